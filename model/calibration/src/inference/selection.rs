//! Which effects a table shows: forward, backward and exchange steps, rivals, and what no name explains.

use super::fit::{Fit, fit};
use super::forward::{Model, Term};
use super::isolation::isolated_series;
use super::noise::Noise;
use super::observations::Observations;
use super::screening::Screen;
use super::significance::{degrees_of_freedom, gain_at};
use super::unnamed::unnamed;
use crate::effects::{Covariate, Effect, LIBRARY};

/// Levels of the decisions, in whitened squares; tuned by `pinswitch simulate --study`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// Probability by chance, over the vocabulary, at which the first named effect is believed.
    pub first_p: f64,
    /// Largest probability by sign flips at which a weak first effect is believed.
    pub flips: f64,
    /// Least gain of each further one.
    pub further: f64,
    /// Least gain of a further one as a share of the first one's gain: below it, it may stem from the form.
    pub further_share: f64,
    /// A gain above this share of the first one's is more than the form of an effect can bend.
    pub beyond_form: f64,
    /// A rival fits worse by less than this.
    pub rival: f64,
    /// ... or by less than this share of what the effect explains.
    pub rival_share: f64,
    /// Least gain of a structure that no name explains.
    pub structure: f64,
    /// Probability by chance, over all structures tried, at which one is believed.
    pub structure_p: f64,
    /// Least gain of such a structure as a share of what the names explain.
    pub structure_share: f64,
    /// By how much a structure alone must fit better than a name with its form bent.
    pub outright: f64,
}

impl Default for Levels {
    fn default() -> Self {
        Self {
            first_p: 0.015,
            flips: 0.1,
            further: 18.0,
            further_share: 0.001,
            beyond_form: 0.08,
            rival: 9.0,
            rival_share: 0.002,
            structure: 26.0,
            structure_p: 0.01,
            structure_share: 0.02,
            outright: 7.0,
        }
    }
}

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

/// What was found.
#[derive(Clone, Debug)]
pub struct Selection {
    /// The paper's model, refitted.
    pub baseline: Fit,
    /// With all that was found.
    pub augmented: Fit,
    /// Gain of each named effect given all others, in the order of the model's terms.
    pub gains: Vec<f64>,
    /// Rivals of each named effect, in the same order.
    pub rivals: Vec<Vec<Rival>>,
    /// Where unnamed structure lies, and its gain.
    pub structure: Option<(Covariate, f64)>,
    /// Every candidate with its gain over the baseline, best first.
    pub candidates: Vec<(&'static str, f64)>,
    /// What each absent effect would still gain on top of what was found.
    pub leftover: Vec<(&'static str, f64)>,
    /// Effects that this data cannot show: id, visible share, strength at a typical size.
    pub invisible: Vec<(&'static dyn Effect, f64, f64)>,
    /// Probability, by flipped signs of whole series, of the largest candidate without any effect.
    pub family_probability: f64,
    /// Gain of the best structure without a name on top of what was found, in whitened squares.
    pub structure_gain: f64,
    /// Structures that were tried.
    pub structures_tried: usize,
    /// The noise.
    pub noise: Noise,
}

/// How many candidates of a scan are fitted in full.
const FITTED: usize = 6;

pub(super) fn named(model: &Model) -> Vec<&'static dyn Effect> {
    model.terms.iter().filter_map(|t| if let Term::Named(e) = t { Some(*e) } else { None }).collect()
}

/// Whether the effect just added, the last term, has a size that its physics allows.
fn possible(effect: &dyn Effect, fitted: &Fit) -> bool {
    let last = fitted.model.terms.len().saturating_sub(1);
    let size = fitted.model.values().get(fitted.model.term_offset(last)).copied();
    !effect.one_sided() || size.is_some_and(|s| s > 0.0)
}

/// Full fits of the most promising absent effects, best cost first.
fn extensions(
    from: &Fit,
    data: &Observations,
    noise: Noise,
    least: f64,
    beyond_form: f64,
    most: usize,
) -> Vec<(&'static dyn Effect, Fit)> {
    let mut scores = Screen::new(from, data, noise).effects();
    if !named(&from.model).is_empty() {
        // What the names so far would explain by bending their own forms is not worth another name.
        let guarded = Screen::guarded(from, data, noise).effects();
        scores.retain(|s| {
            s.gain > beyond_form || guarded.iter().any(|g| g.effect.id() == s.effect.id() && g.gain > least)
        });
    }
    scores.retain(|s| s.gain > least);
    scores.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    scores.truncate(most);
    let mut fits: Vec<_> = scores
        .into_iter()
        .map(|s| (s.effect, fit(&from.model.with_term(Term::Named(s.effect), &s.start), data, noise)))
        .filter(|(effect, fitted)| possible(*effect, fitted))
        .collect();
    fits.sort_by(|a: &(_, Fit), b| a.1.cost.total_cmp(&b.1.cost));
    fits
}

/// Adds named effects while each gains enough, then drops and exchanges.
pub(super) fn search(start: &Fit, data: &Observations, noise: Noise, levels: Levels) -> Fit {
    let mut current = start.clone();
    let degrees = degrees_of_freedom(data, start.model.coordinates.len());
    let first = gain_at(levels.first_p, LIBRARY.len(), degrees);
    let scores = Screen::new(start, data, noise).effects();
    let strongest = scores.iter().map(|s| s.gain).fold(0.0, f64::max);
    // A weak candidate that a few series carry alone is no effect, whatever the noise model says. With few series
    // flips cannot tell, and the noise model decides.
    if strongest < 3.0 * first && data.series >= 12 && flips(&scores) > levels.flips {
        return current;
    }
    for _ in 0..4 {
        let gained = start.cost - current.cost;
        let least = if named(&current.model).is_empty() {
            first
        } else {
            first.max(levels.further).max(levels.further_share * gained)
        };
        // To first order alone: an effect that is not linear may gain more once fitted.
        let screened = if named(&current.model).is_empty() { 0.3 } else { 0.8 } * least;
        let Some((_, best)) =
            extensions(&current, data, noise, screened, levels.beyond_form * gained, FITTED)
                .into_iter()
                .next()
        else {
            break;
        };
        if current.cost - best.cost < least {
            break;
        }
        current = best;
        current = exchange(current, data, noise, levels.beyond_form * gained);
        current = prune(current, data, noise, levels.further.max(levels.further_share * gained));
    }
    current
}

/// Probability of the scores by flipped signs.
fn flips(scores: &[super::screening::EffectScore]) -> f64 {
    let contributions: Vec<&[f64]> =
        scores.iter().filter(|s| s.visible_share > 2e-3).map(|s| s.by_series.as_slice()).collect();
    super::sign_flips::family_probability(&contributions)
}

/// Drops named effects that the others have made superfluous.
fn prune(mut current: Fit, data: &Observations, noise: Noise, least: f64) -> Fit {
    while named(&current.model).len() > 1 {
        let cheapest = (0..current.model.terms.len())
            .filter(|i| matches!(current.model.terms[*i], Term::Named(_)))
            .map(|i| fit(&current.model.without_term(i), data, noise))
            .min_by(|a, b| a.cost.total_cmp(&b.cost));
        match cheapest {
            Some(without) if without.cost - current.cost < least => current = without,
            _ => break,
        }
    }
    current
}

/// Replaces a named effect by another one that fits better in its place.
fn exchange(mut current: Fit, data: &Observations, noise: Noise, beyond_form: f64) -> Fit {
    if named(&current.model).len() < 2 {
        return current;
    }
    for _ in 0..2 {
        let mut better = None;
        for i in 0..current.model.terms.len() {
            if matches!(current.model.terms[i], Term::Named(_)) {
                let without = fit(&current.model.without_term(i), data, noise);
                let id = current.model.terms[i].id();
                for (effect, other) in extensions(&without, data, noise, 8.0, beyond_form, 4) {
                    if effect.id() != id && other.cost < current.cost - 1.0 {
                        better = Some(other);
                        break;
                    }
                }
                if better.is_some() {
                    break;
                }
            }
        }
        match better {
            Some(fit) => current = fit,
            None => break,
        }
    }
    current
}

/// The refitted paper's model from several starts: a stuck fit is indistinguishable from missing physics.
pub(crate) fn fit_baseline(model: &Model, data: &Observations, noise: Noise) -> Fit {
    let mut best = fit(model, data, noise);
    for factor in [0.75f64, 1.3] {
        let mut other = best.model.clone();
        for device in 0..other.frame.devices() {
            other.coordinates[2 + 2 * device] += factor.ln();
        }
        let other = fit(&other, data, noise);
        if other.cost < best.cost {
            best = other;
        }
    }
    best
}

/// With fewer series and directions than these, only the model's own columns are taken out before noise is estimated.
const LEAST_CELLS: usize = 50;

/// Columns that could explain residuals, in newtons: the model's own, the library's, and coarse structure.
fn explainable(fitted: &Fit, data: &Observations) -> Vec<Vec<f64>> {
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let mut columns = super::fit::jacobian(&fitted.model, data, &predicted);
    // So many columns would explain a few series altogether and leave no noise to estimate.
    if data.cells.len() < LEAST_CELLS {
        return columns;
    }
    for effect in LIBRARY {
        for start in effect.starts(&fitted.model.frame) {
            let changed = fitted.model.with_term(Term::Named(effect), &start).predict(&data.points);
            columns.push(changed.iter().zip(&predicted).map(|(c, p)| c - p).collect());
        }
    }
    for condition in 0..fitted.model.frame.conditions.len() {
        for sign in [-1.0, 1.0] {
            columns.push(
                data.points
                    .iter()
                    .map(|p| f64::from(u8::from(p.condition == condition && p.sign * sign > 0.0)))
                    .collect(),
            );
        }
    }
    columns
}

/// Series that may be set aside; more than these are no accidents.
const MOST_ASIDE: usize = 3;

/// Runs the whole search on a table. A series that is wrong as a whole is set aside and the search begins again.
pub fn select(start: &Model, data: &mut Observations, levels: Levels) -> Selection {
    loop {
        let names = search_names(start, data, levels);
        let explained = names.baseline.cost - names.found.cost;
        let open = Screen::new(&names.found, data, names.noise);
        let guarded = Screen::guarded(&names.found, data, names.noise);
        let mut left = open.structures();
        let beyond = left.first().is_some_and(|s| s.gain > levels.beyond_form * explained);
        if !named(&names.found.model).is_empty() && !beyond {
            left = guarded.structures();
        }
        if data.aside() < MOST_ASIDE {
            let structure = left.first().map_or(0.0, |s| s.gain);
            let effect = open.effects().iter().map(|s| s.gain).fold(structure, f64::max);
            if let Some(series) = isolated_series(&open, data, effect) {
                data.set_aside(series);
                continue;
            }
        }
        let bent = guarded.bent_gain();
        let tried = (left.len(), left.first().map_or(0.0, |s| s.gain));
        let (found, structure) =
            unnamed(&names.baseline, names.found, &left, bent, data, names.noise, levels);
        let mut selection = describe(names.baseline, found, structure, data, names.noise, levels);
        (selection.structures_tried, selection.structure_gain) = tried;
        return selection;
    }
}

/// The refitted baseline, what the names make of it, and the noise.
struct Names {
    baseline: Fit,
    found: Fit,
    noise: Noise,
}

fn search_names(start: &Model, data: &mut Observations, levels: Levels) -> Names {
    let guess = Noise::constant(0.1, 0.03);
    let rough = fit(start, data, guess);
    let sd = data.weigh_outliers(&rough.residual_n);
    let start = Noise::constant(sd, sd);
    let rough = fit_baseline(&rough.model, data, start);
    let mut noise = Noise::estimate(data, &rough.residual_n, &explainable(&rough, data), start);
    let mut baseline = fit_baseline(&rough.model, data, noise);
    let mut found = search(&baseline, data, noise, levels);
    // Once something is explained, the noise shows better: estimate it again and repeat.
    if !found.model.terms.is_empty() {
        noise = Noise::estimate(data, &found.residual_n, &explainable(&found, data), noise);
        baseline = fit(&baseline.model, data, noise);
        found = search(&baseline, data, noise, levels);
    }
    Names { baseline, found, noise }
}

/// Gains, rivals, candidates and blind spots of what was found.
fn describe(
    baseline: Fit,
    augmented: Fit,
    structure: Option<(Covariate, f64)>,
    data: &Observations,
    noise: Noise,
    levels: Levels,
) -> Selection {
    let (mut gains, mut rivals) = (Vec::new(), Vec::new());
    for (i, term) in augmented.model.terms.iter().enumerate() {
        let Term::Named(effect) = term else { continue };
        let without = fit(&augmented.model.without_term(i), data, noise);
        let gain = without.cost - augmented.cost;
        gains.push(gain);
        let margin = levels.rival.max(levels.rival_share * gain);
        let scores = Screen::new(&without, data, noise).effects();
        let own = scores.iter().find(|s| s.effect.id() == effect.id()).map(|s| s.column.clone());
        let mut others: Vec<_> = scores.into_iter().filter(|s| s.effect.id() != effect.id()).collect();
        others.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        others.retain(|s| s.gain > 0.3 * gain);
        others.truncate(4);
        let mut list = Vec::new();
        for score in others {
            let other = fit(&without.model.with_term(Term::Named(score.effect), &score.start), data, noise);
            let worse_by = other.cost - augmented.cost;
            if worse_by < margin && possible(score.effect, &other) {
                let cosine = own.as_ref().map_or(0.0, |own| {
                    let dot = super::projection::dot;
                    (dot(own, &score.column) / (dot(own, own) * dot(&score.column, &score.column)).sqrt())
                        .abs()
                });
                list.push(Rival { effect: score.effect, worse_by, cosine });
            }
        }
        rivals.push(list);
    }
    let screen = Screen::new(&baseline, data, noise);
    let scores = screen.effects();
    let mut candidates: Vec<_> = scores.iter().map(|s| (s.effect.id(), s.gain)).collect();
    candidates.sort_by(|a, b| b.1.total_cmp(&a.1));
    let invisible = scores
        .iter()
        .filter(|s| s.visible_share < 2e-3 || s.strength < 4.0)
        .map(|s| (s.effect, s.visible_share, s.strength))
        .collect();
    let family_probability = flips(&scores);
    let leftover =
        Screen::new(&augmented, data, noise).effects().iter().map(|s| (s.effect.id(), s.gain)).collect();
    Selection {
        leftover,
        family_probability,
        structure_gain: 0.0,
        structures_tried: 0,
        baseline,
        augmented,
        gains,
        rivals,
        structure,
        candidates,
        invisible,
        noise,
    }
}
