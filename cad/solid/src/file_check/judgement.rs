//! Which faults make a file invalid: the purpose that it is judged for, and the level that counts.

use crate::validity::{Examination, Fault, Level};

/// What a file is judged for. Without a purpose, a file must be printable and conform to its
/// specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Whether a slicer prints the part.
    Print,
    /// Whether the file conforms to the specification of its format.
    Spec,
}

/// How faults are judged.
#[derive(Clone, Copy, Debug)]
pub struct Judgement {
    /// Purpose; both without one.
    pub purpose: Option<Purpose>,
    /// Least level that makes a file invalid.
    pub level: Level,
}

/// Checks of a package that change the part which a slicer prints.
const GEOMETRY: [&str; 9] =
    ["number", "index", "triangles", "reference", "build", "transform", "unit", "overlap", "model"];
/// Checks of printability, which no specification requires.
const PRINTABILITY: [&str; 5] = ["thin wall", "size", "outside", "bodies", "non-manifold vertex"];
/// Checks of meshes that the core specification of 3MF requires or recommends (4.1).
const MESH: [&str; 9] = [
    "crack",
    "open edge",
    "non-manifold edge",
    "flipped facet",
    "inside out",
    "repeated facet",
    "self-intersection",
    "degenerate facet",
    "axis volumes",
];

/// Checks of a package whose warnings are of what a producer must not write and every reader ignores: errors only if the
/// file is judged by its specification.
const MUST: [&str; 4] = ["identifier", "metadata", "property", "thumbnail"];

/// The check of names outside of the specification; for attributes that slicers need, it is otherwise a note.
const VOCABULARY: &str = "vocabulary";

impl Judgement {
    /// Sets the levels of the faults of a file as a whole, or of a part of a 3MF.
    pub fn apply(self, faults: &mut [Fault], is_three_mf: bool) {
        for fault in faults {
            if is_three_mf && fault.paragraph.is_none() && MESH.contains(&fault.check) {
                fault.paragraph = Some("3MF core 4.1");
            }
            let is_of_spec = self.purpose == Some(Purpose::Spec);
            if is_of_spec && fault.check == VOCABULARY {
                fault.level = Level::Error;
            }
            let is_strict = is_of_spec && MUST.contains(&fault.check);
            if is_strict && fault.paragraph.is_some() && fault.level == Level::Warning {
                fault.level = Level::Error;
            }
            fault.level = fault.level.min(self.most(fault, is_three_mf));
        }
    }

    /// The highest level of a fault for the purpose.
    fn most(self, fault: &Fault, is_three_mf: bool) -> Level {
        let is_of_package = fault.paragraph.is_some() && !MESH.contains(&fault.check);
        match self.purpose {
            None => Level::Error,
            Some(Purpose::Print) => match fault.check {
                // Slicers close cracks, and compute normals from the order of the corners.
                "crack" | "contrary normals" => Level::Warning,
                check if is_of_package && !GEOMETRY.contains(&check) => Level::Warning,
                _ => Level::Error,
            },
            Some(Purpose::Spec) => match fault.check {
                // Recommendations of 3.4.3.1 and 4.1.
                "overlap" | "self-intersection" | "degenerate facet" if is_three_mf => Level::Warning,
                "bodies" => Level::Error,
                check if PRINTABILITY.contains(&check) => Level::Note,
                _ => Level::Error,
            },
        }
    }

    /// Whether a fault of this kind makes a file invalid.
    pub fn counts(self, fault: &Fault) -> bool {
        fault.level >= self.level
    }

    /// The outcome of an examination, whose faults have the levels of this judgement.
    pub fn status(self, examination: &Examination) -> Status {
        if examination.faults.iter().any(|fault| self.counts(fault)) {
            Status::Invalid
        } else if examination.incomplete.iter().any(|check| check.level >= self.level) {
            Status::Unjudged
        } else {
            Status::Valid
        }
    }
}

/// The outcome of a check; a worse one is greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Nothing counts against the file.
    Valid,
    /// A check that could find a fault was not completed.
    Unjudged,
    /// The file has a fault.
    Invalid,
}

impl Status {
    /// The words for a person.
    pub fn words(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Unjudged => "cannot be judged",
            Self::Invalid => "NOT VALID",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(purpose: Option<Purpose>, check: &'static str, paragraph: Option<&'static str>) -> Level {
        let mut fault = Fault { paragraph, ..Fault::new(check, Level::Error, 1, String::new()) };
        Judgement { purpose, level: Level::Error }.apply(std::slice::from_mut(&mut fault), true);
        fault.level
    }

    #[test]
    fn the_purpose_sets_the_levels() {
        let (print, spec) = (Some(Purpose::Print), Some(Purpose::Spec));
        for (check, paragraph, of_print, of_spec) in [
            ("open edge", None, Level::Error, Level::Error),
            ("self-intersection", None, Level::Error, Level::Warning),
            ("crack", None, Level::Warning, Level::Error),
            ("metadata", Some("3MF core 3.4.1"), Level::Warning, Level::Error),
            ("index", Some("3MF core 4.1.4.1"), Level::Error, Level::Error),
            ("outside", Some("3MF core 3.3"), Level::Warning, Level::Note),
        ] {
            assert_eq!(level(None, check, paragraph), Level::Error, "{check}");
            assert_eq!(level(print, check, paragraph), of_print, "{check}");
            assert_eq!(level(spec, check, paragraph), of_spec, "{check}");
        }
    }

    #[test]
    fn requirements_that_readers_ignore_count_only_for_the_specification() {
        for (purpose, expected) in [
            (None, Level::Warning),
            (Some(Purpose::Print), Level::Warning),
            (Some(Purpose::Spec), Level::Error),
        ] {
            let mut fault = Fault::new("metadata", Level::Warning, 1, String::new());
            fault.paragraph = Some("3MF core 3.4.1");
            Judgement { purpose, level: Level::Error }.apply(std::slice::from_mut(&mut fault), true);
            assert_eq!(fault.level, expected);
        }
    }
}
