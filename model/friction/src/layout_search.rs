//! Search over pin patterns for a wanted curve: evaluates every pattern of occupied grooves with
//! the physics.

#[cfg(feature = "parallel")]
use rayon::prelude::*;
use serde::Serialize;

use crate::bed::Bed;
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::physics::{Constants, PhysicsSwitch};
use crate::sort::sort_by_number;
use crate::substrate::Substrate;
use crate::transition::Transition;

/// Number of loads per pattern; the error of the threshold is about 1 %.
const LOADS: usize = 24;
/// Largest number of grooves under the tendon: `2^20` patterns take over half an hour.
pub const MAX_GROOVES: usize = 20;
/// Largest deviation of mirror images from symmetry, in radians.
const SYMMETRY_RAD: f64 = 1e-9;

/// Grooves, number of pins, and loads of a search. Angles are in radians, loads in newtons.
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
/// // 10 pairs and 10 triples, counting mirror images once.
/// assert_eq!(candidates.len(), 12);
/// assert!(pareto_front(&candidates).len() < candidates.len());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Numbers (from 1) and angles of the grooves under the tendon, in ascending order.
    pub grooves: Vec<(usize, f64)>,
    /// Wrap angle.
    pub wrap_rad: f64,
    /// Support of the tendon.
    pub bed: Bed,
    /// Lightest and heaviest load.
    pub loads_n: (f64, f64),
    /// Smallest and largest number of pins.
    pub pins: (usize, usize),
}

/// Pin pattern with its threshold and friction by the physics.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutCandidate {
    /// Occupied grooves, numbered from 1.
    pub pins: Vec<usize>,
    /// Load at which silicone carries half of the friction, N; `None` if it is not within the
    /// loads.
    pub threshold_n: Option<f64>,
    /// Friction at the heaviest load, N.
    pub friction_n: f64,
}

impl Search {
    /// Evaluates every pattern of [`patterns`], in its order. Skips a pattern without an
    /// equilibrium.
    pub fn sweep(&self) -> Vec<LayoutCandidate> {
        let all = patterns(&self.grooves, self.pins);
        #[cfg(feature = "parallel")]
        let all = all.into_par_iter();
        #[cfg(not(feature = "parallel"))]
        let all = all.into_iter();
        all.filter_map(|pins| self.evaluate(&pins)).collect()
    }

    fn evaluate(&self, pins: &[usize]) -> Option<LayoutCandidate> {
        let occupied: Vec<&(usize, f64)> = self.grooves.iter().filter(|(n, _)| pins.contains(n)).collect();
        let pattern = PinPattern::new(occupied.iter().map(|g| g.1).collect());
        let contact = Contact::new(Substrate::Silicone, pattern, self.wrap_rad).ok()?.with_bed(self.bed);
        let switch = PhysicsSwitch::new(&contact, Constants::published());
        let (from, to) = self.loads_n;
        let step = (to - from) / (LOADS - 1) as f64;
        let loads: Vec<f64> = (0..LOADS).map(|i| from + step * i as f64).collect();
        let states = switch.states(&loads).ok()?;
        let shares: Vec<f64> = states.iter().map(|s| s.silicone_share).collect();
        Some(LayoutCandidate {
            pins: pins.to_vec(),
            threshold_n: Transition::threshold_n(&loads, &shares),
            friction_n: states.last()?.friction_n,
        })
    }
}

/// Returns every selection of `fewest` to `most` of `grooves` (numbers and angles, ascending),
/// ordered by its occupancy as a binary number.
///
/// Of two mirror images about the middle of the wrap it returns the first only: mirroring changes
/// the friction of a switch by less than 0.1 %.
///
/// ```
/// use pinswitch_friction::layout_search::patterns;
///
/// let grooves: Vec<(usize, f64)> = (1..=5).map(|i| (i, 0.1 * (i as f64 - 3.0))).collect();
/// let pairs = patterns(&grooves, (2, 2));
/// assert!(pairs.contains(&vec![1, 2]) && !pairs.contains(&vec![4, 5]));
/// assert_eq!(pairs.len(), 6);
/// ```
pub fn patterns(grooves: &[(usize, f64)], (fewest, most): (usize, usize)) -> Vec<Vec<usize>> {
    let grooves = &grooves[..grooves.len().min(MAX_GROOVES)];
    let count = grooves.len() as u32;
    // A pattern has a mirror image only if each groove has a partner on the other side.
    let is_symmetric =
        grooves.iter().zip(grooves.iter().rev()).all(|(a, b)| (a.1 + b.1).abs() < SYMMETRY_RAD);
    let mirrored = |mask: u32| mask.reverse_bits() >> (u32::BITS - count.max(1));
    (1..1u32 << count)
        .filter(|mask| (fewest..=most).contains(&(mask.count_ones() as usize)))
        .filter(|mask| !is_symmetric || *mask <= mirrored(*mask))
        .map(|mask| {
            grooves.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, g)| g.0).collect()
        })
        .collect()
}

/// Returns the candidates that no other exceeds in both threshold and friction, by ascending
/// threshold.
pub fn pareto_front(candidates: &[LayoutCandidate]) -> Vec<&LayoutCandidate> {
    let mut switching: Vec<(f64, &LayoutCandidate)> =
        candidates.iter().filter_map(|c| Some((c.threshold_n?, c))).collect();
    sort_by_number(&mut switching, |(_, c)| -c.friction_n);
    sort_by_number(&mut switching, |(threshold_n, _)| -threshold_n);
    let mut best = 0.0;
    let mut front: Vec<&LayoutCandidate> = switching
        .into_iter()
        .filter(|(_, c)| {
            let leads = c.friction_n > best;
            best = best.max(c.friction_n);
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
    fn every_pattern_is_evaluated() {
        let search = search(6..=10);
        let all = search.sweep();
        // 31 occupancies: 7 are symmetric, the others are pairs of mirror images.
        assert_eq!(all.len(), (31 - 7) / 2 + 7);
        let three = all.iter().find(|c| c.pins == [6, 8, 10]).unwrap();
        // three-single by the physics, see physics::tests.
        assert!((three.friction_n - 8.99).abs() < 0.03, "{three:?}");
    }

    #[test]
    fn front_dominates_all_candidates() {
        let all = search(6..=10).sweep();
        let front = pareto_front(&all);
        assert!(
            front
                .windows(2)
                .all(|w| w[0].threshold_n < w[1].threshold_n && w[0].friction_n > w[1].friction_n)
        );
        for c in &all {
            let beaten = front.iter().any(|f| f.threshold_n >= c.threshold_n && f.friction_n >= c.friction_n);
            assert!(c.threshold_n.is_none() || beaten, "{c:?}");
        }
    }
}
