//! The exact boundary representation in truck-modeling, and its own tessellation as an independent check.
//!
//! Arcs are cut to at most 45 degrees: truck takes a plane's extent from control points, and longer arcs ruin caps
//! silently (cad/doc/meshes.md, "What truck is used for").

use truck_meshalgo::prelude::{
    Faces, MeshableShape, MeshedShape, OptimizingFilter, PolygonMesh, ShellCondition, StandardAttributes,
    Topology,
};
use truck_modeling::{Point3 as TruckPoint, Shell, Solid as TruckSolid, Vertex, Wire, builder};

use super::{Cap, Facing, RingId, Solid};
use crate::mesh::{Mesh, Point3};
use crate::profile::{ChordTolerance, Contour, Edge};

/// Longest arc of an edge, radians.
const LONGEST_ARC_RAD: f64 = std::f64::consts::FRAC_PI_4;

/// Why truck refuses a solid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BrepError {
    /// Walls, caps or the closed shell could not be built.
    #[error("truck: {0}")]
    Truck(#[from] truck_modeling::errors::Error),
    /// The shell is not oriented and closed.
    #[error("truck: {0}")]
    NotClosed(String),
    /// Faces that truck could not tessellate.
    #[error("truck could not tessellate {0} faces")]
    Faces(usize),
}

/// Truck's own tessellation of a solid.
#[derive(Clone, Debug)]
pub struct BrepMesh {
    /// Whether the mesh is closed and oriented.
    pub closed: bool,
    /// The triangles.
    pub mesh: Mesh,
}

impl Solid {
    /// The exact solid: planes, and ruled surfaces between arcs.
    ///
    /// # Errors
    /// [`BrepError`] if truck finds the shell not closed and oriented.
    pub fn brep(&self) -> Result<TruckSolid, BrepError> {
        let cuts = self.matched_counts(self.rings.iter().map(|ring| cuts(&ring.contour)).collect());
        let wires: Vec<Wire> =
            self.rings.iter().zip(&cuts).map(|(ring, cuts)| wire(&ring.contour, cuts, ring.z_mm)).collect();
        let mut shell = Shell::new();
        for wall in &self.walls {
            shell.extend(builder::try_wire_homotopy(&wires[wall.lower.0], &wires[wall.upper.0])?);
        }
        for cap in &self.caps {
            shell.push(builder::try_attach_plane(&self.cap_wires(cap, &wires))?);
        }
        TruckSolid::try_new(vec![shell]).map_err(|e| BrepError::NotClosed(e.to_string()))
    }

    /// Outline counter-clockwise and holes clockwise, seen from the side that the cap faces.
    fn cap_wires(&self, cap: &Cap, wires: &[Wire]) -> Vec<Wire> {
        let turned = |(i, RingId(ring)): (usize, &RingId)| {
            let counter_clockwise = self.rings[*ring].contour.area_mm2() > 0.0;
            let wanted = (i == 0) == (cap.facing == Facing::Up);
            if counter_clockwise == wanted { wires[*ring].clone() } else { wires[*ring].inverse() }
        };
        cap.rings.iter().enumerate().map(turned).collect()
    }

    /// Truck's own tessellation of [`Self::brep`].
    ///
    /// # Errors
    /// [`BrepError`] if the solid cannot be built or a face cannot be tessellated.
    pub fn brep_mesh(&self, tolerance: ChordTolerance) -> Result<BrepMesh, BrepError> {
        let meshed = self.brep()?.triangulation(tolerance.mm());
        let missing = meshed
            .boundaries()
            .iter()
            .flat_map(|shell| shell.face_iter())
            .filter(|f| f.surface().is_none())
            .count();
        if missing > 0 {
            return Err(BrepError::Faces(missing));
        }
        // Positions only: truck's cleaning also merges uv and normals, which is quadratic here (cad/doc/meshes.md).
        let polygon = meshed.to_polygon();
        let triangles: Vec<[usize; 3]> = polygon.faces().triangle_iter().map(|t| t.map(|v| v.pos)).collect();
        let attributes =
            StandardAttributes { positions: polygon.positions().clone(), ..StandardAttributes::default() };
        let mut clean = PolygonMesh::new(attributes, Faces::from_iter(triangles));
        clean
            .put_together_same_attrs(truck_modeling::TOLERANCE)
            .remove_degenerate_faces()
            .remove_unused_attrs();
        let closed = clean.shell_condition() == ShellCondition::Closed;
        Ok(BrepMesh { closed, mesh: ours(&clean) })
    }
}

fn ours(polygon: &PolygonMesh) -> Mesh {
    let positions = polygon.positions().iter().map(|p| Point3::new(p.x, p.y, p.z)).collect();
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let triangles = polygon.faces().triangle_iter().map(|t| t.map(|v| index(v.pos))).collect();
    Mesh::new(positions, triangles)
}

/// Pieces per edge.
fn cuts(contour: &Contour) -> Vec<usize> {
    contour
        .edges()
        .iter()
        .map(|edge| match edge {
            Edge::Line => 1,
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Edge::Arc(arc) => (arc.sweep_rad.abs() / LONGEST_ARC_RAD - 1e-9).ceil().max(1.0) as usize,
        })
        .collect()
}

/// The contour at a height, every vertex made once: truck shares vertices by identity (cad/doc/meshes.md).
fn wire(contour: &Contour, cuts: &[usize], z_mm: f64) -> Wire {
    let at = |p: crate::profile::Point2| TruckPoint::new(p.x, p.y, z_mm);
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut middles: Vec<Option<TruckPoint>> = Vec::new();
    for ((corner, edge), n) in contour.corners().iter().zip(contour.edges()).zip(cuts) {
        for k in 0..*n {
            let share = |halves: usize| halves as f64 / (2 * n) as f64;
            let (start, middle) = match edge {
                Edge::Line => (*corner, None),
                Edge::Arc(arc) => {
                    let on = |halves| arc.point_at(share(halves), arc.radius_mm);
                    (if k == 0 { *corner } else { on(2 * k) }, Some(at(on(2 * k + 1))))
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
