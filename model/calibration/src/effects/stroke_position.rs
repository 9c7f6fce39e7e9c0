//! `stroke_position`: the wrap angle changes along the stroke.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.1]]);

const DESCRIPTION: Description<'static> = Description {
    id: "stroke_position",
    side: Side::Rig,
    covariate: Covariate::Position,
    stage: Stage::ScaledFriction,
    formula: "a (1 + k (s/stroke - 1/2))",
    written: Written::factor(ActsOn::Wrap, "k*(stroke - 0.5)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("run_in")],
    experiment: "both directions over the whole stroke",
    invisible_because: "the position never varies",
    study: StudyRange { size: Some((0.05, 0.2)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
