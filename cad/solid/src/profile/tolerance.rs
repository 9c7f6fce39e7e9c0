//! The chord tolerance of flattened curves.

use pinswitch_diagnostic::{Diagnostic, codes};
use serde::Serialize;

/// A chord tolerance outside of the supported range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("chord tolerance {value} mm is outside of {min} to {max} mm")]
pub struct ToleranceError {
    value: f64,
    min: f64,
    max: f64,
}

impl From<ToleranceError> for Diagnostic {
    fn from(error: ToleranceError) -> Self {
        Self::new(codes::OUT_OF_RANGE, error.to_string()).with_help("use 0.01 mm, which suits every printer")
    }
}

/// Largest distance in millimetres between a flattened curve and the exact one, in both directions.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
pub struct ChordTolerance(f64);

impl ChordTolerance {
    /// Least tolerance: the single precision of binary STL is coarser than a smaller one.
    pub const MIN_MM: f64 = 1e-4;
    /// Largest tolerance: a larger one distorts grooves of half a millimetre.
    pub const MAX_MM: f64 = 0.1;

    /// Creates a tolerance of `mm` millimetres.
    ///
    /// # Errors
    /// [`ToleranceError`] outside of [`Self::MIN_MM`]..=[`Self::MAX_MM`].
    pub fn new(mm: f64) -> Result<Self, ToleranceError> {
        if (Self::MIN_MM..=Self::MAX_MM).contains(&mm) {
            Ok(Self(mm))
        } else {
            Err(ToleranceError { value: mm, min: Self::MIN_MM, max: Self::MAX_MM })
        }
    }

    /// The tolerance in millimetres.
    pub fn mm(self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_out_of_range_are_refused() {
        for bad in [0.0, -1.0, 9e-5, 0.11, f64::NAN, f64::INFINITY] {
            assert!(ChordTolerance::new(bad).is_err(), "{bad}");
        }
        assert!(ChordTolerance::new(1e-4).is_ok() && ChordTolerance::new(0.1).is_ok());
    }
}
