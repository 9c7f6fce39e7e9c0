//! `batch.json`: which sweep a destination holds, with all that is needed to resume it.

use serde::{Deserialize, Serialize};

use super::destination::{Destination, DestinationError};
use super::source::SweepSource;

/// Name of the stamp.
pub(super) const STAMP: &str = "batch.json";
/// Name and version of the stamp's schema.
const SCHEMA: &str = "pinswitch.batch/1";

/// The stamp of a destination.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Name and version of this file's schema.
    pub schema: String,
    /// Program and version.
    pub generator: String,
    /// [`SweepSource::digest`].
    pub sweep_sha256: String,
    /// Number of variants of the whole sweep.
    pub variants: u64,
    /// What the sweep is made of.
    pub source: SweepSource,
}

/// Why a destination cannot be used for a sweep.
#[derive(Debug, thiserror::Error)]
pub enum StampError {
    /// It holds another sweep.
    #[error("{place} holds another sweep ({name:?}); give another --out, nothing was changed")]
    OtherSweep {
        /// The destination.
        place: String,
        /// Name of the sweep there.
        name: String,
    },
    /// It holds something else.
    #[error("{place} holds files that are no batch; give an empty or new --out, nothing was changed")]
    NotEmpty {
        /// The destination.
        place: String,
    },
    /// It holds no batch.
    #[error("{place} holds no batch: there is no {STAMP}")]
    Missing {
        /// The destination.
        place: String,
    },
    /// The stamp cannot be read.
    #[error("{place}/{STAMP}: {problem}; give another --out")]
    Unreadable {
        /// The destination.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// It cannot be read or written.
    #[error(transparent)]
    Destination(#[from] DestinationError),
}

impl Stamp {
    /// The stamp of a sweep.
    pub fn new(source: &SweepSource, variants: u64) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
            sweep_sha256: source.digest(),
            variants,
            source: source.clone(),
        }
    }

    /// Reads the stamp at `destination`.
    ///
    /// # Errors
    /// [`StampError`] if there is none.
    pub fn read(destination: &Destination) -> Result<Self, StampError> {
        let place = destination.name();
        let bytes = destination.get(STAMP)?.ok_or(StampError::Missing { place: place.clone() })?;
        serde_json::from_slice(&bytes).map_err(|e| StampError::Unreadable { place, problem: e.to_string() })
    }

    /// Stamps an empty destination; returns whether it already held this sweep.
    ///
    /// # Errors
    /// [`StampError`] if it holds anything else.
    pub fn put(&self, destination: &Destination) -> Result<bool, StampError> {
        // Another shard may stamp it at the same time: what counts is what is there in the end.
        if destination.get(STAMP)?.is_none() && destination.is_empty()? {
            let unwritable = |e: serde_json::Error| StampError::Unreadable {
                place: destination.name(),
                problem: e.to_string(),
            };
            let mut bytes = serde_json::to_vec_pretty(self).map_err(unwritable)?;
            bytes.push(b'\n');
            destination.put(STAMP, &bytes)?;
            return Ok(false);
        }
        let place = destination.name();
        match Self::read(destination) {
            Ok(there) if there.sweep_sha256 == self.sweep_sha256 => Ok(true),
            Ok(there) => Err(StampError::OtherSweep { place, name: there.source.name }),
            Err(StampError::Missing { place }) => Err(StampError::NotEmpty { place }),
            Err(e) => Err(e),
        }
    }
}
