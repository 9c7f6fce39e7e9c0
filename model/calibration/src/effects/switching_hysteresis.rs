//! `switching_hysteresis`: the threshold differs between ascending and descending loads.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[5.0]]);

const DESCRIPTION: Description<'static> = Description {
    id: "switching_hysteresis",
    side: Side::Switch,
    covariate: Covariate::Sweep,
    stage: Stage::Switch,
    formula: "F_half(down) = F_half(up) - H",
    written: Written::sum(ActsOn::Threshold, "-H*descending"),
    parameters: &[Parameter::free("H", "N")],
    // The silicone recovers with a delay.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("switch_local_tension")],
    experiment: "a descending sweep of loads on a device",
    invisible_because: "no device, or loads never descend",
    study: StudyRange { size: Some((3.0, 10.0)), signed: false, shapes: &[], paper: PaperProtocol::Hidden },
};
