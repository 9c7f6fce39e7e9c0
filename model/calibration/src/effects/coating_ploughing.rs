//! `coating_ploughing`: the force at each pin ploughs the coating.

use std::borrow::Cow;

use super::{
    ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, Side, Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
pub(super) struct CoatingPloughing;

/// Entry in the catalogue.
pub(super) static EFFECT: CoatingPloughing = CoatingPloughing;

static DESCRIPTION: Description<'static> = Description {
    id: "coating_ploughing",
    side: Side::Switch,
    covariate: Covariate::Load,
    stage: Stage::AddedFriction,
    formula: "x_p + kappa sqrt(F) sum theta_i^1.5",
    written: Written::No("it depends on the deflection angle at every pin"),
    parameters: &[Parameter::free("kappa", "N^-0.5")],
    // Ploughing only adds friction.
    one_sided: true,
    bends: true,
    scales: true,
    on_plain: false,
    confused_with: &[Cow::Borrowed("coating_stiffening"), Cow::Borrowed("polygon_bending")],
    experiment: "pins-only runs over load and pin count",
    invisible_because: "no condition with pins",
    study: StudyRange { size: Some((0.012, 0.03)), signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for CoatingPloughing {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.02]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, condition: &Condition, state: &mut ContactState) {
        state.extra_exponent_pins += k[0] * state.load_n.sqrt() * condition.ploughing;
    }
}
