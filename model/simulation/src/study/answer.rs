//! Comparison of the calibrator's answer with the truth.

use pinswitch_calibration::effects::{Covariate, UNATTRIBUTED};
use pinswitch_calibration::{EffectReport, Report, Verdict};

use super::case::{Case, Truth};
use crate::plan::Plan;

/// Reported effect with its rivals, or unattributed structure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answer {
    /// Id, followed by those of its rivals.
    pub(super) names: Vec<String>,
    /// Covariate of unattributed structure.
    pub(super) structure: Option<Covariate>,
}

impl Answer {
    fn new(effect: &EffectReport) -> Self {
        let names = std::iter::once(&effect.id).chain(effect.rivals.iter().map(|rival| &rival.id));
        // Structure over a factor of the protocol, such as the mount, counts as one over the condition.
        let covariate = || Covariate::ALL.into_iter().find(|c| c.as_str() == effect.covariate);
        let structure = (effect.id == UNATTRIBUTED).then(|| covariate().unwrap_or(Covariate::Condition));
        Self { names: names.cloned().collect(), structure }
    }

    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }

    /// Returns the names as text: `a|b` for rivals, `unattributed:covariate` for structure.
    pub(super) fn text(&self) -> String {
        match self.structure {
            Some(covariate) => {
                let rivals = self.names.iter().skip(1).map(|name| format!("|{name}"));
                format!("{UNATTRIBUTED}:{}{}", covariate.as_str(), rivals.collect::<String>())
            }
            None => self.names.join("|"),
        }
    }
}

/// Answer of the calibrator for a rig.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CalibratorAnswer {
    /// Reported effects and structure.
    pub(super) parts: Vec<Answer>,
    /// Verdict.
    pub(super) verdict: Verdict,
}

impl CalibratorAnswer {
    pub(super) fn new(report: &Report) -> Self {
        Self { parts: report.effects.iter().map(Answer::new).collect(), verdict: report.verdict }
    }

    /// Returns whether the answer is exact, and whether it is consistent with the truth.
    pub(super) fn grade(&self, case: &Case, plan: &Plan) -> (bool, bool) {
        match &case.truth {
            Truth::Nothing => {
                // Mount effects are noise, but they are structure over the condition.
                let is_mount = |part: &Answer| {
                    plan.noise.mount_scale > 0.0 && part.structure == Some(Covariate::Condition)
                };
                (self.parts.is_empty(), self.parts.iter().all(is_mount))
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
                let both = self.parts.iter().any(|part| part.has(id) && part.has(rival));
                let right = self.matches(&[id]) && both || self.verdict == Verdict::Inconclusive;
                (right, right)
            }
            Truth::Outside { covariates, or_named } => {
                let is_right = |part: &Answer| part.structure.is_some_and(|c| covariates.contains(&c));
                let right = self.parts.iter().any(is_right);
                let named = or_named.is_some_and(|name| self.matches(&[name]));
                (right && self.parts.iter().all(is_right) || named, right || named)
            }
        }
    }

    /// Returns the false parts of the answer.
    pub(super) fn extras(&self, case: &Case) -> Vec<String> {
        self.parts.iter().filter(|part| !is_true(part, &case.truth)).map(Answer::text).collect()
    }

    /// Whether every true effect is reported or a rival, and every part of the answer contains a true
    /// effect.
    fn matches(&self, truth: &[&str]) -> bool {
        self.parts.iter().all(|part| truth.iter().any(|t| part.has(t)))
            && truth.iter().all(|t| self.parts.iter().any(|part| part.has(t)))
    }
}

/// Whether a part of the answer contains a true effect, or is structure over a true covariate.
fn is_true(part: &Answer, truth: &Truth) -> bool {
    match truth {
        Truth::Nothing => false,
        Truth::Effects(ids) | Truth::Confounded(ids) => ids.iter().any(|id| part.has(id)),
        Truth::SmallConfounded(both) => both.iter().any(|id| part.has(id)),
        Truth::Outside { covariates, or_named } => {
            or_named.is_some_and(|name| part.has(name))
                || part.structure.is_some_and(|c| covariates.contains(&c))
        }
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
        let part = |names: &[&str], structure| Answer {
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            structure,
        };
        let mut parts: Vec<Answer> = sets.iter().map(|set| part(set, None)).collect();
        parts.extend(covariate.map(|covariate| part(&[UNATTRIBUTED], Some(covariate))));
        let answer = CalibratorAnswer { parts, verdict };
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
