//! Which effects a table shows, their rivals, and what no name explains.

use super::baseline::{explainable, fit_baseline};
use super::evidence::evidence;
use super::fit::{Fit, fit, interval_half_widths, jacobian};
use super::forward::{Model, Term};
use super::isolation::isolated_series;
use super::levels::Levels;
use super::limits::{SizeLimit, classes, limits};
use super::noise::Noise;
use super::observations::Observations;
use super::projection::dot;
use super::reliability::{NoiseFactors, Reliability};
use super::screening::{EffectScore, Screen};
use super::search::{VISIBLE_SHARE, bendable_gain, flips, possible, search};
use super::structure_scores::StructureScore;
use super::unnamed::{Context, FoundStructure, with_structure};
use super::variance_components::{Scatter, estimate, shared_again};
use super::weighed::Weighed;
use crate::effects::{Effect, Shape};

/// An effect that explains what a named one explains as well.
#[derive(Clone, Debug)]
pub struct Rival {
    /// The rival.
    pub effect: &'static dyn Effect,
    /// How much worse it fits in its place, in whitened squares.
    pub worse_by: f64,
    /// Cosine between the two sensitivities after the refit.
    pub cosine: f64,
}

/// A named effect of the augmented model.
#[derive(Clone, Debug)]
pub struct FoundEffect {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Index of its term in the augmented model.
    pub term: usize,
    /// What it gains given all others, in whitened squares.
    pub gain: f64,
    /// Effects that explain as much in its place, the strongest first.
    pub rivals: Vec<Rival>,
}

impl FoundEffect {
    /// Ids of the effect and its rivals, sorted.
    pub fn ids(&self) -> Vec<&'static str> {
        let mut ids: Vec<_> =
            std::iter::once(self.effect.id()).chain(self.rivals.iter().map(|r| r.effect.id())).collect();
        ids.sort_unstable();
        ids
    }
}

/// An effect of the catalogue before the decision.
#[derive(Clone, Debug)]
pub struct CandidateEffect {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// What it alone would gain over the baseline to first order, in whitened squares.
    pub gain: f64,
    /// What it would still gain on top of what was found; `None` for what is in the model.
    pub gain_left: Option<f64>,
    /// Share of its trace that the refitted baseline cannot take over, 0..1.
    pub visible_share: f64,
    /// Length of its visible trace at a typical size, in standard deviations.
    pub strength: f64,
}

impl CandidateEffect {
    /// Strength, in standard deviations at a typical size, below which an effect counts as invisible.
    pub const MIN_STRENGTH: f64 = 4.0;

    /// Whether the data cannot show it, at a typical size.
    pub fn is_invisible(&self) -> bool {
        self.is_taken_over() || self.strength < Self::MIN_STRENGTH
    }

    /// Whether the refitted baseline takes its trace over.
    pub fn is_taken_over(&self) -> bool {
        self.visible_share < VISIBLE_SHARE
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Selection {
    /// The paper's model, refitted.
    pub baseline: Fit,
    /// With all that was found.
    pub augmented: Fit,
    /// The named effects found, in the order of the model's terms.
    pub effects: Vec<FoundEffect>,
    /// Where structure without a name lies, if any was found.
    pub structure: Option<FoundStructure>,
    /// Every effect of the catalogue, the one with the largest gain first.
    pub candidates: Vec<CandidateEffect>,
    /// Sizes that the data do not exclude, of visible effects that were not found.
    pub limits: Vec<SizeLimit>,
    /// Visible effects that this design cannot tell apart.
    pub classes: Vec<Vec<&'static str>>,
    /// Probability, by flipped signs of whole series, of the largest candidate without any effect.
    pub family_probability: f64,
    /// Gain of the best structure without a name on top of what was found, in whitened squares.
    pub structure_gain: f64,
    /// Structures that were tried.
    pub structures_tried: usize,
    /// The noise.
    pub noise: Noise,
    /// How well its parts are known.
    pub noise_factors: NoiseFactors,
}

impl Selection {
    /// The same table with nothing believed: what was found did not help on data that had no part in it.
    #[must_use]
    pub fn without_findings(self, data: &Observations, levels: Levels) -> Self {
        let bare = Explanation {
            augmented: self.baseline.clone(),
            baseline: self.baseline,
            structure: None,
            structure_gain: self.structure_gain,
            structures_tried: self.structures_tried,
            noise: self.noise,
            isolated: None,
        };
        finish(bare, data, levels)
    }

    /// Effects that this data cannot show, in the order in which they act.
    pub fn invisible(&self) -> impl Iterator<Item = &CandidateEffect> {
        let vocabulary = &self.baseline.model.vocabulary;
        vocabulary
            .acting_order()
            .iter()
            .filter_map(|e| self.candidates.iter().find(|c| c.effect.id() == e.id()))
            .filter(|c| c.is_invisible())
    }
}

/// Gain, in whitened squares, below which a shape is not worth a look.
const MIN_SHAPE_GAIN: f64 = 9.0;
/// Series that may be excluded; more than these are no accidents.
const MAX_EXCLUDED: usize = 3;

/// Runs the whole search on a table. A series that is wrong as a whole is excluded, and the search begins
/// again.
pub fn select(start: &Model, data: &mut Observations, levels: Levels) -> Selection {
    let chosen = choose(start, data, levels);
    finish(chosen, data, levels)
}

/// The model that the whole search ends with, its noise, and where it has structure without a name; without what is told
/// about it.
pub(crate) fn selected_model(
    start: &Model,
    data: &mut Observations,
    levels: Levels,
) -> (Model, Noise, Option<FoundStructure>) {
    let chosen = choose(start, data, levels);
    let weighed = Weighed::new(data, chosen.noise);
    (without_uncertain_names(chosen.augmented, &weighed).model, chosen.noise, chosen.structure)
}

/// The explanation of a table.
fn choose(start: &Model, data: &mut Observations, levels: Levels) -> Explanation {
    let guess = Noise::constant(0.1, 0.03);
    let rough = fit(start, &Weighed::new(data, guess));
    let sd = data.weigh_outliers(&rough.residual_n);
    let guess = Noise::constant(sd, sd);
    // The first fit has seen readings that are absurd; what friction does is told by the next one.
    let rough = fit_baseline(&rough.model, &Weighed::new(data, guess));
    data.friction_n = rough.model.friction_n(&data.points);
    loop {
        let rough = fit_baseline(&rough.model, &Weighed::new(data, guess));
        let noise = estimate(data, &rough.residual_n, &explainable(&rough, data), guess);
        let free = explain(&rough.model, data, noise, levels);
        if let Some(series) = free.isolated {
            data.exclude(series);
            continue;
        }
        return against_scatter(free, data, levels);
    }
}

/// One explanation of a table at one noise.
#[derive(Clone)]
struct Explanation {
    baseline: Fit,
    augmented: Fit,
    structure: Option<FoundStructure>,
    structure_gain: f64,
    structures_tried: usize,
    noise: Noise,
    /// A series that is wrong as a whole and must be left out first.
    isolated: Option<usize>,
}

impl Explanation {
    /// Shapes without a name; the sine and the cosine of a wave are one.
    fn shapes(&self) -> usize {
        let is_one = |term: &&Term| match term {
            Term::Structure(s) => {
                !matches!(s.form, Shape::TimeWave { quarter: 1, .. } | Shape::PositionWave { quarter: 1, .. })
            }
            Term::Named(_) => false,
        };
        self.augmented.model.terms.iter().filter(is_one).count()
    }

    fn names(&self) -> usize {
        self.augmented.model.named_effects().len()
    }

    /// Minus twice the logarithm of its posterior probability, up to a constant: the evidence, and for each thing
    /// believed how many there were to choose from.
    fn toll(&self, data: &Observations) -> f64 {
        let choices = 2.0 * (self.augmented.model.vocabulary.count() as f64).ln() * self.names() as f64;
        let shapes = 2.0 * (self.structures_tried.max(1) as f64).ln() * self.shapes() as f64;
        let scatter: f64 = Scatter::ALL.iter().map(|s| s.cost(self.noise, data)).sum();
        evidence(&self.augmented, &Weighed::new(data, self.noise)) + choices + shapes + scatter
    }
}

/// Evidence by which believing less may be behind and still be searched for.
const WORTH_A_SEARCH: f64 = 25.0;

impl Explanation {
    /// The explanations that believe one thing less, or nothing.
    fn with_less(&self) -> impl Iterator<Item = Explanation> {
        let terms = &self.augmented.model.terms;
        let bare = (0..terms.len()).rev().fold(self.augmented.model.clone(), |m, i| m.without_term(i));
        let named = (0..terms.len())
            .filter(|i| matches!(terms[*i], Term::Named(_)))
            .map(|i| (self.augmented.model.without_term(i), self.structure));
        let shapeless = (0..terms.len())
            .rev()
            .filter(|i| matches!(terms[*i], Term::Structure(_)))
            .fold(self.augmented.model.clone(), |m, i| m.without_term(i));
        [(bare, None), (shapeless, None)].into_iter().chain(named).map(|(model, structure)| Explanation {
            augmented: Fit { model, ..self.augmented.clone() },
            structure,
            ..self.clone()
        })
    }

    /// The same things believed at another noise.
    fn at(&self, data: &Observations, noise: Noise) -> Explanation {
        let augmented = fit(&self.augmented.model, &Weighed::new(data, noise));
        Explanation { augmented, noise, ..self.clone() }
    }
}

/// Names and structure at a noise, which is estimated again once something is explained.
fn explain(start: &Model, data: &Observations, noise: Noise, levels: Levels) -> Explanation {
    let mut noise = noise;
    let mut weighed = Weighed::new(data, noise);
    let mut baseline = fit_baseline(start, &weighed);
    let mut found = search(&baseline, &weighed, levels);
    if !found.model.terms.is_empty() {
        let before = noise;
        noise = estimate(data, &found.residual_n, &explainable(&found, data), noise);
        noise = Scatter::ALL.iter().fold(noise, |n, scatter| scatter.taken_from(before, n));
        weighed = Weighed::new(data, noise);
        baseline = fit(&baseline.model, &weighed);
        found = search(&baseline, &weighed, levels);
    }
    // A shape that some series follow looks like scatter of the series as long as it is not in the model.
    let (sharper, mut left) = sharper_noise(&found, data, noise);
    if let Some(sharper) = sharper {
        noise = sharper;
        weighed = Weighed::new(data, noise);
        baseline = fit(&baseline.model, &weighed);
        found = fit(&found.model, &weighed);
        left = Screen::new(&found, &weighed).structures();
    }
    let explained = bendable_gain(&baseline, &found, &weighed);
    let open = Screen::new(&found, &weighed);
    let guarded = Screen::guarded(&found, &weighed);
    let beyond = left.first().is_some_and(|s| s.gain > levels.beyond_form * explained);
    if !found.model.named_effects().is_empty() && !beyond {
        left = guarded.structures();
    }
    let isolated = (data.excluded_series() < MAX_EXCLUDED)
        .then(|| {
            let structure = left.first().map_or(0.0, |s| s.gain);
            let effect = open.effects().iter().map(|s| s.gain).fold(structure, f64::max);
            isolated_series(&open, data, effect)
        })
        .flatten();
    let (structure_gain, structures_tried) = (left.first().map_or(0.0, |s| s.gain), left.len());
    let (augmented, structure) = if isolated.is_some() {
        (found.clone(), None)
    } else {
        let bent = guarded.bent_gain();
        Context { weighed: &weighed, levels, explained }.with_unnamed(&baseline, found.clone(), &left, bent)
    };
    Explanation { baseline, augmented, structure, structure_gain, structures_tried, noise, isolated }
}

/// Evidence that a shape must gain beside the choice among all shapes before it changes the noise.
const MIN_EVIDENCE: f64 = 6.0;

/// The noise beside the best shape of each covariate, if one of them makes the table more probable than the noise does
/// without it; and the scores of all shapes.
fn sharper_noise(found: &Fit, data: &Observations, noise: Noise) -> (Option<Noise>, Vec<StructureScore>) {
    let weighed = Weighed::new(data, noise);
    let screen = Screen::new(found, &weighed);
    let shapes = screen.structures();
    let choice = 2.0 * (shapes.len().max(1) as f64).ln() + MIN_EVIDENCE;
    let mut best = (evidence(found, &weighed) - choice, None);
    let mut covariates = Vec::new();
    let columns = explainable(found, data);
    for score in shapes.iter().filter(|s| s.gain > MIN_SHAPE_GAIN) {
        let covariate = score.group[0].covariate;
        if covariates.contains(&covariate) {
            continue;
        }
        covariates.push(covariate);
        let with = with_structure(found, score, &weighed);
        let own = &with.model.terms[found.model.terms.len()..];
        let mut columns = columns.clone();
        let predicted: Vec<f64> = data.force_n.iter().zip(&with.residual_n).map(|(y, r)| y - r).collect();
        let all = jacobian(&with.model, data, &predicted);
        columns.extend(all.into_iter().rev().take(own.len()));
        let sharper = shared_again(data, &with.residual_n, &columns, noise);
        let weighed = Weighed::new(data, sharper);
        let toll = evidence(&fit(&with.model, &weighed), &weighed);
        if toll < best.0 {
            best = (toll, Some(sharper));
        }
    }
    (best.1, shapes)
}

/// Whether scatter from mount to mount, or offsets that wander from series to series, explain a table as well as what
/// was believed without them. Their groups are few, so that no variance is known well: they compete as explanations.
fn against_scatter(free: Explanation, data: &Observations, levels: Levels) -> Explanation {
    let beside = |scatter: Scatter, fitted: &Fit, noise| {
        let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
        let own = jacobian(&fitted.model, data, &predicted);
        scatter.estimated(data, &fitted.residual_n, &own, noise)
    };
    // What is believed is kept, and the scatter beside it estimated.
    let with_scatter = |explanation: Explanation| {
        let noise = Scatter::ALL
            .iter()
            .fold(explanation.noise, |noise, scatter| beside(*scatter, &explanation.augmented, noise));
        if noise == explanation.noise {
            return explanation;
        }
        let weighed = Weighed::new(data, noise);
        let baseline = fit(&explanation.baseline.model, &weighed);
        let augmented = fit(&explanation.augmented.model, &weighed);
        let with = Explanation { baseline, augmented, noise, ..explanation.clone() };
        if with.toll(data) < explanation.toll(data) { with } else { explanation }
    };
    if free.augmented.model.terms.is_empty() {
        return with_scatter(free);
    }
    let bare = |noise| Scatter::ALL.iter().fold(noise, |n, scatter| scatter.left_out(n));
    let alone = Scatter::ALL.map(|scatter| beside(scatter, &free.baseline, bare(free.noise)));
    let mut best = with_scatter(free);
    for found in alone {
        let noise = Scatter::ALL.iter().fold(best.noise, |n, scatter| scatter.taken_from(found, n));
        if noise == bare(noise) {
            continue;
        }
        // The search is only worth its time if believing less than now comes near.
        let toll = best.toll(data);
        if !best.with_less().any(|less| less.at(data, noise).toll(data) < toll + WORTH_A_SEARCH) {
            continue;
        }
        let other = explain(&best.baseline.model, data, noise, levels);
        let other = with_scatter(other);
        if other.toll(data) < best.toll(data) {
            best = other;
        }
    }
    // Names were preferred to shapes before it was known that they need scatter beside them.
    if best.names() > 0 && best.noise != bare(best.noise) {
        let shape = shape_alone(&best, data, levels).map(with_scatter);
        best = shape.filter(|shape| shape.toll(data) < best.toll(data)).unwrap_or(best);
    }
    best
}

/// The best shape alone, with the noise that is beside it and without scatter: what stands against names that need
/// scatter beside them.
fn shape_alone(named: &Explanation, data: &Observations, levels: Levels) -> Option<Explanation> {
    let bare = Scatter::ALL.iter().fold(named.noise, |n, scatter| scatter.left_out(n));
    let baseline = fit(&named.baseline.model, &Weighed::new(data, bare));
    let (sharper, shapes) = sharper_noise(&baseline, data, bare);
    let noise = sharper?;
    let weighed = Weighed::new(data, noise);
    let baseline = fit(&baseline.model, &weighed);
    let left = Screen::new(&baseline, &weighed).structures();
    let context = Context { weighed: &weighed, levels, explained: 0.0 };
    let (augmented, structure) = context.with_unnamed(&baseline, baseline.clone(), &left, 0.0);
    Some(Explanation {
        baseline,
        augmented,
        structure: Some(structure?),
        structure_gain: left.first().map_or(0.0, |s| s.gain),
        structures_tried: shapes.len(),
        noise,
        isolated: None,
    })
}

/// A model without the names whose sizes may as well be zero.
fn without_uncertain_names(mut current: Fit, weighed: &Weighed<'_>) -> Fit {
    loop {
        let (values, widths) = (current.model.values(), interval_half_widths(&current, weighed));
        let uncertain = (0..current.model.terms.len()).find(|index| {
            let at = current.model.term_offset(*index);
            let Term::Named(effect) = &current.model.terms[*index] else { return false };
            let free = effect.parameters().first().is_some_and(|p| p.bounds.is_none());
            free && effect.description().scales && values[at].abs() <= widths[at]
        });
        match uncertain {
            Some(index) => current = fit(&current.model.without_term(index), weighed),
            None => return current,
        }
    }
}

/// Everything that is told about the explanation chosen.
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
    Selection {
        noise_factors: reliability.factors(),
        limits: limits(&chosen.augmented, &weighed, &reliability, |effect| visible(effect.id())),
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

/// Gain and rivals of each named effect of a model.
fn found_effects(augmented: &Fit, weighed: &Weighed<'_>, levels: Levels) -> Vec<FoundEffect> {
    let mut found = Vec::new();
    for (index, term) in augmented.model.terms.iter().enumerate() {
        let Term::Named(effect) = term else { continue };
        let without = fit(&augmented.model.without_term(index), weighed);
        let gain = without.cost - augmented.cost;
        let bends = f64::from(u8::from(effect.description().bends));
        let margin = levels.rival.max(levels.rival_share * gain * bends);
        let mut rivals = rivals(*effect, gain, &without, augmented.cost, weighed);
        rivals.retain(|r| r.worse_by < margin);
        found.push(FoundEffect { effect: *effect, term: index, gain, rivals });
    }
    found
}

/// Effects fitted in place of one that gained `gain`: to the model `without` it, compared with the `cost` with it.
fn rivals(
    effect: &'static dyn Effect,
    gain: f64,
    without: &Fit,
    cost: f64,
    weighed: &Weighed<'_>,
) -> Vec<Rival> {
    let scores = Screen::new(without, weighed).effects();
    let own = scores.iter().find(|s| s.effect.id() == effect.id()).map(|s| s.column.clone());
    let mut others: Vec<_> = scores.into_iter().filter(|s| s.effect.id() != effect.id()).collect();
    others.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    others.retain(|s| s.gain > 0.3 * gain);
    others.truncate(4);
    others
        .into_iter()
        .filter_map(|score| {
            let other = fit(&without.model.with_term(Term::Named(score.effect), &score.start), weighed);
            possible(score.effect, &other).then(|| {
                let cosine = own.as_ref().map_or(0.0, |own| {
                    (dot(own, &score.column) / (dot(own, own) * dot(&score.column, &score.column)).sqrt())
                        .abs()
                });
                Rival { effect: score.effect, worse_by: other.cost - cost, cosine }
            })
        })
        .collect()
}

/// Every effect of the catalogue, by its score over the baseline.
fn candidates(scores: &[EffectScore], augmented: &Fit, weighed: &Weighed<'_>) -> Vec<CandidateEffect> {
    let left = Screen::new(augmented, weighed).effects();
    let mut candidates: Vec<_> = scores
        .iter()
        .map(|score| CandidateEffect {
            effect: score.effect,
            gain: score.gain,
            gain_left: left.iter().find(|l| l.effect.id() == score.effect.id()).map(|l| l.gain),
            visible_share: score.visible_share,
            strength: score.strength,
        })
        .collect();
    candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    candidates
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
    fn a_session_without_effect_has_every_candidate_and_names_none() {
        let (found, data) = selected(&session(3));
        assert!(found.effects.is_empty() && found.structure.is_none(), "{:?}", found.effects);
        assert_eq!(data.excluded_series(), 0);
        assert_eq!(found.candidates.len(), CATALOGUE.len());
        assert!(found.candidates.windows(2).all(|w| w[0].gain >= w[1].gain));
        // One dwell: the trace of an effect of the dwell has no length at all.
        let invisible: Vec<_> = found.invisible().map(|c| c.effect.id()).collect();
        assert!(invisible.contains(&"dwell_relaxation") && !invisible.contains(&"load_cell_offset"));
    }

    #[test]
    fn an_effect_is_named_with_its_size_and_its_gain() {
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
        assert_eq!(found.candidates[0].gain_left, None, "what is in the model has nothing left to gain");
    }

    /// Pins alone in one direction: the friction exponent is one constant, so that an offset of the cell and a hook
    /// left out shift all readings alike. Whichever is named has the other as its rival.
    #[test]
    fn effects_that_look_alike_are_rivals() {
        let offset = effect_named("load_cell_offset").unwrap();
        let hook_n = published::HOOK_MASS_G * 1e-3 * published::GRAVITY_M_S2;
        let as_read_n = hook_n * (-published::MU_PINS * published::wrap_angle_rad()).exp();
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
    fn a_series_that_is_wrong_as_a_whole_is_excluded() {
        let mut rows = session(6);
        let bad = rows[200].series.clone();
        rows.iter_mut().filter(|r| r.series == bad).for_each(|r| r.force_n += 2.0);
        let (found, data) = selected(&rows);
        assert_eq!(data.excluded_series(), 1);
        assert!(data.is_excluded(200) && !data.is_excluded(0));
        assert!(found.effects.is_empty() && found.structure.is_none());
    }
}
