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
use super::make::{CURVE, variant_folder};

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

/// The result of comparing the files of a variant with its manifest.
#[derive(Debug)]
pub(super) struct Inspection<'l> {
    /// The first file that is missing or has changed.
    pub(super) damaged: Option<&'l str>,
    /// The bytes of the curve's table, if it is intact.
    pub(super) curve: Option<Vec<u8>>,
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

    /// Compares the files of the variant with its manifest, up to the first that is missing or has
    /// changed.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub(super) fn inspect<'l>(
        &self,
        id: &str,
        listing: &'l VariantListing,
    ) -> Result<Inspection<'l>, DestinationError> {
        let folder = variant_folder(id);
        let mut curve = None;
        for file in &listing.files {
            if file.content.is_none() && file.file == CURVE {
                curve = self.intact_bytes(&format!("{folder}/{}", file.file), file)?;
                if curve.is_none() {
                    return Ok(Inspection { damaged: Some(&file.file), curve });
                }
            } else if !self.is_intact(&folder, file)? {
                return Ok(Inspection { damaged: Some(&file.file), curve });
            }
        }
        Ok(Inspection { damaged: None, curve })
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
        Ok(self.intact_bytes(name, file)?.is_some())
    }

    /// Returns the bytes of a file with the hash of its entry; `None` if it is missing or has
    /// changed.
    fn intact_bytes(&self, name: &str, file: &ListedFile) -> Result<Option<Vec<u8>>, DestinationError> {
        let bytes = self.destination.get(name)?;
        Ok(bytes.filter(|bytes| file.sha256 == hexadecimal(&Sha256::digest(bytes))))
    }
}
