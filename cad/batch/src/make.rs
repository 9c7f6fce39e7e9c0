//! One variant: refused, kept from an earlier run, or made.

use std::sync::Arc;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::content::{ContentError, MeshMaker, PartStore, StoredPart, content_path};
use super::destination::{Destination, DestinationError};
use super::forecast::{Forecast, Forecasts};
use super::hexadecimal;
use super::sweep::Sweep;
use super::variant::{Variant, Variants};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::{BatchEntry, FileEntry, Manifest};
use pinswitch_switch::formats::curve_files;
use pinswitch_switch::output::BuildError;
use pinswitch_switch::output::{OutputFile, SetError};
use pinswitch_switch::parts::printed;
use pinswitch_switch::prediction::Prediction;

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
    /// Whether an earlier run may have left variants.
    resumed: bool,
}

/// The folder of a variant.
pub(super) fn variant_folder(id: &str) -> String {
    format!("variants/{id}")
}

/// A variant that can be made.
pub(super) struct AcceptedVariant {
    design: Design,
    forecast: Arc<Forecast>,
}

/// A design that fulfils the constraints of a sweep.
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
        None => Ok(AcceptedVariant { design, forecast }),
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
    ) -> Self {
        Self {
            variants,
            sweep_sha256,
            destination,
            contents: PartStore::new(destination, mesh_maker),
            forecasts: Forecasts::default(),
            resumed,
        }
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
        if let Some(manifest) = self.resumed.then(|| self.whole(variant)).transpose()?.flatten() {
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
        let AcceptedVariant { design, forecast } = accepted;
        let sweep: &Sweep = self.variants.sweep();
        let mut parts = printed(design).map_err(|e| SetError::from(BuildError::from(e)))?;
        parts.retain(|part| sweep.parts.contains(&part.name.as_str()));
        let kept: Vec<_> =
            parts.iter().map(|part| self.contents.keep(part, design)).collect::<Result<_, _>>()?;
        let linked: Vec<_> =
            parts.iter().zip(&kept).map(|(part, kept)| part_entry(&part.name, kept)).collect();
        let curve = forecast.shared(design)?;
        let plots = self.plots(design, &curve.prediction)?;
        let facts = parts.iter().zip(kept.iter().map(|k| &k.facts));
        let mut manifest = Manifest::new(design, facts, &curve.prediction);
        let tables = curve.files.iter().map(|(_, entry)| entry.clone());
        manifest.files.extend(linked.iter().cloned().chain(tables).chain(plots.iter().map(FileEntry::of)));
        manifest.batch = Some(BatchEntry {
            sweep_sha256: self.sweep_sha256.to_owned(),
            index: variant.index,
            label: variant.label.clone(),
        });
        let bytes = manifest.bytes()?;
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

    /// The manifest of a variant that an earlier run made, if all its files are still what it says.
    fn whole(&self, variant: &Variant) -> Result<Option<Vec<u8>>, DestinationError> {
        let folder = variant_folder(&variant.id);
        let Some(bytes) = self.destination.get(&format!("{folder}/manifest.json"))? else { return Ok(None) };
        let Ok(manifest) = serde_json::from_slice::<Value>(&bytes) else { return Ok(None) };
        let own = manifest["batch"]["sweep_sha256"] == self.sweep_sha256
            && manifest["batch"]["index"] == variant.index;
        let files = manifest["files"].as_array().filter(|_| own);
        let Some(files) = files else { return Ok(None) };
        for file in files {
            if !self.is_whole(&folder, file)? {
                log::warn!("{}: {} has changed and is made again", variant.id, file["file"]);
                return Ok(None);
            }
        }
        Ok(Some(bytes))
    }

    fn is_whole(&self, folder: &str, file: &Value) -> Result<bool, DestinationError> {
        let name = file["file"].as_str().unwrap_or_default();
        if let Some(content) = file["content"].as_str() {
            if self.destination.size(content)? != file["bytes"].as_u64() {
                return Ok(false);
            }
            if !self.destination.links() {
                return Ok(true);
            }
        }
        let found = self.destination.get(&format!("{folder}/{name}"))?;
        Ok(found.is_some_and(|bytes| file["sha256"] == hexadecimal(&Sha256::digest(&bytes))))
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
