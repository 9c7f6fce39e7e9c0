//! Effects whose size is not the same in all sessions: the one size that the model has is then true of none. What is there
//! with one sign and then with the other may be named by no table of both.

use std::collections::BTreeSet;

use crate::effects::{Channel, Effect, Structure};
use crate::inference::{
    Levels, Model, Noise, Observations, Reliability, Selection, Term, UNATTRIBUTED, Weighed,
    coordinate_covariance, family_p_value, fit, gain_at, jacobian, selected_model,
};
use crate::parallel::map_each;
use crate::report::{Estimate, SizeInSession, UnequalReport};

/// Probability by chance below which a size is not the same in all sessions.
const DIFFERENT_P: f64 = 1e-3;
/// Share of the largest size by which they must differ, too: whatever is certain, less changes no curve.
const DIFFERENT: f64 = 0.2;

/// The effects of a selection whose sizes differ between its sessions, with the size in each.
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

/// Effects and structure that a session alone shows and all together do not, with the size in each session: as far as these
/// differ.
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
    // Shapes that follow one session would take from the size what is there.
    let bare = all.without_terms(|term| matches!(term, Term::Structure(_)));
    let mut known: BTreeSet<String> = named.chain(unnamed).collect();
    let mut found = Vec::new();
    for (model, noise) in alone.into_iter().flatten() {
        let values = model.values();
        for (i, term) in model.terms.iter().enumerate() {
            let tries = sessions
                * match term {
                    Term::Named(_) => all.vocabulary.tries(),
                    Term::Structure(_) => selection.structures_tried.max(1),
                };
            let told = match term {
                Term::Named(effect) => SizeOf::effect(*effect),
                Term::Structure(shape) => Some(SizeOf::shape(shape)),
            };
            let constants = &values[model.term_offset(i)..model.term_offset(i) + term.constants()];
            let Some(told) = told.filter(|told| known.insert(told.id.clone())) else { continue };
            let with = bare.with_term(term.clone(), constants);
            let of_this = of_term(told, bare.terms.len(), tries, &with, noise, data);
            found.extend(of_this.map(|told| UnequalReport { in_the_model: 0.0, ..told }));
        }
    }
    found
}

/// What a size is the size of.
struct SizeOf {
    id: String,
    parameter: String,
    unit: String,
}

impl SizeOf {
    /// `None` of an effect that is there or not.
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

/// Rows of a session beyond the constants of the baseline without which it is asked for nothing alone.
const LEAST_ROWS: usize = 8;

/// A size in one session: its place among them, value, standard deviation, and the degrees of freedom behind that.
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
    // Each session against all others, whose mean lacks its own share.
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

/// The size in one session, all shapes and the constants of the switch held as all sessions have them.
fn size_in(session: usize, at: usize, model: &Model, noise: Noise, data: &Observations) -> Option<Size> {
    let seen = data.subset(|row| data.points[row].session_group == Some(session));
    // A session tells the level of its own friction, too: a size must not stand for that.
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
