//! `load_cell_nonlinearity`: the reading has a quadratic error.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.5]]);

const DESCRIPTION: Description<'static> = Description {
    id: "load_cell_nonlinearity",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::CellScale,
    formula: "reading + k (reading/F0)^2",
    written: Written::sum(ActsOn::Reading, "k*(tension_n/50)^2"),
    parameters: &[Parameter::free("k", "N")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("load_cell_gain"), Cow::Borrowed("load_cell_saturation")],
    experiment: "dead weights up to 65 N on the cell",
    invisible_because: "only one direction, or one load",
    study: StudyRange { size: Some((0.3, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
