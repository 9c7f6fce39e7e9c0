//! `polygon_bending`: friction increases with the deflection angle of the tendon at a pin.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Deflection angle per pin to which `k` refers: 20 degrees.
const REFERENCE_TURN_RAD: f64 = 0.349_065_850_398_865_9;

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct PolygonBending;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &PolygonBending;

static DESCRIPTION: Description<'static> = Description {
    id: "polygon_bending",
    side: Side::Switch,
    covariate: Covariate::Condition,
    stage: Stage::ScaledFriction,
    formula: "mu_p (1 + k (a/n) / (20 deg)) with the mean deflection angle a/n per pin",
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

impl Effect for PolygonBending {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.5]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, condition: &Condition, state: &mut ContactState) {
        if condition.has_pins() {
            state.mu_pins *= (1.0 + k[0] * condition.turn_rad / REFERENCE_TURN_RAD).max(0.0);
        }
    }
}
