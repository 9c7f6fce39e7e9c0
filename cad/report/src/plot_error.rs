//! The error of a figure.

use pinswitch_diagnostic::{Diagnostic, codes};

/// A figure cannot be drawn, since the drawing library refuses a coordinate.
#[derive(Clone, Debug, thiserror::Error)]
#[error("cannot draw the figure: {0}")]
pub struct PlotError(String);

impl PlotError {
    /// Creates the error from that of the drawing library.
    pub fn new(error: &dyn std::error::Error) -> Self {
        Self(error.to_string())
    }
}

impl From<PlotError> for Diagnostic {
    fn from(error: PlotError) -> Self {
        Self::from_error(codes::INTERNAL_ERROR, error)
    }
}
