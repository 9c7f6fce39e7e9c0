//! `direction_asymmetry`: friction differs between the eccentric and the concentric direction.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange,
    Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct DirectionAsymmetry;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &DirectionAsymmetry;

static DESCRIPTION: Description<'static> = Description {
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

impl Effect for DirectionAsymmetry {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn on_contact(&self, k: &[f64], point: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + point.sign * k[0] / 2.0).max(0.0);
    }
}
