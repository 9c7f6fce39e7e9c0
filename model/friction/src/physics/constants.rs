//! The three constants of the materials, with what is known of them.

use nalgebra::Vector3;
use serde::Serialize;

/// Constants of the published bed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Constants {
    /// `kappa` of the coating's ploughing by a pin, `mu = kappa sqrt(N)`, in N^-0.5.
    pub kappa_per_sqrt_n: f64,
    /// Friction coefficient of the coated tendon on the silicone.
    pub mu_silicone: f64,
    /// `N0`: force that sinks a pin flush with the silicone, N.
    pub flush_force_n: f64,
}

impl Constants {
    /// As fitted to the seven published maxima ([`super::fit_maxima`]; a test fits them again).
    pub fn published() -> Self {
        super::fit::PUBLISHED_FIT.constants()
    }

    /// Covariance of the logarithms of the published constants, from the scatter of the maxima about the fit.
    pub fn published_covariance() -> [[f64; 3]; 3] {
        super::fit::PUBLISHED_FIT.covariance
    }

    /// Natural logarithms, in which they are fitted: all are positive, and their errors are relative.
    pub fn logarithms(&self) -> Vector3<f64> {
        Vector3::new(
            libm::log(self.kappa_per_sqrt_n),
            libm::log(self.mu_silicone),
            libm::log(self.flush_force_n),
        )
    }

    /// The constants of these logarithms.
    pub fn from_logarithms(at: &Vector3<f64>) -> Self {
        Self {
            kappa_per_sqrt_n: libm::exp(at[0]),
            mu_silicone: libm::exp(at[1]),
            flush_force_n: libm::exp(at[2]),
        }
    }
}
