//! Warnings of parts, each with a change that was tested: they need both the parts and the search for feasible values.

mod left_out;
mod thin_walls;
mod warning;

pub use warning::Warning;
