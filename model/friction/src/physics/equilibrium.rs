//! The tendon's shape under a given tension: a string, stiff if wanted, over sinking pins on a foundation.
//!
//! Minimises the energy of `model/doc/friction-laws.md` over the gap `u` between the tendon's underside and the
//! undeformed silicone:
//!
//! `E = int [T/2 u'^2 - T u^2/(2 Rc^2) + T u/Rc + EI/2 (u'' + u/Rc^2 - 1/Rc)^2 + k_s/2 <-u>^2] ds + sum W(<h0 - u_i>)`
//!
//! with natural ends and `W' = N`, the support of a pin. Newton's method on the active set of touching nodes, with a
//! line search on the energy: each step lowers it.

use super::banded::BandedMatrix;
use super::grid::Grid;
use super::{Bed, PhysicsError};

/// Newton steps before the search is given up; 3 to 10 are usual.
const MAX_STEPS: usize = 60;
/// Largest force left unbalanced at a node, as a share of the tension and of `EI/Rc^2`.
const BALANCE: f64 = 1e-8;
/// Rounding of the energy, relative.
const ROUNDING: f64 = 1e-9;
/// Least share of a Newton step that the line search tries.
const MIN_STEP: f64 = 1e-6;

/// The shape and what carries it.
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

/// The supports of a tendon: grid, bed and the force that sinks a pin flush.
#[derive(Clone, Copy, Debug)]
pub(super) struct Supports<'a> {
    pub(super) grid: &'a Grid,
    pub(super) bed: &'a Bed,
    /// `N0` of this bed, N.
    pub(super) flush_force_n: f64,
}

/// Force, stiffness and energy of a pin that has sunk.
struct Support {
    force_n: f64,
    stiffness_n_mm: f64,
    energy_n_mm: f64,
}

impl Supports<'_> {
    /// The pin's support at a gap of `u` mm over it: `N = N0 (1 + b) x/(1 + b x)`, `x = <h0 - u>/h0`.
    fn pin(&self, gap_mm: f64) -> Support {
        let h0 = self.bed.protrusion_mm();
        let (x, b) = ((h0 - gap_mm).max(0.0) / h0, self.bed.softening);
        if x == 0.0 {
            return Support { force_n: 0.0, stiffness_n_mm: 0.0, energy_n_mm: 0.0 };
        }
        let (scale, soft) = (self.flush_force_n * (1.0 + b), 1.0 + b * x);
        // The integral of x/(1 + b x); its series where b x is too small for the logarithm.
        let integral = if b * x > 1e-4 { (x - (b * x).ln_1p() / b) / b } else { x * x * (0.5 - b * x / 3.0) };
        Support {
            force_n: scale * x / soft,
            stiffness_n_mm: scale / (h0 * soft * soft),
            energy_n_mm: scale * h0 * integral,
        }
    }

    /// Quadratic form and linear term of string and bending: `E = u'Au/2 - r'u`.
    fn string(&self, tension_n: &[f64]) -> (BandedMatrix, Vec<f64>) {
        let (grid, rc) = (self.grid, self.bed.axis_radius_mm());
        let n = grid.len();
        let mut a = BandedMatrix::zeros(n);
        let mut load = vec![0.0; n];
        for (i, length) in grid.element_mm.iter().enumerate() {
            let k = (tension_n[i] + tension_n[i + 1]) / 2.0 / length;
            a.diagonal[i] += k;
            a.diagonal[i + 1] += k;
            a.first[i] -= k;
        }
        for i in 0..n {
            a.diagonal[i] -= tension_n[i] * grid.share_mm[i] / (rc * rc);
            load[i] -= tension_n[i] * grid.share_mm[i] / rc;
        }
        let stiffness = self.bed.bending_n_mm2;
        if stiffness > 0.0 {
            for i in 1..n.saturating_sub(1) {
                let (left, right) = (grid.element_mm[i - 1], grid.element_mm[i]);
                let k = stiffness * (left + right) / 2.0;
                // Curvature at the node: the three-point second difference, and u/Rc^2.
                let c = [
                    2.0 / (left * (left + right)),
                    1.0 / (rc * rc) - 2.0 / (left * right),
                    2.0 / (right * (left + right)),
                ];
                for (j, cj) in c.iter().enumerate() {
                    a.diagonal[i - 1 + j] += k * cj * cj;
                    load[i - 1 + j] += k * cj / rc;
                }
                a.first[i - 1] += k * c[0] * c[1];
                a.first[i] += k * c[1] * c[2];
                a.second[i - 1] += k * c[0] * c[2];
            }
        }
        (a, load)
    }

    /// Energy, its gradient, and what springs add to the second derivative's diagonal, at `u`.
    fn evaluate(&self, a: &BandedMatrix, load: &[f64], u: &[f64]) -> State {
        let mut gradient = a.times(u);
        let mut springs = vec![0.0; u.len()];
        let mut energy = 0.0;
        let k = self.bed.stiffness_n_mm2();
        for i in 0..u.len() {
            energy += u[i] * (gradient[i] / 2.0 - load[i]);
            gradient[i] -= load[i];
            if u[i] < 0.0 {
                let spring = k * self.grid.silicone_mm[i];
                energy += spring * u[i] * u[i] / 2.0;
                gradient[i] += spring * u[i];
                springs[i] += spring;
            }
        }
        for p in &self.grid.pins {
            let support = self.pin(u[*p]);
            energy += support.energy_n_mm;
            gradient[*p] -= support.force_n;
            springs[*p] += support.stiffness_n_mm;
        }
        State { energy, gradient, springs }
    }

    /// The equilibrium under `tension_n` at the nodes, searched from `start` (a gap at each node).
    ///
    /// # Errors
    /// [`PhysicsError::NotConverged`] if Newton's method does not balance the forces.
    pub(super) fn equilibrium(
        &self,
        tension_n: &[f64],
        start: Option<&[f64]>,
    ) -> Result<Equilibrium, PhysicsError> {
        let (a, load) = self.string(tension_n);
        let bent_n = self.bed.bending_n_mm2 / self.bed.axis_radius_mm().powi(2);
        let bound = BALANCE * (tension_n.iter().copied().fold(0.0, f64::max) + bent_n);
        let mut u = start.map_or_else(|| vec![0.0; self.grid.len()], <[f64]>::to_vec);
        let mut here = self.evaluate(&a, &load, &u);
        for steps in 0..MAX_STEPS {
            if here.unbalanced_n() <= bound {
                return Ok(self.carried(u, steps));
            }
            let step = newton_step(&a, &here);
            let slope: f64 = step.iter().zip(&here.gradient).map(|(s, g)| s * g).sum();
            let mut share = 1.0;
            loop {
                let moved: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + share * s).collect();
                let there = self.evaluate(&a, &load, &moved);
                let lower = there.energy <= here.energy + 1e-4 * share * slope;
                // Near the end, rounding hides the gain; the forces still tell a good step.
                let balanced = there.unbalanced_n() <= 0.5 * here.unbalanced_n()
                    && there.energy <= here.energy + ROUNDING * here.energy.abs();
                if lower || balanced || share < MIN_STEP {
                    (u, here) = (moved, there);
                    break;
                }
                share /= 2.0;
            }
        }
        Err(PhysicsError::NotConverged { unbalanced_n: here.unbalanced_n(), steps: MAX_STEPS })
    }

    fn carried(&self, gap_mm: Vec<f64>, steps: usize) -> Equilibrium {
        let k = self.bed.stiffness_n_mm2();
        let silicone_n =
            gap_mm.iter().zip(&self.grid.silicone_mm).map(|(u, w)| k * w * (-u).max(0.0)).collect();
        let pin_n = self.grid.pins.iter().map(|p| self.pin(gap_mm[*p]).force_n).collect();
        Equilibrium { gap_mm, pin_n, silicone_n, steps }
    }
}

/// Energy and its derivatives at a shape.
struct State {
    energy: f64,
    gradient: Vec<f64>,
    springs: Vec<f64>,
}

impl State {
    /// The largest force left unbalanced at a node, N.
    fn unbalanced_n(&self) -> f64 {
        self.gradient.iter().fold(0.0, |worst, g| worst.max(g.abs()))
    }
}

/// A direction that lowers the energy: Newton's, or Newton's with a stiffer diagonal where the tendon hangs free.
fn newton_step(string: &BandedMatrix, here: &State) -> Vec<f64> {
    let mut shift = 0.0;
    loop {
        let mut matrix = string.clone();
        matrix.diagonal.iter_mut().zip(&here.springs).for_each(|(d, spring)| *d += spring + shift);
        let mut step: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
        let largest = string.diagonal.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        if matrix.solve(&mut step) || shift > largest {
            return step;
        }
        shift = if shift == 0.0 { 1e-6 * largest } else { shift * 10.0 };
    }
}
