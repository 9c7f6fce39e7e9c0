//! Tension along the wrap, integrated from the load to the motor for one direction of motion.
//!
//! A contact that turns the tendon by `theta` raises the friction exponent by
//! `kappa sqrt(T theta) theta` at a pin (ploughing of the coating, `model/doc/friction-laws.md`:
//! `mu = kappa sqrt(N)`), and by `mu_s theta` on the silicone; `T` is the local tension. Shape and
//! tension depend on each other: a fixed-point iteration computes both.

use super::constants::Constants;
use super::equilibrium::{Equilibrium, Supports};
use super::error::PhysicsError;
use crate::capstan::Direction;

/// Largest number of iterations; 3 to 6 are usual.
const MAX_ITERATIONS: usize = 40;
/// Number of iterations without damping of the tension.
const UNDAMPED_ITERATIONS: usize = 8;
/// Largest relative change of the tension in the last iteration.
pub(super) const TOLERANCE: f64 = 1e-6;

/// State of a loaded tendon that slides in one direction.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sliding {
    /// Friction exponent of the pins: their part of `|ln(T/F)|`.
    pub(super) pins_exponent: f64,
    /// Friction exponent of the silicone.
    pub(super) silicone_exponent: f64,
    /// Turn at each pin, rad.
    pub(super) pin_turn_rad: Vec<f64>,
    /// Turn on the silicone, rad.
    pub(super) silicone_turn_rad: f64,
    /// Tension at each node, N.
    pub(super) tension_n: Vec<f64>,
    /// Shape and support forces.
    pub(super) shape: Equilibrium,
    /// Factor that makes the turns sum to the wrap. It differs from 1 by a few percent, the error
    /// of the linearised string.
    pub(super) closure: f64,
}

/// Problem of a tendon that slides over its supports.
#[derive(Clone, Copy)]
pub(super) struct Slide<'a> {
    /// Supports of the tendon.
    pub(super) supports: Supports<'a>,
    /// Friction of the materials.
    pub(super) constants: &'a Constants,
    /// Sum of all turns, rad.
    pub(super) wrap_rad: f64,
    /// Load at the first node, N.
    pub(super) load_n: f64,
    /// Direction of motion.
    pub(super) direction: Direction,
}

/// Computes the state of a sliding tendon; `start` is a similar state, such as that at the previous
/// load.
///
/// # Errors
/// [`PhysicsError`] if the shape or the tension does not converge, or if nothing supports the
/// tendon.
pub(super) fn slide(tendon: Slide<'_>, start: Option<&Sliding>) -> Result<Sliding, PhysicsError> {
    let Slide { supports, load_n, .. } = tendon;
    let nodes = supports.grid.len();
    // The tension of the similar state, scaled to the load.
    let mut tension_n = match start.filter(|s| s.tension_n.len() == nodes) {
        Some(near) => {
            let scale = load_n / near.tension_n.first().copied().unwrap_or(load_n);
            near.tension_n.iter().map(|t| t * scale).collect()
        }
        None => vec![load_n; nodes],
    };
    let mut gap: Option<Vec<f64>> = start.map(|s| s.shape.gap_mm.clone()).filter(|gap| gap.len() == nodes);
    for iteration in 0..MAX_ITERATIONS {
        let shape = supports
            .equilibrium(&tension_n, gap.as_deref())
            .or_else(|_| supports.equilibrium(&tension_n, None))?;
        let (sliding, change) = march(tendon, &tension_n, shape)?;
        if change <= TOLERANCE {
            return Ok(sliding);
        }
        if iteration < UNDAMPED_ITERATIONS {
            tension_n = sliding.tension_n;
        } else {
            // Shape and tension oscillate: damp by the geometric mean.
            tension_n.iter_mut().zip(&sliding.tension_n).for_each(|(t, new)| *t = (*t * new).sqrt());
        }
        gap = Some(sliding.shape.gap_mm);
    }
    Err(PhysicsError::TensionNotConverged { load_n, iterations: MAX_ITERATIONS })
}

/// Integrates along the wrap: turns from the forces, tension from the turns. Also returns the
/// largest relative change of the tension.
fn march(tendon: Slide<'_>, tension_n: &[f64], shape: Equilibrium) -> Result<(Sliding, f64), PhysicsError> {
    let Slide { supports, constants, wrap_rad, load_n, direction } = tendon;
    let grid = supports.grid;
    let at_pin = |(force, node): (&f64, &usize)| force / tension_n[*node];
    let turned: f64 = shape.silicone_n.iter().zip(tension_n).map(|(q, t)| q / t).sum::<f64>()
        + shape.pin_n.iter().zip(&grid.pins).map(at_pin).sum::<f64>();
    if turned.is_nan() || turned <= 0.0 {
        return Err(PhysicsError::NoSupport);
    }
    let closure = wrap_rad / turned;
    let pin_turn_rad: Vec<f64> = shape.pin_n.iter().zip(&grid.pins).map(|p| closure * at_pin(p)).collect();
    let kappa = constants.kappa_per_sqrt_n * supports.bed.ploughing_ratio();
    let (mut log_ratio, mut pins_exponent, mut silicone_exponent, mut silicone_turn_rad) =
        (0.0, 0.0, 0.0, 0.0);
    let (mut next, mut change) = (0, 0.0f64);
    let mut marched = Vec::with_capacity(tension_n.len());
    for (node, t) in tension_n.iter().enumerate() {
        let turn = closure * shape.silicone_n[node] / t;
        silicone_turn_rad += turn;
        let mut rise = constants.mu_silicone * turn;
        silicone_exponent += rise;
        while grid.pins.get(next) == Some(&node) {
            let theta = pin_turn_rad[next];
            let ploughing = kappa * (t * theta).sqrt() * theta;
            pins_exponent += ploughing;
            rise += ploughing;
            next += 1;
        }
        // The tension of a node is that in the middle of its contact.
        let here = load_n * libm::exp(direction.sign() * (log_ratio + rise / 2.0));
        log_ratio += rise;
        change = change.max((here / t - 1.0).abs());
        marched.push(here);
    }
    let sliding = Sliding {
        pins_exponent,
        silicone_exponent,
        pin_turn_rad,
        silicone_turn_rad,
        tension_n: marched,
        shape,
        closure,
    };
    Ok((sliding, change))
}

/// Returns the turn at each touching pin of a rigid proxy, rad: half of both neighbouring pitches,
/// and the rest of the wrap at the outermost pins. A pin beyond the wrap touches while the chord to
/// its neighbour turns less than the tendon; its turn then falls continuously to zero.
pub(super) fn polygon_turns_rad(pins_rad: &[f64], wrap_rad: f64) -> Vec<f64> {
    let mut pins_rad = pins_rad;
    while let [.., before, last] = pins_rad
        && before + last >= wrap_rad
    {
        pins_rad = &pins_rad[..pins_rad.len() - 1];
    }
    while let [first, after, ..] = pins_rad
        && first + after <= -wrap_rad
    {
        pins_rad = &pins_rad[1..];
    }
    let half = |i: usize| (pins_rad[i + 1] - pins_rad[i]) / 2.0;
    let last = pins_rad.len().saturating_sub(1);
    (0..pins_rad.len())
        .map(|i| {
            let before = if i == 0 { pins_rad[0] + wrap_rad / 2.0 } else { half(i - 1) };
            let after = if i == last { wrap_rad / 2.0 - pins_rad[last] } else { half(i) };
            before + after
        })
        .collect()
}

/// Returns the friction exponent of pins on a rigid proxy, integrated from the load in `direction`;
/// `kappa` in N^-0.5.
pub(super) fn pins_alone_exponent(turns_rad: &[f64], kappa: f64, load_n: f64, direction: Direction) -> f64 {
    turns_rad.iter().fold(0.0, |x, theta| {
        // The tension in the middle of the pin, by two fixed-point iterations; the rise is a few
        // percent.
        let middle = |rise: f64| load_n * libm::exp(direction.sign() * (x + rise / 2.0));
        let plough = |t: f64| kappa * (t * theta).sqrt() * theta;
        let first = plough(middle(0.0));
        x + plough(middle(plough(middle(first))))
    })
}

/// Returns the derivative of [`pins_alone_exponent`] with respect to the logarithm of `kappa`.
pub(super) fn pins_alone_slope(turns_rad: &[f64], kappa: f64, load_n: f64, direction: Direction) -> f64 {
    let (_, slope) = turns_rad.iter().fold((0.0, 0.0), |(x, slope), theta| {
        let sign = direction.sign();
        let middle = |rise: f64| load_n * libm::exp(sign * (x + rise / 2.0));
        // Rise of a pin, and its derivative, from the rise in the iteration before.
        let plough = |(rise, by): (f64, f64)| {
            let new = kappa * (middle(rise) * theta).sqrt() * theta;
            (new, new * (1.0 + sign * (slope + by / 2.0) / 2.0))
        };
        let (rise, by) = plough(plough(plough((0.0, 0.0))));
        (x + rise, slope + by)
    });
    slope
}
