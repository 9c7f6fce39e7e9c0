//! A table of configurations in, a table of friction curves out: without parts, in parallel, in bounded
//! memory, and resumed after an interruption.
//!
//! The rows are predicted in blocks. A finished block is a file in a hidden folder next to the output, and
//! the output is the concatenation of all blocks.

mod columns;
mod configurations;
mod work_folder;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::{self, BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use bytes::Bytes;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::FrictionCurve;
use pinswitch_store::{LockPolicy, replace_file_with, write_help};
use pinswitch_switch::config::{Configuration, to_toml};
use pinswitch_switch::design::Design;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use toml_edit::Value;

pub use columns::RowOutcome;
pub use configurations::ConfigurationTable;

use crate::axis::accepted;
use crate::diagnostics::diagnostic_error;
use crate::hexadecimal;
use crate::parallel::{self, Pool};
use crate::prediction_cache::PredictionCache;
use crate::table::Column;
use crate::table_files::{BatchTableError, CsvTable, ParquetTable};
use work_folder::{FinishedBlock, FinishedOutput, WorkFolder};

/// Most rows of a block: after a run is killed, at most this many per thread are predicted again.
const BLOCK_ROWS: u64 = 256;
/// Most lines of a block, if the rows have as many loads as the base.
const BLOCK_LINES: u64 = 8192;
/// Blocks per thread that are in memory together.
const BLOCKS_PER_THREAD: usize = 2;

/// Predicts the curve of a design.
pub type CurveFunction<'a> = &'a (dyn Fn(&Design) -> Result<FrictionCurve, Diagnostic> + Sync);

/// A prediction of every row of a table.
pub struct CurveJob<'a> {
    /// The rows.
    pub table: &'a ConfigurationTable,
    /// The configuration that the rows change.
    pub base: &'a Configuration,
    /// The law, if it is not the default law: text that identifies it, such as the SHA-256 of a model, and its
    /// function.
    pub law: Option<(String, CurveFunction<'a>)>,
    /// Number of threads; 0 means one per processor.
    pub threads: usize,
    /// Behaviour while another process writes the same output.
    pub policy: LockPolicy,
    /// Called with a number of rows when they are finished, also those of an earlier run.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// Format of a table of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveFormat {
    /// CSV.
    Csv,
    /// Parquet.
    Parquet,
}

impl CurveFormat {
    /// Returns the format of a file by the ending of its name.
    ///
    /// # Errors
    /// Another ending.
    pub fn of_file(path: &Path) -> Result<Self, Diagnostic> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            _ => Err(Diagnostic::new(codes::UNSUPPORTED_FORMAT, "unknown format of a table of curves")
                .with_location(Location::field("--out", path.display().to_string()))
                .with_help("give a name that ends with .csv or .parquet")),
        }
    }
}

/// Numbers of rows by their status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CurveTally {
    /// Rows with a curve.
    pub predicted: u64,
    /// Rows whose configuration is invalid, or to which the law does not apply.
    pub refused: u64,
    /// Rows with an internal error.
    pub failed: u64,
}

impl CurveTally {
    /// Returns the number of rows.
    pub fn rows(&self) -> u64 {
        self.predicted + self.refused + self.failed
    }

    fn add(&mut self, other: Self) {
        self.predicted += other.predicted;
        self.refused += other.refused;
        self.failed += other.failed;
    }
}

/// A finished table of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveOutcome {
    /// Its rows by their status.
    pub tally: CurveTally,
    /// Number of rows that an earlier run has predicted.
    pub existing: u64,
}

/// Why a table of curves cannot be written. Finished blocks remain, and the same command resumes the run.
#[derive(Debug)]
pub enum CurveTableError {
    /// The table of configurations is damaged, or the output has no format.
    Input(Diagnostic),
    /// A file or folder cannot be read or written.
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A block cannot be encoded.
    Table(BatchTableError),
    /// The threads cannot be started.
    Threads(Box<dyn Error + Send + Sync>),
}

impl CurveTableError {
    fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Input(error) => error.clone(),
            Self::File { path, source } => {
                Diagnostic::new(codes::CANNOT_WRITE, format!("cannot write: {source}"))
                    .with_location(Location::file(path.display().to_string()))
                    .with_help(write_help(path, source))
            }
            Self::Table(error) => error.diagnostic(),
            Self::Threads(error) => {
                Diagnostic::new(codes::CANNOT_START, format!("cannot start threads: {error}"))
                    .with_help("give fewer --threads")
            }
        }
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Input(error) => error.source(),
            Self::File { source, .. } => Some(source),
            Self::Table(error) => error.source(),
            Self::Threads(error) => Some(&**error),
        }
    }
}

diagnostic_error!(CurveTableError);

impl From<BatchTableError> for CurveTableError {
    fn from(error: BatchTableError) -> Self {
        Self::Table(error)
    }
}

fn file_error(path: &Path) -> impl FnOnce(io::Error) -> CurveTableError + '_ {
    |source| CurveTableError::File { path: path.to_owned(), source }
}

/// Predicts every row and writes the curves to `out`, a CSV or Parquet file by its ending. Rows keep their order, and
/// the bytes do not depend on the number of threads. If `out` exists and is the result of the same inputs, it is
/// only hashed.
///
/// # Errors
/// [`CurveTableError`]; an earlier file at `out` is unchanged.
pub fn predict_rows(job: &CurveJob<'_>, out: &Path) -> Result<CurveOutcome, CurveTableError> {
    let format = CurveFormat::of_file(out).map_err(CurveTableError::Input)?;
    let work = WorkFolder::lock(out, job.digest(format), job.policy)?;
    if let Some(finished) = work.finished()?
        && file_sha256(out).as_ref() == Some(&finished.sha256)
    {
        let FinishedOutput { tally, .. } = finished;
        (job.progress)(tally.rows());
        return Ok(CurveOutcome { tally, existing: tally.rows() });
    }
    let mut blocks = work.resume()?;
    let existing = total(&blocks).rows();
    (job.progress)(existing);
    let pool = Pool::new(job.threads).map_err(CurveTableError::Threads)?;
    let predictor = Predictor {
        job,
        format,
        columns: columns::columns(job.table.fields()),
        predictions: PredictionCache::default(),
    };
    let block_rows = job.block_rows();
    let missing: Vec<u64> =
        (0..job.table.count().div_ceil(block_rows)).filter(|n| !blocks.contains_key(n)).collect();
    let mut reader = job.table.reader().map_err(CurveTableError::Input)?;
    for chunk in missing.chunks(BLOCKS_PER_THREAD * pool.threads()) {
        let read = |number: &u64| {
            let start = number * block_rows;
            let rows = reader.take(start..job.table.count().min(start + block_rows))?;
            Ok(Block { number: *number, start, rows })
        };
        let read: Vec<Block> =
            chunk.iter().map(read).collect::<Result<_, _>>().map_err(CurveTableError::Input)?;
        let written = pool.install(|| {
            parallel::try_map(&read, |block| {
                let (bytes, tally) = predictor.block(block)?;
                (job.progress)(tally.rows());
                Ok::<_, CurveTableError>((block.number, work.write(block.number, tally, &bytes)?))
            })
        })?;
        blocks.extend(written);
    }
    let tally = total(&blocks);
    let mut sha256 = String::new();
    replace_file_with(out, job.policy, |file| {
        let mut output = HashingWriter { output: BufWriter::new(file), hash: Sha256::new() };
        let contents = blocks.values().map(|block| work.read(block));
        write_blocks(&mut output, format, &predictor.columns, contents).map_err(io::Error::other)?;
        output.flush()?;
        sha256 = hexadecimal(&output.hash.finalize());
        Ok(())
    })
    .map_err(file_error(out))?;
    work.finish(FinishedOutput { sha256, tally }, &blocks)?;
    Ok(CurveOutcome { tally, existing })
}

/// The values of a row, as its fields accept them, and its outcome.
pub type PredictedRow = (Vec<Value>, RowOutcome);

/// Predicts every row in memory; rows keep their order. The lock policy and the identity of the law have no effect.
/// Returns `None` if `stop` returns true, which is called after each block.
///
/// # Errors
/// [`CurveTableError`] if the table is damaged or no threads can be started.
pub fn predict_table(
    job: &CurveJob<'_>,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Vec<PredictedRow>>, CurveTableError> {
    let pool = Pool::new(job.threads).map_err(CurveTableError::Threads)?;
    let predictor = Predictor {
        job,
        format: CurveFormat::Csv,
        columns: Vec::new(),
        predictions: PredictionCache::default(),
    };
    let mut reader = job.table.reader().map_err(CurveTableError::Input)?;
    let block = job.block_rows() * (BLOCKS_PER_THREAD * pool.threads()) as u64;
    let (mut rows, mut start) = (Vec::new(), 0);
    while start < job.table.count() {
        let end = job.table.count().min(start + block);
        let values = reader.take(start..end).map_err(CurveTableError::Input)?;
        rows.extend(pool.install(|| parallel::map(&values, |values| predictor.outcome(values))));
        (job.progress)(end - start);
        start = end;
        if stop() {
            return Ok(None);
        }
    }
    Ok(Some(rows))
}

/// Returns the totals of blocks.
fn total(blocks: &BTreeMap<u64, FinishedBlock>) -> CurveTally {
    let mut tally = CurveTally::default();
    blocks.values().for_each(|block| tally.add(block.tally));
    tally
}

/// Writes a table that consists of these blocks.
fn write_blocks(
    mut output: impl Write + Send,
    format: CurveFormat,
    columns: &[Column],
    blocks: impl Iterator<Item = Result<Vec<u8>, CurveTableError>>,
) -> Result<(), CurveTableError> {
    match format {
        CurveFormat::Csv => {
            CsvTable::with_header(&mut output, columns)?.finish()?;
            for block in blocks {
                output.write_all(&block?).map_err(BatchTableError::File)?;
            }
        }
        CurveFormat::Parquet => {
            let mut table = ParquetTable::new(output, columns)?;
            for block in blocks {
                table.append(Bytes::from(block?))?;
            }
            table.finish()?;
        }
    }
    Ok(())
}

impl CurveJob<'_> {
    /// Returns the SHA-256 of everything that determines the output, including the program's version.
    fn digest(&self, format: CurveFormat) -> String {
        let base = to_toml(self.base);
        let law = self.law.as_ref().map_or("", |(identity, _)| identity);
        let mut hash = Sha256::new();
        for text in [env!("CARGO_PKG_VERSION"), self.table.sha256(), &base, law, &format!("{format:?}")] {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        }
        hexadecimal(&hash.finalize())
    }

    fn block_rows(&self) -> u64 {
        (BLOCK_LINES / self.base.friction.points.max(1) as u64).clamp(1, BLOCK_ROWS)
    }
}

/// Rows that are predicted and written together.
struct Block {
    number: u64,
    /// Index of the first row.
    start: u64,
    rows: Vec<Vec<Value>>,
}

struct Predictor<'a> {
    job: &'a CurveJob<'a>,
    format: CurveFormat,
    columns: Vec<Column>,
    predictions: PredictionCache,
}

impl Predictor<'_> {
    /// Predicts a block; returns its bytes in the format of the output, and its totals.
    fn block(&self, block: &Block) -> Result<(Vec<u8>, CurveTally), CurveTableError> {
        let row = |index: &u64| {
            let values = usize::try_from(index - block.start).ok().and_then(|i| block.rows.get(i));
            let values = values.map(Vec::as_slice).unwrap_or_default();
            (*index, self.outcome(values))
        };
        let indices: Vec<u64> = (block.start..block.start + block.rows.len() as u64).collect();
        let rows = parallel::map(&indices, row);
        let mut tally = CurveTally::default();
        for (_, (_, outcome)) in &rows {
            match outcome {
                RowOutcome::Predicted(_) => tally.predicted += 1,
                RowOutcome::Refused(_) => tally.refused += 1,
                RowOutcome::Failed(_) => tally.failed += 1,
            }
        }
        let fields = self.job.table.fields();
        let bytes = match self.format {
            CurveFormat::Csv => {
                let mut table = CsvTable::new(Vec::new());
                for (index, (values, outcome)) in rows {
                    columns::lines(index, columns::own_cells(fields, &values), outcome, |line| {
                        table.push(&line)
                    })?;
                }
                table.finish()?
            }
            CurveFormat::Parquet => {
                let mut table = ParquetTable::new(Vec::new(), &self.columns)?;
                for (index, (values, outcome)) in rows {
                    columns::lines(index, columns::own_cells(fields, &values), outcome, |line| {
                        table.push(line)
                    })?;
                }
                table.finish()?
            }
        };
        Ok((bytes, tally))
    }

    /// Predicts a row; a panic in it does not fail the other rows.
    fn outcome(&self, values: &[Value]) -> (Vec<Value>, RowOutcome) {
        catch_unwind(AssertUnwindSafe(|| self.row(values))).unwrap_or_else(|_| {
            let bug = Diagnostic::new(codes::INTERNAL_ERROR, "internal error (panic)");
            (values.to_vec(), RowOutcome::Failed(bug.with_help("please report the configuration")))
        })
    }

    /// Predicts a row. Also returns its values, converted to the types of their fields where these accept them.
    fn row(&self, values: &[Value]) -> (Vec<Value>, RowOutcome) {
        let mut configuration = self.job.base.clone();
        let mut refusal = None;
        let set = |(field, value): (&crate::ParameterRef, &Value)| {
            let outcome = accepted(field, value).and_then(|value| {
                (field.set)(&mut configuration, &value)
                    .map_err(|error| error.in_field(field.path(), ""))
                    .map(|()| value)
            });
            outcome.unwrap_or_else(|error| {
                refusal.get_or_insert(error);
                value.clone()
            })
        };
        let own = self.job.table.fields().iter().zip(values).map(set).collect();
        let outcome = refusal.map_or_else(|| self.curve(configuration), Err);
        (own, outcome.map_or_else(RowOutcome::Refused, RowOutcome::Predicted))
    }

    fn curve(&self, configuration: Configuration) -> Result<FrictionCurve, Diagnostic> {
        let design = Design::new(configuration)?;
        match &self.job.law {
            Some((_, curve)) => curve(&design),
            None => Ok(self.predictions.get(&design).curve(&design).clone()),
        }
    }
}

/// A writer that hashes what it writes.
struct HashingWriter<W> {
    output: W,
    hash: Sha256,
}

impl<W: Write> Write for HashingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.output.write(bytes)?;
        self.hash.update(bytes.get(..written).unwrap_or_default());
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}

/// Returns the SHA-256 of an ordinary file; `None` if it cannot be read.
fn file_sha256(path: &Path) -> Option<String> {
    let mut file = std::fs::metadata(path).ok()?.is_file().then(|| std::fs::File::open(path).ok())??;
    let mut hash = HashingWriter { output: io::sink(), hash: Sha256::new() };
    io::copy(&mut file, &mut hash).ok()?;
    Some(hexadecimal(&hash.hash.finalize()))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::table_files::{column_names, open_parquet, parquet_rows};

    fn predict(table: &ConfigurationTable, out: &Path, rows: &AtomicU64) -> CurveOutcome {
        let mut base = Configuration::default();
        pinswitch_switch::config::assign(&mut base, "friction.points=2").unwrap();
        let job = CurveJob {
            table,
            base: &base,
            law: None,
            threads: 2,
            policy: LockPolicy::Refuse,
            progress: &|count| {
                rows.fetch_add(count, Ordering::Relaxed);
            },
        };
        predict_rows(&job, out).unwrap()
    }

    /// 600 rows are three blocks, with 87 refused rows among them.
    fn table() -> ConfigurationTable {
        let row = |i: u32| format!("\"[{}]\",{}\n", 5 + i % 2, if i % 7 == 3 { -1.0 } else { 12.5 });
        let text: String = (0..610).map(row).collect();
        ConfigurationTable::read(format!("layout.pins,shell.width_mm\n{text}").into_bytes(), "t.csv").unwrap()
    }

    #[test]
    fn csv_and_parquet_are_equal() {
        let folder = tempfile::tempdir().unwrap();
        let [csv, parquet] = ["t.csv", "t.parquet"].map(|name| folder.path().join(name));
        let rows = AtomicU64::new(0);
        let outcome = predict(&table(), &csv, &rows);
        let tally = CurveTally { predicted: 523, refused: 87, failed: 0 };
        assert_eq!((outcome, rows.into_inner()), (CurveOutcome { tally, existing: 0 }, 610));
        assert_eq!(predict(&table(), &parquet, &AtomicU64::new(0)), outcome);
        let reader = open_parquet(Bytes::from(std::fs::read(&parquet).unwrap())).unwrap();
        let mut text = csv::Reader::from_path(&csv).unwrap();
        assert!(column_names(&reader).eq(text.headers().unwrap().iter()));
        let cells = |row: parquet::record::Row| -> Vec<String> {
            row.get_column_iter().map(|(_, field)| crate::table_files::cell(field).to_string()).collect()
        };
        let parquet: Vec<_> = parquet_rows(reader).unwrap().map(|row| cells(row.unwrap())).collect();
        let csv: Vec<Vec<String>> =
            text.records().map(|r| r.unwrap().iter().map(str::to_owned).collect()).collect();
        assert_eq!(csv.len(), 2 * 523 + 87);
        assert_eq!(csv, parquet);
    }

    #[test]
    fn tables_in_memory_keep_their_rows() {
        let mut base = Configuration::default();
        pinswitch_switch::config::assign(&mut base, "friction.points=2").unwrap();
        let (table, done) = (table(), AtomicU64::new(0));
        let job = CurveJob {
            table: &table,
            base: &base,
            law: None,
            threads: 2,
            policy: LockPolicy::Refuse,
            progress: &|rows| {
                done.fetch_add(rows, Ordering::Relaxed);
            },
        };
        let rows = predict_table(&job, &|| false).unwrap().unwrap();
        assert_eq!((rows.len(), done.load(Ordering::Relaxed)), (610, 610));
        for (i, (values, outcome)) in rows.iter().enumerate() {
            assert_eq!(values[0].to_string().trim(), format!("[{}]", 5 + i % 2));
            assert_eq!(matches!(outcome, RowOutcome::Refused(_)), i % 7 == 3, "row {i}");
        }
        assert!(predict_table(&job, &|| true).unwrap().is_none(), "stopped");
    }

    #[test]
    fn one_run_writes_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("t.csv");
        let _lock = WorkFolder::lock(&out, String::new(), LockPolicy::Refuse).unwrap();
        let job = CurveJob {
            table: &table(),
            base: &Configuration::default(),
            law: None,
            threads: 1,
            policy: LockPolicy::Refuse,
            progress: &|_| {},
        };
        let error = predict_rows(&job, &out).unwrap_err();
        assert!(error.to_string().contains("another run is writing into this folder"), "{error}");
        assert!(!out.exists());
    }
}
