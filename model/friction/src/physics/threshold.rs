//! The threshold of a switch, and its derivatives with respect to every dimension.
//!
//! At the threshold `F*` the friction exponents of silicone and pins are equal:
//! `h(ln F, p) = sum over both directions of (x_s - x_p) = 0`. The implicit function theorem gives
//! `d ln F*/dp = -(dh/dp)/(dh/d ln F)`. Both derivatives of `h` follow from the linearised equations
//! at the solution, so that one solution and one back-substitution per three dimensions are enough.

use super::coupled::{Explicit, MAX_PASSES, Workspace};
use super::error::PhysicsError;
use super::made::Dimension;
use super::switch::PhysicsSwitch;

/// Number of loads among which the threshold is searched.
const SCANNED_LOADS: usize = 32;
/// Largest distance of the silicone's share from one half at the threshold.
const SHARE_TOLERANCE: f64 = 1e-9;
/// Largest number of refinements; 4 to 6 are usual.
const MAX_REFINEMENTS: usize = 60;
/// Largest number of secant steps from a similar switch; 3 are usual.
const MAX_SECANTS: usize = 12;
/// Largest change of the logarithm of the load in a secant step.
const MAX_SECANT: f64 = 0.5;
/// First step from a similar switch, as a logarithm of the load.
const FIRST_STEP: f64 = 0.02;
/// Step of the differences of coefficients, relative to the dimension, or in its unit for the angle
/// and the height of a pin. The state is fixed, so that only rounding limits the step.
const STEP: f64 = 1e-5;

impl PhysicsSwitch {
    /// Computes the load at which silicone carries half of the friction, N, among loads from the
    /// first to the last of `range_n`; `None` if it is not among them.
    ///
    /// ```
    /// use pinswitch_friction::physics::{Constants, PhysicsSwitch};
    /// use pinswitch_friction::published::{LAYOUTS, wrap_angle_rad};
    /// use pinswitch_friction::{Contact, PinPattern, Substrate};
    ///
    /// let pins = PinPattern::even(3, LAYOUTS[1].pitch_rad());
    /// let contact = Contact::new(Substrate::Silicone, pins, wrap_angle_rad())?;
    /// let switch = PhysicsSwitch::new(&contact, Constants::published());
    /// let threshold_n = switch.threshold_n((3.0, 50.0))?.ok_or("no threshold")?;
    /// let share = switch.states(&[threshold_n])?[0].silicone_share;
    /// assert!((share - 0.5).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge at a load.
    pub fn threshold_n(&self, range_n: (f64, f64)) -> Result<Option<f64>, PhysicsError> {
        let Some(mut workspace) = self.workspace() else { return Ok(None) };
        let (from, to) = (libm::log(range_n.0), libm::log(range_n.1));
        let mut before = (from, self.share_over_half(from, &mut workspace)?);
        if before.1 >= 0.0 {
            return Ok(None);
        }
        for i in 1..SCANNED_LOADS {
            let log = from + (to - from) * i as f64 / (SCANNED_LOADS - 1) as f64;
            let here = (log, self.share_over_half(log, &mut workspace)?);
            if here.1 >= 0.0 {
                return self.refined(before, here, &mut workspace).map(|log| Some(libm::exp(log)));
            }
            before = here;
        }
        Ok(None)
    }

    /// Computes the threshold as [`PhysicsSwitch::threshold_n`], from that of a similar switch,
    /// which is faster.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge at a load.
    pub fn threshold_near_n(&self, near_n: f64, range_n: (f64, f64)) -> Result<Option<f64>, PhysicsError> {
        let Some(mut workspace) = self.workspace() else { return Ok(None) };
        let (from, to) = (libm::log(range_n.0), libm::log(range_n.1));
        let mut log = libm::log(near_n);
        let mut share = self.share_over_half(log, &mut workspace)?;
        // The share rises with the load.
        let mut step = if share < 0.0 { FIRST_STEP } else { -FIRST_STEP };
        for _ in 0..MAX_SECANTS {
            if share.abs() <= SHARE_TOLERANCE {
                return Ok((from..=to).contains(&log).then(|| libm::exp(log)));
            }
            let next = log + step;
            if !(from..=to).contains(&next) {
                break;
            }
            let there = self.share_over_half(next, &mut workspace)?;
            let slope = (there - share) / step;
            (log, share) = (next, there);
            step = (-share / slope).clamp(-MAX_SECANT, MAX_SECANT);
            if !(slope > 0.0 && step.is_finite()) {
                break;
            }
        }
        self.threshold_n(range_n)
    }

    /// Refines a load between two loads at which the share is below and above one half, by the
    /// Illinois variant of the false position.
    fn refined(
        &self,
        mut low: (f64, f64),
        mut high: (f64, f64),
        workspace: &mut Workspace,
    ) -> Result<f64, PhysicsError> {
        let mut kept = 0;
        for _ in 0..MAX_REFINEMENTS {
            let log = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let share = self.share_over_half(log, workspace)?;
            if share.abs() <= SHARE_TOLERANCE {
                return Ok(log);
            }
            let side = if share < 0.0 { -1 } else { 1 };
            if side < 0 {
                low = (log, share);
                high.1 *= if kept == side { 0.5 } else { 1.0 };
            } else {
                high = (log, share);
                low.1 *= if kept == side { 0.5 } else { 1.0 };
            }
            kept = side;
        }
        Ok((low.0 + high.0) / 2.0)
    }

    /// Returns the share of the silicone in friction, less one half, at the logarithm of a load.
    fn share_over_half(&self, log_load: f64, workspace: &mut Workspace) -> Result<f64, PhysicsError> {
        Ok(self.state_from(libm::exp(log_load), Some(workspace))?.0.silicone_share - 0.5)
    }

    /// Computes the derivatives of the threshold with respect to dimensions, N per unit of each,
    /// with contacts of the silicone as they are at the threshold.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model or a derivative does not converge.
    pub fn threshold_slopes(
        &self,
        threshold_n: f64,
        dimensions: &[Dimension],
    ) -> Result<Vec<f64>, PhysicsError> {
        let Some(mut workspace) = self.workspace() else { return Ok(vec![0.0; dimensions.len()]) };
        self.state_from(threshold_n, Some(&mut workspace))?;
        let failed = PhysicsError::TensionNotConverged { load_n: threshold_n, iterations: MAX_PASSES };
        if !workspace.refactor(&self.supports()) {
            return Err(failed);
        }
        let mut explicit = vec![Explicit { log_load: 1.0, ..Explicit::default() }];
        for dimension in dimensions {
            explicit.push(self.explicit(*dimension, &workspace).ok_or_else(|| failed.clone())?);
        }
        let mut slopes = Vec::with_capacity(explicit.len());
        let mut rest = explicit.into_iter().peekable();
        while rest.peek().is_some() {
            let batch = std::array::from_fn(|_| rest.next().unwrap_or_default());
            let of_batch = workspace
                .slopes(&self.supports(), self.constants(), self.contact().wrap_rad(), &batch)
                .ok_or_else(|| failed.clone())?;
            slopes.extend(of_batch.total.iter().zip(of_batch.silicone).map(|(total, silicone)| {
                // h = x_s - x_p, over both directions.
                let [eccentric, concentric] = (silicone + silicone - *total).numbers();
                eccentric + concentric
            }));
        }
        let by_load = slopes[0];
        Ok(slopes[1..].iter().take(dimensions.len()).map(|by| -threshold_n * by / by_load).collect())
    }

    /// Computes the explicit derivatives with respect to a dimension. `None` if the nodes are not
    /// the same next to it.
    fn explicit(&self, dimension: Dimension, workspace: &Workspace) -> Option<Explicit> {
        let nominal = self.dimensions();
        let step = match dimension {
            Dimension::PinAngle(_) | Dimension::PinHeight(_) => STEP,
            _ => STEP * nominal.get(dimension),
        };
        let moved = |by: f64| {
            let mut dimensions = nominal.clone();
            dimensions.add(dimension, by);
            self.made(&dimensions).ok()
        };
        let (less, more) = (moved(-step)?, moved(step)?);
        let explicit = workspace.explicit([&less.supports(), &more.supports()], step)?;
        let kappa = |switch: &Self| libm::log(switch.contact().bed().ploughing_ratio());
        let wrap = |switch: &Self| libm::log(switch.contact().wrap_rad());
        Some(Explicit {
            log_kappa: (kappa(&more) - kappa(&less)) / (2.0 * step),
            log_wrap: (wrap(&more) - wrap(&less)) / (2.0 * step),
            ..explicit
        })
    }
}
