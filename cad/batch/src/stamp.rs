//! `batch.json`: which sweep a destination holds, with all that is needed to resume it.

use pinswitch_diagnostic::excerpt;
use serde::{Deserialize, Serialize};

use super::destination::{Destination, DestinationError};
use super::seal::{is_sealed, seal};
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
    #[error(
        "{place} holds no batch: there is no {STAMP}; give a folder or bucket that `pinswitch batch` has written to"
    )]
    Missing {
        /// The destination.
        place: String,
    },
    /// The stamp cannot be read.
    #[error("{place}/{STAMP}: {}; restore it, or give another --out", excerpt(problem, 240))]
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
    /// [`StampError`] if there is none, or it is not as it was written.
    pub fn read(destination: &Destination) -> Result<Self, StampError> {
        let (stamp, is_intact) = Self::found(destination)?;
        if is_intact {
            return Ok(stamp);
        }
        let problem = "it was changed or damaged since it was written".to_owned();
        Err(StampError::Unreadable { place: destination.name(), problem })
    }

    /// The stamp at `destination`, and whether it is as it was written.
    fn found(destination: &Destination) -> Result<(Self, bool), StampError> {
        let place = destination.name();
        let bytes = destination.get(STAMP)?.ok_or(StampError::Missing { place: place.clone() })?;
        let stamp: Self = serde_json::from_slice(&bytes)
            .map_err(|e| StampError::Unreadable { place, problem: e.to_string() })?;
        let is_intact =
            is_sealed(&bytes) && stamp.schema == SCHEMA && stamp.source.digest() == stamp.sweep_sha256;
        Ok((stamp, is_intact))
    }

    /// Whether `destination` already holds this sweep, and its stamp is as it was written.
    ///
    /// # Errors
    /// [`StampError`] if it holds anything else.
    pub(super) fn refuse_foreign(&self, destination: &Destination) -> Result<bool, StampError> {
        let place = destination.name();
        let found = match Self::found(destination) {
            Err(StampError::Missing { .. }) if destination.is_empty()? => return Ok(false),
            // Another shard may have stamped it since it was looked for.
            Err(StampError::Missing { .. }) => Self::found(destination),
            found => found,
        };
        match found {
            Ok((there, is_intact)) if there.sweep_sha256 == self.sweep_sha256 => {
                Ok(is_intact && there.variants == self.variants)
            }
            Ok((there, _)) => {
                // A damaged stamp may be of any length.
                let name = there.source.name.chars().take(80).collect();
                Err(StampError::OtherSweep { place, name })
            }
            Err(StampError::Missing { place }) => Err(StampError::NotEmpty { place }),
            Err(e) => Err(e),
        }
    }

    /// Stamps an empty destination; returns whether it already held this sweep. A stamp of this sweep that was damaged
    /// is written again.
    ///
    /// # Errors
    /// [`StampError`] if it holds anything else.
    pub fn put(&self, destination: &Destination) -> Result<bool, StampError> {
        // Another shard may stamp it at the same time: both write the same.
        let was_there = destination.get(STAMP)?.is_some();
        if self.refuse_foreign(destination)? {
            return Ok(true);
        }
        if was_there {
            log::warn!("{}/{STAMP}: it was changed or damaged, and is written again", destination.name());
        }
        let unwritable = |e: serde_json::Error| StampError::Unreadable {
            place: destination.name(),
            problem: e.to_string(),
        };
        let bytes = serde_json::to_vec_pretty(self).map_err(unwritable)?;
        destination.put(STAMP, &seal(bytes))?;
        Ok(was_there)
    }
}
