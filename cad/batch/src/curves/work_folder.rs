//! The hidden folder of a run, next to its output: finished blocks, and a record of inputs and output.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use pinswitch_store::{FolderLock, LockPolicy, read_own, remove_temporaries, temporary_in};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{CurveTableError, CurveTally, file_error};
use crate::checksum::{has_valid_checksum, with_checksum};
use crate::{hexadecimal, parallel};

/// Name of the record.
const RECORD: &str = "rows.json";
/// Name and version of the record's schema.
const SCHEMA: &str = "pinswitch.curves/1";
/// Begin of the names of blocks.
const BLOCK: &str = "block";
/// Most bytes of a record.
const MAX_RECORD: u64 = 1 << 16;
/// Most bytes of a block that is read.
const MAX_BLOCK: u64 = 1 << 30;

/// The content of the record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Record {
    schema: String,
    generator: String,
    /// SHA-256 of everything that determines the output.
    inputs_sha256: String,
    /// The output, if it is finished.
    output: Option<FinishedOutput>,
}

/// A finished output.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct FinishedOutput {
    pub(super) sha256: String,
    pub(super) tally: CurveTally,
}

/// A finished block. Its name contains its totals and the SHA-256 of its content.
#[derive(Clone, Debug)]
pub(super) struct FinishedBlock {
    name: String,
    pub(super) tally: CurveTally,
    sha256: String,
}

impl FinishedBlock {
    fn new(number: u64, tally: CurveTally, bytes: &[u8]) -> Self {
        let sha256 = hexadecimal(&Sha256::digest(bytes));
        let CurveTally { predicted, refused, failed } = tally;
        let name = format!("{BLOCK}-{number:08}-{predicted}-{refused}-{failed}-{sha256}");
        Self { name, tally, sha256 }
    }

    /// Returns the number of the block with this name, and the block.
    fn from_name(name: &str) -> Option<(u64, Self)> {
        let parts: Vec<&str> = name.split('-').collect();
        let [BLOCK, number, predicted, refused, failed, sha256] = parts[..] else { return None };
        let count = |text: &str| text.parse::<u64>().ok();
        let tally =
            CurveTally { predicted: count(predicted)?, refused: count(refused)?, failed: count(failed)? };
        Some((count(number)?, Self { name: name.to_owned(), tally, sha256: sha256.to_owned() }))
    }
}

/// The locked folder.
pub(super) struct WorkFolder {
    lock: FolderLock,
    inputs_sha256: String,
}

impl WorkFolder {
    /// Returns the folder for an output: `.curves.csv.work` for `curves.csv`.
    pub(super) fn path(out: &Path) -> PathBuf {
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        out.with_file_name(format!(".{name}.work"))
    }

    /// Locks the folder for an output from these inputs.
    pub(super) fn lock(
        out: &Path,
        inputs_sha256: String,
        policy: LockPolicy,
    ) -> Result<Self, CurveTableError> {
        let path = Self::path(out);
        let lock = FolderLock::take(&path, policy).map_err(file_error(&path))?;
        Ok(Self { lock, inputs_sha256 })
    }

    fn folder(&self) -> &Path {
        self.lock.folder()
    }

    /// Returns the record of a run with the same inputs.
    fn record(&self) -> Result<Option<Record>, CurveTableError> {
        let path = self.folder().join(RECORD);
        let bytes = read_own(&path, MAX_RECORD).map_err(file_error(&path))?.unwrap_or_default();
        let record = serde_json::from_slice::<Record>(&bytes).ok().filter(|_| has_valid_checksum(&bytes));
        Ok(record.filter(|r| r.schema == SCHEMA && r.inputs_sha256 == self.inputs_sha256))
    }

    /// Returns the output of an earlier run that has finished it.
    pub(super) fn finished(&self) -> Result<Option<FinishedOutput>, CurveTableError> {
        Ok(self.record()?.and_then(|record| record.output))
    }

    /// Returns the intact blocks of an earlier run with the same inputs, by their numbers. Removes everything else.
    pub(super) fn resume(&self) -> Result<BTreeMap<u64, FinishedBlock>, CurveTableError> {
        if self.record()?.is_none() {
            self.lock.clear().map_err(file_error(self.folder()))?;
            self.write_record(None)?;
        }
        remove_temporaries(self.folder()).map_err(file_error(self.folder()))?;
        let entries = std::fs::read_dir(self.folder()).map_err(file_error(self.folder()))?;
        let names = entries.filter_map(|e| e.ok()?.file_name().into_string().ok());
        let named: Vec<_> = names.filter_map(|name| FinishedBlock::from_name(&name)).collect();
        let checked = parallel::try_map(&named, |(number, block)| {
            let is_intact = hexadecimal(&Sha256::digest(self.read(block)?)) == block.sha256;
            if !is_intact {
                let path = self.folder().join(&block.name);
                std::fs::remove_file(&path).map_err(file_error(&path))?;
            }
            Ok::<_, CurveTableError>(is_intact.then(|| (*number, block.clone())))
        })?;
        Ok(checked.into_iter().flatten().collect())
    }

    /// Returns the bytes of a block.
    pub(super) fn read(&self, block: &FinishedBlock) -> Result<Vec<u8>, CurveTableError> {
        let path = self.folder().join(&block.name);
        let bytes = read_own(&path, MAX_BLOCK).map_err(file_error(&path))?;
        bytes.ok_or_else(|| file_error(&path)(std::io::ErrorKind::NotFound.into()))
    }

    /// Writes a block.
    pub(super) fn write(
        &self,
        number: u64,
        tally: CurveTally,
        bytes: &[u8],
    ) -> Result<FinishedBlock, CurveTableError> {
        let block = FinishedBlock::new(number, tally, bytes);
        self.put(&block.name, bytes)?;
        Ok(block)
    }

    /// Records the finished output, then removes the blocks.
    pub(super) fn finish(
        &self,
        output: FinishedOutput,
        blocks: &BTreeMap<u64, FinishedBlock>,
    ) -> Result<(), CurveTableError> {
        self.write_record(Some(output))?;
        blocks.values().try_for_each(|block| {
            let path = self.folder().join(&block.name);
            std::fs::remove_file(&path).map_err(file_error(&path))
        })
    }

    fn write_record(&self, output: Option<FinishedOutput>) -> Result<(), CurveTableError> {
        let record = Record {
            schema: SCHEMA.to_owned(),
            generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
            inputs_sha256: self.inputs_sha256.clone(),
            output,
        };
        let path = self.folder().join(RECORD);
        let bytes = serde_json::to_vec_pretty(&record).map_err(|e| file_error(&path)(e.into()))?;
        self.put(RECORD, &with_checksum(bytes))
    }

    /// Gives a complete file its name.
    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), CurveTableError> {
        let path = self.folder().join(name);
        let write = || {
            let mut file = temporary_in(self.folder())?;
            file.write_all(bytes)?;
            file.persist(&path).map_err(|e| e.error).map(drop)
        };
        write().map_err(file_error(&path))
    }
}
