//! `direction_asymmetry`: friction differs between the eccentric and the concentric direction.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.1]]);

const DESCRIPTION: Description<'static> = Description {
    id: "direction_asymmetry",
    side: Side::Switch,
    covariate: Covariate::Direction,
    stage: Stage::ScaledFriction,
    formula: "x_c = x (1 + k/2), x_e = x (1 - k/2)",
    written: Written::factor(ActsOn::Wrap, "k*direction/2"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("load_cell_gain")],
    experiment: "silicone and pins-only runs at the same loads: a gain does not scale with friction",
    invisible_because: "only one direction",
    study: StudyRange { size: Some((0.05, 0.2)), signed: true, shapes: &[], paper: PaperProtocol::Shown },
};
