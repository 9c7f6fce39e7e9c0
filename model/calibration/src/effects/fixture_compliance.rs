//! `fixture_compliance`: the wrap angle increases with load because the fixture bends.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.12]]);

const DESCRIPTION: Description<'static> = Description {
    id: "fixture_compliance",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "a (1 + k F/F0), in every condition",
    written: Written::factor(ActsOn::Wrap, "k*load_n/50"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("rate_dependence"), Cow::Borrowed("substrate_saturation")],
    experiment: "a dial gauge on the mount, or several speeds at one load",
    invisible_because: "only one load",
    study: StudyRange {
        size: Some((0.06, 0.25)),
        signed: false,
        shapes: &[],
        paper: PaperProtocol::Confounded,
    },
};
