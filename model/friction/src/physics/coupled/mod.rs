//! Equilibrium of a tendon for both directions of motion together, followed over ascending loads.
//!
//! [`slide`](super::march::slide) converges the shape for each tension. Here every sweep makes one
//! Newton step of the shape and one integration of the tension, from a state extrapolated from the
//! loads before. Both directions are computed side by side, which hides the latency of divisions.
//! A load that does not converge this way is left to [`slide`](super::march::slide), which searches
//! along each step.
//!
//! At a solution the linearised equations give the derivatives of both friction exponents with
//! respect to the constants, and to any dimension by its [`Explicit`] derivatives (implicit
//! function theorem): the factors of the stiffness matrix are computed once, and every pass of the
//! fixed point over shape and tension is a back-substitution.

mod derivatives;
mod elimination;
mod explicit;
mod extrapolation;
mod forces;

use super::constants::Constants;
use super::equilibrium::{BALANCE, Supports};
use super::line_search::share_of_step;
use super::pair::Pair;
use crate::bed::Bed;
use derivatives::Derivatives;
use elimination::{Elimination, middle_row, substitute_back};
use extrapolation::{HISTORY, State};

pub(super) use derivatives::MAX_PASSES;
pub(super) use explicit::Explicit;

/// Largest number of sweeps; 2 to 4 are usual. Loads that need more are left to the line search.
const MAX_SWEEPS: usize = 24;
/// Largest relative error of a friction exponent, estimated from the last changes of the tension.
const EXPONENT_ERROR: f64 = 1e-7;
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
/// Largest number of cuts of a step.
const MAX_CUTS: usize = 12;
/// Largest exponent of the Taylor series in [`exp_of_small`].
const TINY: f64 = 2e-3;
/// Number of material constants.
pub(super) const CONSTANTS: usize = 4;

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
            let (force, stiffness) = pin_support(supports, k, gap);
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
                missed += (linear - supports.pin(p, from + share * by).force_n) * by;
            }
            (1.0 - share) * falling + missed
        };
        share_of_step(falling, MAX_CUTS, slope)
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
            (self.pin_n[k], self.pin_n_mm[k]) = pin_support(supports, k, self.next_gap_mm[node]);
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
}

/// Returns force and stiffness of the pin of this index at this gap.
#[inline(always)]
fn pin_support(supports: &Supports<'_>, pin: usize, gap_mm: Pair) -> (Pair, Pair) {
    let (a, b) = (supports.pin(pin, gap_mm.lane(0)), supports.pin(pin, gap_mm.lane(1)));
    (Pair::new([a.force_n, b.force_n]), Pair::new([a.stiffness_n_mm, b.stiffness_n_mm]))
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
