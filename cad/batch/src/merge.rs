//! Joins the tables of shards into the products of the whole sweep.

use pinswitch_diagnostic::excerpt;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::destination::{Destination, DestinationError};
use super::hexadecimal;
use super::inspect::Inspector;
use super::make::variant_folder;
use super::obstacles::refuse_obstacles;
use super::products::{ProductError, Products};
use super::run::ShardStamp;
use super::seal::is_sealed;
use super::shard::Shard;
use super::stamp::{Stamp, StampError};
use super::sweep::Sweep;
use super::table::{Row, Schema};
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
    #[error("shard {shard}: {}; run it again", excerpt(problem, 300))]
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

/// Rows that are looked at together.
const CHUNK_ROWS: usize = 512;
/// Files that an error names.
const MAX_NAMED: usize = 3;

/// A finished shard and its place.
struct FinishedShard<'a> {
    stamp: ShardStamp,
    place: &'a Destination,
}

impl FinishedShard<'_> {
    fn name(&self) -> String {
        format!("{} of {}", self.stamp.shard, self.place.name())
    }

    /// The bytes of a table of this shard, as it recorded them.
    fn table(&self, file: &str) -> Result<Vec<u8>, MergeError> {
        let broken =
            |problem: &str| MergeError::Broken { shard: self.name(), problem: format!("{file} {problem}") };
        let bytes = self.place.get(file)?.ok_or_else(|| broken("is missing"))?;
        let name = file.rsplit('/').next().unwrap_or_default();
        if self.stamp.tables.get(name) == Some(&hexadecimal(&Sha256::digest(&bytes))) {
            Ok(bytes)
        } else {
            Err(broken("has changed"))
        }
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
    if variants.count() != stamp.variants {
        let problem = format!("it says {} variants, and its sweep has {}", stamp.variants, variants.count());
        return Err(StampError::Unreadable {
            place: places.first().map_or_else(String::new, Destination::name),
            problem,
        }
        .into());
    }
    stamp.refuse_foreign(target)?;
    refuse_obstacles(target, Shard::WHOLE)?;
    let mut found = Vec::new();
    for place in places {
        for folder in place.folders("shards")? {
            if let Some(bytes) = place.get(&format!("shards/{folder}/shard.json"))? {
                let broken = |problem: String| MergeError::Broken {
                    shard: format!("{folder} of {}", place.name()),
                    problem,
                };
                let stamp: ShardStamp =
                    serde_json::from_slice(&bytes).map_err(|e| broken(format!("shard.json: {e}")))?;
                let range = stamp.shard.range(variants.count());
                if !is_sealed(&bytes) || stamp.shard.folder() != folder || stamp.variants != range {
                    return Err(broken("shard.json was changed or damaged".to_owned()));
                }
                found.push(FinishedShard { stamp, place });
            }
        }
    }
    found.sort_by_key(|f| (f.stamp.variants.start, f.stamp.variants.end));
    cover(&found, &stamp)?;
    let _lock = target.lock()?;
    let mut products = Products::new(&variants, target)?;
    let schema = products.schema().clone();
    let mut damage: Vec<(String, String)> = Vec::new();
    for shard in &found {
        let broken = |problem: String| MergeError::Broken { shard: shard.name(), problem };
        let file = format!("shards/{}/variants.parquet", shard.stamp.shard.folder());
        let bytes = shard.table(&file)?;
        shard.table(&format!("shards/{}/variants.csv", shard.stamp.shard.folder()))?;
        let rows = read_rows(bytes, &schema).map_err(|e| broken(e.to_string()))?;
        let mut expected = shard.stamp.variants.clone();
        let inspector = Inspector::new(shard.place);
        let mut rows = rows.map(|row| row.map_err(|e: BatchTableError| broken(e.to_string())));
        loop {
            let chunk = rows.by_ref().take(CHUNK_ROWS).collect::<Result<Vec<_>, _>>()?;
            if chunk.is_empty() {
                break;
            }
            let looks = chunk.par_iter().map(|row| look(&inspector, &schema, row));
            damage.extend(
                looks.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().map(|file| (shard.name(), file)),
            );
            for row in chunk {
                let index =
                    expected.next().ok_or_else(|| broken("its table has too many rows".to_owned()))?;
                #[allow(clippy::cast_precision_loss)]
                if schema.cell(&row, "index").number() != Some(index as f64) {
                    return Err(broken(format!("its table lacks variant {}", index + 1)));
                }
                products.push(index, row)?;
            }
        }
        if !expected.is_empty() {
            return Err(broken(format!("its table lacks the last {} rows", expected.end - expected.start)));
        }
    }
    if let Some((shard, file)) = damage.first() {
        let problem = match damage.len() {
            1 => format!("{file} is missing or has changed"),
            n => {
                let some: Vec<_> =
                    damage.iter().skip(1).take(MAX_NAMED - 1).map(|(_, file)| file.as_str()).collect();
                let rest = if n > MAX_NAMED { format!(" and {} more", n - MAX_NAMED) } else { String::new() };
                format!("{file}, {}{rest} are missing or have changed", some.join(", "))
            }
        };
        return Err(MergeError::Broken { shard: shard.clone(), problem });
    }
    stamp.put(target)?;
    Ok(products.finish()?)
}

/// The first file of a row's variant that is missing or is not what the shard has made.
fn look(inspector: &Inspector<'_>, schema: &Schema, row: &Row) -> Result<Option<String>, DestinationError> {
    let text = |name: &str| schema.cell(row, name).text().unwrap_or_default();
    if text("status") != "made" {
        return Ok(None);
    }
    let id = text("id");
    let named = |file: &str| Some(format!("{}/{file}", variant_folder(id)));
    let found = inspector.manifest(id)?;
    let own = found.filter(|(bytes, _)| hexadecimal(&Sha256::digest(bytes)) == text("manifest_sha256"));
    let Some((_, listing)) = own else { return Ok(named("manifest.json")) };
    Ok(inspector.damaged(id, &listing)?.and_then(named))
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
        let hint = found.first().map_or_else(
            || "; run them with --shard K/N".to_owned(),
            |f| format!("; run {}", f.stamp.shard.siblings(stamp.variants, from..to)),
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
