//! The study of the calibrator: rigs of every kind with sizes, forms and noise drawn, and what it says of them.

mod case;
mod case_study;
mod cases;
mod experiment_study;
mod figures;
mod form_study;
mod masks;
mod nulls;
mod outcome;
mod outside;
mod said;
mod shown;
mod summary;
mod told_probability;
mod true_form;

pub use case::{Case, Group, Truth};
pub use case_study::Study;
pub use cases::{plan_of, study_cases};
pub use experiment_study::{
    ExperimentOutcome, ExperimentStudy, Standing, experiment_cases, run_experiment_case,
};
pub use form_study::{FormOutcome, FormStudy, run_form_case};
pub use outcome::{CaseOutcome, run_case};
pub use told_probability::Promised;
