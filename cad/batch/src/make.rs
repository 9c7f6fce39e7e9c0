//! One variant: refused, reused from an earlier run, or made.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use pinswitch_diagnostic::{Diagnostic, codes};

use super::checksum::with_checksum;
use super::constraint::Violation;
use super::content::{ContentError, MeshMaker, PartStore, StoredPart, content_path};
use super::destination::{Destination, DestinationError};
use super::inspect::{Inspection, Inspector};
use super::prediction_cache::{CachedPrediction, PredictionCache};
use super::slicing::VariantSlicer;
use super::variant::{Variant, Variants};
use pinswitch_slicer::Slicer;
use pinswitch_solid::verification::Kernel;
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::{BatchEntry, FileEntry, Manifest};
use pinswitch_switch::feasibility;
use pinswitch_switch::formats::curve_files;
use pinswitch_switch::output::{BuildError, OutputFile, SetError};
use pinswitch_switch::parts::{PRINTED_PARTS, Part, PrintedPart, fit_on_bed, printed_of};
use pinswitch_switch::prediction::Prediction;

/// File of a variant's curve.
pub(super) const CURVE: &str = "friction.csv";
/// File of its plot, in a sweep with plots.
const FIGURE: &str = "friction.svg";

/// What became of a variant.
#[derive(Clone, Debug, PartialEq)]
pub enum VariantOutcome {
    /// Its files are at the destination.
    Made {
        /// The bytes of its manifest.
        manifest: Vec<u8>,
        /// The bytes of the table of its curve.
        curve: Vec<u8>,
        /// Whether an earlier run made it.
        reused: bool,
    },
    /// It cannot be built, or does not meet a constraint.
    Refused(Refusal),
    /// An error occurred while it was made.
    Failed(Diagnostic),
}

/// Why a variant is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// It has the same settings as an earlier variant.
    Repeats {
        /// The id of the earlier variant.
        id: String,
    },
    /// Its configuration cannot be built, printed or assembled.
    Configuration(Diagnostic),
    /// It does not meet a constraint of the sweep.
    Constraint(Violation),
}

impl Refusal {
    /// Returns what many refusals have in common: the field or the constraint, without values.
    pub fn kind(&self) -> String {
        match self {
            Self::Repeats { .. } => "repeats another variant".to_owned(),
            Self::Configuration(error) => {
                error.location().and_then(|location| location.field.clone()).unwrap_or_default()
            }
            Self::Constraint(violation) => format!("constraint {:?}", violation.constraint),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Repeats { id } => write!(f, "repeats {id}"),
            Self::Configuration(error) => write!(f, "{error}"),
            Self::Constraint(violation) => write!(f, "{violation}"),
        }
    }
}

impl From<Refusal> for Diagnostic {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Configuration(error) => error,
            Refusal::Repeats { .. } => Self::new(codes::DUPLICATE_ENTRY, refusal.to_string()),
            Refusal::Constraint(_) => Self::new(codes::CONSTRAINT_NOT_SATISFIED, refusal.to_string()),
        }
    }
}

impl From<Diagnostic> for Refusal {
    fn from(error: Diagnostic) -> Self {
        Self::Configuration(error)
    }
}

/// Makes variants at a destination.
pub(super) struct VariantMaker<'a> {
    variants: &'a Variants,
    sweep_sha256: &'a str,
    destination: &'a Destination,
    contents: PartStore<'a>,
    predictions: PredictionCache,
    slicer: Option<VariantSlicer<'a>>,
    /// Checks the variants of an earlier run, if there can be any.
    inspector: Option<Inspector<'a>>,
}

/// Returns the folder of a variant.
pub(super) fn variant_folder(id: &str) -> String {
    format!("variants/{id}")
}

/// A variant that can be made.
pub(super) struct AcceptedVariant {
    design: Design,
    prediction: Arc<CachedPrediction>,
    /// The parts of the sweep.
    parts: Vec<Part>,
}

/// Builds the design of a variant and its parts, and checks everything that can refuse it, so that
/// a dry run and a run refuse the same variants.
///
/// # Errors
/// Why the variant is refused.
pub(super) fn accept(
    variants: &Variants,
    variant: &Variant,
    predictions: &PredictionCache,
) -> Result<AcceptedVariant, Refusal> {
    if let Some(original) = variant.repeats {
        return Err(Refusal::Repeats { id: variants.get(original).id });
    }
    let design = Design::new(variant.configuration.clone())?;
    let prediction = predictions.get(&design);
    let mut constraints = variants.sweep().constraints.iter();
    let violation = constraints.find_map(|c| c.violation(&design, prediction.curve(&design)));
    if let Some(violation) = violation {
        return Err(Refusal::Constraint(violation));
    }
    let parts = printed_of(&design, |name| variants.sweep().parts.contains(&name))?;
    fit_on_bed(&parts, &design)?;
    Ok(AcceptedVariant { design, prediction, parts })
}

impl<'a> VariantMaker<'a> {
    /// A maker for `destination`; `is_resumed` if it can contain variants of the same sweep.
    pub(super) fn new(
        variants: &'a Variants,
        sweep_sha256: &'a str,
        destination: &'a Destination,
        is_resumed: bool,
        mesh_maker: MeshMaker,
        slicer: Option<&'a Slicer>,
    ) -> Self {
        Self {
            variants,
            sweep_sha256,
            destination,
            contents: PartStore::new(destination, mesh_maker),
            predictions: PredictionCache::default(),
            slicer: slicer.map(VariantSlicer::new),
            inspector: is_resumed.then(|| Inspector::new(destination)),
        }
    }

    /// The same maker, which verifies every mesh with `kernel`.
    pub(super) fn with_kernel(mut self, kernel: Option<Kernel>) -> Self {
        self.contents = self.contents.with_kernel(kernel);
        self
    }

    /// Makes `variant` unless it is refused or exists already.
    ///
    /// # Errors
    /// An error that would fail every other variant, too, such as a full disk.
    pub(super) fn make(&self, variant: &Variant) -> Result<VariantOutcome, DestinationError> {
        if let Some(inspector) = &self.inspector
            && let Some(made) = self.existing(inspector, variant)?
        {
            return Ok(made);
        }
        let accepted = match accept(self.variants, variant, &self.predictions) {
            Ok(accepted) => accepted,
            Err(refusal) => return Ok(VariantOutcome::Refused(refusal)),
        };
        match self.build(variant, &accepted) {
            Ok((manifest, curve)) => Ok(VariantOutcome::Made { manifest, curve, reused: false }),
            Err(ContentError::Destination(e)) if e.is_fatal() => Err(e),
            Err(ContentError::Set(SetError::Build(error))) => {
                // A part that cannot be built is the fault of a value, if another value makes it buildable.
                match feasibility::explained(error, accepted.design.configuration()) {
                    BuildError::Configuration(e) => Ok(VariantOutcome::Refused(e.into())),
                    other => Ok(VariantOutcome::Failed(ContentError::Set(SetError::Build(other)).into())),
                }
            }
            Err(e) => Ok(VariantOutcome::Failed(e.into())),
        }
    }

    /// Makes the files of a variant, and returns the bytes of its manifest and of its curve.
    fn build(
        &self,
        variant: &Variant,
        accepted: &AcceptedVariant,
    ) -> Result<(Vec<u8>, Vec<u8>), ContentError> {
        let AcceptedVariant { design, prediction, parts } = accepted;
        let stored: Vec<_> =
            parts.iter().map(|part| self.contents.store(part, design)).collect::<Result<_, _>>()?;
        let linked: Vec<_> =
            parts.iter().zip(&stored).map(|(part, stored)| part_entry(&part.name, stored)).collect();
        let curve = prediction.shared(design)?;
        let plots = self.plots(design, &curve.prediction)?;
        let facts = parts.iter().zip(stored.iter().map(|s| &s.facts));
        let mut manifest = Manifest::new(design, facts, &curve.prediction);
        for (entry, stored) in manifest.parts.iter_mut().zip(&stored) {
            entry.verification.clone_from(&stored.verification);
        }
        let tables = curve.files.iter().map(|(_, entry)| entry.clone());
        manifest.files.extend(linked.iter().cloned().chain(tables).chain(plots.iter().map(FileEntry::of)));
        manifest.batch = Some(BatchEntry {
            sweep_sha256: self.sweep_sha256.to_owned(),
            index: variant.index,
            label: variant.label.clone(),
        });
        if let Some(slicer) = &self.slicer {
            let parts: Vec<_> = parts
                .iter()
                .zip(&stored)
                .map(|(part, stored)| (part.name.as_str(), stored.sha256.as_str()))
                .collect();
            let read = |sha256: &str| self.contents.read(sha256);
            manifest.print = Some(slicer.entry(design.configuration(), &parts, read)?);
        }
        let bytes = with_checksum(manifest.bytes()?);
        let folder = variant_folder(&variant.id);
        for file in curve.files.iter().map(|(file, _)| file).chain(&plots) {
            self.destination.put(&format!("{folder}/{}", file.name), &file.bytes)?;
        }
        for entry in linked {
            if let Some(content) = &entry.content {
                self.destination.link(content, &format!("{folder}/{}", entry.file))?;
            }
        }
        // The manifest comes last: a variant with a manifest is complete.
        self.destination.put(&format!("{folder}/manifest.json"), &bytes)?;
        let table = curve.files.iter().find(|(file, _)| file.name == CURVE);
        Ok((bytes, table.map(|(file, _)| file.bytes.clone()).unwrap_or_default()))
    }

    /// Draws the plots of one variant; they contain its name.
    fn plots(&self, design: &Design, prediction: &Prediction) -> Result<Vec<OutputFile>, SetError> {
        if !self.variants.sweep().plots {
            return Ok(Vec::new());
        }
        let mut files = curve_files(design, prediction, true)?;
        files.retain(|file| file.name.ends_with(".svg"));
        Ok(files)
    }

    /// Returns a variant of an earlier run, if its manifest lists the files that this run would make
    /// and all of them are unchanged. That run has accepted the variant.
    fn existing(
        &self,
        inspector: &Inspector<'_>,
        variant: &Variant,
    ) -> Result<Option<VariantOutcome>, DestinationError> {
        let Some((bytes, listing)) = inspector.manifest(&variant.id)? else { return Ok(None) };
        if listing.batch.sweep_sha256 != self.sweep_sha256 || listing.batch.index != variant.index {
            return Ok(None);
        }
        // The earlier run had no slicer.
        if self.slicer.is_some() && listing.print.is_none() {
            return Ok(None);
        }
        let sweep = self.variants.sweep();
        let is_made = |part: &&PrintedPart| {
            sweep.parts.contains(&part.name) && (part.is_wanted)(&variant.configuration)
        };
        let expected: BTreeSet<String> = PRINTED_PARTS
            .iter()
            .filter(is_made)
            .map(|part| format!("{}.stl", part.name))
            .chain([CURVE.to_owned()])
            .chain(sweep.plots.then(|| FIGURE.to_owned()))
            .collect();
        let listed: BTreeSet<String> = listing.files.iter().map(|file| file.file.clone()).collect();
        let inspection = if listed == expected {
            inspector.inspect(&variant.id, &listing)?
        } else {
            Inspection { damaged: Some("manifest.json"), curve: None }
        };
        match inspection {
            Inspection { damaged: None, curve: Some(curve) } => {
                Ok(Some(VariantOutcome::Made { manifest: bytes, curve, reused: true }))
            }
            Inspection { damaged, .. } => {
                let file = damaged.unwrap_or(CURVE);
                log::warn!("{}: {file} is missing or has changed; the variant is made again", variant.id);
                Ok(None)
            }
        }
    }
}

fn part_entry(name: &str, part: &StoredPart) -> FileEntry {
    FileEntry {
        file: format!("{name}.stl"),
        bytes: part.bytes,
        sha256: part.sha256.clone(),
        content: Some(content_path(&part.sha256)),
    }
}
