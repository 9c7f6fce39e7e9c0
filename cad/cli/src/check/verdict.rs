//! Verdicts: the outcome of the check of a file, and of each part of a file that contains several.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use pinswitch_diagnostic::{Diagnostic, excerpt, neutral_line};
use pinswitch_solid::validity::{Examination, Expectation, Fault, MeshFacts};
use serde::Serialize;

use super::format::{self, Format, unreadable};

/// Longest text from a file that is printed, in characters.
const MAX_CHARACTERS: usize = 300;

/// The outcome of the check of one file; its facts are the sums over its parts.
#[derive(Debug, Serialize)]
pub(super) struct Verdict {
    file: String,
    format: &'static str,
    pub(super) valid: bool,
    #[serde(flatten)]
    examination: Examination,
    /// Objects of a 3MF.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<PartVerdict>,
    /// Observations that are not faults.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    remarks: Vec<String>,
}

/// The outcome of the check of one part of a file.
#[derive(Debug, Serialize)]
pub(super) struct PartVerdict {
    pub(super) name: String,
    pub(super) valid: bool,
    #[serde(flatten)]
    pub(super) examination: Examination,
}

impl PartVerdict {
    pub(super) fn new(name: String, examination: Examination) -> Self {
        Self { name, valid: examination.is_valid(), examination }
    }
}

impl Verdict {
    /// Reads and examines a file of any supported format.
    ///
    /// # Errors
    /// A diagnostic if the file cannot be examined.
    pub(super) fn of_file(file: &Path, expected: &Expectation) -> Result<Self, Diagnostic> {
        if file.is_dir() {
            return Err(Diagnostic::new("the path is a folder").with_help("give the files in it"));
        }
        let opened = File::open(file).map_err(unreadable)?;
        let bytes = opened.metadata().map_err(unreadable)?.len();
        let mut reader = BufReader::new(opened);
        let format = Format::detect(reader.fill_buf().map_err(unreadable)?)?;
        let most = format.max_bytes();
        if bytes > most {
            return Err(Diagnostic::new(format!("the file has {bytes} bytes, at most {most} are examined"))
                .with_help("export it with a coarser mesh"));
        }
        let name = file.display().to_string();
        match format {
            Format::Stl => {
                let (examination, remarks) = format::stl(&mut reader, expected)?;
                Ok(Self {
                    file: name,
                    format: format.name(),
                    valid: examination.is_valid(),
                    examination,
                    parts: Vec::new(),
                    remarks,
                })
            }
            Format::ThreeMf => {
                let (faults, parts) = format::three_mf(reader, expected)?;
                Ok(Self::of_parts(name, format, faults, parts, expected))
            }
        }
    }

    /// The verdict on a file with parts; `faults` are those of the file as a whole.
    fn of_parts(
        file: String,
        format: Format,
        mut faults: Vec<Fault>,
        parts: Vec<PartVerdict>,
        expected: &Expectation,
    ) -> Self {
        let facts = parts.iter().map(|p| p.examination.facts.clone()).reduce(|sum, facts| sum.joined(&facts));
        let facts: MeshFacts = facts.unwrap_or_default();
        if let Some(bodies) = expected.bodies.filter(|bodies| *bodies != facts.bodies) {
            faults.push(Fault {
                check: "bodies",
                count: facts.bodies,
                at_mm: None,
                detail: format!("the file has {} bodies, expected {bodies}", facts.bodies),
            });
        }
        let valid = faults.is_empty() && parts.iter().all(|part| part.valid);
        let examination = Examination { facts, faults };
        Self { file, format: format.name(), valid, examination, parts, remarks: Vec::new() }
    }

    /// Formats the verdict for a person: a line for the file, for each part and for each fault.
    ///
    /// Names and faults contain text of the file, which may act on a terminal: control characters
    /// become visible.
    pub(super) fn describe(&self) -> String {
        let mut text = format!("{}: {}\n", shown(&self.file), summary(self.valid, &self.examination));
        for part in &self.parts {
            text += &format!("  {}: {}\n", shown(&part.name), summary(part.valid, &part.examination));
            let faults = part.examination.faults.iter();
            faults.for_each(|fault| text += &format!("    {}\n", shown(&fault.to_string())));
        }
        let faults = self.examination.faults.iter();
        faults.for_each(|fault| text += &format!("  {}\n", shown(&fault.to_string())));
        self.remarks.iter().for_each(|remark| text += &format!("  note: {remark}\n"));
        text
    }
}

/// The text on one line, of bounded length and without control characters.
fn shown(text: &str) -> String {
    neutral_line(&excerpt(text, MAX_CHARACTERS)).into_owned()
}

fn summary(valid: bool, examination: &Examination) -> String {
    let facts = &examination.facts;
    let size: Vec<_> = (0..3).map(|i| format!("{:.2}", facts.high_mm[i] - facts.low_mm[i])).collect();
    format!(
        "{}; {} triangles, {:.3} mm3, {} mm",
        if valid { "valid" } else { "NOT VALID" },
        facts.triangles,
        facts.volume_mm3,
        size.join(" x ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_become_visible() {
        let name = "\u{1b}]0;title\u{7}\nfake: valid".to_owned();
        let fault = Fault { check: "vocabulary", count: 1, at_mm: None, detail: "\u{9b}2J".repeat(1000) };
        let part = PartVerdict::new(name, Examination { faults: vec![fault], ..Examination::default() });
        let expected = Expectation::default();
        let verdict =
            Verdict::of_parts("a\r.3mf".to_owned(), Format::ThreeMf, Vec::new(), vec![part], &expected);
        let text = verdict.describe();
        assert_eq!(text.lines().count(), 3, "{text}");
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text}");
        assert!(text.lines().all(|line| line.chars().count() < 2000), "{text}");
    }
}
