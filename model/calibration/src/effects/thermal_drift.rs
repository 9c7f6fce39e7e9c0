//! `thermal_drift`: the reading drifts with time.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.5]]);

const DESCRIPTION: Description<'static> = Description {
    id: "thermal_drift",
    side: Side::Rig,
    covariate: Covariate::Time,
    stage: Stage::CellZero,
    formula: "reading + k u, u the share of the session's time",
    written: Written::sum(ActsOn::Reading, "k*time"),
    parameters: &[Parameter::free("k", "N")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("wear_drift")],
    experiment: "a zero reading before and after the session",
    invisible_because: "the session is too short to drift",
    study: StudyRange { size: Some((0.3, 1.5)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
