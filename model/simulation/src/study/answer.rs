//! Comparison of the calibrator's answer with the truth.

use pinswitch_calibration::Verdict;
use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::inference::UNATTRIBUTED;

use super::case::{Case, Truth};
use crate::plan::Plan;

/// Answer of the calibrator for a rig.
pub(super) struct CalibratorAnswer<'a> {
    /// Reported effects, each with its rivals.
    pub(super) sets: &'a [Vec<&'a str>],
    /// Covariate of unattributed structure.
    pub(super) covariate: Option<Covariate>,
    /// Verdict.
    pub(super) verdict: Verdict,
}

impl CalibratorAnswer<'_> {
    /// Returns whether the answer is exact, and whether it is consistent with the truth.
    pub(super) fn grade(&self, case: &Case, plan: &Plan) -> (bool, bool) {
        match &case.truth {
            Truth::Nothing => {
                let is_empty = self.sets.is_empty() && self.covariate.is_none();
                // Mount effects are noise, but they are structure over the condition.
                let mounts = plan.noise.mount_scale > 0.0 && self.covariate == Some(Covariate::Condition);
                (is_empty, is_empty || mounts && self.sets.is_empty())
            }
            Truth::Effects(ids) => {
                let matches = self.matches(ids);
                (matches && self.verdict == Verdict::Attributed, matches)
            }
            Truth::Confounded(ids) => {
                let matches = self.matches(ids);
                (matches && self.verdict == Verdict::Ambiguous, matches)
            }
            Truth::SmallConfounded([id, rival]) => {
                let both = self.sets.iter().any(|s| s.contains(id) && s.contains(rival));
                let right = self.matches(&[id]) && both || self.is_inconclusive();
                (right, right)
            }
            Truth::Outside { covariates, or_named } => {
                let right = self.covariate.is_some_and(|covariate| covariates.contains(&covariate));
                let named = or_named.is_some_and(|name| self.matches(&[name]));
                (right && self.sets.is_empty() || named, right || named)
            }
        }
    }

    /// Returns the false parts of the answer.
    pub(super) fn extras(&self, case: &Case) -> Vec<String> {
        let (true_names, true_covariates): (Vec<&str>, &[Covariate]) = match &case.truth {
            Truth::Nothing => (Vec::new(), &[]),
            Truth::Effects(ids) | Truth::Confounded(ids) => (ids.clone(), &[]),
            Truth::SmallConfounded(both) => (both.to_vec(), &[]),
            Truth::Outside { covariates, or_named } => (or_named.iter().copied().collect(), covariates),
        };
        let false_sets = self.sets.iter().filter(|set| !true_names.iter().any(|t| set.contains(t)));
        let mut extras: Vec<String> = false_sets.map(|set| set.join("|")).collect();
        let covariate = self.covariate.filter(|covariate| !true_covariates.contains(covariate));
        extras.extend(covariate.map(|covariate| format!("{UNATTRIBUTED}:{}", covariate.as_str())));
        extras
    }

    /// Whether every true effect is reported or a rival, and every reported set contains a true
    /// effect.
    fn matches(&self, truth: &[&str]) -> bool {
        self.covariate.is_none()
            && self.sets.iter().all(|s| truth.iter().any(|t| s.contains(t)))
            && truth.iter().all(|t| self.sets.iter().any(|s| s.contains(t)))
    }

    /// Whether the verdict reports no effect and excludes none.
    fn is_inconclusive(&self) -> bool {
        !matches!(
            self.verdict,
            Verdict::None | Verdict::Attributed | Verdict::Ambiguous | Verdict::Unattributed
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Protocol;
    use crate::study::case::Group;

    fn graded(truth: Truth, sets: &[Vec<&str>], covariate: Option<Covariate>) -> ((bool, bool), Vec<String>) {
        let case = Case {
            name: String::new(),
            protocol: Protocol::Paper,
            group: Group::Masks,
            truth,
            every_noise: false,
        };
        let verdict = match (sets, covariate) {
            (_, Some(_)) => Verdict::Unattributed,
            ([], None) => Verdict::None,
            (sets, None) if sets.iter().any(|s| s.len() > 1) => Verdict::Ambiguous,
            _ => Verdict::Attributed,
        };
        let answer = CalibratorAnswer { sets, covariate, verdict };
        let mut plan = Plan::default();
        plan.noise.mount_scale = 0.02;
        (answer.grade(&case, &plan), answer.extras(&case))
    }

    #[test]
    fn small_confounded_effects_need_both_names() {
        let truth = || Truth::SmallConfounded(["rate_dependence", "fixture_compliance"]);
        let both = vec!["rate_dependence", "fixture_compliance"];
        assert_eq!(graded(truth(), &[both], None), ((true, true), vec![]));
        assert_eq!(graded(truth(), &[], None).0, (false, false));
        assert_eq!(graded(truth(), &[vec!["rate_dependence"]], None).0, (false, false));
    }

    #[test]
    fn false_parts_are_extras() {
        let truth = || Truth::Effects(vec!["guide_drag", "load_cell_gain"]);
        let right = [vec!["guide_drag"], vec!["load_cell_gain"]];
        assert_eq!(graded(truth(), &right, None), ((true, true), vec![]));
        let more = [right.to_vec(), vec![vec!["run_in", "adhesion"]]].concat();
        let extras = vec!["run_in|adhesion".to_owned(), "unattributed:time".to_owned()];
        assert_eq!(graded(truth(), &more, Some(Covariate::Time)), ((false, false), extras));
    }

    #[test]
    fn alternative_answers_are_exact() {
        let truth =
            |or_named| Truth::Outside { covariates: &[Covariate::Load, Covariate::Repetition], or_named };
        for covariate in [Covariate::Load, Covariate::Repetition] {
            assert_eq!(graded(truth(None), &[], Some(covariate)), ((true, true), vec![]));
        }
        let elsewhere = graded(truth(None), &[], Some(Covariate::Time));
        assert_eq!(elsewhere, ((false, false), vec!["unattributed:time".to_owned()]));
        let extra = graded(truth(None), &[vec!["run_in"]], Some(Covariate::Load));
        assert_eq!(extra, ((false, true), vec!["run_in".to_owned()]));
        let offset = [vec!["load_cell_offset"]];
        assert_eq!(graded(truth(Some("load_cell_offset")), &offset, None), ((true, true), vec![]));
        assert_eq!(graded(truth(None), &offset, None).0, (false, false));
    }

    #[test]
    fn mount_effects_match_conditions() {
        assert_eq!(graded(Truth::Nothing, &[], None).0, (true, true));
        assert_eq!(graded(Truth::Nothing, &[], Some(Covariate::Condition)).0, (false, true));
        assert_eq!(graded(Truth::Nothing, &[], Some(Covariate::Time)).0, (false, false));
    }
}
