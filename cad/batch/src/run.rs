//! Runs a batch: variants in parallel, rows in order, with bounded memory, from where an earlier run was stopped.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::content::Workshop;
use super::destination::{Destination, DestinationError};
use super::make::{Maker, Outcome};
use super::products::{ProductError, Products, Tally};
use super::shard::Shard;
use super::source::SweepSource;
use super::stamp::{Stamp, StampError};
use super::table::{Row, Schema};
use super::variant::Variants;

/// Variants whose rows are in memory at the same time.
const AT_ONCE: u64 = 512;

/// How a batch is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Which variants are made.
    pub shard: Shard,
    /// Threads; 0 takes one per processor.
    pub threads: usize,
    /// Whether the first variant that fails ends the run.
    pub fail_fast: bool,
    /// What makes the parts.
    pub workshop: Workshop,
}

/// Who watches a run, and may stop it.
pub trait Watch: Sync {
    /// One more variant is done.
    fn done(&self, outcome: &Outcome);
    /// Whether to begin no further variant.
    fn stopped(&self) -> bool;
}

/// Why a run did not come to its end. What is written so far stays, and the same command takes it up.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The destination is not for this sweep.
    #[error(transparent)]
    Stamp(#[from] StampError),
    /// The destination cannot be written from the start.
    #[error("{0}; give an --out that can be written")]
    Unusable(DestinationError),
    /// The destination can no longer be written.
    #[error("{source}; {done} of {of} variants are there: make room and give the same command again")]
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
    /// Somebody stopped it.
    #[error("stopped: {done} of {of} variants are there; the same command again makes the rest")]
    Stopped {
        /// Variants that are done.
        done: u64,
        /// Variants of the run.
        of: u64,
    },
    /// A variant failed, and that was to end the run.
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
    options: Options,
    watch: &dyn Watch,
) -> Result<Tally, RunError> {
    // A folder with something else in it is left as it is, before anything is written there.
    let stamp = Stamp::new(source, variants.count());
    refuse_foreign(&stamp, destination)?;
    let _claim = destination.claim().map_err(RunError::Unusable)?;
    let resumed = stamp.put(destination)?;
    let range = options.shard.range(variants.count());
    let maker = Maker::new(variants, &stamp.sweep_sha256, destination, resumed, options.workshop);
    let mut products = Products::new(variants, destination)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let (mut done, of) = (0, range.end - range.start);
    let schema = products.schema().clone();
    for start in range.clone().step_by(usize::try_from(AT_ONCE).unwrap_or(1)) {
        let chunk = start..range.end.min(start + AT_ONCE);
        let results = pool.install(|| make_chunk(chunk.clone(), variants, &maker, &schema, options, watch));
        let finished = results.iter().filter(|r| matches!(r, Ended::Row(_))).count() as u64;
        for (index, result) in chunk.zip(results) {
            match result {
                Ended::Row(row) => products.push(index, row)?,
                Ended::Failed { id, reason } => return Err(RunError::Failed { id, reason }),
                Ended::Hopeless(source) => {
                    return Err(RunError::Destination { source, done: done + finished, of });
                }
                Ended::NotBegun => {}
            }
        }
        done += finished;
        if watch.stopped() && done < of {
            return Err(RunError::Stopped { done, of });
        }
    }
    if options.shard.is_whole() {
        return Ok(products.finish()?);
    }
    let folder = format!("shards/{}/", options.shard.folder());
    let tally = products.finish_table(&folder)?;
    let stamp = ShardStamp { sweep_sha256: stamp.sweep_sha256, shard: options.shard, variants: range };
    let bytes = serde_json::to_vec_pretty(&stamp).unwrap_or_default();
    destination.put(&format!("{folder}shard.json"), &bytes).map_err(ProductError::from)?;
    Ok(tally)
}

/// Refuses a destination that holds another sweep or other files.
fn refuse_foreign(stamp: &Stamp, destination: &Destination) -> Result<(), RunError> {
    if destination.is_empty()? {
        return Ok(());
    }
    let place = destination.name();
    match Stamp::read(destination) {
        Ok(there) if there.sweep_sha256 == stamp.sweep_sha256 => Ok(()),
        Ok(there) => Err(StampError::OtherSweep { place, name: there.source.name }.into()),
        Err(StampError::Missing { place }) => Err(StampError::NotEmpty { place }.into()),
        Err(e) => Err(e.into()),
    }
}

impl From<DestinationError> for RunError {
    fn from(error: DestinationError) -> Self {
        Self::Unusable(error)
    }
}

/// How a variant's turn ended.
enum Ended {
    Row(Row),
    Failed { id: String, reason: String },
    Hopeless(DestinationError),
    NotBegun,
}

fn make_chunk(
    chunk: Range<u64>,
    variants: &Variants,
    maker: &Maker<'_>,
    schema: &Schema,
    options: Options,
    watch: &dyn Watch,
) -> Vec<Ended> {
    let halt = AtomicBool::new(false);
    chunk
        .into_par_iter()
        .map(|index| {
            if watch.stopped() || halt.load(Ordering::Relaxed) {
                return Ended::NotBegun;
            }
            let variant = variants.get(index);
            // A fault of the program in one variant must not cost the others.
            let outcome = catch_unwind(AssertUnwindSafe(|| maker.make(&variant))).unwrap_or_else(|_| {
                Ok(Outcome::Failed("a fault of the program; please report the configuration".to_owned()))
            });
            match outcome {
                Err(error) => {
                    halt.store(true, Ordering::Relaxed);
                    Ended::Hopeless(error)
                }
                Ok(Outcome::Failed(reason)) if options.fail_fast => {
                    halt.store(true, Ordering::Relaxed);
                    Ended::Failed { id: variant.id, reason }
                }
                Ok(outcome) => {
                    watch.done(&outcome);
                    Ended::Row(schema.row(&variant, &outcome))
                }
            }
        })
        .collect()
}
