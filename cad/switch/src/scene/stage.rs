//! Pictures of the steps of the assembly: present bodies in grey, and added bodies in colour, at a distance.

use crate::built::{Built, MeshedBody};
use crate::config::MountKind;
use crate::design::Design;
use crate::documents::BEARING_MM;
use crate::hardware::{Hardware, HardwareKind, hardware};
use crate::parts::{Part, Role, SPACER};
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::render::{Body, View};

/// A step of the assembly, named after the bodies that it adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The cut pins, alone.
    CutPins,
    /// The layer or the proxy, onto the shell.
    Bed,
    /// Inserts, into the shell.
    Inserts,
    /// Dowels, into the shell.
    Dowels,
    /// The left support.
    LeftSupport,
    /// The pins, into grooves and slots.
    Pins,
    /// The right support.
    RightSupport,
    /// The mounting plate.
    Mount,
    /// Screws and nuts.
    Fasteners,
    /// The guide pulleys, next to the switch.
    Pulley,
    /// The feet of the rig.
    Stand,
    /// The distal link of a joint, with washers and nut.
    Joint,
    /// The tendon.
    Tendon,
    /// Cell, drive and load of the rig.
    Drive,
}

/// Rotation of the switch, with grooves up, at which the outer face of the left support is visible.
const TURN_DEG: f64 = 38.0;
/// Elevation of the camera.
const RISE_DEG: f64 = 32.0;
/// The view of a rig with its table: from the front.
pub(super) const RIG_VIEW: View = View { turn_deg: -66.0, rise_deg: 24.0 };

/// Colours of present bodies, from the shell to the pins: neighbours have different greys.
const SHELL_GREY: [u8; 3] = [224, 224, 222];
const BED_GREY: [u8; 3] = [202, 204, 206];
const PLATE_GREY: [u8; 3] = [214, 214, 212];
const METAL_GREY: [u8; 3] = [158, 160, 164];
/// Colour of added steel: pins, screws, dowels.
const STEEL: [u8; 3] = [206, 72, 52];
/// Colour of the added tendon.
const TENDON: [u8; 3] = [38, 128, 96];
/// Colour of an added mount.
const MOUNT: [u8; 3] = [146, 118, 190];

/// Distances of added bodies from their positions, mm: support, layer, tendon and mounting plate.
const SUPPORT_APART_MM: f64 = 12.0;
const BED_APART_MM: f64 = 9.0;
const TENDON_APART_MM: f64 = 14.0;
const MOUNT_APART_MM: f64 = 24.0;
/// The same on the bolt of the rig: spacer, pulley with bearing, and washer with nut.
const SPACER_APART_MM: f64 = 26.0;
const PULLEY_APART_MM: f64 = 32.0;
const NUT_APART_MM: f64 = 44.0;
/// Distance of the feet of the rig, mm.
const FEET_APART_MM: f64 = 40.0;
/// The same on the axle of a joint: distal link, and washer with nut beyond it.
const DISTAL_APART_MM: f64 = 34.0;
const AXLE_NUT_APART_MM: f64 = 44.0;
/// Distance of spare pins, mm.
const SPARE_APART_MM: f64 = 5.0;
/// Distance of small hardware from its position, mm.
const SMALL_APART_MM: f64 = 6.0;

/// A body of a step in its position.
struct Item {
    mesh: Mesh,
    grey: [u8; 3],
    colour: [u8; 3],
    /// Displacement while its step adds it, in the frame of the assembly.
    apart: Vector3,
}

/// Returns the view of a step: from the side of the left support, unless a large plate would hide the added bodies.
pub fn stage_view(design: &Design, stage: Stage) -> View {
    if stage == Stage::Drive {
        return RIG_VIEW;
    }
    let is_hidden = match design.configuration().mount.kind {
        MountKind::Rig | MountKind::Flange => {
            matches!(stage, Stage::Mount | Stage::Pulley | Stage::Stand | Stage::Tendon)
        }
        // The distal link is outside the right support.
        MountKind::Joint => matches!(stage, Stage::Mount | Stage::Joint | Stage::Tendon),
        MountKind::None => false,
    };
    View { turn_deg: if is_hidden { -TURN_DEG } else { TURN_DEG }, rise_deg: RISE_DEG }
}

/// Returns the bodies of the picture of the last of `stages`.
pub fn stage_scene(built: &Built, stages: &[Stage]) -> Vec<Body> {
    let Some((now, before)) = stages.split_last() else { return Vec::new() };
    let done = before.iter().filter(|stage| **stage != Stage::CutPins).flat_map(|stage| items(built, *stage));
    let there = done.map(|item| Body { mesh: grooves_up(item.mesh), colour: item.grey });
    let added = items(built, *now).into_iter().map(|item| {
        let apart = if *now == Stage::CutPins { Vector3::zeros() } else { item.apart };
        Body { mesh: grooves_up(item.mesh.translated(apart)), colour: item.colour }
    });
    let shell = bodies(built, |role| role == Role::Shell)
        .map(|mesh| Body { mesh: grooves_up(mesh), colour: SHELL_GREY });
    // Cut pins are shown without the shell.
    let shell: Vec<Body> = if *now == Stage::CutPins { Vec::new() } else { shell.collect() };
    shell.into_iter().chain(there).chain(added).collect()
}

/// Rotates a mesh of the assembly so that the pulley's axis is horizontal, from left to right, and the grooves are up.
pub(super) fn grooves_up(mesh: Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| Point3::new(p.z, p.x, p.y)).collect();
    Mesh::new(turned, mesh.triangles)
}

/// Meshes of bodies in their positions in the assembly.
fn bodies(built: &Built, is_wanted: impl Fn(Role) -> bool) -> impl Iterator<Item = Mesh> {
    placed(built, move |part| is_wanted(part.role))
}

fn placed(built: &Built, is_wanted: impl Fn(&Part) -> bool) -> impl Iterator<Item = Mesh> {
    let place = |body: &MeshedBody| Some(body.part.pose?.apply(body.mesh.clone()));
    built.assembly().filter(move |body| is_wanted(&body.part)).filter_map(place)
}

/// Returns whether a part is added with the pulley, and not with the plate.
fn is_spacer(part: &Part) -> bool {
    part.name.starts_with(SPACER)
}

/// Returns the bodies that a step adds.
fn items(built: &Built, stage: Stage) -> Vec<Item> {
    let design = built.design();
    let z = |mm: f64| Vector3::new(0.0, 0.0, mm);
    let y = |mm: f64| Vector3::new(0.0, mm, 0.0);
    let of = |is_wanted: fn(Role) -> bool, grey, colour, apart| -> Vec<Item> {
        bodies(built, is_wanted).map(|mesh| Item { mesh, grey, colour, apart }).collect()
    };
    let is_pin = |role| matches!(role, Role::Pin { .. });
    let mount = |is_wanted: fn(&Part) -> bool, apart: Vector3| {
        let is_wanted = move |part: &Part| part.role == Role::Mount && is_wanted(part);
        placed(built, is_wanted).map(move |mesh| Item { mesh, grey: PLATE_GREY, colour: MOUNT, apart })
    };
    match stage {
        Stage::CutPins => {
            let mut cut = of(is_pin, METAL_GREY, STEEL, Vector3::zeros());
            cut.extend(spares(design, cut.first().map(|pin| &pin.mesh)));
            cut
        }
        Stage::Pins => of(is_pin, METAL_GREY, STEEL, z(design.pin_length_mm() + SMALL_APART_MM)),
        Stage::Bed => {
            let is_bed = |role| matches!(role, Role::Layer | Role::Proxy);
            let colour =
                if bodies(built, |r| r == Role::Layer).next().is_some() { Role::Layer } else { Role::Proxy };
            of(is_bed, BED_GREY, colour.colour(), y(BED_APART_MM))
        }
        Stage::LeftSupport => {
            let is_left = |role| matches!(role, Role::Support { outwards_z } if outwards_z < 0.0);
            let colour = Role::Support { outwards_z: -1.0 }.colour();
            of(is_left, PLATE_GREY, colour, z(-SUPPORT_APART_MM))
        }
        Stage::RightSupport => {
            let is_right = |role| matches!(role, Role::Support { outwards_z } if outwards_z > 0.0);
            let colour = Role::Support { outwards_z: 1.0 }.colour();
            of(is_right, PLATE_GREY, colour, z(SUPPORT_APART_MM))
        }
        Stage::Mount => {
            let plate = mount(|part| !is_spacer(part), z(-MOUNT_APART_MM));
            let is_in_plate = |kind| {
                matches!(
                    kind,
                    HardwareKind::Bolt
                        | HardwareKind::Axle
                        | HardwareKind::StopScrew
                        | HardwareKind::StopNut
                        | HardwareKind::SpliceBolt
                        | HardwareKind::SpliceNut
                )
            };
            plate.chain(bought(design, is_in_plate, |_| -MOUNT_APART_MM)).collect()
        }
        Stage::Pulley => {
            let colour = Role::Accessory.colour();
            let pulley = of(|role| role == Role::Accessory, PLATE_GREY, colour, z(PULLEY_APART_MM));
            let is_on_bolt =
                |kind| matches!(kind, HardwareKind::Bearing | HardwareKind::Washer | HardwareKind::BoltNut);
            let apart = |body: &Hardware| match body.kind {
                HardwareKind::Bearing => PULLEY_APART_MM - BEARING_MM,
                _ => NUT_APART_MM,
            };
            let bought = bought(design, is_on_bolt, apart);
            mount(is_spacer, z(SPACER_APART_MM)).chain(pulley).chain(bought).collect()
        }
        Stage::Stand => {
            let feet = stand(built, true, z(-FEET_APART_MM));
            let is_of_feet = |kind| {
                matches!(kind, HardwareKind::FootBolt | HardwareKind::FootWasher | HardwareKind::FootNut)
            };
            let apart = |body: &Hardware| match body.kind {
                HardwareKind::FootBolt => FEET_APART_MM,
                _ if body.from_right => SMALL_APART_MM,
                _ => -2.0 * FEET_APART_MM,
            };
            feet.into_iter().chain(bought(design, is_of_feet, apart)).collect()
        }
        Stage::Drive => {
            let is_of_drive = |kind| {
                matches!(
                    kind,
                    HardwareKind::Cell
                        | HardwareKind::CellBolt
                        | HardwareKind::EyeBolt
                        | HardwareKind::Line
                        | HardwareKind::Actuator
                        | HardwareKind::DriveBolt
                        | HardwareKind::DriveNut
                        | HardwareKind::Hook
                        | HardwareKind::Weight
                )
            };
            let parts = stand(built, false, Vector3::zeros());
            parts.into_iter().chain(bought(design, is_of_drive, |_| 0.0)).collect()
        }
        Stage::Joint => {
            let is_on_axle = |kind| matches!(kind, HardwareKind::AxleWasher | HardwareKind::AxleNut);
            // The first washer is between the links.
            let middle_mm = design.configuration().shell.width_mm / 2.0;
            let apart = |body: &Hardware| {
                let is_between = body.solid.bounds().is_some_and(|(low, _)| low.z < middle_mm);
                if is_between { SMALL_APART_MM } else { AXLE_NUT_APART_MM }
            };
            let mut all = of(|role| role == Role::DistalLink, PLATE_GREY, MOUNT, z(DISTAL_APART_MM));
            all.extend(bought(design, is_on_axle, apart));
            all
        }
        Stage::Tendon => of(|role| role == Role::Tendon, METAL_GREY, TENDON, y(TENDON_APART_MM)),
        Stage::Inserts => put_in(design, |kind| kind == HardwareKind::Insert),
        Stage::Dowels => put_in(design, |kind| kind == HardwareKind::Dowel),
        Stage::Fasteners => put_in(design, |kind| matches!(kind, HardwareKind::Screw | HardwareKind::Nut)),
    }
}

/// The feet of a rig, or its cell mount and drive.
fn stand(built: &Built, are_feet: bool, apart: Vector3) -> Vec<Item> {
    let is_wanted =
        move |part: &Part| part.role == Role::Stand && part.name.starts_with("rig-foot") == are_feet;
    placed(built, is_wanted).map(|mesh| Item { mesh, grey: PLATE_GREY, colour: MOUNT, apart }).collect()
}

/// Spare pins, next to the outermost pin.
fn spares(design: &Design, pin: Option<&Mesh>) -> Vec<Item> {
    let number = design.configuration().pins.spares;
    let aside = |i: usize| Vector3::new(-SPARE_APART_MM * (i + 1) as f64, 0.0, 0.0);
    let spare = |pin: &Mesh, i| Item {
        mesh: pin.clone().translated(aside(i)),
        grey: METAL_GREY,
        colour: STEEL,
        apart: Vector3::zeros(),
    };
    pin.into_iter().flat_map(|pin| (0..number).map(move |i| spare(pin, i))).collect()
}

/// Bought bodies of some kinds, each at a distance along the axis.
fn bought(
    design: &Design,
    is_wanted: impl Fn(HardwareKind) -> bool,
    apart_mm: impl Fn(&Hardware) -> f64,
) -> Vec<Item> {
    let item = |body: Hardware| {
        let mesh = body.solid.mesh(design.tolerance()).ok()?;
        let apart = Vector3::new(0.0, 0.0, apart_mm(&body));
        Some(Item { mesh, grey: METAL_GREY, colour: STEEL, apart })
    };
    hardware(design).into_iter().filter(|body| is_wanted(body.kind)).filter_map(item).collect()
}

/// Bought bodies that are put in from outside: each at its length and [`SMALL_APART_MM`].
fn put_in(design: &Design, is_wanted: impl Fn(HardwareKind) -> bool) -> Vec<Item> {
    bought(design, is_wanted, |body| {
        let length = body.solid.bounds().map_or(0.0, |(low, high)| high.z - low.z);
        let apart = match body.kind {
            HardwareKind::Nut => SUPPORT_APART_MM,
            _ => length + SMALL_APART_MM,
        };
        if body.from_right { apart } else { -apart }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;

    const ALL: [Stage; 13] = [
        Stage::CutPins,
        Stage::Bed,
        Stage::Inserts,
        Stage::Dowels,
        Stage::LeftSupport,
        Stage::Pins,
        Stage::RightSupport,
        Stage::Mount,
        Stage::Fasteners,
        Stage::Pulley,
        Stage::Stand,
        Stage::Tendon,
        Stage::Drive,
    ];

    fn built(text: &str) -> Built {
        Built::new(Design::new(read(text, "x.toml").unwrap().0).unwrap()).unwrap()
    }

    #[test]
    fn every_step_adds_bodies_and_keeps_others() {
        let full = built(
            "[layout]\npins = [5, 8, 11]\n[fasteners]\nkind = \"insert\"\ndowel_diameter_mm = 2.0\n[mount]\nkind = \"rig\"\n[tendon]\nsheath_diameter_mm = 3.0\n",
        );
        for number in 1..=ALL.len() {
            let bodies = stage_scene(&full, &ALL[..number]);
            let before = stage_scene(&full, &ALL[..number - 1]).len();
            assert!(bodies.len() > before || number == 2, "{:?}", ALL[number - 1]);
            let is_grey = |c: &[u8; 3]| c[0].abs_diff(c[2]) < 8 && c[0].abs_diff(c[1]) < 8;
            assert!(bodies.iter().any(|b| !is_grey(&b.colour)), "{:?} adds nothing", ALL[number - 1]);
            assert!(number == 1 || is_grey(&bodies[0].colour), "the shell is there");
        }
        let joint = built("[mount]\nkind = \"joint\"\n");
        let [plate, link] = [Stage::Mount, Stage::Joint].map(|stage| items(&joint, stage).len());
        assert_eq!((plate, link), (2, 4), "link and axle, then link, washers and nut");
        // Bodies that the configuration does not have are not drawn.
        let plain = built("");
        for stage in [
            Stage::Inserts,
            Stage::Dowels,
            Stage::Mount,
            Stage::Pulley,
            Stage::Stand,
            Stage::Drive,
            Stage::Joint,
        ] {
            assert!(items(&plain, stage).is_empty(), "{stage:?}");
        }
    }
}
