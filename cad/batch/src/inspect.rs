//! Whether the files of a variant are what its manifest says: before a run keeps them, and before a merge counts them.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use serde::Deserialize;
use sha2::{Digest, Sha256};

use super::content::content_path;
use super::destination::{Destination, DestinationError};
use super::hexadecimal;
use super::make::variant_folder;
use super::seal::is_sealed;

/// What is read of a variant's manifest.
#[derive(Debug, Deserialize)]
pub(super) struct VariantListing {
    /// The batch that it was made in.
    pub(super) batch: ListedBatch,
    /// What a slicer said of it.
    pub(super) print: Option<serde_json::Value>,
    /// All its files.
    pub(super) files: Vec<ListedFile>,
}

/// The batch of a manifest.
#[derive(Debug, Deserialize)]
pub(super) struct ListedBatch {
    pub(super) sweep_sha256: String,
    pub(super) index: u64,
}

/// A file of a manifest.
#[derive(Debug, Deserialize)]
pub(super) struct ListedFile {
    pub(super) file: String,
    bytes: u64,
    sha256: String,
    content: Option<String>,
}

/// Looks at the variants of one destination; what many share is read once.
pub(super) struct Inspector<'a> {
    destination: &'a Destination,
    /// Whether the content with these first digits of its hash is whole.
    known: Mutex<HashMap<u64, bool>>,
}

impl<'a> Inspector<'a> {
    /// For a destination of which nothing is known.
    pub(super) fn new(destination: &'a Destination) -> Self {
        Self { destination, known: Mutex::new(HashMap::new()) }
    }

    /// The manifest of a variant with its bytes; `None` if there is none, or not the one that was written.
    ///
    /// # Errors
    /// [`DestinationError`] if it cannot be read.
    pub(super) fn manifest(&self, id: &str) -> Result<Option<(Vec<u8>, VariantListing)>, DestinationError> {
        let bytes = self.destination.get(&format!("{}/manifest.json", variant_folder(id)))?;
        Ok(bytes.filter(|bytes| is_sealed(bytes)).and_then(|bytes| {
            let listing = serde_json::from_slice(&bytes).ok()?;
            Some((bytes, listing))
        }))
    }

    /// The first file of the variant that is missing or has changed.
    ///
    /// # Errors
    /// [`DestinationError`] if one cannot be read.
    pub(super) fn damaged<'l>(
        &self,
        id: &str,
        listing: &'l VariantListing,
    ) -> Result<Option<&'l str>, DestinationError> {
        let folder = variant_folder(id);
        for file in &listing.files {
            if !self.is_whole(&folder, file)? {
                return Ok(Some(&file.file));
            }
        }
        Ok(None)
    }

    fn is_whole(&self, folder: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let name = format!("{folder}/{}", file.file);
        if let Some(content) = &file.content {
            if *content != content_path(&file.sha256) || !self.is_content_whole(content, file)? {
                return Ok(false);
            }
            // A store has the content only; a link is the content.
            if !self.destination.links() || self.destination.is_same(content, &name) {
                return Ok(true);
            }
        }
        self.has_hash(&name, file)
    }

    fn is_content_whole(&self, content: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let key = file.sha256.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok());
        let Some(key) = key else { return Ok(false) };
        if let Some(whole) = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Ok(*whole);
        }
        // A store's objects are never half written, and cost money to read: their size is enough.
        let whole = if self.destination.links() {
            self.has_hash(content, file)?
        } else {
            self.destination.size(content)? == Some(file.bytes)
        };
        self.known.lock().unwrap_or_else(PoisonError::into_inner).insert(key, whole);
        Ok(whole)
    }

    fn has_hash(&self, name: &str, file: &ListedFile) -> Result<bool, DestinationError> {
        let found = self.destination.get(name)?;
        Ok(found.is_some_and(|bytes| file.sha256 == hexadecimal(&Sha256::digest(&bytes))))
    }
}
