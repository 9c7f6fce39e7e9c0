//! Runs a batch: variants in parallel, rows in order, with bounded memory, from where an earlier run was stopped.

use std::collections::BTreeMap;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::content::MeshMaker;
use super::destination::{Destination, DestinationError};
use super::make::{VariantMaker, VariantOutcome};
use super::obstacles::refuse_obstacles;
use super::products::{ProductError, Products};
use super::seal::seal;
use super::shard::Shard;
use super::source::SweepSource;
use super::stamp::{Stamp, StampError};
use super::table::{Row, Schema};
use super::tally::Tally;
use super::variant::Variants;
use pinswitch_slicer::Slicer;
use pinswitch_solid::verification::Kernel;

/// Variants whose rows are in memory at the same time.
const CHUNK_VARIANTS: u64 = 512;

/// Threads for a store, where no number is given.
const STORE_THREADS: usize = 16;

/// How a batch is run.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Which variants are made.
    pub shard: Shard,
    /// Threads; 0 takes one per processor, or 16 for a store.
    pub threads: usize,
    /// Whether the first variant that fails ends the run.
    pub fail_fast: bool,
    /// What makes the parts.
    pub mesh_maker: MeshMaker,
    /// What says how long the parts print, where [`SweepSource::slice`] asks for it.
    pub slicer: Option<&'a Slicer>,
    /// The kernel that verifies every mesh, where [`SweepSource::verify`] requests it.
    pub kernel: Option<Kernel>,
}

/// Observes a run, and may stop it.
pub trait Observer: Sync {
    /// One more variant is done.
    fn variant_done(&self, outcome: &VariantOutcome);
    /// Whether no further variant should be started.
    fn stop_requested(&self) -> bool;
}

/// Why a run did not finish. What has been written stays, and the same command resumes it.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The destination is not for this sweep.
    #[error(transparent)]
    Stamp(#[from] StampError),
    /// The destination cannot be written from the start.
    #[error(transparent)]
    Unusable(DestinationError),
    /// The destination can no longer be written.
    #[error("{source}; {done} of {of} variants are there: then give the same command again")]
    Destination {
        /// Why.
        source: DestinationError,
        /// Variants that are done.
        done: u64,
        /// Variants of the run.
        of: u64,
    },
    /// Table, plots or page cannot be made.
    #[error("{0}; the variants are there: the same command again makes the rest")]
    Products(#[from] ProductError),
    /// The user stopped it.
    #[error("stopped: {done} of {of} variants are there; the same command again makes the rest")]
    Stopped {
        /// Variants that are done.
        done: u64,
        /// Variants of the run.
        of: u64,
    },
    /// A variant failed, and the run was to stop at the first failure.
    #[error("{id}: {reason}; --fail-fast ends the run here")]
    Failed {
        /// The variant.
        id: String,
        /// Why.
        reason: String,
    },
    /// The threads cannot be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// What `shard.json` says of a finished shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardStamp {
    /// The sweep.
    pub sweep_sha256: String,
    /// The shard.
    pub shard: Shard,
    /// Its variants.
    pub variants: Range<u64>,
    /// SHA-256 of its tables, by their names; they hold the hashes of all manifests, and these of all other files.
    pub tables: BTreeMap<String, String>,
}

/// Name of the folder for unfinished files of a shard.
pub fn partial_folder(shard: Shard) -> String {
    format!("{}{}", super::destination::PARTIAL, shard.folder())
}

/// Makes every variant of the shard, and its products.
///
/// # Errors
/// [`RunError`]; whatever it is, nothing that was written is lost.
pub fn run(
    variants: &Variants,
    source: &SweepSource,
    destination: &Destination,
    options: Options<'_>,
    observer: &dyn Observer,
) -> Result<Tally, RunError> {
    // A folder with something else in it is left as it is, before anything is written there.
    let stamp = Stamp::new(source, variants.count());
    stamp.refuse_foreign(destination)?;
    refuse_obstacles(destination, options.shard)?;
    let _lock = destination.lock().map_err(RunError::Unusable)?;
    let resumed = stamp.put(destination)?;
    let range = options.shard.range(variants.count());
    let maker = VariantMaker::new(
        variants,
        &stamp.sweep_sha256,
        destination,
        resumed,
        options.mesh_maker,
        options.slicer,
    )
    .with_kernel(options.kernel);
    let mut products = Products::new(variants, destination)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads(options, destination)).build()?;
    let (mut done, of) = (0, range.end - range.start);
    let schema = products.schema().clone();
    for start in range.clone().step_by(usize::try_from(CHUNK_VARIANTS).unwrap_or(1)) {
        let chunk = start..range.end.min(start + CHUNK_VARIANTS);
        let results =
            pool.install(|| make_chunk(chunk.clone(), variants, &maker, &schema, options, observer));
        let finished = results.iter().filter(|r| matches!(r, VariantResult::Row(_))).count() as u64;
        for (index, result) in chunk.zip(results) {
            match result {
                VariantResult::Row(row) => products.push(index, row)?,
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
    destination.put(&format!("{folder}shard.json"), &seal(bytes)).map_err(ProductError::from)?;
    Ok(tally)
}

/// Threads of a run. A thread waits for a store most of the time: so many uploads go on at once.
fn threads(options: Options<'_>, destination: &Destination) -> usize {
    if options.threads > 0 || destination.links() { options.threads } else { STORE_THREADS }
}

/// Whether a run would be let into `destination`: refuses what [`run`] refuses there before it makes anything, and leaves
/// nothing behind. Whether a store can be written is not tried.
///
/// # Errors
/// [`RunError`] for a place with another sweep or other files, with something in the way, a busy one, and one that cannot
/// be written.
pub fn admit(
    variants: &Variants,
    source: &SweepSource,
    destination: &Destination,
    shard: Shard,
) -> Result<(), RunError> {
    Stamp::new(source, variants.count()).refuse_foreign(destination)?;
    refuse_obstacles(destination, shard)?;
    destination.lock().map(drop).map_err(RunError::Unusable)
}

impl From<DestinationError> for RunError {
    fn from(error: DestinationError) -> Self {
        Self::Unusable(error)
    }
}

/// What became of one variant of a chunk.
enum VariantResult {
    Row(Row),
    Failed { id: String, reason: String },
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
    chunk
        .into_par_iter()
        .map(|index| {
            if observer.stop_requested() || halt.load(Ordering::Relaxed) {
                return VariantResult::NotStarted;
            }
            let variant = variants.get(index);
            // A panic in one variant must not lose the others.
            let outcome = catch_unwind(AssertUnwindSafe(|| maker.make(&variant))).unwrap_or_else(|_| {
                Ok(VariantOutcome::Failed(
                    "a fault of the program; please report the configuration".to_owned(),
                ))
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
                    VariantResult::Row(schema.row(&variant, &outcome))
                }
            }
        })
        .collect()
}
