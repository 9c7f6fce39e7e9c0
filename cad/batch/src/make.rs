//! One variant: refused, kept from an earlier run, or made.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::content::{ContentError, MeshMaker, PartStore, StoredPart, content_path};
use super::destination::{Destination, DestinationError};
use super::forecast::{Forecast, Forecasts};
use super::inspect::Inspector;
use super::seal::seal;
use super::slicing::VariantSlicer;
use super::variant::{Variant, Variants};
use pinswitch_slicer::Slicer;
use pinswitch_solid::verification::Kernel;
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::{BatchEntry, FileEntry, Manifest};
use pinswitch_switch::formats::curve_files;
use pinswitch_switch::output::{BuildError, OutputFile, SetError};
use pinswitch_switch::parts::{Part, fit_on_bed, printed};
use pinswitch_switch::prediction::Prediction;

/// The table of a variant's curve.
const CURVE: &str = "friction.csv";
/// Its figure, where the sweep asks for plots.
const FIGURE: &str = "friction.svg";

/// What became of a variant.
#[derive(Clone, Debug, PartialEq)]
pub enum VariantOutcome {
    /// Its files are at the destination; this is its manifest.
    Made {
        /// The manifest's bytes.
        manifest: Vec<u8>,
        /// Whether it is left from an earlier run.
        reused: bool,
    },
    /// It cannot be built, or a constraint forbids it.
    Refused(String),
    /// Making it failed.
    Failed(String),
}

/// Makes variants at a destination.
pub(super) struct VariantMaker<'a> {
    variants: &'a Variants,
    sweep_sha256: &'a str,
    destination: &'a Destination,
    contents: PartStore<'a>,
    forecasts: Forecasts,
    slicer: Option<VariantSlicer<'a>>,
    /// What looks at the variants that an earlier run may have left.
    inspector: Option<Inspector<'a>>,
}

/// The folder of a variant.
pub(super) fn variant_folder(id: &str) -> String {
    format!("variants/{id}")
}

/// A variant that can be made.
pub(super) struct AcceptedVariant {
    design: Design,
    forecast: Arc<Forecast>,
    /// The parts that the sweep asks for.
    parts: Vec<Part>,
}

/// A design that fulfils the constraints of a sweep, with its parts: all that can be refused is refused here, so that a
/// dry run refuses what a run refuses.
///
/// # Errors
/// The reason for which the variant is refused.
pub(super) fn accepted(
    variants: &Variants,
    variant: &Variant,
    forecasts: &Forecasts,
) -> Result<AcceptedVariant, String> {
    if let Some(original) = variant.repeats {
        return Err(format!("repeats {}", variants.get(original).id));
    }
    let design = Design::new(variant.configuration.clone()).map_err(|e| e.to_string())?;
    let forecast = forecasts.of(&design);
    let mut constraints = variants.sweep().constraints.iter();
    match constraints.find_map(|c| c.refusal(&design, forecast.curve(&design))) {
        Some(reason) => Err(reason),
        None => {
            let mut parts = printed(&design).map_err(|e| e.to_string())?;
            parts.retain(|part| variants.sweep().parts.contains(&part.name.as_str()));
            fit_on_bed(&parts, &design).map_err(|e| e.to_string())?;
            Ok(AcceptedVariant { design, forecast, parts })
        }
    }
}

impl<'a> VariantMaker<'a> {
    /// A maker for `destination`; `resumed` says whether it may already hold variants of the same sweep.
    pub(super) fn new(
        variants: &'a Variants,
        sweep_sha256: &'a str,
        destination: &'a Destination,
        resumed: bool,
        mesh_maker: MeshMaker,
        slicer: Option<&'a Slicer>,
    ) -> Self {
        Self {
            variants,
            sweep_sha256,
            destination,
            contents: PartStore::new(destination, mesh_maker),
            forecasts: Forecasts::default(),
            slicer: slicer.map(VariantSlicer::new),
            inspector: resumed.then(|| Inspector::new(destination)),
        }
    }

    /// The same maker, which verifies every mesh with `kernel`.
    pub(super) fn with_kernel(mut self, kernel: Option<Kernel>) -> Self {
        self.contents = self.contents.with_kernel(kernel);
        self
    }

    /// Makes `variant` unless it is refused or already there.
    ///
    /// # Errors
    /// [`DestinationError`] for what would stop every other variant too, such as a full disk.
    pub(super) fn make(&self, variant: &Variant) -> Result<VariantOutcome, DestinationError> {
        let accepted = match accepted(self.variants, variant, &self.forecasts) {
            Ok(accepted) => accepted,
            Err(reason) => return Ok(VariantOutcome::Refused(reason)),
        };
        if let Some(inspector) = &self.inspector
            && let Some(manifest) = self.whole(inspector, variant, &accepted)?
        {
            return Ok(VariantOutcome::Made { manifest, reused: true });
        }
        match self.build(variant, &accepted) {
            Ok(manifest) => Ok(VariantOutcome::Made { manifest, reused: false }),
            Err(ContentError::Destination(e)) if e.is_fatal => Err(e),
            Err(ContentError::Set(SetError::Build(BuildError::Configuration(e)))) => {
                Ok(VariantOutcome::Refused(e.to_string()))
            }
            Err(e) => Ok(VariantOutcome::Failed(e.to_string())),
        }
    }

    fn build(&self, variant: &Variant, accepted: &AcceptedVariant) -> Result<Vec<u8>, ContentError> {
        let AcceptedVariant { design, forecast, parts } = accepted;
        let kept: Vec<_> =
            parts.iter().map(|part| self.contents.keep(part, design)).collect::<Result<_, _>>()?;
        let linked: Vec<_> =
            parts.iter().zip(&kept).map(|(part, kept)| part_entry(&part.name, kept)).collect();
        let curve = forecast.shared(design)?;
        let plots = self.plots(design, &curve.prediction)?;
        let facts = parts.iter().zip(kept.iter().map(|k| &k.facts));
        let mut manifest = Manifest::new(design, facts, &curve.prediction);
        for (entry, kept) in manifest.parts.iter_mut().zip(&kept) {
            entry.verification.clone_from(&kept.verification);
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
                .zip(&kept)
                .map(|(part, kept)| (part.name.as_str(), kept.sha256.as_str()))
                .collect();
            let stored = |sha256: &str| self.contents.stored(sha256);
            manifest.print = Some(slicer.entry(design.configuration(), &parts, stored)?);
        }
        let bytes = seal(manifest.bytes()?);
        let folder = variant_folder(&variant.id);
        for file in curve.files.iter().map(|(file, _)| file).chain(&plots) {
            self.destination.put(&format!("{folder}/{}", file.name), &file.bytes)?;
        }
        for entry in linked {
            if let Some(content) = &entry.content {
                self.destination.link(content, &format!("{folder}/{}", entry.file))?;
            }
        }
        // A variant with a manifest is whole: it comes last.
        self.destination.put(&format!("{folder}/manifest.json"), &bytes)?;
        Ok(bytes)
    }

    /// The figures of one variant, which bear its name.
    fn plots(&self, design: &Design, prediction: &Prediction) -> Result<Vec<OutputFile>, SetError> {
        if !self.variants.sweep().plots {
            return Ok(Vec::new());
        }
        let mut files = curve_files(design, prediction, true)?;
        files.retain(|file| file.name.ends_with(".svg"));
        Ok(files)
    }

    /// The manifest of a variant that an earlier run made, if it lists what this run would make, and all its files are
    /// still what it says.
    fn whole(
        &self,
        inspector: &Inspector<'_>,
        variant: &Variant,
        accepted: &AcceptedVariant,
    ) -> Result<Option<Vec<u8>>, DestinationError> {
        let Some((bytes, listing)) = inspector.manifest(&variant.id)? else { return Ok(None) };
        if listing.batch.sweep_sha256 != self.sweep_sha256 || listing.batch.index != variant.index {
            return Ok(None);
        }
        // Made while no slicer was there.
        if self.slicer.is_some() && listing.print.is_none() {
            return Ok(None);
        }
        let expected: BTreeSet<String> = accepted
            .parts
            .iter()
            .map(|part| format!("{}.stl", part.name))
            .chain([CURVE.to_owned()])
            .chain(self.variants.sweep().plots.then(|| FIGURE.to_owned()))
            .collect();
        let listed: BTreeSet<String> = listing.files.iter().map(|file| file.file.clone()).collect();
        let problem = if listed == expected {
            inspector.damaged(&variant.id, &listing)?
        } else {
            Some("manifest.json")
        };
        if let Some(file) = problem {
            log::warn!("{}: {file} has changed and is made again", variant.id);
            return Ok(None);
        }
        Ok(Some(bytes))
    }
}

fn part_entry(name: &str, kept: &StoredPart) -> FileEntry {
    FileEntry {
        file: format!("{name}.stl"),
        bytes: kept.bytes,
        sha256: kept.sha256.clone(),
        content: Some(content_path(&kept.sha256)),
    }
}
