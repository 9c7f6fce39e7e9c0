//! The build: items of the plate, resolved to meshes in their places.

use std::collections::{BTreeMap, HashSet};

use super::findings::Findings;
use super::model::{Model, ModelObject, ObjectRef, PackagedMesh};
use super::transform::Transform;
use crate::mesh::{Mesh, Point3};

/// Deepest nesting of components; some programs write chains of a hundred.
const MAX_DEPTH: usize = 1000;
/// Most objects that are resolved: components of components multiply.
const MAX_OBJECTS: usize = 10_000;
/// Most meshes that are returned again because a transform changes their shape.
const MAX_SCALED: usize = 100;
/// Most triangles of these meshes.
const MAX_SCALED_TRIANGLES: usize = 200_000;
/// Most solids that are returned in their places.
const MAX_SOLIDS: usize = 500;
/// Most triangles of all solids in their places, and most vertices of all items.
const MAX_TRIANGLES: usize = 4_000_000;
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
    /// The bound that ended the traversal.
    pub(super) bound: Option<String>,
    /// The bound on meshes of another size.
    pub(super) size_bound: Option<String>,
    /// Triangles of meshes of another size.
    scaled_triangles: usize,
    /// Triangles of all solids.
    triangles: usize,
    /// Vertices of all items.
    vertices: usize,
}

impl Build {
    /// Resolves every item of the model in `main_part`; appends the faults of items that cannot be
    /// built.
    pub(super) fn of_package(
        models: &BTreeMap<String, Model>,
        main_part: &str,
        findings: &mut Findings,
    ) -> Self {
        let items = models.get(main_part).map_or(&[][..], |model| &model.items);
        if items.is_empty() {
            findings.error("build", "3MF core 3.4.3", "the build has no item");
        }
        let mut traversal = Traversal {
            models,
            findings,
            objects: 0,
            item: 0,
            is_printable: true,
            path: Vec::new(),
            bounds: None,
            sizes: HashSet::new(),
            build: Self::default(),
        };
        for (number, item) in items.iter().enumerate() {
            (traversal.item, traversal.is_printable, traversal.bounds) = (number, item.is_printable, None);
            traversal.descend(&item.object, item.transform);
            traversal.check_bounds(&item.object.1);
        }
        traversal.build
    }
}

/// A depth-first traversal of items, components and meshes.
struct Traversal<'a> {
    models: &'a BTreeMap<String, Model>,
    findings: &'a mut Findings,
    /// Objects visited so far, under all items.
    objects: usize,
    /// The current item.
    item: usize,
    /// Whether slicers print the current item.
    is_printable: bool,
    /// Objects from the item to the current one.
    path: Vec<&'a ObjectRef>,
    /// Bounding box of the current item.
    bounds: Option<(Point3, Point3)>,
    /// Objects and shapes of transforms that are not rigid.
    sizes: HashSet<(&'a ObjectRef, [u64; 9])>,
    build: Build,
}

impl<'a> Traversal<'a> {
    fn descend(&mut self, reference: &'a ObjectRef, transform: Transform) {
        let (part, id) = reference;
        let Some(object) = self.models.get(part).and_then(|model| model.objects.get(id)) else {
            let detail = format!("object {id} does not exist");
            self.findings.error("reference", "3MF core 3.4.3.1", &detail);
            return;
        };
        if self.path.contains(&reference) {
            // Within a part, the reference to an object that is not defined before it is reported.
            if self.path.last().is_none_or(|(last, _)| last == part) {
                return;
            }
            self.findings.error("reference", "3MF core 4.2.1", &format!("object {id} contains itself"));
            return;
        }
        if self.path.len() == MAX_DEPTH || self.objects == MAX_OBJECTS {
            let bound =
                format!("the build has more than {MAX_OBJECTS} components, or {MAX_DEPTH} nested ones");
            self.build.bound = Some(bound);
            return;
        }
        self.objects += 1;
        if object.kind == "other" {
            let detail = format!("the build refers to object {id} of the type other");
            self.findings.error("build", "3MF core 3.4.3.1", &detail);
        }
        if let Some(mesh) = &object.mesh {
            self.extend_bounds(mesh, &transform);
            if object.is_solid() && self.is_printable {
                self.place(object, mesh, &transform);
            }
            if !transform.is_rigid() {
                self.scale(reference, object, mesh, &transform);
            }
        }
        self.path.push(reference);
        for (component, inner) in &object.components {
            if self.build.bound.is_some() {
                break;
            }
            self.descend(component, inner.then(&transform));
        }
        self.path.pop();
    }

    fn place(&mut self, object: &ModelObject, mesh: &Mesh, transform: &Transform) {
        self.build.triangles += mesh.triangles.len();
        if self.build.solids.len() == MAX_SOLIDS || self.build.triangles > MAX_TRIANGLES {
            let bound = format!("the build has more than {MAX_SOLIDS} solids, or {MAX_TRIANGLES} triangles");
            self.build.bound = Some(bound);
            return;
        }
        let (name, mesh) = (object.name.clone(), transform.mesh(mesh));
        self.build.solids.push(PlacedMesh { item: self.item, name, mesh });
    }

    /// Adds the mesh in another size or shape than that of its object, each once.
    fn scale(&mut self, reference: &'a ObjectRef, object: &ModelObject, mesh: &Mesh, transform: &Transform) {
        if !self.sizes.insert((reference, transform.shape())) {
            return;
        }
        self.build.scaled_triangles += mesh.triangles.len();
        if self.build.scaled.len() == MAX_SCALED
            || self.build.scaled_triangles > MAX_SCALED_TRIANGLES.max(mesh.triangles.len())
        {
            self.build.size_bound = Some(format!(
                "more than {MAX_SCALED} other sizes of objects, or {MAX_SCALED_TRIANGLES} triangles"
            ));
            return;
        }
        let (name, mesh) = (format!("{}, as it is built", object.name), transform.mesh(mesh));
        self.build.scaled.push(PackagedMesh { name, is_solid: object.is_solid(), mesh });
    }

    fn extend_bounds(&mut self, mesh: &Mesh, transform: &Transform) {
        self.build.vertices += mesh.positions.len();
        if self.build.vertices > MAX_TRIANGLES {
            self.build.bound = Some(format!("the build has more than {MAX_TRIANGLES} vertices"));
            return;
        }
        for p in mesh.positions.iter().map(|p| transform.point(*p)) {
            let (low, high) = self.bounds.unwrap_or((p, p));
            self.bounds = Some((low.inf(&p), high.sup(&p)));
        }
    }

    /// Reports an item below or next to the plate. Slicers put an item on the plate, and centre one
    /// that reaches over an edge.
    fn check_bounds(&mut self, id: &str) {
        let is_outside =
            |(low, high): &(Point3, Point3)| low.z < -ROUNDING_MM || high.x < 0.0 || high.y < 0.0;
        if let Some((low, _)) = self.bounds.filter(is_outside).filter(|_| self.is_printable) {
            let at = [low.x, low.y, low.z].map(|v| format!("{v:.2}")).join(" ");
            let detail = format!("object {id} is below or next to the plate, from {at} mm");
            self.findings.warning("outside", "3MF core 3.3", &detail);
        }
    }
}
