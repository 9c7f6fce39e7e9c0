//! Named effects whose size is not the same in all sessions: the one size that the model has is then true of none.

use crate::effects::Effect;
use crate::inference::{
    Observations, Reliability, Selection, Weighed, coordinate_covariance, family_p_value, fit, gain_at,
    jacobian,
};
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
    selection
        .effects
        .iter()
        .filter_map(|found| of_effect(found.effect, found.term, tries, selection, data))
        .collect()
}

/// A size in one session: its place among them, value, standard deviation, and the degrees of freedom behind that.
struct Size {
    session: usize,
    value: f64,
    sd: f64,
    degrees: f64,
}

fn of_effect(
    effect: &'static dyn Effect,
    term: usize,
    tries: usize,
    selection: &Selection,
    data: &Observations,
) -> Option<UnequalReport> {
    let model = &selection.augmented.model;
    let size = effect.parameters().first()?;
    let at = model.term_offset(term);
    let sizes: Vec<Size> =
        (0..model.frame.sessions.len()).filter_map(|session| size_in(session, at, selection, data)).collect();
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
        id: effect.id().to_owned(),
        parameter: size.name.to_owned(),
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
                        unit: size.unit.to_owned(),
                    },
                }
            })
            .collect(),
    })
}

/// The size in one session, all shapes and the constants of the switch held as all sessions have them.
fn size_in(session: usize, at: usize, selection: &Selection, data: &Observations) -> Option<Size> {
    let seen = data.subset(|row| data.points[row].session_group == Some(session));
    let model = &selection.augmented.model;
    // A session tells the level of its own friction, too: a size must not stand for that.
    let own: Vec<usize> = [0, 1].into_iter().chain([at]).filter(|i| !model.is_held(*i)).collect();
    if seen.points.len() < 4 * own.len() {
        return None;
    }
    let weighed = Weighed::new(&seen, selection.noise);
    let fitted = fit(&model.frozen_except(&own), &weighed);
    let (value, slope) = fitted.model.value(at);
    let sd = slope.abs() * coordinate_covariance(&fitted, &weighed)[(at, at)].max(0.0).sqrt();
    let predicted: Vec<f64> = seen.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let columns = jacobian(&fitted.model, &seen, &predicted);
    let columns: Vec<Vec<f64>> = own.iter().map(|i| columns[*i].clone()).collect();
    let information = vec![slope * slope / (sd * sd); columns.len()];
    let degrees = *Reliability::degrees_of_each(&seen, selection.noise, &columns, &information).last()?;
    (fitted.cost.is_finite() && sd.is_finite() && sd > 0.0).then_some(Size { session, value, sd, degrees })
}
