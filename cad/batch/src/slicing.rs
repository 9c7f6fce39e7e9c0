//! Estimates of a slicer for the parts of variants: equal parts with equal settings are sliced
//! once.

use std::sync::Arc;

use quick_cache::sync::Cache;

use pinswitch_slicer::{PreparedSlicer, PrintEstimate, PrintSettings, Slicer, SlicerError};
use pinswitch_switch::config::Configuration;
use pinswitch_switch::documents::PrintEntry;

/// Settings in the cache, each a small folder.
const CACHED_SETTINGS: usize = 32;
/// Estimates in the cache, about 200 bytes each.
const CACHED_ESTIMATES: usize = 50_000;

/// A slicer with a cache of its estimates. Threads that need the same estimate wait for the first
/// one.
pub(super) struct VariantSlicer<'a> {
    slicer: &'a Slicer,
    prepared: Cache<String, Arc<PreparedSlicer>>,
    estimates: Cache<(String, String), PrintEstimate>,
}

impl<'a> VariantSlicer<'a> {
    pub(super) fn new(slicer: &'a Slicer) -> Self {
        Self { slicer, prepared: Cache::new(CACHED_SETTINGS), estimates: Cache::new(CACHED_ESTIMATES) }
    }

    /// Estimates the parts of a variant, printed one by one. Parts are names with the hashes of
    /// their bytes, which `bytes` reads.
    ///
    /// # Errors
    /// Those of `bytes`, and [`SlicerError`] with the slicer's message.
    pub(super) fn entry<E: From<SlicerError>>(
        &self,
        configuration: &Configuration,
        parts: &[(&str, &str)],
        bytes: impl Fn(&str) -> Result<Vec<u8>, E>,
    ) -> Result<PrintEntry, E> {
        let settings = PrintSettings::from_configuration(configuration);
        let key = settings.options().join(" ");
        let prepare = || self.slicer.clone().prepared(&settings).map(Arc::new);
        let prepared = self.prepared.get_or_insert_with(&key, prepare)?;
        let estimate = |(name, sha256): &(&str, &str)| {
            let part = (key.clone(), (*sha256).to_owned());
            self.estimates
                .get_or_insert_with(&part, || Ok(prepared.slice(&format!("{name}.stl"), &bytes(sha256)?)?))
        };
        let total: PrintEstimate =
            parts.iter().map(estimate).collect::<Result<Vec<_>, E>>()?.into_iter().sum();
        let PrintEstimate { print_minutes, filament_g, filament_m } = total;
        let slicer = prepared.version().to_owned();
        Ok(PrintEntry { of: "parts", slicer, print_minutes, filament_g, filament_m })
    }
}
