//! The tendon's shape under a given tension: a string with bending stiffness over sinking pins on a
//! foundation.
//!
//! Minimises the energy of `model/doc/friction-laws.md` over the gap `u` between the tendon's
//! underside and the undeformed silicone:
//!
//! ```text
//! E = int [T/2 u'^2 - T u^2/(2 Rc^2) + T u/Rc + EI/2 (u'' + u/Rc^2 - 1/Rc)^2 + k_s/2 <-u>^2] ds
//!     + sum W(<h0 - u_i>)
//! ```
//!
//! `T` is the tension, `Rc` the radius of the tendon's axis, `EI` its bending stiffness, `k_s` the
//! foundation stiffness, `h0` the protrusion of a resting pin, `s` the arc length, and
//! `<x> = max(x, 0)`. `W' = N` is the support force of a pin. The ends of the tendon point along
//! the tangents at both ends of the wrap. The solver is Newton's method on the active set of
//! touching nodes, with a line search along each step.

use super::banded::BandedMatrix;
use super::error::PhysicsError;
use super::grid::Grid;
use super::line_search::share_of_step;
use crate::bed::Bed;

/// Largest number of Newton steps; 3 to 10 are usual.
const MAX_STEPS: usize = 60;
/// Largest unbalanced force at a node, relative to the tension plus `EI/Rc^2`.
pub(super) const BALANCE: f64 = 1e-8;
/// Rounding error of a node's force, relative to its largest summand.
const ROUNDING: f64 = 1e-12;
/// Least height of a pin, relative to the nominal height: the support of a lower pin is small but
/// defined.
const LOWEST_PIN: f64 = 1e-3;
/// Largest number of cuts of a step; the last one is used then.
const MAX_CUTS: usize = 30;
/// Largest multiple of the string's negative stiffness that is added to the matrix of a Newton
/// step.
const MAX_SHIFT: f64 = 1e4;

/// Equilibrium shape with the forces of its supports.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Equilibrium {
    /// Gap over the undeformed silicone at each node, mm; negative where the silicone is pressed.
    pub(super) gap_mm: Vec<f64>,
    /// Force of each pin, N.
    pub(super) pin_n: Vec<f64>,
    /// Force of the silicone at each node, N.
    pub(super) silicone_n: Vec<f64>,
    /// Newton steps taken.
    pub(super) steps: usize,
}

/// Supports of a tendon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Supports<'a> {
    /// Nodes along the wrap.
    pub(super) grid: &'a Grid,
    /// Dimensions and stiffness.
    pub(super) bed: &'a Bed,
    /// `N0` of this bed, N.
    pub(super) flush_force_n: f64,
    /// Deviation of the height of each pin of the grid, mm; empty if all pins are nominal.
    pub(super) heights_mm: &'a [f64],
}

/// Force and stiffness of a pin that is pressed into the silicone.
#[derive(Clone, Copy)]
pub(super) struct Support {
    pub(super) force_n: f64,
    pub(super) stiffness_n_mm: f64,
}

impl Supports<'_> {
    /// Returns the support of the pin of this index in the grid at a gap of `u` mm:
    /// `N = N0 (1 + b) x/(1 + b x)` with `x = <h0 - u>/h0`. A pin that is higher than nominal has a
    /// larger `h0`, and a larger `N0` in proportion.
    pub(super) fn pin(&self, pin: usize, gap_mm: f64) -> Support {
        let nominal = self.bed.protrusion_mm();
        let (h0, flush_force_n) = match self.heights_mm.get(pin) {
            None => (nominal, self.flush_force_n),
            Some(by) => {
                let height = (nominal + by).max(LOWEST_PIN * nominal);
                (height, self.flush_force_n * height / nominal)
            }
        };
        let (x, b) = ((h0 - gap_mm).max(0.0) / h0, self.bed.softening);
        if x == 0.0 {
            return Support { force_n: 0.0, stiffness_n_mm: 0.0 };
        }
        let (scale, soft) = (flush_force_n * (1.0 + b), 1.0 + b * x);
        Support { force_n: scale * x / soft, stiffness_n_mm: scale / (h0 * soft * soft) }
    }

    /// Returns the quadratic form and the linear term of string and bending: `E = u'Au/2 - r'u`.
    fn string(&self, tension_n: &[f64]) -> (BandedMatrix, Vec<f64>) {
        let (grid, rc) = (self.grid, self.bed.axis_radius_mm());
        let n = grid.len();
        let (mut a, mut load) = grid.bending(self.bending_n_mm2(tension_n));
        for (i, per_mm) in grid.per_element_mm.iter().enumerate() {
            let k = 0.5 * (tension_n[i] + tension_n[i + 1]) * per_mm;
            a.diagonal[i] += k;
            a.diagonal[i + 1] += k;
            a.first[i] -= k;
        }
        let per_rc = 1.0 / rc;
        for i in 0..n {
            let pressed = tension_n[i] * grid.share_mm[i] * per_rc;
            a.diagonal[i] -= pressed * per_rc;
            load[i] -= pressed;
        }
        // Both ends point along the tangents at the ends of the wrap: a free string with u' = 0 at
        // the end of the wrap has u' = tan(m) (1 - u/Rc) at an angle m beyond it.
        let tilt = libm::tan(grid.reach_rad);
        for end in [0, n.saturating_sub(1)] {
            load[end] += tension_n[end] * tilt;
            a.diagonal[end] += tension_n[end] * tilt / rc;
        }
        (a, load)
    }

    /// Returns the gradient of the energy at `u`, and the springs' part of the second derivative's
    /// diagonal.
    fn evaluate(&self, a: &BandedMatrix, load: &[f64], u: &[f64]) -> State {
        let mut gradient = a.times(u);
        let mut springs = vec![0.0; u.len()];
        let k = self.bed.stiffness_n_mm2();
        for i in 0..u.len() {
            gradient[i] -= load[i];
            if u[i] < 0.0 {
                let spring = k * self.grid.silicone_mm[i];
                gradient[i] += spring * u[i];
                springs[i] += spring;
            }
        }
        for (k, p) in self.grid.pins.iter().enumerate() {
            let support = self.pin(k, u[*p]);
            gradient[*p] -= support.force_n;
            springs[*p] += support.stiffness_n_mm;
        }
        State { gradient, springs }
    }

    /// Computes the equilibrium under `tension_n` at the nodes, from an initial gap at each node.
    ///
    /// # Errors
    /// [`PhysicsError::NotConverged`] if Newton's method does not balance the forces.
    pub(super) fn equilibrium(
        &self,
        tension_n: &[f64],
        start: Option<&[f64]>,
    ) -> Result<Equilibrium, PhysicsError> {
        let (a, load) = self.string(tension_n);
        let bent_n = self.bending_n_mm2(tension_n) / self.bed.axis_radius_mm().powi(2);
        let tolerance_n = BALANCE * (tension_n.iter().copied().fold(0.0, f64::max) + bent_n);
        let stiffest = a.diagonal.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let rc = self.bed.axis_radius_mm();
        let hanging: Vec<f64> =
            tension_n.iter().zip(&self.grid.share_mm).map(|(t, share)| t * share / (rc * rc)).collect();
        let mut u = start.map_or_else(|| self.pressed(tension_n), <[f64]>::to_vec);
        let mut here = self.evaluate(&a, &load, &u);
        for steps in 0..MAX_STEPS {
            let largest_gap = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
            if here.unbalanced_n() <= tolerance_n + ROUNDING * stiffest * largest_gap {
                return Ok(self.supported(u, steps));
            }
            let step = newton_step(&a, &hanging, &here);
            (u, here) = self.line_search(&a, &load, &u, &step, &here);
        }
        Err(PhysicsError::NotConverged { unbalanced_n: here.unbalanced_n(), steps: MAX_STEPS })
    }

    /// Returns the tendon's bending stiffness under the lowest of these tensions, N mm².
    fn bending_n_mm2(&self, tension_n: &[f64]) -> f64 {
        self.bed.tendon_bending_n_mm2(tension_n.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// Returns the initial gap: that of a tendon on silicone without pins.
    fn pressed(&self, tension_n: &[f64]) -> Vec<f64> {
        let k = self.bed.stiffness_n_mm2() * self.bed.axis_radius_mm();
        tension_n.iter().map(|t| -t / k).collect()
    }

    /// Finds an approximate minimum of the energy along `step`, from its slope: differences of the
    /// energy itself are lost in rounding. The energy is convex along almost every step, so the
    /// slope crosses zero once.
    fn line_search(
        &self,
        a: &BandedMatrix,
        load: &[f64],
        u: &[f64],
        step: &[f64],
        here: &State,
    ) -> (Vec<f64>, State) {
        let slope = |state: &State| state.gradient.iter().zip(step).map(|(g, s)| g * s).sum::<f64>();
        let at = |share: f64| {
            let moved: Vec<f64> = u.iter().zip(step).map(|(u, s)| u + share * s).collect();
            let state = self.evaluate(a, load, &moved);
            (moved, state)
        };
        // The trial at the share that was evaluated last.
        let mut last = None;
        let share = share_of_step(slope(here), MAX_CUTS, |share| {
            let trial = at(share);
            let now = slope(&trial.1);
            last = Some((share, trial));
            now
        });
        match last {
            Some((evaluated, trial)) if evaluated == share => trial,
            _ => at(share),
        }
    }

    /// Returns the equilibrium with this gap.
    fn supported(&self, gap_mm: Vec<f64>, steps: usize) -> Equilibrium {
        let k = self.bed.stiffness_n_mm2();
        let silicone_n =
            gap_mm.iter().zip(&self.grid.silicone_mm).map(|(u, w)| k * w * (-u).max(0.0)).collect();
        let pin_n = self.grid.pins.iter().enumerate().map(|(k, p)| self.pin(k, gap_mm[*p]).force_n).collect();
        Equilibrium { gap_mm, pin_n, silicone_n, steps }
    }
}

/// Derivatives of the energy at a shape.
struct State {
    gradient: Vec<f64>,
    springs: Vec<f64>,
}

impl State {
    /// Returns the largest unbalanced force at a node, N.
    fn unbalanced_n(&self) -> f64 {
        self.gradient.iter().fold(0.0, |worst, g| worst.max(g.abs()))
    }
}

/// Returns a direction in which the energy falls: Newton's step, with a stiffer diagonal if the
/// second derivative is not positive definite. Only the string's term `-T/Rc^2` can make it so;
/// increasing multiples of its magnitude, `hanging`, are added.
fn newton_step(string: &BandedMatrix, hanging: &[f64], here: &State) -> Vec<f64> {
    let mut multiple = 0.0;
    loop {
        let mut matrix = string.clone();
        for ((d, spring), own) in matrix.diagonal.iter_mut().zip(&here.springs).zip(hanging) {
            *d += spring + multiple * own;
        }
        let mut step: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
        if matrix.solve(&mut step) || multiple > MAX_SHIFT {
            return step;
        }
        multiple = if multiple == 0.0 { 1.5 } else { multiple * 4.0 };
    }
}
