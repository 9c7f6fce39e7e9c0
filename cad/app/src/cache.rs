//! Results of the last designs, since most changes leave the curve and most parts unchanged.

use pinswitch_solid::solid::CapCache;
use pinswitch_switch::built::Built;

use crate::prediction_cache::PredictionCache;

/// Corners of caps in the cache, at 50 bytes: a coarse and an exact design with all parts, and some
/// more.
const CAP_CORNERS: usize = 100_000;

/// Curves, parts, and the triangulated caps of parts.
#[derive(Debug)]
pub(crate) struct Cache {
    pub(crate) predictions: PredictionCache,
    pub(crate) caps: CapCache,
    /// The last coarse design: the designs of one drag share most of its parts.
    pub(crate) built: Option<Built>,
}

impl Default for Cache {
    fn default() -> Self {
        Self { predictions: PredictionCache::default(), caps: CapCache::new(CAP_CORNERS), built: None }
    }
}
