//! `guide_drag`: a constant drag of the guide pulleys in every condition.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.3]]);

const DESCRIPTION: Description<'static> = Description {
    id: "guide_drag",
    side: Side::Rig,
    covariate: Covariate::Direction,
    stage: Stage::Drag,
    formula: "T + d c in every condition",
    written: Written::sum(ActsOn::Tension, "c*direction"),
    parameters: &[Parameter::free("c", "N")],
    // It opposes every move.
    one_sided: true,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("adhesion")],
    experiment: "a pins-only run or a blank run without the switch",
    invisible_because: "only one direction",
    study: StudyRange { size: Some((0.1, 0.5)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};
