//! Friction at the contact: pins, silicone and the switch between them, with the effects of a plan.

use pinswitch_friction::{LayoutLaw, Substrate, published};

use crate::plan::Plan;
use crate::row_covariates::RowCovariates;

/// Reference load in newtons (`model/doc/effect-catalogue.md`).
pub(super) const F0_N: f64 = 50.0;

/// Contact of a condition.
#[derive(Clone, Debug)]
pub(super) struct TwinContact {
    substrate: Option<Substrate>,
    pins: Vec<usize>,
    wrap_rad: f64,
    /// Turn at each pin in radians; they sum to the wrap (`model/doc/friction-laws.md`).
    turns_rad: Vec<f64>,
    half_load_n: f64,
    steepness: f64,
}

/// Friction exponents of a row, with all effects.
struct Exponents {
    pins: f64,
    silicone: f64,
}

impl TwinContact {
    /// Creates the contact of a condition; `device` is the number of layouts on silicone before it.
    pub(super) fn new(plan: &Plan, substrate: Option<Substrate>, pins: &[usize], device: usize) -> Self {
        let wrap_rad = if substrate.is_none() { 1.0 } else { plan.wrap_angle_deg.to_radians() };
        let at: Vec<f64> =
            pins.iter().map(|g| *g as f64 * published::GROOVE_PITCH_DEG.to_radians()).collect();
        let span = at.last().zip(at.first()).map_or(0.0, |(l, f)| l - f);
        let outside = (wrap_rad - span).max(0.0) / 2.0;
        let n = pins.len();
        let turns_rad = (0..n)
            .map(|i| {
                let before = if i == 0 { outside } else { (at[i] - at[i - 1]) / 2.0 };
                let after = if i + 1 == n { outside } else { (at[i + 1] - at[i]) / 2.0 };
                before + after
            })
            .collect();
        let pitch = if n > 1 { span / (n as f64 - 1.0) } else { wrap_rad };
        let factor = plan.constants.half_load_factor.get(device).copied().unwrap_or(1.0);
        Self {
            substrate,
            pins: pins.to_vec(),
            wrap_rad,
            turns_rad,
            half_load_n: LayoutLaw::SCALE_N * (n as f64 / (wrap_rad * pitch)).sqrt() * factor,
            steepness: plan.constants.steepness_of(device),
        }
    }

    /// Whether the contact is a layout on silicone.
    pub(super) fn switches(&self) -> bool {
        self.substrate == Some(Substrate::Silicone) && !self.pins.is_empty()
    }

    /// Returns the tension in newtons at a load, from the tension of the previous iteration.
    pub(super) fn tension_n(&self, plan: &Plan, at: &RowCovariates, load_n: f64, before_n: f64) -> f64 {
        let x = self.exponents(plan, at, load_n, before_n);
        let grow = |x: f64| load_n * (at.sign * x).exp();
        let c = plan.effects.iter().find(|e| e.id == "adhesion");
        let stuck = |share: f64| c.map_or(0.0, |e| at.sign * e.values[0] * share);
        if !self.switches() {
            return if self.substrate == Some(Substrate::Abs) {
                grow(x.pins)
            } else {
                grow(x.silicone) + stuck(1.0)
            };
        }
        let s = self.switched(plan, at, load_n, before_n);
        let w = self.pins.len() as f64 / 30.0;
        let carried = if c.is_some_and(|e| e.form == 1) { (1.0 - w) * s } else { s };
        // Eq. 4 on T - F of each branch (`model/doc/friction-laws.md`).
        load_n
            + (1.0 + w) * (1.0 - s) * (grow(x.pins) - load_n)
            + (1.0 - w) * s * (grow(x.silicone) - load_n)
            + stuck(carried)
    }

    /// Returns the share of the contact that has switched to silicone, 0 to 1.
    fn switched(&self, plan: &Plan, at: &RowCovariates, load_n: f64, tension_n: f64) -> f64 {
        let mut half_n = self.half_load_n;
        let mut local = None;
        for e in &plan.effects {
            match (e.id.as_str(), e.form) {
                ("switching_hysteresis", 1) => half_n += e.values[0] * if at.down { -0.5 } else { 0.5 },
                ("switching_hysteresis", _) if at.down => half_n -= e.values[0],
                ("switch_local_tension", form) => local = Some(form),
                _ => {}
            }
        }
        let s = |force_n: f64| 1.0 / (1.0 + (-self.steepness * (force_n / half_n - 1.0)).exp());
        let ratio = (tension_n / load_n.max(1e-9)).max(1e-3);
        match local {
            None => s(load_n),
            Some(1) => s(0.5 * (load_n + tension_n)),
            Some(2) => {
                (0..16).map(|i| s(load_n * ratio.powf((f64::from(i) + 0.5) / 16.0))).sum::<f64>() / 16.0
            }
            Some(_) if (ratio - 1.0).abs() < 1e-9 => s(load_n),
            Some(_) => s(load_n * (ratio - 1.0) / ratio.ln()),
        }
    }

    /// Returns the friction exponents with all effects that change them.
    fn exponents(&self, plan: &Plan, at: &RowCovariates, load_n: f64, tension_n: f64) -> Exponents {
        let share = load_n / F0_N;
        let mean_share = 0.5 * (load_n + tension_n) / F0_N;
        let (mut pins, mut silicone, mut both, mut ploughing) = (1.0, 1.0, at.seating, 0.0);
        for e in &plan.effects {
            let k = e.values.first().copied().unwrap_or(0.0);
            let shape = e.values.get(1).copied().unwrap_or(0.0);
            match (e.id.as_str(), e.form) {
                ("coating_stiffening", 1) => pins *= 1.0 + k * settling(share, 1.0),
                ("coating_stiffening", 2) => pins *= 1.0 + k * mean_share.powf(shape),
                ("coating_stiffening", _) => pins *= 1.0 + k * share.powf(shape),
                ("coating_ploughing", form) => ploughing += self.ploughing(form, k, at.sign, load_n),
                ("polygon_bending", form) => pins *= self.bending(form, k),
                ("substrate_saturation", 1) => silicone *= (1.0 + share).powf(-k),
                ("substrate_saturation", 2) => silicone /= (1.0 + 2.0 * k * share).sqrt(),
                ("substrate_saturation", _) => {
                    silicone *= share.powf(-k * (1.0 - shape)) / (1.0 + k * shape * share);
                }
                ("dwell_relaxation", 1) => silicone *= (at.dwell_s / published::DWELL_S).powf(k),
                ("dwell_relaxation", _) => silicone *= 1.0 + k * (at.dwell_s / published::DWELL_S).ln(),
                ("run_in", 1) => silicone *= 1.0 + k / (1.0 + (at.repetition - 1.0) / shape),
                ("run_in", 2) => silicone *= 1.0 + k * (-(at.series_repetition - 1.0) / shape).exp(),
                ("run_in", _) => {
                    let restart = if at.sign > 0.0 { e.values.get(2).copied().unwrap_or(1.0) } else { 1.0 };
                    silicone *= 1.0 + restart * k * settled(at.repetition - 1.0, shape, e.values.get(3));
                }
                ("wear_drift", 1) => both *= 1.0 + k * at.travel_share,
                ("wear_drift", 2) => both *= 1.0 + k * at.time_share,
                ("wear_drift", _) => both *= 1.0 + k * settling(at.travel_share, shape),
                ("rate_dependence", 1) => both *= (at.speed_pct / at.mean_speed_pct).powf(k),
                ("rate_dependence", _) => both *= 1.0 + k * (at.speed_pct / at.mean_speed_pct).ln(),
                ("direction_asymmetry", 1) => both *= (at.sign * k / 2.0).exp(),
                ("direction_asymmetry", _) => both *= 1.0 + at.sign * k / 2.0,
                ("fixture_compliance", 1) => both *= 1.0 + k * mean_share,
                ("fixture_compliance", 2) => both *= 1.0 + k * share.powf(0.8),
                ("fixture_compliance", _) => both *= 1.0 + k * share,
                ("stroke_position", 1) => {
                    both *= 1.0 + k * (std::f64::consts::PI * (at.stroke_share - 0.5)).sin() / 2.0;
                }
                ("stroke_position", _) => both *= 1.0 + k * (at.stroke_share - 0.5),
                _ => {}
            }
        }
        for d in &plan.disturbances {
            let (p, s) = d.on_friction(at, &self.pins);
            pins *= p;
            silicone *= s;
            ploughing *= p;
        }
        Exponents {
            pins: (plan.constants.mu_p * self.wrap_rad * pins + ploughing) * both,
            silicone: plan.constants.mu_s * self.wrap_rad * silicone * both,
        }
    }

    /// Returns the friction exponent from ploughing at the pins.
    fn ploughing(&self, form: u8, kappa: f64, sign: f64, load_n: f64) -> f64 {
        match form {
            1 => {
                let mut tension_n = load_n;
                self.turns_rad
                    .iter()
                    .map(|t| {
                        let x = kappa * tension_n.sqrt() * t.powf(1.5);
                        tension_n *= (sign * x).exp();
                        x
                    })
                    .sum()
            }
            2 => {
                let unit = F0_N.powf(0.05) * 0.3f64.powf(0.05);
                self.turns_rad.iter().map(|t| kappa * unit * load_n.powf(0.45) * t.powf(1.45)).sum()
            }
            _ => self.turns_rad.iter().map(|t| kappa * load_n.sqrt() * t.powf(1.5)).sum(),
        }
    }

    /// Returns the factor of bending on the friction of the pins; the reference turn is 20 degrees.
    fn bending(&self, form: u8, k: f64) -> f64 {
        let n = self.turns_rad.len();
        if n == 0 {
            return 1.0;
        }
        let reference = 20f64.to_radians();
        let mean = self.wrap_rad / n as f64 / reference;
        match form {
            1 => 1.0 + k * mean * mean,
            2 => {
                let weighted: f64 = self.turns_rad.iter().map(|t| t * t).sum();
                1.0 + k * weighted / self.wrap_rad / reference
            }
            _ => 1.0 + k * mean,
        }
    }
}

/// Order of run-in above one up to which its decay is exponential: below, `1 + q x` loses its digits.
const LEAST_ORDER: f64 = 1e-6;

/// Returns what remains of run-in after a number of repetitions: exponential decay, or slower decay of an order above one.
fn settled(repetitions: f64, r0: f64, order: Option<&f64>) -> f64 {
    match order {
        Some(q) if *q > LEAST_ORDER => (1.0 + q * repetitions / r0).powf(-1.0 / q),
        _ => (-repetitions / r0).exp(),
    }
}

/// Returns an exponential approach with time constant `t`, which is 0 at `u = 0` and 1 at `u = 1`.
fn settling(u: f64, t: f64) -> f64 {
    (1.0 - (-u / t).exp()) / (1.0 - (-1.0 / t).exp())
}
