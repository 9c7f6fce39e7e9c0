//! The build: items of the plate, resolved to meshes in their places.

use std::collections::BTreeMap;

use super::core_spec::fault;
use super::model::{Model, ObjectRef, PackagedMesh};
use super::transform::Transform;
use crate::mesh::{Mesh, Point3};
use crate::validity::Fault;

/// Deepest nesting of components.
const MAX_DEPTH: usize = 16;
/// Most objects that are resolved: components of components multiply.
const MAX_OBJECTS: usize = 10_000;
/// Most meshes that are returned again because a transform changes their shape.
const MAX_SCALED: usize = 100;
/// Most solids that are returned in their places.
const MAX_SOLIDS: usize = 500;
/// Most triangles of all solids in their places.
const MAX_TRIANGLES: usize = 10_000_000;
/// Depth in mm below the plate that counts as rounding.
const ROUNDING_MM: f64 = 1e-3;

/// A solid in its place on the plate.
#[derive(Clone, Debug)]
pub struct PlacedMesh {
    /// Its build item, from 0. Solids of one item form one object.
    pub item: usize,
    /// Name of its object.
    pub name: String,
    /// The mesh in its place, in millimetres.
    pub mesh: Mesh,
}

/// The resolved build of a package.
#[derive(Debug, Default)]
pub(super) struct Build {
    /// Solids in their places.
    pub(super) solids: Vec<PlacedMesh>,
    /// Meshes of another size or shape than that of their object.
    pub(super) scaled: Vec<PackagedMesh>,
}

impl Build {
    /// Resolves every item of the model in `main_part`; appends the faults of items that cannot be
    /// built.
    pub(super) fn of_package(
        models: &BTreeMap<String, Model>,
        main_part: &str,
        faults: &mut Vec<Fault>,
    ) -> Self {
        let items = models.get(main_part).map_or(&[][..], |model| &model.items);
        if items.is_empty() {
            faults.push(fault("build", "the build has no item"));
        }
        let mut traversal =
            Traversal { models, faults, objects: 0, item: 0, bounds: None, build: Self::default() };
        for (item, (object, transform)) in items.iter().enumerate() {
            (traversal.item, traversal.bounds) = (item, None);
            traversal.descend(object, *transform, 0);
            traversal.check_bounds(&object.1);
        }
        traversal.build
    }

    /// Whether there is room for another solid: a short file can request any number of copies.
    fn has_room_for(&self, mesh: &Mesh) -> bool {
        let triangles: usize = self.solids.iter().map(|solid| solid.mesh.triangles.len()).sum();
        self.solids.len() < MAX_SOLIDS && triangles + mesh.triangles.len() <= MAX_TRIANGLES
    }
}

/// A depth-first traversal of items, components and meshes.
struct Traversal<'a> {
    models: &'a BTreeMap<String, Model>,
    faults: &'a mut Vec<Fault>,
    /// Objects visited so far, under all items.
    objects: usize,
    /// The current item.
    item: usize,
    /// Bounding box of the current item.
    bounds: Option<(Point3, Point3)>,
    build: Build,
}

impl Traversal<'_> {
    fn descend(&mut self, (part, id): &ObjectRef, transform: Transform, depth: usize) {
        self.objects += 1;
        let Some(object) = self.models.get(part).and_then(|model| model.objects.get(id)) else {
            self.faults.push(fault("reference", &format!("object {id} does not exist")));
            return;
        };
        if depth > MAX_DEPTH || self.objects == MAX_OBJECTS {
            let detail = format!("object {id} contains itself, or too many components");
            self.faults.push(fault("reference", &detail));
        }
        if depth > MAX_DEPTH || self.objects >= MAX_OBJECTS {
            return;
        }
        if transform.determinant() <= 0.0 {
            self.faults.push(fault("mirrored", &format!("a transform mirrors or flattens object {id}")));
        }
        if let Some(mesh) = &object.mesh {
            self.extend_bounds(mesh.positions.iter().map(|p| transform.point(*p)));
            if object.is_solid && self.build.has_room_for(mesh) {
                let (name, mesh) = (object.name.clone(), transform.mesh(mesh));
                self.build.solids.push(PlacedMesh { item: self.item, name, mesh });
            }
            if !transform.is_rigid() && self.build.scaled.len() < MAX_SCALED {
                let (name, mesh) = (format!("{}, as it is built", object.name), transform.mesh(mesh));
                self.build.scaled.push(PackagedMesh { name, is_solid: object.is_solid, mesh });
            }
        }
        for (component, inner) in &object.components {
            self.descend(component, inner.then(&transform), depth + 1);
        }
    }

    fn extend_bounds(&mut self, points: impl Iterator<Item = Point3>) {
        for p in points {
            let (low, high) = self.bounds.unwrap_or((p, p));
            self.bounds = Some((low.inf(&p), high.sup(&p)));
        }
    }

    /// Reports an item below or next to the plate. Slicers centre an item that reaches over an
    /// edge.
    fn check_bounds(&mut self, id: &str) {
        let is_outside =
            |(low, high): &(Point3, Point3)| low.z < -ROUNDING_MM || high.x < 0.0 || high.y < 0.0;
        if let Some((low, _)) = self.bounds.filter(is_outside) {
            let at = [low.x, low.y, low.z].map(|v| format!("{v:.2}")).join(" ");
            self.faults
                .push(fault("outside", &format!("object {id} is below or next to the plate, from {at} mm")));
        }
    }
}
