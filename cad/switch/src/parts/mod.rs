//! The parts of a switch: exact solids in print orientation, with their poses in the assembly.
//!
//! A printed part is one file and one entry of [`PRINTED_PARTS`].

mod bed;
mod coupon;
mod fastening;
mod guide_pulley;
mod joint;
mod label;
mod layer;
mod letter_shape;
mod marks;
mod mould;
mod mount;
mod omission;
mod part;
mod rig;
mod sector;
mod shell;
mod stroke_font;
mod support;
mod tendon;

use crate::config::{ConfigError, Configuration, DriveKind, Location, MouldKind, MountKind, field_location};
use crate::design::Design;
use pinswitch_diagnostic::codes;
use pinswitch_friction::Substrate;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Contour, OffsetError, polar};
use pinswitch_solid::solid::Solid;

pub use bed::fit_on_bed;
pub(crate) use bed::{can_be_printed, room_on_bed};
pub(crate) use joint::{DISTAL, PROXIMAL};
pub use layer::silicone_layer;
pub use mould::cavity_mm3;
pub(crate) use mould::{CAST_LAYER, CAST_OVERFILL, CAST_SPRUE, CAST_VENT, cast, keys};
pub(crate) use mount::SPACER;
pub use mount::spacer_mm;
pub use omission::LeftOut;
pub use part::{Part, Role, Substance};
pub(crate) use rig::{cell_bolts, cell_length_mm, front_mm, middle_mm, stand_holes};
pub use sector::Sector;
pub(crate) use stroke_font::{HEIGHT as LETTER_HEIGHT, WIDTH as LETTER_WIDTH, strokes as letter_strokes};
pub(crate) use tendon::RIG_END_MM;
pub use tendon::{Touch, tendon_at_flexion, touches};

/// A printed part: which configurations have it, and how it is built.
pub struct PrintedPart {
    /// Name, and stem of its files.
    pub name: &'static str,
    /// Whether a configuration has it.
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
        is_wanted: |c| c.parts.guide_pulley || rig::is_rig(c),
        build: guide_pulley::guide_pulley,
    },
    PrintedPart {
        name: "guide-pulley-2",
        is_wanted: rig::has_drive_pulley,
        build: guide_pulley::drive_pulley,
    },
    PrintedPart {
        name: "base-flange",
        is_wanted: |c| mount::has_plate(c, MountKind::Flange),
        build: mount::plate,
    },
    PrintedPart {
        name: PROXIMAL,
        is_wanted: |c| mount::has_plate(c, MountKind::Joint),
        build: joint::proximal_link,
    },
    PrintedPart {
        name: DISTAL,
        is_wanted: |c| mount::has_plate(c, MountKind::Joint),
        build: joint::distal_link,
    },
    PrintedPart { name: "rig-plate", is_wanted: rig::is_rig, build: rig::left_board },
    PrintedPart { name: "rig-plate-2", is_wanted: rig::has_joint, build: rig::right_board },
    PrintedPart { name: "rig-splice", is_wanted: rig::has_joint, build: rig::splice },
    PrintedPart { name: SPACER, is_wanted: rig::is_rig, build: mount::spacer },
    PrintedPart { name: "pulley-spacer-2", is_wanted: rig::has_drive_pulley, build: mount::drive_spacer },
    PrintedPart { name: "rig-foot-left", is_wanted: rig::is_rig, build: rig::left_foot },
    PrintedPart { name: "rig-foot-right", is_wanted: rig::is_rig, build: rig::right_foot },
    PrintedPart { name: "cell-mount", is_wanted: rig::is_rig, build: rig::cell_mount },
    PrintedPart {
        name: "actuator-foot",
        is_wanted: |c| rig::has_drive(c, DriveKind::Actuator),
        build: rig::actuator_foot,
    },
    PrintedPart {
        name: "crank-foot",
        is_wanted: |c| rig::has_drive(c, DriveKind::Crank),
        build: rig::crank_foot,
    },
    PrintedPart {
        name: "crank-drum",
        is_wanted: |c| rig::has_drive(c, DriveKind::Crank),
        build: rig::crank_drum,
    },
    PrintedPart {
        name: "crank-knob",
        is_wanted: |c| rig::has_drive(c, DriveKind::Crank),
        build: rig::crank_knob,
    },
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

/// Builds every printed part of `design`.
///
/// # Errors
/// A diagnostic of the field whose chamfer, draft or offset leaves nothing of an edge; without help, as [`Design::new`].
pub fn printed(design: &Design) -> Result<Vec<Part>, ConfigError> {
    printed_of(design, |_| true)
}

/// Builds the printed parts of `design` whose name is chosen.
///
/// # Errors
/// As [`printed`], of the chosen parts only.
pub fn printed_of(
    design: &Design,
    is_chosen: impl Fn(&'static str) -> bool,
) -> Result<Vec<Part>, ConfigError> {
    let c = design.configuration();
    let wanted = PRINTED_PARTS.iter().filter(|p| is_chosen(p.name) && (p.is_wanted)(c));
    wanted.map(|p| (p.build)(design).map_err(|error| with_value(error, c))).collect()
}

/// The error with the value of its field.
fn with_value(error: ConfigError, c: &Configuration) -> ConfigError {
    let Some(field) = error.location().and_then(|location| location.field.clone()) else { return error };
    let location = Location { value: c.shown(&field), field: Some(field), ..Location::default() };
    error.with_location(location)
}

/// Builds one printed part by its name; `None` if the design does not have it.
pub(crate) fn printed_part(name: &str, design: &Design) -> Option<Result<Part, ConfigError>> {
    let part = PRINTED_PARTS.iter().find(|p| p.name == name && (p.is_wanted)(design.configuration()))?;
    Some((part.build)(design))
}

/// Builds the bodies that are not printed, for the assembly and the bill of materials: layer, pins and tendon.
///
/// # Errors
/// As [`printed`].
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

/// Returns the error of `field` when an offset that depends on it leaves nothing of an edge.
fn offset_error(field: &'static str) -> impl Fn(OffsetError) -> ConfigError {
    move |e| {
        ConfigError::new(codes::SHAPE_CANNOT_BE_BUILT, format!("too large for this geometry: {e}"))
            .with_location(field_location(field))
    }
}

/// Returns clockwise circles on `radius_mm` at `angles_rad`, for holes.
fn holes_at(radius_mm: f64, angles_rad: &[f64], hole_radius_mm: f64) -> Vec<Contour> {
    angles_rad.iter().map(|a| Contour::circle(polar(radius_mm, *a), hole_radius_mm).reversed()).collect()
}

/// Returns all features that a design leaves out, each with its part. No part is built for it.
pub(crate) fn left_out_features(design: &Design) -> Vec<(&'static str, LeftOut)> {
    let c = design.configuration();
    let on = |part: &'static str, lost: Vec<LeftOut>| lost.into_iter().map(move |feature| (part, feature));
    let core = (has_split_mould(c) && mould::core_has_lost_label(design)).then_some(LeftOut::Label);
    let plate = if c.mount.kind == MountKind::None { Vec::new() } else { mount::left_out(design) };
    on("shell", shell::left_out(design))
        .chain(on("mould-core", core.into_iter().collect()))
        .chain(on("support-left", support::left_out(design, support::Side::Left)))
        .chain(on("support-right", support::left_out(design, support::Side::Right)))
        .chain(on("plate", plate))
        .collect()
}

#[cfg(test)]
mod assembly_tests;
#[cfg(test)]
mod joint_tests;
#[cfg(test)]
pub(crate) mod sections;
#[cfg(test)]
mod tests;
