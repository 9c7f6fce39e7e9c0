//! What is told of several sessions: what changed between them, what is not the same in all, and what was known after each.

use serde::{Deserialize, Serialize};

use super::{EffectReport, Estimate, Report, Verdict};
use crate::asked::Asked;

/// A constant of the switch that some sessions or specimens have otherwise than the latest one, whose constants the model
/// predicts with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChangeReport {
    /// `mu_p`, `mu_s`, or `F_half`: the half loads of all layouts.
    pub constant: String,
    /// `session` or `specimen`.
    pub by: String,
    /// The names of those that have it otherwise.
    pub groups: Vec<String>,
    /// The names of the others, the latest among them.
    pub others: Vec<String>,
    /// Their constant over that of the others.
    pub factor: Estimate,
    /// The constant of the others, where it is one; absent for half loads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest: Option<f64>,
}

impl ChangeReport {
    /// In words: what is how large where.
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

/// A named effect whose size is not the same in all sessions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnequalReport {
    /// Its id.
    pub id: String,
    /// The size.
    pub parameter: String,
    /// What the model has, which is true of no session; 0 of an effect that sessions alone show and all together do not.
    pub in_the_model: f64,
    /// Probability by chance that sizes differ so much.
    pub p_value: f64,
    /// The size in each session that tells it.
    pub sizes: Vec<SizeInSession>,
}

/// A size in one session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeInSession {
    /// The session.
    pub session: String,
    /// The size there, shapes held as all sessions together have them.
    pub size: Estimate,
}

impl UnequalReport {
    /// In words: how large it is where.
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
            "together they name none, and the model has none of it".to_owned()
        } else {
            format!("the {:.4} that the model has is true of none", self.in_the_model)
        };
        format!(
            "{} is not the same in all sessions: {} = {}; {in_the_model}",
            self.id,
            self.parameter,
            each.join(", ")
        )
    }
}

/// What was known after one of several tables, and those before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SessionReport {
    /// The table that came last.
    pub table: String,
    /// What the runs of this table were proposed for, if a plan was given, and what came of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asked: Option<Asked>,
    /// Rows up to here.
    pub rows: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// What was found, each with its rivals.
    pub effects: Vec<Vec<String>>,
    /// Effects of consequence that were not excluded.
    pub not_excluded: Vec<String>,
    /// Error to expect on a new session, in newtons.
    #[serde(rename = "promise_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_n: Option<f64>,
}

impl SessionReport {
    /// What a report says after `table`.
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

    /// In words: the verdict, and what it is about.
    pub fn words(&self) -> String {
        let found: Vec<String> = self.effects.iter().map(|ids| ids.join(" or ")).collect();
        let word = self.verdict.as_str();
        match (found.is_empty(), self.verdict) {
            (false, _) => format!("{word}: {}", found.join(", ")),
            (true, Verdict::Inconclusive) if !self.not_excluded.is_empty() => {
                format!("{word}: not excluded are {}", self.not_excluded.join(", "))
            }
            (true, _) => word.to_owned(),
        }
    }
}
