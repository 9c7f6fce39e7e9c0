//! `polygon_bending`: friction increases with the deflection angle of the tendon at a pin.

use std::borrow::Cow;

use super::{
    ActsOn, Covariate, Description, FormulaEffect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};

/// Entry in the catalogue.
pub(super) static EFFECT: FormulaEffect = FormulaEffect::new(DESCRIPTION, &[&[0.6]]);

const DESCRIPTION: Description<'static> = Description {
    id: "polygon_bending",
    side: Side::Switch,
    covariate: Covariate::Condition,
    stage: Stage::ScaledFriction,
    formula: "mu_p (1 + k (a/n) / (20 deg)) with the mean deflection angle a/n per pin",
    // `k` refers to 20 degrees.
    written: Written::factor(ActsOn::MuPins, "k*turn_per_pin_rad/0.3490658503988659"),
    parameters: &[Parameter::free("k", "1")],
    // Sharper deflections bend the fibres more.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("coating_ploughing")],
    experiment: "the same number of loads on a layout with another number of pins",
    invisible_because: "all pins-only and device layouts have the same number of pins",
    study: StudyRange { size: Some((0.3, 1.5)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};
