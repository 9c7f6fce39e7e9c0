//! Backwards: which pins make a wanted curve. Every pattern of occupied grooves is tried with the physics.

#[cfg(feature = "parallel")]
use rayon::prelude::*;
use serde::Serialize;

use crate::physics::{Bed, Constants, PhysicsSwitch};
use crate::{Contact, PinPattern, Substrate, Transition};

/// Loads at which the sweep computes a pattern: the threshold comes out within about 1 %.
const LOADS: usize = 24;
/// Most grooves under the tendon: `2^20` patterns take over half an hour.
pub const MAX_GROOVES: usize = 20;

/// The grooves to fill and the loads to look at. Angles in radians, loads in newtons.
///
/// ```
/// use pinswitch_friction::layout_search::{Search, pareto_front};
/// use pinswitch_friction::physics::Bed;
/// use pinswitch_friction::published;
///
/// // Three pins at most in the five grooves around the middle of the published segment.
/// let pitch_rad = published::GROOVE_PITCH_DEG.to_radians();
/// let search = Search {
///     grooves: (6..=10).map(|groove| (groove, (groove as f64 - 8.0) * pitch_rad)).collect(),
///     wrap_rad: published::wrap_angle_rad(),
///     bed: Bed::published(),
///     loads_n: (3.0, 50.0),
///     pins: (2, 3),
/// };
/// let candidates = search.sweep();
/// assert_eq!(candidates.len(), 20);
/// assert!(pareto_front(&candidates).len() < candidates.len());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Angles of the grooves that the tendon touches, ascending, with their numbers from 1.
    pub grooves: Vec<(usize, f64)>,
    /// Wrap angle.
    pub wrap_rad: f64,
    /// What carries the tendon.
    pub bed: Bed,
    /// Lightest and heaviest load.
    pub loads_n: (f64, f64),
    /// Fewest and most pins.
    pub pins: (usize, usize),
}

/// A pattern and what the physics says of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutCandidate {
    /// Occupied grooves, numbered from 1.
    pub pins: Vec<usize>,
    /// Load at which silicone makes half of the friction, N; `None` if it does not within the loads.
    pub threshold_n: Option<f64>,
    /// Friction at the heaviest load, N.
    pub friction_n: f64,
    /// That friction over the friction of the pins alone.
    pub ratio: f64,
}

/// What is wanted; at least one of the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Wanted {
    /// Threshold, N.
    pub threshold_n: Option<f64>,
    /// Friction at the heaviest load, N.
    pub friction_n: Option<f64>,
}

impl Wanted {
    /// Distance from what is wanted: root of the summed squares of the logarithms of both ratios. Infinite if a
    /// threshold is wanted and there is none.
    pub fn miss(&self, threshold_n: Option<f64>, friction_n: f64) -> f64 {
        let apart = |wanted: f64, found: f64| (found / wanted).ln().powi(2);
        let threshold = match (self.threshold_n, threshold_n) {
            (Some(wanted), Some(found)) => apart(wanted, found),
            (Some(_), None) => f64::INFINITY,
            (None, _) => 0.0,
        };
        (threshold + self.friction_n.map_or(0.0, |wanted| apart(wanted, friction_n))).sqrt()
    }
}

impl Search {
    /// Number of patterns that differ in what the tendon touches.
    pub fn patterns(&self) -> usize {
        self.masks().count()
    }

    fn masks(&self) -> impl Iterator<Item = u32> {
        let (fewest, most) = self.pins;
        let grooves = self.grooves.len().min(MAX_GROOVES);
        (1..1u32 << grooves).filter(move |m| (fewest..=most).contains(&(m.count_ones() as usize)))
    }

    /// Every pattern, in the order of its occupancy as a binary number. A pattern whose equilibrium is not found is
    /// left out.
    pub fn sweep(&self) -> Vec<LayoutCandidate> {
        let masks: Vec<u32> = self.masks().collect();
        #[cfg(feature = "parallel")]
        let masks = masks.into_par_iter();
        #[cfg(not(feature = "parallel"))]
        let masks = masks.into_iter();
        masks.filter_map(|mask| self.evaluate(mask)).collect()
    }

    fn evaluate(&self, mask: u32) -> Option<LayoutCandidate> {
        let occupied: Vec<&(usize, f64)> =
            self.grooves.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, g)| g).collect();
        let pattern = PinPattern::new(occupied.iter().map(|g| g.1).collect());
        let on = |substrate| {
            Contact::new(substrate, pattern.clone(), self.wrap_rad)
                .ok()
                .map(|contact| PhysicsSwitch::new(&contact.with_bed(self.bed), Constants::published()))
        };
        let (from, to) = self.loads_n;
        let step = (to - from) / (LOADS - 1) as f64;
        let loads: Vec<f64> = (0..LOADS).map(|i| from + step * i as f64).collect();
        let states = on(Substrate::Silicone)?.states(&loads).ok()?;
        let shares: Vec<f64> = states.iter().map(|s| s.silicone_share).collect();
        let friction_n = states.last()?.friction_n;
        Some(LayoutCandidate {
            pins: occupied.iter().map(|g| g.0).collect(),
            threshold_n: Transition::threshold_n(&loads, &shares),
            friction_n,
            ratio: friction_n / on(Substrate::Abs)?.friction_n(to).ok()?,
        })
    }
}

/// Candidates that no other beats in both threshold and ratio, by ascending threshold.
pub fn pareto_front(candidates: &[LayoutCandidate]) -> Vec<&LayoutCandidate> {
    let mut switching: Vec<(f64, &LayoutCandidate)> =
        candidates.iter().filter_map(|c| Some((c.threshold_n?, c))).collect();
    switching.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.ratio.total_cmp(&a.1.ratio)));
    let mut best = 0.0;
    let mut front: Vec<&LayoutCandidate> = switching
        .into_iter()
        .filter(|(_, c)| {
            let leads = c.ratio > best;
            best = best.max(c.ratio);
            leads
        })
        .map(|(_, c)| c)
        .collect();
    front.reverse();
    front
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published;

    fn search(grooves: std::ops::RangeInclusive<usize>) -> Search {
        let pitch = published::GROOVE_PITCH_DEG.to_radians();
        Search {
            grooves: grooves.map(|i| (i, (i as f64 - 8.0) * pitch)).collect(),
            wrap_rad: published::wrap_angle_rad(),
            bed: Bed::published(),
            loads_n: (3.0766, 49.671),
            pins: (1, 15),
        }
    }

    #[test]
    fn every_pattern_is_tried() {
        let search = search(6..=10);
        let all = search.sweep();
        assert_eq!((search.patterns(), all.len()), (31, 31));
        let three = all.iter().find(|c| c.pins == [6, 8, 10]).unwrap();
        // three-single by physics, see physics::tests.
        assert!((three.friction_n - 8.99).abs() < 0.03, "{three:?}");
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let all = search(6..=10).sweep();
        let front = pareto_front(&all);
        assert!(front.windows(2).all(|w| w[0].threshold_n < w[1].threshold_n && w[0].ratio > w[1].ratio));
        for c in &all {
            let beaten = front.iter().any(|f| f.threshold_n >= c.threshold_n && f.ratio >= c.ratio);
            assert!(c.threshold_n.is_none() || beaten, "{c:?}");
        }
    }

    #[test]
    fn a_miss_is_zero_where_the_wish_is_met() {
        let wanted = Wanted { threshold_n: Some(20.0), friction_n: Some(8.0) };
        assert_eq!(wanted.miss(Some(20.0), 8.0), 0.0);
        assert_eq!(wanted.miss(None, 8.0), f64::INFINITY);
        assert!((wanted.miss(Some(20.0), 8.8) - 1.1f64.ln()).abs() < 1e-12);
    }
}
