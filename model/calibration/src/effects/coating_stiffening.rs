//! `coating_stiffening`: friction of the coating on the pins increases with load.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, REFERENCE_LOAD_N, Side,
    Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct CoatingStiffening;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &CoatingStiffening;

static DESCRIPTION: Description<'static> = Description {
    id: "coating_stiffening",
    side: Side::Switch,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "mu_p (1 + k (F/F0)^m), m in 1..2, F0 = 50 N",
    written: Written::factor(ActsOn::MuPins, "k*(load_n/50)^m"),
    parameters: &[Parameter::free("k", "1"), Parameter::bounded("m", "1", 0.9, 2.1)],
    // The contact area increases with load.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("polygon_bending"), Cow::Borrowed("coating_ploughing")],
    experiment: "pins-only runs over load and pin count",
    invisible_because: "no condition with pins, or only one load",
    study: StudyRange {
        size: Some((0.3, 1.2)),
        signed: false,
        shapes: &[(1.0, 2.0)],
        paper: PaperProtocol::Shown,
    },
};

impl Effect for CoatingStiffening {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.4, 1.05], vec![0.4, 1.5], vec![0.4, 1.95]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.mu_pins *= (1.0 + k[0] * libm::pow(state.load_n / REFERENCE_LOAD_N, k[1])).max(0.0);
    }
}
