//! The section of the assembly. Screws come first where they can: the other parts are put over them, so that nothing is loose.

use super::document::{Block, Step};
use super::scenes::{FROM_BELOW, ON_BENCH, along, each, moving, outward, placed, scene, still};
use super::{bed_contact, carried_by, groove_list};
use crate::built::Built;
use crate::config::{DriveKind, MouldKind, MountKind};
use crate::design::Design;
use crate::documents::{Bill, Manifest, layout_text};
use crate::parts::{LeftOut, SPACER};
use crate::rig::RigBolts;
use crate::scene::{
    Bench, Bodies, FROM_LEFT, FROM_RIGHT, GUIDE_PULLEY, Illustration, Motion, Move, RIG_VIEW, Upright,
    switch_view,
};
use pinswitch_friction::{Substrate, pluralise};
use pinswitch_solid::render::View;

/// Distances of bodies from their places in pictures, mm.
const SUPPORT_APART_MM: f64 = 18.0;
const SHELL_APART_MM: f64 = 24.0;
const BED_APART_MM: f64 = 9.0;
const MOUNT_APART_MM: f64 = 24.0;
const TENDON_APART_MM: f64 = 14.0;
const SPACER_APART_MM: f64 = 26.0;
const PULLEY_APART_MM: f64 = 32.0;
const NUT_APART_MM: f64 = 44.0;
const DISTAL_APART_MM: f64 = 34.0;
const FEET_APART_MM: f64 = 40.0;
/// Gap between small hardware and the part into which it is put, mm.
const SMALL_APART_MM: f64 = 8.0;

/// The set whose assembly is described.
struct Assembly<'a> {
    built: &'a Built,
    bill: &'a Bill,
    bodies: &'a Bodies,
}

/// How the supports are fixed to the shell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Joint {
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
    match a.joint() {
        Joint::Studs => steps.extend(a.stack()),
        Joint::Inserts | Joint::Glue => steps.extend(a.join_both_sides()),
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

    fn joint(&self) -> Joint {
        match &self.bill.fasteners {
            Some(f) if f.inserts > 0 => Joint::Inserts,
            Some(_) => Joint::Studs,
            None => Joint::Glue,
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
        match self.joint() {
            Joint::Studs => scene(Bench::Switch, Upright::Axis, ON_BENCH, moves),
            Joint::Inserts | Joint::Glue => scene(Bench::Switch, Upright::Grooves, FROM_LEFT, moves),
        }
    }

    /// A picture of moves from the right, which a mounting plate hides from the left.
    fn picture_from_right(&self, moves: Vec<Move>) -> Illustration {
        let picture = self.picture(moves);
        let view = if self.joint() == Joint::Studs { picture.view } else { FROM_RIGHT };
        Illustration { view, ..picture }
    }

    /// The length of the longest of the bodies along the axis, mm.
    fn length_mm(&self, names: &[String]) -> f64 {
        let boxes = names.iter().filter_map(|name| self.bodies.find(Bench::Switch, name)?.mesh.bounds());
        boxes.map(|(low, high)| high.z - low.z).fold(0.0, f64::max)
    }

    /// Steps of the shell: inserts, layer or proxy, dowels.
    fn shell(&self) -> Vec<Step> {
        let c = self.design().configuration();
        let shell = || placed(self.names(&["shell"]), "shell");
        let picture = |view: View, moves| scene(Bench::Shell, Upright::Grooves, view, moves);
        let mut steps = Vec::new();
        let inserts = self.names(&["insert"]);
        if !inserts.is_empty() {
            let (left, right) = (self.on_side("insert", false), self.on_side("insert", true));
            let far = self.length_mm(&inserts) + SMALL_APART_MM;
            let label = pluralise(inserts.len(), "insert");
            let moves = vec![
                shell(),
                each(left, label, Motion::Into, along(-far)),
                each(right, "", Motion::Into, along(far)),
            ];
            steps.push(
                Step::new("Press the inserts into the shell")
                    .text(
                        "Press the inserts flush into both ends of the holes of the shell with a soldering iron. Let the shell cool.",
                    )
                    .risk("An insert is tilted.", "A screw turned into it by hand is not perpendicular to the face; reheat it.")
                    .risk("An insert protrudes.", "A flat plate rocks on the face; reheat it and press it flush.")
                    .picture(picture(FROM_LEFT, moves)),
            );
        }
        let source = if self.is_silicone() && c.mould.kind == MouldKind::None {
            format!(
                "Use an existing silicone layer: this set has no mould (`mould.kind = \"none\"`). The layer is {:.1} mm wide and {} mm \
                 thick, smooth inside, and has {} outside. The sheet `silicone-layer` of the drawing has all dimensions.",
                self.design().layer_width_mm(),
                c.silicone.thickness_mm,
                pluralise(c.segment.grooves, "groove")
            )
        } else {
            String::new()
        };
        let keeps = if self.design().stops_mm().is_some() { ", between the stops at its ends" } else { "" };
        let bed = self.names(&["silicone-layer", "proxy"]);
        let bed_moves = |shell: Option<Move>| -> Vec<Move> {
            let bed = moving(bed.clone(), self.bed(), self.bed_motion(), outward(BED_APART_MM));
            shell.into_iter().chain([bed]).collect()
        };
        let first = inserts.is_empty().then(shell);
        let mut step = Step::new(format!("Put the {} on the shell", self.bed()))
            .text(source)
            .text(format!("Put the {} on the shell, with its grooves outward{keeps}.", self.bed()))
            .risk_if(
                self.is_silicone(),
                "Dust or air is under the layer.",
                "A bump is visible from the side; lift the layer and clean both faces.",
            );
        if self.is_silicone() {
            step = step.text(format!(
                "Leave the same gap at both edges: the layer is {:.1} mm narrower than the shell.",
                2.0 * c.silicone.side_clearance_mm
            ));
        } else {
            step = step.risk("The proxy is warped.", "It rocks on the shell; print it again with a brim.");
        }
        steps.push(step.picture(picture(FROM_LEFT, bed_moves(first))));
        if let Some(d) = &self.bill.dowels {
            let dowels = self.names(&["dowel"]);
            let far = self.length_mm(&dowels) + SMALL_APART_MM;
            let moves = vec![each(dowels, pluralise(d.number, "dowel"), Motion::Into, along(far))];
            steps.push(
                Step::new("Put the dowels into the shell")
                    .text(format!(
                        "Cut {} dowels of {} mm, {} mm long, and put them into the shell. They protrude equally at both ends.",
                        d.number, d.diameter_mm, d.length_mm
                    ))
                    .risk("A dowel is too long.", "A support does not reach the shell; shorten the dowel.")
                    .picture(picture(FROM_LEFT, moves)),
            );
        }
        steps
    }

    /// A layer of more than half a turn is bent over the shell.
    fn bed_motion(&self) -> Motion {
        if self.design().half_span_rad() < std::f64::consts::FRAC_PI_2 {
            Motion::Into
        } else {
            Motion::Flexible
        }
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
                    "Push {screw_words} through {base_words} from its outer face, and fix the heads with adhesive tape. Put it on the \
                     table{} with the screws up: the other parts are put over them.{skin}",
                    self.pad_words()
                ))
                .text(if has_mount { String::new() } else { self.marks() })
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
                    "Put the shell with the {} over the screws, with its grooves at the outer, longer edge of the support, until it is flat \
                     on the left support{lip}.{}",
                    self.bed(),
                    self.shell_face_words()
                ))
                .risk_if(
                    self.has_lip(),
                    &format!("The lip is on the edge of the {} and not outside of it.", self.bed_edge()),
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
        let is_glued = self.joint() == Joint::Glue;
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

    fn left_support_step(&self, title: &str, by: pinswitch_solid::mesh::Vector3) -> Step {
        let lip = if self.joint() == Joint::Studs { String::new() } else { self.lip_words() };
        let face = if lip.is_empty() { self.inner_face_words() } else { "" };
        let target = if self.joint() == Joint::Studs { "over the screws" } else { "on the shell" };
        let moves = vec![moving(self.names(&["support-left"]), "left support L", Motion::Into, by)];
        Step::new(title)
            .text(format!("Put the left support (L) {target}{lip}{face}."))
            .risk_if(
                self.design().configuration().label.engrave,
                "Left and right support are exchanged.",
                "The engraved letter is R, or the engraved face is toward the shell.",
            )
            .risk_if(
                !self.design().configuration().label.engrave,
                "The support is not flat.",
                "Light is visible under it; look for a string or a burr.",
            )
            .picture(self.picture(moves))
    }

    /// The side of the shell that is up, by its engraving.
    fn shell_face_words(&self) -> &'static str {
        let shell =
            self.built.printed().iter().map(crate::built::BuiltPart::part).find(|p| p.name == "shell");
        if shell.is_some_and(|p| !p.engraved.is_empty()) { " Its engraved face is up." } else { "" }
    }

    /// The inner face of a support, by what is on it.
    fn inner_face_words(&self) -> &'static str {
        match (self.design().slot_angles_rad().is_empty(), self.has_lip()) {
            (false, _) => ", with its slots toward the shell",
            (true, true) => ", with its lip toward the shell",
            (true, false) => "",
        }
    }

    fn has_lip(&self) -> bool {
        self.design().configuration().support.lip_depth_mm > 0.0 && !self.has_lost(LeftOut::Lip)
    }

    fn bed_edge(&self) -> &'static str {
        if self.is_silicone() { "layer" } else { "proxy" }
    }

    fn lip_words(&self) -> String {
        if self.has_lip() {
            format!(", with its lip over the edge of the {}", self.bed_edge())
        } else {
            String::new()
        }
    }

    /// Returns whether a support lacks a feature that does not fit.
    fn has_lost(&self, what: LeftOut) -> bool {
        self.supports().any(|part| part.left_out.contains(&what))
    }

    fn supports(&self) -> impl Iterator<Item = &crate::parts::Part> {
        self.built
            .printed()
            .iter()
            .map(crate::built::BuiltPart::part)
            .filter(|p| p.name.starts_with("support"))
    }

    fn is_marked(&self) -> bool {
        self.design().configuration().label.engrave && !self.has_lost(LeftOut::Arrow)
    }

    /// The engraved marks of the left support, and the side of the load.
    fn marks(&self) -> String {
        let c = self.design().configuration();
        let marks = match (self.is_marked(), self.has_lost(LeftOut::Label)) {
            (true, false) => {
                let label = &c.label.text;
                let label = if label.is_empty() {
                    format!("the label of the layout ({})", layout_text(c))
                } else {
                    format!("the label `{label}`")
                };
                format!(
                    "The outer face of the left support has {label} and an arrow. The arrow points to groove 1, on the side of the load; the `1` is on that side."
                )
            }
            (true, true) => {
                "The arrow on its outer face points to groove 1, on the side of the load; the `1` is on that side.".to_owned()
            }
            (false, _) if !c.label.engrave => {
                "The supports have no marks (`label.engrave = false`). Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
            }
            (false, _) => {
                "The arrow does not fit on the supports. Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
            }
        };
        let has_f = |line: &String| line.contains("F>1") || line.contains("1<F");
        let force =
            if self.supports().flat_map(|s| &s.engraved).any(has_f) { " `F` is the load." } else { "" };
        let covered = if self.is_marked() && c.mount.kind != MountKind::None {
            " The mounting plate covers the marks; the same marks on the right support stay visible."
        } else {
            ""
        };
        let pen = if self.joint() == Joint::Studs && self.bill.pins.number > 0 {
            " Mark the side of groove 1 with a pen on the edge of the support, because its outer face is hidden in the next steps."
        } else {
            ""
        };
        format!("{marks}{force}{covered}{pen}")
    }

    /// The step of the pins; `None` without pins.
    fn pins(&self) -> Option<Step> {
        let c = self.design().configuration();
        let number = self.bill.pins.number;
        if number == 0 {
            return None;
        }
        let from = match (self.is_marked(), self.joint()) {
            (true, Joint::Studs) => "counted from the marked side",
            (true, _) => "counted from the `1`",
            (false, _) => "counted from the side of the load",
        };
        let pins = self.names(&["pin"]);
        let far = self.length_mm(&pins) + SMALL_APART_MM;
        let words = if number == 1 { "pin" } else { "pins" };
        let moves = vec![each(pins, pluralise(number, "pin"), Motion::Into, along(far))];
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
                .picture(self.picture_from_right(moves)),
        )
    }

    fn right_support_step(&self, title: &str) -> Step {
        let slides = match (self.bill.pins.number > 0, self.is_silicone()) {
            (true, true) => " Every pin must slide to the end of its slot and back.",
            (true, false) => " Every pin must rest in its groove of the proxy.",
            (false, _) => "",
        };
        let target = if self.joint() == Joint::Studs { "over the screws" } else { "on the shell" };
        let engages =
            if self.bill.pins.number > 0 { ", and guide every pin into its slot with tweezers" } else { "" };
        let glue = if self.joint() == Joint::Glue {
            " Glue it like the left one, and let the glue set before the first load."
        } else {
            ""
        };
        let has_trap = self.joint() == Joint::Studs && self.design().fastening().nut_trap.is_some();
        let skin = self.skin_words(has_trap);
        let moves = vec![moving(
            self.names(&["support-right"]),
            "right support R",
            Motion::Into,
            along(SUPPORT_APART_MM),
        )];
        Step::new(title)
            .text(format!(
                "Put the right support (R) {target}{}{engages}.{slides}{glue}{skin}",
                self.inner_face_words()
            ))
            .risk_if(
                self.bill.pins.number == 0,
                "The support is not flat on the shell.",
                "Light is visible between them; look for a string or a burr.",
            )
            .risk_if(
                self.bill.pins.number > 0,
                "A pin is next to its slot.",
                "There is a gap between shell and support; lift the support and guide the pin.",
            )
            .picture(self.picture_from_right(moves))
    }

    fn screw_words(&self) -> String {
        let Some(f) = &self.bill.fasteners else { return String::new() };
        format!("{} {} x {}", pluralise(f.number, "screw"), f.thread, f.length_mm)
    }

    /// Heads that are not in a recess protrude below the part.
    fn pad_words(&self) -> &'static str {
        let fastening = self.design().fastening();
        let recess =
            if self.plate().is_empty() { fastening.counterbore } else { fastening.mount_counterbore };
        let head_mm = fastening.thread.map_or(0.0, |t| t.head_mm[1]);
        if recess.is_some_and(|r| r.depth_mm >= head_mm) {
            ""
        } else {
            ", on a soft pad because the heads protrude,"
        }
    }

    /// Whether the part through which the screws from the left pass first has recesses for their heads.
    fn has_left_recess(&self) -> bool {
        let fastening = self.design().fastening();
        if self.plate().is_empty() {
            fastening.counterbore.is_some()
        } else {
            fastening.mount_counterbore.is_some()
        }
    }

    /// The skin above the recesses of a part; empty without recesses.
    fn skin_words(&self, has_recess: bool) -> String {
        if !has_recess {
            return String::new();
        }
        format!(
            " A skin of {} mm closes the hole above every recess, so that it prints without support. Break it with the screw.",
            self.design().membrane_mm()
        )
    }

    /// The layer bulges: the screws are not tightened over silicone.
    fn tight_words(&self) -> &'static str {
        if self.is_silicone() { ", finger tight, so that the layer can bulge" } else { "" }
    }

    fn nuts(&self) -> Step {
        let fastening = self.design().fastening();
        let nuts = self.names(&["nut"]);
        let (number, far) = (nuts.len(), self.length_mm(&nuts) + SMALL_APART_MM);
        let thread = self.bill.fasteners.as_ref().map_or("", |f| f.thread);
        let label = format!("{} {thread}", pluralise(number, "nut"));
        let place = match (fastening.nut_trap.is_some(), number) {
            (true, 1) => "Put the nut into the trap of the right support",
            (true, _) => "Put the nuts into the traps of the right support",
            (false, 1) => "Put the nut on the screw",
            (false, _) => "Put the nuts on the screws",
        };
        let moves = vec![each(nuts, label, Motion::Into, along(far))];
        let title = if number == 1 { "Fasten the nut" } else { "Fasten the nuts" };
        Step::new(title)
            .text(format!(
                "{place}. Fasten with {}{}. Remove the tape.",
                self.screw_words(),
                self.tight_words()
            ))
            .risk_if(
                fastening.nut_trap.is_some(),
                "A nut is not in its trap.",
                "It turns with the screw; press it into the trap.",
            )
            .risk_if(
                fastening.nut_trap.is_none(),
                "A nut is loose.",
                "The supports move against the shell; hold the nut with the spanner and turn the screw.",
            )
            .risk_if(
                self.bill.pins.number > 0 && self.is_silicone(),
                "The screws are too tight.",
                "A pin does not return after it is pressed in; loosen the nuts by a quarter turn.",
            )
            .picture(self.picture(moves))
    }

    fn insert_screws(&self, screws: Vec<String>, from_right: bool) -> Step {
        let far = self.length_mm(&screws) + SMALL_APART_MM;
        let (side, sign) = if from_right { ("right", 1.0) } else { ("left", -1.0) };
        let (thread, length) = self.bill.fasteners.as_ref().map_or(("", 0.0), |f| {
            (f.thread, if from_right { f.right_length_mm.unwrap_or(f.length_mm) } else { f.length_mm })
        });
        let has_recess =
            if from_right { self.design().fastening().counterbore.is_some() } else { self.has_left_recess() };
        let words = format!("{} {thread} x {length}", pluralise(screws.len(), "screw"));
        let moves = vec![each(screws, words.clone(), Motion::Into, along(sign * far))];
        Step::new(format!("Fasten the {side} side"))
            .text(format!(
                "Fasten with {words} from the {side} into the inserts.{}",
                self.skin_words(has_recess)
            ))
            .risk(
                "A screw turns without end.",
                "The insert turns with it; press it in again with the soldering iron.",
            )
            .picture(if from_right { self.picture_from_right(moves) } else { self.picture(moves) })
    }

    fn glue_words(&self) -> String {
        let dowels = if self.bill.dowels.is_some() { " The dowels locate the supports." } else { "" };
        let supports = if dowels.is_empty() { "the plates of both supports" } else { "the supports" };
        format!(
            "This set has no screws (`fasteners.count = 0`).{dowels} Glue {supports} to the ends of the shell with ABS cement or epoxy. \
             Keep slots and grooves free of it."
        )
    }

    /// The names of the mounting plate.
    fn plate(&self) -> Vec<String> {
        self.names(&["base-flange", "link-proximal", "rig-plate"])
    }

    fn plate_words(&self) -> String {
        self.plate().first().map_or_else(String::new, |name| format!("`{name}`"))
    }

    /// The holes of the mounting plate, and their use.
    fn plate_holes(&self) -> String {
        let c = self.design().configuration();
        let Some(m) = &self.bill.mount else { return String::new() };
        match c.mount.kind {
            MountKind::None => String::new(),
            MountKind::Flange => format!("It has {} mounting holes of {} mm.", m.holes, m.hole_diameter_mm),
            MountKind::Joint => format!(
                "Its {} holes of {} mm fasten it to the base of the finger.",
                m.holes, m.hole_diameter_mm
            ),
            MountKind::Rig => "It is the board of the rig. No head protrudes below it.".to_owned(),
        }
    }

    /// Moves of bolt and screws that are put into the plate from its outer face.
    fn plate_moves(&self, with_plate: bool) -> Vec<Move> {
        let mut moves = Vec::new();
        if with_plate {
            moves.push(placed(self.plate(), "mounting plate"));
        }
        let bolt = self.names(&["bolt"]);
        let far = self.length_mm(&bolt) + SMALL_APART_MM;
        moves.push(each(bolt, "bolt M8", Motion::Into, along(-far)));
        let axle = self.names(&["axle"]);
        let far = self.length_mm(&axle) + SMALL_APART_MM;
        moves.push(each(axle, "axle", Motion::Into, along(-far)));
        // The splice of a board in two parts is behind it, with its bolts from the front.
        moves.push(moving(self.names(&["rig-splice"]), "splice", Motion::Into, along(-MOUNT_APART_MM)));
        let bolts = self.names(&["splice-bolt"]);
        let far = self.length_mm(&bolts) + SMALL_APART_MM;
        moves.push(each(
            bolts,
            "bolts of the splice",
            Motion::Into,
            self.toward_its_side("splice-bolt", far),
        ));
        let nuts = self.names(&["splice-nut"]);
        let far = MOUNT_APART_MM + SMALL_APART_MM;
        moves.push(each(nuts, "nuts", Motion::Into, self.toward_its_side("splice-nut", far)));
        moves
    }

    /// A displacement along the axis toward the side from which bought bodies are put in.
    fn toward_its_side(&self, stem: &str, far_mm: f64) -> pinswitch_solid::mesh::Vector3 {
        along(if self.on_side(stem, true).is_empty() { -far_mm } else { far_mm })
    }

    /// Moves of the sheath stop with its screws and nuts.
    fn sheath_stop(&self) -> Vec<Move> {
        let (screws, nuts) = (self.names(&["stop-screw"]), self.names(&["stop-nut"]));
        let far = self.length_mm(&screws) + SMALL_APART_MM;
        vec![
            moving(self.names(&["sheath-stop"]), "sheath stop", Motion::Into, along(MOUNT_APART_MM)),
            each(screws, "screws M3", Motion::Into, along(-far)),
            each(nuts, "nuts M3", Motion::Into, along(MOUNT_APART_MM + SMALL_APART_MM)),
        ]
    }

    /// The text of bolt and sheath stop.
    fn plate_hardware_words(&self) -> Vec<String> {
        let mut words = Vec::new();
        let Some(m) = &self.bill.mount else { return words };
        if self.design().has_board_joint() {
            words.push(
                "Bolt `rig-plate`, `rig-plate-2` and `rig-splice` together, with the splice behind the joint."
                    .to_owned(),
            );
        }
        let (bolt, head) = match (self.design().joint().is_some(), m.pulleys) {
            (true, _) => ("axle", "its head in the pocket"),
            (false, 2..) => ("bolts of the guide pulleys", "their heads in the pockets"),
            (false, _) => ("bolt of the axle", "its head in the pocket"),
        };
        if let Some(axle) = &m.axle {
            words.push(format!(
                "Put the {bolt} ({axle}) through {} from its outer face, with {head}.",
                self.plate_words()
            ));
        }
        words
    }

    fn sheath_stop_step(&self) -> Option<Step> {
        let hardware = self.bill.mount.as_ref()?.sheath_stop.as_ref()?;
        let moves = self.sheath_stop();
        Some(
            Step::new("Screw the sheath stop on")
                .text(format!(
                    "Screw `sheath-stop` to the inner face of {} ({hardware}). The end of the sheath rests on the step of its channel.",
                    self.plate_words()
                ))
                .risk("The stop is turned around.", "The wide end of its channel is toward the switch.")
                .picture(self.picture_from_right(moves)),
        )
    }

    /// Steps of a plate to which the switch is screwed: the plate is first, on the table.
    fn plate_on_the_table(&self) -> Vec<Step> {
        let has_bolt = !self.names(&["bolt"]).is_empty();
        let moves = self.plate_moves(true);
        let view = if has_bolt { FROM_BELOW } else { ON_BENCH };
        let mut step = Step::new("Prepare the mounting plate").text(format!(
            "Take {}. {}",
            self.plate_words(),
            self.plate_holes()
        ));
        for words in self.plate_hardware_words() {
            step = step.text(words);
        }
        let step = step.risk_if(
            self.has_left_recess(),
            "The plate is upside down.",
            "The heads protrude from it, because their recesses are on the other side.",
        );
        let step = step.risk_if(
            !self.has_left_recess(),
            "The plate is turned around.",
            "Its holes are not in line with those of the support.",
        );
        let step = step.picture(Illustration { view, ..self.picture(moves) });
        [Some(step), self.sheath_stop_step()].into_iter().flatten().collect()
    }

    /// Steps of a plate that is put on the left support.
    fn plate_on_the_support(&self) -> Vec<Step> {
        let mut moves = self.plate_moves(false);
        moves.insert(0, moving(self.plate(), "mounting plate", Motion::Into, along(-MOUNT_APART_MM)));
        let mut step = Step::new("Put the mounting plate on the left support");
        for words in self.plate_hardware_words() {
            step = step.text(words);
        }
        let step = step
            .text(format!(
                "Put {} on the outer face of the left support. The screws of the next step fasten it. {}",
                self.plate_words(),
                self.plate_holes()
            ))
            .risk("The plate is turned around.", "Its holes are not in line with those of the support.")
            .picture(self.picture(moves));
        [Some(step), self.sheath_stop_step()].into_iter().flatten().collect()
    }

    /// The guide pulley, on the rig or separate.
    fn pulley(&self) -> Option<Step> {
        let mount = self.bill.mount.as_ref();
        if let (Some(bearing), Some(axle)) =
            (mount.and_then(|m| m.bearing), mount.and_then(|m| m.axle.as_ref()))
        {
            let pulley = self.names(&[GUIDE_PULLEY]);
            let moves = vec![
                moving(self.names(&[SPACER]), "spacers", Motion::Into, along(SPACER_APART_MM)),
                moving(self.names(&["bearing"]), "", Motion::Into, along(PULLEY_APART_MM)),
                moving(pulley, "guide pulley with bearing", Motion::Into, along(PULLEY_APART_MM)),
                moving(
                    self.names(&["washer", "bolt-nut"]),
                    "washer and nut",
                    Motion::Into,
                    along(NUT_APART_MM),
                ),
            ];
            let (number, drive) = if self.design().has_drive_pulley() {
                ("each of the two guide pulleys", " `guide-pulley-2` leads it to the drive.")
            } else {
                ("`guide-pulley`", "")
            };
            return Some(
                Step::new("Mount the guide pulleys")
                    .text(format!(
                        "Press a {bearing} bearing into {number}. Put `pulley-spacer` on the bolt ({axle}), then the pulley with its bearing \
                         toward the board, washer and nut. A pulley turns freely, {} mm of tendon from the switch. `guide-pulley` leads the \
                         tendon to the load.{drive}",
                        self.design().configuration().mount.pulley_distance_mm
                    ))
                    .risk("The pulley drags.", "It stops at once after a push; turn the nut back by a quarter turn.")
                    .picture(scene(Bench::Switch, Upright::Axis, ON_BENCH, moves)),
            );
        }
        let bearing = self.bill.pulley_bearing?;
        Some(
            Step::new("Mount the guide pulley")
                .text(format!(
                    "Press a {bearing} bearing into `guide-pulley`, and mount it on an axle of 8 mm on the side of the load. The pulley \
                     leads the tendon to the load."
                ))
                .risk("The pulley is out of line.", "The tendon rubs on a flange.")
                .picture(still(Bench::Loose, vec![GUIDE_PULLEY.to_owned()], "guide pulley")),
        )
    }

    /// The distal link of a joint, on the axle.
    fn distal_link(&self) -> Option<Step> {
        let joint = self.design().joint()?;
        let m = self.bill.mount.as_ref()?;
        let [low, high] = joint.flexion_deg;
        let mut washers = self.names(&["axle-washer"]);
        let height = |name: &String| {
            let bounds = self.bodies.find(Bench::Switch, name).and_then(|item| item.mesh.bounds());
            bounds.map_or(0.0, |(low, _)| low.z)
        };
        washers.sort_by(|a, b| height(a).total_cmp(&height(b)));
        let outer = washers.split_off(washers.len().min(1));
        let moves = vec![
            moving(washers, "", Motion::Into, along(SMALL_APART_MM + MOUNT_APART_MM)),
            moving(self.names(&["link-distal"]), "distal link", Motion::Into, along(DISTAL_APART_MM)),
            moving(outer, "", Motion::Into, along(NUT_APART_MM)),
            moving(self.names(&["axle-nut"]), "washer and nut", Motion::Into, along(NUT_APART_MM)),
        ];
        Some(
            Step::new("Put the distal link on the axle")
                .text(format!(
                    "Put a washer on the axle, and the hub of `link-distal` on it, through the hollow of the shell, with its lug between the \
                     stops. Put the second washer and the self-locking nut on the axle. Tighten the nut until the link has no play, and loosen \
                     it until the link falls by its own weight. It turns from {low} to {high} deg of flexion, at which its lug meets a stop. \
                     Its {} holes of {} mm fasten it to the load.",
                    m.holes, m.hole_diameter_mm
                ))
                .risk("The nut is too tight.", "The link stays where it is left; loosen the nut by a quarter turn.")
                .picture(self.picture_from_right(moves)),
        )
    }

    /// How the tendon of a joint is guided and anchored.
    fn anchoring(&self) -> String {
        let (Some(joint), Some(sleeve)) =
            (self.design().joint(), self.bill.mount.as_ref().and_then(|m| m.crimp_sleeve.as_deref()))
        else {
            return String::new();
        };
        let [low, high] = joint.flexion_deg.map(|deg| joint.contact(deg).wrap_rad().to_degrees());
        format!(
            " That is the wrap in the picture, at a flexion of {} deg; it grows from {low:.1} to {high:.1} deg between the stops. Lead the \
             tendon from the motor through the channel of `link-proximal`, over the switch, and through the channel of `link-distal`. Crimp \
             a sleeve on its end ({sleeve}), which rests on the anchor.",
            joint.assembled_deg
        )
    }

    /// The feet of the rig.
    fn stand(&self) -> Option<Step> {
        let (layout, bolts) = (self.design().rig_layout()?, RigBolts::new(self.design())?);
        let foot_bolts = self.names(&["foot-bolt"]);
        let far = self.length_mm(&foot_bolts) + SMALL_APART_MM;
        let moves = vec![
            moving(
                self.names(&["rig-foot-left", "rig-foot-right"]),
                "feet",
                Motion::Into,
                along(-FEET_APART_MM),
            ),
            each(foot_bolts, "bolts M6", Motion::Into, self.toward_its_side("foot-bolt", far)),
            each(self.names(&["foot-washer"]), "", Motion::Still, along(0.0)),
            each(
                self.names(&["foot-nut"]),
                "",
                Motion::Into,
                self.toward_its_side("foot-nut", FEET_APART_MM),
            ),
        ];
        Some(
            Step::new("Put the board on its feet")
                .text(format!(
                    "Bolt `rig-foot-left` and `rig-foot-right` behind the board: 4 bolts M6 x {} from the front, with washers. Put the feet on \
                     the table, with the left end of the board {:.0} mm from its edge, so that the guide pulley of the load is beyond the edge. \
                     The load hangs {:.0} mm from the edge. Clamp both feet.",
                    bolts.foot_mm,
                    layout.board_x_mm[0] - layout.edge_x_mm,
                    layout.edge_x_mm - layout.load_x_mm
                ))
                .risk("The board is not upright.", "A weight on a thread does not hang parallel to it; put card under a foot.")
                .picture(scene(Bench::Switch, Upright::Grooves, RIG_VIEW, moves)),
        )
    }

    /// Cell, drive and load of the rig.
    fn drive(&self) -> Option<Step> {
        let c = self.design().configuration();
        let (layout, bolts) = (self.design().rig_layout()?, RigBolts::new(self.design())?);
        let (thread, number, mm) = bolts.cell;
        let cell = format!(
            "Bolt the load cell to `cell-mount` ({number} x M{thread} x {mm} in its open slots) and screw the eye bolt into its free end."
        );
        let along_mm = layout.drive.x - layout.board_x_mm[1];
        let drive = match c.rig.drive {
            DriveKind::Actuator => format!(
                "Bolt the actuator to `cell-mount` (M{0} x {1}, {2} washers under its eye) and to `actuator-foot` (M{0} x {3}). Clamp the \
                 foot with its bolt {along_mm:.0} mm from the right end of the board.",
                bolts.drive_thread_mm, bolts.pin_mm, layout.packing, bolts.axle_mm
            ),
            DriveKind::Crank => format!(
                "Bolt `crank-drum` to `crank-foot` (M8 x {}) and `crank-knob` to its lever. Clamp the foot with the axle {along_mm:.0} mm \
                 from the right end of the board. Tie a tendon from the bolt of `cell-mount` to the drum. The M5 bolt through a hole of the \
                 drum locks it.",
                bolts.axle_mm
            ),
        };
        let parts = self.names(&["cell-mount", "actuator-foot", "crank-foot", "crank-drum", "crank-knob"]);
        let bought = self.names(&[
            "load-cell",
            "cell-bolt",
            "eye-bolt",
            "line",
            "actuator",
            "drive-bolt",
            "drive-nut",
            "hook",
            "weight",
        ]);
        let moves = vec![placed(parts, "cell mount and drive"), placed(bought, "load cell and weights")];
        Some(
            Step::new("Mount cell, drive and load")
                .text(format!("{cell} {drive}"))
                .text(format!(
                    "Crimp the end of the tendon to the eye bolt, and the other end to the hook. With the load lifted, the weights stay below \
                     the table top; with the load lowered, they hang {} mm lower and clear the floor. `rig-bill.csv` lists everything to buy, \
                     `wiring.svg` shows the connections, and `run-sheet.html` lists the runs.",
                    c.rig.stroke_mm
                ))
                .risk("The weights touch the table.", "The reading of the cell jumps while they pass its edge; move the board outward.")
                .picture(scene(Bench::Switch, Upright::Grooves, RIG_VIEW, moves)),
        )
    }

    fn tendon(&self) -> Step {
        let c = self.design().configuration();
        let t = &self.bill.tendon;
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
            .picture(scene(Bench::Switch, Upright::Grooves, switch_view(self.design()), moves))
    }
}
