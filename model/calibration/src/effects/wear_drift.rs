//! `wear_drift`: friction drifts with the total travel since the session began.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct WearDrift;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &WearDrift;

static DESCRIPTION: Description<'static> = Description {
    id: "wear_drift",
    side: Side::Switch,
    covariate: Covariate::Time,
    stage: Stage::ScaledFriction,
    formula: "mu (1 + k g(u)), u the share of all repetitions, g(u) = u or (1 - exp(-u/t))/(1 - exp(-1/t))",
    written: Written::factor(ActsOn::Mu, "k*(1 - exp(-travel/t)) / (1 - exp(-1/t))"),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("t", "1", 0.08, 3.0)],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("thermal_drift")],
    experiment: "repeat the first series at the end of the session",
    invisible_because: "the session is too short to drift",
    study: StudyRange {
        size: Some((0.08, 0.25)),
        signed: true,
        shapes: &[(0.2, 3.0)],
        paper: PaperProtocol::Shown,
    },
};

impl Effect for WearDrift {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.1, 0.15], vec![0.1, 0.4], vec![0.1, 2.0]]
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        let settled = -libm::expm1(-1.0 / k[1]);
        let factor = (1.0 + k[0] * -libm::expm1(-point.travel / k[1]) / settled).max(0.0);
        state.mu_pins *= factor;
        state.mu_silicone *= factor;
        state.extra_exponent_pins *= factor;
    }
}
