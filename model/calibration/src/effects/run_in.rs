//! `run_in`: friction of the silicone is higher in the first repetitions of a series.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(
    DESCRIPTION,
    &[
        &[0.2, 1.0, 1.0, 0.02],
        &[0.2, 2.5, 1.0, 0.02],
        &[0.2, 6.0, 1.0, 0.02],
        &[0.2, 2.5, 0.0, 0.02],
        &[0.2, 1.5, 1.0, 1.0],
    ],
);

const DESCRIPTION: Description<'static> = Description {
    id: "run_in",
    side: Side::Switch,
    covariate: Covariate::Repetition,
    stage: Stage::ScaledFriction,
    formula: "mu_s (1 + g k (1 + q (r - 1)/r0)^(-1/q)), g = 1 eccentric, c concentric (c = 1: it settles again there)",
    written: Written::factor(
        ActsOn::MuSilicone,
        "k*(1 + max(q, 1e-6)*(repetition - 1)/r0)^(-1/max(q, 1e-6)) * ((direction < 0) + c*(direction > 0))",
    ),
    parameters: &[
        Parameter::free("k", "1"),
        Parameter::bounded("r0", "1", 0.5, 12.0),
        Parameter::bounded("c", "1", -0.05, 1.05),
        // General-order kinetics: exponential at 0, hyperbolic at 1.
        Parameter::bounded_or("q", "1", -0.05, 1.05, 0.0),
    ],
    // Friction is higher before it settles.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("stroke_position")],
    experiment: "a series started in the middle of the stroke",
    invisible_because: "one repetition per series, or no silicone",
    study: StudyRange {
        size: Some((0.05, 0.4)),
        signed: false,
        shapes: &[(1.5, 6.0), (1.0, 1.0)],
        paper: PaperProtocol::Shown,
    },
};
