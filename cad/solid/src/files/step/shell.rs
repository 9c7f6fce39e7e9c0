//! The shell of a solid. Walls and caps of one ring share its edges.

use super::surface::{circle, face_surface, line, wall_surface};
use super::writer::{Id, StepWriter, list, raised, text};
use crate::mesh::Vector3;
use crate::profile::{Contour, Edge};
use crate::solid::{Facing, Solid};

/// Vertices and edges of a ring.
struct RingEdges {
    vertices: Vec<Id>,
    edges: Vec<Id>,
}

/// Writes the solid as a MANIFOLD_SOLID_BREP.
pub(super) fn manifold_solid(out: &mut StepWriter, name: &str, solid: &Solid) -> Id {
    let rings: Vec<RingEdges> = solid.rings().map(|(contour, z_mm)| ring_edges(out, contour, z_mm)).collect();
    let contours: Vec<(&Contour, f64)> = solid.rings().collect();
    let mut faces = Vec::new();
    for (lower, upper) in solid.walls() {
        wall_faces(out, [contours[lower], contours[upper]], [&rings[lower], &rings[upper]], &mut faces);
    }
    for (facing, members) in solid.caps() {
        let up = if facing == Facing::Up { 1.0 } else { -1.0 };
        let (contour, z_mm) = contours[members[0]];
        let surface = face_surface(out, raised(contour.corners()[0], z_mm), Vector3::z() * up);
        let bounds: Vec<Id> = members
            .iter()
            .enumerate()
            .map(|(i, ring)| {
                // Seen from the side that the cap faces, outlines run counter-clockwise and holes
                // clockwise.
                let counter_clockwise = contours[*ring].0.area_mm2() > 0.0;
                let along = counter_clockwise == ((i == 0) == (facing == Facing::Up));
                let kind = if i == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
                let steps: Vec<(Id, bool)> = rings[*ring].edges.iter().map(|e| (*e, along)).collect();
                bound(out, kind, if along { steps } else { steps.into_iter().rev().collect() })
            })
            .collect();
        faces.push(out.add(&format!("ADVANCED_FACE('',{},{surface},.T.)", list(&bounds))));
    }
    let shell = out.add(&format!("CLOSED_SHELL('',{})", list(&faces)));
    out.add(&format!("MANIFOLD_SOLID_BREP('{}',{shell})", text(name)))
}

fn ring_edges(out: &mut StepWriter, contour: &Contour, z_mm: f64) -> RingEdges {
    let vertices: Vec<Id> = contour
        .corners()
        .iter()
        .map(|p| {
            let point = out.point(raised(*p, z_mm));
            out.add(&format!("VERTEX_POINT('',{point})"))
        })
        .collect();
    let edges = contour
        .edges()
        .iter()
        .enumerate()
        .map(|(i, edge)| {
            let (from, to) = contour.ends(i);
            let (curve, forward) = match edge {
                Edge::Line => (line(out, raised(from, z_mm), raised(to, z_mm)), true),
                // A circle runs counter-clockwise, an arc in either direction.
                Edge::Arc(arc) => (circle(out, raised(arc.centre, z_mm), arc.radius_mm), arc.sweep_rad > 0.0),
            };
            edge_curve(out, vertices[i], vertices[(i + 1) % vertices.len()], curve, forward)
        })
        .collect();
    RingEdges { vertices, edges }
}

fn edge_curve(out: &mut StepWriter, from: Id, to: Id, curve: Id, forward: bool) -> Id {
    out.add(&format!("EDGE_CURVE('',{from},{to},{curve},{})", flag(forward)))
}

/// Writes the faces of a wall, one for each edge of its contours.
fn wall_faces(
    out: &mut StepWriter,
    [(lower, low), (upper, high)]: [(&Contour, f64); 2],
    [below, above]: [&RingEdges; 2],
    faces: &mut Vec<Id>,
) {
    let n = lower.corners().len();
    let sides: Vec<Id> = (0..n)
        .map(|i| {
            let curve = line(out, raised(lower.corners()[i], low), raised(upper.corners()[i], high));
            edge_curve(out, below.vertices[i], above.vertices[i], curve, true)
        })
        .collect();
    for i in 0..n {
        let next = (i + 1) % n;
        let (surface, same_sense) = wall_surface(out, [(lower, low), (upper, high)], i);
        let steps =
            vec![(below.edges[i], true), (sides[next], true), (above.edges[i], false), (sides[i], false)];
        let bound = bound(out, "FACE_OUTER_BOUND", steps);
        faces.push(out.add(&format!("ADVANCED_FACE('',({bound}),{surface},{})", flag(same_sense))));
    }
}

fn bound(out: &mut StepWriter, kind: &str, steps: Vec<(Id, bool)>) -> Id {
    let oriented: Vec<Id> = steps
        .into_iter()
        .map(|(edge, along)| out.add(&format!("ORIENTED_EDGE('',*,*,{edge},{})", flag(along))))
        .collect();
    let edge_loop = out.add(&format!("EDGE_LOOP('',{})", list(&oriented)));
    out.add(&format!("{kind}('',{edge_loop},.T.)"))
}

fn flag(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}
