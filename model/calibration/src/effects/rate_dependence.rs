//! `rate_dependence`: friction depends on the speed of the actuator.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.25]]);

const DESCRIPTION: Description<'static> = Description {
    id: "rate_dependence",
    side: Side::Switch,
    covariate: Covariate::Speed,
    stage: Stage::ScaledFriction,
    formula: "mu (1 + k ln(v/v0)), v0 the geometric mean speed",
    written: Written::factor(ActsOn::Mu, "k*ln(speed_pct/mean_speed_pct)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("fixture_compliance"), Cow::Borrowed("substrate_saturation")],
    experiment: "several speeds at one load",
    invisible_because: "the speed never varies",
    study: StudyRange {
        size: Some((0.15, 0.5)),
        signed: false,
        shapes: &[],
        paper: PaperProtocol::Confounded,
    },
};
