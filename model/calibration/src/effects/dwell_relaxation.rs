//! `dwell_relaxation`: friction of the silicone depends on the pause before the reading.

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.08]]);

const DESCRIPTION: Description<'static> = Description {
    id: "dwell_relaxation",
    side: Side::Switch,
    covariate: Covariate::Dwell,
    stage: Stage::ScaledFriction,
    formula: "mu_s (1 + k ln(dwell / 3 s))",
    written: Written::factor(ActsOn::MuSilicone, "k*ln(dwell_s/3)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[],
    experiment: "one silicone run with dwells of 0.3, 3 and 30 s",
    invisible_because: "the dwell never varies, or there is no silicone",
    study: StudyRange { size: Some((0.04, 0.12)), signed: true, shapes: &[], paper: PaperProtocol::Hidden },
};
