//! `rate_dependence`: friction depends on the speed of the actuator.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct RateDependence;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &RateDependence;

static DESCRIPTION: Description<'static> = Description {
    id: "rate_dependence",
    side: Side::Switch,
    covariate: Covariate::Speed,
    stage: Stage::ScaledFriction,
    formula: "mu (1 + k ln(v/v0)), v0 the geometric mean speed",
    written: Written::factor(ActsOn::Mu, "k*ln(speed_pct/mean_speed_pct)"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("fixture_compliance"), Cow::Borrowed("substrate_saturation")],
    experiment: "several speeds at one load",
    invisible_because: "the speed never varies",
    study: StudyRange {
        size: Some((0.15, 0.5)),
        signed: false,
        shapes: &[],
        paper: PaperProtocol::Confounded,
    },
};

impl Effect for RateDependence {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.1]]
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        let factor = (1.0 + k[0] * point.log_speed).max(0.0);
        state.mu_pins *= factor;
        state.mu_silicone *= factor;
        state.extra_exponent_pins *= factor;
    }
}
