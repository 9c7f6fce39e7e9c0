//! The distal link of a joint, and the end of its tendon.

use super::super::document::Step;
use super::super::scenes::{along, along_with, on_axis};
use super::{Assembly, MOUNT_APART_MM, SMALL_APART_MM};
use crate::scene::{Bench, Motion};

/// Distance of the bodies from their places in pictures, mm.
const DISTAL_APART_MM: f64 = 48.0;
/// The same for the nut on the axle.
const AXLE_NUT_APART_MM: f64 = 60.0;

impl Assembly<'_> {
    /// The distal link of a joint, on the axle.
    pub(super) fn distal_link(&self) -> Option<Step> {
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
            along_with(washers, "washer", Motion::Into, along(SMALL_APART_MM + MOUNT_APART_MM)),
            on_axis(self.names(&["link-distal"]), "distal link", Motion::Into, along(DISTAL_APART_MM)),
            along_with(outer, "", Motion::Into, along(AXLE_NUT_APART_MM)),
            on_axis(self.names(&["axle-nut"]), "washer and nut", Motion::Into, along(AXLE_NUT_APART_MM)),
        ];
        Some(
            Step::new("Put the distal link on the axle")
                .text(format!(
                    "Put a washer on the axle, and the hub of `link-distal` on it, through the hollow of the shell, with its lug between the \
                     stops. Put the second washer and the self-locking nut on the axle. Tighten the nut until the link has no play, and loosen \
                     it until the link falls by its own weight. It turns from {low} to {high} deg of flexion, at which its lug meets a stop. \
                     Its {} holes of {} mm fasten what the finger carries, with screws of your own.",
                    m.holes, m.hole_diameter_mm
                ))
                .risk("The nut is too tight.", "The link stays where it is left; loosen the nut by a quarter turn.")
                .picture(self.picture_from_right(moves)),
        )
    }

    /// How the tendon of a joint is guided and anchored.
    pub(super) fn anchoring(&self) -> String {
        let (Some(joint), Some(sleeve)) =
            (self.design().joint(), self.bill.mount.as_ref().and_then(|m| m.crimp_sleeve.as_deref()))
        else {
            return String::new();
        };
        let [low, high] = joint.flexion_deg.map(|deg| joint.contact(deg).wrap_rad().to_degrees());
        format!(
            " The picture shows a flexion of {} deg. The contact grows with the flexion, from {low:.1} deg at the first stop to {high:.1} deg \
             at the other. Lead the tendon from the motor through the channel of `link-proximal`, over the switch, and through the \
             channel of `link-distal`, which is on the side of groove 1. Measure first, as in the section of use; then crimp a sleeve on \
             its end ({sleeve}), which rests on the anchor of `link-distal`.",
            joint.assembled_deg
        )
    }
}
