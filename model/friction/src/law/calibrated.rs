//! `calibrated`: a model fitted to measured data. Its curves come from a model file, not from a
//! contact alone.

use super::definition::LawDefinition;
use super::error::LawError;

pub(super) static DEFINITION: LawDefinition = LawDefinition {
    word: "calibrated",
    title: "calibrated model",
    summary: "Model calibrated on measured data: the layouts of its rig",
    source: "a model calibrated on measured data; the reasons list its effects",
    needs_model: true,
    states: |_, _| Err(NEEDS_MODEL),
    uncertain: |_, _| Err(NEEDS_MODEL),
    remark: |_| None,
};

const NEEDS_MODEL: LawError =
    LawError::DoesNotApply { problem: "a calibrated law needs a model file", help: "give one with --model" };
