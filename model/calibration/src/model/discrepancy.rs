//! Where the form of an effect may be wrong: its size then depends on a covariate.

use serde::{Deserialize, Serialize};

use crate::effects::Covariate;
use crate::table::{Condition, Point};

/// A dimensionless function of the covariates, of order one, that multiplies the size of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "factor")]
pub enum DiscrepancyFactor {
    /// Legendre polynomial over the share of the highest load.
    Load {
        /// 1 or 2.
        degree: u8,
        /// Highest load in newtons.
        most_n: f64,
    },
    /// Legendre polynomial over the session.
    Time {
        /// 1 or 2.
        degree: u8,
    },
    /// Legendre polynomial over the stroke.
    Position {
        /// 1 or 2.
        degree: u8,
    },
    /// Logarithm of the speed, as a share of the largest one.
    Speed {
        /// Largest `|ln(v/v0)|`.
        most: f64,
    },
    /// Logarithm of the dwell, as a share of the largest one.
    Dwell {
        /// Largest `|ln(dwell / 3 s)|`.
        most: f64,
    },
    /// Transient over the first repetitions, `exp(-(r - 1)/2) - 1/2`.
    Repetition,
    /// -1 eccentric, +1 concentric.
    Direction,
    /// 1 on one device.
    Device {
        /// Index of the device.
        device: usize,
    },
}

impl DiscrepancyFactor {
    /// Returns its value at a point on a condition.
    pub fn value(self, point: &Point, condition: &Condition) -> f64 {
        match self {
            Self::Load { degree, most_n } => legendre(degree, point.load_n / most_n),
            Self::Time { degree } => legendre(degree, point.time),
            Self::Position { degree } => legendre(degree, point.position),
            Self::Speed { most } => point.log_speed / most,
            Self::Dwell { most } => point.log_dwell / most,
            Self::Repetition => libm::exp(-(point.repetition - 1.0) / 2.0) - 0.5,
            Self::Direction => point.sign,
            Self::Device { device } => f64::from(u8::from(condition.device == Some(device))),
        }
    }
}

/// Returns the Legendre polynomial of degree 1 or 2 over a share 0..1.
fn legendre(degree: u8, share: f64) -> f64 {
    let u = 2.0 * share - 1.0;
    if degree == 1 { u } else { 1.5 * u * u - 0.5 }
}

/// A discrepancy of a term: its size is multiplied by one plus the sum of `value * factor`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Discrepancy {
    /// Index of the term.
    pub term: usize,
    /// Value of the factor's coefficient.
    pub value: f64,
    /// Standard deviation of it.
    pub sd: f64,
    /// The factor.
    #[serde(flatten)]
    pub factor: DiscrepancyFactor,
}

/// Highest load in newtons and largest logarithms of speed and dwell of a table, to which factors refer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Largest {
    pub(crate) load_n: f64,
    pub(crate) log_speed: f64,
    pub(crate) log_dwell: f64,
}

impl Largest {
    /// Returns the factors along a covariate on a table with these devices.
    pub(crate) fn factors(&self, covariate: Covariate, devices: usize) -> Vec<DiscrepancyFactor> {
        let degrees = [1, 2];
        match covariate {
            Covariate::Load => {
                degrees.map(|degree| DiscrepancyFactor::Load { degree, most_n: self.load_n }).to_vec()
            }
            Covariate::Time => degrees.map(|degree| DiscrepancyFactor::Time { degree }).to_vec(),
            Covariate::Position => degrees.map(|degree| DiscrepancyFactor::Position { degree }).to_vec(),
            Covariate::Speed => vec![DiscrepancyFactor::Speed { most: self.log_speed }],
            Covariate::Dwell => vec![DiscrepancyFactor::Dwell { most: self.log_dwell }],
            Covariate::Repetition => vec![DiscrepancyFactor::Repetition],
            Covariate::Condition if devices > 1 => {
                (0..devices).map(|device| DiscrepancyFactor::Device { device }).collect()
            }
            Covariate::Direction => vec![DiscrepancyFactor::Direction],
            Covariate::Condition | Covariate::Sweep => Vec::new(),
        }
    }
}
