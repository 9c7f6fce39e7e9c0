//! The figures that a calibrator is judged by: a row for each group of rigs, and the same in words.

use std::collections::BTreeMap;

use super::case::{Case, Group};
use super::case_study::Study;
use super::figures::median_of;
use super::forecast::{Forecast, reliability_table};
use super::outcome::CaseOutcome;

impl Study {
    /// Returns a row for each group, and one for each kind of rig without effect, in Markdown.
    pub fn groups(&self) -> String {
        let mut text = String::from(
            "| group | sets | exact | consistent | error on the next session | after/before | expected/actual | false parts |\n|---|---|---|---|---|---|---|---|\n",
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

    /// Returns the main figures of every group with outcomes, one per line.
    pub fn summary(&self) -> String {
        let mut lines = Vec::new();
        for group in Group::ALL {
            let outcomes = self.of(|case| case.group == group);
            if !outcomes.is_empty() {
                lines.extend(group_lines(group, &outcomes));
            }
        }
        let all = self.of(|_| true);
        let mut shares = |what: &str, of: &dyn Fn(&CaseOutcome) -> Vec<bool>| {
            let flags: Vec<bool> = all.iter().flat_map(|outcome| of(outcome)).collect();
            if !flags.is_empty() {
                lines.push(format!("{what}: {}", share(&flags, |flag| *flag)));
            }
        };
        shares("95 % intervals that contain the true size", &|o| o.covered.clone());
        shares("90 % intervals that contain the error on the next session", &|o| {
            o.is_error_covered.into_iter().collect()
        });
        let mut ratios: Vec<f64> = all.iter().filter_map(|o| o.expected_error_ratio).collect();
        ratios.sort_by(f64::total_cmp);
        if !ratios.is_empty() {
            let quantile = |percent: usize| ratios[percent * (ratios.len() - 1) / 100];
            lines.push(format!(
                "expected error of a new session over the actual one: median {:.3}, 10 to 90 % {:.3} to {:.3}",
                median_of(ratios.iter().copied()),
                quantile(10),
                quantile(90)
            ));
        }
        lines.iter().map(|l| format!("- {l}\n")).collect()
    }

    /// Returns the reliability of the probabilities of effects, in Markdown.
    pub fn reliability(&self) -> String {
        let all = self.of(|_| true);
        let reported: Vec<Forecast> = all.iter().flat_map(|o| o.reported.iter().copied()).collect();
        let candidates: Vec<Forecast> = all.iter().flat_map(|o| o.candidates.iter().copied()).collect();
        let kinds = ["reported effects and structure", "all effects of the vocabulary"];
        reliability_table("posterior probability", kinds, [&reported, &candidates])
    }

    /// Returns the outcomes of the selected kinds.
    fn of(&self, wanted: impl Fn(&Case) -> bool) -> Vec<&CaseOutcome> {
        self.outcomes.iter().filter(|(case, _)| wanted(case)).flat_map(|(_, outcomes)| outcomes).collect()
    }
}

/// Returns the main figures of a group.
fn group_lines(group: Group, outcomes: &[&CaseOutcome]) -> Vec<String> {
    let (exact, consistent) = (share(outcomes, |o| o.exact), share(outcomes, |o| o.exact || o.consistent));
    let visible: Vec<&CaseOutcome> = outcomes.iter().filter(|o| o.visible).copied().collect();
    let attributed = |what: &str| {
        vec![
            format!("{what} attributed exactly: {exact}"),
            format!("... of the visible ones: {}", share(&visible, |o| o.exact)),
            format!("{what} attributed or among the rivals: {consistent}"),
            format!("... of the visible ones: {}", share(&visible, |o| o.exact || o.consistent)),
            format!(
                "... or left open (within the reported limits, or reported as invisible): {}",
                share(outcomes, |o| o.exact || o.consistent || o.left_open)
            ),
        ]
    };
    let without_effect =
        |what: &str| vec![format!("{what}, false alarms: {}", share(outcomes, |o| !o.exact))];
    let outside = |what: &str| {
        vec![
            format!("{what}, unattributed with the right covariate: {consistent}"),
            format!(
                "... of those that are visible despite mount effects: {}",
                share(&visible, |o| o.exact || o.consistent)
            ),
            format!("{what}, and no effect reported: {exact}"),
        ]
    };
    match group {
        Group::Nulls => without_effect("rigs without effect"),
        Group::BenchNulls => without_effect("small bench without effect"),
        Group::Singles => {
            let mut lines = attributed("single effects");
            let ratio = median_of(outcomes.iter().map(|o| o.fresh_n[1] / o.fresh_n[0].max(1e-9)));
            lines.push(format!("single effects, median error on noise-free rows after/before: {ratio:.3}"));
            lines
        }
        Group::Scattered => attributed("single effects with scatter"),
        Group::BenchSingles => attributed("single effects on the small bench"),
        Group::Pairs => attributed("pairs"),
        Group::BenchPairs => attributed("pairs on the small bench"),
        Group::Masks => attributed("effects with a drag that may mask them"),
        Group::Confounded => vec![
            format!("confounded effects, ambiguous (or inconclusive if small): {exact}"),
            format!("confounded effects, attributed or among the rivals: {consistent}"),
        ],
        Group::Outside => outside("outside the vocabulary"),
        Group::BenchOutside => outside("outside the vocabulary on the small bench"),
    }
}

/// Returns a row of the table; empty without outcomes.
fn row(name: &str, outcomes: &[&CaseOutcome]) -> String {
    if outcomes.is_empty() {
        return String::new();
    }
    let count = |predicate: fn(&CaseOutcome) -> bool| {
        let count = outcomes.iter().filter(|o| predicate(o)).count();
        format!("{count} ({:.1} %)", 100.0 * count as f64 / outcomes.len() as f64)
    };
    let mut extras: BTreeMap<&str, usize> = BTreeMap::new();
    for extra in outcomes.iter().flat_map(|o| &o.extras) {
        *extras.entry(extra).or_default() += 1;
    }
    let mut extras: Vec<(&str, usize)> = extras.into_iter().collect();
    extras.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let extras: Vec<String> = extras.into_iter().map(|(name, count)| format!("{name} ({count})")).collect();
    let ratios: Vec<f64> = outcomes.iter().filter_map(|o| o.expected_error_ratio).collect();
    format!(
        "| {name} | {} | {} | {} | {:.3} N | {:.3} | {} | {} |\n",
        outcomes.len(),
        count(|o| o.exact),
        count(|o| o.exact || o.consistent),
        median_of(outcomes.iter().map(|o| o.next_n[1])),
        median_of(outcomes.iter().map(|o| o.next_n[1] / o.next_n[0].max(1e-9))),
        if ratios.is_empty() { String::new() } else { format!("{:.3}", median_of(ratios.into_iter())) },
        extras.join("; ").replace('|', " or ")
    )
}

/// Returns number and percentage of the outcomes that satisfy a predicate, as text.
fn share<T>(outcomes: &[T], predicate: impl Fn(&T) -> bool) -> String {
    let count = outcomes.iter().filter(|o| predicate(o)).count();
    format!("{count} of {} ({:.1} %)", outcomes.len(), 100.0 * count as f64 / outcomes.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::cases::study_cases;
    use pinswitch_calibration::Verdict;

    fn outcome(exact: bool, extras: &[&str]) -> CaseOutcome {
        CaseOutcome {
            seed: 1,
            verdict: Verdict::None,
            named: Vec::new(),
            fresh_n: [0.2, 0.1],
            next_n: [0.4, 0.3],
            expected_error_ratio: None,
            exact,
            consistent: exact,
            left_open: false,
            visible: exact,
            extras: extras.iter().map(|e| (*e).to_owned()).collect(),
            covered: vec![exact],
            is_error_covered: None,
            reported: Vec::new(),
            candidates: Vec::new(),
            bad_series: 0,
        }
    }

    #[test]
    fn every_group_has_a_row() {
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
        assert!(words.contains("95 % intervals that contain the true size: 1 of 3"), "{words}");
        assert_eq!(words.lines().count(), 6, "{words}");
        assert!(words.contains("... of the visible ones: 1 of 1"), "{words}");
        let mut with_ratio = outcome(true, &[]);
        with_ratio.expected_error_ratio = Some(1.1);
        let null = study_cases().into_iter().find(|c| c.group == Group::Nulls);
        study.add(null.unwrap(), vec![with_ratio]);
        let row = "| no effect | 1 | 1 (100.0 %) | 1 (100.0 %) | 0.300 N | 0.750 | 1.100 |  |";
        assert!(study.groups().contains(row), "{}", study.groups());
    }
}
