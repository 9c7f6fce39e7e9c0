//! `substrate_saturation`: the friction coefficient of the silicone decreases with load.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, REFERENCE_LOAD_N, Side,
    Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct SubstrateSaturation;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &SubstrateSaturation;

static DESCRIPTION: Description<'static> = Description {
    id: "substrate_saturation",
    side: Side::Switch,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "mu_s (F/F0)^(n-1) blended with mu_s/(1 + k F/F0) by the shape h in 0..1",
    written: Written::factor(
        ActsOn::MuSilicone,
        "max(load_n/50, 0.001)^(-k*(1 - h)) / max(1 + k*h*load_n/50, 0.05) - 1",
    ),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("h", "1", -0.02, 1.02)],
    // The friction of a soft contact increases less than the load.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("rate_dependence"), Cow::Borrowed("fixture_compliance")],
    experiment: "several loads at one speed",
    invisible_because: "no silicone, or only one load",
    study: StudyRange {
        size: Some((0.12, 0.33)),
        signed: false,
        shapes: &[(0.0, 1.0)],
        paper: PaperProtocol::Shown,
    },
};

impl Effect for SubstrateSaturation {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.15, 0.05], vec![0.15, 0.5], vec![0.15, 0.95]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        let f = (state.load_n / REFERENCE_LOAD_N).max(1e-3);
        // h = 0: the power law with n = 1 - k; h = 1: the hyperbola. In between, the exponents add.
        let power = libm::pow(f, -k[0] * (1.0 - k[1]));
        let hyperbola = 1.0 / (1.0 + k[0] * k[1] * f).max(0.05);
        state.mu_silicone *= power * hyperbola;
    }
}
