//! Derivatives of the friction exponents with respect to constants and dimensions, by the implicit function theorem: a
//! back-substitution for each pass of the fixed point over shape and tension.

// A parameter is the index into several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::elimination::middle_row;
use super::{CONSTANTS, Explicit, Workspace};
use crate::bed::Bed;
use crate::physics::constants::Constants;
use crate::physics::equilibrium::Supports;
use crate::physics::pair::Pair;

/// Largest change of a derivative of the log tension in the last pass, relative to the largest
/// derivative.
const DERIVATIVE_TOLERANCE: f64 = 1e-7;
/// Largest number of passes over shape and tension for derivatives; 5 to 8 are usual.
pub(in crate::physics) const MAX_PASSES: usize = 60;

/// Derivatives of the friction exponents with respect to parameters, as many as there are constants.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct ExponentSlopes {
    /// Of the whole exponent.
    pub(in crate::physics) total: [Pair; CONSTANTS],
    /// Of the silicone's part.
    pub(in crate::physics) silicone: [Pair; CONSTANTS],
}

/// Arrays of derivatives with respect to as many parameters as there are constants.
#[derive(Clone, Debug, Default)]
pub(super) struct Derivatives {
    explicit: [Explicit; CONSTANTS],
    right: Vec<[Pair; CONSTANTS]>,
    turn: Vec<[Pair; CONSTANTS]>,
    pin_turn: Vec<[Pair; CONSTANTS]>,
    log_tension: Vec<[Pair; CONSTANTS]>,
}

impl Workspace {
    /// Computes the derivatives of the friction exponents of both directions with respect to the
    /// logarithms of `kappa`, `mu_s`, `N0` and the foundation stiffness, at the last load. `None` if a derivative does not
    /// converge.
    ///
    /// Touching nodes and pins stay those of the solution; where one is about to touch, the
    /// derivatives are one-sided.
    pub(in crate::physics) fn derivatives(
        &mut self,
        supports: &Supports<'_>,
        constants: &Constants,
        wrap_rad: f64,
    ) -> Option<[Pair; CONSTANTS]> {
        if !self.refactor(supports) {
            return None;
        }
        let mut explicit = std::mem::take(&mut self.derivatives.explicit);
        explicit[0].log_kappa = 1.0;
        explicit[1].log_mu = 1.0;
        explicit[2].pin_n.clone_from(&self.pin_n);
        explicit[3].silicone_n.clear();
        explicit[3]
            .silicone_n
            .extend(self.silicone_turn.iter().zip(&self.tension_n).map(|(turn, t)| *turn * *t));
        let foundation_n = explicit[3].silicone_n.clone();
        explicit[3].node_n = foundation_n;
        let slopes = self.slopes(supports, constants, wrap_rad, &explicit);
        self.derivatives.explicit = explicit;
        slopes.map(|slopes| slopes.total)
    }

    /// Linearises and factorises the balance of forces at the last load. Returns `false` if the
    /// matrix is not positive definite.
    pub(in crate::physics) fn refactor(&mut self, supports: &Supports<'_>) -> bool {
        let bending = self.bending_n_mm2(supports.bed);
        self.supports_at_gap(supports);
        if !self.solve(bending) {
            return false;
        }
        for i in 0..self.nodes.len() {
            let stiffness = self.nodes[i].silicone_n_mm;
            let force = self.gap_mm[i].where_negative(self.gap_mm[i] * -stiffness);
            self.silicone_turn[i] = force / self.tension_n[i];
        }
        true
    }

    /// Computes the derivatives of the friction exponents with respect to parameters, from their
    /// explicit derivatives, after [`Workspace::refactor`]. `None` if a derivative does not
    /// converge.
    pub(in crate::physics) fn slopes(
        &mut self,
        supports: &Supports<'_>,
        constants: &Constants,
        wrap_rad: f64,
        explicit: &[Explicit; CONSTANTS],
    ) -> Option<ExponentSlopes> {
        let (n, mu) = (self.nodes.len(), constants.mu_silicone);
        let kappa = constants.kappa_per_sqrt_n * supports.bed.ploughing_ratio();
        let bending = self.bending_n_mm2(supports.bed);
        let turned = self.turned();
        let closure = Pair::both(wrap_rad) / turned;
        let lowest = self.lowest_tension();
        let bending_slope = self.bending_slope(supports.bed, bending);
        let mut d = std::mem::take(&mut self.derivatives);
        let zero = [Pair::both(0.0); CONSTANTS];
        d.right.resize(n, zero);
        d.turn.resize(n, zero);
        d.pin_turn.resize(self.pins.len(), zero);
        d.log_tension.resize(n, zero);
        d.log_tension.fill(zero);
        let mut result = None;
        for _ in 0..MAX_PASSES {
            self.derivative_of_gap(&mut d, explicit, lowest, bending_slope);
            self.derivative_of_turns(&mut d, explicit, closure, turned);
            let (slopes, change) = self.derivative_of_tension(&mut d, explicit, [mu, kappa], closure);
            if change <= DERIVATIVE_TOLERANCE {
                result = Some(slopes);
                break;
            }
        }
        self.derivatives = d;
        result
    }

    /// Returns the node of the lowest tension of each direction, which limits the bending
    /// stiffness.
    fn lowest_tension(&self) -> [usize; 2] {
        [0, 1].map(|lane| {
            let tension = |i: usize| self.tension_n[i].lane(lane);
            (1..self.nodes.len()).fold(0, |least, i| if tension(i) < tension(least) { i } else { least })
        })
    }

    /// Returns the derivative of the bending stiffness with respect to the logarithm of the lowest
    /// tension.
    fn bending_slope(&self, bed: &Bed, bending: Pair) -> Pair {
        let least = self.tension_n.iter().fold(Pair::both(f64::INFINITY), |least, t| least.min(*t));
        Pair::new([0, 1].map(|i| bed.tendon_bending_slope_n_mm2(bending.lane(i), least.lane(i))))
    }

    /// Solves the linearised balance of forces for the derivatives of the gap, into `d.right`.
    fn derivative_of_gap(
        &self,
        d: &mut Derivatives,
        explicit: &[Explicit; CONSTANTS],
        lowest: [usize; 2],
        bending_slope: Pair,
    ) {
        let n = self.nodes.len();
        let u = &self.gap_mm;
        let bent: [Pair; CONSTANTS] = std::array::from_fn(|k| {
            bending_slope * Pair::new([0, 1].map(|lane| d.log_tension[lowest[lane]][k].lane(lane)))
        });
        // Derivative of the string's pull across the element before.
        let mut pull_before = [Pair::both(0.0); CONSTANTS];
        for i in 0..n {
            let node = &self.nodes[i];
            let next = (i + 1).min(n - 1);
            let stretch = (u[i] - u[next]) * (0.5 * node.per_element_mm);
            let string = self.tension_n[i] * (u[i] * node.string - Pair::both(node.string_load));
            let mut bend = u[i] * node.bending[0] - Pair::both(node.bending_load);
            if i + 1 < n {
                bend = bend + u[i + 1] * node.bending[1];
            }
            if i + 2 < n {
                bend = bend + u[i + 2] * node.bending[2];
            }
            if i >= 1 {
                bend = bend + u[i - 1] * self.nodes[i - 1].bending[1];
            }
            if i >= 2 {
                bend = bend + u[i - 2] * self.nodes[i - 2].bending[2];
            }
            for k in 0..CONSTANTS {
                let (here, there) = (d.log_tension[i][k], d.log_tension[next][k]);
                let pull = stretch * (self.tension_n[i] * here + self.tension_n[next] * there);
                let force = pull - pull_before[k] + string * here + bend * bent[k];
                pull_before[k] = pull;
                d.right[i][k] = Pair::both(0.0) - force;
            }
        }
        for (k, explicit) in explicit.iter().enumerate() {
            for (node, force) in self.pins.iter().zip(&explicit.pin_n) {
                d.right[*node][k] = d.right[*node][k] + *force;
            }
            for (right, force) in d.right.iter_mut().zip(&explicit.node_n) {
                right[k] = right[k] + *force;
            }
        }
        self.substitute(&mut d.right);
    }

    /// Solves for right sides of the constants, with the factors of [`Workspace::solve`].
    fn substitute(&self, right: &mut [[Pair; CONSTANTS]]) {
        let (n, factors) = (right.len(), &self.factors[..right.len()]);
        let middle = middle_row(n);
        let mut top = [[Pair::both(0.0); 2]; CONSTANTS];
        let mut bottom = top;
        let reduce = |[inverse, one, two]: [Pair; 3],
                      b: &mut [Pair; CONSTANTS],
                      carry: &mut [[Pair; 2]; CONSTANTS]| {
            for (b, carry) in b.iter_mut().zip(carry) {
                let reduced = *b - carry[0];
                *carry = [one * reduced + carry[1], two * reduced];
                *b = reduced * inverse;
            }
        };
        for k in 0..n - 2 - middle {
            if k < middle {
                reduce(factors[k], &mut right[k], &mut top);
            }
            reduce(factors[n - 1 - k], &mut right[n - 1 - k], &mut bottom);
        }
        for (top, bottom) in top.iter_mut().zip(&bottom) {
            top[0] = top[0] + bottom[1];
        }
        reduce(factors[middle], &mut right[middle], &mut top);
        for (top, bottom) in top.iter_mut().zip(&bottom) {
            top[0] = top[0] + bottom[0];
        }
        reduce(factors[middle + 1], &mut right[middle + 1], &mut top);
        let zero = [Pair::both(0.0); CONSTANTS];
        let (mut x, mut y) = ((right[middle + 1], zero), (zero, zero));
        let back = |[_, one, two]: [Pair; 3],
                    b: &mut [Pair; CONSTANTS],
                    near: &mut ([Pair; CONSTANTS], [Pair; CONSTANTS])| {
            for k in 0..CONSTANTS {
                let x = b[k] - two * near.1[k] - one * near.0[k];
                b[k] = x;
                (near.1[k], near.0[k]) = (near.0[k], x);
            }
        };
        back(factors[middle], &mut right[middle], &mut x);
        y.0 = right[middle + 1];
        y.1 = right[middle];
        for k in 0..n - 2 - middle {
            if k < middle {
                back(factors[middle - 1 - k], &mut right[middle - 1 - k], &mut x);
            }
            back(factors[middle + 2 + k], &mut right[middle + 2 + k], &mut y);
        }
    }

    /// Computes the derivatives of the turns from those of gap and tension. They sum to that of the
    /// wrap.
    fn derivative_of_turns(
        &self,
        d: &mut Derivatives,
        explicit: &[Explicit; CONSTANTS],
        closure: Pair,
        turned: Pair,
    ) {
        let mut sum = [Pair::both(0.0); CONSTANTS];
        for i in 0..self.nodes.len() {
            let (t, turn) = (self.tension_n[i], self.silicone_turn[i]);
            let stiffness =
                self.gap_mm[i].map(|u| if u < 0.0 { self.nodes[i].silicone_n_mm } else { 0.0 }) / t;
            for k in 0..CONSTANTS {
                let own = explicit[k].silicone_n.get(i).map_or(Pair::both(0.0), |force| *force / t);
                let by = own - stiffness * d.right[i][k] - turn * d.log_tension[i][k];
                d.turn[i][k] = by;
                sum[k] = sum[k] + by;
            }
        }
        for (p, &node) in self.pins.iter().enumerate() {
            let t = self.tension_n[node];
            let (turn, stiffness) = (self.pin_n[p] / t, self.pin_n_mm[p] / t);
            for k in 0..CONSTANTS {
                let own = explicit[k].pin_n.get(p).map_or(Pair::both(0.0), |force| *force / t);
                let by = own - stiffness * d.right[node][k] - turn * d.log_tension[node][k];
                d.pin_turn[p][k] = by;
                sum[k] = sum[k] + by;
            }
        }
        let mut closing = sum.map(|sum| sum / turned);
        for (closing, explicit) in closing.iter_mut().zip(explicit) {
            *closing = *closing - Pair::both(explicit.log_wrap);
        }
        for (turn, by) in self.silicone_turn.iter().zip(&mut d.turn) {
            for k in 0..CONSTANTS {
                by[k] = (by[k] - *turn * closing[k]) * closure;
            }
        }
        for (p, &node) in self.pins.iter().enumerate() {
            let turn = self.pin_n[p] / self.tension_n[node];
            for k in 0..CONSTANTS {
                d.pin_turn[p][k] = (d.pin_turn[p][k] - turn * closing[k]) * closure;
            }
        }
    }

    /// Integrates the derivatives of the log tension from those of the turns. Returns the
    /// derivatives of the exponents, and the largest change relative to the largest derivative.
    fn derivative_of_tension(
        &self,
        d: &mut Derivatives,
        explicit: &[Explicit; CONSTANTS],
        [mu, kappa]: [f64; 2],
        closure: Pair,
    ) -> (ExponentSlopes, f64) {
        let mut silicone = [Pair::both(0.0); CONSTANTS];
        for (turn, by) in self.silicone_turn.iter().zip(&mut d.turn) {
            for k in 0..CONSTANTS {
                by[k] = (by[k] + *turn * closure * explicit[k].log_mu) * mu;
                silicone[k] = silicone[k] + by[k];
            }
        }
        for (p, &node) in self.pins.iter().enumerate() {
            let t = self.tension_n[node];
            let theta = closure * self.pin_n[p] / t;
            let root = (t * theta).sqrt() * kappa;
            let ploughing = root * theta;
            for k in 0..CONSTANTS {
                d.turn[node][k] = d.turn[node][k]
                    + ploughing * explicit[k].log_kappa
                    + ploughing * d.log_tension[node][k] * 0.5
                    + root * d.pin_turn[p][k] * 1.5;
            }
        }
        let mut sum = [Pair::both(0.0); CONSTANTS];
        let (mut change, mut largest) = (0.0f64, 0.0f64);
        for (rise, log) in d.turn.iter().zip(&mut d.log_tension) {
            for k in 0..CONSTANTS {
                let risen = (sum[k] + rise[k] * 0.5) * Pair::new([-1.0, 1.0]);
                let here = risen + Pair::both(explicit[k].log_load);
                sum[k] = sum[k] + rise[k];
                let moved = (here - log[k]).abs();
                change = change.max(moved.lane(0)).max(moved.lane(1));
                largest = largest.max(here.lane(0).abs()).max(here.lane(1).abs());
                log[k] = here;
            }
        }
        let slopes = ExponentSlopes { total: sum, silicone };
        (slopes, if largest > 0.0 { change / largest } else { change })
    }
}
