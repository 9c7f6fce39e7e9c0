//! Comparison of several sessions: changes between them, differing sizes, and the state after each.

use serde::{Deserialize, Serialize};

use super::{EffectReport, Estimate, Report, Verdict};
use crate::session_plan::SessionPlan;

/// A constant of the switch that differs in some sessions or specimens from the latest one, which
/// the model predicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChangeReport {
    /// `mu_p`, `mu_s`, or `F_half` for the thresholds of all layouts.
    pub constant: String,
    /// `session` or `specimen`.
    pub by: String,
    /// Names of the groups with the other value.
    pub groups: Vec<String>,
    /// Names of the remaining groups, including the latest.
    pub others: Vec<String>,
    /// Ratio of their constant to that of the remaining groups.
    pub factor: Estimate,
    /// The constant of the remaining groups; absent for thresholds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest: Option<f64>,
}

impl ChangeReport {
    /// Describes the change in words.
    pub fn words(&self) -> String {
        let Estimate { value, ci95, .. } = &self.factor;
        let percent = |factor: f64| format!("{:+.1}", 100.0 * (factor - 1.0));
        let than = self
            .latest
            .map_or_else(String::new, |latest| format!(" ({:.3} instead of {latest:.3})", value * latest));
        let name = if self.constant == "F_half" { "the half load of every layout" } else { &self.constant };
        format!(
            "{name} differs by {} % [{}, {}] in {} {}{than} from that in {}",
            percent(*value),
            percent(ci95[0]),
            percent(ci95[1]),
            self.by,
            self.groups.join(", "),
            self.others.join(", "),
        )
    }
}

/// An effect whose size differs between sessions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnequalReport {
    /// Id.
    pub id: String,
    /// Name of the size.
    pub parameter: String,
    /// Size in the model, which applies to no session; 0 for an effect that single sessions show
    /// but all together do not.
    pub in_the_model: f64,
    /// Probability of such a difference by chance.
    pub p_value: f64,
    /// Size in each session that determines it.
    pub sizes: Vec<SizeInSession>,
}

/// A size in one session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeInSession {
    /// Session.
    pub session: String,
    /// Size in that session, with the shapes fixed at the common fit.
    pub size: Estimate,
}

impl UnequalReport {
    /// Describes the sizes in words.
    pub fn words(&self) -> String {
        let each: Vec<String> = self
            .sizes
            .iter()
            .map(|SizeInSession { session, size }| {
                let [low, high] = size.ci95;
                format!("{:.4} [{low:.4}, {high:.4}] {} in {session}", size.value, size.unit)
            })
            .collect();
        let in_the_model = if self.in_the_model == 0.0 {
            "the sessions together do not show it, and the model excludes it".to_owned()
        } else {
            format!("the model's value {:.4} applies to none of them", self.in_the_model)
        };
        format!(
            "{} differs between sessions: {} = {}; {in_the_model}",
            self.id,
            self.parameter,
            each.join(", ")
        )
    }
}

/// State after one of several tables and those before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
