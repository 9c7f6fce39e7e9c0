//! Shell, layer and dowels.

use super::super::document::Step;
use super::super::scenes::{along, each, moving, outward, placed, scene};
use super::{Assembly, SMALL_APART_MM};
use crate::built::BuiltPart;
use crate::config::MouldKind;
use crate::scene::{Bench, FROM_LEFT, Motion, Move, Upright};
use pinswitch_friction::pluralise;
use pinswitch_solid::render::View;

/// Distance of the bodies from their places in pictures, mm.
const BED_APART_MM: f64 = 9.0;

impl Assembly<'_> {
    /// Steps of the shell: inserts, layer or proxy, dowels.
    pub(super) fn shell(&self) -> Vec<Step> {
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

    /// The side of the shell that is up, by its engraving.
    pub(super) fn shell_face_words(&self) -> &'static str {
        let shell = self.built.printed().iter().map(BuiltPart::part).find(|p| p.name == "shell");
        if shell.is_some_and(|p| !p.engraved.is_empty()) {
            " The engraved face of the shell is up."
        } else {
            ""
        }
    }
}
