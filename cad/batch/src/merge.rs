//! Joins the tables of shards into the products of the whole sweep.

use super::destination::{Destination, DestinationError};
use super::products::{ProductError, Products};
use super::run::ShardStamp;
use super::stamp::{Stamp, StampError};
use super::sweep::Sweep;
use super::table_files::{BatchTableError, read_rows};
use super::tally::Tally;
use super::variant::Variants;
use pinswitch_switch::config::ConfigError;

/// Why shards cannot be merged. Nothing is written.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A place holds no batch, or the target holds another one.
    #[error(transparent)]
    Stamp(#[from] StampError),
    /// Two places hold different sweeps.
    #[error("{0} and {1} hold different sweeps; merge the shards of one")]
    DifferentSweeps(String, String),
    /// Some variants are in no shard.
    #[error("variants {from} to {to} of {of} are in no finished shard{hint}")]
    Gap {
        /// First one missing, from 1.
        from: u64,
        /// Last one missing.
        to: u64,
        /// All of them.
        of: u64,
        /// The shards to run, if they can be told.
        hint: String,
    },
    /// Some variants are in two shards.
    #[error("variants {from} to {to} are both in shard {first} and in shard {second}; leave one of them out")]
    Overlap {
        /// First one that is there twice, from 1.
        from: u64,
        /// Last one.
        to: u64,
        /// A shard, with its place.
        first: String,
        /// The other.
        second: String,
    },
    /// A shard's table does not hold what its stamp says.
    #[error("shard {shard}: {problem}; run it again")]
    Broken {
        /// The shard, with its place.
        shard: String,
        /// What is wrong.
        problem: String,
    },
    /// The sweep in the stamp cannot be read.
    #[error(transparent)]
    Sweep(#[from] ConfigError),
    /// The products cannot be made.
    #[error(transparent)]
    Products(#[from] ProductError),
    /// A place cannot be read.
    #[error(transparent)]
    Destination(#[from] DestinationError),
}

/// A finished shard and its place.
struct FinishedShard<'a> {
    stamp: ShardStamp,
    place: &'a Destination,
}

impl FinishedShard<'_> {
    fn name(&self) -> String {
        format!("{} of {}", self.stamp.shard, self.place.name())
    }
}

/// Merges all finished shards of `places` into `target`, which may be one of them.
///
/// # Errors
/// [`MergeError`] for gaps, overlaps, other sweeps and broken shards; nothing is written then.
pub fn merge(places: &[Destination], target: &Destination) -> Result<Tally, MergeError> {
    let stamp = one_sweep(places)?;
    let sweep = Sweep::new(&stamp.source)?;
    let variants = Variants::new(sweep, &stamp.source);
    let mut found = Vec::new();
    for place in places {
        for folder in place.folders("shards")? {
            if let Some(bytes) = place.get(&format!("shards/{folder}/shard.json"))? {
                let stamp = serde_json::from_slice(&bytes).map_err(|e| MergeError::Broken {
                    shard: format!("{folder} of {}", place.name()),
                    problem: e.to_string(),
                })?;
                found.push(FinishedShard { stamp, place });
            }
        }
    }
    found.sort_by_key(|f| (f.stamp.variants.start, f.stamp.variants.end));
    cover(&found, &stamp)?;
    let _lock = target.lock()?;
    stamp.put(target)?;
    let mut products = Products::new(&variants, target)?;
    let schema = products.schema().clone();
    for shard in &found {
        let broken = |problem: String| MergeError::Broken { shard: shard.name(), problem };
        let file = format!("shards/{}/variants.parquet", shard.stamp.shard.folder());
        let bytes = shard.place.get(&file)?.ok_or_else(|| broken("its table is missing".to_owned()))?;
        let rows = read_rows(bytes, &schema).map_err(|e| broken(e.to_string()))?;
        let mut expected = shard.stamp.variants.clone();
        for row in rows {
            let row = row.map_err(|e: BatchTableError| broken(e.to_string()))?;
            let index = expected.next().ok_or_else(|| broken("its table has too many rows".to_owned()))?;
            #[allow(clippy::cast_precision_loss)]
            if schema.cell(&row, "index").number() != Some(index as f64) {
                return Err(broken(format!("its table lacks variant {}", index + 1)));
            }
            products.push(index, row)?;
        }
        if !expected.is_empty() {
            return Err(broken(format!("its table lacks the last {} rows", expected.end - expected.start)));
        }
    }
    Ok(products.finish()?)
}

/// The stamp that all places share.
fn one_sweep(places: &[Destination]) -> Result<Stamp, MergeError> {
    let mut first: Option<(Stamp, String)> = None;
    for place in places {
        let stamp = Stamp::read(place)?;
        match &first {
            None => first = Some((stamp, place.name())),
            Some((known, _)) if known.sweep_sha256 == stamp.sweep_sha256 => {}
            Some((_, name)) => return Err(MergeError::DifferentSweeps(name.clone(), place.name())),
        }
    }
    first.map(|(stamp, _)| stamp).ok_or_else(|| StampError::Missing { place: "nothing".to_owned() }.into())
}

/// Whether the shards hold every variant once.
fn cover(found: &[FinishedShard<'_>], stamp: &Stamp) -> Result<(), MergeError> {
    let mut next = 0;
    let mut before: Option<&FinishedShard<'_>> = None;
    let gap = |from: u64, to: u64| {
        let of = found.first().map(|f| f.stamp.shard);
        let hint = of.map_or_else(
            || "; run them with --shard K/N".to_owned(),
            |shard| {
                format!(
                    "; run the missing shards of {}",
                    shard.folder().rsplit('-').next().unwrap_or_default()
                )
            },
        );
        MergeError::Gap { from: from + 1, to, of: stamp.variants, hint }
    };
    for shard in found {
        let range = &shard.stamp.variants;
        if shard.stamp.sweep_sha256 != stamp.sweep_sha256 {
            return Err(MergeError::Broken {
                shard: shard.name(),
                problem: "it belongs to another sweep".to_owned(),
            });
        }
        if range.start > next {
            return Err(gap(next, range.start));
        }
        if let Some(first) = before.filter(|_| range.start < next) {
            let (from, to) = (range.start + 1, next.min(range.end));
            return Err(MergeError::Overlap { from, to, first: first.name(), second: shard.name() });
        }
        next = range.end;
        before = Some(shard);
    }
    if next < stamp.variants { Err(gap(next, stamp.variants)) } else { Ok(()) }
}
