//! `coating_stiffening`: friction of the coating on the pins increases with load.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.5, 1.0], &[0.5, 2.0]]);

const DESCRIPTION: Description<'static> = Description {
    id: "coating_stiffening",
    side: Side::Switch,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "mu_p (1 + k (F/F0)^m), m in 1..2, F0 = 50 N",
    written: Written::factor(ActsOn::MuPins, "k*(load_n/50)^m"),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("m", "1", 0.9, 2.1)],
    // The contact area increases with load.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("polygon_bending"), Cow::Borrowed("coating_ploughing")],
    experiment: "pins-only runs over load and pin count",
    invisible_because: "no condition with pins, or only one load",
    study: StudyRange {
        size: Some((0.3, 1.2)),
        signed: false,
        shapes: &[(1.0, 2.0)],
        paper: PaperProtocol::Shown,
    },
};
