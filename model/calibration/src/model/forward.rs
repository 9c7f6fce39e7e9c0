//! Forward model: predicts readings from constants and rows.

use pinswitch_friction::Substrate;

use super::{Discrepancy, Model, Term};
use crate::effects::{Channel, ContactState, Covariate, Effect, Shape, Stage, Structure};
use crate::table::{Changing, Condition, Point};

impl Model {
    /// Returns readings in newtons at the points.
    pub fn predict(&self, points: &[Point]) -> Vec<f64> {
        self.predict_with(points, false)
    }

    fn predict_with(&self, points: &[Point], is_part: bool) -> Vec<f64> {
        let values = self.values();
        let terms = self.acting(&values, is_part);
        let mut contact: Option<(&Point, ContactState)> = None;
        points
            .iter()
            .map(|point| {
                // The contact before the terms depends on condition and groups only.
                let before = match &contact {
                    Some((known, state)) if known.has_contact_of(point) => *state,
                    _ => self.contact(&values, point),
                };
                contact = Some((point, before));
                let mut state = ContactState { load_n: point.load_n, ..before };
                let condition = &self.frame.conditions[point.condition];
                terms.iter().for_each(|term| term.on_contact(point, condition, &mut state));
                let tension_n = state.tension_n(condition, point);
                reading_n(&terms, point, condition, tension_n)
            })
            .collect()
    }

    /// Returns the change of the readings in newtons per relative change of the friction exponent.
    pub fn friction_n(&self, points: &[Point]) -> Vec<f64> {
        let everywhere = Structure {
            covariate: Covariate::Load,
            channel: Channel::Friction,
            only_in: None,
            form: Shape::LoadPower { power: 0, unit_n: 1.0 },
        };
        let size = 1e-3;
        let mut changed = self.with_term(Term::Structure(everywhere), &[size]).predict(points);
        changed.iter_mut().zip(self.predict(points)).for_each(|(c, p)| *c = (*c - p) / size);
        changed
    }

    /// Returns the tension of a part in newtons, including effects of the switch and excluding
    /// those of the rig.
    pub fn predict_part(&self, points: &[Point]) -> Vec<f64> {
        self.predict_with(points, true)
    }

    /// Returns the silicone's share of the friction at the points, by eq. 4 with the baseline's
    /// constants, 0..1.
    pub fn silicone_share(&self, points: &[Point]) -> Vec<f64> {
        let values = self.values();
        points
            .iter()
            .map(|p| {
                let condition = &self.frame.conditions[p.condition];
                let Some(d) = condition.device else {
                    return f64::from(u8::from(condition.substrate == Some(Substrate::Silicone)));
                };
                let [half_load, steepness] = Self::device_constants(d).map(|i| values[i]);
                let s = 1.0 / (1.0 + libm::exp(-steepness * (p.load_n / half_load - 1.0)));
                let silicone = (1.0 - condition.weight) * s * libm::sinh(values[1] * condition.wrap_rad);
                let pins = (1.0 + condition.weight) * (1.0 - s) * libm::sinh(values[0] * condition.wrap_rad);
                silicone / (silicone + pins).max(1e-300)
            })
            .collect()
    }

    /// Returns the terms with their constants; for a part, without those of the rig.
    fn acting<'a>(&'a self, values: &'a [f64], is_part: bool) -> Vec<Acting<'a>> {
        let mut at = self.baseline_len();
        let mut terms = Vec::with_capacity(self.terms.len());
        for (index, term) in self.terms.iter().enumerate() {
            let constants = &values[at..at + term.constants()];
            at += term.constants();
            let is_kept = !is_part || term.is_of_switch();
            let discrepancies = self.discrepancies.iter().filter(|d| d.term == index).collect();
            terms.extend(is_kept.then_some(Acting { term, constants, discrepancies }));
        }
        // Effects act in the order of their stages between the weight and the reading, whatever the
        // order of the terms. Structure without a name comes last: it was fitted on top of the others.
        terms.sort_by_key(|acting| match acting.term {
            Term::Named(effect) => (0, Some(effect.description().stage)),
            Term::Structure(_) => (1, None),
        });
        terms
    }

    /// Returns the contact at a point before the terms.
    fn contact(&self, values: &[f64], point: &Point) -> ContactState {
        let condition: &Condition = &self.frame.conditions[point.condition];
        let plain = self.plain[point.condition];
        let [half_load_n, steepness] =
            condition.device.map_or([1.0, 1.0], |d| Self::device_constants(d).map(|i| values[i]));
        let mut state = ContactState {
            load_n: point.load_n,
            wrap_rad: condition.wrap_rad,
            mu_pins: values[0],
            mu_silicone: if plain == usize::MAX { values[1] } else { values[plain] },
            extra_exponent_pins: 0.0,
            exponent_factor: 1.0,
            half_load_n,
            steepness,
            local_tension: false,
            adhesion_n: 0.0,
            drag_n: 0.0,
        };
        let changes = &self.frame.changes;
        let factors = if changes.is_empty() { &[] } else { &values[self.first_change()..] };
        for (change, factor) in changes.iter().zip(factors) {
            match change.constant {
                _ if !change.applies_to(point) => {}
                Changing::Pins => state.mu_pins *= factor,
                Changing::Silicone => state.mu_silicone *= factor,
                Changing::HalfLoad => state.half_load_n *= factor,
            }
        }
        state
    }
}

/// A term with its constants.
struct Acting<'a> {
    term: &'a Term,
    constants: &'a [f64],
    discrepancies: Vec<&'a Discrepancy>,
}

impl Acting<'_> {
    /// Calls `apply` with the constants at a point, whose first one is the size there.
    fn with_constants<T>(&self, point: &Point, condition: &Condition, apply: impl FnOnce(&[f64]) -> T) -> T {
        if self.discrepancies.is_empty() {
            return apply(self.constants);
        }
        let factor = |d: &&Discrepancy| d.value * d.factor.value(point, condition);
        let mut constants = self.constants.to_vec();
        if let Some(size) = constants.first_mut() {
            *size *= 1.0 + self.discrepancies.iter().map(factor).sum::<f64>();
        }
        apply(&constants)
    }

    fn on_contact(&self, point: &Point, condition: &Condition, state: &mut ContactState) {
        self.with_constants(point, condition, |k| match self.term {
            Term::Named(effect) => effect.on_contact(k, point, condition, state),
            Term::Structure(structure) => structure.on_contact(k[0], point, state),
        });
    }
}

/// Returns the reading in newtons for a tension after the contact.
fn reading_n(terms: &[Acting<'_>], point: &Point, condition: &Condition, tension_n: f64) -> f64 {
    let mut reading = tension_n;
    // Effects on the tension come before the load cell, whatever the order of the terms.
    for acting in terms {
        if let Term::Named(effect) = acting.term {
            reading =
                acting.with_constants(point, condition, |k| effect.on_tension(k, point, condition, reading));
        }
    }
    // A limit of the load cell applies after all other effects.
    let mut limits: Vec<(&dyn Effect, &[f64])> = Vec::new();
    for acting in terms {
        match acting.term {
            Term::Named(effect) if effect.description().stage == Stage::CellLimit => {
                // A second limit of the same effect replaces the first.
                limits.retain(|(other, _)| other.id() != effect.id());
                limits.push((&**effect, acting.constants));
            }
            Term::Named(effect) => {
                reading = acting
                    .with_constants(point, condition, |k| effect.on_reading(k, point, condition, reading));
            }
            Term::Structure(structure) => {
                reading = structure.on_reading(acting.constants[0], point, reading);
            }
        }
    }
    limits.iter().fold(reading, |reading, (effect, k)| effect.on_reading(k, point, condition, reading))
}
