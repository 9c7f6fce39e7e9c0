//! Errors of the STL reader.

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes, excerpt};

use super::binary::HEADER;

/// Longest message of the system that an error repeats, in characters.
const MAX_CHARACTERS: usize = 200;

/// A file that cannot be read as an STL.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    /// The file cannot be read.
    #[error("cannot read the STL: {}", excerpt(&.0.to_string(), MAX_CHARACTERS))]
    Unreadable(#[from] std::io::Error),
    /// A line of an ASCII STL is not what the format requires.
    #[error("line {line}: {problem}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The file is shorter than its count of triangles requires.
    #[error(
        "the header announces {announced} triangles, which take {expected} bytes, but the file has {actual}"
    )]
    Length {
        /// Number of triangles in the header.
        announced: u32,
        /// Bytes that they take.
        expected: u64,
        /// Bytes in the file.
        actual: u64,
    },
    /// The file has another format.
    #[error("the file is {0}, not an STL")]
    OtherFormat(&'static str),
    /// The file has no bytes.
    #[error("the file is empty")]
    NoBytes,
    /// The file is shorter than the header of a binary STL.
    #[error("the file has {0} bytes, but an STL has at least {HEADER}")]
    TooShort(u64),
    /// The file is an STL without triangles.
    #[error("the STL contains no triangle")]
    NoTriangle,
}

impl StlError {
    /// Kind of fault.
    fn code(&self) -> Code {
        match self {
            Self::Unreadable(_) => codes::CANNOT_READ,
            Self::OtherFormat(_) => codes::UNSUPPORTED_FORMAT,
            Self::NoBytes | Self::TooShort(_) => codes::DAMAGED_FILE,
            Self::Line { .. } | Self::Length { .. } | Self::NoTriangle => codes::MALFORMED_MESH_FILE,
        }
    }

    /// The way out.
    fn help(&self) -> &'static str {
        match self {
            Self::Unreadable(_) => "give a file that exists and can be read",
            Self::OtherFormat(_) => "give an STL or a 3MF",
            Self::Length { .. } => "export the part again: the file is cut short, or it is not an STL",
            Self::NoTriangle => "export the part again, with at least one body",
            Self::Line { .. } | Self::NoBytes | Self::TooShort(_) => "export the part again",
        }
    }
}

impl From<StlError> for Diagnostic {
    fn from(error: StlError) -> Self {
        let diagnostic = match &error {
            StlError::Line { line, problem } => Self::new(codes::MALFORMED_MESH_FILE, problem.clone())
                .with_location(Location { line: Some(*line), ..Location::default() }),
            other => Self::new(other.code(), other.to_string()),
        };
        diagnostic.with_help(error.help())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_becomes_a_location() {
        let error = StlError::Line { line: 3, problem: "expected 'outer loop'".to_owned() };
        let diagnostic = Diagnostic::from(error).or_in_file("a.stl");
        assert_eq!(
            diagnostic.render("error"),
            "error: a.stl:3: expected 'outer loop' [malformed-mesh-file]\n  help: export the part again"
        );
    }
}
