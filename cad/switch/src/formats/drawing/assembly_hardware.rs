//! Outlines of bought hardware on the sheet of the assembly: screws, nuts, dowels, the bearing and its bolt.

use crate::config::MountKind;
use crate::design::{Design, Thread};
use pinswitch_drafting::Layer;
use pinswitch_drafting::view::{Stroke, Trace};
use pinswitch_solid::profile::{Point2, Vector2, polar};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6};

/// Outer radius of a 608 bearing (ISO 15), and radii of an M8 bolt and an M3 screw, mm.
const BEARING_RADIUS_MM: f64 = 11.0;
const AXLE_RADIUS_MM: f64 = 4.0;
const STOP_SCREW_RADIUS_MM: f64 = 1.5;

/// Returns the positions of hardware of a kind in the front view, with its radius in mm.
pub(super) fn places(design: &Design, kind: &str) -> Vec<(Point2, f64)> {
    let around = |angles: Vec<f64>, radius_mm: f64| -> Vec<(Point2, f64)> {
        angles.into_iter().map(|a| (polar(design.fastener_radius_mm(), a), radius_mm)).collect()
    };
    let mounting = design.mounting();
    let axle = |radius_mm| -> Vec<(Point2, f64)> {
        mounting.iter().flat_map(|m| m.axles()).map(|h| (h.centre, radius_mm)).collect()
    };
    let f = &design.configuration().fasteners;
    match kind {
        "screw" => around(design.fastener_angles_rad(), shown_mm(design).unwrap_or(f.hole_diameter_mm / 2.0)),
        "dowel" => around(design.dowel_angles_rad(), f.dowel_diameter_mm / 2.0),
        "bearing" => axle(BEARING_RADIUS_MM),
        "axle" => {
            let joint = design.joint().map(|joint| (Point2::origin(), joint.axle.diameter_mm / 2.0));
            axle(AXLE_RADIUS_MM).into_iter().chain(joint).collect()
        }
        "stop screw" => {
            let screws = mounting.iter().filter_map(|m| m.sheath).flat_map(|s| s.screws);
            screws.map(|h| (h.centre, STOP_SCREW_RADIUS_MM)).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the lines of all hardware in the front view. Dowels are inside the supports and the bearing faces the plate, so
/// they are hidden; nuts or heads, the bolt and the screws of the sheath stop end on the near side.
pub(super) fn front(design: &Design) -> Vec<(Layer, Trace)> {
    let kinds = [
        ("screw", Layer::Visible),
        ("dowel", Layer::Hidden),
        ("bearing", Layer::Hidden),
        ("axle", Layer::Visible),
        ("stop screw", Layer::Visible),
    ];
    let circles = kinds.into_iter().flat_map(|(kind, layer)| {
        places(design, kind).into_iter().map(move |(at, radius_mm)| (layer, Trace::Circle(at, radius_mm)))
    });
    circles.chain(nuts(design).into_iter().map(|trace| (Layer::Visible, trace))).collect()
}

/// Radius of a screw in the front view, mm: of its head with inserts, else of its end in the nut.
fn shown_mm(design: &Design) -> Option<f64> {
    let thread = design.fastening().thread?;
    let has_head = design.fastening().insert_mm.is_some();
    Some(if has_head { thread.head_mm[0] / 2.0 } else { radius_mm(&thread)? })
}

/// Radius of a thread, mm, from its name.
fn radius_mm(thread: &Thread) -> Option<f64> {
    thread.name.strip_prefix('M')?.parse::<f64>().ok().map(|diameter| diameter / 2.0)
}

/// Nuts on the face of the right support. A nut in a trap has the outline of the trap, and is left out.
fn nuts(design: &Design) -> Vec<Trace> {
    let fastening = design.fastening();
    let Some(thread) =
        fastening.thread.filter(|_| fastening.insert_mm.is_none() && fastening.nut_trap.is_none())
    else {
        return Vec::new();
    };
    let corner_mm = thread.nut_mm[0] / 2.0 / libm::cos(FRAC_PI_6);
    let corner = |angle: f64, i: f64| {
        polar(design.fastener_radius_mm(), angle) + polar(corner_mm, angle + FRAC_PI_6 + i * FRAC_PI_3).coords
    };
    let sides = |angle: f64| {
        (0..6).map(move |i| Trace::Line(corner(angle, f64::from(i)), corner(angle, f64::from(i) + 1.0)))
    };
    design.fastener_angles_rad().into_iter().flat_map(sides).collect()
}

/// The parts of a screw and its nut outside of the switch: half of the width, and both ends along the axis, mm.
fn protrusions(design: &Design) -> Vec<[f64; 3]> {
    let (c, fastening) = (design.configuration(), design.fastening());
    let (Some(thread), Some((length_mm, _))) = (fastening.thread, design.screw_lengths_mm()) else {
        return Vec::new();
    };
    let depth = |recess: Option<crate::design::Recess>| recess.map_or(0.0, |r| r.depth_mm);
    let (left, head_depth) = if c.mount.kind == MountKind::None {
        (-c.support.plate_mm, depth(fastening.counterbore))
    } else {
        (-c.support.plate_mm - c.mount.plate_mm, depth(fastening.mount_counterbore))
    };
    let right = c.shell.width_mm + c.support.plate_mm;
    let head_mm = thread.head_mm[0] / 2.0;
    let mut all = vec![[head_mm, left + head_depth - thread.head_mm[1], left]];
    if fastening.insert_mm.is_some() {
        all.push([head_mm, right, right - depth(fastening.counterbore) + thread.head_mm[1]]);
    } else {
        let nut_end = right - depth(fastening.nut_trap) + thread.nut_mm[1];
        let half_nut = thread.nut_mm[0] / 2.0;
        all.push([half_nut, right, nut_end]);
        let tip = left + head_depth + length_mm;
        all.extend(radius_mm(&thread).map(|half| [half, nut_end.max(right), tip]));
    }
    all.retain(|[_, from, to]| to > from);
    all
}

/// Returns the outlines of heads, nuts and ends of screws in a side view, over the lowest point of the assembly. `across`
/// gives the position of a screw across the view, and `None` for one that is cut away.
pub(super) fn side_view(
    design: &Design,
    lowest_mm: f64,
    across: impl Fn(Vector2) -> Option<f64>,
) -> Vec<Stroke> {
    let blocks = protrusions(design);
    let screws =
        design.fastener_angles_rad().into_iter().map(|a| polar(design.fastener_radius_mm(), a).coords);
    let at = screws.filter_map(across);
    at.flat_map(|u| {
        blocks.iter().flat_map(move |[half, from, to]| {
            let (low, high) = (from - lowest_mm, to - lowest_mm);
            let corners = [[u - half, low], [u + half, low], [u + half, high], [u - half, high]];
            (0..4).map(move |i| [corners[i], corners[(i + 1) % 4]])
        })
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    fn design(assignments: &[&str]) -> Design {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        Design::new(c).unwrap()
    }

    #[test]
    fn heads_and_nuts_protrude_from_the_switch() {
        let plain = protrusions(&design(&["fasteners.kind=screw"]));
        // M3 x 25 through 20 mm: a head of 3 mm, a nut of 2.4 mm, and the end of the screw.
        let expected = [[2.75, -6.0, -3.0], [2.75, 17.0, 19.4], [1.5, 19.4, 22.0]];
        assert!(
            plain.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-9),
            "{plain:?}"
        );
        // A trap of 1.5 mm leaves 0.9 mm of the nut outside.
        assert!((protrusions(&design(&[]))[1][2] - 17.9).abs() < 1e-9);
        assert_eq!(nuts(&design(&[])).len(), 0);
        assert_eq!(nuts(&design(&["fasteners.kind=screw"])).len(), 12);
        let insert = protrusions(&design(&["fasteners.kind=insert"]));
        assert_eq!(insert.iter().map(|b| b[0]).collect::<Vec<_>>(), [2.75, 2.75]);
        // A flange contains all heads.
        assert!(protrusions(&design(&["mount.kind=flange"])).iter().all(|b| b[1] >= 17.0));
    }
}
