//! The figures that a calibrator is judged by: a row for each group of rigs, and the same in words.

use std::collections::BTreeMap;

use super::case::{Case, Group};
use super::case_study::Study;
use super::figures::median_of;
use super::outcome::CaseOutcome;

/// A promise below this share of what a new session has is broken.
const LEAST_PROMISE: f64 = 0.8;

impl Study {
    /// A row for each group, and one for each kind of rig without effect, in Markdown.
    pub fn groups(&self) -> String {
        let mut text = String::from(
            "| group | sets | right | honest | error on the next session | after/before | promised/that | said beside the truth |\n|---|---|---|---|---|---|---|---|\n",
        );
        for group in Group::ALL {
            text.push_str(&row(group.as_str(), &self.of(|case| case.group == group)));
        }
        let mut kinds: Vec<&str> = Vec::new();
        for (case, _) in self.outcomes.iter().filter(|o| o.0.group == Group::Nulls) {
            if !kinds.contains(&case.name.as_str()) {
                kinds.push(&case.name);
            }
        }
        for kind in kinds {
            text.push_str(&row(kind, &self.of(|case| case.name == kind)));
        }
        text
    }

    /// The figures in words, of the groups that were run.
    pub fn summary(&self) -> String {
        let mut lines = Vec::new();
        for group in Group::ALL {
            let outcomes = self.of(|case| case.group == group);
            if !outcomes.is_empty() {
                lines.extend(in_words(group, &outcomes));
            }
        }
        let all: Vec<bool> = self.of(|_| true).iter().flat_map(|o| o.covered.iter().copied()).collect();
        if !all.is_empty() {
            let held = all.iter().filter(|c| **c).count();
            let percent = 100.0 * held as f64 / all.len() as f64;
            lines.push(format!(
                "95 % intervals that hold the true size: {held} of {} ({percent:.1} %)",
                all.len()
            ));
        }
        let attributed: Vec<bool> =
            self.of(|_| true).iter().flat_map(|o| o.across_zero.iter().copied()).collect();
        if !attributed.is_empty() {
            let across = attributed.iter().filter(|a| **a).count();
            lines.push(format!(
                "attributed sizes whose interval holds zero: {across} of {}",
                attributed.len()
            ));
        }
        let mut promises: Vec<f64> =
            self.of(|_| true).iter().filter_map(|o| o.expected_error_ratio).collect();
        promises.sort_by(f64::total_cmp);
        if let (Some(least), Some(most)) = (promises.first(), promises.last()) {
            let below = promises.iter().filter(|p| **p < LEAST_PROMISE).count();
            lines.push(format!(
                "error promised for a new session over that of the next one: median {:.3}, {least:.3} to {most:.3}; \
                 below {LEAST_PROMISE} in {below} of {}",
                median_of(promises.iter().copied()),
                promises.len()
            ));
        }
        lines.iter().map(|l| format!("- {l}\n")).collect()
    }

    fn of(&self, wanted: impl Fn(&Case) -> bool) -> Vec<&CaseOutcome> {
        self.outcomes.iter().filter(|(case, _)| wanted(case)).flat_map(|(_, outcomes)| outcomes).collect()
    }
}

/// The figures of one group.
fn in_words(group: Group, outcomes: &[&CaseOutcome]) -> Vec<String> {
    let (exact, honest) = (share(outcomes, |o| o.exact), share(outcomes, |o| o.exact || o.honest));
    let visible: Vec<&CaseOutcome> = outcomes.iter().filter(|o| o.visible).copied().collect();
    let named = |what: &str| {
        vec![
            format!("{what} named exactly: {exact}"),
            format!("... of those that the session could show: {}", share(&visible, |o| o.exact)),
            format!("{what} named or among the rivals: {honest}"),
            format!("... of those that the session could show: {}", share(&visible, |o| o.exact || o.honest)),
            format!(
                "... or left open: within the limits told, or told as invisible: {}",
                share(outcomes, |o| o.exact || o.honest || o.open)
            ),
        ]
    };
    match group {
        Group::Nulls => vec![
            format!("rigs without effect: an alarm in {}", share(outcomes, |o| !o.exact)),
            format!("their probabilities by chance: {}", calibration_of_p(outcomes)),
        ],
        Group::Singles => {
            let mut lines = named("single effects");
            let ratio = median_of(outcomes.iter().map(|o| o.fresh_n[1] / o.fresh_n[0].max(1e-9)));
            lines.push(format!("error on fresh rows after/before, median over the singles: {ratio:.3}"));
            lines
        }
        Group::Scattered => named("single effects under scatter"),
        Group::Pairs => named("pairs"),
        Group::Masks => named("effects beside a drag that may hide them"),
        Group::Confounded => vec![
            format!("confounded designs called ambiguous, or inconclusive where small: {exact}"),
            format!("confounded designs with the truth named or among the rivals: {honest}"),
        ],
        Group::Outside => vec![
            format!("outside the vocabulary, unattributed with the right covariate: {honest}"),
            format!(
                "... of those that the session could show beside mounts that differ: {}",
                share(&visible, |o| o.exact || o.honest)
            ),
            format!("outside the vocabulary, no name beside it: {exact}"),
        ],
    }
}

/// One row; nothing without outcomes.
fn row(name: &str, outcomes: &[&CaseOutcome]) -> String {
    if outcomes.is_empty() {
        return String::new();
    }
    let count = |holds: fn(&CaseOutcome) -> bool| {
        let count = outcomes.iter().filter(|o| holds(o)).count();
        format!("{count} ({:.1} %)", 100.0 * count as f64 / outcomes.len() as f64)
    };
    let mut extras: BTreeMap<&str, usize> = BTreeMap::new();
    for extra in outcomes.iter().flat_map(|o| &o.extras) {
        *extras.entry(extra).or_default() += 1;
    }
    let mut extras: Vec<(&str, usize)> = extras.into_iter().collect();
    extras.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let extras: Vec<String> = extras.into_iter().map(|(name, count)| format!("{name} ({count})")).collect();
    let promises: Vec<f64> = outcomes.iter().filter_map(|o| o.expected_error_ratio).collect();
    format!(
        "| {name} | {} | {} | {} | {:.3} N | {:.3} | {} | {} |\n",
        outcomes.len(),
        count(|o| o.exact),
        count(|o| o.exact || o.honest),
        median_of(outcomes.iter().map(|o| o.next_n[1])),
        median_of(outcomes.iter().map(|o| o.next_n[1] / o.next_n[0].max(1e-9))),
        if promises.is_empty() { String::new() } else { format!("{:.3}", median_of(promises.into_iter())) },
        extras.join("; ").replace('|', " or ")
    )
}

/// Percentage of the outcomes for which something holds, with their number.
fn share(outcomes: &[&CaseOutcome], holds: impl Fn(&CaseOutcome) -> bool) -> String {
    let count = outcomes.iter().filter(|o| holds(o)).count();
    format!("{count} of {} ({:.1} %)", outcomes.len(), 100.0 * count as f64 / outcomes.len().max(1) as f64)
}

/// How often the probability of the largest gain falls below some levels; it should as often as the level says.
fn calibration_of_p(nulls: &[&CaseOutcome]) -> String {
    let below = |level: f64| {
        let count = nulls.iter().filter(|o| o.p_value < level).count();
        format!("below {level} in {:.1} %", 100.0 * count as f64 / nulls.len().max(1) as f64)
    };
    [0.5, 0.2, 0.1, 0.05, 0.02].map(below).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::cases::study_cases;
    use pinswitch_calibration::Verdict;

    fn outcome(exact: bool, extras: &[&str]) -> CaseOutcome {
        CaseOutcome {
            verdict: Verdict::None,
            named: Vec::new(),
            fresh_n: [0.2, 0.1],
            next_n: [0.4, 0.3],
            expected_error_ratio: None,
            exact,
            honest: exact,
            open: false,
            visible: exact,
            extras: extras.iter().map(|e| (*e).to_owned()).collect(),
            covered: vec![exact],
            largest_gain: 0.0,
            p_value: 1.0,
            structure_gain: 0.0,
            across_zero: Vec::new(),
            excluded: 0,
        }
    }

    #[test]
    fn a_summary_has_a_row_for_each_group_that_was_run_and_counts_extras() {
        let mut study = Study::default();
        let mask = study_cases().into_iter().find(|c| c.group == Group::Masks);
        study.add(
            mask.unwrap(),
            vec![outcome(true, &[]), outcome(false, &["a|b", "c"]), outcome(false, &["c"])],
        );
        let text = study.groups();
        let row = "| masks | 3 | 1 (33.3 %) | 1 (33.3 %) | 0.300 N | 0.750 |  | c (2); a or b (1) |";
        assert!(text.contains(row) && text.lines().count() == 3, "{text}");
        let words = study.summary();
        assert!(words.contains("95 % intervals that hold the true size: 1 of 3"), "{words}");
        assert_eq!(words.lines().count(), 6, "{words}");
        assert!(words.contains("... of those that the session could show: 1 of 1"), "{words}");
        let mut promised = outcome(true, &[]);
        promised.expected_error_ratio = Some(1.1);
        let null = study_cases().into_iter().find(|c| c.group == Group::Nulls);
        study.add(null.unwrap(), vec![promised]);
        let row = "| no effect | 1 | 1 (100.0 %) | 1 (100.0 %) | 0.300 N | 0.750 | 1.100 |  |";
        assert!(study.groups().contains(row), "{}", study.groups());
    }
}
