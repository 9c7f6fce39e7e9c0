//! `hook_omitted`: the declared load omits the weight of the hook.

use pinswitch_friction::published;

use std::borrow::Cow;

use super::{ContactState, Covariate, Description, Effect, PaperProtocol, Side, Stage, StudyRange, Written};
use crate::table::{Condition, Frame, Point};

/// Marker type; see [`DESCRIPTION`].
#[derive(Debug)]
pub(super) struct HookOmitted;

/// Entry in the catalogue.
pub(super) static EFFECT: HookOmitted = HookOmitted;

static DESCRIPTION: Description<'static> = Description {
    id: "hook_omitted",
    side: Side::Rig,
    covariate: Covariate::Load,
    stage: Stage::Load,
    formula: "F + 0.613 N: the hook of 62.53 g; no free constant",
    written: Written::No("it is without constants"),
    parameters: &[],
    one_sided: false,
    bends: false,
    scales: false,
    on_plain: false,
    confused_with: &[Cow::Borrowed("load_cell_offset")],
    experiment: "weigh the hook",
    invisible_because: "",
    study: StudyRange { size: None, signed: false, shapes: &[], paper: PaperProtocol::Shown },
};

impl Effect for HookOmitted {
    fn description(&self) -> Description<'_> {
        DESCRIPTION
    }

    fn typical(&self, _frame: &Frame) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn on_contact(&self, _: &[f64], _: &Point, _: &Condition, state: &mut ContactState) {
        state.load_n += published::HOOK_MASS_G * 1e-3 * published::GRAVITY_M_S2;
    }
}
