//! The files that the last run has written into a folder, from its manifest.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::set::MANIFEST;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::WriteError;
use pinswitch_store::{is_plain, read_own};

/// Files that pinswitch wrote, with the SHA-256 of each content that it gave them, and their source.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) source: Option<SourceEntry>,
    pub(super) files: BTreeMap<String, BTreeSet<String>>,
}

/// The part of a manifest that is read.
#[derive(Deserialize)]
struct Listing {
    schema: String,
    source: Option<SourceEntry>,
    files: Vec<ListedFile>,
}

#[derive(Deserialize)]
struct ListedFile {
    file: String,
    sha256: String,
}

impl Record {
    /// Reads the manifest of `folder`. A manifest of another program is ignored.
    ///
    /// # Errors
    /// [`WriteError`] if one of them exists and cannot be read.
    pub(super) fn read(folder: &Path) -> Result<Self, WriteError> {
        let mut record = Self::default();
        let read = |name: &str| {
            let path = folder.join(name);
            read_existing(&path).map_err(WriteError::at(&path))
        };
        if let Some(bytes) = read(MANIFEST)?
            && let Ok(listing) = serde_json::from_slice::<Listing>(&bytes)
            && listing.schema.starts_with("pinswitch.set/")
        {
            record.source = listing.source;
            record.add(MANIFEST, sha256(&bytes));
            listing.files.into_iter().for_each(|file| record.add(&file.file, file.sha256));
        }
        Ok(record)
    }

    /// Whether pinswitch gave the file this content.
    pub(super) fn wrote(&self, name: &str, bytes: &[u8]) -> bool {
        self.files.get(name).is_some_and(|hashes| hashes.contains(&sha256(bytes)))
    }

    /// Adds a file. A manifest is foreign text: entries with a path are ignored.
    fn add(&mut self, name: &str, hash: String) {
        if is_plain(name) {
            self.files.entry(name.to_owned()).or_default().insert(hash);
        }
    }
}

/// Returns the source of the set in the folder of `file`, if its manifest lists the file with this content.
pub(crate) fn source_of_set_with(file: &Path, bytes: &[u8]) -> Option<SourceEntry> {
    let record = Record::read(file.parent()?).ok()?;
    record.wrote(file.file_name()?.to_str()?, bytes).then_some(record.source)?
}

/// Longest file under a name of pinswitch that is read, in bytes: some times the largest part.
const MAX_EXISTING: u64 = 4 << 30;

/// Reads a file under a name that pinswitch gives; `None` if it does not exist.
///
/// # Errors
/// As [`read_own`].
pub(super) fn read_existing(path: &Path) -> std::io::Result<Option<Vec<u8>>> {
    read_own(path, MAX_EXISTING)
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
