//! The exact solid in truck-modeling, and its tessellation by truck-meshalgo.
//!
//! Arcs are cut to at most 45 degrees: truck takes the extent of a plane from control points, and
//! longer arcs give wrong caps without an error (cad/doc/meshes.md, "Second kernel").

use truck_meshalgo::prelude::{
    Faces, MeshableShape, MeshedShape, OptimizingFilter, PolygonMesh, StandardAttributes,
};
use truck_modeling::{Point3 as TruckPoint, Shell, Solid as TruckSolid, Vertex, Wire, builder};

use super::kernel::KernelError;
use crate::mesh::{Mesh, Point3};
use crate::profile::{ChordTolerance, Contour, Edge, Point2};
use crate::solid::{Facing, Solid};
use crate::validity::is_closed;

/// Longest arc of an edge, radians.
const LONGEST_ARC_RAD: f64 = std::f64::consts::FRAC_PI_4;

/// Shares of the chord tolerance that are tried until the mesh is closed: at a coarse one, truck
/// may fold the facets of a narrow face over each other.
const TOLERANCE_SHARES: [f64; 3] = [1.0, 0.4, 0.1];

/// Builds the solid in truck and tessellates it.
///
/// # Errors
/// [`KernelError`] if truck refuses a face or the shell, or cannot tessellate a face.
pub(super) fn mesh(solid: &Solid, tolerance: ChordTolerance) -> Result<Mesh, KernelError> {
    let error = |problem: String| KernelError { kernel: "truck-modeling", problem };
    let exact = truck_solid(solid, tolerance).map_err(|e| error(e.to_string()))?;
    let mut mesh = Mesh::default();
    for share in TOLERANCE_SHARES {
        let meshed = exact.triangulation(share * tolerance.mm());
        let faces = meshed.boundaries().iter().flat_map(|shell| shell.face_iter());
        let missing = faces.filter(|face| face.surface().is_none()).count();
        if missing > 0 {
            return Err(error(format!("{missing} faces cannot be tessellated")));
        }
        mesh = welded(&meshed.to_polygon());
        if is_closed(&mesh) {
            break;
        }
    }
    Ok(mesh)
}

/// The exact solid: planes, and ruled surfaces between arcs. Twisted walls are cut into as many
/// faces as our mesh has pieces: truck tessellates a face without regard to its twist.
fn truck_solid(
    solid: &Solid,
    tolerance: ChordTolerance,
) -> Result<TruckSolid, truck_modeling::errors::Error> {
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let mut cuts: Vec<Vec<usize>> = rings.iter().map(|(contour, _)| cuts(contour)).collect();
    for (lower, upper) in solid.walls() {
        let twisted = rings[lower].0.wall_pieces(rings[upper].0, tolerance);
        cuts[lower].iter_mut().zip(twisted).for_each(|(n, pieces)| *n = pieces.max(*n));
    }
    let cuts = solid.matched_counts(cuts);
    let wires: Vec<Wire> =
        rings.iter().zip(&cuts).map(|((contour, z_mm), cuts)| wire(contour, cuts, *z_mm)).collect();
    let mut shell = Shell::new();
    for (lower, upper) in solid.walls() {
        shell.extend(builder::try_wire_homotopy(&wires[lower], &wires[upper])?);
    }
    for (facing, members) in solid.caps() {
        // Seen from the side that the cap faces, outlines run counter-clockwise and holes
        // clockwise.
        let oriented = |(i, ring): (usize, usize)| {
            let is_counter_clockwise = rings[ring].0.area_mm2() > 0.0;
            let keeps = is_counter_clockwise == ((i == 0) == (facing == Facing::Up));
            if keeps { wires[ring].clone() } else { wires[ring].inverse() }
        };
        let boundary: Vec<Wire> = members.into_iter().enumerate().map(oriented).collect();
        shell.push(builder::try_attach_plane(&boundary)?);
    }
    TruckSolid::try_new(vec![shell]).map_err(Into::into)
}

/// Pieces per edge.
fn cuts(contour: &Contour) -> Vec<usize> {
    let pieces = |edge: &Edge| match edge {
        Edge::Line => 1,
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        Edge::Arc(arc) => (arc.sweep_rad.abs() / LONGEST_ARC_RAD - 1e-9).ceil().max(1.0) as usize,
    };
    contour.edges().iter().map(pieces).collect()
}

/// The contour at a height. Every vertex is made once, since truck shares vertices by identity.
fn wire(contour: &Contour, cuts: &[usize], z_mm: f64) -> Wire {
    let at = |p: Point2| TruckPoint::new(p.x, p.y, z_mm);
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut middles: Vec<Option<TruckPoint>> = Vec::new();
    for (i, (edge, n)) in contour.edges().iter().zip(cuts).enumerate() {
        let (from, to) = contour.ends(i);
        for k in 0..*n {
            let share = |halves: usize| halves as f64 / (2 * n) as f64;
            let (start, middle) = match edge {
                Edge::Line => (from + (to - from) * share(2 * k), None),
                Edge::Arc(arc) => {
                    let on = |halves| arc.point_at(share(halves), arc.radius_mm);
                    (if k == 0 { from } else { on(2 * k) }, Some(at(on(2 * k + 1))))
                }
            };
            vertices.push(builder::vertex(at(start)));
            middles.push(middle);
        }
    }
    (0..vertices.len())
        .map(|i| {
            let (from, to) = (&vertices[i], &vertices[(i + 1) % vertices.len()]);
            match middles[i] {
                Some(transit) => builder::circle_arc(from, to, transit),
                None => builder::line(from, to),
            }
        })
        .collect()
}

/// The polygon with equal positions merged. Merging normals and texture coordinates, too, takes
/// quadratic time.
fn welded(polygon: &PolygonMesh) -> Mesh {
    let triangles: Vec<[usize; 3]> = polygon.faces().triangle_iter().map(|t| t.map(|v| v.pos)).collect();
    let attributes =
        StandardAttributes { positions: polygon.positions().clone(), ..StandardAttributes::default() };
    let mut clean = PolygonMesh::new(attributes, Faces::from_iter(triangles));
    clean.put_together_same_attrs(truck_modeling::TOLERANCE).remove_degenerate_faces().remove_unused_attrs();
    let positions = clean.positions().iter().map(|p| Point3::new(p.x, p.y, p.z)).collect();
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    Mesh::new(positions, clean.faces().triangle_iter().map(|t| t.map(|v| index(v.pos))).collect())
}
