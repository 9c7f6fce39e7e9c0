//! Formulas of unattributed structure in a report.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Estimate;

/// A formula that fits equally well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FormRival {
    /// Shape.
    pub shape: String,
    /// Quantity that it changes.
    pub acts_on: String,
    /// Difference of the log evidence to the best formula, in nats.
    pub worse_by: f64,
}

/// Formula of unattributed structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FormReport {
    /// `level` (also between two ends), `step`, `ramp`, `sine`, `bump`, `dip`, `power`,
    /// `forgetting`, `memory` or `groups`.
    pub shape: String,
    /// `friction`, `reading`, `wrap` or `threshold`.
    pub acts_on: String,
    /// Quantity in the words of `discovered.toml`, such as `mu_silicone`.
    pub channel: String,
    /// Id of the effect in `discovered.toml`.
    pub id: String,
    /// Formula, in the language of `model/doc/own-effects.md`.
    pub formula: String,
    /// Constants.
    pub parameters: BTreeMap<String, Estimate>,
    /// Share of the log evidence of the structure that the formula explains, 0..1.
    pub explains: f64,
    /// Held-out error of the model with the formula in place of the structure, in newtons.
    #[serde(rename = "heldout_rmse_N")]
    pub heldout_rmse_n: f64,
    /// Whether the model contains the formula, because its evidence is not smaller than that of the
    /// structure.
    pub in_model: bool,
    /// Other formulas that fit equally well.
    pub rivals: Vec<FormRival>,
}

impl FormReport {
    /// Returns the shape in words, with its article.
    pub fn words(&self) -> String {
        match self.shape.as_str() {
            "groups" => "a level of one operator".to_owned(),
            shape => format!("a {shape}"),
        }
    }
}
