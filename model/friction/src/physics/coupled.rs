//! Equilibrium of a tendon for both directions of motion together, followed over ascending loads.
//!
//! [`slide`](super::march::slide) converges the shape for each tension. Here every sweep makes one
//! Newton step of the shape and one integration of the tension, from a state extrapolated from the
//! loads before. Both directions are computed side by side, which hides the latency of divisions.
//! A load that does not converge this way is left to [`slide`](super::march::slide), which searches
//! along each step.
//!
//! At a solution the linearised equations give the derivatives of both friction exponents (implicit
//! function theorem): the factors of the stiffness matrix are computed once, and every pass of the
//! fixed point over shape and tension is a back-substitution.

// A constant is the index into several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::constants::Constants;
use super::equilibrium::{BALANCE, Supports};
use super::pair::Pair;
use crate::bed::Bed;

/// Largest number of sweeps; 2 to 4 are usual. Loads that need more are left to the line search.
const MAX_SWEEPS: usize = 24;
/// Largest relative error of a friction exponent, estimated from the last changes of the tension.
const EXPONENT_ERROR: f64 = 5e-9;
/// Assumed ratio of a change of the tension to the change before, where it is not known.
const UNKNOWN_RATE: f64 = 0.1;
/// Least such ratio; usual are 0.005 to 0.1.
const LEAST_RATE: f64 = 0.02;
/// Largest change of the tension from which the secant of the integrations is used.
const ACCELERATED_BELOW: f64 = 0.02;
/// Largest step of the secant.
const MAX_SECANT: f64 = 0.5;
/// Ratio of unbalanced forces of successive sweeps above which the next step is searched.
const PROGRESS: f64 = 0.1;
/// Number of sweeps after which every step is searched.
const MAX_PLAIN_SWEEPS: usize = 4;
/// The line search ends when the slope of the energy is below this share of its initial value.
const FLAT: f64 = 0.5;
/// Largest number of cuts of a step.
const MAX_CUTS: usize = 12;
/// Largest sum of the magnitudes of the weights of an extrapolation.
const MAX_WEIGHT: f64 = 16.0;
/// Number of states from which the next one is extrapolated.
const HISTORY: usize = 3;
/// Largest exponent of the Taylor series in [`exp_of_small`].
const TINY: f64 = 2e-3;
/// Largest change of a derivative of the log tension in the last pass, relative to the largest
/// derivative.
const DERIVATIVE_TOLERANCE: f64 = 1e-8;
/// Largest number of passes over shape and tension for derivatives; 5 to 8 are usual.
pub(super) const MAX_PASSES: usize = 60;
/// Number of material constants.
pub(super) const CONSTANTS: usize = 3;

/// Coefficients of the equations at each node, which do not depend on the load.
#[derive(Clone, Debug)]
struct Node {
    /// Inverse length of the element to the next node, 1/mm; zero at the last node.
    per_element_mm: f64,
    /// Diagonal and both off-diagonals of bending, for a stiffness of 1 N mm².
    bending: [f64; 3],
    /// Linear term of bending, for a stiffness of 1 N mm².
    bending_load: f64,
    /// Diagonal of the string, per tension.
    string: f64,
    /// Linear term of the string, per tension.
    string_load: f64,
    /// Stiffness of the silicone, N/mm.
    silicone_n_mm: f64,
}

impl Node {
    /// Returns the diagonal entry of string and bending, without the elements on both sides.
    #[inline(always)]
    fn diagonal(&self, bending: Pair, tension: Pair) -> Pair {
        bending * self.bending[0] + tension * self.string
    }

    /// Returns the linear term of string and bending.
    #[inline(always)]
    fn load(&self, bending: Pair, tension: Pair) -> Pair {
        bending * self.bending_load + tension * self.string_load
    }
}

/// State of the tendon at one load, in both directions.
#[derive(Clone, Debug, Default)]
struct State {
    load_n: f64,
    /// Gap at each node, mm.
    gap_mm: Vec<Pair>,
    /// Tension over load at each node.
    ratio: Vec<Pair>,
}

/// Friction exponents of both directions, `|ln(T/F)|`, by material.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Exponents {
    pub(super) pins: Pair,
    pub(super) silicone: Pair,
}

/// Arrays of a curve's computation, one entry per node unless stated otherwise. They are allocated
/// once for all loads.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    /// Largest relative error of a friction exponent.
    pub(super) exponent_error: f64,
    nodes: Vec<Node>,
    pins: Vec<usize>,
    /// States at the loads before, the last one first.
    history: [State; HISTORY],
    known: usize,
    gap_mm: Vec<Pair>,
    next_gap_mm: Vec<Pair>,
    tension_n: Vec<Pair>,
    /// Inverse of the tension before the last integration, 1/N.
    per_tension: Vec<Pair>,
    /// Tension of the integration before.
    integrated_n: Vec<Pair>,
    /// Relative change of the tension by the last integration and by the one before.
    misfit: Vec<Pair>,
    misfit_before: Vec<Pair>,
    /// Stiffness of the springs, N/mm.
    spring: Vec<Pair>,
    /// Linear term of the pins, N.
    pin_load: Vec<Pair>,
    /// Turn of the silicone over the closure.
    silicone_turn: Vec<Pair>,
    /// Force of each pin, N.
    pin_n: Vec<Pair>,
    /// Stiffness of each pin, N/mm.
    pin_n_mm: Vec<Pair>,
    /// Rise of the friction exponent.
    rise: Vec<Pair>,
    /// Inverse pivots and both columns of the factors.
    factors: Vec<[Pair; 3]>,
    right: Vec<Pair>,
    /// Nodes that meet or leave the silicone in a step.
    crossing: Vec<usize>,
    derivatives: Derivatives,
}

/// Arrays of derivatives with respect to the logarithms of the constants.
#[derive(Clone, Debug, Default)]
struct Derivatives {
    right: Vec<[Pair; CONSTANTS]>,
    turn: Vec<[Pair; CONSTANTS]>,
    pin_turn: Vec<[Pair; CONSTANTS]>,
    log_tension: Vec<[Pair; CONSTANTS]>,
}

impl Workspace {
    /// Creates the arrays for a tendon on `supports`.
    pub(super) fn new(supports: &Supports<'_>) -> Self {
        let (grid, rc) = (supports.grid, supports.bed.axis_radius_mm());
        let n = grid.len();
        let tilt = libm::tan(grid.reach_rad);
        let (form, load) = grid.unit_bending();
        let nodes = (0..n)
            .map(|i| {
                let end = if i == 0 || i + 1 == n { tilt } else { 0.0 };
                Node {
                    per_element_mm: grid.per_element_mm.get(i).copied().unwrap_or(0.0),
                    bending: [form.diagonal[i], form.first[i], form.second[i]],
                    bending_load: load[i],
                    string: end / rc - grid.share_mm[i] / (rc * rc),
                    string_load: end - grid.share_mm[i] / rc,
                    silicone_n_mm: supports.bed.stiffness_n_mm2() * grid.silicone_mm[i],
                }
            })
            .collect();
        let (zeros, pins) = (vec![Pair::both(0.0); n], vec![Pair::both(0.0); grid.pins.len()]);
        let state = State { load_n: 0.0, gap_mm: zeros.clone(), ratio: zeros.clone() };
        Self {
            exponent_error: EXPONENT_ERROR,
            nodes,
            pins: grid.pins.clone(),
            history: std::array::from_fn(|_| state.clone()),
            known: 0,
            gap_mm: zeros.clone(),
            next_gap_mm: zeros.clone(),
            tension_n: zeros.clone(),
            per_tension: zeros.clone(),
            integrated_n: zeros.clone(),
            misfit: zeros.clone(),
            misfit_before: zeros.clone(),
            spring: zeros.clone(),
            pin_load: zeros.clone(),
            silicone_turn: zeros.clone(),
            pin_n: pins.clone(),
            pin_n_mm: pins,
            rise: zeros.clone(),
            factors: vec![[Pair::both(0.0); 3]; n],
            right: zeros,
            crossing: Vec::with_capacity(n),
            derivatives: Derivatives::default(),
        }
    }

    /// Computes the friction exponents at a load, which becomes part of the history. `None` without
    /// convergence.
    pub(super) fn follow(
        &mut self,
        supports: &Supports<'_>,
        constants: &Constants,
        wrap_rad: f64,
        load_n: f64,
    ) -> Option<Exponents> {
        self.extrapolate(supports, wrap_rad, load_n);
        let kappa = constants.kappa_per_sqrt_n * supports.bed.ploughing_ratio();
        let (mut unbalanced_before, mut unbalanced_before_that) = (f64::INFINITY, f64::INFINITY);
        let mut change_before = f64::INFINITY;
        for sweep in 0..MAX_SWEEPS {
            let bending = self.bending_n_mm2(supports.bed);
            let rc = supports.bed.axis_radius_mm();
            let largest = self.tension_n.iter().fold(Pair::both(0.0), |most, t| most.max(*t));
            let tolerance_n = (largest + bending * (1.0 / (rc * rc))) * BALANCE;
            self.supports_at_gap(supports);
            if !self.solve(bending) {
                return None;
            }
            // Active sets can alternate; a search along the step prevents this.
            let is_far = match sweep {
                0 => self.known == 0,
                1 => false,
                _ => {
                    let is_slow = unbalanced_before >= PROGRESS * unbalanced_before_that;
                    unbalanced_before > 1.0 && (sweep >= MAX_PLAIN_SWEEPS || is_slow)
                }
            };
            let unbalanced = self.take_step(supports, tolerance_n, is_far);
            let turned = self.turned();
            if !turned.all(|t| t > 0.0) {
                return None;
            }
            let closure = Pair::both(wrap_rad) / turned;
            let (exponents, change) = self.integrate(constants.mu_silicone, kappa, closure, load_n);
            // The error of the new tension is the next change, which decreases geometrically.
            let rate = match sweep {
                0 => UNKNOWN_RATE,
                1 => (change / change_before).max(LEAST_RATE),
                // The secant hides the rate of the integrations.
                _ => (change / change_before).max(UNKNOWN_RATE),
            };
            let total = exponents.pins + exponents.silicone;
            let least_exponent = total.lane(0).min(total.lane(1));
            if unbalanced <= 1.0 && rate * change <= self.exponent_error * least_exponent {
                self.remember(load_n);
                return Some(exponents);
            }
            if !change.is_finite() {
                return None;
            }
            self.accelerate(sweep > 0 && change < ACCELERATED_BELOW);
            (unbalanced_before_that, unbalanced_before) = (unbalanced_before, unbalanced);
            change_before = change;
        }
        None
    }

    /// Moves the tension beyond the last integration, by the secant of the last two (Anderson's
    /// method with one step of memory), if `is_near` a solution.
    fn accelerate(&mut self, is_near: bool) {
        let mut ahead = Pair::both(0.0);
        if is_near {
            let (mut product, mut square) = (Pair::both(0.0), Pair::both(f64::MIN_POSITIVE));
            for (now, before) in self.misfit.iter().zip(&self.misfit_before) {
                let by = *now - *before;
                product = product + *now * by;
                square = square + by * by;
            }
            ahead = (product / square).map(|x| x.clamp(-MAX_SECANT, MAX_SECANT));
        }
        for (tension, before) in self.tension_n.iter_mut().zip(&mut self.integrated_n) {
            let integrated = *tension;
            if is_near {
                *tension = integrated - ahead * (integrated - *before);
            }
            *before = integrated;
        }
        std::mem::swap(&mut self.misfit, &mut self.misfit_before);
    }

    /// Adds a state to the history that was computed otherwise: gaps and tensions of the eccentric
    /// and the concentric direction.
    pub(super) fn accept(&mut self, load_n: f64, gap_mm: [&[f64]; 2], tension_n: [&[f64]; 2]) {
        for i in 0..self.nodes.len() {
            self.gap_mm[i] = Pair::new([gap_mm[0][i], gap_mm[1][i]]);
            self.tension_n[i] = Pair::new([tension_n[0][i], tension_n[1][i]]);
        }
        self.remember(load_n);
    }

    /// Sets gap and tension to those expected at `load_n`, by a polynomial through the last states.
    fn extrapolate(&mut self, supports: &Supports<'_>, wrap_rad: f64, load_n: f64) {
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

    fn remember(&mut self, load_n: f64) {
        self.history.rotate_right(1);
        let state = &mut self.history[0];
        state.load_n = load_n;
        state.gap_mm.copy_from_slice(&self.gap_mm);
        state.ratio.iter_mut().zip(&self.tension_n).for_each(|(ratio, t)| *ratio = *t * (1.0 / load_n));
        self.known = (self.known + 1).min(HISTORY);
    }

    fn bending_n_mm2(&self, bed: &Bed) -> Pair {
        let least = self.tension_n.iter().fold(Pair::both(f64::INFINITY), |least, t| least.min(*t));
        least.map(|t| bed.tendon_bending_n_mm2(t))
    }

    /// Computes the springs at the gap, linearised.
    fn supports_at_gap(&mut self, supports: &Supports<'_>) {
        for ((spring, node), gap) in self.spring.iter_mut().zip(&self.nodes).zip(&self.gap_mm) {
            *spring = gap.where_negative(Pair::both(node.silicone_n_mm));
        }
        self.pin_load.fill(Pair::both(0.0));
        for (k, &node) in self.pins.iter().enumerate() {
            let gap = self.gap_mm[node];
            let (force, stiffness) = pin_support(supports, gap);
            self.spring[node] = self.spring[node] + stiffness;
            self.pin_load[node] = self.pin_load[node] + force + stiffness * gap;
            (self.pin_n[k], self.pin_n_mm[k]) = (force, stiffness);
        }
    }

    /// Factorises the stiffness matrix at the springs, and solves for the next gap. Returns `false`
    /// if the matrix is not positive definite.
    ///
    /// Rows are eliminated from both ends at once, up to the rows `middle` and `middle + 1`: two
    /// chains of divisions instead of one.
    fn solve(&mut self, bending: Pair) -> bool {
        let n = self.nodes.len();
        let middle = middle_row(n);
        let (nodes, tension) = (&self.nodes[..n], &self.tension_n[..n]);
        let (spring, pin_load) = (&self.spring[..n], &self.pin_load[..n]);
        let (factors, right) = (&mut self.factors[..n], &mut self.right[..n]);
        let element = |i: usize| (tension[i] + tension[(i + 1).min(n - 1)]) * (0.5 * nodes[i].per_element_mm);
        let (mut top, mut bottom) = (Elimination::default(), Elimination::default());
        let (mut above, mut below) = (Pair::both(0.0), Pair::both(0.0));
        for k in 0..n - 2 - middle {
            if k < middle {
                let i = k;
                let after = element(i);
                let diagonal = nodes[i].diagonal(bending, tension[i]) + above + after + spring[i];
                let b = nodes[i].load(bending, tension[i]) + pin_load[i];
                let first = bending * nodes[i].bending[1] - after;
                (factors[i], right[i]) = top.eliminate(diagonal, first, bending * nodes[i].bending[2], b);
                above = after;
            }
            let i = n - 1 - k;
            let before = element(i - 1);
            let diagonal = nodes[i].diagonal(bending, tension[i]) + before + below + spring[i];
            let b = nodes[i].load(bending, tension[i]) + pin_load[i];
            let first = bending * nodes[i - 1].bending[1] - before;
            (factors[i], right[i]) = bottom.eliminate(diagonal, first, bending * nodes[i - 2].bending[2], b);
            below = before;
        }
        let between = element(middle);
        let diagonal = nodes[middle].diagonal(bending, tension[middle]) + above + between + spring[middle];
        let b = nodes[middle].load(bending, tension[middle]) + pin_load[middle];
        top.diagonal[0] = top.diagonal[0] + bottom.diagonal[1];
        top.first = top.first + bottom.first;
        top.right[0] = top.right[0] + bottom.right[1];
        let first = bending * nodes[middle].bending[1] - between;
        (factors[middle], right[middle]) = top.eliminate(diagonal, first, Pair::both(0.0), b);
        let diagonal =
            nodes[middle + 1].diagonal(bending, tension[middle + 1]) + between + below + spring[middle + 1];
        let b = nodes[middle + 1].load(bending, tension[middle + 1]) + pin_load[middle + 1];
        top.diagonal[0] = top.diagonal[0] + bottom.diagonal[0];
        top.right[0] = top.right[0] + bottom.right[0];
        (factors[middle + 1], right[middle + 1]) =
            top.eliminate(diagonal, Pair::both(0.0), Pair::both(0.0), b);
        substitute_back(factors, right, &mut self.next_gap_mm[..n]);
        // An indefinite matrix has a pivot that is not positive.
        factors.iter().fold(true, |is_positive, [inverse, ..]| is_positive & inverse.all(|d| d > 0.0))
    }

    /// Shortens the step to the next gap to an approximate minimum of the energy along it. Returns
    /// whether it did so.
    fn shorten_step(&mut self, supports: &Supports<'_>) -> bool {
        self.crossing.clear();
        for (i, (from, to)) in self.gap_mm.iter().zip(&self.next_gap_mm).enumerate() {
            let [a, b] = [0, 1].map(|lane| (from.lane(lane) < 0.0) != (to.lane(lane) < 0.0));
            if a | b {
                self.crossing.push(i);
            }
        }
        let falling = self.slope_at_start().numbers();
        let shares = [self.step_share(supports, falling[0], 0), self.step_share(supports, falling[1], 1)];
        if shares == [1.0; 2] {
            return false;
        }
        for (gap, next) in self.gap_mm.iter().zip(&mut self.next_gap_mm) {
            *next = *gap + Pair::new(shares) * (*next - *gap);
        }
        true
    }

    /// Returns the slope of the energy along the step at its start, from the factors of the
    /// stiffness: `-s'Ks`.
    fn slope_at_start(&self) -> Pair {
        let n = self.nodes.len();
        let middle = middle_row(n);
        let step = |i: usize| self.next_gap_mm[i] - self.gap_mm[i];
        let mut slope = Pair::both(0.0);
        let (mut near, mut far) = (step(middle + 1), Pair::both(0.0));
        for i in (0..=middle).rev() {
            let [inverse, one, two] = self.factors[i];
            let here = step(i);
            let x = here + one * near + two * far;
            slope = slope - x * x / inverse;
            (near, far) = (here, near);
        }
        (near, far) = (Pair::both(0.0), Pair::both(0.0));
        for i in middle + 1..n {
            let [inverse, one, two] = self.factors[i];
            let here = step(i);
            let x = here + one * near + two * far;
            slope = slope - x * x / inverse;
            (near, far) = (here, if i == middle + 1 { step(middle) } else { near });
        }
        slope
    }

    /// Returns the share of the step of one direction at which the slope of the energy is small;
    /// `falling` is the slope at its start.
    fn step_share(&self, supports: &Supports<'_>, falling: f64, lane: usize) -> f64 {
        let step = |i: usize| self.next_gap_mm[i].lane(lane) - self.gap_mm[i].lane(lane);
        let slope = |share: f64| {
            let mut missed = 0.0;
            for &i in &self.crossing {
                let (from, by) = (self.gap_mm[i].lane(lane), step(i));
                let to = from + share * by;
                if (from < 0.0) != (to < 0.0) {
                    missed -= self.nodes[i].silicone_n_mm * to.abs() * by;
                }
            }
            for (p, &node) in self.pins.iter().enumerate() {
                let (from, by) = (self.gap_mm[node].lane(lane), step(node));
                let linear = self.pin_n[p].lane(lane) - self.pin_n_mm[p].lane(lane) * share * by;
                missed += (linear - supports.pin(from + share * by).force_n) * by;
            }
            (1.0 - share) * falling + missed
        };
        let (mut low, mut high) = ((0.0, falling), None);
        let mut share = 1.0;
        for _ in 0..MAX_CUTS {
            let now = slope(share);
            if now.abs() <= FLAT * falling.abs() {
                break;
            }
            if now > 0.0 {
                high = Some((share, now));
            } else {
                low = (share, now);
            }
            share = match high {
                None => break,
                // Regula falsi, limited to the inner part of the interval.
                Some((end, rising)) => {
                    let cut = low.0 + (end - low.0) * low.1.abs() / (low.1.abs() + rising);
                    cut.clamp(low.0 + 0.1 * (end - low.0), end - 0.1 * (end - low.0))
                }
            };
        }
        share
    }

    /// Moves to the next gap, with a search along the step if `is_far`, and computes the forces
    /// there. Returns the largest force that the linearised springs miss, relative to the
    /// tolerance; infinite after a shortened step.
    fn take_step(&mut self, supports: &Supports<'_>, tolerance_n: Pair, is_far: bool) -> f64 {
        let is_short = is_far && self.shorten_step(supports);
        let mut missed = Pair::both(0.0);
        for i in 0..self.nodes.len() {
            let (gap, next, stiffness) = (self.gap_mm[i], self.next_gap_mm[i], self.nodes[i].silicone_n_mm);
            let pressed = next * -stiffness;
            let force = next.where_negative(pressed);
            let linear = gap.where_negative(pressed);
            missed = missed.max((force - linear).abs());
            self.per_tension[i] = Pair::both(1.0) / self.tension_n[i];
            self.silicone_turn[i] = force * self.per_tension[i];
        }
        for (k, &node) in self.pins.iter().enumerate() {
            let step = self.next_gap_mm[node] - self.gap_mm[node];
            let linear = self.pin_n[k] - self.pin_n_mm[k] * step;
            (self.pin_n[k], self.pin_n_mm[k]) = pin_support(supports, self.next_gap_mm[node]);
            missed = missed.max((self.pin_n[k] - linear).abs());
        }
        std::mem::swap(&mut self.gap_mm, &mut self.next_gap_mm);
        let share = missed / tolerance_n;
        if is_short { f64::INFINITY } else { share.lane(0).max(share.lane(1)) }
    }

    /// Returns the sum of all turns before closure.
    fn turned(&self) -> Pair {
        let pins = self.pins.iter().zip(&self.pin_n);
        let pins = pins.fold(Pair::both(0.0), |sum, (node, force)| sum + *force / self.tension_n[*node]);
        self.silicone_turn.iter().fold(pins, |sum, turn| sum + *turn)
    }

    /// Integrates the tension along the wrap from the forces, and replaces it.
    /// Returns the friction exponents, and the largest relative change of the tension; infinite if
    /// it is not a number.
    fn integrate(&mut self, mu: f64, kappa: f64, closure: Pair, load_n: f64) -> (Exponents, f64) {
        let mut exponents = Exponents::default();
        for (rise, turn) in self.rise.iter_mut().zip(&self.silicone_turn) {
            *rise = *turn * closure * mu;
            exponents.silicone = exponents.silicone + *rise;
        }
        for (node, force) in self.pins.iter().zip(&self.pin_n) {
            let tension = self.tension_n[*node];
            let theta = closure * *force / tension;
            let ploughing = (tension * theta).sqrt() * theta * kappa;
            exponents.pins = exponents.pins + ploughing;
            self.rise[*node] = self.rise[*node] + ploughing;
        }
        let (mut tension, mut change) = (Pair::both(load_n), Pair::both(0.0));
        let misfits = self.misfit.iter_mut().zip(&self.per_tension);
        for ((rise, t), (misfit, per_tension)) in self.rise.iter().zip(&mut self.tension_n).zip(misfits) {
            // The tension of a node is that in the middle of its contact.
            let factor = exp_of_small(*rise * Pair::new([-0.5, 0.5]));
            let here = tension * factor;
            tension = here * factor;
            *misfit = (here - *t) * *per_tension;
            change = change.max(misfit.abs());
            *t = here;
        }
        let worst = change.lane(0).max(change.lane(1));
        let is_finite = change.all(f64::is_finite) && tension.all(f64::is_finite);
        (exponents, if is_finite { worst } else { f64::INFINITY })
    }

    /// Computes the derivatives of the friction exponents of both directions with respect to the
    /// logarithms of `kappa`, `mu_s` and `N0`, at the last load. `None` if a derivative does not
    /// converge.
    ///
    /// Touching nodes and pins stay those of the solution; where one is about to touch, the
    /// derivatives are one-sided.
    pub(super) fn derivatives(
        &mut self,
        supports: &Supports<'_>,
        constants: &Constants,
        wrap_rad: f64,
    ) -> Option<[Pair; CONSTANTS]> {
        let (n, mu) = (self.nodes.len(), constants.mu_silicone);
        let kappa = constants.kappa_per_sqrt_n * supports.bed.ploughing_ratio();
        let bending = self.bending_n_mm2(supports.bed);
        self.supports_at_gap(supports);
        if !self.solve(bending) {
            return None;
        }
        for i in 0..n {
            let stiffness = self.nodes[i].silicone_n_mm;
            let force = self.gap_mm[i].where_negative(self.gap_mm[i] * -stiffness);
            self.silicone_turn[i] = force / self.tension_n[i];
        }
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
            self.derivative_of_gap(&mut d, lowest, bending_slope);
            self.derivative_of_turns(&mut d, closure, turned);
            let (exponents, change) = self.derivative_of_tension(&mut d, mu, kappa, closure);
            if change <= DERIVATIVE_TOLERANCE {
                result = Some(exponents);
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
    fn derivative_of_gap(&self, d: &mut Derivatives, lowest: [usize; 2], bending_slope: Pair) {
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
        for (node, force) in self.pins.iter().zip(&self.pin_n) {
            d.right[*node][2] = d.right[*node][2] + *force;
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

    /// Computes the derivatives of the turns from those of gap and tension. They sum to zero.
    fn derivative_of_turns(&self, d: &mut Derivatives, closure: Pair, turned: Pair) {
        let mut sum = [Pair::both(0.0); CONSTANTS];
        for i in 0..self.nodes.len() {
            let (t, turn) = (self.tension_n[i], self.silicone_turn[i]);
            let stiffness =
                self.gap_mm[i].map(|u| if u < 0.0 { self.nodes[i].silicone_n_mm } else { 0.0 }) / t;
            for k in 0..CONSTANTS {
                let by = Pair::both(0.0) - stiffness * d.right[i][k] - turn * d.log_tension[i][k];
                d.turn[i][k] = by;
                sum[k] = sum[k] + by;
            }
        }
        for (p, &node) in self.pins.iter().enumerate() {
            let t = self.tension_n[node];
            let (turn, stiffness) = (self.pin_n[p] / t, self.pin_n_mm[p] / t);
            for k in 0..CONSTANTS {
                let own = if k == 2 { turn } else { Pair::both(0.0) };
                let by = own - stiffness * d.right[node][k] - turn * d.log_tension[node][k];
                d.pin_turn[p][k] = by;
                sum[k] = sum[k] + by;
            }
        }
        let closing = sum.map(|sum| sum / turned);
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
        mu: f64,
        kappa: f64,
        closure: Pair,
    ) -> ([Pair; CONSTANTS], f64) {
        for (turn, by) in self.silicone_turn.iter().zip(&mut d.turn) {
            by[1] = by[1] + *turn * closure;
            for by in by.iter_mut() {
                *by = *by * mu;
            }
        }
        for (p, &node) in self.pins.iter().enumerate() {
            let t = self.tension_n[node];
            let theta = closure * self.pin_n[p] / t;
            let root = (t * theta).sqrt() * kappa;
            let ploughing = root * theta;
            for k in 0..CONSTANTS {
                let own = if k == 0 { ploughing } else { Pair::both(0.0) };
                d.turn[node][k] = d.turn[node][k]
                    + own
                    + ploughing * d.log_tension[node][k] * 0.5
                    + root * d.pin_turn[p][k] * 1.5;
            }
        }
        let mut sum = [Pair::both(0.0); CONSTANTS];
        let (mut change, mut largest) = (0.0f64, 0.0f64);
        for (rise, log) in d.turn.iter().zip(&mut d.log_tension) {
            for k in 0..CONSTANTS {
                let here = (sum[k] + rise[k] * 0.5) * Pair::new([-1.0, 1.0]);
                sum[k] = sum[k] + rise[k];
                let moved = (here - log[k]).abs();
                change = change.max(moved.lane(0)).max(moved.lane(1));
                largest = largest.max(here.lane(0).abs()).max(here.lane(1).abs());
                log[k] = here;
            }
        }
        (sum, if largest > 0.0 { change / largest } else { change })
    }
}

/// Returns force and stiffness of a pin at this gap.
#[inline(always)]
fn pin_support(supports: &Supports<'_>, gap_mm: Pair) -> (Pair, Pair) {
    let (a, b) = (supports.pin(gap_mm.lane(0)), supports.pin(gap_mm.lane(1)));
    (Pair::new([a.force_n, b.force_n]), Pair::new([a.stiffness_n_mm, b.stiffness_n_mm]))
}

/// Returns the first of both rows at which the eliminations from both ends meet.
fn middle_row(rows: usize) -> usize {
    (rows - 2) / 2
}

/// Solves for the unknowns from the middle to both ends.
#[inline(always)]
fn substitute_back(factors: &[[Pair; 3]], right: &[Pair], x: &mut [Pair]) {
    let n = x.len();
    let (factors, right) = (&factors[..n], &right[..n]);
    let middle = middle_row(n);
    let at = |i: usize, near: Pair, far: Pair| right[i] - factors[i][2] * far - factors[i][1] * near;
    x[middle + 1] = right[middle + 1];
    x[middle] = at(middle, x[middle + 1], Pair::both(0.0));
    let (mut up, mut down) = ((x[middle], x[middle + 1]), (x[middle + 1], x[middle]));
    for k in 0..n - 2 - middle {
        if k < middle {
            let i = middle - 1 - k;
            x[i] = at(i, up.0, up.1);
            up = (x[i], up.0);
        }
        let i = middle + 2 + k;
        x[i] = at(i, down.0, down.1);
        down = (x[i], down.0);
    }
}

/// Elimination of rows of a symmetric matrix of half-bandwidth 2 from one end: what remains to be
/// subtracted from the next row and from the one after it.
#[derive(Clone, Copy, Default)]
struct Elimination {
    diagonal: [Pair; 2],
    /// Of the entry that couples both rows.
    first: Pair,
    right: [Pair; 2],
}

impl Elimination {
    /// Eliminates a row with its couplings to the next rows. Returns the inverse pivot, the factors
    /// of both couplings, and the right side over the pivot.
    #[inline(always)]
    fn eliminate(&mut self, diagonal: Pair, first: Pair, second: Pair, b: Pair) -> ([Pair; 3], Pair) {
        let inverse = Pair::both(1.0) / (diagonal - self.diagonal[0]);
        let (first, b) = (first - self.first, b - self.right[0]);
        let (one, two) = (first * inverse, second * inverse);
        self.diagonal = [one * first + self.diagonal[1], two * second];
        self.first = one * second;
        self.right = [one * b + self.right[1], two * b];
        ([inverse, one, two], b * inverse)
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

/// Returns `exp(x)`, by its Taylor series for small `x`, which is exact to the last digit or two.
#[inline(always)]
fn exp_of_small(x: Pair) -> Pair {
    if x.abs().all(|x| x < TINY) {
        let one = Pair::both(1.0);
        let quadratic = Pair::both(0.5) + x * (Pair::both(1.0 / 6.0) + x * (1.0 / 24.0));
        return one + x * (one + x * quadratic);
    }
    x.map(libm::exp)
}
