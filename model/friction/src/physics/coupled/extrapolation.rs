//! The state at the next load, from a polynomial through the states at the loads before.

use super::Workspace;
use crate::physics::equilibrium::Supports;
use crate::physics::pair::Pair;

/// Largest sum of the magnitudes of the weights of an extrapolation.
const MAX_WEIGHT: f64 = 16.0;
/// Number of states from which the next one is extrapolated.
pub(super) const HISTORY: usize = 3;

/// State of the tendon at one load, in both directions.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) load_n: f64,
    /// Gap at each node, mm.
    pub(super) gap_mm: Vec<Pair>,
    /// Tension over load at each node.
    pub(super) ratio: Vec<Pair>,
}

impl Workspace {
    /// Sets gap and tension to those expected at `load_n`, by a polynomial through the last states.
    pub(super) fn extrapolate(&mut self, supports: &Supports<'_>, wrap_rad: f64, load_n: f64) {
        let known = self.known;
        let Some(weights) = (1..=known).rev().find_map(|order| weights(&self.history[..order], load_n))
        else {
            let gap_mm = self.guessed_gap_mm(supports, wrap_rad, load_n);
            self.gap_mm.fill(Pair::both(gap_mm));
            self.tension_n.fill(Pair::both(load_n));
            return;
        };
        let [a, b, c] = &self.history;
        for i in 0..self.nodes.len() {
            let sum = |x: Pair, y: Pair, z: Pair| x * weights[0] + y * weights[1] + z * weights[2];
            self.gap_mm[i] = sum(a.gap_mm[i], b.gap_mm[i], c.gap_mm[i]);
            self.tension_n[i] = sum(a.ratio[i], b.ratio[i], c.ratio[i]) * load_n;
        }
        if self.tension_n.iter().any(|t| !t.all(|t| t > 0.0)) {
            let last = &self.history[0];
            self.gap_mm.copy_from_slice(&last.gap_mm);
            self.tension_n.iter_mut().zip(&last.ratio).for_each(|(t, ratio)| *t = *ratio * load_n);
        }
    }

    /// Returns a gap without a similar state: that of pins that carry the whole load, or of the
    /// tendon on silicone without pins if they sink flush.
    fn guessed_gap_mm(&self, supports: &Supports<'_>, wrap_rad: f64, load_n: f64) -> f64 {
        let bed = supports.bed;
        let flush_n = supports.flush_force_n * self.pins.len() as f64;
        // Of N = N0 (1 + b) x/(1 + b x).
        let share = load_n * wrap_rad / flush_n;
        let sunk = share / (1.0 + bed.softening * (1.0 - share));
        if share < 1.0 {
            bed.protrusion_mm() * (1.0 - sunk)
        } else {
            -load_n / (bed.stiffness_n_mm2() * bed.axis_radius_mm())
        }
    }

    pub(super) fn remember(&mut self, load_n: f64) {
        self.history.rotate_right(1);
        let state = &mut self.history[0];
        state.load_n = load_n;
        state.gap_mm.copy_from_slice(&self.gap_mm);
        state.ratio.iter_mut().zip(&self.tension_n).for_each(|(ratio, t)| *ratio = *t * (1.0 / load_n));
        self.known = (self.known + 1).min(HISTORY);
    }
}

/// Returns the weights of the states in the polynomial through them at `load_n`; `None` if they are
/// too large, because the loads are too close together.
fn weights(states: &[State], load_n: f64) -> Option<[f64; HISTORY]> {
    let mut weights = [0.0; HISTORY];
    for (i, state) in states.iter().enumerate() {
        let mut weight = 1.0;
        for (j, other) in states.iter().enumerate() {
            if i != j {
                weight *= (load_n - other.load_n) / (state.load_n - other.load_n);
            }
        }
        weights[i] = weight;
    }
    let sum: f64 = weights.iter().map(|w| w.abs()).sum();
    (sum <= MAX_WEIGHT).then_some(weights)
}
