//! `substrate_saturation`: the friction coefficient of the silicone decreases with load.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.2, 0.0], &[0.2, 1.0]]);

const DESCRIPTION: Description<'static> = Description {
    id: "substrate_saturation",
    side: Side::Switch,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "mu_s (F/F0)^(n-1) blended with mu_s/(1 + k F/F0) by the shape h in 0..1",
    written: Written::factor(
        ActsOn::MuSilicone,
        "max(load_n/50, 0.001)^(-k*(1 - h)) / max(1 + k*h*load_n/50, 0.05) - 1",
    ),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("h", "1", -0.02, 1.02)],
    // The friction of a soft contact increases less than the load.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("rate_dependence"), Cow::Borrowed("fixture_compliance")],
    experiment: "several loads at one speed",
    invisible_because: "no silicone, or only one load",
    study: StudyRange {
        size: Some((0.12, 0.33)),
        signed: false,
        shapes: &[(0.0, 1.0)],
        paper: PaperProtocol::Shown,
    },
};
