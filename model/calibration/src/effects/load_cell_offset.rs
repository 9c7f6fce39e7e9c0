//! `load_cell_offset`: the reading has a constant offset.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.4]]);

const DESCRIPTION: Description<'static> = Description {
    id: "load_cell_offset",
    side: Side::Rig,
    covariate: Covariate::Direction,
    stage: Stage::CellZero,
    formula: "reading + b",
    written: Written::sum(ActsOn::Reading, "b"),
    parameters: &[Parameter::free("b", "N")],
    one_sided: false,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("hook_omitted")],
    experiment: "a zero reading of the unloaded cell",
    invisible_because: "too few loads",
    study: StudyRange { size: Some((0.2, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
