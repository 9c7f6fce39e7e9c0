//! The plate on which the switch is mounted.

use super::super::document::Step;
use super::super::scenes::{FROM_BELOW, ON_BENCH, along, each, moving, placed};
use super::{Assembly, MOUNT_APART_MM, SMALL_APART_MM};
use crate::config::MountKind;
use crate::scene::{Illustration, Motion, Move};
use pinswitch_solid::mesh::Vector3;

impl Assembly<'_> {
    /// The names of the mounting plate.
    pub(super) fn plate(&self) -> Vec<String> {
        self.names(&["base-flange", "link-proximal", "rig-plate"])
    }

    pub(super) fn plate_words(&self) -> String {
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
                "Its {} holes of {} mm fasten the finished finger to its base, with screws of your own.",
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
    pub(super) fn toward_its_side(&self, stem: &str, far_mm: f64) -> Vector3 {
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
                "Of {axle}, put the {bolt} through {} from the outer face, with {head}{}.",
                self.plate_words(),
                if self.design().joint().is_some() {
                    ", and hold it with adhesive tape; washers and nut follow later"
                } else {
                    ""
                }
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
    pub(super) fn plate_on_the_table(&self) -> Vec<Step> {
        let has_bolt = !self.names(&["bolt", "axle"]).is_empty();
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
    pub(super) fn plate_on_the_support(&self) -> Vec<Step> {
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
}
