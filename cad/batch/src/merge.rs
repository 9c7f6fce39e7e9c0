//! Merges finished shards into the products of the whole sweep.

use std::error::Error;

use pinswitch_diagnostic::{Diagnostic, codes, excerpt};
use sha2::{Digest, Sha256};

use super::checksum::has_valid_checksum;
use super::destination::{Destination, DestinationError};
use super::diagnostics::diagnostic_error;
use super::gallery::Sketch;
use super::hexadecimal;
use super::inspect::Inspector;
use super::make::variant_folder;
use super::obstructions::check_paths;
use super::parallel;
use super::products::{ProductError, Products};
use super::run::ShardStamp;
use super::shard::Shard;
use super::stamp::{Stamp, StampError};
use super::sweep::Sweep;
use super::table::{Cell, Row, Schema};
use super::table_files::{BatchTableError, read_rows};
use super::tally::Tally;
use super::variant::Variants;

/// Why shards cannot be merged.
#[derive(Debug)]
pub enum MergeError {
    /// A place is not a batch, or the target contains another one.
    Stamp(StampError),
    /// Two places contain different sweeps.
    DifferentSweeps(String, String),
    /// Some variants are in no shard.
    Gap {
        /// First missing variant, from 1.
        from: u64,
        /// Last missing variant.
        to: u64,
        /// Number of variants of the sweep.
        of: u64,
        /// Options of the missing shards.
        options: String,
    },
    /// Some variants are in two shards.
    Overlap {
        /// First common variant, from 1.
        from: u64,
        /// Last common variant.
        to: u64,
        /// One shard with its place.
        first: String,
        /// The other shard with its place.
        second: String,
    },
    /// A file of a shard is missing, damaged or inconsistent.
    Broken {
        /// The shard with its place.
        shard: String,
        /// What is wrong.
        problem: String,
    },
    /// The sweep in the stamp is not valid.
    Sweep(Diagnostic),
    /// The products cannot be made.
    Products(ProductError),
    /// A place cannot be read.
    Destination(DestinationError),
}

impl MergeError {
    fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Stamp(error) => error.diagnostic(),
            Self::DifferentSweeps(first, second) => Diagnostic::new(
                codes::SHARDS_DO_NOT_JOIN,
                format!("{first} and {second} contain different sweeps"),
            )
            .with_help("merge the shards of one sweep"),
            Self::Gap { from, to, of, options } => Diagnostic::new(
                codes::SHARDS_DO_NOT_JOIN,
                format!("variants {from} to {to} of {of} are in no finished shard"),
            )
            .with_help(format!("run {options}")),
            Self::Overlap { from, to, first, second } => Diagnostic::new(
                codes::SHARDS_DO_NOT_JOIN,
                format!("variants {from} to {to} are both in shard {first} and in shard {second}"),
            )
            .with_help("leave one of them out"),
            Self::Broken { shard, problem } => {
                Diagnostic::new(codes::SHARD_DAMAGED, format!("shard {shard}: {}", excerpt(problem, 300)))
                    .with_help("run it again")
            }
            Self::Sweep(error) => error.clone(),
            Self::Products(error) => error.diagnostic(),
            Self::Destination(error) => error.clone().into(),
        }
    }

    /// Returns whether the cause is the user's input: places that are not the shards of one batch.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Stamp(error) => error.is_bad_input(),
            Self::Products(_) | Self::Destination(_) => false,
            _ => true,
        }
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Stamp(error) => error.source(),
            Self::Sweep(error) => error.source(),
            Self::Products(error) => error.source(),
            Self::Destination(error) => error.source(),
            Self::DifferentSweeps(..) | Self::Gap { .. } | Self::Overlap { .. } | Self::Broken { .. } => None,
        }
    }
}

diagnostic_error!(MergeError);

impl From<StampError> for MergeError {
    fn from(error: StampError) -> Self {
        Self::Stamp(error)
    }
}

impl From<ProductError> for MergeError {
    fn from(error: ProductError) -> Self {
        Self::Products(error)
    }
}

impl From<DestinationError> for MergeError {
    fn from(error: DestinationError) -> Self {
        Self::Destination(error)
    }
}

/// Rows that are checked in parallel.
const CHUNK_ROWS: usize = 512;
/// Most files that an error lists.
const MAX_LISTED: usize = 3;

/// A finished shard and its place.
struct FinishedShard<'a> {
    stamp: ShardStamp,
    place: &'a Destination,
}

impl FinishedShard<'_> {
    fn name(&self) -> String {
        format!("{} of {}", self.stamp.shard, self.place.name())
    }

    /// Reads a table of this shard, and checks its recorded hash.
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

/// Merges all finished shards of `places` into `target`, which can be one of them.
///
/// # Errors
/// Gaps, overlaps, different sweeps and damaged shards; then nothing is written.
pub fn merge(places: &[Destination], target: &Destination) -> Result<Tally, MergeError> {
    let stamp = common_stamp(places)?;
    let sweep = Sweep::new(&stamp.source).map_err(MergeError::Sweep)?;
    let variants = Variants::new(sweep, &stamp.source);
    if variants.count() != stamp.variants {
        let problem = format!("{} variants recorded, but the sweep has {}", stamp.variants, variants.count());
        let place = places.first().map_or_else(String::new, Destination::name);
        return Err(StampError::Invalid { place, problem, source: None }.into());
    }
    stamp.check(target)?;
    check_paths(target, Shard::WHOLE)?;
    let shards = finished_shards(places, variants.count())?;
    check_coverage(&shards, &stamp)?;
    let _lock = target.lock()?;
    let mut products = Products::new(&variants, target)?;
    let mut damaged: Vec<(String, String)> = Vec::new();
    for shard in &shards {
        add_rows(shard, &variants, &mut products, &mut damaged)?;
    }
    if let Some(error) = damage(&damaged) {
        return Err(error);
    }
    stamp.write(target)?;
    Ok(products.finish()?)
}

/// Reads the records of all finished shards, sorted by their variants. A damaged record is an
/// error.
fn finished_shards(places: &[Destination], variants: u64) -> Result<Vec<FinishedShard<'_>>, MergeError> {
    let mut shards = Vec::new();
    for place in places {
        for folder in place.folders("shards")? {
            let Some(bytes) = place.get(&format!("shards/{folder}/shard.json"))? else { continue };
            let broken = |problem: String| MergeError::Broken {
                shard: format!("{folder} of {}", place.name()),
                problem,
            };
            let stamp: ShardStamp =
                serde_json::from_slice(&bytes).map_err(|e| broken(format!("shard.json: {e}")))?;
            let is_consistent = has_valid_checksum(&bytes)
                && stamp.shard.folder() == folder
                && stamp.variants == stamp.shard.range(variants);
            if !is_consistent {
                return Err(broken("shard.json was changed or damaged".to_owned()));
            }
            shards.push(FinishedShard { stamp, place });
        }
    }
    shards.sort_by_key(|shard| (shard.stamp.variants.start, shard.stamp.variants.end));
    Ok(shards)
}

/// Adds the rows of a shard to the products, and its damaged files to `damaged`.
fn add_rows(
    shard: &FinishedShard<'_>,
    variants: &Variants,
    products: &mut Products<'_>,
    damaged: &mut Vec<(String, String)>,
) -> Result<(), MergeError> {
    let schema = products.schema().clone();
    let broken = |problem: String| MergeError::Broken { shard: shard.name(), problem };
    let folder = shard.stamp.shard.folder();
    let bytes = shard.table(&format!("shards/{folder}/variants.parquet"))?;
    shard.table(&format!("shards/{folder}/variants.csv"))?;
    let rows = read_rows(bytes, &schema).map_err(|e| broken(e.to_string()))?;
    let mut rows = rows.map(|row| row.map_err(|e: BatchTableError| broken(e.to_string())));
    let mut expected = shard.stamp.variants.clone();
    let inspector = Inspector::new(shard.place);
    loop {
        let chunk = rows.by_ref().take(CHUNK_ROWS).collect::<Result<Vec<_>, _>>()?;
        if chunk.is_empty() {
            break;
        }
        let inspected = parallel::try_map(&chunk, |row| inspected(&inspector, variants, &schema, row))?;
        for (row, variant) in chunk.into_iter().zip(inspected) {
            damaged.extend(variant.damaged.map(|file| (shard.name(), file)));
            let index = expected.next().ok_or_else(|| broken("its table has too many rows".to_owned()))?;
            #[allow(clippy::cast_precision_loss)]
            if schema.cell(&row, "index").number() != Some(index as f64) {
                return Err(broken(format!("its table lacks variant {}", index + 1)));
            }
            products.push(index, row, variant.sketch)?;
        }
    }
    if expected.is_empty() {
        return Ok(());
    }
    Err(broken(format!("its table lacks the last {} rows", expected.end - expected.start)))
}

/// Returns the error for damaged files, each with its shard; the first of them are listed.
fn damage(damaged: &[(String, String)]) -> Option<MergeError> {
    let (shard, file) = damaged.first()?;
    let problem = match damaged.len() {
        1 => format!("{file} is missing or has changed"),
        n => {
            let others: Vec<_> =
                damaged.iter().skip(1).take(MAX_LISTED - 1).map(|(_, file)| file.as_str()).collect();
            let rest = if n > MAX_LISTED { format!(" and {} more", n - MAX_LISTED) } else { String::new() };
            format!("{file}, {}{rest} are missing or have changed", others.join(", "))
        }
    };
    Some(MergeError::Broken { shard: shard.clone(), problem })
}

/// The inspected variant of a row.
#[derive(Default)]
struct InspectedVariant {
    /// The first file that is missing or has changed.
    damaged: Option<String>,
    sketch: Option<Sketch>,
}

/// Compares the files of a row's variant with its manifest, and sketches its curve.
fn inspected(
    inspector: &Inspector<'_>,
    variants: &Variants,
    schema: &Schema,
    row: &Row,
) -> Result<InspectedVariant, DestinationError> {
    let text = |name: &str| schema.cell(row, name).text().unwrap_or_default();
    if text("status") != "made" {
        return Ok(InspectedVariant::default());
    }
    let id = text("id");
    let damaged = |file: &str| InspectedVariant {
        damaged: Some(format!("{}/{file}", variant_folder(id))),
        sketch: None,
    };
    let manifest = inspector.manifest(id)?;
    let unchanged =
        manifest.filter(|(bytes, _)| hexadecimal(&Sha256::digest(bytes)) == text("manifest_sha256"));
    let Some((_, listing)) = unchanged else { return Ok(damaged("manifest.json")) };
    let inspection = inspector.inspect(id, &listing)?;
    if let Some(file) = inspection.damaged {
        return Ok(damaged(file));
    }
    let index = match schema.cell(row, "index") {
        Cell::Integer(index) => u64::try_from(*index).ok().filter(|index| *index < variants.count()),
        _ => None,
    };
    let sketch = index.zip(inspection.curve).and_then(|(index, curve)| Sketch::new(variants, index, &curve));
    Ok(InspectedVariant { damaged: None, sketch })
}

/// Reads the stamp that all places have in common.
fn common_stamp(places: &[Destination]) -> Result<Stamp, MergeError> {
    let mut first: Option<(Stamp, String)> = None;
    for place in places {
        let stamp = Stamp::read(place)?;
        match &first {
            None => first = Some((stamp, place.name())),
            Some((known, _)) if known.sweep_sha256 == stamp.sweep_sha256 => {}
            Some((_, name)) => return Err(MergeError::DifferentSweeps(name.clone(), place.name())),
        }
    }
    first.map(|(stamp, _)| stamp).ok_or_else(|| StampError::Missing { place: String::new() }.into())
}

/// Checks that the shards contain every variant once.
fn check_coverage(shards: &[FinishedShard<'_>], stamp: &Stamp) -> Result<(), MergeError> {
    let mut next = 0;
    let mut previous: Option<&FinishedShard<'_>> = None;
    let gap = |from: u64, to: u64| {
        let options = shards.first().map_or_else(
            || "the shards with --shard K/N".to_owned(),
            |first| first.stamp.shard.options_for(stamp.variants, from..to),
        );
        MergeError::Gap { from: from + 1, to, of: stamp.variants, options }
    };
    for shard in shards {
        let range = &shard.stamp.variants;
        if shard.stamp.sweep_sha256 != stamp.sweep_sha256 {
            let problem = "it belongs to another sweep".to_owned();
            return Err(MergeError::Broken { shard: shard.name(), problem });
        }
        if range.start > next {
            return Err(gap(next, range.start));
        }
        if let Some(first) = previous.filter(|_| range.start < next) {
            let (from, to) = (range.start + 1, next.min(range.end));
            return Err(MergeError::Overlap { from, to, first: first.name(), second: shard.name() });
        }
        next = range.end;
        previous = Some(shard);
    }
    if next < stamp.variants { Err(gap(next, stamp.variants)) } else { Ok(()) }
}
