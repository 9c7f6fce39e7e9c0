//! The chord tolerance: how far a flattened curve may lie from the true one.

use serde::Serialize;

/// The chord tolerance is outside the range that meshes of this size can hold.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("chord tolerance {value} mm is outside {min} to {max} mm; 0.01 mm suits every printer")]
pub struct ToleranceError {
    value: f64,
    min: f64,
    max: f64,
}

/// Largest distance in millimetres between a flattened curve and the true one; absolute, in both directions.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
pub struct ChordTolerance(f64);

impl ChordTolerance {
    /// Below this, binary STL's single precision is coarser than the tolerance.
    pub const MIN_MM: f64 = 1e-4;
    /// Above this, grooves of half a millimetre lose their shape.
    pub const MAX_MM: f64 = 0.1;

    /// A tolerance of `mm` millimetres.
    ///
    /// # Errors
    /// [`ToleranceError`] outside [`Self::MIN_MM`]..=[`Self::MAX_MM`].
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
    fn only_tolerances_in_range_exist() {
        for bad in [0.0, -1.0, 9e-5, 0.11, f64::NAN, f64::INFINITY] {
            assert!(ChordTolerance::new(bad).is_err(), "{bad}");
        }
        assert!(ChordTolerance::new(1e-4).is_ok() && ChordTolerance::new(0.1).is_ok());
    }
}
