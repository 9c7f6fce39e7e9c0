//! STL: binary files written, binary and ASCII files read.

mod ascii;
mod binary;
mod error;
mod facets;
mod file_type;
mod read;
mod vertex_map;
mod write;

pub use error::StlError;
pub use facets::StlFile;
pub use read::read_stl;
pub use write::stl_bytes;
