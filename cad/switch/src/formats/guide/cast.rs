//! The section of casting: mix, close, pour, cure, cut, open, release.

use super::cure::{cure_step, post_cure_step};
use super::document::{Block, Step};
use super::scenes::{along, moving, outward, placed, scene};
use crate::config::MouldKind;
use crate::design::Design;
use crate::documents::Manifest;
use crate::parts::{CAST_LAYER, CAST_OVERFILL, CAST_SPRUE, CAST_VENT};
use crate::process::instructions;
use crate::scene::{Bench, Bodies, Illustration, Motion, Move, ToolArrow, Upright, distance_to_mesh};
use pinswitch_friction::Substrate;
use pinswitch_solid::mesh::{Point3, Vector3};
use pinswitch_solid::render::View;

/// Cameras of the mould: with the ribs toward the camera, and with the end of the parting line.
const MOULD_VIEW: View = View { turn_deg: 152.0, rise_deg: 34.0 };
const TRAY_VIEW: View = View { turn_deg: 200.0, rise_deg: 48.0 };

/// Distances of the parts of the mould in pictures, mm.
const RING_APART_MM: f64 = 20.0;
const LID_APART_MM: f64 = 40.0;
/// Gap under the lid through which the blade cuts, mm.
const CUT_MM: f64 = 3.0;
/// Distance of the layer from the mould, mm.
const LAYER_APART_MM: f64 = 12.0;
/// Height above a body from which its top is searched, and difference of heights of the same face, mm.
const ABOVE_MM: f64 = 1.0;
const SAME_MM: f64 = 1e-6;
/// Length of the arrow of the stream and of the blade, mm.
const STREAM_MM: f64 = 16.0;

pub(super) fn cast(design: &Design, manifest: &Manifest, bodies: &Bodies) -> Vec<Block> {
    let c = design.configuration();
    let steps = match (c.layout.substrate, c.mould.kind) {
        (Substrate::Silicone, MouldKind::Split) => split(design, manifest, bodies),
        (Substrate::Silicone, MouldKind::OnePiece) => tray(design, manifest, bodies),
        _ => Vec::new(),
    };
    let post_cure = if steps.is_empty() { None } else { post_cure_step(design) };
    steps.into_iter().chain(post_cure).map(Block::Step).collect()
}

/// Weighing and mixing, the same for every mould.
fn mix_step(design: &Design, manifest: &Manifest) -> Option<Step> {
    let c = design.configuration();
    let s = manifest.bill_of_materials.silicone.as_ref()?;
    let product = s.product.unwrap_or("your silicone");
    let reason = if s.mix_g > s.pour_g * c.silicone.waste_factor {
        "smaller amounts are difficult to weigh"
    } else {
        "some remains in the cup"
    };
    let pot_life = c.process.silicone.data().map_or(String::new(), |product| {
        format!(" Pour within {:.0} min of mixing: it thickens at room temperature.", product.pot_life_min)
    });
    Some(
        Step::new("Mix the silicone")
            .text(format!(
                "Weigh {:.1} g of base and {:.1} g of curing agent of {product} ({:.0}:1), {:.1} g in total. The mould holds {:.2} ml ({:.2} g); {reason}.",
                s.base_g, s.agent_g, s.mix_ratio, s.mix_g, s.pour_ml, s.pour_g
            ))
            .text(format!(
                "Mix for three minutes and scrape the walls of the cup. Remove the bubbles in a vacuum chamber, or let the cup stand for 30 \
                 minutes, until the surface is flat.{pot_life}"
            ))
            .risk("The ratio is wrong.", "The cured rest in the cup is sticky or brittle.")
            .risk("Bubbles remain.", "The surface of the mix is not flat; wait longer."),
    )
}

fn names(bodies: &Bodies, stems: &[&str]) -> Vec<String> {
    stems.iter().flat_map(|stem| bodies.names(Bench::Mould, stem)).collect()
}

fn picture(view: View, moves: Vec<Move>) -> Illustration {
    scene(Bench::Mould, Upright::Axis, view, moves)
}

/// The middle of the top of a body.
fn top(bodies: &Bodies, name: &str) -> Option<Point3> {
    let mesh = &bodies.find(Bench::Mould, name)?.mesh;
    let (low, high) = mesh.bounds()?;
    let middle = nalgebra::center(&low, &high);
    let above = Point3::new(middle.x, middle.y, high.z + ABOVE_MM);
    let is_on_top = |distance_mm: f64| distance_mm < ABOVE_MM + SAME_MM;
    if distance_to_mesh(mesh, above, -Vector3::z()).is_some_and(is_on_top) {
        return Some(above - along(ABOVE_MM));
    }
    // The middle of a curved body is beside it: the nearest vertex of its top is not.
    let upper = mesh.positions.iter().filter(|p| p.z > high.z - SAME_MM);
    upper.min_by(|a, b| (*a - middle).norm().total_cmp(&(*b - middle).norm())).copied()
}

/// An arrow that ends above a body.
fn stream(bodies: &Bodies, name: &str) -> Vec<ToolArrow> {
    let arrow =
        |p: Point3| ToolArrow { ends: [p + along(STREAM_MM), p + along(1.0)], label: "silicone".to_owned() };
    top(bodies, name).map(arrow).into_iter().collect()
}

fn split(design: &Design, manifest: &Manifest, bodies: &Bodies) -> Vec<Step> {
    let of = |stems: &[&str]| names(bodies, stems);
    let plugs = of(&[CAST_SPRUE, CAST_VENT]);
    let lid_with_plugs = [of(&["mould-lid"]), plugs.clone()].concat();
    let exploded = picture(
        MOULD_VIEW,
        vec![
            placed(of(&["mould-core"]), "core"),
            moving(of(&["mould-ring"]), "ring", Motion::Into, along(RING_APART_MM)),
            moving(of(&["mould-lid"]), "lid", Motion::Into, along(LID_APART_MM)),
        ],
    );
    let mut closed = picture(MOULD_VIEW, Vec::new());
    // In its full colour, the lid is distinct from the ring below it.
    closed.moves = vec![placed(of(&["mould-lid"]), "lid with funnel and vents")];
    closed.notes = [("mould-ring", "ring"), ("mould-core", "core")]
        .map(|(name, label)| (name.to_owned(), label.to_owned()))
        .to_vec();
    let mut poured = picture(
        MOULD_VIEW,
        vec![
            placed(of(&[CAST_LAYER]), ""),
            placed(of(&[CAST_SPRUE]), "full funnel"),
            placed(of(&[CAST_VENT]), "full vents"),
        ],
    );
    poured.arrows = stream(bodies, CAST_SPRUE);
    let mut cut =
        picture(MOULD_VIEW, vec![moving(lid_with_plugs.clone(), "raised lid", Motion::Away, along(CUT_MM))]);
    // The lid stays on the silicone until the next step.
    cut.moves[0].motion = Motion::Still;
    cut.arrows = blade(bodies);
    cut.notes = vec![("mould-ring".to_owned(), "ring".to_owned())];
    let opened = picture(
        MOULD_VIEW,
        vec![
            moving(lid_with_plugs, "lid with plugs", Motion::Away, along(LID_APART_MM)),
            moving(of(&["mould-ring"]), "ring", Motion::Away, along(RING_APART_MM)),
            placed(of(&[CAST_LAYER]), "silicone layer"),
        ],
    );
    let released = picture(
        MOULD_VIEW,
        vec![moving(
            of(&[CAST_LAYER]),
            "silicone layer",
            Motion::FlexibleAway,
            // Above the keys of the core.
            outward(LAYER_APART_MM) + along(LAYER_APART_MM),
        )],
    );
    let mut steps = vec![
        Step::new("Put the mould together")
            .text("Put the ring on the base of the core, with the keys in the holes, and the lid on the ring.")
            .text(instructions::preparation(design.configuration()))
            .risk(
                "A part is turned around.",
                "It rocks on the keys: one key is off centre, so that the mould closes in one orientation only.",
            )
            .picture(exploded),
        Step::new("Close the mould")
            .text("Clamp all three with a rubber band around each end. Tape the parting line.")
            .risk("The mould is open by a hair.", "Light is visible between ring and base; press and clamp again.")
            .picture(closed),
    ];
    steps.extend(mix_step(design, manifest));
    steps.extend([
        Step::new("Pour the silicone")
            .text("Put the mould on a level table. Pour slowly through the funnel until silicone rises in both vents.")
            .risk(
                "Air is trapped at an end.",
                "One vent stays empty; tilt the mould so that this vent is highest, and pour more.",
            )
            .risk("The mould leaks.", "The level in the funnel falls; tape the place and pour more.")
            .picture(poured),
        cure_step(design),
        Step::new("Cut the sprue and the vents")
            .text(
                "Remove the bands and the tape. Raise the lid evenly at both ends by 2 to 3 mm: the silicone in funnel and vents \
                 stretches.",
            )
            .text("Cut the silicone between lid and ring with a thin blade, flush with the ring.")
            .text("The lid does not come off before the cut, because the funnel is wider above.")
            .risk("The lid is pulled off without a cut.", "The sprue tears a hole into the layer.")
            .picture(cut),
        Step::new("Open the mould")
            .text("Remove the lid, and slide the ring off along the axis. Push the plugs of silicone out of the lid.")
            .risk("The ring is tilted.", "It jams, and its ribs cut the silicone; push both ends alternately.")
            .picture(opened),
        Step::new("Take the layer out")
            .text("Peel the layer from the core, from one end to the other. Trim the flash and the stubs of sprue and vents with a blade.")
            .text(layer_size(design))
            .risk(
                "The layer is torn or has a bubble in a groove.",
                "A groove is not straight and smooth over its width; cast again.",
            )
            .picture(released),
    ]);
    steps
}

/// The arrow of a blade that cuts between ring and lid, from the side of the ribs.
fn blade(bodies: &Bodies) -> Vec<ToolArrow> {
    // The ring has keys on its upper face, and the lid has a flat lower one.
    let Some((low, high)) = bodies.find(Bench::Mould, "mould-lid").and_then(|item| item.mesh.bounds()) else {
        return Vec::new();
    };
    let at = |y: f64| Point3::new(0.0, y, low.z + CUT_MM / 2.0);
    vec![ToolArrow { ends: [at(high.y + STREAM_MM), at(high.y - 1.0)], label: "blade".to_owned() }]
}

fn layer_size(design: &Design) -> String {
    format!(
        "The layer is {:.1} mm wide and {:.1} mm thick.",
        design.layer_width_mm(),
        design.configuration().silicone.thickness_mm
    )
}

fn tray(design: &Design, manifest: &Manifest, bodies: &Bodies) -> Vec<Step> {
    let m = &design.configuration().mould;
    let has_basin = m.overfill_mm > 0.0;
    let of = |stems: &[&str]| names(bodies, stems);
    let empty = picture(TRAY_VIEW, vec![placed(of(&["mould-tray"]), "tray")]);
    let mut poured =
        picture(TRAY_VIEW, vec![placed(of(&[CAST_LAYER]), ""), placed(of(&[CAST_OVERFILL]), "full basin")]);
    poured.arrows = stream(bodies, if has_basin { CAST_OVERFILL } else { CAST_LAYER });
    let overfill = picture(
        TRAY_VIEW,
        vec![moving(of(&[CAST_OVERFILL]), "overfill", Motion::Away, along(LAYER_APART_MM))],
    );
    let released = picture(
        TRAY_VIEW,
        vec![moving(
            of(&[CAST_LAYER]),
            "silicone layer",
            Motion::Away,
            along(design.layer_width_mm() + LAYER_APART_MM),
        )],
    );
    let mut steps = vec![
        Step::new("Prepare the tray")
            .text("Level the tray, with its open side up.")
            .text(instructions::preparation(design.configuration()))
            .risk("The tray is not level.", "A drop of water does not stay in the middle of the brim.")
            .picture(empty),
    ];
    steps.extend(mix_step(design, manifest));
    steps.push(
        Step::new("Pour the silicone")
            .text(if has_basin {
                "Pour slowly at one end until the basin above the layer is full."
            } else {
                "Pour slowly at one end until the tray is full, and level the silicone with the brim."
            })
            .risk(
                "Air is trapped behind a rib.",
                "A bubble rises; move a thin wire along the ribs until none rises.",
            )
            .picture(poured),
    );
    steps.push(cure_step(design));
    if has_basin {
        let draft = if m.draft_deg > 0.0 { " Only the walls above the ledge have a draft." } else { "" };
        steps.push(
            Step::new("Cut the overfill off")
                .text(format!(
                    "Cut along the ledge of the basin with a thin blade that is flat on the ledge, and lift the overfill off.{draft}"
                ))
                .risk("The blade dips into the cavity.", "The edge of the layer is wavy; keep the blade on the ledge.")
                .picture(overfill),
        );
    }
    steps.push(
        Step::new("Take the layer out")
            .text(
                "Loosen the layer from the walls of the tray with a thin blunt blade, all around. Lift one end with tweezers and peel \
                 the layer out from this end.",
            )
            .text(layer_size(design))
            .risk(
                "The layer sticks and is stretched too far.",
                "It becomes longer than the tray; put a drop of soapy water between silicone and wall.",
            )
            .picture(released),
    );
    steps
}
