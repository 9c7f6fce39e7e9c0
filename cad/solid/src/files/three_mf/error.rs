//! Errors of the 3MF reader.

use pinswitch_diagnostic::{Diagnostic, Location};

/// Size in bytes of the largest part that is unpacked: a small archive can contain endless zeros.
pub(super) const MAX_PART: u64 = 1 << 30;

/// A file that cannot be read as a 3MF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ThreeMfReadError {
    /// The archive, or a part of it, cannot be unpacked.
    #[error("cannot read the ZIP archive: {0}")]
    Archive(String),
    /// The archive contains no model.
    #[error("the ZIP archive contains no 3D model")]
    NoModel,
    /// A part is too large.
    #[error("{part}: more than {MAX_PART} bytes when unpacked")]
    TooLong {
        /// Name of the part.
        part: String,
    },
    /// A part is not the XML that it should be.
    #[error("{part}: {problem}")]
    Malformed {
        /// Name of the part.
        part: String,
        /// What is wrong.
        problem: String,
    },
}

impl ThreeMfReadError {
    /// The way out.
    fn help(&self) -> &'static str {
        match self {
            Self::NoModel => "give a 3MF file",
            Self::TooLong { .. } => "export it with a coarser mesh",
            Self::Archive(_) | Self::Malformed { .. } => "export the file again",
        }
    }
}

impl From<ThreeMfReadError> for Diagnostic {
    fn from(error: ThreeMfReadError) -> Self {
        let in_part = |problem: String, part: &str| {
            let location = Location { field: Some(part.to_owned()), ..Location::default() };
            Self::new(problem).with_location(location)
        };
        let diagnostic = match &error {
            ThreeMfReadError::TooLong { part } => {
                in_part(format!("more than {MAX_PART} bytes when unpacked"), part)
            }
            ThreeMfReadError::Malformed { part, problem } => in_part(problem.clone(), part),
            other => Self::new(other.to_string()),
        };
        diagnostic.with_help(error.help())
    }
}
