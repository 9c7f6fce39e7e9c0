//! `fixture_compliance`: the wrap angle increases with load because the fixture bends.

use std::borrow::Cow;

use super::{
    ActsOn, ContactState, Covariate, Description, Effect, PaperProtocol, Parameter, REFERENCE_LOAD_N, Side,
    Stage, StudyRange, Written,
};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
struct FixtureCompliance;

/// Entry in the catalogue.
pub(super) const EFFECT: &dyn Effect = &FixtureCompliance;

static DESCRIPTION: Description<'static> = Description {
    id: "fixture_compliance",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::ScaledFriction,
    formula: "a (1 + k F/F0), in every condition",
    written: Written::factor(ActsOn::Wrap, "k*load_n/50"),
    parameters: &[Parameter::free("k", "1")],
    one_sided: false,
    bends: true,
    scales: true,
    on_plain: true,
    confused_with: &[Cow::Borrowed("rate_dependence"), Cow::Borrowed("substrate_saturation")],
    experiment: "a dial gauge on the mount, or several speeds at one load",
    invisible_because: "only one load",
    study: StudyRange {
        size: Some((0.06, 0.25)),
        signed: false,
        shapes: &[],
        paper: PaperProtocol::Confounded,
    },
};

impl Effect for FixtureCompliance {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn starts(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![0.05]]
    }

    fn on_contact(&self, k: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.exponent_factor *= (1.0 + k[0] * state.load_n / REFERENCE_LOAD_N).max(0.0);
    }
}
