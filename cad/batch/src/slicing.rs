//! What a slicer says of the parts of variants: equal parts with equal settings are sliced once.

use std::sync::Arc;

use quick_cache::sync::Cache;

use pinswitch_slicer::{PreparedSlicer, PrintEstimate, PrintSettings, Slicer, SlicerError};
use pinswitch_switch::config::Configuration;
use pinswitch_switch::documents::PrintEntry;

/// Settings kept in the cache, each a small folder.
const CACHED_SETTINGS: usize = 32;
/// Estimates kept in the cache, about 200 bytes each.
const CACHED_ESTIMATES: usize = 50_000;

/// A slicer with all that it has said so far. Threads that need the same answer wait for the first.
pub(super) struct VariantSlicer<'a> {
    slicer: &'a Slicer,
    prepared: Cache<String, Arc<PreparedSlicer>>,
    known: Cache<(String, String), PrintEstimate>,
}

impl<'a> VariantSlicer<'a> {
    pub(super) fn new(slicer: &'a Slicer) -> Self {
        Self { slicer, prepared: Cache::new(CACHED_SETTINGS), known: Cache::new(CACHED_ESTIMATES) }
    }

    /// What the parts of a variant take, printed one by one: each with its name, the hash of its bytes, and how to get these.
    ///
    /// # Errors
    /// Those of `bytes`, and [`SlicerError`] with what the slicer said.
    pub(super) fn entry<E: From<SlicerError>>(
        &self,
        configuration: &Configuration,
        parts: &[(&str, &str)],
        bytes: impl Fn(&str) -> Result<Vec<u8>, E>,
    ) -> Result<PrintEntry, E> {
        let settings = PrintSettings::of(configuration);
        let key = settings.options().join(" ");
        let prepare = || self.slicer.clone().prepared(&settings).map(Arc::new);
        let prepared = self.prepared.get_or_insert_with(&key, prepare)?;
        let estimate = |(name, sha256): &(&str, &str)| {
            let of = (key.clone(), (*sha256).to_owned());
            self.known
                .get_or_insert_with(&of, || Ok(prepared.slice(&format!("{name}.stl"), &bytes(sha256)?)?))
        };
        let total: PrintEstimate =
            parts.iter().map(estimate).collect::<Result<Vec<_>, E>>()?.into_iter().sum();
        let PrintEstimate { print_minutes, filament_g, filament_m } = total;
        let slicer = prepared.version().to_owned();
        Ok(PrintEntry { of: "parts", slicer, print_minutes, filament_g, filament_m })
    }
}
