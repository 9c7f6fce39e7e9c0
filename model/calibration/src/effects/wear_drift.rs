//! `wear_drift`: friction drifts with the total travel since the session began.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect =
    FormulaEffect::new(DESCRIPTION, &[&[0.15, 0.15], &[0.15, 0.5], &[0.15, 3.0]]);

const DESCRIPTION: Description<'static> = Description {
    id: "wear_drift",
    side: Side::Switch,
    covariate: Covariate::Time,
    stage: Stage::ScaledFriction,
    formula: "mu (1 + k g(u)), u the share of all repetitions, g(u) = u or (1 - exp(-u/t))/(1 - exp(-1/t))",
    written: Written::factor(ActsOn::Mu, "k*(1 - exp(-travel/t)) / (1 - exp(-1/t))"),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("t", "1", 0.08, 3.0)],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("thermal_drift")],
    experiment: "repeat the first series at the end of the session",
    invisible_because: "the session is too short to drift",
    study: StudyRange {
        size: Some((0.08, 0.25)),
        signed: true,
        shapes: &[(0.2, 3.0)],
        paper: PaperProtocol::Shown,
    },
};
