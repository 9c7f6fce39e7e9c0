//! The study of the calibrator: random rigs of every kind, and the answers of the calibrator
//! compared with the truth.

mod answer;
mod bench;
mod case;
mod case_study;
mod cases;
mod experiment_study;
mod figures;
mod forecast;
mod form_study;
mod masks;
mod nulls;
mod outcome;
mod outside;
mod summary;
mod true_form;
mod visibility;

pub use case::{Case, Group, Truth};
pub use case_study::{StudiedRig, Study};
pub use cases::{plan_of, study_cases};
pub use experiment_study::{
    Attribution, ExperimentOutcome, ExperimentStudy, experiment_cases, run_experiment_case,
};
pub use forecast::Forecast;
pub use form_study::{FormOutcome, FormStudy, run_form_case};
pub use outcome::{CaseOutcome, run_case};
