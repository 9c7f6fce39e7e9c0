//! Effects whose size differs between sessions, so that the model's common size applies to none of
//! them. An effect whose sign differs between sessions may not show in their joint table.

use std::collections::BTreeSet;

use crate::effects::{Channel, Effect, Structure};
use crate::inference::{
    Levels, Model, Noise, Observations, Reliability, Selection, Term, UNATTRIBUTED, Weighed,
    coordinate_covariance, family_p_value, fit, gain_at, jacobian, selected_model,
};
use crate::parallel::map_each;
use crate::report::{Estimate, SizeInSession, UnequalReport};

/// Probability by chance below which sizes count as different.
const DIFFERENT_P: f64 = 1e-3;
/// Smallest relevant difference, as a share of the largest size: a smaller one changes no curve,
/// however significant it is.
const DIFFERENT: f64 = 0.2;

/// Returns the effects of a selection whose sizes differ between sessions, with the size in each
/// session.
pub(super) fn unequal(selection: &Selection, data: &Observations) -> Vec<UnequalReport> {
    let sessions = &selection.augmented.model.frame.sessions;
    if sessions.len() < 2 {
        return Vec::new();
    }
    let tries = selection.effects.len() * sessions.len();
    let model = &selection.augmented.model;
    selection
        .effects
        .iter()
        .filter_map(|found| {
            of_term(SizeOf::effect(found.effect)?, found.term, tries, model, selection.noise, data)
        })
        .collect()
}

/// Returns effects and structure that single sessions show and all together do not, with the size
/// in each session, if these differ.
pub(super) fn hidden(selection: &Selection, data: &Observations, levels: Levels) -> Vec<UnequalReport> {
    let (all, start) = (&selection.augmented.model, &selection.baseline.model);
    let sessions = start.frame.sessions.len();
    if sessions < 2 {
        return Vec::new();
    }
    let alone = map_each((0..sessions).collect(), |session| {
        let mut seen = data.subset(|row| data.points[row].session_group == Some(session));
        let is_enough = seen.points.len() >= start.values().len() + LEAST_ROWS;
        is_enough.then(|| selected_model(start, &mut seen, levels)).map(|(model, noise, _)| (model, noise))
    });
    let named = selection.effects.iter().flat_map(|effect| effect.ids()).map(str::to_owned);
    let unnamed = all.terms.iter().filter_map(|term| match term {
        Term::Structure(shape) => Some(along(shape)),
        Term::Named(_) => None,
    });
    // Shapes that follow one session would absorb part of the size.
    let bare = all.without_terms(|term| matches!(term, Term::Structure(_)));
    let mut known: BTreeSet<String> = named.chain(unnamed).collect();
    let mut reports = Vec::new();
    for (model, noise) in alone.into_iter().flatten() {
        let values = model.values();
        for (i, term) in model.terms.iter().enumerate() {
            let tries = sessions
                * match term {
                    Term::Named(_) => all.vocabulary.tries(),
                    Term::Structure(_) => selection.structures_tried.max(1),
                };
            let size = match term {
                Term::Named(effect) => SizeOf::effect(*effect),
                Term::Structure(shape) => Some(SizeOf::shape(shape)),
            };
            let constants = &values[model.term_offset(i)..model.term_offset(i) + term.constants()];
            let Some(size) = size.filter(|size| known.insert(size.id.clone())) else { continue };
            let with = bare.with_term(term.clone(), constants);
            let of_this = of_term(size, bare.terms.len(), tries, &with, noise, data);
            reports.extend(of_this.map(|report| UnequalReport { in_the_model: 0.0, ..report }));
        }
    }
    reports
}

/// Identity of a size: effect or structure, parameter and unit.
struct SizeOf {
    id: String,
    parameter: String,
    unit: String,
}

impl SizeOf {
    /// Returns `None` for an effect without constants.
    fn effect(effect: &dyn Effect) -> Option<Self> {
        let size = effect.parameters().first()?;
        Some(Self { id: effect.id().to_owned(), parameter: size.name.to_owned(), unit: size.unit.to_owned() })
    }

    fn shape(shape: &Structure) -> Self {
        let unit = if matches!(shape.channel, Channel::Reading | Channel::Drag) { "N" } else { "1" };
        Self { id: along(shape), parameter: format!("{UNATTRIBUTED}.1"), unit: unit.to_owned() }
    }
}

fn along(shape: &Structure) -> String {
    format!("{UNATTRIBUTED} ({})", shape.covariate.as_str())
}

/// Fewest rows of a session, beyond the constants of the baseline, for a search in that session
/// alone.
const LEAST_ROWS: usize = 8;

/// A size in one session: index of the session, value, standard deviation and degrees of freedom.
struct Size {
    session: usize,
    value: f64,
    sd: f64,
    degrees: f64,
}

fn of_term(
    size: SizeOf,
    term: usize,
    tries: usize,
    model: &Model,
    noise: Noise,
    data: &Observations,
) -> Option<UnequalReport> {
    let at = model.term_offset(term);
    let sizes: Vec<Size> = (0..model.frame.sessions.len())
        .filter_map(|session| size_in(session, at, model, noise, data))
        .collect();
    let weight: f64 = sizes.iter().map(|s| s.sd.powi(-2)).sum();
    let mean = sizes.iter().map(|s| s.value / (s.sd * s.sd)).sum::<f64>() / weight;
    // Each session is compared with the mean of the others.
    let gain = |s: &Size| {
        let rest = 1.0 / (weight - s.sd.powi(-2)).max(1e-300);
        let of_rest = (mean * weight - s.value / (s.sd * s.sd)) * rest;
        (s.value - of_rest).powi(2) / (s.sd * s.sd + rest)
    };
    let most = sizes.iter().max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let p_value = family_p_value(gain(most), tries, most.degrees);
    let low = sizes.iter().map(|s| s.value).fold(f64::INFINITY, f64::min);
    let high = sizes.iter().map(|s| s.value).fold(f64::NEG_INFINITY, f64::max);
    let is_much = high - low > DIFFERENT * low.abs().max(high.abs());
    (sizes.len() > 1 && p_value < DIFFERENT_P && is_much).then(|| UnequalReport {
        id: size.id,
        parameter: size.parameter,
        in_the_model: model.values()[at],
        p_value,
        sizes: sizes
            .iter()
            .map(|s| {
                let half = gain_at(0.05, 1, s.degrees).sqrt() * s.sd;
                SizeInSession {
                    session: model.frame.sessions[s.session].clone(),
                    size: Estimate {
                        value: s.value,
                        ci95: [s.value - half, s.value + half],
                        unit: size.unit.clone(),
                    },
                }
            })
            .collect(),
    })
}

/// Fits the size in one session, with all shapes and the other constants of the switch fixed at the
/// common fit.
fn size_in(session: usize, at: usize, model: &Model, noise: Noise, data: &Observations) -> Option<Size> {
    let seen = data.subset(|row| data.points[row].session_group == Some(session));
    // The session has its own level of friction, which the size must not absorb.
    let own: Vec<usize> = [0, 1].into_iter().chain([at]).filter(|i| !model.is_held(*i)).collect();
    if seen.points.len() < 4 * own.len() {
        return None;
    }
    let weighed = Weighed::new(&seen, noise);
    let fitted = fit(&model.frozen_except(&own), &weighed);
    let (value, slope) = fitted.model.value(at);
    let sd = slope.abs() * coordinate_covariance(&fitted, &weighed)[(at, at)].max(0.0).sqrt();
    let predicted: Vec<f64> = seen.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let columns = jacobian(&fitted.model, &seen, &predicted);
    let columns: Vec<Vec<f64>> = own.iter().map(|i| columns[*i].clone()).collect();
    let information = vec![slope * slope / (sd * sd); columns.len()];
    let degrees = *Reliability::degrees_of_each(&seen, noise, &columns, &information).last()?;
    (fitted.cost.is_finite() && sd.is_finite() && sd > 0.0).then_some(Size { session, value, sd, degrees })
}
