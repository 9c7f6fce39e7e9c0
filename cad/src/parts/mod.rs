//! The parts of a switch: exact solids in print orientation, and where each one sits in the assembly.

mod coupon;
mod guide_pulley;
mod label;
mod layer;
mod mould;
mod sector;
mod shell;
mod stroke_font;
mod support;

use serde::Serialize;

use crate::config::{ConfigError, MouldKind, SubstrateKind};
use crate::design::Design;
use crate::mesh::{Mesh, Vector3};
use crate::profile::{Contour, OffsetError, polar};
use crate::solid::{CapError, Facing, Solid};
use crate::validity::Expectation;

pub use layer::silicone_layer;
pub use mould::cavity_mm3;
pub use sector::Sector;

/// What a part is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Material {
    /// Printed.
    Abs,
    /// Cast.
    Silicone,
    /// Bought.
    Steel,
}

/// How a part is turned from print orientation into the assembly, about the pulley's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Whether the part is turned half round about the y axis.
    pub flipped: bool,
    /// Height of the part's origin in the assembly, mm.
    pub z_mm: f64,
}

impl Pose {
    const fn upright(z_mm: f64) -> Self {
        Self { flipped: false, z_mm }
    }

    /// `mesh`, brought from print orientation (about the axis) into the assembly.
    pub fn apply(&self, mesh: Mesh) -> Mesh {
        let turned = if self.flipped { mesh.flipped_about_y() } else { mesh };
        turned.translated(Vector3::new(0.0, 0.0, self.z_mm))
    }
}

/// One body: an exact solid, standing on z = 0 in print orientation, the pulley's axis at the origin.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name, and stem of its file.
    pub name: String,
    /// What it is made of.
    pub material: Material,
    /// The exact solid.
    pub solid: Solid,
    /// Where it sits in the assembly; `None` for tools such as the mould.
    pub pose: Option<Pose>,
    /// What a person should know about it.
    pub notes: Vec<String>,
}

impl Part {
    fn new(name: impl Into<String>, solid: Solid, pose: Option<Pose>) -> Self {
        Self { name: name.into(), material: Material::Abs, solid, pose, notes: Vec::new() }
    }

    /// What its mesh is held against: one body, and the exact volume within what the chord tolerance allows.
    pub fn expectation(&self, design: &Design) -> Expectation {
        let bound = self.solid.volume_bound_mm3(design.tolerance());
        Expectation {
            bodies: Some(1),
            volume_mm3: Some((self.solid.volume_mm3(), bound)),
            ..Expectation::default()
        }
    }

    /// Widest ceiling to be bridged when it is printed, mm: over all faces that look down from above the bed, the shorter
    /// side of their bounding box. 0 without any.
    pub fn widest_bridge_mm(&self) -> f64 {
        let rings: Vec<(&Contour, f64)> = self.solid.rings().collect();
        let bed = self.solid.bounds().map_or(0.0, |(low, _)| low.z);
        self.solid
            .caps()
            .filter(|(facing, _)| *facing == Facing::Down)
            .filter_map(|(_, members)| members.first().map(|outline| rings[*outline]))
            .filter(|(_, z_mm)| *z_mm > bed + 1e-9)
            .map(|(contour, _)| {
                let (low, high) = contour.bounds();
                (high.x - low.x).min(high.y - low.y)
            })
            .fold(0.0, f64::max)
    }

    /// The mesh about the pulley's axis, standing on z = 0.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        self.solid.mesh(design.tolerance())
    }

    /// The mesh as it is written: the middle of its bounding box on the z axis, standing on z = 0.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn print_mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        let mesh = self.mesh(design)?;
        let shift = self.solid.bounds().map_or(Vector3::zeros(), |(low, high)| {
            let middle = nalgebra::center(&low, &high);
            Vector3::new(-middle.x, -middle.y, -low.z)
        });
        Ok(mesh.translated(shift))
    }
}

/// Every printed part that `design` asks for.
///
/// # Errors
/// [`ConfigError`] if a chamfer, draft or offset swallows an edge.
pub fn printed(design: &Design) -> Result<Vec<Part>, ConfigError> {
    let c = design.configuration();
    let mut parts = vec![shell::shell(design)?];
    match (c.layout.substrate, c.mould.kind) {
        (SubstrateKind::Abs, _) | (_, MouldKind::None) => {}
        (SubstrateKind::Silicone, MouldKind::OnePiece) => parts.push(mould::one_piece(design)?),
        (SubstrateKind::Silicone, MouldKind::Split) => parts.extend(mould::split(design)?),
    }
    parts.extend(support::pair(design)?);
    if c.parts.proxy || c.layout.substrate == SubstrateKind::Abs {
        parts.push(layer::proxy(design)?);
    }
    if c.parts.coupon {
        parts.push(coupon::coupon(design)?);
    }
    if c.parts.guide_pulley {
        parts.push(guide_pulley::guide_pulley(design)?);
    }
    Ok(parts)
}

/// The bodies that are not printed, for the assembly and the bill of materials: layer and pins.
///
/// # Errors
/// [`ConfigError`] if an offset swallows an edge.
pub fn reference_bodies(design: &Design) -> Result<Vec<Part>, ConfigError> {
    let c = design.configuration();
    let mut bodies = Vec::new();
    if c.layout.substrate == SubstrateKind::Silicone {
        bodies.push(silicone_layer(design)?);
    }
    let z_mm = (c.shell.width_mm - design.pin_length_mm()) / 2.0;
    for (pin, angle) in design.pin_angles_rad().into_iter().enumerate() {
        let outline = Contour::circle(polar(design.contact_radius_mm(), angle), c.pins.diameter_mm / 2.0);
        let solid = Solid::prism(&outline, &[], 0.0, design.pin_length_mm(), 0.0)
            .map_err(swallowed("pins.diameter_mm"))?;
        let mut part = Part::new(format!("pin-{}", pin + 1), solid, Some(Pose::upright(z_mm)));
        part.material = Material::Steel;
        bodies.push(part);
    }
    Ok(bodies)
}

/// The complaint about `field` when an offset that depends on it swallows an edge.
fn swallowed(field: &'static str) -> impl Fn(OffsetError) -> ConfigError {
    move |e| ConfigError {
        field: field.to_owned(),
        value: None,
        problem: format!("is too large for this geometry: {e}"),
        remedy: format!("lower {field}"),
        place: None,
    }
}

/// Clockwise circles on `radius_mm` at `angles_rad`, for holes.
fn holes_at(radius_mm: f64, angles_rad: &[f64], hole_radius_mm: f64) -> Vec<Contour> {
    angles_rad.iter().map(|a| Contour::circle(polar(radius_mm, *a), hole_radius_mm).reversed()).collect()
}

#[cfg(test)]
mod tests;
