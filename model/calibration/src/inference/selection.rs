//! Selection of the effects of a table, their rivals, and unattributed structure.

use super::against_scatter::against_scatter;
use super::baseline::{explainable, fit_baseline};
use super::changes::choose;
use super::explanation::{Explanation, explain};
use super::fit::{Fit, fit, interval_half_widths, jacobian};
use super::levels::Levels;
use super::limits::{SizeLimit, classes, limits};
use super::model::{Model, Term};
use super::noise::Noise;
use super::observations::Observations;
use super::reliability::{NoiseFactors, Reliability};
use super::rivals::{candidates, found_effects};
use super::screening::Screen;
use super::search::{VISIBLE_SHARE, flips};
use super::unnamed::FoundStructure;
use super::variance_components::estimate;
use super::weighed::Weighed;
use crate::effects::{Effect, Vocabulary};

/// An effect that explains the data as well as one of the model.
#[derive(Clone, Debug)]
pub struct Rival {
    /// The rival.
    pub effect: &'static dyn Effect,
    /// Increase of the deviance in its place.
    pub worse_by: f64,
    /// Cosine between the two sensitivities after the refit.
    pub cosine: f64,
}

/// An effect of the augmented model.
#[derive(Clone, Debug)]
pub struct FoundEffect {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Index of its term in the augmented model.
    pub term: usize,
    /// Reduction of the deviance given all other terms.
    pub gain: f64,
    /// Effects that explain as much in its place, the strongest first.
    pub rivals: Vec<Rival>,
}

impl FoundEffect {
    /// Returns the ids of the effect and its rivals, sorted.
    pub fn ids(&self) -> Vec<&'static str> {
        let mut ids: Vec<_> =
            std::iter::once(self.effect.id()).chain(self.rivals.iter().map(|r| r.effect.id())).collect();
        ids.sort_unstable();
        ids
    }
}

/// An effect of the catalogue as a candidate.
#[derive(Clone, Debug)]
pub struct CandidateEffect {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Reduction of the deviance over the baseline if added alone, to first order.
    pub gain: f64,
    /// Reduction of the deviance on top of the final model; `None` for effects of the model.
    pub gain_left: Option<f64>,
    /// Share of its trace that the refitted baseline cannot absorb, 0..1.
    pub visible_share: f64,
    /// Norm of its projected trace at a typical size, in standard deviations.
    pub strength: f64,
}

impl CandidateEffect {
    /// Strength in standard deviations at a typical size below which an effect is not identifiable.
    pub const MIN_STRENGTH: f64 = 4.0;

    /// Returns whether it is not identifiable at a typical size.
    pub fn is_invisible(&self) -> bool {
        self.is_taken_over() || self.strength < Self::MIN_STRENGTH
    }

    /// Returns whether the refitted baseline absorbs its trace.
    pub fn is_taken_over(&self) -> bool {
        self.visible_share < VISIBLE_SHARE
    }
}

/// Result of the search.
#[derive(Clone, Debug)]
pub struct Selection {
    /// The refitted model of the paper.
    pub baseline: Fit,
    /// The model with all terms.
    pub augmented: Fit,
    /// Effects of the model, in the order of its terms.
    pub effects: Vec<FoundEffect>,
    /// Unattributed structure, if there is any.
    pub structure: Option<FoundStructure>,
    /// All effects of the catalogue, by descending gain.
    pub candidates: Vec<CandidateEffect>,
    /// Sizes that the data do not exclude, of identifiable effects that are not in the model.
    pub limits: Vec<SizeLimit>,
    /// The same for effects that are not identifiable at a typical size.
    pub hidden_limits: Vec<SizeLimit>,
    /// Classes of identifiable effects that this design cannot separate.
    pub classes: Vec<Vec<&'static str>>,
    /// Probability of the largest gain without any effect, by sign flips of whole series.
    pub family_probability: f64,
    /// Reduction of the deviance by the best structure in addition to the model.
    pub structure_gain: f64,
    /// Number of structures tried.
    pub structures_tried: usize,
    /// The noise.
    pub noise: Noise,
    /// Uncertainty of its components.
    pub noise_factors: NoiseFactors,
}

impl Selection {
    /// Reverts to the baseline, because the terms did not reduce the error on held-out data.
    #[must_use]
    pub fn without_findings(self, data: &Observations, levels: Levels) -> Self {
        let baseline = self.baseline.clone();
        self.with_names(baseline, data, levels)
    }

    /// Returns the selection with the effects of a fit, and without structure.
    #[must_use]
    pub(crate) fn with_names(self, named: Fit, data: &Observations, levels: Levels) -> Self {
        let bare = Explanation {
            named: named.model.clone(),
            augmented: named,
            baseline: self.baseline,
            structure: None,
            structure_gain: self.structure_gain,
            structures_tried: self.structures_tried,
            noise: self.noise,
            isolated: None,
        };
        finish(bare, data, levels)
    }

    /// Returns the selection for another vocabulary that contains all its effects.
    #[must_use]
    pub(crate) fn told_among(self, vocabulary: &Vocabulary, data: &Observations, levels: Levels) -> Self {
        if *vocabulary == self.augmented.model.vocabulary {
            return self;
        }
        let among = |fitted: Fit| Fit { model: fitted.model.among(vocabulary), ..fitted };
        let augmented = among(self.augmented);
        let same = Explanation {
            named: augmented.model.clone(),
            augmented,
            baseline: among(self.baseline),
            structure: self.structure,
            structure_gain: self.structure_gain,
            structures_tried: self.structures_tried,
            noise: self.noise,
            isolated: None,
        };
        finish(same, data, levels)
    }

    /// Returns the effects that are not identifiable with this table, in the order in which they
    /// act.
    pub fn invisible(&self) -> impl Iterator<Item = &CandidateEffect> {
        let vocabulary = &self.baseline.model.vocabulary;
        vocabulary
            .acting_order()
            .iter()
            .filter_map(|e| self.candidates.iter().find(|c| c.effect.id() == e.id()))
            .filter(|c| c.is_invisible())
    }
}

/// Runs the whole search on a table. A series with a gross error is excluded, and the search is
/// repeated.
pub fn select(start: &Model, data: &mut Observations, levels: Levels) -> Selection {
    let chosen = choose(start, data, levels);
    finish(chosen, data, levels)
}

/// Returns the model of the search, its noise, and its structure, without the rest of the
/// selection.
pub(crate) fn selected_model(
    start: &Model,
    data: &mut Observations,
    levels: Levels,
) -> (Model, Noise, Option<FoundStructure>) {
    let chosen = choose(start, data, levels);
    let weighed = Weighed::new(data, chosen.noise);
    (without_uncertain_names(chosen.augmented, &weighed).model, chosen.noise, chosen.structure)
}

/// Returns the explanation of a table with the constants of its model.
pub(super) fn explained(start: &Model, data: &mut Observations, levels: Levels) -> Explanation {
    let guess = Noise::constant(0.1, 0.03);
    let rough = fit(start, &Weighed::new(data, guess));
    let sd = data.weigh_outliers(&rough.residual_n);
    let guess = Noise::constant(sd, sd);
    // The first fit includes absurd readings; the next one determines the friction.
    let rough = fit_baseline(&rough.model, &Weighed::new(data, guess));
    data.friction_n = rough.model.friction_n(&data.points);
    let mut is_known = false;
    loop {
        let rough = fit_baseline(&rough.model, &Weighed::new(data, guess));
        let noise = estimate(data, &rough.residual_n, &explainable(&rough, data), guess);
        let free = explain(&rough.model, data, noise, levels);
        if let Some(series) = free.isolated {
            data.exclude(series);
            continue;
        }
        // A drag that the baseline absorbed in friction does not scale with the tendon seating.
        let friction_n = free.augmented.model.friction_n(&data.points);
        if !is_known && departs(&friction_n, &data.friction_n) {
            data.friction_n = friction_n;
            is_known = true;
            continue;
        }
        return against_scatter(free, data, levels);
    }
}

/// Difference of two traces of friction, as a share of their norm, above which their scatter
/// differs.
const ANOTHER_FRICTION: f64 = 0.1;

fn departs(now: &[f64], before: &[f64]) -> bool {
    let (mut apart, mut length) = (0.0, 0.0);
    for (a, b) in now.iter().zip(before) {
        apart += (a - b).powi(2);
        length += b * b;
    }
    apart > ANOTHER_FRICTION.powi(2) * length
}

/// Removes effects whose sizes are compatible with zero or have an impossible sign, since shapes
/// added later may have reversed them.
fn without_uncertain_names(mut current: Fit, weighed: &Weighed<'_>) -> Fit {
    while let Some(index) = uncertain_name(&current, weighed) {
        current = as_claimed(&current, index, weighed)
            .unwrap_or_else(|| fit(&current.model.without_term(index), weighed));
    }
    current
}

/// Returns the index of an effect whose size is compatible with zero or has an impossible sign.
fn uncertain_name(fitted: &Fit, weighed: &Weighed<'_>) -> Option<usize> {
    let (values, widths) = (fitted.model.values(), interval_half_widths(fitted, weighed));
    (0..fitted.model.terms.len()).find(|index| {
        let at = fitted.model.term_offset(*index);
        let Term::Named(effect) = &fitted.model.terms[*index] else { return false };
        let free = effect.parameters().first().is_some_and(|p| p.bounds.is_none());
        let is_turned = effect.description().one_sided && values[at] <= 0.0;
        free && effect.description().scales && (values[at].abs() <= widths[at] || is_turned)
    })
}

/// Increase of the deviance, absolute and as a share of the gain, by which a hypothesis may be
/// worse than the same effect with free shapes.
const AS_CLAIMED: (f64, f64) = (9.0, 0.1);

/// Fixes the shapes of a user-defined effect at their start values: a table may not locate a bump
/// between two readings, on which its height depends, although its presence is certain. `None` if
/// the hypothesis does not explain the effect.
fn as_claimed(fitted: &Fit, index: usize, weighed: &Weighed<'_>) -> Option<Fit> {
    let Term::Named(effect) = &fitted.model.terms[index] else { return None };
    let model = &fitted.model;
    let own = model.vocabulary.own().find(|own| own.definition().id == effect.id())?;
    let last = model.term_offset(index) + own.definition().parameters.len() - 1;
    if model.is_held(last) {
        return None;
    }
    let claimed: Vec<f64> = own.definition().parameters.iter().map(|p| p.start).collect();
    let bare = model.without_term(index);
    let with = bare.with_term(Term::Named(*effect), &claimed);
    let at = with.term_offset(bare.terms.len());
    let shapes = own.definition().parameters.iter().filter(|p| p.bounds.is_some()).count();
    if shapes == 0 {
        return None;
    }
    let free: Vec<usize> = (0..with.values().len() - shapes).collect();
    let held = fit(&with.frozen_except(&free), weighed);
    let explained = fit(&bare, weighed).cost - fitted.cost;
    let is_as_good = held.cost - fitted.cost < AS_CLAIMED.0.max(AS_CLAIMED.1 * explained);
    let (size, half) = (held.model.values()[at], interval_half_widths(&held, weighed)[at]);
    (is_as_good && size.abs() > half).then_some(held)
}

/// Completes the selection for the chosen explanation.
fn finish(mut chosen: Explanation, data: &Observations, levels: Levels) -> Selection {
    let weighed = Weighed::new(data, chosen.noise);
    chosen.augmented = without_uncertain_names(chosen.augmented, &weighed);
    let scores = Screen::new(&chosen.baseline, &weighed).effects();
    let predicted: Vec<f64> =
        data.force_n.iter().zip(&chosen.augmented.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&chosen.augmented.model, data, &predicted);
    let reliability = Reliability::new(data, chosen.noise, &own);
    let candidates = candidates(&scores, &chosen.augmented, &weighed);
    let visible = |id: &str| candidates.iter().any(|c| c.effect.id() == id && !c.is_invisible());
    let shown = |id: &str| candidates.iter().any(|c| c.effect.id() == id && !c.is_taken_over());
    let limits = limits(&chosen.augmented, &weighed, &reliability, |effect| shown(effect.id()));
    let (limits, hidden_limits) = limits.into_iter().partition(|limit| visible(limit.effect.id()));
    Selection {
        noise_factors: reliability.factors(),
        limits,
        hidden_limits,
        classes: classes(&scores, |score| visible(score.effect.id())),
        effects: found_effects(&chosen.augmented, &weighed, levels),
        structure: chosen.structure,
        family_probability: flips(&scores),
        structure_gain: chosen.structure_gain,
        structures_tried: chosen.structures_tried,
        candidates,
        baseline: chosen.baseline,
        augmented: chosen.augmented,
        noise: chosen.noise,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{CATALOGUE, effect_named};
    use crate::table::{Frame, PlateauRow};
    use crate::test_session::{session, session_with};
    use pinswitch_friction::{Substrate, published};

    fn selected(rows: &[PlateauRow]) -> (Selection, Observations) {
        let frame = Frame::new(rows);
        let mut data = Observations::new(&frame, rows).unwrap();
        (select(&Model::baseline(frame), &mut data, Levels::default()), data)
    }

    #[test]
    fn a_session_without_effects_shows_none() {
        let (found, data) = selected(&session(3));
        assert!(found.effects.is_empty() && found.structure.is_none(), "{:?}", found.effects);
        assert_eq!(data.excluded_series(), 0);
        assert_eq!(found.candidates.len(), CATALOGUE.len());
        assert!(found.candidates.windows(2).all(|w| w[0].gain >= w[1].gain));
        // There is one dwell, so the trace of an effect of the dwell is zero.
        let invisible: Vec<_> = found.invisible().map(|c| c.effect.id()).collect();
        assert!(invisible.contains(&"dwell_relaxation") && !invisible.contains(&"load_cell_offset"));
    }

    #[test]
    fn an_effect_has_size_and_gain() {
        let ploughing = effect_named("coating_ploughing").unwrap();
        let (found, _) = selected(&session_with(4, &[(Term::Named(ploughing), &[0.024])]));
        let [effect] = found.effects.as_slice() else { panic!("{:?}", found.effects) };
        assert_eq!(
            (effect.effect.id(), effect.term, effect.ids()[0]),
            ("coating_ploughing", 0, "coating_ploughing")
        );
        assert!(effect.gain > 100.0 && effect.rivals.is_empty(), "{effect:?}");
        let kappa = *found.augmented.model.values().last().unwrap();
        assert!((kappa / 0.024 - 1.0).abs() < 0.05, "{kappa}");
        assert_eq!(found.candidates[0].effect.id(), "coating_ploughing");
        assert_eq!(found.candidates[0].gain_left, None, "an effect of the model cannot gain further");
    }

    /// Pins alone in one direction: the friction exponent is one constant, so that an offset of the
    /// load cell and a missing hook change all readings alike. Each is a rival of the other.
    #[test]
    fn effects_that_look_alike_are_rivals() {
        let offset = effect_named("load_cell_offset").unwrap();
        let hook_n = published::HOOK_MASS_G * 1e-3 * published::GRAVITY_M_S2;
        let as_read_n = hook_n * libm::exp(-published::MU_PINS * published::wrap_angle_rad());
        let day = |seed: u64| {
            let mut rows = session_with(seed, &[(Term::Named(offset), &[as_read_n])]);
            rows.retain(|r| r.substrate == Some(Substrate::Abs) && r.direction.sign() < 0.0);
            rows.iter_mut().for_each(|r| r.series = format!("{seed}-{}", r.series));
            rows
        };
        let (found, _) = selected(&[day(5), day(6), day(7)].concat());
        let [effect] = found.effects.as_slice() else { panic!("{:?}", found.effects) };
        assert!(
            effect.ids().contains(&"load_cell_offset") && effect.ids().contains(&"hook_omitted"),
            "{effect:?}"
        );
        assert!(effect.rivals.iter().all(|r| r.cosine > 0.9), "{effect:?}");
    }

    #[test]
    fn series_with_gross_errors_are_excluded() {
        let mut rows = session(6);
        let bad = rows[200].series.clone();
        rows.iter_mut().filter(|r| r.series == bad).for_each(|r| r.force_n += 2.0);
        let (found, data) = selected(&rows);
        assert_eq!(data.excluded_series(), 1);
        assert!(data.is_excluded(200) && !data.is_excluded(0));
        assert!(found.effects.is_empty() && found.structure.is_none());
    }
}
