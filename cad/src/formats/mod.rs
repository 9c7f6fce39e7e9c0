//! Files beside the STL: what slicers, CAD programs and workshops open.

mod drawing;
mod dxf;
mod plate;
mod step;
mod three_mf;

pub use drawing::drawing_svg;
pub use dxf::dxf;
pub use plate::lay_out;
pub use step::{Placement, StepPart, step_assembly, step_part};
pub use three_mf::{Object, Package, ThreeMfError, three_mf};
