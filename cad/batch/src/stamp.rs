//! `batch.json`: the sweep of a destination, with everything that is needed to resume it.

use std::error::Error;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::checksum::{has_valid_checksum, with_checksum};
use super::destination::{Destination, DestinationError};
use super::diagnostics::diagnostic_error;
use super::source::SweepSource;

/// Name of the stamp's file.
pub(super) const STAMP: &str = "batch.json";
/// Name and version of the stamp's schema.
const SCHEMA: &str = "pinswitch.batch/1";

/// The stamp of a destination: the content of `batch.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Stamp {
    /// Name and version of this file's schema.
    pub schema: String,
    /// Program and version.
    pub generator: String,
    /// [`SweepSource::digest`].
    pub sweep_sha256: String,
    /// Number of variants of the whole sweep.
    pub variants: u64,
    /// The texts of the sweep.
    pub source: SweepSource,
}

/// Why a destination cannot be used for a sweep.
#[derive(Debug)]
pub enum StampError {
    /// It contains another sweep.
    OtherSweep {
        /// The destination.
        place: String,
        /// Name of the sweep there.
        name: String,
    },
    /// It contains other files.
    NotEmpty {
        /// The destination.
        place: String,
    },
    /// It does not contain a batch.
    Missing {
        /// The destination.
        place: String,
    },
    /// The stamp is malformed, damaged or inconsistent.
    Invalid {
        /// The destination.
        place: String,
        /// What is wrong.
        problem: String,
        /// The error of the JSON library.
        source: Option<serde_json::Error>,
    },
    /// The destination cannot be read or written.
    Destination(DestinationError),
}

impl StampError {
    /// Returns whether the cause is the user's input, rather than a system that refuses a valid path.
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, Self::Destination(error) if error.is_refusal())
    }

    pub(super) fn diagnostic(&self) -> Diagnostic {
        const UNCHANGED: &str = "nothing was changed";
        match self {
            Self::OtherSweep { place, name } => {
                Diagnostic::new(codes::OTHER_SWEEP, format!("{place} contains another sweep ({name:?})"))
                    .with_help(format!(
                        "give another --out, or the options of that batch, such as --verify ({UNCHANGED})"
                    ))
            }
            Self::NotEmpty { place } => Diagnostic::new(
                codes::NOT_A_BATCH_FOLDER,
                format!("{place} is not empty and not a batch folder ({STAMP} not found)"),
            )
            .with_help(format!("give an empty or new --out ({UNCHANGED})")),
            Self::Missing { place } => Diagnostic::new(
                codes::NOT_A_BATCH_FOLDER,
                format!("{place} is not a batch folder ({STAMP} not found)"),
            )
            .with_help("give a folder or bucket that `pinswitch batch` has written"),
            Self::Invalid { place, problem, .. } => Diagnostic::new(codes::CHANGED_FILE, problem)
                .with_location(Location::file(format!("{place}/{STAMP}")))
                .with_help("restore it, or give another --out"),
            Self::Destination(error) => error.clone().into(),
        }
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Invalid { source, .. } => source.as_ref().map(|source| source as _),
            Self::Destination(error) => error.source(),
            Self::OtherSweep { .. } | Self::NotEmpty { .. } | Self::Missing { .. } => None,
        }
    }
}

diagnostic_error!(StampError);

impl From<DestinationError> for StampError {
    fn from(error: DestinationError) -> Self {
        Self::Destination(error)
    }
}

impl Stamp {
    /// The stamp of a sweep with this number of variants.
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
    /// A destination without a stamp, and a stamp that was changed since it was written.
    pub fn read(destination: &Destination) -> Result<Self, StampError> {
        let (stamp, is_intact) = Self::read_unchecked(destination)?;
        if is_intact {
            return Ok(stamp);
        }
        let problem = "it was changed or damaged since it was written".to_owned();
        Err(StampError::Invalid { place: destination.name(), problem, source: None })
    }

    /// Reads the stamp at `destination`; returns also whether it is unchanged since it was written.
    fn read_unchecked(destination: &Destination) -> Result<(Self, bool), StampError> {
        let place = destination.name();
        let bytes = destination.get(STAMP)?.ok_or(StampError::Missing { place: place.clone() })?;
        let stamp: Self = serde_json::from_slice(&bytes).map_err(|e| StampError::Invalid {
            place,
            problem: e.to_string(),
            source: Some(e),
        })?;
        let is_intact = has_valid_checksum(&bytes)
            && stamp.schema == SCHEMA
            && stamp.source.digest() == stamp.sweep_sha256;
        Ok((stamp, is_intact))
    }

    /// Returns whether `destination` contains this sweep already, with an intact stamp; `false` if
    /// it is empty.
    ///
    /// # Errors
    /// A destination with anything else.
    pub(super) fn check(&self, destination: &Destination) -> Result<bool, StampError> {
        let place = destination.name();
        let existing = match Self::read_unchecked(destination) {
            Err(StampError::Missing { .. }) if destination.is_empty()? => return Ok(false),
            // Another shard may have written the stamp in the meantime.
            Err(StampError::Missing { .. }) => Self::read_unchecked(destination),
            other => other,
        };
        match existing {
            Ok((stamp, is_intact)) if stamp.sweep_sha256 == self.sweep_sha256 => {
                Ok(is_intact && stamp.variants == self.variants)
            }
            Ok((stamp, _)) => {
                // A damaged stamp may contain a name of any length.
                let name = stamp.source.name.chars().take(80).collect();
                Err(StampError::OtherSweep { place, name })
            }
            Err(StampError::Missing { place }) => Err(StampError::NotEmpty { place }),
            Err(e) => Err(e),
        }
    }

    /// Writes the stamp; returns whether the destination contained this sweep already. A damaged
    /// stamp of this sweep is replaced.
    ///
    /// # Errors
    /// The stamp cannot be written.
    pub fn write(&self, destination: &Destination) -> Result<bool, StampError> {
        // Another shard may write the stamp at the same time: both write the same bytes.
        let existed = destination.get(STAMP)?.is_some();
        if self.check(destination)? {
            return Ok(true);
        }
        if existed {
            log::warn!("{}/{STAMP} was changed or damaged; it is written again", destination.name());
        }
        let bytes = serde_json::to_vec_pretty(self).map_err(|e| StampError::Invalid {
            place: destination.name(),
            problem: e.to_string(),
            source: Some(e),
        })?;
        destination.put(STAMP, &with_checksum(bytes))?;
        Ok(existed)
    }
}
