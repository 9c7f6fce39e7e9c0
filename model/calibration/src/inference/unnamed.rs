//! Unattributed structure: detection, comparison with the effects, and correction by smooth shapes.

use super::fit::{Fit, fit};
use super::levels::Levels;
use super::model::Term;
use super::screening::Screen;
use super::search::{prune, search};
use super::sign_flips::family_probability;
use super::significance::{degrees_of_freedom, gain_at};
use super::structure_scores::StructureScore;
use super::weighed::Weighed;
use crate::effects::Covariate;

/// Largest probability by sign flips of a weak shape.
const MOST_BY_FLIPS: f64 = 0.05;
/// Share of an effect's gain that shapes in its place may lack and still replace it.
const REPLACED_SHARE: f64 = 0.15;

/// Structure that no effect explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundStructure {
    /// Covariate along which it shows.
    pub covariate: Covariate,
    /// Reduction of the deviance by its first shape, less the penalty for its free ends or
    /// frequency.
    pub gain: f64,
}

/// Input of every step of the comparison.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context<'a> {
    pub(super) weighed: &'a Weighed<'a>,
    pub(super) levels: Levels,
    /// Reduction of the deviance by the effects with approximate formulas.
    pub(super) explained: f64,
}

impl Context<'_> {
    /// Searches structure that no effect explains, and compares it with the effects. `left` are the
    /// scores of all structures in addition to the effects, and `bent_gain` is the gain of bending
    /// the effects.
    pub(super) fn with_unnamed(
        &self,
        baseline: &Fit,
        found: Fit,
        left: &[StructureScore],
        bent_gain: f64,
    ) -> (Fit, Option<FoundStructure>) {
        let &Context { weighed, levels, explained } = self;
        // With few series larger gains occur by chance; the level of the study applies to dozens of
        // them.
        let degrees = degrees_of_freedom(weighed.data, baseline.model.coordinates.len());
        let chance = gain_at(levels.structure_p, left.len().max(1), degrees);
        let least = levels.structure.max(chance).max(levels.structure_share * explained);
        let on_top = left
            .first()
            .filter(|score| score.gain > 3.0 * least || self.is_carried_by_many(left))
            .and_then(|score| self.on_top_of(&found, score, least));
        let alone = if found.model.terms.is_empty() {
            Vec::new()
        } else {
            Screen::new(baseline, weighed).structures()
        };
        let best = match alone.first().filter(|s| s.gain > least) {
            Some(score) => self.instead_of(baseline, &found, score, bent_gain, on_top),
            None => on_top,
        };
        let best = best.or_else(|| self.in_place_of_one(&found, bent_gain, least));
        match best {
            Some((with, structure)) => {
                let corrected = with_what_is_left(with, weighed);
                let least = levels.further.max(0.01 * (baseline.cost - corrected.cost));
                let pruned = prune(corrected, weighed, least, 0);
                (self.without_names_that_shapes_replace(pruned), Some(structure))
            }
            None => (found, None),
        }
    }

    /// Returns whether the largest score exceeds those of sign flips, which need no noise model: a
    /// weak shape that depends on a few series is not accepted. With few series, sign flips are not
    /// conclusive.
    fn is_carried_by_many(&self, scores: &[StructureScore]) -> bool {
        let carried: Vec<&[f64]> = scores.iter().map(|s| s.by_series.as_slice()).collect();
        carried.iter().all(|c| c.len() < 12) || family_probability(&carried) <= MOST_BY_FLIPS
    }

    /// Returns the structure in addition to the effects, if its gain exceeds `least`.
    fn on_top_of(&self, found: &Fit, score: &StructureScore, least: f64) -> Option<(Fit, FoundStructure)> {
        if score.gain <= least {
            return None;
        }
        let with = with_structure(found, score, self.weighed);
        let gain = found.cost - with.cost;
        (gain > least).then(|| {
            let pruned = prune(with, self.weighed, self.levels.further, 0);
            (pruned, FoundStructure { covariate: score.group[0].covariate, gain: gain - score.penalty() })
        })
    }

    /// Returns the better one of the structure alone, with effects added to it only, and of the
    /// model `so_far`.
    fn instead_of(
        &self,
        baseline: &Fit,
        found: &Fit,
        score: &StructureScore,
        bent_gain: f64,
        so_far: Option<(Fit, FoundStructure)>,
    ) -> Option<(Fit, FoundStructure)> {
        let &Context { weighed, levels, .. } = self;
        let penalty = |f: &Fit| f.cost + levels.further * f.model.named_effects().len() as f64;
        let with = with_structure(baseline, score, self.weighed);
        // One shape against several effects: each effect beyond the first must justify its
        // constants.
        let names = found.model.named_effects().len() as f64;
        // The effects may bend before a shape counts as a better fit.
        let margin = levels.outright + 0.06 * bent_gain - 12.0 * (names - 1.0);
        if with.cost >= found.cost - bent_gain - margin && so_far.is_none() {
            return so_far;
        }
        let gain = baseline.cost - with.cost;
        let extended = search(&with, weighed, levels);
        let pruned = prune(extended, weighed, levels.further, 0);
        if so_far.as_ref().is_none_or(|(b, _)| penalty(&pruned) < penalty(b)) {
            Some((
                pruned,
                FoundStructure { covariate: score.group[0].covariate, gain: gain - score.penalty() },
            ))
        } else {
            so_far
        }
    }

    /// Returns the structure that replaces one of several effects and explains more than that
    /// effect with any bend: a drag that grows with speed resembles a drag, and friction that does.
    fn in_place_of_one(&self, found: &Fit, bent_gain: f64, least: f64) -> Option<(Fit, FoundStructure)> {
        let is_name = |index: &usize| matches!(found.model.terms[*index], Term::Named(_));
        let names: Vec<usize> = (0..found.model.terms.len()).filter(is_name).collect();
        if names.len() < 2 {
            return None;
        }
        let best = names
            .into_iter()
            .filter_map(|index| {
                let without = fit(&found.model.without_term(index), self.weighed);
                let score = Screen::new(&without, self.weighed).structures().into_iter().next()?;
                let with = with_structure(&without, &score, self.weighed);
                let gain = without.cost - with.cost - score.penalty();
                let structure = FoundStructure { covariate: score.group[0].covariate, gain };
                (gain > least).then_some((with, structure))
            })
            .min_by(|a, b| a.0.cost.total_cmp(&b.0.cost))?;
        (best.0.cost < found.cost - bent_gain - self.levels.outright).then_some(best)
    }

    /// With unattributed structure in the model, keeps an effect only if more shapes cannot replace
    /// it, since it may be another part of the same structure.
    fn without_names_that_shapes_replace(&self, mut current: Fit) -> Fit {
        let mut index = 0;
        while index < current.model.terms.len() {
            if matches!(current.model.terms[index], Term::Named(_)) {
                let without = fit(&current.model.without_term(index), self.weighed);
                let gain = without.cost - current.cost;
                let bare = with_what_is_left(without, self.weighed);
                if bare.cost - current.cost < self.levels.further.max(REPLACED_SHARE * gain) {
                    current = bare;
                    index = 0;
                    continue;
                }
            }
            index += 1;
        }
        current
    }
}

/// Adds shapes while each gains clearly.
pub(crate) fn with_what_is_left(mut current: Fit, weighed: &Weighed<'_>) -> Fit {
    for _ in 0..4 {
        let scores = Screen::new(&current, weighed).structures();
        let Some(score) = scores.first().filter(|s| s.gain > 30.0) else { break };
        let with = with_structure(&current, score, weighed);
        if current.cost - with.cost < 25.0 {
            break;
        }
        current = with;
    }
    current
}

/// Adds a structure's shapes to a model and fits.
pub(super) fn with_structure(from: &Fit, score: &StructureScore, weighed: &Weighed<'_>) -> Fit {
    let model = score
        .group
        .iter()
        .zip(&score.sizes)
        .fold(from.model.clone(), |m, (s, k)| m.with_term(Term::Structure(s.clone()), &[*k]));
    fit(&model, weighed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Channel, Shape, Structure};
    use crate::inference::{Model, Noise, Observations, select};
    use crate::table::Frame;
    use crate::test_session::{session, session_with};

    fn wave() -> Term {
        let form = Shape::PositionWave { cycles: 3.0, quarter: 0 };
        Term::Structure(Structure { covariate: Covariate::Position, channel: Channel::Friction, form })
    }

    #[test]
    fn waves_along_the_stroke_are_unattributed() {
        let rows = session_with(2, &[(wave(), &[0.15])]);
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        let found = select(&Model::baseline(frame), &mut data, Levels::default());
        assert_eq!(found.structure.map(|s| s.covariate), Some(Covariate::Position));
        assert!(found.effects.is_empty(), "{:?}", found.effects);
        assert!(found.augmented.cost < 0.5 * found.baseline.cost, "the shapes correct most of it");
    }

    #[test]
    fn structures_must_exceed_chance() {
        let rows = session(1);
        let frame = Frame::new(&rows);
        let data = Observations::new(&frame, &rows).unwrap();
        let weighed = &Weighed::new(&data, Noise::constant(0.05, 0.01));
        let context = Context { weighed, levels: Levels::default(), explained: 0.0 };
        let baseline = fit(&Model::baseline(frame), weighed);
        let scores = Screen::new(&baseline, weighed).structures();
        let best = &scores[0];
        assert!(context.on_top_of(&baseline, best, best.gain + 1.0).is_none());
        let (_, structure) = context.on_top_of(&baseline, best, 0.5 * best.gain).unwrap();
        assert_eq!(structure.covariate, best.group[0].covariate);
        for penalty in [0.0, 8.0, 15.0] {
            let score = scores.iter().find(|s| s.penalty() == penalty).unwrap();
            let (_, structure) = context.on_top_of(&baseline, score, -1e6).unwrap();
            let fitted = with_structure(&baseline, score, weighed);
            assert!((baseline.cost - fitted.cost - penalty - structure.gain).abs() < 1e-9, "{score:?}");
        }
        let (kept, none) = context.with_unnamed(&baseline, baseline.clone(), &scores, 0.0);
        assert!(none.is_none() && kept.model.terms.is_empty(), "noise alone is not structure");
    }
}
