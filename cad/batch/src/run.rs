//! Runs a batch: variants in parallel, rows in order, in bounded memory; an interrupted run is
//! resumed.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use pinswitch_diagnostic::{Diagnostic, codes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::checksum::with_checksum;
use super::content::MeshMaker;
use super::destination::{Destination, DestinationError};
use super::diagnostics::diagnostic_error;
use super::gallery::Sketch;
use super::make::{VariantMaker, VariantOutcome};
use super::obstructions::check_paths;
use super::parallel::{self, Pool};
use super::products::{ProductError, Products};
use super::shard::Shard;
use super::source::SweepSource;
use super::stamp::{Stamp, StampError};
use super::table::{Row, Schema};
use super::tally::Tally;
use super::variant::Variants;
use pinswitch_slicer::Slicer;
use pinswitch_solid::verification::Kernel;

/// Most variants whose rows are in memory at the same time.
const CHUNK_VARIANTS: u64 = 512;

/// Default number of threads for a store.
const STORE_THREADS: usize = 16;

/// Options of a run.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// The variants to make.
    pub shard: Shard,
    /// Number of threads; 0 means one per processor, or 16 for a store.
    pub threads: usize,
    /// Whether the first variant that fails ends the run.
    pub fail_fast: bool,
    /// Makes the mesh files of parts.
    pub mesh_maker: MeshMaker,
    /// Estimates the print time of the parts if [`SweepSource::slice`] is set.
    pub slicer: Option<&'a Slicer>,
    /// The kernel that verifies every mesh, where [`SweepSource::verify`] requests it.
    pub kernel: Option<Kernel>,
}

/// Observes a run, and can stop it.
pub trait Observer: Sync {
    /// Called once for each finished variant.
    fn variant_done(&self, outcome: &VariantOutcome);
    /// Returns whether no further variant should be started.
    fn stop_requested(&self) -> bool;
}

/// Why a run did not finish. Finished variants remain, and the same command resumes the run.
#[derive(Debug)]
pub enum RunError {
    /// The destination is not for this sweep.
    Stamp(StampError),
    /// The destination cannot be written from the start.
    Unusable(DestinationError),
    /// The destination can no longer be written.
    Destination {
        /// Why.
        source: DestinationError,
        /// Number of finished variants.
        done: u64,
        /// Number of variants of the run.
        of: u64,
    },
    /// Table, plots or page cannot be made.
    Products(ProductError),
    /// The observer stopped it.
    Stopped {
        /// Number of finished variants.
        done: u64,
        /// Number of variants of the run.
        of: u64,
    },
    /// A variant failed, with [`Options::fail_fast`].
    Failed {
        /// The variant.
        id: String,
        /// Why.
        reason: Diagnostic,
    },
    /// The threads cannot be started.
    Threads(Box<dyn Error + Send + Sync>),
}

impl RunError {
    fn diagnostic(&self) -> Diagnostic {
        const RESUME: &str = "run the same command again to resume";
        match self {
            Self::Stamp(error) => error.diagnostic(),
            Self::Unusable(error) => error.clone().into(),
            Self::Destination { source, done, of } => {
                let help = format!("{}, then {RESUME} ({done} of {of} variants are finished)", source.help());
                Diagnostic::from(source.clone()).with_help(help)
            }
            Self::Products(error) => {
                let error = error.diagnostic();
                let remedy = error.help().map(|help| format!("{help}, then ")).unwrap_or_default();
                let help = format!("{remedy}{RESUME} (the variants are finished)");
                error.with_help(help)
            }
            Self::Stopped { done, of } => Diagnostic::new(
                codes::BATCH_STOPPED,
                format!("stopped: {done} of {of} variants are finished"),
            )
            .with_help(RESUME),
            Self::Failed { id, reason } => {
                Diagnostic::new(codes::VARIANTS_FAILED, format!("variant {id} failed: {reason}"))
                    .with_help("omit --fail-fast to make the other variants")
            }
            Self::Threads(error) => {
                Diagnostic::new(codes::CANNOT_START, format!("cannot start threads: {error}"))
                    .with_help("give fewer --threads")
            }
        }
    }

    /// Returns whether the cause is the user's input: a destination of another batch, or a path that
    /// cannot be a folder.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Stamp(error) => error.is_bad_input(),
            Self::Unusable(error) => !error.is_refusal(),
            _ => false,
        }
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Stamp(error) => error.source(),
            Self::Unusable(error) | Self::Destination { source: error, .. } => error.source(),
            Self::Products(error) => error.source(),
            Self::Stopped { .. } => None,
            Self::Failed { reason, .. } => reason.source(),
            Self::Threads(error) => Some(&**error),
        }
    }
}

diagnostic_error!(RunError);

impl From<StampError> for RunError {
    fn from(error: StampError) -> Self {
        Self::Stamp(error)
    }
}

impl From<DestinationError> for RunError {
    fn from(error: DestinationError) -> Self {
        Self::Unusable(error)
    }
}

impl From<ProductError> for RunError {
    fn from(error: ProductError) -> Self {
        Self::Products(error)
    }
}

/// The content of `shard.json`, the record of a finished shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ShardStamp {
    /// [`SweepSource::digest`].
    pub sweep_sha256: String,
    /// The shard.
    pub shard: Shard,
    /// The indices of its variants.
    pub variants: Range<u64>,
    /// SHA-256 of its tables by their names. The tables contain the hashes of all manifests, and
    /// these contain the hashes of all other files.
    pub tables: BTreeMap<String, String>,
}

/// Returns the name of the folder for unfinished files of a shard.
pub fn partial_folder(shard: Shard) -> String {
    format!("{}{}", super::destination::PARTIAL, shard.folder())
}

/// Makes every variant of the shard and its products.
///
/// # Errors
/// [`RunError`]; files that were written remain.
pub fn run(
    variants: &Variants,
    source: &SweepSource,
    destination: &Destination,
    options: Options<'_>,
    observer: &dyn Observer,
) -> Result<Tally, RunError> {
    // All checks come before the first write: a folder with other files stays unchanged.
    let stamp = Stamp::new(source, variants.count());
    stamp.check(destination)?;
    check_paths(destination, options.shard)?;
    let _lock = destination.lock()?;
    let is_resumed = stamp.write(destination)?;
    let range = options.shard.range(variants.count());
    let maker = VariantMaker::new(
        variants,
        &stamp.sweep_sha256,
        destination,
        is_resumed,
        options.mesh_maker,
        options.slicer,
    )
    .with_kernel(options.kernel);
    let mut products = Products::new(variants, destination)?;
    let pool = Pool::new(threads(options, destination)).map_err(RunError::Threads)?;
    let (mut done, of) = (0, range.end - range.start);
    let schema = products.schema().clone();
    for start in range.clone().step_by(usize::try_from(CHUNK_VARIANTS).unwrap_or(1)) {
        let chunk = start..range.end.min(start + CHUNK_VARIANTS);
        let results =
            pool.install(|| make_chunk(chunk.clone(), variants, &maker, &schema, options, observer));
        let finished = results.iter().filter(|r| matches!(r, VariantResult::Row(..))).count() as u64;
        for (index, result) in chunk.zip(results) {
            match result {
                VariantResult::Row(row, sketch) => products.push(index, row, sketch)?,
                VariantResult::Failed { id, reason } => return Err(RunError::Failed { id, reason }),
                VariantResult::Fatal(source) => {
                    return Err(RunError::Destination { source, done: done + finished, of });
                }
                VariantResult::NotStarted => {}
            }
        }
        done += finished;
        if observer.stop_requested() && done < of {
            return Err(RunError::Stopped { done, of });
        }
    }
    if options.shard.is_whole() {
        return Ok(products.finish()?);
    }
    let folder = format!("shards/{}/", options.shard.folder());
    let (tally, tables) = products.finish_table(&folder)?;
    let stamp =
        ShardStamp { sweep_sha256: stamp.sweep_sha256, shard: options.shard, variants: range, tables };
    let bytes = serde_json::to_vec_pretty(&stamp).map_err(ProductError::from)?;
    let file = format!("{folder}shard.json");
    destination.put(&file, &with_checksum(bytes)).map_err(ProductError::from)?;
    Ok(tally)
}

/// Returns the number of threads. A thread waits for a store most of the time, so that many uploads
/// run at once.
fn threads(options: Options<'_>, destination: &Destination) -> usize {
    if options.threads > 0 || destination.has_links() { options.threads } else { STORE_THREADS }
}

/// Checks that [`run`] would accept the destination, and leaves it unchanged. It does not check
/// whether a store can be written.
///
/// # Errors
/// A destination with another sweep, other files or an obstruction, one that is locked, and one
/// that cannot be written.
pub fn check_destination(
    variants: &Variants,
    source: &SweepSource,
    destination: &Destination,
    shard: Shard,
) -> Result<(), RunError> {
    Stamp::new(source, variants.count()).check(destination)?;
    check_paths(destination, shard)?;
    destination.lock()?;
    Ok(())
}

/// The result of one variant of a chunk.
enum VariantResult {
    Row(Row, Option<Sketch>),
    Failed { id: String, reason: Diagnostic },
    Fatal(DestinationError),
    NotStarted,
}

fn make_chunk(
    chunk: Range<u64>,
    variants: &Variants,
    maker: &VariantMaker<'_>,
    schema: &Schema,
    options: Options<'_>,
    observer: &dyn Observer,
) -> Vec<VariantResult> {
    let halt = AtomicBool::new(false);
    parallel::map_range(chunk, |index| {
        if observer.stop_requested() || halt.load(Ordering::Relaxed) {
            return VariantResult::NotStarted;
        }
        let variant = variants.get(index);
        // A panic in one variant must not fail the others.
        let outcome = catch_unwind(AssertUnwindSafe(|| maker.make(&variant))).unwrap_or_else(|_| {
            let bug = Diagnostic::new(codes::INTERNAL_ERROR, "internal error (panic)");
            Ok(VariantOutcome::Failed(bug.with_help("please report the configuration")))
        });
        match outcome {
            Err(error) => {
                halt.store(true, Ordering::Relaxed);
                VariantResult::Fatal(error)
            }
            Ok(VariantOutcome::Failed(reason)) if options.fail_fast => {
                halt.store(true, Ordering::Relaxed);
                VariantResult::Failed { id: variant.id, reason }
            }
            Ok(outcome) => {
                observer.variant_done(&outcome);
                let sketch = match &outcome {
                    // Only a whole batch has a gallery.
                    VariantOutcome::Made { curve, .. } if options.shard.is_whole() => {
                        Sketch::new(variants, index, curve)
                    }
                    _ => None,
                };
                VariantResult::Row(schema.row(&variant, &outcome), sketch)
            }
        }
    })
}
