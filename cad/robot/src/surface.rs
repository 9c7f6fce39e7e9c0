//! Tensions of a switch over load and wrap angle.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::FrictionCurve;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Serialize;

/// Name and version of the JSON format.
const SCHEMA: &str = "pinswitch.surface/1";
/// Standard normal variate of the edge of a 95 % band.
const EDGE: f64 = 1.96;

/// Tensions of a switch: rows for wrap angles, columns for loads.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Surface {
    /// Name and version of the format.
    schema: &'static str,
    /// Name of the switch.
    name: String,
    /// Law of the tensions.
    law: &'static str,
    /// Wrap angles, ascending, rad.
    wrap_rad: Vec<f64>,
    /// Loads, ascending, N.
    load_n: Vec<f64>,
    /// Tension while the load is released, N.
    eccentric_n: Vec<Vec<f64>>,
    /// Tension while the load is pulled, N.
    concentric_n: Vec<Vec<f64>>,
    /// Factors of the friction exponents at the edges of the band.
    #[serde(skip)]
    factors: Vec<Vec<[f64; 2]>>,
}

impl Surface {
    /// Creates the table of curves at ascending wrap angles in radians, which have the same loads.
    ///
    /// # Errors
    /// A [`Diagnostic`] without curves, for other loads, or where a tension does not grow with the load: the load at a
    /// tension would not be unique.
    pub fn new(name: &str, curves: Vec<(f64, FrictionCurve)>) -> Result<Self, Diagnostic> {
        let Some((_, first)) = curves.first() else {
            return Err(Diagnostic::new(codes::TENSION_NOT_INCREASING, "a switch without curves")
                .with_help("give at least one wrap angle"));
        };
        let (law, load_n) = (first.law.as_str(), first.load_n.clone());
        for (wrap_rad, curve) in &curves {
            let rises = |column: &[f64]| column.windows(2).all(|pair| pair[1] > pair[0]);
            let is_whole = curve.load_n == load_n && load_n.len() > 1;
            if !(is_whole
                && [&curve.load_n, &curve.eccentric_n, &curve.concentric_n].iter().all(|c| rises(c)))
            {
                let location =
                    Location::field("layout.wrap_angle_deg", format!("{:.2}", wrap_rad.to_degrees()));
                return Err(Diagnostic::new(
                    codes::TENSION_NOT_INCREASING,
                    "the tension does not grow with the load at this wrap angle",
                )
                .with_location(location)
                .with_help("give at least two loads, or another law"));
            }
        }
        let factors = curves.iter().map(|(_, curve)| factors(curve)).collect();
        Ok(Self {
            schema: SCHEMA,
            name: name.to_owned(),
            law,
            wrap_rad: curves.iter().map(|(wrap_rad, _)| *wrap_rad).collect(),
            eccentric_n: curves.iter().map(|(_, curve)| curve.eccentric_n.clone()).collect(),
            concentric_n: curves.iter().map(|(_, curve)| curve.concentric_n.clone()).collect(),
            load_n,
            factors,
        })
    }

    /// Returns the name of the switch.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the loads, N.
    pub fn load_n(&self) -> &[f64] {
        &self.load_n
    }

    pub(crate) fn wrap_rad(&self) -> &[f64] {
        &self.wrap_rad
    }

    pub(crate) fn eccentric_n(&self) -> &[Vec<f64>] {
        &self.eccentric_n
    }

    pub(crate) fn concentric_n(&self) -> &[Vec<f64>] {
        &self.concentric_n
    }

    /// Returns the table for a standard normal variate `z` of the band: 0 is the curve, and -1.96 and 1.96 are the
    /// edges. The exponents of both directions are multiplied by the same factor (`model/doc/finger.md`, "Bands"); the
    /// error is the same quantile at every load and wrap angle.
    #[must_use]
    pub fn drawn(&self, z: f64) -> Self {
        let mut drawn = self.clone();
        let scaled = |tension_n: f64, load_n: f64, [low, high]: [f64; 2]| {
            let edge = if z < 0.0 { low } else { high };
            load_n * libm::exp(libm::log(tension_n / load_n) * libm::pow(edge, z.abs() / EDGE))
        };
        for table in [&mut drawn.eccentric_n, &mut drawn.concentric_n] {
            for (row, factors) in table.iter_mut().zip(&self.factors) {
                for ((tension_n, load_n), factor) in row.iter_mut().zip(&self.load_n).zip(factors) {
                    *tension_n = scaled(*tension_n, *load_n, *factor);
                }
            }
        }
        drawn
    }

    /// Returns `count` tables drawn from the band, as [`Self::drawn`].
    pub fn draws(&self, count: u32, seed: u64) -> Vec<Self> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(|_| self.drawn(normal(&mut random))).collect()
    }

    /// Returns the table as JSON.
    ///
    /// # Errors
    /// A [`Diagnostic`] if a number is not finite.
    pub fn to_json(&self) -> Result<String, Diagnostic> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
        Ok(text + "\n")
    }

    /// Returns the table as CSV, with a line for each wrap angle and load.
    pub fn to_csv(&self) -> String {
        let mut text = "wrap_deg,load_N,eccentric_N,concentric_N\n".to_owned();
        for (i, wrap_rad) in self.wrap_rad.iter().enumerate() {
            for (j, load_n) in self.load_n.iter().enumerate() {
                let (eccentric_n, concentric_n) = (self.eccentric_n[i][j], self.concentric_n[i][j]);
                text +=
                    &format!("{:.4},{load_n:.6},{eccentric_n:.6},{concentric_n:.6}\n", wrap_rad.to_degrees());
            }
        }
        text
    }
}

/// Draws a standard normal variate by the method of Box and Muller.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (share, turn): (f64, f64) = (random.random(), random.random());
    (-2.0 * libm::log(1.0 - share)).sqrt() * libm::cos(std::f64::consts::TAU * turn)
}

/// Returns the factors of the friction exponent at both edges of the band, `asinh(D_edge/F)/asinh(D/F)`.
fn factors(curve: &FrictionCurve) -> Vec<[f64; 2]> {
    let exponent = |friction_n: f64, load_n: f64| libm::asinh(friction_n / load_n);
    (0..curve.load_n.len())
        .map(|i| {
            let middle = exponent(curve.friction_n[i], curve.load_n[i]);
            let edge = |friction_n: f64| exponent(friction_n, curve.load_n[i]) / middle;
            [edge(curve.band_low_n[i]), edge(curve.band_high_n[i])]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};

    fn curve() -> FrictionCurve {
        let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
        let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
        predict(&contact, &[5.0, 20.0, 49.671])
    }

    #[test]
    fn draws_reach_the_edges_of_the_band() {
        let curve = curve();
        let surface = Surface::new("s", vec![(1.1, curve.clone())]).unwrap();
        assert_eq!(surface.drawn(0.0), surface);
        for (z, edge_n) in [(-EDGE, &curve.band_low_n), (EDGE, &curve.band_high_n)] {
            let drawn = surface.drawn(z);
            for (i, edge_n) in edge_n.iter().enumerate() {
                // The directions differ a little: the geometric mean of both exponents is that of the friction.
                let friction_n = (drawn.concentric_n[0][i] - drawn.eccentric_n[0][i]) / 2.0;
                assert!((friction_n / edge_n - 1.0).abs() < 0.02, "{friction_n} {edge_n}");
            }
        }
    }

    #[test]
    fn draws_are_normal_and_reproducible() {
        let surface = Surface::new("s", vec![(1.1, curve())]).unwrap();
        let draws = surface.draws(2000, 1);
        assert_eq!(draws[..3], surface.draws(3, 1)[..]);
        let below = |z: f64| {
            let limit_n = surface.drawn(z).concentric_n[0][2];
            draws.iter().filter(|draw| draw.concentric_n[0][2] < limit_n).count() as f64 / 2000.0
        };
        for (z, share) in [(-EDGE, 0.025), (-1.0, 0.159), (0.0, 0.5), (EDGE, 0.975)] {
            assert!((below(z) - share).abs() < 0.03, "{z}: {}", below(z));
        }
    }

    #[test]
    fn falling_tensions_are_refused() {
        let mut wrong = curve();
        wrong.eccentric_n[2] = 1.0;
        let error = Surface::new("s", vec![(1.1, wrong)]).unwrap_err();
        assert_eq!(error.location().unwrap().field.as_deref(), Some("layout.wrap_angle_deg"));
        assert!(Surface::new("s", Vec::new()).is_err());
    }

    #[test]
    fn csv_has_a_line_for_each_load() {
        let surface = Surface::new("s", vec![(0.5, curve()), (1.1, curve())]).unwrap();
        assert_eq!(surface.to_csv().lines().count(), 7);
    }
}
