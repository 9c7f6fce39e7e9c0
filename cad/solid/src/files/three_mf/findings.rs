//! Findings of a package: each kind is kept a few times, and counted.

use std::collections::BTreeMap;

use pinswitch_diagnostic::excerpt;

use crate::validity::{Fault, Level};

/// Most findings of a kind that are kept with their text.
const MAX_OF_KIND: usize = 3;
/// Longest detail of a finding, in characters: it may quote any text of the file.
const MAX_CHARACTERS: usize = 300;

/// The findings of a package, in the order in which they were met.
#[derive(Debug, Default)]
pub(super) struct Findings {
    faults: Vec<Fault>,
    /// Number of findings of each kind.
    counts: BTreeMap<(&'static str, Level), usize>,
}

impl Findings {
    /// Adds a violation of `paragraph`.
    pub(super) fn error(&mut self, check: &'static str, paragraph: &'static str, detail: &str) {
        self.add(check, Level::Error, 1, paragraph, detail);
    }

    /// Adds a deviation from a recommendation of `paragraph`.
    pub(super) fn warning(&mut self, check: &'static str, paragraph: &'static str, detail: &str) {
        self.add(check, Level::Warning, 1, paragraph, detail);
    }

    /// Adds a finding that occurs `count` times.
    pub(super) fn add(
        &mut self,
        check: &'static str,
        level: Level,
        count: usize,
        paragraph: &'static str,
        detail: &str,
    ) {
        let of_kind = self.counts.entry((check, level)).or_default();
        *of_kind += 1;
        if *of_kind <= MAX_OF_KIND {
            let fault = Fault::new(check, level, count, excerpt(detail, MAX_CHARACTERS));
            self.faults.push(fault.with_paragraph(paragraph));
        }
    }

    /// Returns the findings, with one that counts those of a kind that were not kept.
    pub(super) fn finish(mut self) -> Vec<Fault> {
        for ((check, level), count) in self.counts {
            if let Some(more) = count.checked_sub(MAX_OF_KIND).filter(|more| *more > 0) {
                let detail = format!("{more} more findings of this kind");
                self.faults.push(Fault::new(check, level, more, detail));
            }
        }
        self.faults
    }
}
