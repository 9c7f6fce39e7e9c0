//! Files of any solid or mesh: STL, 3MF, STEP, DXF and GLB, as bytes.

mod dxf;
mod glb;
mod plate;
mod step;
mod stl;
mod three_mf;

pub use dxf::dxf;
pub use glb::{GlbBody, GlbError, GlbMaterial, glb};
pub use plate::{BED_EDGE_MM, Box3, PART_GAP_MM, Placement, lay_out, needed_bed_mm};
pub use step::{StepPart, step_assembly, step_part};
pub use stl::{StlError, StlFile, read_stl, stl_bytes};
pub use three_mf::{
    BaseMaterial, Object, Package, PackagedMesh, PlacedMesh, ThreeMf, ThreeMfError, ThreeMfReadError,
    read_three_mf, three_mf,
};
