//! The section of the assembly. Screws come first where they can: the other parts are put over them, so that nothing is loose.

mod fastening;
mod joint;
mod marks;
mod mount;
mod pulley;
mod rig;
mod shell;
mod support;

use super::document::{Block, Step};
use super::scenes::{FROM_BELOW, JOINT_VIEW, ON_BENCH, along, each, moving, outward, placed, scene};
use super::{bed_contact, carried_by, groove_list};
use crate::built::Built;
use crate::config::MountKind;
use crate::design::Design;
use crate::documents::{Bill, Manifest};
use crate::scene::{
    Bench, Bodies, FROM_LEFT, FROM_RIGHT, Illustration, Motion, Move, ToolArrow, Upright, switch_view,
};
use pinswitch_friction::{Substrate, pluralise};
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::profile::polar;

/// Distances of bodies from their places in pictures, mm.
const SUPPORT_APART_MM: f64 = 18.0;
const SHELL_APART_MM: f64 = 24.0;
const MOUNT_APART_MM: f64 = 24.0;
const TENDON_APART_MM: f64 = 14.0;
const NUT_APART_MM: f64 = 44.0;
/// Gap between small hardware and the part into which it is put, mm.
const SMALL_APART_MM: f64 = 8.0;

/// Most pins whose grooves a call-out lists.
const MOST_LISTED: usize = 6;
/// Length of the arrow that points to a groove, and its distance from the end of the groove, mm.
const GROOVE_ARROW_MM: f64 = 18.0;
const GROOVE_END_MM: f64 = 2.0;

/// The set whose assembly is described.
struct Assembly<'a> {
    built: &'a Built,
    bill: &'a Bill,
    bodies: &'a Bodies,
}

/// How the supports are fixed to the shell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fixing {
    /// Screws from the left with nuts on the right: the parts are stacked on the screws.
    Studs,
    /// Screws from both sides into inserts.
    Inserts,
    /// Glue.
    Glue,
}

pub(super) fn assemble(built: &Built, manifest: &Manifest, bodies: &Bodies) -> Vec<Block> {
    let a = Assembly { built, bill: &manifest.bill_of_materials, bodies };
    let mut steps = a.shell();
    match a.fixing() {
        Fixing::Studs => steps.extend(a.stack()),
        Fixing::Inserts | Fixing::Glue => steps.extend(a.join_both_sides()),
    }
    steps.extend(a.distal_link());
    steps.extend(a.pulley());
    steps.extend(a.stand());
    steps.push(a.tendon());
    steps.extend(a.drive());
    steps.into_iter().map(Block::Step).collect()
}

impl Assembly<'_> {
    const fn design(&self) -> &Design {
        self.built.design()
    }

    fn fixing(&self) -> Fixing {
        match &self.bill.fasteners {
            Some(f) if f.inserts > 0 => Fixing::Inserts,
            Some(_) => Fixing::Studs,
            None => Fixing::Glue,
        }
    }

    fn is_silicone(&self) -> bool {
        self.design().configuration().layout.substrate == Substrate::Silicone
    }

    fn bed(&self) -> &'static str {
        if self.is_silicone() { "silicone layer" } else { "proxy" }
    }

    fn names(&self, stems: &[&str]) -> Vec<String> {
        stems.iter().flat_map(|stem| self.bodies.names(Bench::Switch, stem)).collect()
    }

    /// Bought bodies that are put in from the right, or from the left.
    fn on_side(&self, stem: &str, from_right: bool) -> Vec<String> {
        let is_wanted = |name: &String| {
            self.bodies.find(Bench::Switch, name).is_some_and(|item| item.from_right == from_right)
        };
        self.names(&[stem]).into_iter().filter(is_wanted).collect()
    }

    /// Shell and bed, with what is fixed to them before the supports.
    fn shell_group(&self) -> Vec<String> {
        self.names(&["shell", "silicone-layer", "proxy", "dowel", "insert"])
    }

    /// A picture of moves from the left, or of a stack.
    fn picture(&self, moves: Vec<Move>) -> Illustration {
        match self.fixing() {
            Fixing::Studs => scene(Bench::Switch, Upright::Axis, ON_BENCH, moves),
            Fixing::Inserts | Fixing::Glue => scene(Bench::Switch, Upright::Grooves, FROM_LEFT, moves),
        }
    }

    /// A picture of moves from the right, which a mounting plate hides from the left.
    fn picture_from_right(&self, moves: Vec<Move>) -> Illustration {
        let picture = self.picture(moves);
        let view = if self.fixing() == Fixing::Studs { picture.view } else { FROM_RIGHT };
        Illustration { view, ..picture }
    }

    /// The length of the longest of the bodies along the axis, mm.
    fn length_mm(&self, names: &[String]) -> f64 {
        let boxes = names.iter().filter_map(|name| self.bodies.find(Bench::Switch, name)?.mesh.bounds());
        boxes.map(|(low, high)| high.z - low.z).fold(0.0, f64::max)
    }

    /// Steps with screws from the left: every part is put over the screws, from below upward.
    fn stack(&self) -> Vec<Step> {
        let c = self.design().configuration();
        let mut steps = Vec::new();
        let screws = self.names(&["screw"]);
        let has_mount = c.mount.kind != MountKind::None;
        if has_mount {
            steps.extend(self.plate_on_the_table());
        }
        let base = if has_mount { self.plate() } else { self.names(&["support-left"]) };
        let base_words = if has_mount { self.plate_words() } else { "the left support (L)".to_owned() };
        let screw_words = self.screw_words();
        let far = self.length_mm(&screws) + SMALL_APART_MM;
        let mut moves = vec![each(screws, screw_words.clone(), Motion::Into, along(-far))];
        if !has_mount {
            moves.insert(0, placed(base, "left support L"));
        }
        let picture = Illustration { view: FROM_BELOW, ..self.picture(moves) };
        let skin = self.skin_words(self.has_left_recess());
        steps.push(
            Step::new("Put the screws in first")
                .text(format!(
                    "Push {screw_words} through {base_words} from its outer face, and fix the heads with adhesive tape.{skin}"
                ))
                .text(if has_mount { String::new() } else { self.marks() })
                .text(format!(
                    "Put it on the table{} with the screws up: the other parts are put over them.",
                    self.pad_words()
                ))
                .risk(
                    "A screw is in from the inner face.",
                    "Its tip points down when the engraved face is on the table; turn it around.",
                )
                .picture(picture),
        );
        if has_mount {
            steps.push(
                self.left_support_step("Put the left support on the screws", along(SUPPORT_APART_MM))
                    .text(self.marks()),
            );
        }
        let group = self.shell_group();
        let lip = self.lip_words();
        let mut moves = vec![moving(group, "", Motion::Into, along(SHELL_APART_MM))];
        moves[0].label = format!("shell with {}", self.bed());
        steps.push(
            Step::new("Put the shell on the screws")
                .text(format!(
                    "Put the shell with the {} over the screws, until it is flat on the left support. The grooves of the shell are at the \
                     longer edge of the support{lip}. Hold the {} on the shell meanwhile.{}",
                    self.bed(),
                    self.bed_edge(),
                    self.shell_face_words()
                ))
                .risk_if(
                    self.has_lip(),
                    &format!("The edge of the {} is not under the lip of the support.", self.bed_edge()),
                    "There is a gap between shell and support; press the edge under the lip with a flat stick.",
                )
                .picture(self.picture(moves)),
        );
        steps.extend(self.pins());
        steps.push(self.right_support_step("Put the right support on the screws"));
        steps.push(self.nuts());
        steps
    }

    /// Steps with screws from both sides, or with glue.
    fn join_both_sides(&self) -> Vec<Step> {
        let is_glued = self.fixing() == Fixing::Glue;
        let has_mount = self.design().configuration().mount.kind != MountKind::None;
        let glue = if is_glued { self.glue_words() } else { String::new() };
        let mut left = self
            .left_support_step("Put the left support on the shell", along(-SUPPORT_APART_MM))
            .text(self.marks())
            .text(glue)
            .risk_if(
                is_glued,
                "Glue runs into a slot.",
                "A pin sticks in it; wipe the glue off before it sets.",
            );
        if let Some((_, picture)) = &mut left.picture {
            let label = format!("shell with {}", self.bed());
            picture.moves.insert(0, placed(self.shell_group(), label));
        }
        let mut steps = vec![left];
        if has_mount {
            let mut plate = self.plate_on_the_support();
            steps.append(&mut plate);
        }
        if !is_glued {
            let screws = self.on_side("screw", false);
            steps.push(self.insert_screws(screws, false));
        }
        steps.extend(self.pins());
        steps.push(self.right_support_step("Put the right support on the shell"));
        if !is_glued {
            steps.push(self.insert_screws(self.on_side("screw", true), true));
        }
        steps
    }

    /// The step of the pins; `None` without pins.
    fn pins(&self) -> Option<Step> {
        let c = self.design().configuration();
        let number = self.bill.pins.number;
        if number == 0 {
            return None;
        }
        let from = match (self.is_marked(), self.fixing()) {
            (true, Fixing::Studs) => "counted from the marked side",
            (true, _) => "counted from the `1`",
            (false, _) => "counted from the side of the load",
        };
        let pins = self.names(&["pin"]);
        let far = self.length_mm(&pins) + SMALL_APART_MM;
        let words = if number == 1 { "pin" } else { "pins" };
        let label = match number {
            0..=MOST_LISTED => {
                let grooves: Vec<String> = c.layout.pins.iter().map(ToString::to_string).collect();
                let word = if number == 1 { "groove" } else { "grooves" };
                format!("{} in {word} {}", pluralise(number, "pin"), grooves.join(", "))
            }
            _ => pluralise(number, "pin"),
        };
        let moves = vec![each(pins, label, Motion::Into, along(far))];
        let mut picture = self.picture_from_right(moves);
        picture.arrows.extend(self.first_groove());
        Some(
            Step::new(if number == 1 { "Put the pin in" } else { "Put the pins in" })
                .text(format!(
                    "Put the {words} into {}, {from}, and into the slots of the support.",
                    groove_list(&c.layout.pins)
                ))
                .risk(
                    "A pin is in a neighbouring groove.",
                    &format!(
                        "Count again from the side of the load: {} of {} grooves.",
                        number, c.segment.grooves
                    ),
                )
                .risk("A pin is not in its slot.", "It is higher than the others, or it tilts.")
                .picture(picture),
        )
    }

    /// The arrow that points to groove 1, at its upper end.
    fn first_groove(&self) -> Option<ToolArrow> {
        let angle_rad = self.design().groove_angles_rad().into_iter().next()?;
        let bed = self.names(&["silicone-layer", "proxy"]);
        let mesh = &self.bodies.find(Bench::Switch, bed.first()?)?.mesh;
        let radius_mm = mesh.positions.iter().map(|p| libm::hypot(p.x, p.y)).fold(0.0, f64::max);
        let (_, high) = mesh.bounds()?;
        let at = |mm: f64| {
            let p = polar(radius_mm + mm, angle_rad);
            Point3::new(p.x, p.y, high.z - GROOVE_END_MM)
        };
        Some(ToolArrow { ends: [at(GROOVE_ARROW_MM), at(0.5)], label: "groove 1".to_owned() })
    }

    fn tendon(&self) -> Step {
        let c = self.design().configuration();
        let t = &self.bill.tendon;
        let view = match c.mount.kind {
            MountKind::Joint => JOINT_VIEW,
            _ => switch_view(self.design()),
        };
        let moves =
            vec![moving(self.names(&["tendon"]), "tendon", Motion::Flexible, outward(TENDON_APART_MM))];
        Step::new("Put the tendon over the switch")
            .text(format!(
                "Put {} mm of tendon ({} mm with its coating) over the {}. It is wrapped by {:.2} deg.{}{}",
                t.length_mm,
                t.outer_diameter_mm,
                carried_by(self.design()),
                c.layout.wrap_angle_deg,
                bed_contact(self.design()),
                self.anchoring()
            ))
            .risk(
                "The tendon rubs on a support.",
                "Its coating has a bright line at the side; centre it between the supports.",
            )
            .picture(scene(Bench::Switch, Upright::Grooves, view, moves))
    }
}
