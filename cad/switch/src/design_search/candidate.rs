//! A configuration on trial, its curve against the targets, and the loads to look at.

use pinswitch_friction::Substrate;

use super::belief::{Belief, Believed, ModelError, Part};
use super::curve::Curve;
use crate::ask::{Ask, Quantity, SOURCES, Target};
use crate::config::Configuration;
use crate::design::{Design, contact_of};

/// Loads between the ends, evenly in their logarithm.
const LOADS: usize = 22;
/// How far the loads reach beyond the range: a made part may switch a little outside of it.
const REACH: f64 = 1.5;

/// What does not change during a search.
pub(super) struct Trial<'a> {
    pub(super) ask: &'a Ask,
    pub(super) belief: &'a dyn Belief,
    /// Lightest and heaviest load, N.
    pub(super) range_n: (f64, f64),
    /// Loads at which curves are computed.
    pub(super) loads_n: Vec<f64>,
}

/// The draw of one made part: constants, model, dimensions. All standard normal.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Draw {
    pub(super) constants: Vec<f64>,
    pub(super) model: f64,
    pub(super) made: [f64; SOURCES],
}

impl<'a> Trial<'a> {
    pub(super) fn new(ask: &'a Ask, belief: &'a dyn Belief, range_n: (f64, f64)) -> Self {
        let (low, high) = ((range_n.0 / REACH).max(0.2), range_n.1 * REACH);
        let mut loads_n: Vec<f64> =
            (0..LOADS).map(|i| low * (high / low).powf(i as f64 / (LOADS - 1) as f64)).collect();
        loads_n.extend([range_n.0.max(low), range_n.1]);
        loads_n.extend(ask.targets.iter().filter_map(|t| match t.quantity {
            Quantity::Friction { load_n } => Some(load_n),
            _ => None,
        }));
        loads_n.sort_by(f64::total_cmp);
        loads_n.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * b.abs());
        Self { ask, belief, range_n, loads_n }
    }

    /// The part of a configuration on silicone; `None` if the tendon would not lie on all of its pins.
    pub(super) fn part(&self, configuration: &Configuration) -> Option<Part> {
        let mut configuration = configuration.clone();
        configuration.layout.substrate = Substrate::Silicone;
        let mut pins = configuration.layout.pins.clone();
        pins.sort_unstable();
        let contact = contact_of(configuration).ok()?;
        (contact.pins().count() == pins.len() && !pins.is_empty()).then_some(Part { pins, contact })
    }

    /// Values of all targets by the best guess.
    pub(super) fn median(&self, configuration: &Configuration) -> Option<Vec<f64>> {
        let part = self.part(configuration)?;
        let curve = self.belief.curve(&part, &self.loads_n, &vec![0.0; self.belief.constants()])?;
        Some(self.values(&curve, 1.0))
    }

    /// Values of the targets on a curve whose threshold is moved by a factor.
    pub(super) fn values(&self, curve: &Curve, threshold_factor: f64) -> Vec<f64> {
        let value = |t: &Target| {
            let value = curve.value(t.quantity, self.range_n);
            if t.quantity == Quantity::Threshold { value * threshold_factor } else { value }
        };
        self.ask.targets.iter().map(value).collect()
    }

    /// Whether the best guess meets all targets; a threshold must lie within the loads.
    pub(super) fn is_met(&self, values: &[f64]) -> bool {
        self.ask.targets.iter().zip(values).all(|(t, v)| self.meets(t, *v))
    }

    fn meets(&self, target: &Target, value: f64) -> bool {
        let within =
            target.quantity != Quantity::Threshold || (self.range_n.0..=self.range_n.1).contains(&value);
        within && target.wish.is_met(value)
    }

    /// How far the values miss the targets: root of the sum of squares of the logarithms.
    pub(super) fn miss(&self, values: &[f64]) -> f64 {
        let excess = |(t, v): (&Target, &f64)| {
            let outside = if t.quantity == Quantity::Threshold {
                (self.range_n.0 / v).ln().max((v / self.range_n.1).ln()).max(0.0)
            } else {
                0.0
            };
            t.wish.excess(*v).abs().max(outside).powi(2)
        };
        self.ask.targets.iter().zip(values).map(excess).sum::<f64>().sqrt()
    }

    /// The values of a made part, predicted in full.
    pub(super) fn made(
        &self,
        part: &Part,
        hardness_shore_a: f64,
        error: &ModelError,
        draw: &Draw,
    ) -> Option<Vec<f64>> {
        let bed = self.ask.tolerances.made(part.contact.bed(), hardness_shore_a, &draw.made);
        let made = Part { pins: part.pins.clone(), contact: part.contact.clone().with_bed(bed) };
        let curve = self.belief.curve(&made, &self.loads_n, &draw.constants)?;
        let (curve, threshold_factor) = error.applied(curve, draw.model);
        Some(self.values(&curve, threshold_factor))
    }

    /// All that is believed of a part.
    pub(super) fn believed(&self, part: &Part) -> Option<Believed> {
        self.belief.believed(part, &self.loads_n)
    }

    /// The curve of a part whose dimensions are off by `made`, by the best guess.
    pub(super) fn curve_of_made(
        &self,
        part: &Part,
        hardness_shore_a: f64,
        made: &[f64; SOURCES],
    ) -> Option<Curve> {
        let bed = self.ask.tolerances.made(part.contact.bed(), hardness_shore_a, made);
        let made = Part { pins: part.pins.clone(), contact: part.contact.clone().with_bed(bed) };
        self.belief.curve(&made, &self.loads_n, &vec![0.0; self.belief.constants()])
    }

    /// Which limit of the part a configuration breaks; `None` if it can be printed and keeps to all.
    pub(super) fn broken_limit(&self, configuration: &Configuration) -> Option<String> {
        let mut on_silicone = configuration.clone();
        on_silicone.layout.substrate = Substrate::Silicone;
        let design = match Design::new(on_silicone) {
            Ok(design) => design,
            Err(e) => return Some(e.to_string()),
        };
        let limits = &self.ask.limits;
        let radius_mm = design.support_radius_mm();
        let width_mm = outer_width_mm(configuration);
        if let Some(most) = limits.outer_radius_mm.filter(|most| radius_mm > most + 1e-9) {
            return Some(format!("limits.outer_radius_mm = {most}: the supports reach {radius_mm:.2} mm"));
        }
        if let Some(most) = limits.outer_width_mm.filter(|most| width_mm > most + 1e-9) {
            return Some(format!("limits.outer_width_mm = {most}: shell and supports take {width_mm:.2} mm"));
        }
        None
    }
}

/// Width of the assembled switch: the shell between its two supports.
pub(super) fn outer_width_mm(c: &Configuration) -> f64 {
    c.shell.width_mm + 2.0 * c.support.plate_mm
}
