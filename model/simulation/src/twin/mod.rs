//! The physical twin: noise-free readings of a synthetic rig.
//!
//! It shares no formula with the fitter, so that the study of the calibrator also covers effects
//! whose true form differs from the fitted one. Form 0 of every effect is that of the effect
//! catalogue, and a test compares it with the fitter's; `effect_forms` lists the other forms. Only
//! for an effect without a formula here does the twin use the fitter's model.

mod contact;

use std::collections::BTreeMap;

use contact::{F0_N, TwinContact};
use pinswitch_calibration::model::{Model, Term};
use pinswitch_calibration::table::{Frame, PlateauRow};
use pinswitch_friction::published;

use crate::effect_forms::has_own_formula;
use crate::plan::Plan;
use crate::row_covariates::RowCovariates;
use crate::series_traits::SessionTraits;

/// Computes the readings in newtons without noise, one per row of a whole session in the order of
/// time.
pub(super) fn readings(plan: &Plan, session: &[PlateauRow], traits: &SessionTraits) -> Vec<f64> {
    let end_s = session.iter().map(|r| r.time_s).fold(1e-9, f64::max);
    let mean_speed_pct =
        (session.iter().map(|r| r.speed_pct.ln()).sum::<f64>() / session.len().max(1) as f64).exp();
    let mut contacts = BTreeMap::new();
    let mut devices = 0;
    let mut in_series = BTreeMap::new();
    let most_n = session.iter().map(|r| r.load_n).fold(1e-9, f64::max);
    // Load of this series and of the one before.
    let (mut name, mut load_n, mut before_n) = ("", 0.0, 0.0);
    let mut out = Vec::with_capacity(session.len());
    for (made, row) in session.iter().enumerate() {
        let contact = contacts.entry((row.substrate, row.pins.clone())).or_insert_with(|| {
            let contact = TwinContact::new(plan, row.substrate, &row.pins, devices);
            devices += usize::from(contact.switches());
            contact
        });
        let series_repetition: &mut f64 = in_series.entry(row.series.clone()).or_insert(0.0);
        *series_repetition += 1.0;
        if name != row.series {
            (name, before_n, load_n) = (&row.series, load_n, row.load_n);
        }
        let mark = traits.of(&row.series);
        let moment = RowCovariates {
            sign: row.direction.sign(),
            down: row.sweep == pinswitch_calibration::table::Sweep::Down,
            speed_pct: row.speed_pct,
            mean_speed_pct,
            dwell_s: row.dwell_s,
            repetition: f64::from(row.repetition),
            series_repetition: *series_repetition,
            stroke_share: row.position_mm / published::STROKE_MM,
            time_share: row.time_s / end_s,
            travel_share: made as f64 / session.len() as f64,
            step_down: (before_n - load_n) / most_n,
            operator: mark.operator,
            seating: mark.friction_factor,
        };
        out.push(reading(plan, contact, &moment, row));
    }
    add_fitter_effects(plan, session, &mut out);
    out
}

/// Adds the effects without a formula in the twin: their change of the fitter's model with the
/// constants of the plan.
fn add_fitter_effects(plan: &Plan, session: &[PlateauRow], readings_n: &mut [f64]) {
    let effects: Vec<_> = plan
        .effects
        .iter()
        .filter(|e| !has_own_formula(&e.id))
        .filter_map(|e| Some((plan.vocabulary.named(&e.id)?, e.values.as_slice())))
        .collect();
    let frame = Frame::new(session);
    let Some(points) = frame.points(session).filter(|_| !effects.is_empty()) else { return };
    let mut model = Model::baseline(frame);
    let mut values = model.values();
    (values[0], values[1]) = (plan.constants.mu_p, plan.constants.mu_s);
    for device in 0..model.frame.devices() {
        let [half_load, steepness] = Model::device_constants(device);
        values[half_load] *= plan.constants.half_load_factor.get(device).copied().unwrap_or(1.0);
        values[steepness] = plan.constants.steepness_of(device);
    }
    model.set_values(&values);
    let without = model.predict(&points);
    let with = effects
        .iter()
        .fold(model, |m, (effect, k)| m.with_term(Term::Named(effect.clone()), k))
        .predict(&points);
    for ((reading, with), without) in readings_n.iter_mut().zip(with).zip(without) {
        *reading += with - without;
    }
}

/// Computes a reading in newtons: hook, contact, guide pulleys, load cell.
fn reading(plan: &Plan, contact: &TwinContact, at: &RowCovariates, row: &PlateauRow) -> f64 {
    let has = |id: &str| plan.effects.iter().find(|e| e.id == id).map(|e| (e.values.as_slice(), e.form));
    let hook_n = published::HOOK_MASS_G * 1e-3 * published::GRAVITY_M_S2;
    let load_n = row.load_n + if has("hook_omitted").is_some() { hook_n } else { 0.0 };
    // Effects of the local tension: a fixed-point iteration, which converges in a few steps.
    let mut tension_n = load_n;
    for _ in 0..8 {
        tension_n = contact.tension_n(plan, at, load_n, tension_n);
    }
    if let Some((k, _)) = has("guide_drag") {
        tension_n += at.sign * k[0];
    }
    let mut force_n = tension_n;
    if let Some((k, _)) = has("load_cell_gain") {
        force_n += k[0] * tension_n;
    }
    if let Some((k, form)) = has("load_cell_nonlinearity") {
        force_n += k[0] * (tension_n / F0_N).max(0.0).powf(if form == 1 { 2.25 } else { 2.0 });
    }
    if let Some((k, _)) = has("load_cell_offset") {
        force_n += k[0];
    }
    if let Some((k, _)) = has("thermal_drift") {
        force_n += k[0] * at.time_share;
    }
    for d in &plan.disturbances {
        force_n += d.on_reading_n(at, &row.pins);
    }
    if let Some((k, form)) = has("load_cell_saturation") {
        force_n = if form == 1 {
            // A smooth transition over half a newton instead of a corner.
            k[0] - 0.25 * ((k[0] - force_n) / 0.25).exp().ln_1p()
        } else {
            force_n.min(k[0])
        };
    }
    force_n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};
    use crate::effect_forms::FORMS;
    use crate::plan::EffectPlan;
    use pinswitch_calibration::effects::{CATALOGUE, effect_named};

    /// The twin and the fitter implement `model/doc/effect-catalogue.md` independently.
    #[test]
    fn first_forms_match_the_fitter() {
        for effect in CATALOGUE {
            let (id, range) = (effect.id(), effect.description().study);
            let mut plan = Plan::randomised();
            let values = range.values_at(range.largest());
            plan.effects.push(EffectPlan { id: id.to_owned(), values: values.clone(), form: 0 });
            let mut random = rand::SeedableRng::seed_from_u64(3);
            let rows = crate::protocol::rows(&plan, &mut random);
            let frame = Frame::new(&rows);
            let model = Model::baseline(frame.clone()).with_term(Term::named(*effect), &values);
            let fitters = model.predict(&frame.points(&rows).unwrap());
            let worst = readings(&plan, &rows, &SessionTraits::default())
                .iter()
                .zip(&fitters)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            // The fitter interpolates the share of travel between 400 points, and iterates the
            // local tension three times; the twin iterates it until it converges.
            let bound = if ["wear_drift", "switch_local_tension"].contains(&id) { 1e-2 } else { 1e-3 };
            assert!(worst < bound, "{id}: {worst} N");
        }
    }

    /// Run-in of the order 1 in the fitter is hyperbolic decay in the twin, and between them the two agree.
    #[test]
    fn orders_of_run_in_match_the_fitter() {
        let effect = effect_named("run_in").unwrap();
        let own = |q: f64| vec![0.4, 1.5, 0.2, q];
        let orders =
            [(vec![0.4, 1.5, 1.0], 1, 1.0), (own(0.5), 0, 0.5), (own(1e-300), 0, 0.0), (own(-0.05), 0, 0.0)];
        for (values, form, order) in orders {
            let mut plan = Plan::randomised();
            plan.effects.push(EffectPlan { id: "run_in".to_owned(), values: values.clone(), form });
            let rows = crate::protocol::rows(&plan, &mut rand::SeedableRng::seed_from_u64(3));
            let frame = Frame::new(&rows);
            let fitted = [&values[..3], &[order]].concat();
            let model = Model::baseline(frame.clone()).with_term(Term::named(effect), &fitted);
            let fitters = model.predict(&frame.points(&rows).unwrap());
            let twins = readings(&plan, &rows, &SessionTraits::default());
            let worst = twins.iter().zip(&fitters).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-3, "{values:?}: {worst} N");
        }
    }

    /// Every other form differs from form 0 by less than 1.5 times the effect.
    #[test]
    fn other_forms_differ_from_the_first() {
        for (id, names) in FORMS {
            let range = effect_named(id).unwrap().description().study;
            let with = |form: Option<u8>| {
                let mut plan = Plan::randomised();
                let values = range.values_at(range.largest());
                if let Some(form) = form {
                    plan.effects.push(EffectPlan { id: id.to_owned(), values, form });
                }
                let mut random = rand::SeedableRng::seed_from_u64(3);
                readings(&plan, &crate::protocol::rows(&plan, &mut random), &SessionTraits::default())
            };
            let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum::<f64>();
            let (none, first) = (with(None), with(Some(0)));
            for form in 1..names.len() {
                let other = with(Some(u8::try_from(form).unwrap()));
                let change = distance(&other, &first) / distance(&first, &none);
                assert!(change > 1e-3 && change < 1.5, "{id} form {form}: {change}");
            }
        }
    }

    /// In a whole session, each series on silicone depends on the load of the previous one, and
    /// pins alone do not.
    #[test]
    fn silicone_remembers_the_previous_load() {
        let mut plan = Plan::default();
        let mut random = rand::SeedableRng::seed_from_u64(3);
        let rows = crate::protocol::rows(&plan, &mut random);
        let without = readings(&plan, &rows, &SessionTraits::default());
        let kind = DisturbanceKind::Memory { repetitions: 20.0 };
        plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Silicone, size: 0.5 });
        let with = readings(&plan, &rows, &SessionTraits::default());
        let exponent = |force_n: f64, row: &PlateauRow| (force_n / row.load_n).ln();
        let most_n = rows.iter().map(|r| r.load_n).fold(0.0, f64::max);
        let (mut before_n, mut series, mut series_repetition) = (0.0, &rows[0], 0);
        for ((row, a), b) in rows.iter().zip(&without).zip(&with) {
            if row.series != series.series {
                (before_n, series, series_repetition) = (series.load_n, row, 0);
            }
            if row.substrate == Some(pinswitch_friction::Substrate::Abs) {
                assert_eq!(a, b);
            } else if row.pins.is_empty() {
                let left = (-f64::from(series_repetition) / 20.0).exp();
                let expected = 1.0 + 0.5 * (before_n - row.load_n) / most_n * left;
                let factor = exponent(*b, row) / exponent(*a, row);
                assert!((factor - expected).abs() < 1e-9, "{factor} instead of {expected}");
            }
            series_repetition += 1;
        }
    }
}
