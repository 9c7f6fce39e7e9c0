//! What is handed from one step to the next on the way to a set: a file in memory, or why there is none.

use crate::config::Diagnostic;
use pinswitch_report::PlotError;
use pinswitch_solid::solid::CapError;
use pinswitch_solid::validity::Fault;

/// A file to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Its name in the folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// A file of these bytes.
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
            other => Self::new(other.problem()).with_help("report the configuration").with_source(other),
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
    /// A file cannot be put together.
    #[error("cannot put a file together: {0}")]
    Encoding(String),
}

impl SetError {
    /// A file that cannot be put together, for this reason.
    pub fn encoding(error: impl std::fmt::Display) -> Self {
        Self::Encoding(error.to_string())
    }
}
