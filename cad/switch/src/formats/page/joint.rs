//! The tendon of a joint at several flexions, for the animation of the page.

use serde::Serialize;

use crate::design::{Design, Joint, JointContact};
use crate::parts::DISTAL;
use pinswitch_solid::profile::Point2;

/// Number of flexions between the stops.
const FLEXIONS: u32 = 60;
/// Largest angle between neighbouring points on an arc, radians.
const STEP_RAD: f64 = 0.04;

/// The joint between its stops.
#[derive(Debug, Serialize)]
pub(super) struct JointStates {
    /// Flexion of the assembly, degrees.
    assembled_deg: f64,
    /// Flexions of `paths`, degrees, ascending from stop to stop.
    flexion_deg: Vec<f64>,
    /// Wrap angle at each flexion, degrees.
    wrap_deg: Vec<f64>,
    /// Axis of the taut tendon at each flexion, from the proximal to the distal link.
    paths: Vec<Vec<[f64; 2]>>,
    /// Bodies that turn with the distal link.
    moving: Vec<&'static str>,
    z_mm: f64,
    tendon_radius_mm: f64,
}

impl JointStates {
    /// Returns the states of a joint; `None` without one.
    pub(super) fn new(design: &Design) -> Option<Self> {
        let joint = design.joint()?;
        let [low, high] = joint.flexion_deg;
        let share = |i: u32| low + (high - low) * f64::from(i) / f64::from(FLEXIONS);
        let contacts: Vec<JointContact> = (0..=FLEXIONS).map(|i| joint.contact(share(i))).collect();
        Some(Self {
            assembled_deg: joint.assembled_deg,
            flexion_deg: contacts.iter().map(|contact| contact.flexion_deg).collect(),
            wrap_deg: contacts.iter().map(|contact| contact.wrap_rad().to_degrees()).collect(),
            paths: contacts.iter().map(|contact| path(&joint, contact)).collect(),
            moving: vec![DISTAL],
            z_mm: joint.levels.tendon_mm,
            tendon_radius_mm: design.tendon_diameter_mm() / 2.0,
        })
    }
}

/// Points on the axis of the tendon: its ends, the mouths of guide and anchor, and points on each arc.
fn path(joint: &Joint, contact: &JointContact) -> Vec<[f64; 2]> {
    let arcs = contact.arcs.iter().flat_map(|arc| {
        let disc = joint.discs()[arc.disc];
        let sweep = arc.to_rad - arc.from_rad;
        let pieces = (sweep / STEP_RAD).ceil().max(1.0);
        let at = move |i: f64| {
            let angle = arc.from_rad + sweep * i / pieces;
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            Point2::new(disc.centre.x + disc.radius_mm * cos, disc.centre.y + disc.radius_mm * sin)
        };
        std::iter::successors(Some(0.0), move |i| (*i < pieces).then_some(i + 1.0)).map(at)
    });
    [joint.proximal_end(), joint.proximal.mouth()]
        .into_iter()
        .chain(arcs)
        .chain([contact.anchor, joint.distal_end(contact)])
        .map(|p| [p.x, p.y])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::read;

    fn design(text: &str) -> Design {
        Design::new(read(text, "x.toml").unwrap().0).unwrap()
    }

    /// Its ends do not slide: a path that is longer by the growth of the wrap would be another tendon, so that the tendon
    /// moves through the guide by its moment arm.
    #[test]
    fn paths_lengthen_by_the_moment_arm() {
        let design = design("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"joint\"\n");
        let states = JointStates::new(&design).unwrap();
        let joint = design.joint().unwrap();
        assert_eq!((states.flexion_deg[0], states.flexion_deg[60]), (0.0, 75.0));
        let length = |path: &Vec<[f64; 2]>| -> f64 {
            path.windows(2).map(|w| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1])).sum()
        };
        for i in 0..60 {
            let longer = length(&states.paths[i + 1]) - length(&states.paths[i]);
            let turned = (states.flexion_deg[i + 1] - states.flexion_deg[i]).to_radians();
            let middle = joint.contact(f64::midpoint(states.flexion_deg[i], states.flexion_deg[i + 1]));
            assert!((longer - turned * middle.moment_arm_mm).abs() < 2e-3, "{i}: {longer}");
        }
        assert!(JointStates::new(&self::design("")).is_none());
    }
}
