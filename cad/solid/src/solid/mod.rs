//! Solids of contours at heights: walls between two rings, and flat caps with holes.
//!
//! A [`Solid`] gives its volume in closed form and its mesh. The mesh is watertight by
//! construction, because walls and caps share the vertices of their rings by index.

mod cap;
mod cap_cache;
mod content;
mod definition;
mod frame;
mod tessellate;
mod thin_places;
mod volume;
mod wall_section;

pub use cap::CapError;
pub use cap_cache::CapCache;
pub use definition::{Facing, RingId, Solid};
pub use thin_places::ThinPlace;
