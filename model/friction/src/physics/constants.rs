//! The three constants of the materials, and their fit to the published maxima.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

/// Material constants for the published bed; a [`Bed`](crate::bed::Bed) scales them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Constants {
    /// Ploughing coefficient `kappa` of the coating on a pin, `mu = kappa sqrt(N)`, in N^-0.5.
    pub kappa_per_sqrt_n: f64,
    /// Friction coefficient of the coated tendon on the silicone.
    pub mu_silicone: f64,
    /// Force `N0` that sinks a pin flush with the silicone, N.
    pub flush_force_n: f64,
}

impl Constants {
    /// Returns the constants fitted to the seven published maxima by [`super::fit_maxima`]; a test
    /// repeats the fit.
    pub fn published() -> Self {
        PUBLISHED_FIT.constants()
    }

    /// Returns the covariance of the logarithms of the published constants, from the scatter of the
    /// maxima about the fit.
    pub fn published_covariance() -> [[f64; 3]; 3] {
        PUBLISHED_FIT.covariance
    }

    /// Returns the natural logarithms, the parameters of the fit: the constants are positive, their
    /// errors relative.
    pub fn logarithms(&self) -> Vector3<f64> {
        Vector3::new(
            libm::log(self.kappa_per_sqrt_n),
            libm::log(self.mu_silicone),
            libm::log(self.flush_force_n),
        )
    }

    /// Creates constants from their natural logarithms.
    pub fn from_logarithms(at: &Vector3<f64>) -> Self {
        Self {
            kappa_per_sqrt_n: libm::exp(at[0]),
            mu_silicone: libm::exp(at[1]),
            flush_force_n: libm::exp(at[2]),
        }
    }
}

/// Result of a fit as data: constants, covariance of their logarithms, and errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PublishedFit {
    /// kappa in N^-0.5, mu_s, N0 in N.
    pub(crate) constants: [f64; 3],
    /// Covariance of their logarithms.
    pub(crate) covariance: [[f64; 3]; 3],
    /// Relative scatter of the maxima about the fit.
    pub(crate) scatter: f64,
    /// Root mean square of the relative leave-one-layout-out errors.
    pub(crate) left_out_rms: f64,
    /// Degrees of freedom: number of maxima minus number of constants.
    pub(crate) degrees_of_freedom: f64,
}

/// Fit to the seven maxima on the published bed; a test repeats it.
pub(crate) const PUBLISHED_FIT: PublishedFit = PublishedFit {
    constants: [0.023634, 0.23221, 8.0572],
    covariance: [
        [7.775e-4, 8.4e-6, 4.461e-4],
        [8.4e-6, 1.2615e-3, 9.142e-4],
        [4.461e-4, 9.142e-4, 2.6036e-3],
    ],
    scatter: 0.0488,
    left_out_rms: 0.0552,
    degrees_of_freedom: 4.0,
};

impl PublishedFit {
    /// Returns the fitted constants.
    pub(crate) fn constants(&self) -> Constants {
        let [kappa_per_sqrt_n, mu_silicone, flush_force_n] = self.constants;
        Constants { kappa_per_sqrt_n, mu_silicone, flush_force_n }
    }
}
