//! What is known of a file: of all of it, and of each part of a file that holds several.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_solid::validity::{Examination, Expectation, Fault, MeshFacts};
use serde::Serialize;

use super::format::{self, Format};

/// What is known of one file; its facts are those of all its parts together.
#[derive(Debug, Serialize)]
pub(super) struct Verdict {
    file: String,
    format: &'static str,
    pub(super) valid: bool,
    #[serde(flatten)]
    examination: Examination,
    /// Objects of a 3MF, solids of a STEP.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<PartVerdict>,
    /// What is worth knowing, and no fault.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    remarks: Vec<String>,
}

/// What is known of one part of a file.
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

/// Examines a file of any kind that is known.
pub(super) fn of(file: &Path, expected: &Expectation, tolerance_mm: f64) -> Result<Verdict, Diagnostic> {
    if file.is_dir() {
        return Err(Diagnostic::new("is a folder").with_help("give the files in it"));
    }
    let opened = File::open(file).map_err(format::unreadable)?;
    let length = opened.metadata().map_err(format::unreadable)?.len();
    let mut reader = BufReader::new(opened);
    let head = reader.fill_buf().map_err(format::unreadable)?;
    let format = Format::of(head);
    let most = format.longest();
    if length > most {
        let problem = format!("is {length} bytes long, more than {most}");
        return Err(Diagnostic::new(problem).with_help("export it coarser"));
    }
    let name = file.display().to_string();
    match format {
        Format::Stl => {
            let (examination, remarks) = format::stl(&mut reader, expected)?;
            Ok(Verdict {
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
            Ok(Verdict::of_parts(name, format, faults, parts, expected))
        }
        Format::Step => {
            let (faults, parts) = format::step(reader, expected, tolerance_mm)?;
            Ok(Verdict::of_parts(name, format, faults, parts, expected))
        }
    }
}

impl Verdict {
    /// Of a file with parts; `faults` are those of the file as a whole.
    fn of_parts(
        file: String,
        format: Format,
        mut faults: Vec<Fault>,
        parts: Vec<PartVerdict>,
        expected: &Expectation,
    ) -> Self {
        let facts =
            parts.iter().map(|p| &p.examination.facts).fold(None, |sum, facts| Some(together(sum, facts)));
        let facts = facts.unwrap_or_default();
        if let Some(wanted) = expected.bodies.filter(|wanted| *wanted != facts.bodies) {
            faults.push(Fault {
                check: "bodies",
                count: facts.bodies,
                at_mm: None,
                detail: format!("the file has {} bodies, expected are {wanted}", facts.bodies),
            });
        }
        let valid = faults.is_empty() && parts.iter().all(|part| part.valid);
        let examination = Examination { facts, faults };
        Self { file, format: format.name(), valid, examination, parts, remarks: Vec::new() }
    }

    /// The verdict in words, a line for the file and for each part, and one for each fault.
    pub(super) fn describe(&self) -> String {
        let mut text = format!("{}: {}\n", self.file, summary(self.valid, &self.examination));
        for part in &self.parts {
            text += &format!("  {}: {}\n", part.name, summary(part.valid, &part.examination));
            part.examination.faults.iter().for_each(|fault| text += &format!("    {fault}\n"));
        }
        self.examination.faults.iter().for_each(|fault| text += &format!("  {fault}\n"));
        self.remarks.iter().for_each(|remark| text += &format!("  note: {remark}\n"));
        text
    }
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

/// Facts of what was seen so far and of one more.
fn together(sum: Option<MeshFacts>, more: &MeshFacts) -> MeshFacts {
    let Some(sum) = sum else { return more.clone() };
    MeshFacts {
        triangles: sum.triangles + more.triangles,
        vertices: sum.vertices + more.vertices,
        bodies: sum.bodies + more.bodies,
        voids: sum.voids + more.voids,
        volume_mm3: sum.volume_mm3 + more.volume_mm3,
        surface_mm2: sum.surface_mm2 + more.surface_mm2,
        low_mm: std::array::from_fn(|i| sum.low_mm[i].min(more.low_mm[i])),
        high_mm: std::array::from_fn(|i| sum.high_mm[i].max(more.high_mm[i])),
        min_height_mm: sum.min_height_mm.min(more.min_height_mm),
    }
}
