//! `load_cell_gain`: the reading has a wrong scale.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.02]]);

const DESCRIPTION: Description<'static> = Description {
    id: "load_cell_gain",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::CellScale,
    formula: "reading (1 + g)",
    written: Written::factor(ActsOn::Reading, "g"),
    parameters: &[Parameter::free("g", "1")],
    one_sided: false,
    bends: false,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("direction_asymmetry"), Cow::Borrowed("load_cell_nonlinearity")],
    experiment: "dead weights up to 65 N on the cell",
    invisible_because: "only one direction",
    study: StudyRange { size: Some((0.01, 0.06)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
