//! Steps of the assembly as pictures: what is there already in grey, what the step adds apart from it and in colour.

use super::rig_hardware::{in_the_plate, on_the_bolt};
use crate::built::{Built, MeshedBody};
use crate::config::MountKind;
use crate::design::Design;
use crate::documents::{BEARING_MM, bill_of_materials};
use crate::parts::{Part, Role, SPACER};
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::profile::{Contour, Point2, polar};
use pinswitch_solid::render::{Body, View};
use pinswitch_solid::solid::Solid;

/// A step of the assembly, by what it adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Pins are cut: they lie alone.
    CutPins,
    /// The layer, or the proxy, comes onto the shell.
    Bed,
    /// Inserts go into the shell.
    Inserts,
    /// Dowels go into the shell.
    Dowels,
    /// The left support.
    LeftSupport,
    /// The pins come into grooves and slots.
    Pins,
    /// The right support.
    RightSupport,
    /// What the switch is mounted by.
    Mount,
    /// Screws and nuts.
    Fasteners,
    /// The guide pulley, beside the switch.
    Pulley,
    /// The tendon.
    Tendon,
}

/// Turn of the switch, grooves up and left support on the left, so that the outer face of the left support is seen.
const TURN_DEG: f64 = 38.0;
/// Height of the eye.
const RISE_DEG: f64 = 32.0;

/// Colours of what is there already, from the shell to the pins: greys, so that neighbours can be told apart.
const SHELL_GREY: [u8; 3] = [224, 224, 222];
const BED_GREY: [u8; 3] = [202, 204, 206];
const PLATE_GREY: [u8; 3] = [214, 214, 212];
pub(super) const METAL_GREY: [u8; 3] = [158, 160, 164];
/// Colour of steel that a step adds: pins, screws, dowels.
pub(super) const STEEL: [u8; 3] = [206, 72, 52];
/// Colour of the tendon when it is added.
const TENDON: [u8; 3] = [38, 128, 96];
/// Colour of a mount when it is added.
const MOUNT: [u8; 3] = [146, 118, 190];

/// How far parts are shown from their place, mm: a support, a layer, the tendon, a mounting plate, small hardware.
const SUPPORT_APART_MM: f64 = 12.0;
const BED_APART_MM: f64 = 9.0;
const TENDON_APART_MM: f64 = 14.0;
const MOUNT_APART_MM: f64 = 24.0;
/// The spacer of the rig's pulley, the pulley with its bearing, washer and nut: one after the other on the bolt.
const SPACER_APART_MM: f64 = 26.0;
const PULLEY_APART_MM: f64 = 32.0;
const NUT_APART_MM: f64 = 44.0;
/// Pins to spare, beside the others.
const SPARE_APART_MM: f64 = 5.0;
const SMALL_APART_MM: f64 = 6.0;

/// A body of a step in its place.
pub(super) struct Item {
    pub(super) mesh: Mesh,
    pub(super) grey: [u8; 3],
    pub(super) colour: [u8; 3],
    /// How far it is shown from its place while its step adds it, in the assembly's frame.
    pub(super) apart: Vector3,
}

/// Where the eye stands: on the side of the left support, but where a large plate in front of it would hide what a step shows.
pub fn stage_view(design: &Design, stage: Stage) -> View {
    let is_hidden = matches!(design.configuration().mount.kind, MountKind::Rig | MountKind::Flange)
        && matches!(stage, Stage::Mount | Stage::Pulley | Stage::Tendon);
    View { turn_deg: if is_hidden { -TURN_DEG } else { TURN_DEG }, rise_deg: RISE_DEG }
}

/// The picture's bodies for the last of `stages`, with all of those before it done.
pub fn stage_scene(built: &Built, stages: &[Stage]) -> Vec<Body> {
    let Some((now, before)) = stages.split_last() else { return Vec::new() };
    let done = before.iter().filter(|stage| **stage != Stage::CutPins).flat_map(|stage| items(built, *stage));
    let there = done.map(|item| Body { mesh: lying(item.mesh), colour: item.grey });
    let added = items(built, *now).into_iter().map(|item| {
        let apart = if *now == Stage::CutPins { Vector3::zeros() } else { item.apart };
        Body { mesh: lying(item.mesh.translated(apart)), colour: item.colour }
    });
    let shell =
        bodies(built, |role| role == Role::Shell).map(|mesh| Body { mesh: lying(mesh), colour: SHELL_GREY });
    // Cut pins lie alone; everything else is put on the shell.
    let shell: Vec<Body> = if *now == Stage::CutPins { Vec::new() } else { shell.collect() };
    shell.into_iter().chain(there).chain(added).collect()
}

/// Turned so that the pulley's axis runs from left to right, and the grooves look up.
fn lying(mesh: Mesh) -> Mesh {
    let turned = mesh.positions.iter().map(|p| Point3::new(p.z, p.x, p.y)).collect();
    Mesh::new(turned, mesh.triangles)
}

/// Meshes of bodies of the assembly, in their places.
fn bodies(built: &Built, is_wanted: impl Fn(Role) -> bool) -> impl Iterator<Item = Mesh> {
    placed(built, move |part| is_wanted(part.role))
}

fn placed(built: &Built, is_wanted: impl Fn(&Part) -> bool) -> impl Iterator<Item = Mesh> {
    let place = |body: &MeshedBody| Some(body.part.pose?.apply(body.mesh.clone()));
    built.assembly().filter(move |body| is_wanted(&body.part)).filter_map(place)
}

/// Whether a part comes with the pulley, and not with the plate.
fn is_spacer(part: &Part) -> bool {
    part.name == SPACER
}

/// What a step adds.
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
            plate.chain(in_the_plate(design, -MOUNT_APART_MM)).collect()
        }
        Stage::Pulley => {
            let colour = Role::Accessory.colour();
            let pulley = of(|role| role == Role::Accessory, PLATE_GREY, colour, z(PULLEY_APART_MM));
            let bought = on_the_bolt(design, [PULLEY_APART_MM - BEARING_MM, NUT_APART_MM]);
            mount(is_spacer, z(SPACER_APART_MM)).chain(pulley).chain(bought).collect()
        }
        Stage::Tendon => of(|role| role == Role::Tendon, METAL_GREY, TENDON, y(TENDON_APART_MM)),
        Stage::Inserts => inserts(design),
        Stage::Dowels => dowels(design),
        Stage::Fasteners => fasteners(design),
    }
}

/// Pins to spare, beside the one that lies outermost.
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

/// A prism of steel between two heights, for what is bought; nothing for an outline that has no area.
fn steel(design: &Design, outline: &Contour, [from_mm, to_mm]: [f64; 2], apart_mm: f64) -> Option<Item> {
    let mesh = Solid::prism(outline, &[], from_mm, to_mm, 0.0).ok()?.mesh(design.tolerance()).ok()?;
    Some(Item { mesh, grey: METAL_GREY, colour: STEEL, apart: Vector3::new(0.0, 0.0, apart_mm) })
}

fn on_fasteners(design: &Design) -> Vec<Point2> {
    design.fastener_angles_rad().into_iter().map(|angle| polar(design.fastener_radius_mm(), angle)).collect()
}

/// An insert at each end of each of the shell's holes.
fn inserts(design: &Design) -> Vec<Item> {
    let Some([bore_mm, length_mm]) = design.fastening().insert_mm else { return Vec::new() };
    let width = design.configuration().shell.width_mm;
    let pair = |at: Point2| {
        let outline = Contour::circle(at, bore_mm / 2.0);
        let apart = length_mm + SMALL_APART_MM;
        let left = steel(design, &outline, [0.0, length_mm], -apart);
        [left, steel(design, &outline, [width - length_mm, width], apart)]
    };
    on_fasteners(design).into_iter().flat_map(pair).flatten().collect()
}

fn dowels(design: &Design) -> Vec<Item> {
    let c = design.configuration();
    let (length, middle) = (design.dowel_length_mm(), c.shell.width_mm / 2.0);
    let one = |angle: f64| {
        let at = polar(design.fastener_radius_mm(), angle);
        let outline = Contour::circle(at, c.fasteners.dowel_diameter_mm / 2.0);
        steel(design, &outline, [middle - length / 2.0, middle + length / 2.0], length + SMALL_APART_MM)
    };
    design.dowel_angles_rad().into_iter().filter_map(one).collect()
}

/// Screws with their heads, and their nuts: where the bill's lengths put them.
fn fasteners(design: &Design) -> Vec<Item> {
    let Some(bill) = bill_of_materials(design).fasteners else { return Vec::new() };
    let c = design.configuration();
    let fastening = design.fastening();
    let hole = c.fasteners.hole_diameter_mm;
    let shank = hole / 2.0 * 0.92;
    let [head_wide, head_high] = fastening.thread.map_or([1.8 * hole, hole], |t| t.head_mm);
    let [flats, nut_high] = fastening.thread.map_or([1.8 * hole, 0.8 * hole], |t| t.nut_mm);
    let sunk = fastening.counterbore.map_or(0.0, |r| r.depth_mm);
    let mount_mm = if c.mount.kind != MountKind::None { c.mount.plate_mm } else { 0.0 };
    let left_face = -(c.support.plate_mm + mount_mm) + sunk;
    let right_face = c.shell.width_mm + c.support.plate_mm;
    let screw = |at: Point2, face: f64, inwards: f64, length_mm: f64| {
        let apart = -inwards * (length_mm + SMALL_APART_MM);
        let ordered = |a: f64, b: f64| [a.min(b), a.max(b)];
        let stem = ordered(face, face + inwards * length_mm);
        let head = ordered(face - inwards * head_high, face);
        let part = |radius, span| steel(design, &Contour::circle(at, radius), span, apart);
        [part(shank, stem), part(head_wide / 2.0, head)]
    };
    let nut = |at: Point2| {
        let seat = right_face - fastening.nut_trap.map_or(0.0, |r| r.depth_mm);
        let corner =
            |i: u32| at + polar(flats / 3f64.sqrt(), f64::from(i) * std::f64::consts::FRAC_PI_3).coords;
        let outline = Contour::polygon((0..6).rev().map(corner).collect());
        steel(design, &outline, [seat, seat + nut_high], SUPPORT_APART_MM)
    };
    let mut all = Vec::new();
    for at in on_fasteners(design) {
        all.extend(screw(at, left_face, 1.0, bill.length_mm).into_iter().flatten());
        if bill.inserts > 0 {
            let length_mm = bill.right_length_mm.unwrap_or(bill.length_mm);
            all.extend(screw(at, right_face - sunk, -1.0, length_mm).into_iter().flatten());
        } else {
            all.extend(nut(at));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;

    const ALL: [Stage; 11] = [
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
        Stage::Tendon,
    ];

    fn built(text: &str) -> Built {
        Built::new(Design::new(read(text, "x.toml").unwrap().0).unwrap()).unwrap()
    }

    #[test]
    fn every_step_adds_something_and_keeps_what_is_there() {
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
        // What nobody asked for is not drawn.
        let plain = built("");
        for stage in [Stage::Inserts, Stage::Dowels, Stage::Mount, Stage::Pulley] {
            assert!(items(&plain, stage).is_empty(), "{stage:?}");
        }
    }

    /// Screws start at the outer face and their tips come out beyond the nut, or end in the shell, within the inserts' screws.
    #[test]
    fn screws_reach_as_far_as_the_bill_says() {
        for (text, tips_meet) in [("", false), ("[fasteners]\nkind = \"insert\"\n", true)] {
            let built = built(text);
            let c = built.design().configuration();
            let all = items(&built, Stage::Fasteners);
            let span = |item: &Item| item.mesh.bounds().map(|(low, high)| (low.z, high.z)).unwrap();
            let longest = |item: &&Item| span(item).1 - span(item).0 > 4.0;
            let stems: Vec<(f64, f64)> = all.iter().filter(longest).map(span).collect();
            assert_eq!(stems.len(), if tips_meet { 4 } else { 2 });
            for (low, high) in stems {
                let outer = c.shell.width_mm + c.support.plate_mm;
                assert!(low >= -c.support.plate_mm - 1e-9 || !tips_meet, "{low}");
                assert!(tips_meet || high > outer, "{high}");
                assert!(
                    !tips_meet || high - low < c.support.plate_mm + c.shell.width_mm / 2.0,
                    "{low} to {high}"
                );
            }
        }
    }
}
