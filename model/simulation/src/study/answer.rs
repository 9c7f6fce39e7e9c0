//! Whether what the calibrator said of a rig is true of it.

use pinswitch_calibration::Verdict;
use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::inference::UNATTRIBUTED;

use super::case::{Case, Truth};
use crate::plan::Plan;

/// What the calibrator said of one rig.
pub(super) struct CalibratorAnswer<'a> {
    /// The effects named, each with its rivals.
    pub(super) sets: &'a [Vec<&'a str>],
    /// Where structure lies that has no name.
    pub(super) place: Option<Covariate>,
    /// The verdict.
    pub(super) verdict: Verdict,
}

impl CalibratorAnswer<'_> {
    /// Whether it is the right answer, and whether it is an honest one.
    pub(super) fn grade(&self, case: &Case, plan: &Plan) -> (bool, bool) {
        match &case.truth {
            Truth::Nothing => {
                let silent = self.sets.is_empty() && self.place.is_none();
                // Mounts that differ are seen by their conditions; they are noise, and they are there.
                let mounts = plan.noise.mount_scale > 0.0 && self.place == Some(Covariate::Condition);
                (silent, silent || mounts && self.sets.is_empty())
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
                let right = self.place.is_some_and(|place| covariates.contains(&place));
                let named = or_named.is_some_and(|name| self.matches(&[name]));
                (right && self.sets.is_empty() || named, right || named)
            }
        }
    }

    /// What it said beside the truth.
    pub(super) fn extras(&self, case: &Case) -> Vec<String> {
        let (true_names, places): (Vec<&str>, &[Covariate]) = match &case.truth {
            Truth::Nothing => (Vec::new(), &[]),
            Truth::Effects(ids) | Truth::Confounded(ids) => (ids.clone(), &[]),
            Truth::SmallConfounded(both) => (both.to_vec(), &[]),
            Truth::Outside { covariates, or_named } => (or_named.iter().copied().collect(), covariates),
        };
        let beside = self.sets.iter().filter(|set| !true_names.iter().any(|t| set.contains(t)));
        let mut extras: Vec<String> = beside.map(|set| set.join("|")).collect();
        let place = self.place.filter(|place| !places.contains(place));
        extras.extend(place.map(|place| format!("{UNATTRIBUTED}:{}", place.as_str())));
        extras
    }

    /// Whether every one of these is named or among the rivals, and nothing else stands alone.
    fn matches(&self, truth: &[&str]) -> bool {
        self.place.is_none()
            && self.sets.iter().all(|s| truth.iter().any(|t| s.contains(t)))
            && truth.iter().all(|t| self.sets.iter().any(|s| s.contains(t)))
    }

    /// Whether the verdict is one that names nothing and excludes nothing.
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

    fn graded(truth: Truth, sets: &[Vec<&str>], place: Option<Covariate>) -> ((bool, bool), Vec<String>) {
        let case = Case {
            name: String::new(),
            protocol: Protocol::Paper,
            group: Group::Masks,
            truth,
            every_noise: false,
        };
        let verdict = match (sets, place) {
            (_, Some(_)) => Verdict::Unattributed,
            ([], None) => Verdict::None,
            (sets, None) if sets.iter().any(|s| s.len() > 1) => Verdict::Ambiguous,
            _ => Verdict::Attributed,
        };
        let answer = CalibratorAnswer { sets, place, verdict };
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
    fn what_is_said_beside_the_truth_is_an_extra() {
        let truth = || Truth::Effects(vec!["guide_drag", "load_cell_gain"]);
        let right = [vec!["guide_drag"], vec!["load_cell_gain"]];
        assert_eq!(graded(truth(), &right, None), ((true, true), vec![]));
        let more = [right.to_vec(), vec![vec!["run_in", "adhesion"]]].concat();
        let extras = vec!["run_in|adhesion".to_owned(), "unattributed:time".to_owned()];
        assert_eq!(graded(truth(), &more, Some(Covariate::Time)), ((false, false), extras));
    }

    #[test]
    fn any_of_the_covariates_is_right_and_so_is_the_other_name() {
        let truth =
            |or_named| Truth::Outside { covariates: &[Covariate::Load, Covariate::Repetition], or_named };
        for place in [Covariate::Load, Covariate::Repetition] {
            assert_eq!(graded(truth(None), &[], Some(place)), ((true, true), vec![]));
        }
        let elsewhere = graded(truth(None), &[], Some(Covariate::Time));
        assert_eq!(elsewhere, ((false, false), vec!["unattributed:time".to_owned()]));
        let beside = graded(truth(None), &[vec!["run_in"]], Some(Covariate::Load));
        assert_eq!(beside, ((false, true), vec!["run_in".to_owned()]));
        let offset = [vec!["load_cell_offset"]];
        assert_eq!(graded(truth(Some("load_cell_offset")), &offset, None), ((true, true), vec![]));
        assert_eq!(graded(truth(None), &offset, None).0, (false, false));
    }

    #[test]
    fn mounts_that_differ_may_be_told_by_their_conditions() {
        assert_eq!(graded(Truth::Nothing, &[], None).0, (true, true));
        assert_eq!(graded(Truth::Nothing, &[], Some(Covariate::Condition)).0, (false, true));
        assert_eq!(graded(Truth::Nothing, &[], Some(Covariate::Time)).0, (false, false));
    }
}
