//! Verdicts: the outcome of the check of a file, and of each part of a file that contains several.

use std::io::{BufRead, Seek};

use pinswitch_diagnostic::{Diagnostic, codes, excerpt, neutral_line};
use schemars::JsonSchema;
use serde::Serialize;

use crate::validity::{Examination, Expectation, Fault, Level, MeshFacts};

use super::format::{self, Format, unreadable};
use super::judgement::{Judgement, Status};

/// Longest text from a file that is printed, in characters.
const MAX_CHARACTERS: usize = 300;
/// Most parts of a file that are printed.
const MAX_PARTS: usize = 100;

/// The outcome of the check of one file; its facts are the sums over its parts.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Verdict {
    /// The file, as given.
    file: String,
    /// Its format.
    format: &'static str,
    /// Whether it has no fault that counts.
    valid: bool,
    /// Whether all checks that count are complete, or a fault is known.
    judged: bool,
    /// The outcome.
    #[serde(skip)]
    pub status: Status,
    #[serde(flatten)]
    examination: Examination,
    /// Objects of a 3MF.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<PartVerdict>,
}

/// The outcome of the check of one part of a file.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PartVerdict {
    /// Name of the object.
    name: String,
    /// Whether it has no fault that counts.
    valid: bool,
    /// The outcome.
    #[serde(skip)]
    pub status: Status,
    #[serde(flatten)]
    examination: Examination,
}

impl PartVerdict {
    /// The verdict on an object of a 3MF.
    pub fn new(name: String, mut examination: Examination, judgement: Judgement) -> Self {
        judgement.apply(&mut examination.faults, true);
        let status = judgement.status(&examination);
        Self { name, valid: status == Status::Valid, status, examination }
    }
}

impl Verdict {
    /// Reads and examines a file of any supported format. `name` is its name in the verdict, and `bytes` its
    /// length.
    ///
    /// # Errors
    /// A diagnostic if the file is of another format, damaged, or too long to be examined.
    pub fn read(
        reader: &mut (impl BufRead + Seek),
        bytes: u64,
        name: String,
        expected: &Expectation,
        judgement: Judgement,
    ) -> Result<Self, Diagnostic> {
        let format = Format::detect(reader.fill_buf().map_err(unreadable)?)?;
        let most = format.max_bytes();
        if bytes > most {
            return Err(Diagnostic::new(
                codes::MESH_NOT_JUDGED,
                format!("the file has {bytes} bytes, at most {most} are examined"),
            )
            .with_help("export it with a coarser mesh"));
        }
        match format {
            Format::Stl => {
                let mut examination = format::stl(reader, expected)?;
                judgement.apply(&mut examination.faults, false);
                let status = judgement.status(&examination);
                Ok(Self::new(name, format, status, examination, Vec::new()))
            }
            Format::ThreeMf => {
                let (examination, parts) = format::three_mf(reader, expected, judgement)?;
                Ok(Self::of_parts(name, examination, parts, expected, judgement))
            }
        }
    }

    fn new(
        file: String,
        format: Format,
        status: Status,
        examination: Examination,
        parts: Vec<PartVerdict>,
    ) -> Self {
        let (valid, judged) = (status == Status::Valid, status != Status::Unjudged);
        Self { file, format: format.name(), valid, judged, status, examination, parts }
    }

    /// The verdict on a 3MF; `examination` contains the faults of the file as a whole.
    fn of_parts(
        file: String,
        mut examination: Examination,
        parts: Vec<PartVerdict>,
        expected: &Expectation,
        judgement: Judgement,
    ) -> Self {
        let facts = parts.iter().map(|p| p.examination.facts.clone()).reduce(|sum, facts| sum.joined(&facts));
        let facts: MeshFacts = facts.unwrap_or_default();
        if let Some(bodies) = expected.bodies.filter(|bodies| *bodies != facts.bodies) {
            let detail = format!("the file has {} bodies, expected {bodies}", facts.bodies);
            examination.faults.push(Fault::new("bodies", Level::Error, facts.bodies, detail));
        }
        examination.facts = facts;
        judgement.apply(&mut examination.faults, true);
        let of_parts = parts.iter().map(|part| part.status).max().unwrap_or(Status::Valid);
        let status = judgement.status(&examination).max(of_parts);
        Self::new(file, Format::ThreeMf, status, examination, parts)
    }

    /// The bounds that prevented a judgement.
    pub fn bounds(&self) -> Vec<String> {
        let examinations = self.parts.iter().map(|part| &part.examination).chain([&self.examination]);
        let checks = examinations.flat_map(|examination| &examination.incomplete);
        let mut bounds: Vec<_> = checks.map(|one| format!("{}: {}", one.check, one.bound)).collect();
        bounds.sort();
        bounds.dedup();
        bounds
    }

    /// Formats the verdict for a person: a line for the file, for each part and for each fault.
    ///
    /// Names and faults contain text of the file, which may act on a terminal: control characters
    /// become visible.
    pub fn describe(&self) -> String {
        let mut text = format!("{}: {}\n", shown(&self.file), summary(self.status, &self.examination));
        // Parts with findings come first if not all are printed.
        let mut parts: Vec<_> = self.parts.iter().collect();
        if parts.len() > MAX_PARTS {
            parts.sort_by_key(|part| std::cmp::Reverse(part.status));
        }
        for part in parts.iter().take(MAX_PARTS) {
            text += &format!("  {}: {}\n", shown(&part.name), summary(part.status, &part.examination));
            text += &findings(&part.examination, "    ");
        }
        if let Some(more) = parts.len().checked_sub(MAX_PARTS).filter(|more| *more > 0) {
            text += &format!("  {more} more parts\n");
        }
        text + &findings(&self.examination, "  ")
    }
}

/// A line for each fault, the most serious first, and for each check that was not completed.
fn findings(examination: &Examination, indent: &str) -> String {
    let mut faults: Vec<&Fault> = examination.faults.iter().collect();
    faults.sort_by_key(|fault| std::cmp::Reverse(fault.level));
    let faults = faults.into_iter().map(|fault| format!("{}: {fault}", fault.level.name()));
    let incomplete =
        examination.incomplete.iter().map(|one| format!("not completed: {}: {}", one.check, one.bound));
    faults.chain(incomplete).map(|line| format!("{indent}{}\n", shown(&line))).collect()
}

/// The text on one line, of bounded length and without control characters.
fn shown(text: &str) -> String {
    neutral_line(&excerpt(text, MAX_CHARACTERS)).into_owned()
}

fn summary(status: Status, examination: &Examination) -> String {
    let facts = &examination.facts;
    let size: Vec<_> = (0..3).map(|i| format!("{:.2}", facts.high_mm[i] - facts.low_mm[i])).collect();
    format!(
        "{}; {} triangles, {:.3} mm3, {} mm",
        status.words(),
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
        let fault = Fault::new("vocabulary", Level::Error, 1, "\u{9b}2J".repeat(1000));
        let judgement = Judgement { purpose: None, level: Level::Error };
        let examination = Examination { faults: vec![fault], ..Examination::default() };
        let part = PartVerdict::new(name, examination, judgement);
        let expected = Expectation::default();
        let verdict =
            Verdict::of_parts("a\r.3mf".to_owned(), Examination::default(), vec![part], &expected, judgement);
        let text = verdict.describe();
        assert_eq!(text.lines().count(), 3, "{text}");
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text}");
        assert!(text.lines().all(|line| line.chars().count() < 2000), "{text}");
    }
}
