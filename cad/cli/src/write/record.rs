//! The files that earlier runs have written into a folder, from its manifest and from the journal of a killed run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path};

use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::set::MANIFEST;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::WriteError;
use pinswitch_store::{JOURNAL, read_own};

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
    /// Reads the manifest and the journal of `folder`. A manifest of another program is ignored.
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
        if let Some(bytes) = read(JOURNAL)?
            && let Ok(killed) = serde_json::from_slice::<Self>(&bytes)
        {
            // The killed run is later than the run that wrote the manifest.
            record.source = killed.source.or(record.source);
            for (name, hashes) in killed.files {
                hashes.into_iter().for_each(|hash| record.add(&name, hash));
            }
        }
        Ok(record)
    }

    /// Returns the record with `files` added.
    pub(super) fn with(&self, files: &[OutputFile], source: &SourceEntry) -> Self {
        let mut all = self.clone();
        all.source = Some(source.clone());
        files.iter().for_each(|file| all.add(&file.name, sha256(&file.bytes)));
        all
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

/// Whether `name` is a plain file name, not a path.
pub(super) fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(only)), None) if only == name)
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
