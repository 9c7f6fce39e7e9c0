//! Files in memory, and the errors of building and of encoding.

use crate::config::Diagnostic;
use pinswitch_diagnostic::{Code, codes};
use pinswitch_report::PlotError;
use pinswitch_solid::solid::CapError;
use pinswitch_solid::validity::Fault;

/// A file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Name in the folder of the set.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// A file with a name and its content.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// Why a design cannot be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A value of the configuration cannot be built.
    #[error(transparent)]
    Configuration(#[from] Diagnostic),
    /// Contours of a part cross: a bound is missing, and this is a fault of the program.
    #[error("{part}: {source}; please report the configuration")]
    Cap {
        /// The part.
        part: String,
        /// Where.
        source: CapError,
    },
    /// A mesh is not valid: a fault of the program.
    #[error("{part}: invalid mesh: {fault}; please report the configuration")]
    Invalid {
        /// The part.
        part: String,
        /// What is wrong.
        fault: Fault,
    },
}

impl BuildError {
    /// Kind of fault.
    pub fn code(&self) -> Code {
        match self {
            Self::Configuration(error) => error.code(),
            Self::Cap { .. } => codes::SHAPE_CANNOT_BE_BUILT,
            Self::Invalid { .. } => codes::INVALID_MESH,
        }
    }

    /// Returns what is wrong, without field and help.
    pub fn problem(&self) -> String {
        match self {
            Self::Configuration(error) => error.problem().to_owned(),
            Self::Cap { part, .. } => format!("contours of {part} cross"),
            Self::Invalid { part, fault } => format!("mesh of {part} is invalid: {fault}"),
        }
    }
}

impl From<BuildError> for Diagnostic {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Configuration(error) => error,
            other => Self::new(other.code(), other.problem())
                .with_help("report the configuration")
                .with_source(other),
        }
    }
}

/// Why a set cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// A part cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file cannot be encoded.
    #[error("cannot encode a file: {0}")]
    Encoding(String),
}

impl SetError {
    /// A file that cannot be encoded, with the reason.
    pub fn encoding(error: impl std::fmt::Display) -> Self {
        Self::Encoding(error.to_string())
    }
}

impl From<SetError> for Diagnostic {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Build(error) => error.into(),
            SetError::Plot(error) => {
                Self::new(codes::INTERNAL_ERROR, "cannot draw the plot of the curve").with_source(error)
            }
            SetError::Encoding(reason) => {
                Self::new(codes::INTERNAL_ERROR, format!("cannot encode a file: {reason}"))
            }
        }
    }
}
