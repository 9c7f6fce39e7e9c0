//! What a batch would be: how many variants, which are refused and why, how long it takes, how large it becomes.

use std::collections::BTreeMap;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::content::MeshMaker;
use super::destination::{Destination, DestinationError, remedy};
use super::forecast::Forecasts;
use super::make::{VariantMaker, VariantOutcome, accepted};
use super::shard::Shard;
use super::variant::Variants;

/// At most this many variants are checked; of a larger sweep, an even sample.
const MAX_CHECKED: u64 = 100_000;
/// Variants made first, so that shared parts exist.
const WARM_UP_VARIANTS: usize = 8;
/// Variants made after those, and measured.
const MEASURED_VARIANTS: usize = 24;

/// Variants that are refused for the same kind of reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RefusalGroup {
    /// The field, constraint or kind.
    pub kind: String,
    /// How many of those checked.
    pub count: u64,
    /// One of them.
    pub example: String,
    /// Its reason in full.
    pub reason: String,
}

/// What was measured on a few variants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Variants that were made to measure it.
    pub variants: usize,
    /// Seconds for each further variant, with all threads at work.
    pub seconds_per_variant: f64,
    /// Bytes that each further variant adds at the destination.
    pub bytes_per_variant: f64,
    /// Bytes of its files, were nothing shared.
    pub bytes_unshared: f64,
}

/// The estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Estimate {
    /// Variants of the shard.
    pub variants: u64,
    /// How many of them were checked.
    pub checked: u64,
    /// How many of the checked ones would be refused, by kind, most first.
    pub refused: Vec<RefusalGroup>,
    /// Absent if no variant can be made.
    pub measured: Option<Measured>,
    /// Threads.
    pub threads: usize,
    /// Variants that would be made, scaled up from those checked.
    pub made: u64,
    /// How long it would take here, s.
    pub seconds: f64,
    /// How large it would become, bytes.
    pub bytes: f64,
}

/// Checks every variant of `shard`, makes a few in a temporary folder, and throws them away.
///
/// # Errors
/// [`DestinationError`] if the temporary folder cannot be used.
pub fn estimate(
    variants: &Variants,
    shard: Shard,
    threads: usize,
    mesh_maker: MeshMaker,
) -> Result<Estimate, DestinationError> {
    let range = shard.range(variants.count());
    let count = range.end - range.start;
    let every = count.div_ceil(MAX_CHECKED).max(1);
    let forecasts = Forecasts::default();
    let checked: Vec<(u64, Option<String>)> = (0..count.div_ceil(every))
        .into_par_iter()
        .map(|i| {
            let index = range.start + i * every;
            (index, accepted(variants, &variants.get(index), &forecasts).err())
        })
        .collect();
    let good: Vec<u64> = checked.iter().filter(|(_, reason)| reason.is_none()).map(|(i, _)| *i).collect();
    let measured = measure(variants, &good, mesh_maker)?;
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let made = (count as f64 * good.len() as f64 / checked.len().max(1) as f64).round() as u64;
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

fn refusals(variants: &Variants, checked: &[(u64, Option<String>)]) -> Vec<RefusalGroup> {
    let mut kinds: BTreeMap<String, RefusalGroup> = BTreeMap::new();
    for (index, reason) in checked.iter().filter_map(|(i, r)| Some((*i, r.as_ref()?))) {
        let kind = reason_kind(reason);
        let entry = kinds.entry(kind.clone()).or_insert_with(|| RefusalGroup {
            kind,
            count: 0,
            example: variants.get(index).id,
            reason: reason.clone(),
        });
        entry.count += 1;
    }
    let mut all: Vec<_> = kinds.into_values().collect();
    all.sort_by_key(|r| std::cmp::Reverse(r.count));
    all
}

/// A reason without its numbers.
fn reason_kind(reason: &str) -> String {
    if reason.starts_with("repeats ") {
        return "repeats another variant".to_owned();
    }
    if let Some((constraint, _)) = reason.split_once(" is not met") {
        return constraint.to_owned();
    }
    reason.split(' ').next().unwrap_or_default().to_owned()
}

/// Makes an even sample of variants and measures what each of the later ones costs.
#[allow(clippy::cast_precision_loss)]
fn measure(
    variants: &Variants,
    good: &[u64],
    mesh_maker: MeshMaker,
) -> Result<Option<Measured>, DestinationError> {
    if good.is_empty() {
        return Ok(None);
    }
    let failed = |e: std::io::Error| DestinationError {
        place: "the temporary folder".to_owned(),
        problem: e.to_string(),
        remedy: remedy(&e),
        is_fatal: true,
    };
    let folder = tempfile::tempdir().map_err(failed)?;
    let destination = Destination::open(&folder.path().display().to_string(), ".partial-dry-run")?;
    let _lock = destination.lock()?;
    let maker = VariantMaker::new(variants, "", &destination, false, mesh_maker, None);
    let chosen: Vec<u64> = (0..good.len().min(WARM_UP_VARIANTS + MEASURED_VARIANTS))
        .map(|i| good[i * good.len() / good.len().min(WARM_UP_VARIANTS + MEASURED_VARIANTS)])
        .collect();
    // With few variants there is nothing to warm up with: the shared parts count in full.
    let (first, rest) = chosen.split_at(if chosen.len() > WARM_UP_VARIANTS { WARM_UP_VARIANTS } else { 0 });
    let make = |indices: &[u64]| -> Result<f64, DestinationError> {
        let sizes: Result<Vec<f64>, _> = indices
            .par_iter()
            .map(|index| match maker.make(&variants.get(*index))? {
                VariantOutcome::Made { manifest, .. } => {
                    let facts: serde_json::Value = serde_json::from_slice(&manifest).unwrap_or_default();
                    let files = facts["files"].as_array().map(Vec::as_slice).unwrap_or_default();
                    let bytes: u64 = files.iter().filter_map(|f| f["bytes"].as_u64()).sum();
                    Ok(bytes as f64 + manifest.len() as f64)
                }
                _ => Ok(0.0),
            })
            .collect();
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

/// Bytes of all files under `folder`; links to one file count once.
#[allow(clippy::cast_precision_loss)]
fn folder_size(folder: &std::path::Path) -> f64 {
    let Ok(entries) = std::fs::read_dir(folder) else { return 0.0 };
    entries
        .filter_map(Result::ok)
        .map(|entry| match entry.file_type() {
            Ok(kind) if kind.is_dir() => folder_size(&entry.path()),
            // Every part of a variant is a link to one under parts/.
            Ok(_) if entry.path().extension().is_some_and(|e| e == "stl") && !in_parts(&entry.path()) => 0.0,
            _ => entry.metadata().map_or(0.0, |m| m.len() as f64),
        })
        .sum()
}

fn in_parts(path: &std::path::Path) -> bool {
    path.parent().and_then(std::path::Path::parent).is_some_and(|p| p.ends_with("parts"))
}
