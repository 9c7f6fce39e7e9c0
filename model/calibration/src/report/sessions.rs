//! Comparison of several sessions: changes between them, differing sizes, and the state after each.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EffectReport, Report, Verdict};
use crate::session_plan::SessionPlan;

/// A constant of the switch that differs between sessions or specimens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChangeReport {
    /// `mu_p`, `mu_s`, `mu` for all friction coefficients, or `F_half` for half loads.
    pub constant: String,
    /// Layout of the half load; that of every layout if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<String>,
    /// `session` or `specimen`.
    pub by: String,
    /// Posterior probability of the change.
    pub probability: f64,
    /// Factor of the constant in each session or specimen.
    pub factors: BTreeMap<String, f64>,
}

impl ChangeReport {
    /// Describes the change in words.
    pub fn words(&self) -> String {
        let each: Vec<String> = self
            .factors
            .iter()
            .map(|(group, factor)| format!("{:+.1} % in {} {group}", 100.0 * (factor - 1.0), self.by))
            .collect();
        let of = self.layout.as_ref().map_or_else(String::new, |layout| format!(" of {layout}"));
        format!("{}{of} differs between {}s: {}", self.constant, self.by, each.join(", "))
    }
}

/// State after one of several tables and those before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SessionReport {
    /// The last table.
    pub table: String,
    /// Plan of this table with the answers to its questions, if a plan was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asked: Option<SessionPlan>,
    /// Number of rows so far.
    pub rows: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// Effects of the model, each followed by its rivals.
    pub effects: Vec<Vec<String>>,
    /// Relevant effects that are not excluded.
    pub not_excluded: Vec<String>,
    /// Expected error of a new session in newtons.
    #[serde(rename = "promise_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_n: Option<f64>,
}

impl SessionReport {
    /// Returns the state of a report after `table`.
    pub fn after(table: String, report: &Report) -> Self {
        let ids = |effect: &EffectReport| {
            std::iter::once(effect.id.clone()).chain(effect.rivals.iter().map(|r| r.id.clone())).collect()
        };
        Self {
            table,
            asked: None,
            rows: report.data.rows,
            verdict: report.verdict,
            effects: report.effects.iter().map(ids).collect(),
            not_excluded: report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.clone()).collect(),
            promise_n: report.promise_n,
        }
    }

    /// Describes verdict and effects in words.
    pub fn words(&self) -> String {
        let effects: Vec<String> = self.effects.iter().map(|ids| ids.join(" or ")).collect();
        let word = self.verdict.as_str();
        match (effects.is_empty(), self.verdict) {
            (false, _) => format!("{word}: {}", effects.join(", ")),
            (true, Verdict::Inconclusive) if !self.not_excluded.is_empty() => {
                format!("{word}: cannot rule out {}", self.not_excluded.join(", "))
            }
            (true, _) => word.to_owned(),
        }
    }
}
