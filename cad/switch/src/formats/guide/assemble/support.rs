//! The supports: left and right, their lips and faces.

use super::super::document::Step;
use super::super::scenes::{along, moving};
use super::{Assembly, Fixing, SUPPORT_APART_MM};
use crate::built::BuiltPart;
use crate::parts::{LeftOut, Part};
use crate::scene::Motion;
use pinswitch_solid::mesh::Vector3;

impl Assembly<'_> {
    pub(super) fn left_support_step(&self, title: &str, by: Vector3) -> Step {
        let lip = if self.fixing() == Fixing::Studs { String::new() } else { self.lip_words() };
        let face = if lip.is_empty() { self.inner_face_words() } else { "" };
        let target = if self.fixing() == Fixing::Studs { "over the screws" } else { "on the shell" };
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

    pub(super) fn right_support_step(&self, title: &str) -> Step {
        let slides = match (self.bill.pins.number > 0, self.is_silicone()) {
            (true, true) => " Every pin must slide to the end of its slot and back.",
            (true, false) => " Every pin must rest in its groove of the proxy.",
            (false, _) => "",
        };
        let target = if self.fixing() == Fixing::Studs { "over the screws" } else { "on the shell" };
        let engages =
            if self.bill.pins.number > 0 { ", and guide every pin into its slot with tweezers" } else { "" };
        let glue = if self.fixing() == Fixing::Glue {
            " Glue it like the left one, and let the glue set before the first load."
        } else {
            ""
        };
        let has_trap = self.fixing() == Fixing::Studs && self.design().fastening().nut_trap.is_some();
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

    /// The inner face of a support, by what is on it.
    fn inner_face_words(&self) -> &'static str {
        match (self.design().slot_angles_rad().is_empty(), self.has_lip()) {
            (false, _) => ", with its slots toward the shell",
            (true, true) => ", with its lip toward the shell",
            (true, false) => "",
        }
    }

    pub(super) fn has_lip(&self) -> bool {
        self.design().configuration().support.lip_depth_mm > 0.0 && !self.has_lost(LeftOut::Lip)
    }

    pub(super) fn bed_edge(&self) -> &'static str {
        if self.is_silicone() { "layer" } else { "proxy" }
    }

    pub(super) fn lip_words(&self) -> String {
        if self.has_lip() {
            format!(", and its lip is over the edge of the {}", self.bed_edge())
        } else {
            String::new()
        }
    }

    /// Returns whether a support lacks a feature that does not fit.
    pub(super) fn has_lost(&self, what: LeftOut) -> bool {
        self.supports().any(|part| part.left_out.contains(&what))
    }

    pub(super) fn supports(&self) -> impl Iterator<Item = &Part> {
        self.built.printed().iter().map(BuiltPart::part).filter(|p| p.name.starts_with("support"))
    }
}
