//! Faults of meshes and files.

use schemars::JsonSchema;
use serde::Serialize;

use crate::mesh::Point3;

/// How serious a fault is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// An observation without consequences for the part.
    Note,
    /// The part can be printed, with a risk.
    Warning,
    /// The mesh is not a solid, or the file breaks its specification.
    Error,
}

impl Level {
    /// Returns the name of the level, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A fault of a mesh or of a file: its name, level, number of occurrences, place and extent.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Fault {
    /// Name of the check that failed.
    pub check: &'static str,
    /// How serious the fault is.
    pub level: Level,
    /// Number of edges, facets, vertices or bodies concerned.
    pub count: usize,
    /// Place of the first or worst occurrence, mm; absent for a fault without a place.
    pub at_mm: Option<[f64; 3]>,
    /// What is wrong, and by how much.
    pub detail: String,
    /// Paragraph of the specification that the file breaks, such as `3MF core 3.4.2`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paragraph: Option<&'static str>,
}

impl Fault {
    /// Creates a fault without a place.
    pub fn new(check: &'static str, level: Level, count: usize, detail: String) -> Self {
        Self { check, level, count, at_mm: None, detail, paragraph: None }
    }

    /// Returns the fault with a place in mm.
    #[must_use]
    pub fn with_place(self, at_mm: [f64; 3]) -> Self {
        Self { at_mm: Some(at_mm), ..self }
    }

    /// Returns the fault at a point.
    pub(super) fn at(self, point: Point3) -> Self {
        self.with_place(point.coords.into())
    }

    /// Returns the fault with the paragraph of the specification that the file breaks.
    #[must_use]
    pub fn with_paragraph(self, paragraph: &'static str) -> Self {
        Self { paragraph: Some(paragraph), ..self }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.check, self.detail)?;
        if let Some([x, y, z]) = self.at_mm {
            write!(f, " (at {x:.4} {y:.4} {z:.4} mm)")?;
        }
        self.paragraph.map_or(Ok(()), |paragraph| write!(f, " [{paragraph}]"))
    }
}
