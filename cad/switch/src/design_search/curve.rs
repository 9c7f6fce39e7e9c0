//! Curves without bands, whose states are computed where they are needed, and the values of the target quantities.
//!
//! A target depends on the states around a threshold or at a load, and not on those at all other
//! loads of a search. The share of the silicone rises with the load, so that a bisection finds the
//! threshold among them.

use crate::request::Quantity;

/// Half of the logarithm of the ratio of loads over which the stiffness is computed: the curve from
/// 15 % below to 15 % above the threshold. A narrower range shows the mesh of the physics, and a
/// wider one cuts off the knee.
const STIFFNESS_HALF_SPAN: f64 = 0.14;

/// Friction and share of the silicone at one load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadState {
    /// Friction, N.
    pub friction_n: f64,
    /// Share of the friction that silicone carries.
    pub silicone_share: f64,
}

impl LoadState {
    /// Returns the state with the friction multiplied by `exp(error)`.
    #[must_use]
    pub fn scaled(self, error: f64) -> Self {
        Self { friction_n: self.friction_n * libm::exp(error), ..self }
    }
}

/// The threshold of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switching {
    /// Load at which silicone carries half of the friction, N. If no load reaches this share, an
    /// extrapolated load that is monotonic in the share at the end of the curve.
    pub threshold_n: f64,
    /// Whether the threshold is within the loads of the curve.
    pub is_found: bool,
    /// Index of the first load at or above the threshold; the number of loads if there is none.
    pub next: usize,
}

/// A curve at ascending loads. A state is computed when it is first needed.
pub struct Curve<'a> {
    loads_n: &'a [f64],
    known: Vec<Option<LoadState>>,
    compute: Box<dyn FnMut(usize) -> Option<LoadState> + 'a>,
    /// Index of the first load above the threshold of a similar curve.
    expected: Option<usize>,
}

impl<'a> Curve<'a> {
    /// Creates a curve at `loads_n`, in newtons, ascending. `compute` returns the state at the load
    /// with this index; `None` if it cannot be computed.
    pub fn new(loads_n: &'a [f64], compute: impl FnMut(usize) -> Option<LoadState> + 'a) -> Self {
        Self { loads_n, known: vec![None; loads_n.len()], compute: Box::new(compute), expected: None }
    }

    /// Returns the same curve, whose threshold is expected below the load with this index. A good
    /// guess makes the search for it short, and does not change its result.
    #[must_use]
    pub fn expecting(self, next: usize) -> Self {
        Self { expected: Some(next), ..self }
    }

    /// Returns the state at the load with this index; `None` if it cannot be computed.
    pub fn state(&mut self, index: usize) -> Option<LoadState> {
        if self.known[index].is_none() {
            self.known[index] = (self.compute)(index);
        }
        self.known[index]
    }

    /// Returns the share of the silicone at every load.
    pub fn silicone_shares(&mut self) -> Option<Vec<f64>> {
        (0..self.loads_n.len()).map(|i| Some(self.state(i)?.silicone_share)).collect()
    }

    /// Returns whether silicone carries half of the friction at the load with this index.
    fn is_beyond(&mut self, index: usize) -> Option<bool> {
        Some(self.state(index)?.silicone_share >= 0.5)
    }

    /// Returns the index of the first load at or above the threshold; the number of loads if there
    /// is none.
    fn first_beyond(&mut self) -> Option<usize> {
        // At `low` and below, silicone carries less than half; at `high` and above, half or more.
        let (mut low, mut high) = (None, self.loads_n.len());
        if let Some(expected) = self.expected.map(|next| next.min(high)) {
            // Steps from the guess double until they enclose the threshold.
            let mut step = 1;
            if expected < high && self.is_beyond(expected)? {
                high = expected;
                while let Some(index) = high.checked_sub(step) {
                    if !self.is_beyond(index)? {
                        low = Some(index);
                        break;
                    }
                    (high, step) = (index, 2 * step);
                }
            } else {
                let mut index = expected.min(high.saturating_sub(1));
                while index < high {
                    if self.is_beyond(index)? {
                        high = index;
                        break;
                    }
                    low = Some(index);
                    (index, step) = (index + step, 2 * step);
                }
            }
        }
        loop {
            let first = low.map_or(0, |low| low + 1);
            if first >= high {
                return Some(high);
            }
            let middle = usize::midpoint(first, high - 1);
            if self.is_beyond(middle)? {
                high = middle;
            } else {
                low = Some(middle);
            }
        }
    }

    /// Returns the threshold; `None` if a state cannot be computed, or without loads.
    pub fn switching(&mut self) -> Option<Switching> {
        let next = self.first_beyond()?;
        let last = self.loads_n.len().checked_sub(1)?;
        if next == 0 {
            let share = self.state(0)?.silicone_share;
            return Some(Switching { threshold_n: self.loads_n[0] * 0.5 / share, is_found: false, next });
        }
        if next > last {
            let share = self.state(last)?.silicone_share;
            let threshold_n = self.loads_n[last] * 0.5 / share.max(0.05);
            return Some(Switching { threshold_n, is_found: false, next });
        }
        let (below, above) = (self.state(next - 1)?.silicone_share, self.state(next)?.silicone_share);
        let part = (0.5 - below) / (above - below);
        let (from, to) = (self.loads_n[next - 1], self.loads_n[next]);
        Some(Switching { threshold_n: from * libm::pow(to / from, part), is_found: true, next })
    }

    /// Returns the friction at `load_n`, interpolated linearly in the logarithms of both, and
    /// constant beyond the ends.
    pub fn friction_at(&mut self, load_n: f64) -> Option<f64> {
        let i = self.loads_n.partition_point(|l| *l < load_n);
        let last = self.loads_n.len().checked_sub(1)?;
        if i == 0 || i > last || load_n == self.loads_n[i] {
            return Some(self.state(i.min(last))?.friction_n);
        }
        let (l0, l1) = (self.loads_n[i - 1], self.loads_n[i]);
        let (below, above) = (self.state(i - 1)?.friction_n.max(1e-9), self.state(i)?.friction_n.max(1e-9));
        Some(below * libm::pow(above / below, libm::log(load_n / l0) / libm::log(l1 / l0)))
    }

    /// Returns the value of `quantity`; `range_n` contains the lightest and the heaviest load.
    pub fn value(&mut self, quantity: Quantity, range_n: (f64, f64)) -> Option<f64> {
        match quantity {
            Quantity::Threshold => Some(self.switching()?.threshold_n),
            Quantity::Friction { load_n } => self.friction_at(load_n),
            Quantity::LowLoadFriction => self.friction_at(range_n.0),
            Quantity::MaxFriction => self.friction_at(range_n.1),
            Quantity::Stiffness => {
                let threshold_n = self.switching()?.threshold_n;
                self.stiffness(threshold_n)
            }
        }
    }

    /// Returns `d ln D / d ln F` around `load_n`.
    fn stiffness(&mut self, load_n: f64) -> Option<f64> {
        let (first, last) = (*self.loads_n.first()?, *self.loads_n.last()?);
        let low = (load_n * libm::exp(-STIFFNESS_HALF_SPAN)).clamp(first, last);
        let high = (load_n * libm::exp(STIFFNESS_HALF_SPAN)).clamp(first, last);
        if high <= low * 1.0001 {
            return Some(1.0);
        }
        Some(libm::log(self.friction_at(high)? / self.friction_at(low)?) / libm::log(high / low))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;

    fn loads() -> Vec<f64> {
        (0..40).map(|i| 2.0 * 1.1f64.powi(i)).collect()
    }

    /// A power law, with this share of the silicone at each load.
    fn power_law(loads_n: &[f64], share: fn(f64) -> f64) -> Curve<'_> {
        Curve::new(loads_n, move |i| {
            let friction_n = 0.01 * libm::pow(loads_n[i], 1.5);
            Some(LoadState { friction_n, silicone_share: share(loads_n[i]) })
        })
    }

    #[test]
    fn quantities_of_a_power_law() {
        let loads = loads();
        let mut c = power_law(&loads, |l| l / (l + 20.0));
        assert!((c.friction_at(33.3).unwrap() - 0.01 * libm::pow(33.3f64, 1.5)).abs() < 1e-9);
        let switching = c.switching().unwrap();
        assert!(switching.is_found && (switching.threshold_n - 20.0).abs() < 0.05, "{switching:?}");
        assert!((c.value(Quantity::Stiffness, (2.0, 50.0)).unwrap() - 1.5).abs() < 1e-6);
    }

    #[test]
    fn a_threshold_beyond_the_loads_lies_beyond_them() {
        let loads = loads();
        let after = power_law(&loads, |l| 0.3 * l / (l + 20.0)).switching().unwrap();
        assert!(!after.is_found && after.threshold_n > loads[39]);
        let before = power_law(&loads, |_| 0.9).switching().unwrap();
        assert!(!before.is_found && before.threshold_n < loads[0]);
    }

    proptest! {
        /// With any guess or none, the bisection finds what a scan of all loads finds.
        #[test]
        fn every_search_finds_the_first_load_beyond(
            first in 0..12usize, expected in prop::option::of(0..15usize),
        ) {
            let loads: Vec<f64> = (1..=10).map(f64::from).collect();
            let evaluated = Cell::new(0);
            let mut curve = Curve::new(&loads, |i| {
                evaluated.set(evaluated.get() + 1);
                Some(LoadState { friction_n: 1.0, silicone_share: if i < first { 0.4 } else { 0.6 } })
            });
            if let Some(next) = expected {
                curve = curve.expecting(next);
            }
            prop_assert_eq!(curve.first_beyond(), Some(first.min(10)));
            if expected == Some(first) {
                prop_assert!(evaluated.get() <= 2);
            }
        }
    }

    #[test]
    fn states_that_cannot_be_computed_matter_where_they_are_needed() {
        let loads = [1.0, 2.0, 3.0];
        let mut curve =
            Curve::new(&loads, |i| (i < 2).then_some(LoadState { friction_n: 1.0, silicone_share: 0.2 }));
        assert_eq!(curve.friction_at(1.5), Some(1.0));
        assert_eq!(curve.friction_at(2.5), None);
        assert_eq!(curve.switching(), None);
    }
}
