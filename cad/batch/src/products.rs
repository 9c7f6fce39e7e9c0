//! The products of a batch or shard in addition to its variants: the table, and for a whole sweep
//! the plots and the page.

use std::collections::{BTreeMap, HashSet};
use std::error::Error;
use std::path::Path;

use pinswitch_diagnostic::{Diagnostic, codes};
use sha2::{Digest, Sha256};

use super::destination::{Destination, DestinationError};
use super::diagnostics::diagnostic_error;
use super::gallery::{Gallery, Sketch};
use super::hexadecimal;
use super::page::page;
use super::plots::{curves_svg, threshold_svg};
use super::table::{Row, Schema};
use super::table_files::{BatchTableError, TableWriter};
use super::tally::Tally;
use super::variant::Variants;
use pinswitch_report::PlotError;

/// The table in both formats.
pub(super) const TABLES: [&str; 2] = ["variants.csv", "variants.parquet"];
/// Products of a whole sweep in addition to the table: two plots and the page.
pub(super) const PRODUCTS: [&str; 3] = ["curves.svg", "threshold.svg", "index.html"];

/// Why the products cannot be made.
#[derive(Debug)]
pub enum ProductError {
    /// The table cannot be written.
    Table(BatchTableError),
    /// A plot cannot be drawn.
    Plot(PlotError),
    /// The destination cannot be written.
    Destination(DestinationError),
    /// The shard's stamp cannot be encoded.
    Stamp(serde_json::Error),
}

impl ProductError {
    pub(super) fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Table(error) => error.diagnostic(),
            Self::Plot(error) => Diagnostic::new(codes::INTERNAL_ERROR, error.to_string()),
            Self::Destination(error) => error.clone().into(),
            Self::Stamp(error) => {
                Diagnostic::new(codes::INTERNAL_ERROR, format!("cannot encode the shard's stamp: {error}"))
            }
        }
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Table(error) => error.source(),
            Self::Plot(error) => Some(error),
            Self::Destination(error) => error.source(),
            Self::Stamp(error) => Some(error),
        }
    }
}

diagnostic_error!(ProductError);

impl From<BatchTableError> for ProductError {
    fn from(error: BatchTableError) -> Self {
        Self::Table(error)
    }
}

impl From<PlotError> for ProductError {
    fn from(error: PlotError) -> Self {
        Self::Plot(error)
    }
}

impl From<DestinationError> for ProductError {
    fn from(error: DestinationError) -> Self {
        Self::Destination(error)
    }
}

impl From<serde_json::Error> for ProductError {
    fn from(error: serde_json::Error) -> Self {
        Self::Stamp(error)
    }
}

/// Collects rows in the order of the sweep and writes the products.
pub(super) struct Products<'a> {
    variants: &'a Variants,
    destination: &'a Destination,
    schema: Schema,
    csv: tempfile::NamedTempFile,
    parquet: tempfile::NamedTempFile,
    table: TableWriter,
    gallery: Gallery,
    tally: Tally,
    /// The first 64 bits of the hash of every part so far.
    seen: HashSet<u64>,
}

impl<'a> Products<'a> {
    /// Products without rows.
    ///
    /// # Errors
    /// Temporary files that cannot be created.
    pub(super) fn new(variants: &'a Variants, destination: &'a Destination) -> Result<Self, ProductError> {
        let schema = Schema::new(variants.sweep());
        let (csv, parquet) = (destination.local_file()?, destination.local_file()?);
        Ok(Self {
            table: TableWriter::create(&schema, csv.path(), parquet.path())?,
            gallery: Gallery::new(variants),
            variants,
            destination,
            schema,
            csv,
            parquet,
            tally: Tally::default(),
            seen: HashSet::new(),
        })
    }

    /// Returns the columns of the table.
    pub(super) fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Adds the row of the next variant, with its sketch if it was made and is in the gallery.
    ///
    /// # Errors
    /// A table that cannot be written, for example on a full disk.
    pub(super) fn push(&mut self, index: u64, row: Row, sketch: Option<Sketch>) -> Result<(), ProductError> {
        self.count(&row);
        self.gallery.add(index, &self.schema, &row, sketch);
        self.table.push(row)?;
        Ok(())
    }

    fn count(&mut self, row: &Row) {
        let cell = |name: &str| self.schema.cell(row, name);
        match cell("status").text() {
            Some("made") => self.tally.made += 1,
            Some("refused") => self.tally.refused += 1,
            _ => self.tally.failed += 1,
        }
        for part in self.schema.parts() {
            let hash = cell(&format!("{part}.sha256")).text();
            let hash = hash.and_then(|h| u64::from_str_radix(h.get(..16)?, 16).ok());
            let bytes = cell(&format!("{part}.bytes")).number();
            if let (Some(hash), Some(bytes)) = (hash, bytes) {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                self.tally.count_part(bytes as u64, self.seen.insert(hash));
            }
        }
    }

    /// Completes the table in `folder`, without plots and page; returns also the SHA-256 of its
    /// files by name.
    ///
    /// # Errors
    /// A table that cannot be written.
    pub(super) fn finish_table(
        self,
        folder: &str,
    ) -> Result<(Tally, BTreeMap<String, String>), ProductError> {
        self.table.finish()?;
        let mut hashes = BTreeMap::new();
        for (name, file) in TABLES.into_iter().zip([self.csv, self.parquet]) {
            hashes.insert(name.to_owned(), hash_of(file.path()).map_err(BatchTableError::from)?);
            self.destination.put_file(&format!("{folder}{name}"), file)?;
        }
        Ok((self.tally, hashes))
    }

    /// Completes table, plots and page.
    ///
    /// # Errors
    /// A product that cannot be drawn or written.
    pub(super) fn finish(mut self) -> Result<Tally, ProductError> {
        let gallery = std::mem::take(&mut self.gallery);
        let name = self.variants.sweep().name.clone();
        let destination = self.destination;
        let (tally, _) = self.finish_table("")?;
        let curves = curves_svg(&name, &gallery)?;
        let threshold = threshold_svg(&name, &gallery)?;
        let page = page(&name, &gallery, &tally, [&curves, &threshold]);
        for (name, text) in PRODUCTS.into_iter().zip([&curves, &threshold, &page]) {
            destination.put(name, text.as_bytes())?;
        }
        Ok(tally)
    }
}

/// Returns the SHA-256 of a file of any length.
fn hash_of(path: &Path) -> std::io::Result<String> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::ErrorKind::InvalidInput.into());
    }
    let mut file = std::fs::File::open(path)?;
    let (mut hash, mut buffer) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        match std::io::Read::read(&mut file, &mut buffer)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            n => hash.update(&buffer[..n]),
        }
    }
}
