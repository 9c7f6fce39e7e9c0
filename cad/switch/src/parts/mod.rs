//! The parts of a switch: exact solids in print orientation, and where each one sits in the assembly.
//!
//! A printed part is one file and one entry of [`PRINTED_PARTS`].

mod bed;
mod coupon;
mod fastening;
mod guide_pulley;
mod label;
mod layer;
mod left_out;
mod marks;
mod mould;
mod mount;
mod omission;
mod part;
mod sector;
mod shell;
mod stroke_font;
mod support;
mod tendon;
mod thin_walls;

use crate::config::{ConfigError, Configuration, MouldKind, MountKind};
use crate::design::Design;
use crate::design::rules::{Change, Effort, ways_out};
use pinswitch_friction::Substrate;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Contour, OffsetError, polar};
use pinswitch_solid::solid::Solid;

pub(crate) use bed::can_be_printed;
pub use bed::fit_on_bed;
pub use layer::silicone_layer;
pub(crate) use mould::keys;
pub use mould::{cavity_mm3, gang_mm};
pub(crate) use mount::SPACER;
pub use mount::spacer_mm;
pub use omission::LeftOut;
pub use part::{Material, Part, Role};
pub use sector::Sector;
pub use tendon::{Touch, touches};

/// A printed part: when a configuration asks for it, and how it is built.
pub struct PrintedPart {
    /// Name, and stem of its files.
    pub name: &'static str,
    /// Whether a configuration asks for it.
    pub is_wanted: fn(&Configuration) -> bool,
    build: fn(&Design) -> Result<Part, ConfigError>,
}

/// Every printed part, in the order in which a set lists them.
pub const PRINTED_PARTS: &[PrintedPart] = &[
    PrintedPart { name: "shell", is_wanted: |_| true, build: shell::shell },
    PrintedPart { name: "mould-core", is_wanted: has_split_mould, build: mould::core },
    PrintedPart { name: "mould-ring", is_wanted: has_split_mould, build: mould::ring },
    PrintedPart { name: "mould-lid", is_wanted: has_split_mould, build: mould::lid },
    PrintedPart { name: "mould-tray", is_wanted: has_tray, build: mould::one_piece },
    PrintedPart { name: "support-left", is_wanted: |_| true, build: support::left },
    PrintedPart { name: "support-right", is_wanted: |_| true, build: support::right },
    PrintedPart { name: "proxy", is_wanted: |c| c.parts.proxy || is_rigid(c), build: layer::proxy },
    PrintedPart { name: "coupon", is_wanted: |c| c.parts.coupon, build: coupon::coupon },
    PrintedPart {
        name: "guide-pulley",
        is_wanted: |c| c.parts.guide_pulley || mount::has_plate(c, MountKind::Rig),
        build: guide_pulley::guide_pulley,
    },
    PrintedPart {
        name: "base-flange",
        is_wanted: |c| mount::has_plate(c, MountKind::Flange),
        build: mount::plate,
    },
    PrintedPart {
        name: "finger-link",
        is_wanted: |c| mount::has_plate(c, MountKind::FingerLink),
        build: mount::plate,
    },
    PrintedPart {
        name: "rig-plate",
        is_wanted: |c| mount::has_plate(c, MountKind::Rig),
        build: mount::plate,
    },
    PrintedPart { name: SPACER, is_wanted: |c| mount::has_plate(c, MountKind::Rig), build: mount::spacer },
    PrintedPart { name: "sheath-stop", is_wanted: mount::has_sheath_stop, build: mount::sheath_stop },
];

fn is_rigid(c: &Configuration) -> bool {
    c.layout.substrate == Substrate::Abs
}

fn has_split_mould(c: &Configuration) -> bool {
    !is_rigid(c) && c.mould.kind == MouldKind::Split
}

fn has_tray(c: &Configuration) -> bool {
    !is_rigid(c) && c.mould.kind == MouldKind::OnePiece
}

/// Every printed part that `design` asks for.
///
/// # Errors
/// [`ConfigError`] if a chamfer, draft or offset swallows an edge, with the nearest value that swallows none.
pub fn printed(design: &Design) -> Result<Vec<Part>, ConfigError> {
    all_printed(design).map_err(|error| swallowing(error, design.configuration()))
}

fn all_printed(design: &Design) -> Result<Vec<Part>, ConfigError> {
    let wanted = PRINTED_PARTS.iter().filter(|p| (p.is_wanted)(design.configuration()));
    wanted.map(|p| (p.build)(design)).collect()
}

/// Fields of which a contour's offset depends, so that too large a value swallows an edge.
const OFFSETS: [&str; 5] = [
    "print.elephant_foot_mm",
    "mould.key_height_mm",
    "mould.pour_width_mm",
    "segment.groove_radius_mm",
    "support.corner_radius_mm",
];

/// The error about an offset that swallows an edge, with the present value and the largest one below it that swallows none.
fn swallowing(error: ConfigError, c: &Configuration) -> ConfigError {
    let Some(field) = OFFSETS.into_iter().find(|field| *field == error.field) else { return error };
    let is_built =
        |c: &Configuration| Design::new(c.clone()).is_ok_and(|design| all_printed(&design).is_ok());
    let (remedy, changes) = ways_out(field, c, &[Change::Lower(field)], &is_built, Effort::THOROUGH);
    let error = ConfigError { value: c.shown(field), ..error };
    if remedy.is_empty() { error } else { ConfigError { remedy, changes, ..error } }
}

/// One printed part by its name; `None` where it is not asked for or cannot be built.
fn printed_part(name: &str, design: &Design) -> Option<Part> {
    let part = PRINTED_PARTS.iter().find(|p| p.name == name && (p.is_wanted)(design.configuration()))?;
    (part.build)(design).ok()
}

/// The bodies that are not printed, for the assembly and the bill of materials: layer, pins and tendon.
///
/// # Errors
/// [`ConfigError`] if an offset swallows an edge.
pub fn reference_bodies(design: &Design) -> Result<Vec<Part>, ConfigError> {
    let c = design.configuration();
    let mut bodies = Vec::new();
    if !is_rigid(c) {
        bodies.push(silicone_layer(design)?);
    }
    let z_mm = -design.pin_overhang_mm();
    for (index, angle) in design.pin_angles_rad().into_iter().enumerate() {
        let outline = Contour::circle(polar(design.contact_radius_mm(), angle), c.pins.diameter_mm / 2.0);
        let solid = Solid::prism(&outline, &[], 0.0, design.pin_length_mm(), 0.0)
            .map_err(offset_error("pins.diameter_mm"))?;
        let pose = Some(Pose::upright(z_mm));
        bodies.push(Part::new(format!("pin-{}", index + 1), Role::Pin { index }, solid, pose));
    }
    bodies.push(tendon::tendon(design));
    Ok(bodies)
}

/// The error about `field` when an offset that depends on it swallows an edge.
fn offset_error(field: &'static str) -> impl Fn(OffsetError) -> ConfigError {
    move |e| ConfigError {
        field: field.to_owned(),
        value: None,
        problem: format!("is too large for this geometry: {e}"),
        remedy: format!("lower {field}"),
        changes: Vec::new(),
        place: None,
    }
}

/// Clockwise circles on `radius_mm` at `angles_rad`, for holes.
fn holes_at(radius_mm: f64, angles_rad: &[f64], hole_radius_mm: f64) -> Vec<Contour> {
    angles_rad.iter().map(|a| Contour::circle(polar(radius_mm, *a), hole_radius_mm).reversed()).collect()
}

#[cfg(test)]
mod assembly_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod zz_study;
