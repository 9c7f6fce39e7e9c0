//! The friction, calibration and simulation crates under the paths they had when they were one crate.
//!
//! It knows nothing of its own, and goes when nobody imports it any more.

pub use pinswitch_friction::{
    Contact, ContactError, Direction, FrictionCurve, Law, LawError, LayoutLaw, PaperSwitch, PinPattern,
    PublishedPoint, Substrate, Switch, SwitchState, Transition, Trust, best_law, capstan_friction_n,
    capstan_tension_n, finger, least_squares, other_laws, predict, predict_by, published, published_points,
};

pub use pinswitch_calibration::{effects, inference, segmentation};
pub use pinswitch_simulation as simulation;

/// The closed loop: a table in, a verdict with errors before and after out.
pub mod calibration {
    pub use pinswitch_calibration::{
        BadSeries, Calibration, CalibrationError, CandidateReport as Candidate, DataSummary, EffectReport,
        Estimate, Explanation, Extrapolation, Fate, HeldOut, Invisible, ModelFile, ModelFileError,
        ModelReport, Report, RivalReport, Verdict, calibrate, calibrate_below, explain_published, held_out,
        layouts_left_out,
    };
}

/// Measured data of the friction rig.
pub mod rig {
    pub use pinswitch_calibration::table::*;
    pub use pinswitch_friction::Substrate as Surface;
}

/// Backwards: which pins make a wanted curve.
pub mod layout_search {
    pub use pinswitch_friction::layout_search::*;
    pub use pinswitch_friction::layout_search::{LayoutCandidate as Candidate, MAX_GROOVES as MOST_GROOVES};
}

/// Friction from physics.
pub mod physics {
    pub use pinswitch_friction::physics::*;

    /// What the tendon does outside the pins.
    pub mod hypotheses {
        pub use pinswitch_friction::physics::hypotheses::HypothesisFinding as Finding;
        pub use pinswitch_friction::physics::hypotheses::*;
    }
}
