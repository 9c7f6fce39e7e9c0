//! Where a solid stands in the assembly: relationships between representations, followed up to the outermost.

use std::collections::BTreeMap;

use nalgebra::{Matrix4, Vector3, Vector4};
use ruststep::ast::Parameter;

use super::entities::{Entities, entity, list};

/// A motion without change of shape, as a matrix; millimetres.
pub(super) type Isometry = Matrix4<f64>;

/// Most ways up from a part: an assembly of assemblies multiplies.
const MOST_PLACES: usize = 1000;
/// Assemblies within assemblies.
const MAX_DEPTH: usize = 32;

/// Which representation stands in which, and how it is moved there.
pub(super) struct Placements<'a> {
    entities: &'a Entities,
    parents: BTreeMap<u64, Vec<(u64, Isometry)>>,
    unit_mm: f64,
}

impl<'a> Placements<'a> {
    pub(super) fn of(entities: &'a Entities, unit_mm: f64) -> Self {
        let mut placements = Self { entities, parents: BTreeMap::new(), unit_mm };
        for (id, parameters) in entities.of_kind("REPRESENTATION_RELATIONSHIP") {
            let [_, _, child, parent] = parameters else { continue };
            let moved = entities
                .record(id, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")
                .and_then(|moved| moved.first().and_then(entity));
            placements.add(entity(child), entity(parent), moved);
        }
        // The same representation under another name: by AP214, the shape comes second.
        for (_, parameters) in entities.of_kind("SHAPE_REPRESENTATION_RELATIONSHIP") {
            if let [_, _, outer, inner] = parameters {
                placements.add(entity(inner), entity(outer), None);
            }
        }
        placements
    }

    fn add(&mut self, child: Option<u64>, parent: Option<u64>, moved: Option<u64>) {
        let (Some(child), Some(parent)) = (child, parent) else { return };
        let by = moved.and_then(|id| self.transformation(id)).unwrap_or_else(Isometry::identity);
        self.parents.entry(child).or_default().push((parent, by));
    }

    /// From the first frame to the second.
    fn transformation(&self, id: u64) -> Option<Isometry> {
        let parameters = self.entities.record(id, "ITEM_DEFINED_TRANSFORMATION")?;
        let [_, _, from, to] = parameters else { return None };
        Some(self.frame(entity(to)?)? * self.frame(entity(from)?)?.try_inverse()?)
    }

    /// A frame: its origin, its z axis, and roughly its x axis (AXIS2_PLACEMENT_3D).
    fn frame(&self, id: u64) -> Option<Isometry> {
        let parameters = self.entities.record(id, "AXIS2_PLACEMENT_3D")?;
        let origin = self.numbers(parameters.get(1)?, "CARTESIAN_POINT")? * self.unit_mm;
        let axis =
            |i: usize, usual| parameters.get(i).and_then(|p| self.numbers(p, "DIRECTION")).unwrap_or(usual);
        let z = axis(2, Vector3::z()).try_normalize(1e-12)?;
        let rough = axis(3, Vector3::x());
        let x = (rough - z * z.dot(&rough)).try_normalize(1e-12).or_else(|| {
            // Without a direction of its own, any that is square to z.
            (Vector3::y() - z * z.y).try_normalize(1e-12)
        })?;
        let y = z.cross(&x);
        let column = |v: Vector3<f64>, w: f64| Vector4::new(v.x, v.y, v.z, w);
        Some(Matrix4::from_columns(&[column(x, 0.0), column(y, 0.0), column(z, 0.0), column(origin, 1.0)]))
    }

    fn numbers(&self, parameter: &Parameter, kind: &str) -> Option<Vector3<f64>> {
        let coordinates = list(self.entities.record(entity(parameter)?, kind)?.get(1)?)?;
        let number = |p: &Parameter| match p {
            Parameter::Real(value) => Some(*value),
            #[allow(clippy::cast_precision_loss)]
            Parameter::Integer(value) => Some(*value as f64),
            _ => None,
        };
        let [x, y, z] = coordinates else { return None };
        Some(Vector3::new(number(x)?, number(y)?, number(z)?))
    }

    /// Where a solid stands, once for each time that its part is used.
    pub(super) fn of_solid(&self, solid: u64) -> Vec<Isometry> {
        let mut found = Vec::new();
        match self.entities.representation_of(solid) {
            Some(representation) => self.climb(representation, Isometry::identity(), 0, &mut found),
            None => found.push(Isometry::identity()),
        }
        found
    }

    fn climb(&self, representation: u64, so_far: Isometry, depth: usize, found: &mut Vec<Isometry>) {
        if found.len() >= MOST_PLACES || depth > MAX_DEPTH {
            return;
        }
        match self.parents.get(&representation) {
            None => found.push(so_far),
            Some(parents) => {
                parents.iter().for_each(|(parent, by)| self.climb(*parent, by * so_far, depth + 1, found));
            }
        }
    }
}
