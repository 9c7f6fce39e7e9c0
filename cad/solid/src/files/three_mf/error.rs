//! Errors of the 3MF reader.

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};

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
    /// The file needs more work than a bound allows.
    #[error("cannot be judged: {0}")]
    Bound(String),
    /// The file uses a feature without which its content has another meaning.
    #[error("cannot be judged: {0}")]
    Unsupported(String),
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
    /// Kind of fault.
    fn code(&self) -> Code {
        match self {
            Self::Bound(_) | Self::Unsupported(_) => codes::MESH_NOT_JUDGED,
            Self::Archive(_) | Self::NoModel | Self::Malformed { .. } => codes::MALFORMED_MESH_FILE,
        }
    }

    /// The way out.
    fn help(&self) -> &'static str {
        match self {
            Self::NoModel => "give a 3MF file",
            Self::Bound(_) => "a coarser mesh, several files, or the export of another program may meet it",
            Self::Unsupported(_) => "check it in a program that supports this",
            Self::Archive(_) | Self::Malformed { .. } => "export the file again",
        }
    }
}

impl From<ThreeMfReadError> for Diagnostic {
    fn from(error: ThreeMfReadError) -> Self {
        let in_part = |problem: String, part: &str| {
            let location = Location { field: Some(part.to_owned()), ..Location::default() };
            Self::new(codes::MALFORMED_MESH_FILE, problem).with_location(location)
        };
        let diagnostic = match &error {
            ThreeMfReadError::Malformed { part, problem } => in_part(problem.clone(), part),
            other => Self::new(other.code(), other.to_string()),
        };
        diagnostic.with_help(error.help())
    }
}
