//! Screws, nuts, inserts and glue.

use super::super::document::Step;
use super::super::scenes::{along, each};
use super::{Assembly, SMALL_APART_MM};
use crate::scene::Motion;
use pinswitch_friction::pluralise;

impl Assembly<'_> {
    pub(super) fn screw_words(&self) -> String {
        let Some(f) = &self.bill.fasteners else { return String::new() };
        format!("{} {} x {}", pluralise(f.number, "screw"), f.thread, f.length_mm)
    }

    /// Heads that are not in a recess protrude below the part.
    pub(super) fn pad_words(&self) -> &'static str {
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
    pub(super) fn has_left_recess(&self) -> bool {
        let fastening = self.design().fastening();
        if self.plate().is_empty() {
            fastening.counterbore.is_some()
        } else {
            fastening.mount_counterbore.is_some()
        }
    }

    /// The skin above the recesses of a part; empty without recesses.
    pub(super) fn skin_words(&self, has_recess: bool) -> String {
        if !has_recess {
            return String::new();
        }
        format!(
            " A skin of {} mm closes the hole at every recess of this part, so that it prints without support. Push a screw through it \
             before, and remove the pieces.",
            self.design().membrane_mm()
        )
    }

    /// The layer bulges: the screws are not tightened over silicone.
    fn tight_words(&self) -> &'static str {
        if self.is_silicone() { ", until the supports touch the shell and no further" } else { "" }
    }

    pub(super) fn nuts(&self) -> Step {
        let fastening = self.design().fastening();
        let nuts = self.names(&["nut"]);
        let (number, far) = (nuts.len(), self.length_mm(&nuts) + SMALL_APART_MM);
        let thread = self.bill.fasteners.as_ref().map_or("", |f| f.thread);
        let label = format!("{} {thread}", pluralise(number, "nut"));
        let (place, turn) = match (fastening.nut_trap.is_some(), number) {
            (true, 1) => (
                "Put the nut into the trap of the right support, with adhesive tape over it",
                "Turn the stack over onto this face, and remove the tape from the head of the screw",
            ),
            (true, _) => (
                "Put the nuts into the traps of the right support, with adhesive tape over them",
                "Turn the stack over onto this face, and remove the tape from the heads of the screws",
            ),
            (false, 1) => {
                ("Put the nut on the screw", "Hold the stack together, and remove the tape from the head")
            }
            (false, _) => {
                ("Put the nuts on the screws", "Hold the stack together, and remove the tape from the heads")
            }
        };
        let moves = vec![each(nuts, label, Motion::Into, along(far))];
        let title = if number == 1 { "Fasten the nut" } else { "Fasten the nuts" };
        Step::new(title)
            .text(format!("{place}. {turn}. Tighten the {}{}.", self.screw_words(), self.tight_words()))
            .risk_if(
                fastening.nut_trap.is_some(),
                "A nut is not in its trap.",
                "It turns with the screw; press it into the trap with a finger.",
            )
            .risk_if(
                fastening.nut_trap.is_none(),
                "A nut is loose.",
                "The supports move against the shell; hold the nut with the spanner and turn the screw.",
            )
            .risk_if(
                self.bill.pins.number > 0 && self.is_silicone(),
                "The screws are too tight.",
                "A pin does not return after it is pressed in; loosen the screws by a quarter turn.",
            )
            .picture(self.picture(moves))
    }

    pub(super) fn insert_screws(&self, screws: Vec<String>, from_right: bool) -> Step {
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

    pub(super) fn glue_words(&self) -> String {
        let dowels = if self.bill.dowels.is_some() { " The dowels locate the supports." } else { "" };
        let supports = if dowels.is_empty() { "the plates of both supports" } else { "the supports" };
        format!(
            "This set has no screws (`fasteners.count = 0`).{dowels} Glue {supports} to the ends of the shell with {}. \
             Keep slots and grooves free of it.",
            self.design().configuration().process.material.data().glue
        )
    }
}
