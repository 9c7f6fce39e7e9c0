//! The search space: available materials, patterns of grooves, and ranges of continuous parameters.

use pinswitch_friction::layout_search::{MAX_GROOVES, patterns};

use crate::config::Configuration;
use crate::design::contact_of;
use crate::request::{Parameter, Request, Varied};

/// A base configuration with the parameters that may vary.
pub(super) struct Space {
    /// The base with each combination of materials.
    pub(super) materials: Vec<Configuration>,
    /// Continuous parameters.
    pub(super) varied: Vec<Varied>,
    /// Fewest and most pins.
    pins: (usize, usize),
    vary_pattern: bool,
}

impl Space {
    pub(super) fn new(base: &Configuration, request: &Request) -> Self {
        let mut materials = vec![base.clone()];
        let lists = [
            (Parameter::PinDiameterMm, &request.materials.pin_diameter_mm),
            (Parameter::HardnessShoreA, &request.materials.hardness_shore_a),
        ];
        for (parameter, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            materials = each_with(&materials, list, |c, value| parameter.set(c, *value));
        }
        if !request.materials.tendon.is_empty() {
            materials = each_with(&materials, &request.materials.tendon, |c, tendon| {
                c.tendon.rope_diameter_mm = tendon.rope_diameter_mm;
                c.tendon.coating_mm = tendon.coating_mm;
            });
        }
        let grooves = base.segment.grooves;
        let pins = request.limits.pins.map_or((1, grooves), |(fewest, most)| (fewest, most.min(grooves)));
        // The same request finds the same designs, in whatever order it names its parameters.
        let mut varied = request.vary.parameters.clone();
        varied.sort_by_key(|v| v.parameter);
        Self { materials, varied, pins, vary_pattern: request.vary.pattern }
    }

    /// Returns the position of the base, each parameter scaled from 0 to 1 over its range.
    pub(super) fn base(&self) -> Vec<f64> {
        let at = |v: &Varied| {
            let value = v.parameter.value(&self.materials[0]);
            if v.to > v.from { ((value - v.from) / (v.to - v.from)).clamp(0.0, 1.0) } else { 0.0 }
        };
        self.varied.iter().map(at).collect()
    }

    /// Returns point `index` of a Halton sequence, which covers the ranges evenly.
    pub(super) fn spread_point(&self, index: usize) -> Vec<f64> {
        const PRIMES: [usize; 7] = [2, 3, 5, 7, 11, 13, 17];
        self.varied.iter().zip(PRIMES).map(|(_, prime)| radical_inverse(index, prime)).collect()
    }

    /// Returns the configuration at a place, with parameters rounded to values that can be made.
    pub(super) fn configuration(&self, material: usize, pins: &[usize], at: &[f64]) -> Configuration {
        let mut c = self.materials[material].clone();
        c.layout.pins = pins.to_vec();
        for (v, x) in self.varied.iter().zip(at) {
            let value = v.from + (v.to - v.from) * x.clamp(0.0, 1.0);
            v.parameter.set(&mut c, v.parameter.rounded(value, (v.from, v.to)));
        }
        c
    }

    /// Returns the patterns within the wrap to evaluate at a place, at most `most`. Mirror images
    /// occur once.
    pub(super) fn patterns(&self, material: usize, at: &[f64], most: usize) -> Patterns {
        let own = &self.materials[material].layout.pins;
        if !self.vary_pattern {
            return Patterns { all: 1, taken: vec![own.clone()] };
        }
        let c = self.configuration(material, own, at);
        let half_rad = c.layout.wrap_angle_deg.to_radians() / 2.0;
        let pitch_rad = c.segment.span_deg.to_radians() / c.segment.grooves as f64;
        // Grooves are numbered as in the base. If the wrap needs more grooves, `configuration`
        // renumbers the pins.
        let count = self.materials[material].segment.grooves;
        let middle = (count as f64 - 1.0) / 2.0;
        let mut grooves: Vec<(usize, f64)> = (0..count)
            .map(|i| (i + 1, (i as f64 - middle) * pitch_rad))
            // A pin outside the wrap carries no load, so patterns with such a pin are redundant.
            .filter(|(_, angle)| angle.abs() <= half_rad)
            .collect();
        // Every second groove is omitted until the patterns can be enumerated.
        while grooves.len() > MAX_GROOVES {
            grooves = grooves.into_iter().step_by(2).collect();
        }
        let found = patterns(&grooves, self.pins);
        let all = found.len();
        Patterns { all, taken: thinned(found, most) }
    }
}

/// The selected patterns, and the number of all patterns.
pub(super) struct Patterns {
    pub(super) all: usize,
    pub(super) taken: Vec<Vec<usize>>,
}

/// Returns at most `most` patterns: the even ones first, then an evenly spaced selection of the
/// others.
fn thinned(all: Vec<Vec<usize>>, most: usize) -> Vec<Vec<usize>> {
    if all.len() <= most {
        return all;
    }
    let is_even = |pins: &Vec<usize>| pins.windows(2).all(|w| w[1] - w[0] == pins[1] - pins[0]);
    let (mut even, others): (Vec<_>, Vec<_>) = all.into_iter().partition(is_even);
    even.truncate(most);
    let room = most - even.len();
    let count = others.len();
    even.extend(
        others
            .into_iter()
            .enumerate()
            .filter(|(i, _)| i * room / count != (i + 1) * room / count)
            .map(|o| o.1),
    );
    even
}

fn each_with<T>(
    all: &[Configuration],
    values: &[T],
    set: impl Fn(&mut Configuration, &T),
) -> Vec<Configuration> {
    all.iter()
        .flat_map(|c| {
            values.iter().map(|value| {
                let mut changed = c.clone();
                set(&mut changed, value);
                changed
            })
        })
        .collect()
}

/// Returns the digits of `index` in `base`, mirrored at the radix point.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / base as f64);
    while index > 0 {
        value += (index % base) as f64 * digit;
        index /= base;
        digit /= base as f64;
    }
    value
}

/// Returns whether `configuration` can be predicted. The range that a configuration accepts may
/// contain values without a contact.
pub(super) fn is_predictable(configuration: &Configuration) -> bool {
    contact_of(configuration.clone()).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::{Quantity, Requirement, Target};

    #[test]
    fn materials_are_combined_and_places_are_within_their_ranges() {
        let mut request = Request {
            targets: vec![Target { quantity: Quantity::Threshold, requirement: Requirement::AtLeast(5.0) }],
            ..Request::default()
        };
        request.materials.pin_diameter_mm = vec![0.8, 1.0];
        request.materials.hardness_shore_a = vec![30.0, 40.0, 50.0];
        let space = Space::new(&Configuration::default(), &request);
        assert_eq!(space.materials.len(), 6);
        for index in 1..20 {
            let c = space.configuration(0, &[5, 8, 11], &space.spread_point(index));
            for v in &space.varied {
                let value = v.parameter.value(&c);
                assert!(value >= v.from - 1e-6 && value <= v.to + 1e-6, "{value} {v:?}");
            }
        }
        request.vary.pattern = false;
        request.vary.parameters = vec![Varied { parameter: Parameter::WrapDeg, from: 120.0, to: 120.0 }];
        let mut kept = Configuration::default();
        kept.layout.pins = vec![5, 8, 11];
        let wide = Space::new(&kept, &request);
        let pins = &wide.patterns(0, &wide.base(), 9).taken[0];
        assert_eq!(
            wide.configuration(0, pins, &wide.base()).layout.pins,
            [8, 11, 14],
            "three grooves more on each side"
        );
        let patterns = space.patterns(0, &space.base(), 100);
        assert!(patterns.all > 900 && patterns.taken.len() <= 100 && patterns.taken.len() > 90);
    }
}
