//! The ZIP archive of a package, and the XML documents in it.

use std::io::{Cursor, Read};

use pinswitch_diagnostic::excerpt;
use roxmltree::{Document, ParsingOptions};
use zip::ZipArchive;
use zip::result::ZipError;

use super::core_spec::{MODEL_TYPE, RELATIONSHIPS};
use super::error::{MAX_PART, ThreeMfReadError};

/// Most nodes of a document: some five million triangles with their vertices.
const MAX_NODES: u32 = 8_000_000;
/// Longest message of the XML parser that an error repeats, in characters.
const MAX_CHARACTERS: usize = 200;

/// The parts of a package, by name.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ThreeMfReadError> {
        // The library's own messages name its internals.
        let zip = ZipArchive::new(Cursor::new(bytes))
            .map_err(|_| ThreeMfReadError::Archive("it is truncated or damaged".to_owned()))?;
        Ok(Self { zip })
    }

    /// Returns a part as text; `None` if the package has no part of that name.
    pub(super) fn text(&mut self, part: &str) -> Result<Option<String>, ThreeMfReadError> {
        let damaged =
            || ThreeMfReadError::Archive(format!("{} in it is damaged", excerpt(part, MAX_CHARACTERS)));
        let file = match self.zip.by_name(part) {
            Ok(file) => file,
            Err(ZipError::FileNotFound) => return Ok(None),
            Err(_) => return Err(damaged()),
        };
        let mut bytes = Vec::new();
        file.take(MAX_PART + 1).read_to_end(&mut bytes).map_err(|_| damaged())?;
        if bytes.len() as u64 > MAX_PART {
            return Err(ThreeMfReadError::TooLong { part: excerpt(part, MAX_CHARACTERS) });
        }
        String::from_utf8(bytes).map(Some).map_err(|_| malformed(part, "not UTF-8"))
    }
}

/// The error of a part that is not what it should be.
pub(super) fn malformed(part: &str, problem: &str) -> ThreeMfReadError {
    ThreeMfReadError::Malformed {
        part: excerpt(part, MAX_CHARACTERS),
        problem: excerpt(problem, MAX_CHARACTERS),
    }
}

/// Parses the XML of a part.
pub(super) fn parsed<'a>(text: &'a str, part: &str) -> Result<Document<'a>, ThreeMfReadError> {
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    // Some programs write a byte order mark.
    Document::parse_with_options(text.trim_start_matches('\u{feff}'), options)
        .map_err(|e| malformed(part, &e.to_string()))
}

/// Returns the part that the relationships of a package name as its model.
pub(super) fn related_model(relationships: &str) -> Result<Option<String>, ThreeMfReadError> {
    let document = parsed(relationships, RELATIONSHIPS)?;
    let model = document.descendants().find(|n| n.attribute("Type") == Some(MODEL_TYPE));
    Ok(model.and_then(|n| n.attribute("Target")).map(|path| path.trim_start_matches('/').to_owned()))
}
