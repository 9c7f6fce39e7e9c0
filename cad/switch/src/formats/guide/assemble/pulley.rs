//! The guide pulleys.

use super::super::document::Step;
use super::super::scenes::{ON_BENCH, along, along_with, each, scene, still};
use super::{Assembly, NUT_APART_MM};
use crate::parts::SPACER;
use crate::scene::{Bench, GUIDE_PULLEY, Motion, Upright};

/// Distance of the bodies from their places in pictures, mm.
const SPACER_APART_MM: f64 = 26.0;
const PULLEY_APART_MM: f64 = 32.0;

impl Assembly<'_> {
    /// The guide pulley, on the rig or separate.
    pub(super) fn pulley(&self) -> Option<Step> {
        let mount = self.bill.mount.as_ref();
        if let (Some(bearing), Some(axle)) =
            (mount.and_then(|m| m.bearing), mount.and_then(|m| m.axle.as_ref()))
        {
            let pulley = self.names(&[GUIDE_PULLEY]);
            let moves = vec![
                along_with(self.names(&[SPACER]), "spacers", Motion::Into, along(SPACER_APART_MM)),
                along_with(self.names(&["bearing"]), "", Motion::Into, along(PULLEY_APART_MM)),
                each(pulley, "guide pulley with bearing", Motion::Into, along(PULLEY_APART_MM)),
                along_with(
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
}
