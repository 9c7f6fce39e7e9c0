//! Results of the study by kind of rig.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::case::Case;
use super::figures::{answer_text, median_of};
use super::outcome::CaseOutcome;

/// Results by kind of rig.
///
/// ```
/// use pinswitch_simulation::{Study, run_case, study_cases};
///
/// let case = study_cases().into_iter().find(|c| c.name == "load_cell_gain").ok_or("not a case")?;
/// let outcome = run_case(&case, 1).ok_or("the table reads back")?;
/// assert!(outcome.consistent, "{:?}", outcome.named);
/// let mut study = Study::default();
/// study.add(case, vec![outcome]);
/// assert!(study.table().contains("load_cell_gain"));
/// assert!(study.groups().contains("| singles | 1 |"));
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Study {
    pub(super) outcomes: Vec<(Case, Vec<CaseOutcome>)>,
}

/// A rig of the study, with what its calibration found.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StudiedRig {
    /// Protocol of the session.
    pub protocol: String,
    /// Group of its kind.
    pub group: String,
    /// Its effects or its disturbance, as text.
    pub rig: String,
    /// What the calibration found.
    pub outcome: CaseOutcome,
}

impl Study {
    /// Returns every rig in the order of the study.
    pub fn rigs(&self) -> Vec<StudiedRig> {
        let of = |(case, outcomes): &(Case, Vec<CaseOutcome>)| {
            let studied = |outcome: &CaseOutcome| StudiedRig {
                protocol: format!("{:?}", case.protocol).to_lowercase(),
                group: case.group.as_str().to_owned(),
                rig: case.name.clone(),
                outcome: outcome.clone(),
            };
            outcomes.iter().map(studied).collect::<Vec<_>>()
        };
        self.outcomes.iter().flat_map(of).collect()
    }

    /// Adds the outcomes of a kind.
    pub fn add(&mut self, case: Case, outcomes: Vec<CaseOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// Returns the results by kind, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| protocol | group | rig | sets | exact | exact of the visible | consistent | left open | error after/before | next session | intervals with the truth | other answers |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            let exact = outcomes.iter().filter(|o| o.exact).count();
            let consistent = outcomes.iter().filter(|o| o.exact || o.consistent).count();
            let open = outcomes.iter().filter(|o| o.left_open && !o.exact && !o.consistent).count();
            let visible = outcomes.iter().filter(|o| o.visible).count();
            let seen = outcomes.iter().filter(|o| o.visible && o.exact).count();
            let mut other: BTreeMap<String, usize> = BTreeMap::new();
            for o in outcomes.iter().filter(|o| !o.exact) {
                *other.entry(answer_text(o)).or_default() += 1;
            }
            let other: Vec<String> = other.into_iter().map(|(answer, k)| format!("{answer} ({k})")).collect();
            text.push_str(&format!(
                "| {} | {} | {} | {} | {exact} | {seen} of {visible} | {consistent} | {open} | {:.3} | {:.3} | {} | {} |\n",
                format!("{:?}", case.protocol).to_lowercase(),
                case.group.as_str(),
                case.name,
                outcomes.len(),
                median_of(outcomes.iter().map(|o| o.fresh_n[1] / o.fresh_n[0].max(1e-9))),
                median_of(outcomes.iter().map(|o| o.next_n[1] / o.next_n[0].max(1e-9))),
                covered(outcomes),
                other.join("; ").replace('|', " or ")
            ));
        }
        text
    }
}

/// Returns the number of intervals that contain the true size, as text; empty without intervals.
fn covered(outcomes: &[CaseOutcome]) -> String {
    let all: Vec<bool> = outcomes.iter().flat_map(|o| o.covered.iter().copied()).collect();
    if all.is_empty() {
        return String::new();
    }
    format!("{} of {}", all.iter().filter(|c| **c).count(), all.len())
}
