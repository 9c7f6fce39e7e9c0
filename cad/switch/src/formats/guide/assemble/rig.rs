//! The rig: its feet, load cell, drive and load.

use super::super::document::Step;
use super::super::scenes::{along, each, moving, placed, scene};
use super::{Assembly, SMALL_APART_MM};
use crate::config::DriveKind;
use crate::rig::RigBolts;
use crate::scene::{Bench, Motion, RIG_VIEW, Upright};

/// Distance of the bodies from their places in pictures, mm.
const FEET_APART_MM: f64 = 40.0;

impl Assembly<'_> {
    /// The feet of the rig.
    pub(super) fn stand(&self) -> Option<Step> {
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
    pub(super) fn drive(&self) -> Option<Step> {
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
}
