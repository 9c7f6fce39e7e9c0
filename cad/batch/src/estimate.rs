//! The estimate of a dry run: number of variants, refusals with their reasons, time and size.

use std::collections::BTreeMap;
use std::time::Instant;

use schemars::JsonSchema;
use serde::Serialize;

use super::content::MeshMaker;
use super::destination::{Destination, DestinationError};
use super::make::{Refusal, VariantMaker, VariantOutcome, accept};
use super::parallel;
use super::prediction_cache::PredictionCache;
use super::shard::Shard;
use super::variant::Variants;

/// Most variants that are checked; of a larger sweep, an evenly spaced sample.
const MAX_CHECKED: u64 = 100_000;
/// Variants that are made before the measurement, so that shared parts exist.
const WARM_UP_VARIANTS: usize = 8;
/// Variants that are measured.
const MEASURED_VARIANTS: usize = 24;

/// Refusals of the same kind.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct RefusalGroup {
    /// [`Refusal::kind`]: the field or the constraint.
    pub kind: String,
    /// Number of checked variants.
    pub count: u64,
    /// Id of one of them.
    pub example: String,
    /// Its reason.
    pub reason: String,
}

/// Measurements of a few variants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Measured {
    /// Number of measured variants.
    pub variants: usize,
    /// Time per further variant with all threads, s.
    pub seconds_per_variant: f64,
    /// Size that each further variant adds to the destination, bytes.
    pub bytes_per_variant: f64,
    /// Size of its files including shared parts, bytes.
    pub bytes_unshared: f64,
}

/// The estimate of a dry run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Estimate {
    /// Number of variants of the shard.
    pub variants: u64,
    /// Number of checked variants.
    pub checked: u64,
    /// Refusals among the checked variants by kind, the most frequent first.
    pub refused: Vec<RefusalGroup>,
    /// Measurements; absent if no variant can be made.
    pub measured: Option<Measured>,
    /// Number of threads.
    pub threads: usize,
    /// Number of variants that would be made, extrapolated from the checked ones.
    pub made: u64,
    /// Time on this machine, s.
    pub seconds: f64,
    /// Size of the batch, bytes.
    pub bytes: f64,
}

/// Checks the variants of `shard`, and makes a few of them in a temporary folder to measure them.
///
/// # Errors
/// A temporary folder that cannot be used.
pub fn estimate(
    variants: &Variants,
    shard: Shard,
    threads: usize,
    mesh_maker: MeshMaker,
) -> Result<Estimate, DestinationError> {
    let range = shard.range(variants.count());
    let count = range.end - range.start;
    let every = count.div_ceil(MAX_CHECKED).max(1);
    let predictions = PredictionCache::default();
    let checked: Vec<(u64, Option<Refusal>)> = parallel::map_range(0..count.div_ceil(every), |i| {
        let index = range.start + i * every;
        (index, accept(variants, &variants.get(index), &predictions).err())
    });
    let accepted: Vec<u64> =
        checked.iter().filter(|(_, refusal)| refusal.is_none()).map(|(i, _)| *i).collect();
    let measured = measure(variants, &accepted, mesh_maker)?;
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let made = (count as f64 * accepted.len() as f64 / checked.len().max(1) as f64).round() as u64;
    #[allow(clippy::cast_precision_loss)]
    let total = |each: fn(&Measured) -> f64| measured.as_ref().map_or(0.0, each) * made as f64;
    Ok(Estimate {
        variants: count,
        checked: checked.len() as u64,
        refused: refusals(variants, &checked),
        threads,
        made,
        seconds: total(|m| m.seconds_per_variant),
        bytes: total(|m| m.bytes_per_variant),
        measured,
    })
}

/// Groups the refusals by kind.
fn refusals(variants: &Variants, checked: &[(u64, Option<Refusal>)]) -> Vec<RefusalGroup> {
    let mut groups: BTreeMap<String, RefusalGroup> = BTreeMap::new();
    for (index, refusal) in checked.iter().filter_map(|(i, r)| Some((*i, r.as_ref()?))) {
        let kind = refusal.kind();
        let group = groups.entry(kind.clone()).or_insert_with(|| RefusalGroup {
            kind,
            count: 0,
            example: variants.get(index).id,
            reason: refusal.to_string(),
        });
        group.count += 1;
    }
    let mut all: Vec<_> = groups.into_values().collect();
    all.sort_by_key(|group| std::cmp::Reverse(group.count));
    all
}

/// Makes an evenly spaced sample of the accepted variants, and measures the later ones.
#[allow(clippy::cast_precision_loss)]
fn measure(
    variants: &Variants,
    accepted: &[u64],
    mesh_maker: MeshMaker,
) -> Result<Option<Measured>, DestinationError> {
    if accepted.is_empty() {
        return Ok(None);
    }
    let folder = tempfile::tempdir().map_err(DestinationError::temporary)?;
    let destination = Destination::open(&folder.path().display().to_string(), ".partial-dry-run")?;
    let _lock = destination.lock()?;
    let maker = VariantMaker::new(variants, "", &destination, false, mesh_maker, None);
    let chosen: Vec<u64> = (0..accepted.len().min(WARM_UP_VARIANTS + MEASURED_VARIANTS))
        .map(|i| accepted[i * accepted.len() / accepted.len().min(WARM_UP_VARIANTS + MEASURED_VARIANTS)])
        .collect();
    // Few variants are measured without a warm-up, and shared parts count in full.
    let (first, rest) = chosen.split_at(if chosen.len() > WARM_UP_VARIANTS { WARM_UP_VARIANTS } else { 0 });
    let make = |indices: &[u64]| -> Result<f64, DestinationError> {
        let sizes = parallel::try_map(indices, |index| match maker.make(&variants.get(*index))? {
            VariantOutcome::Made { manifest, .. } => {
                let facts: serde_json::Value = serde_json::from_slice(&manifest).unwrap_or_default();
                let files = facts["files"].as_array().map(Vec::as_slice).unwrap_or_default();
                let bytes: u64 = files.iter().filter_map(|f| f["bytes"].as_u64()).sum();
                Ok(bytes as f64 + manifest.len() as f64)
            }
            _ => Ok(0.0),
        });
        Ok(sizes?.iter().sum())
    };
    make(first)?;
    let before = folder_size(folder.path());
    let start = Instant::now();
    let unshared = make(rest)?;
    let seconds = start.elapsed().as_secs_f64();
    let n = rest.len() as f64;
    Ok(Some(Measured {
        variants: rest.len(),
        seconds_per_variant: seconds / n,
        bytes_per_variant: (folder_size(folder.path()) - before) / n,
        bytes_unshared: unshared / n,
    }))
}

/// Returns the bytes of all files in `folder` and below; links to one file count once.
#[allow(clippy::cast_precision_loss)]
fn folder_size(folder: &std::path::Path) -> f64 {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0.0 };
    entries
        .filter_map(Result::ok)
        .map(|entry| match entry.file_type() {
            Ok(kind) if kind.is_dir() => folder_size(&entry.path()),
            // Every part of a variant is a link to a file in parts/.
            Ok(_) if entry.path().extension().is_some_and(|e| e == "stl") && !is_in_parts(&entry.path()) => {
                0.0
            }
            _ => entry.metadata().map_or(0.0, |m| m.len() as f64),
        })
        .sum()
}

fn is_in_parts(path: &std::path::Path) -> bool {
    path.parent().and_then(std::path::Path::parent).is_some_and(|p| p.ends_with("parts"))
}
