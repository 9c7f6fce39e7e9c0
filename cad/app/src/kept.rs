//! What is kept of the designs asked about last: most changes leave the curve, and most parts, as they are.

use pinswitch_solid::solid::CapCache;
use pinswitch_switch::built::Built;

use crate::predicted::Predictions;

/// Corners of caps that are kept, at 50 bytes: those of a coarse and an exact design with all its parts, and of some more.
const CORNERS: usize = 100_000;

/// Curves, parts, and the triangulated caps of parts.
#[derive(Debug)]
pub(crate) struct Kept {
    pub(crate) predictions: Predictions,
    pub(crate) caps: CapCache,
    /// The last coarse design: those that follow while something moves have most of its parts.
    pub(crate) built: Option<Built>,
}

impl Default for Kept {
    fn default() -> Self {
        Self { predictions: Predictions::default(), caps: CapCache::new(CORNERS), built: None }
    }
}
