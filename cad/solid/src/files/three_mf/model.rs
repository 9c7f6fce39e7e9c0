//! Model parts: objects with their meshes and components, and the items of the build.

use std::collections::{BTreeMap, HashMap};

use roxmltree::Node;

use super::archive::{malformed, parsed};
use super::core_spec::{
    CORE, OWN, PRODUCTION, attributes, fault, faults, is_metadata, is_supported, unit_mm,
};
use super::error::ThreeMfReadError;
use super::transform::Transform;
use crate::mesh::{Mesh, Point3};
use crate::validity::Fault;

/// A mesh of a package, in its own coordinates.
#[derive(Clone, Debug)]
pub struct PackagedMesh {
    /// Name of its object, or `object ID`.
    pub name: String,
    /// Whether it is printed as a solid: other meshes are supports and surfaces, which need not be
    /// closed.
    pub is_solid: bool,
    /// The mesh, in millimetres.
    pub mesh: Mesh,
}

/// A reference to an object: its part and its id.
pub(super) type ObjectRef = (String, String);

/// An object of a model.
#[derive(Debug)]
pub(super) struct ModelObject {
    pub(super) name: String,
    pub(super) is_solid: bool,
    pub(super) mesh: Option<Mesh>,
    pub(super) components: Vec<(ObjectRef, Transform)>,
}

/// A model part.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// Ids of the objects, in the order of the file.
    order: Vec<String>,
    pub(super) objects: HashMap<String, ModelObject>,
    /// Objects to be built.
    pub(super) items: Vec<(ObjectRef, Transform)>,
}

impl Model {
    /// Meshes of the objects, in the order of the file.
    pub(super) fn into_meshes(mut self) -> Vec<PackagedMesh> {
        let take = |id: &String| {
            let object = self.objects.remove(id)?;
            Some(PackagedMesh { name: object.name, is_solid: object.is_solid, mesh: object.mesh? })
        };
        self.order.iter().filter_map(take).collect()
    }

    /// Parts that components and items of this model refer to.
    pub(super) fn referenced_parts(&self) -> Vec<String> {
        let components = self.objects.values().flat_map(|object| &object.components);
        components.chain(&self.items).map(|((part, _), _)| part.clone()).collect()
    }
}

/// Reads the models of one package and collects their faults and the metadata of pinswitch.
#[derive(Debug, Default)]
pub(super) struct ModelReader {
    pub(super) faults: Vec<Fault>,
    pub(super) configuration: Option<String>,
    pub(super) law: Option<String>,
}

impl ModelReader {
    /// Reads the model in `part`.
    ///
    /// # Errors
    /// [`ThreeMfReadError`] if the text is not a model of the core specification.
    pub(super) fn model(&mut self, text: &str, part: &str) -> Result<Model, ThreeMfReadError> {
        let document = parsed(text, part)?;
        let root = document.root_element();
        if root.tag_name().name() != "model" || root.tag_name().namespace() != Some(CORE) {
            return Err(malformed(part, "the root element is not a model of the 3MF core specification"));
        }
        self.faults.extend(unknown_names(root));
        self.faults.extend(missing_extensions(root));
        self.faults.extend(metadata_faults(root));
        self.configuration = self.configuration.take().or_else(|| own_metadata(root, "configuration"));
        self.law = self.law.take().or_else(|| own_metadata(root, "law"));
        let unit = root.attribute("unit").unwrap_or("millimeter");
        let unit_mm = unit_mm(unit).unwrap_or_else(|| {
            self.faults.push(fault("unit", &format!("the specification has no unit {unit}")));
            1.0
        });
        let mut model = Model::default();
        for object in core(root, "resources").flat_map(|resources| core(resources, "object")) {
            self.add_object(&mut model, object, part, unit_mm);
        }
        for item in core(root, "build").flat_map(|build| core(build, "item")) {
            model.items.push(self.placement(item, part, unit_mm));
        }
        Ok(model)
    }

    fn add_object(&mut self, model: &mut Model, object: Node<'_, '_>, part: &str, unit_mm: f64) {
        let id = object.attribute("id").unwrap_or_default().to_owned();
        let kind = object.attribute("type").unwrap_or("model");
        let read = ModelObject {
            name: object.attribute("name").map_or_else(|| format!("object {id}"), str::to_owned),
            is_solid: matches!(kind, "model" | "solidsupport"),
            mesh: core(object, "mesh").next().map(|mesh| self.mesh(mesh, &id, unit_mm)),
            components: core(object, "components")
                .flat_map(|all| core(all, "component"))
                .map(|component| self.placement(component, part, unit_mm))
                .collect(),
        };
        if model.objects.insert(id.clone(), read).is_some() {
            self.faults.push(fault("reference", &format!("two objects have the id {id}")));
        } else {
            model.order.push(id);
        }
    }

    fn mesh(&mut self, mesh: Node<'_, '_>, id: &str, unit_mm: f64) -> Mesh {
        let mut invalid: Vec<String> = Vec::new();
        let mut number = |node: Node<'_, '_>, name: &str| -> f64 {
            let text = node.attribute(name);
            let value = text.and_then(|v| v.trim().parse().ok());
            if value.is_none() {
                let absent = || format!("without {name}");
                invalid.push(text.map_or_else(absent, |v| format!("with {name}=\"{v}\"")));
            }
            value.unwrap_or(f64::NAN)
        };
        let positions: Vec<Point3> = core(mesh, "vertices")
            .flat_map(|all| core(all, "vertex"))
            .map(|v| Point3::new(number(v, "x"), number(v, "y"), number(v, "z")) * unit_mm)
            .collect();
        if let Some(first) = invalid.first() {
            let problem = if first.contains(',') {
                "numbers have a decimal point, not a comma"
            } else {
                "a coordinate is a number"
            };
            let detail = format!("object {id} has a vertex {first}; {problem}");
            self.faults.push(faults("number", invalid.len(), &detail));
        }
        let mut outside = 0;
        let mut triangles = Vec::new();
        for triangle in core(mesh, "triangles").flat_map(|all| core(all, "triangle")) {
            let corner = |name| -> Option<u32> {
                let index: u32 = triangle.attribute(name)?.trim().parse().ok()?;
                positions.get(index as usize).map(|_| index)
            };
            match (corner("v1"), corner("v2"), corner("v3")) {
                (Some(a), Some(b), Some(c)) => triangles.push([a, b, c]),
                _ => outside += 1,
            }
        }
        if outside > 0 {
            let detail =
                format!("{outside} triangles of object {id} name none of its {} vertices", positions.len());
            self.faults.push(faults("index", outside, &detail));
        }
        Mesh::new(positions, triangles)
    }

    /// The object and the transform of an item or a component.
    fn placement(&mut self, node: Node<'_, '_>, part: &str, unit_mm: f64) -> (ObjectRef, Transform) {
        let path = node.attribute((PRODUCTION, "path")).map(|path| path.trim_start_matches('/'));
        let id = node.attribute("objectid").unwrap_or_default();
        let object = (path.unwrap_or(part).to_owned(), id.to_owned());
        let Some(text) = node.attribute("transform") else { return (object, Transform::IDENTITY) };
        let transform = Transform::parse(text, unit_mm).unwrap_or_else(|| {
            self.faults.push(fault("transform", "a transform does not have twelve finite numbers"));
            Transform::IDENTITY
        });
        (object, transform)
    }
}

/// Children in the core namespace.
fn core<'a, 'input: 'a>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |n| n.tag_name().name() == name && n.tag_name().namespace() == Some(CORE))
}

/// The value of metadata in the namespace of pinswitch.
fn own_metadata(root: Node<'_, '_>, key: &str) -> Option<String> {
    let has_key = |n: &Node<'_, '_>| {
        let (prefix, name) = n.attribute("name").and_then(|name| name.split_once(':')).unwrap_or_default();
        name == key && root.lookup_namespace_uri(Some(prefix)) == Some(OWN)
    };
    core(root, "metadata").find(has_key).and_then(|n| n.text()).map(str::to_owned)
}

/// Elements and attributes outside of the specification, each once with its number of occurrences.
fn unknown_names(root: Node<'_, '_>) -> Vec<Fault> {
    let mut unknown: BTreeMap<String, usize> = BTreeMap::new();
    for node in root.descendants().filter(|n| n.tag_name().namespace() == Some(CORE)) {
        let element = node.tag_name().name();
        let Some(known) = attributes(element) else {
            *unknown.entry(format!("<{element}>")).or_default() += 1;
            continue;
        };
        for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
            if !known.contains(&attribute.name()) {
                *unknown.entry(format!("{} of <{element}>", attribute.name())).or_default() += 1;
            }
        }
    }
    let fault = |(name, count): (String, usize)| {
        faults("vocabulary", count, &format!("{name} is not in the core specification"))
    };
    unknown.into_iter().map(fault).collect()
}

fn missing_extensions(root: Node<'_, '_>) -> Vec<Fault> {
    let required = root.attribute("requiredextensions").unwrap_or_default();
    let missing =
        required.split_whitespace().filter_map(|prefix| match root.lookup_namespace_uri(Some(prefix)) {
            Some(namespace) if is_supported(namespace) => None,
            Some(namespace) => Some(format!("the required extension {namespace} is not supported")),
            None => Some(format!("the required extension {prefix} is not declared")),
        });
    missing.map(|detail| fault("extension", &detail)).collect()
}

fn metadata_faults(root: Node<'_, '_>) -> Vec<Fault> {
    let names: Vec<&str> = core(root, "metadata").filter_map(|n| n.attribute("name")).collect();
    let flaw = |(i, name): (usize, &&str)| {
        let declared = |prefix: &str| root.lookup_namespace_uri(Some(prefix)).is_some();
        let is_known = name.split_once(':').map_or(is_metadata(name), |(prefix, _)| declared(prefix));
        if names[..i].contains(name) {
            Some(fault("metadata", &format!("{name} occurs twice")))
        } else if is_known {
            None
        } else {
            Some(fault("metadata", &format!("{name} is not in the specification and has no namespace")))
        }
    };
    names.iter().enumerate().filter_map(flaw).collect()
}
