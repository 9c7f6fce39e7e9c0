//! Forward model: predicts readings from constants and rows.

use pinswitch_friction::Substrate;

use super::model::{Model, Term};
use crate::effects::{Channel, ContactState, Covariate, Effect, Shape, Side, Stage, Structure};
use crate::table::{Changing, Condition, Point};

impl Model {
    /// Returns readings in newtons at the points.
    pub fn predict(&self, points: &[Point]) -> Vec<f64> {
        let values = self.values();
        self.readings(&values, points, |_| true, &[])
    }

    /// Returns readings at the points that are `touched`, and those of `before` elsewhere.
    /// Consecutive rows of a series have the same setting; quantities that do not vary within a
    /// series are computed once for all of them.
    fn readings(
        &self,
        values: &[f64],
        points: &[Point],
        touched: impl Fn(&Point) -> bool,
        before: &[f64],
    ) -> Vec<f64> {
        let terms = self.acting(values, false);
        let moves = self.terms.iter().any(Term::moves_along_a_series);
        let still = terms.iter().take_while(|(term, _)| !term.moves_contact()).count();
        let contact_moves = terms.iter().any(|(term, _)| term.moves_contact());
        let mut last: Option<Setting<'_>> = None;
        points
            .iter()
            .enumerate()
            .map(|(i, point)| {
                if !touched(point) {
                    return before[i];
                }
                match &mut last {
                    Some(known) if known.point.is_of_one_setting(point) => {
                        if moves {
                            if contact_moves {
                                known.tension_n = self.tension_n(&terms[still..], point, known.state);
                            }
                            known.reading_n = self.reading_n(&terms, point, known.tension_n);
                        }
                        known.point = point;
                        known.reading_n
                    }
                    _ => {
                        let state = self.contact(values, &terms[..still], point);
                        let tension_n = self.tension_n(&terms[still..], point, state);
                        let reading_n = self.reading_n(&terms, point, tension_n);
                        last = Some(Setting { point, state, tension_n, reading_n });
                        reading_n
                    }
                }
            })
            .collect()
    }

    /// Returns readings after one constant has changed, where `before` were those at the points;
    /// only conditions that depend on the constant are computed again.
    pub(crate) fn predict_changed(&self, points: &[Point], before: &[f64], index: usize) -> Vec<f64> {
        let values = self.values();
        let touched: Vec<bool> = (0..self.frame.conditions.len()).map(|c| self.touches(index, c)).collect();
        self.readings(&values, points, |p| touched[p.condition], before)
    }

    /// Returns whether the readings on a condition depend on a constant.
    fn touches(&self, index: usize, condition: usize) -> bool {
        let c = &self.frame.conditions[condition];
        match index {
            0 => c.has_pins(),
            1 => c.substrate == Some(Substrate::Silicone),
            _ if index < 2 + 2 * self.frame.devices() => c.device == Some((index - 2) / 2),
            _ if index < self.first_change() => self.plain[condition] == index,
            _ if index < self.baseline_len() => {
                match self.frame.changes[index - self.first_change()].constant {
                    Changing::Pins => c.has_pins(),
                    Changing::Silicone => c.is_silicone_or_plain(),
                    Changing::HalfLoad => c.device.is_some(),
                }
            }
            _ => true,
        }
    }

    /// Returns the change of the readings in newtons per relative change of the friction exponent.
    pub fn friction_n(&self, points: &[Point]) -> Vec<f64> {
        let everywhere = Structure {
            covariate: Covariate::Load,
            channel: Channel::Friction,
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
        let values = self.values();
        let terms = self.acting(&values, true);
        let read = |point: &Point| {
            let state = self.contact(&values, &terms, point);
            self.reading_n(&terms, point, self.tension_n(&[], point, state))
        };
        points.iter().map(read).collect()
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
    fn acting<'a>(&'a self, values: &'a [f64], part_only: bool) -> Vec<(&'a Term, &'a [f64])> {
        let mut at = self.baseline_len();
        let mut terms = Vec::with_capacity(self.terms.len());
        for term in &self.terms {
            let constants = &values[at..at + term.constants()];
            at += term.constants();
            let is_kept = !part_only
                || matches!(term, Term::Named(effect) if effect.description().side == Side::Switch);
            terms.extend(is_kept.then_some((term, constants)));
        }
        terms
    }

    /// Returns the contact at a point after these terms.
    fn contact(&self, values: &[f64], terms: &[(&Term, &[f64])], point: &Point) -> ContactState {
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
        on_contact(terms, point, condition, &mut state);
        state
    }

    /// Returns the tension in newtons after the contact and further terms, before the load cell.
    fn tension_n(&self, terms: &[(&Term, &[f64])], point: &Point, mut state: ContactState) -> f64 {
        let condition = &self.frame.conditions[point.condition];
        on_contact(terms, point, condition, &mut state);
        state.tension_n(condition, point)
    }

    /// Returns the reading in newtons for a tension after the contact.
    fn reading_n(&self, terms: &[(&Term, &[f64])], point: &Point, tension_n: f64) -> f64 {
        let condition = &self.frame.conditions[point.condition];
        let mut reading = tension_n;
        // Effects on the tension come before the load cell, whatever the order of the terms.
        for (term, constants) in terms {
            if let Term::Named(effect) = term {
                reading = effect.on_tension(constants, point, condition, reading);
            }
        }
        // A limit of the load cell applies after all other effects.
        let mut limits = Vec::new();
        for (term, constants) in terms {
            match term {
                Term::Named(effect) => {
                    if effect.description().stage == Stage::CellLimit {
                        // A second limit of the same effect replaces the first.
                        limits.retain(|(other, _): &(&&dyn Effect, _)| other.id() != effect.id());
                        limits.push((effect, constants));
                    } else {
                        reading = effect.on_reading(constants, point, condition, reading);
                    }
                }
                Term::Structure(structure) => {
                    reading = structure.on_reading(constants[0], point, reading);
                }
            }
        }
        limits.iter().fold(reading, |reading, (effect, k)| effect.on_reading(k, point, condition, reading))
    }
}

/// Quantities common to rows of one setting: the contact, if it does not vary within a series, and
/// the last row's tension and reading in newtons.
struct Setting<'a> {
    point: &'a Point,
    state: ContactState,
    tension_n: f64,
    reading_n: f64,
}

/// Applies these terms to a contact, in their order.
fn on_contact(terms: &[(&Term, &[f64])], point: &Point, condition: &Condition, state: &mut ContactState) {
    for (term, constants) in terms {
        match term {
            Term::Named(effect) => effect.on_contact(constants, point, condition, state),
            Term::Structure(structure) => structure.on_contact(constants[0], point, state),
        }
    }
}
