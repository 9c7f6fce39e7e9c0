//! The check of a whole STL or 3MF file: detection of the format, examination of every mesh in it, and a
//! [`Verdict`] for a purpose.

mod format;
mod judgement;
mod verdict;

pub use judgement::{Judgement, Purpose, Status};
pub use verdict::{PartVerdict, Verdict};
