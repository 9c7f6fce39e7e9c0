//! Curves and surfaces: lines, circles, planes, cylinders, cones, and ruled B-spline surfaces for
//! twisted walls.

use std::f64::consts::{PI, TAU};

use super::writer::{Id, StepWriter, list, raised, real};
use crate::mesh::{Point3, Vector3};
use crate::profile::{Arc, Contour, Edge};

/// Difference of lengths, in mm, and of angles, in rad, up to which they are equal.
const SAME: f64 = 1e-9;
/// Largest angle of a rational piece of a wall between arcs, rad. A wall joins its arcs at equal
/// shares of their angles, a rational piece at equal parameters, which agree only at its ends. With
/// pieces of a quarter turn, the relative error of the volume of a chamfered part was 5e-5; it
/// falls with the square of the angle.
const LARGEST_PIECE_RAD: f64 = PI / 32.0;

pub(super) fn line(out: &mut StepWriter, from: Point3, to: Point3) -> Id {
    let along = to - from;
    let start = out.point(from);
    let direction = out.direction(along.normalize());
    let vector = out.add(&format!("VECTOR('',{direction},{})", real(along.norm())));
    out.add(&format!("LINE('',{start},{vector})"))
}

/// Writes a circle, counter-clockwise seen from above.
pub(super) fn circle(out: &mut StepWriter, centre: Point3, radius_mm: f64) -> Id {
    let frame = out.placement(centre, Vector3::z(), Vector3::x());
    out.add(&format!("CIRCLE('',{frame},{})", real(radius_mm)))
}

/// Writes a plane through `at` with its normal out of the material.
pub(super) fn face_surface(out: &mut StepWriter, at: Point3, normal: Vector3) -> Id {
    let normal = normal.normalize();
    // Any direction in the plane: the cross product with an axis that is far from parallel to the
    // normal.
    let across = if normal.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let frame = out.placement(at, normal, normal.cross(&across).normalize());
    out.add(&format!("PLANE('',{frame})"))
}

/// Writes the surface of edge `i` of a wall between two contours at heights; returns it and whether
/// its normal points out of the material.
pub(super) fn wall_surface(
    out: &mut StepWriter,
    [(lower, low), (upper, high)]: [(&Contour, f64); 2],
    i: usize,
) -> (Id, bool) {
    let (from, to) = lower.ends(i);
    let (above_from, above_to) = upper.ends(i);
    match (lower.edges()[i], upper.edges()[i]) {
        (Edge::Arc(a), Edge::Arc(b)) => {
            let coaxial = (a.centre - b.centre).norm() < SAME
                // The same direction modulo full turns.
                && (b.start_rad - a.start_rad + PI).rem_euclid(TAU) - PI < SAME
                && (a.start_rad - b.start_rad + PI).rem_euclid(TAU) - PI < SAME
                && (a.sweep_rad - b.sweep_rad).abs() < SAME;
            let outward = a.sweep_rad > 0.0;
            if coaxial && (a.radius_mm - b.radius_mm).abs() < SAME {
                let frame = out.placement(raised(a.centre, low), Vector3::z(), Vector3::x());
                (out.add(&format!("CYLINDRICAL_SURFACE('',{frame},{})", real(a.radius_mm))), outward)
            } else if coaxial {
                (cone(out, (&a, low), (&b, high)), outward)
            } else {
                (ruled_arcs(out, (&a, low), (&b, high)), true)
            }
        }
        _ => {
            let corners =
                [raised(from, low), raised(to, low), raised(above_to, high), raised(above_from, high)];
            let normal = (corners[1] - corners[0]).cross(&(corners[3] - corners[0]));
            let out_of_plane = normal.normalize().dot(&(corners[2] - corners[0])).abs();
            if out_of_plane < SAME {
                (face_surface(out, corners[0], normal), true)
            } else {
                (bilinear(out, corners), true)
            }
        }
    }
}

/// Writes a cone about a vertical axis. It widens along its axis, as the format requires.
fn cone(out: &mut StepWriter, (a, low): (&Arc, f64), (b, high): (&Arc, f64)) -> Id {
    let widens_upwards = b.radius_mm > a.radius_mm;
    let (narrow, z_mm, up) = if widens_upwards { (a, low, 1.0) } else { (b, high, -1.0) };
    let half_angle = libm::atan((b.radius_mm - a.radius_mm).abs() / (high - low));
    let frame = out.placement(raised(narrow.centre, z_mm), Vector3::z() * up, Vector3::x());
    out.add(&format!("CONICAL_SURFACE('',{frame},{},{})", real(narrow.radius_mm), real(half_angle)))
}

/// Control points and weights of an arc in rational quadratic pieces.
fn arc_poles(arc: &Arc, z_mm: f64, pieces: usize) -> Vec<(Point3, f64)> {
    let half = arc.sweep_rad / (2 * pieces) as f64;
    (0..=2 * pieces)
        .map(|k| {
            let fraction = k as f64 / (2 * pieces) as f64;
            if k % 2 == 0 {
                (raised(arc.point_at(fraction, arc.radius_mm), z_mm), 1.0)
            } else {
                (raised(arc.point_at(fraction, arc.radius_mm / libm::cos(half)), z_mm), libm::cos(half))
            }
        })
        .collect()
}

/// Writes the ruled surface between two arcs: rational, quadratic along the arcs, with exact arcs
/// as edges.
fn ruled_arcs(out: &mut StepWriter, (a, low): (&Arc, f64), (b, high): (&Arc, f64)) -> Id {
    let largest = a.sweep_rad.abs().max(b.sweep_rad.abs());
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let pieces = (largest / LARGEST_PIECE_RAD - SAME).ceil().max(1.0) as usize;
    let (below, above) = (arc_poles(a, low, pieces), arc_poles(b, high, pieces));
    let rows: Vec<String> = below
        .iter()
        .zip(&above)
        .map(|((p, _), (q, _))| {
            let pair = [out.point(*p), out.point(*q)];
            list(&pair)
        })
        .collect();
    let weights: Vec<String> =
        below.iter().zip(&above).map(|((_, v), (_, w))| format!("({},{})", real(*v), real(*w))).collect();
    let inner = ",2".repeat(pieces - 1);
    let knots: Vec<String> = (0..=pieces).map(|k| real(k as f64)).collect();
    out.add(&format!(
        "(BOUNDED_SURFACE() B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.F.,.F.,.F.) \
         B_SPLINE_SURFACE_WITH_KNOTS((3{inner},3),(2,2),({}),(0.0,1.0),.UNSPECIFIED.) GEOMETRIC_REPRESENTATION_ITEM() \
         RATIONAL_B_SPLINE_SURFACE(({})) REPRESENTATION_ITEM('') SURFACE())",
        rows.join(","),
        knots.join(","),
        weights.join(",")
    ))
}

/// Writes the ruled surface between two lines that are not parallel; corners counter-clockwise from
/// outside, lower ones first.
fn bilinear(out: &mut StepWriter, corners: [Point3; 4]) -> Id {
    let [a, b, c, d] = corners.map(|p| out.point(p));
    out.add(&format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,(({a},{d}),({b},{c})),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.0,1.0),\
         (0.0,1.0),.UNSPECIFIED.)"
    ))
}
