//! Compares the files of a variant with its manifest, before a run reuses them and before a merge
//! counts them.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use serde::Deserialize;
use sha2::{Digest, Sha256};

use super::checksum::has_valid_checksum;
use super::content::content_path;
use super::destination::{Destination, DestinationError};
use super::hexadecimal;
use super::make::variant_folder;

/// The parts of a variant's manifest that are read.
#[derive(Debug, Deserialize)]
pub(super) struct VariantListing {
    /// The batch in which it was made.
    pub(super) batch: ListedBatch,
    /// The slicer's estimate.
    pub(super) print: Option<serde_json::Value>,
    /// All its files.
    pub(super) files: Vec<ListedFile>,
}

/// The batch in a manifest.
#[derive(Debug, Deserialize)]
pub(super) struct ListedBatch {
    pub(super) sweep_sha256: String,
    pub(super) index: u64,
}

/// A file in a manifest.
#[derive(Debug, Deserialize)]
pub(super) struct ListedFile {
    pub(super) file: String,
    bytes: u64,
    sha256: String,
    content: Option<String>,
}

/// Checks the variants of one destination; a file that many variants share is read once.
pub(super) struct Inspector<'a> {
    destination: &'a Destination,
    /// Whether the part with these first 64 bits of its hash is intact.
    checked: Mutex<HashMap<u64, bool>>,
}

impl<'a> Inspector<'a> {
    /// An inspector that has not checked any file yet.
    pub(super) fn new(destination: &'a Destination) -> Self {
        Self { destination, checked: Mutex::new(HashMap::new()) }
    }

    /// Reads the manifest of a variant; `None` if it is missing or was changed.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn manifest(&self, id: &str) -> Result<Option<(Vec<u8>, VariantListing)>, DestinationError> {
        let bytes = self.destination.get(&format!("{}/manifest.json", variant_folder(id)))?;
        Ok(bytes.filter(|bytes| has_valid_checksum(bytes)).and_then(|bytes| {
            let listing = serde_json::from_slice(&bytes).ok()?;
            Some((bytes, listing))
        }))
    }

    /// Returns the first file of the variant that is missing or has changed.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn damaged<'l>(
        &self,
        id: &str,
        listing: &'l VariantListing,
    ) -> Result<Option<&'l str>, DestinationError> {
        let folder = variant_folder(id);
        for file in &listing.files {
            if !self.is_intact(&folder, file)? {
                return Ok(Some(&file.file));
            }
        }
        Ok(None)
    }

    fn is_intact(&self, folder: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let name = format!("{folder}/{}", file.file);
        if let Some(content) = &file.content {
            if *content != content_path(&file.sha256) || !self.is_part_intact(content, file)? {
                return Ok(false);
            }
            // A store contains the part only, and a link is the part.
            if !self.destination.has_links() || self.destination.is_same(content, &name) {
                return Ok(true);
            }
        }
        self.has_hash(&name, file)
    }

    fn is_part_intact(&self, content: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let key = file.sha256.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok());
        let Some(key) = key else { return Ok(false) };
        if let Some(is_intact) = self.checked.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Ok(*is_intact);
        }
        // Objects of a store are never partly written, and reading costs money: their size is
        // enough.
        let is_intact = if self.destination.has_links() {
            self.has_hash(content, file)?
        } else {
            self.destination.size(content)? == Some(file.bytes)
        };
        self.checked.lock().unwrap_or_else(PoisonError::into_inner).insert(key, is_intact);
        Ok(is_intact)
    }

    fn has_hash(&self, name: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let bytes = self.destination.get(name)?;
        Ok(bytes.is_some_and(|bytes| file.sha256 == hexadecimal(&Sha256::digest(&bytes))))
    }
}
