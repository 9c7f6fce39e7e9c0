//! Evaluation of a candidate: its curve at the loads of the search, the values of the targets, and
//! the limits.

use pinswitch_friction::{Substrate, Transition};

use super::belief::{Belief, Believed, ModelError, Part};
use super::curve::Curve;
use crate::config::Configuration;
use crate::design::{Design, Dimensions, contact_of, is_accepted};
use crate::prediction::evenly;
use crate::request::{Quantity, Request, SOURCES, Target};

/// Number of loads of a curve, evenly spaced in their logarithm.
const LOADS: usize = 22;
/// Factor by which the loads extend beyond the range, since the threshold of a made part may be
/// slightly outside.
const REACH: f64 = 1.5;

/// Number of loads of `predict` on each side of a threshold at which it is refined.
const AROUND: usize = 2;
/// Largest relative error of a threshold that is interpolated between the loads of a search.
const NEAR: f64 = 0.05;

/// The invariants of a search.
pub(super) struct Trial<'a> {
    pub(super) request: &'a Request,
    pub(super) belief: &'a dyn Belief,
    /// Lightest and heaviest load, N.
    pub(super) range_n: (f64, f64),
    /// Loads at which curves are computed.
    pub(super) loads_n: Vec<f64>,
    /// Loads of the curve of `predict`, which determine the reported threshold.
    predicted_n: Vec<f64>,
    /// Whether limits of size are soft: an excess counts as a miss, and does not exclude a
    /// configuration.
    has_soft_sizes: bool,
}

/// The random variables of one made part: constants, model error and dimensions. All are standard
/// normal.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Draw {
    pub(super) constants: Vec<f64>,
    pub(super) model: f64,
    pub(super) made: [f64; SOURCES],
}

impl<'a> Trial<'a> {
    pub(super) fn new(
        request: &'a Request,
        belief: &'a dyn Belief,
        range_n: (f64, f64),
        points: usize,
    ) -> Self {
        let (low, high) = ((range_n.0 / REACH).max(0.2), range_n.1 * REACH);
        let mut loads_n: Vec<f64> =
            (0..LOADS).map(|i| low * libm::pow(high / low, i as f64 / (LOADS - 1) as f64)).collect();
        loads_n.extend([range_n.0.max(low), range_n.1]);
        loads_n.extend(request.targets.iter().filter_map(|t| match t.quantity {
            Quantity::Friction { load_n } => Some(load_n),
            _ => None,
        }));
        loads_n.sort_by(f64::total_cmp);
        loads_n.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * b.abs());
        Self {
            request,
            belief,
            range_n,
            loads_n,
            predicted_n: evenly(range_n, points),
            has_soft_sizes: false,
        }
    }

    /// Returns the same loads for another request.
    pub(super) fn with_request<'b>(&'b self, request: &'b Request) -> Trial<'b> {
        Trial { request, loads_n: self.loads_n.clone(), predicted_n: self.predicted_n.clone(), ..*self }
    }

    /// Returns the same loads for another request, with soft limits of size.
    pub(super) fn with_soft_sizes<'b>(&'b self, request: &'b Request) -> Trial<'b> {
        Trial { has_soft_sizes: true, ..self.with_request(request) }
    }

    /// Returns whether limits of size are soft.
    pub(super) const fn has_soft_sizes(&self) -> bool {
        self.has_soft_sizes
    }

    /// Returns the limited sizes: the field, the size of `configuration`, and the largest allowed
    /// size, mm.
    fn sizes(&self, configuration: &Configuration) -> Vec<(&'static str, f64, f64)> {
        let limits = &self.request.limits;
        let radius_mm = || Dimensions::new(configuration.clone()).support_radius_mm();
        let radius = limits.outer_radius_mm.map(|most| ("limits.outer_radius_mm", radius_mm(), most));
        let width =
            limits.outer_width_mm.map(|most| ("limits.outer_width_mm", outer_width_mm(configuration), most));
        radius.into_iter().chain(width).collect()
    }

    /// Returns the sizes that exceed soft limits: the field, the size, and the limit, mm.
    pub(super) fn missed_sizes(&self, configuration: &Configuration) -> Vec<(&'static str, f64, f64)> {
        let mut sizes = if self.has_soft_sizes { self.sizes(configuration) } else { Vec::new() };
        sizes.retain(|(_, size, most)| size > &(most + 1e-9));
        sizes
    }

    /// Returns the miss of a configuration: that of the targets, combined with that of soft limits
    /// of size.
    pub(super) fn shortfall(&self, configuration: &Configuration) -> Option<f64> {
        let targets = self.miss(&self.median(configuration)?);
        let sizes = self.missed_sizes(configuration);
        Some(sizes.iter().map(|(_, size, most)| libm::log(size / most)).fold(targets, libm::hypot))
    }

    /// Returns the part of a configuration on silicone; `None` without pins, or if the tendon does
    /// not touch all of them.
    pub(super) fn part(&self, configuration: &Configuration) -> Option<Part> {
        let mut configuration = configuration.clone();
        configuration.layout.substrate = Substrate::Silicone;
        let mut pins = configuration.layout.pins.clone();
        pins.sort_unstable();
        let contact = contact_of(configuration).ok()?;
        (contact.pins().count() == pins.len() && !pins.is_empty()).then_some(Part { pins, contact })
    }

    /// Returns the best estimates of all targets.
    pub(super) fn median(&self, configuration: &Configuration) -> Option<Vec<f64>> {
        let part = self.part(configuration)?;
        let mut curve = self.belief.best(&part, &self.loads_n)?;
        let settled = self.settled(&part, &mut curve)?;
        self.values(&mut curve, settled)
    }

    /// Returns the ratio of the threshold between the loads of `predict` to that of `curve`, which
    /// has fewer loads; 1 if the threshold is not between the loads of `predict`. `None` if a
    /// state of the curve cannot be computed.
    pub(super) fn settled(&self, part: &Part, curve: &mut Curve<'_>) -> Option<f64> {
        let here = curve.switching()?;
        let between = |from: usize, to: usize| {
            let loads = &self.predicted_n[from..to];
            Transition::threshold_n(loads, &self.belief.best(part, loads)?.silicone_shares()?)
        };
        let count = self.predicted_n.len();
        let next = self.predicted_n.partition_point(|l| *l < here.threshold_n);
        // A few loads around the threshold are nearly always sufficient.
        let (from, to) = (next.saturating_sub(AROUND + 1), (next + AROUND).min(count));
        let is_near = here.is_found && next > 0 && next < count;
        let is_beyond = here.threshold_n < self.predicted_n[0] * (1.0 - NEAR)
            || here.threshold_n > self.predicted_n[count - 1] * (1.0 + NEAR);
        let found = match is_near.then(|| between(from, to)).flatten() {
            Some(found) => Some(found),
            None if is_beyond => None,
            None => between(0, count),
        };
        Some(found.map_or(1.0, |found| found / here.threshold_n))
    }

    /// Returns the values of the targets of a curve whose threshold is multiplied by a factor;
    /// `None` if a state that they need cannot be computed.
    pub(super) fn values(&self, curve: &mut Curve<'_>, threshold_factor: f64) -> Option<Vec<f64>> {
        let value = |t: &Target| {
            let value = curve.value(t.quantity, self.range_n)?;
            Some(if t.quantity == Quantity::Threshold { value * threshold_factor } else { value })
        };
        self.request.targets.iter().map(value).collect()
    }

    /// Returns whether the best estimate meets all targets. A threshold must also be within the
    /// loads.
    pub(super) fn is_met(&self, values: &[f64]) -> bool {
        self.request.targets.iter().zip(values).all(|(t, v)| self.meets(t, *v))
    }

    fn meets(&self, target: &Target, value: f64) -> bool {
        let within =
            target.quantity != Quantity::Threshold || (self.range_n.0..=self.range_n.1).contains(&value);
        within && target.requirement.is_met(value)
    }

    /// Returns the miss of the values: the root of the sum of the squared logarithms.
    pub(super) fn miss(&self, values: &[f64]) -> f64 {
        let excess = |(t, v): (&Target, &f64)| {
            let outside = if t.quantity == Quantity::Threshold {
                libm::log(self.range_n.0 / v).max(libm::log(v / self.range_n.1)).max(0.0)
            } else {
                0.0
            };
            t.requirement.excess(*v).abs().max(outside).powi(2)
        };
        self.request.targets.iter().zip(values).map(excess).sum::<f64>().sqrt()
    }

    /// Returns the values of a made part from its own prediction. Its threshold is expected below
    /// the load with the index `next`.
    pub(super) fn made(
        &self,
        part: &Part,
        hardness_shore_a: f64,
        (error, next): (&ModelError, usize),
        draw: &Draw,
    ) -> Option<Vec<f64>> {
        let bed = self.request.tolerances.made(part.contact.bed(), hardness_shore_a, &draw.made);
        let made = Part { pins: part.pins.clone(), contact: part.contact.clone().with_bed(bed) };
        let curve = self.belief.curve(&made, &self.loads_n, &draw.constants)?;
        let (curve, threshold_factor) = error.applied(curve, &self.loads_n, draw.model);
        self.values(&mut curve.expecting(next), threshold_factor)
    }

    /// Returns the predictive distribution of a part.
    pub(super) fn believed(&self, part: &Part) -> Option<Believed<'_>> {
        self.belief.believed(part, &self.loads_n)
    }

    /// Returns the best estimate of the curve of a part with deviations of `made` standard
    /// deviations in its dimensions.
    pub(super) fn curve_of_made(
        &self,
        part: &Part,
        hardness_shore_a: f64,
        made: &[f64; SOURCES],
    ) -> Option<Curve<'_>> {
        let bed = self.request.tolerances.made(part.contact.bed(), hardness_shore_a, made);
        let made = Part { pins: part.pins.clone(), contact: part.contact.clone().with_bed(bed) };
        self.belief.best(&made, &self.loads_n)
    }

    /// Returns whether a configuration can be printed and satisfies all limits. Faster than
    /// [`Self::broken_limit`], whose remedies take too long for a step of a search.
    pub(super) fn keeps_limits(&self, configuration: &Configuration) -> bool {
        let mut on_silicone = configuration.clone();
        on_silicone.layout.substrate = Substrate::Silicone;
        is_accepted(on_silicone)
            && lacking_bed_mm(configuration).is_none()
            && (self.has_soft_sizes
                || self.sizes(configuration).into_iter().all(|(_, size, most)| size <= most + 1e-9))
    }

    /// Returns the limit that a configuration violates; `None` if it can be printed and satisfies
    /// all of them.
    pub(super) fn broken_limit(&self, configuration: &Configuration) -> Option<String> {
        let mut on_silicone = configuration.clone();
        on_silicone.layout.substrate = Substrate::Silicone;
        if let Err(e) = Design::new(on_silicone) {
            return Some(e.to_string());
        }
        if let Some(needed_mm) = lacking_bed_mm(configuration) {
            let bed_mm = configuration.print.bed_mm;
            return Some(format!("print.bed_mm = {bed_mm} mm: the shell alone needs {needed_mm:.1} mm"));
        }
        if self.has_soft_sizes {
            return None;
        }
        let broken = self.sizes(configuration).into_iter().find(|(_, size, most)| size > &(most + 1e-9));
        broken.map(|(field, size, most)| {
            let what =
                if field.contains("radius") { "the supports reach" } else { "shell and supports take" };
            format!("{field} = {most} mm: {what} {size:.2} mm")
        })
    }
}

/// Returns the side of the bed that the shell needs, if that of the printer is smaller. The search
/// checks whether all parts fit only for proposals, since that takes too long for a step.
fn lacking_bed_mm(c: &Configuration) -> Option<f64> {
    let needed_mm = Dimensions::new(c.clone()).least_bed_mm();
    (needed_mm > c.print.bed_mm).then_some(needed_mm)
}

/// Returns the width of the assembled switch: the shell and its two supports.
pub(super) fn outer_width_mm(c: &Configuration) -> f64 {
    c.shell.width_mm + 2.0 * c.support.plate_mm
}

#[cfg(test)]
mod tests {
    use super::super::PublishedPhysics;
    use super::*;
    use crate::prediction::predicted_curve;
    use crate::request::{Requirement, Target};

    #[test]
    fn thresholds_agree_with_predictions() {
        let request = Request {
            targets: vec![Target { quantity: Quantity::Threshold, requirement: Requirement::AtLeast(5.0) }],
            ..Request::default()
        };
        let belief = PublishedPhysics::default();
        for pins in [vec![5, 8, 11], vec![4, 8, 12], vec![6, 7, 10]] {
            let mut configuration = Configuration::default();
            configuration.layout.pins = pins;
            let f = &configuration.friction;
            let trial = Trial::new(&request, &belief, (f.load_min_n, f.load_max_n), f.points);
            let value = trial.median(&configuration).unwrap()[0];
            let curve = predicted_curve(&Design::new(configuration).unwrap());
            let predicted = Transition::of(&curve).unwrap().threshold_n;
            // Curves are solved to 1e-7 of the friction exponent.
            assert!((value / predicted - 1.0).abs() < 1e-7, "{value} {predicted}");
        }
    }
}
