//! Model parts: objects with their meshes and components, and the items of the build.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::archive::malformed;
use super::core_spec::{
    OBJECT_TYPES, OWN, PRODUCTION, SLICER_ATTRIBUTES, is_metadata, is_supported, unit_mm,
};
use super::document::{Document, Element, Namespace, RawMesh, TriangleProperties, read_document};
use super::error::ThreeMfReadError;
use super::findings::Findings;
use super::materials;
use super::part_name::normalized;
use super::transform::Transform;
use super::value::{index, resource_id};
use crate::mesh::Mesh;
use crate::validity::Level;

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
    /// Its type, such as `model`.
    pub(super) kind: String,
    pub(super) mesh: Option<Mesh>,
    pub(super) components: Vec<(ObjectRef, Transform)>,
}

impl ModelObject {
    /// Whether its mesh is a solid.
    pub(super) fn is_solid(&self) -> bool {
        matches!(self.kind.as_str(), "model" | "solidsupport")
    }
}

/// An item of the build.
#[derive(Debug)]
pub(super) struct Item {
    pub(super) object: ObjectRef,
    pub(super) transform: Transform,
    /// Whether slicers print it.
    pub(super) is_printable: bool,
}

/// A model part.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// Ids of the objects, in the order of the file.
    order: Vec<String>,
    pub(super) objects: HashMap<String, ModelObject>,
    /// Objects to be built.
    pub(super) items: Vec<Item>,
}

impl Model {
    /// Meshes of the objects, in the order of the file.
    pub(super) fn into_meshes(mut self) -> Vec<PackagedMesh> {
        let take = |id: &String| {
            let object = self.objects.remove(id)?;
            let is_solid = object.is_solid();
            Some(PackagedMesh { name: object.name, is_solid, mesh: object.mesh? })
        };
        self.order.iter().filter_map(take).collect()
    }

    /// Parts that components and items of this model refer to.
    pub(super) fn referenced_parts(&self) -> HashSet<&str> {
        let components = self.objects.values().flat_map(|object| &object.components);
        let items = self.items.iter().map(|item| &item.object);
        components.map(|(object, _)| object).chain(items).map(|(part, _)| part.as_str()).collect()
    }
}

/// Reads the models of one package and collects their findings and the metadata of pinswitch.
#[derive(Debug, Default)]
pub(super) struct ModelReader {
    pub(super) findings: Findings,
    pub(super) configuration: Option<String>,
    pub(super) law: Option<String>,
    /// Objects of the last model with their thumbnails.
    pub(super) thumbnails: Vec<(String, String)>,
    /// Parts of the textures of the last model.
    pub(super) textures: BTreeSet<String>,
    /// Unique identifiers of the package, with the names of their elements.
    uuids: HashSet<(&'static str, String)>,
}

impl ModelReader {
    /// Reads the model in `part`, whose name in the archive is `shown`.
    ///
    /// # Errors
    /// [`ThreeMfReadError`] if the text is not a model of the core specification, or cannot be judged.
    pub(super) fn model(&mut self, text: &str, part: &str, shown: &str) -> Result<Model, ThreeMfReadError> {
        let mut document = read_document(text, shown)?;
        if !document.root.is_core("model") {
            return Err(malformed(shown, "the root element is not a model of the 3MF core specification"));
        }
        self.check_extensions(&document.root)?;
        self.check_names(&document);
        self.check_order(&document.root);
        self.check_structure(&document.root);
        self.check_identifiers(&document.root);
        self.check_metadata(&document.root);
        let root = &mut document.root;
        self.configuration = self.configuration.take().or_else(|| own_metadata(root, "configuration"));
        self.law = self.law.take().or_else(|| own_metadata(root, "law"));
        let unit = root.attribute("unit").unwrap_or("millimeter");
        let unit_mm = unit_mm(unit).unwrap_or_else(|| {
            let detail = format!("the specification has no unit {unit}");
            self.findings.error("unit", "3MF core 3.4", &detail);
            1.0
        });
        let mut model = Model::default();
        for child in &mut root.children {
            if child.is_core("resources") {
                self.resources(&mut model, child, part, unit_mm);
            }
        }
        for item in root.core("build").flat_map(|build| build.core("item")) {
            let (object, transform) = self.placement(item, part, unit_mm);
            let is_printable = !matches!(item.attribute("printable"), Some("0" | "false"));
            model.items.push(Item { object, transform, is_printable });
        }
        Ok(model)
    }

    fn resources(&mut self, model: &mut Model, resources: &mut Element, part: &str, unit_mm: f64) {
        self.check_ids(resources);
        materials::check_references(resources, &mut self.findings);
        let groups: HashMap<String, Group> = resources
            .children
            .iter()
            .filter(|child| !child.is_core("object"))
            .filter_map(|child| Some((resource_id(child.attribute("id")?), Group::of(child))))
            .collect();
        self.check_materials(resources);
        let textures = resources
            .children
            .iter()
            .filter(|child| child.namespace.is(materials::NAMESPACE) && child.name == "texture2d");
        self.textures.extend(textures.filter_map(|texture| texture.attribute("path")).map(normalized));
        for object in resources.children.iter_mut().filter(|child| child.is_core("object")) {
            self.check_properties(object, &groups);
            self.object(model, object, part, unit_mm);
        }
    }

    fn object(&mut self, model: &mut Model, object: &mut Element, part: &str, unit_mm: f64) {
        let id = resource_id(object.attribute("id").unwrap_or_default());
        let kind = object.attribute("type").unwrap_or("model").to_owned();
        if !OBJECT_TYPES.contains(&kind.as_str()) {
            self.findings.error("object", "3MF core 4", &format!("object {id} has the unknown type {kind}"));
        }
        let (meshes, components) = (object.core("mesh").count(), object.core("components").count());
        if meshes + components != 1 {
            let detail =
                format!("object {id} has {meshes} meshes and {components} lists of components, not one");
            self.findings.error("object", "3MF core B.1.1", &detail);
        }
        if components > 0 && (object.attribute("pid").is_some() || object.attribute("pindex").is_some()) {
            let detail = format!("object {id} has components and a property");
            self.findings.error("property", "3MF core 4", &detail);
        }
        if let Some(thumbnail) = object.attribute("thumbnail") {
            self.thumbnails.push((id.clone(), normalized(thumbnail)));
        }
        let name = object.attribute("name").map_or_else(|| format!("object {id}"), str::to_owned);
        let placements: Vec<_> = object.core("components").flat_map(|all| all.core("component")).collect();
        let components: Vec<_> =
            placements.iter().map(|component| self.placement(component, part, unit_mm)).collect();
        for ((component_part, component), _) in &components {
            if component_part == part && !model.objects.contains_key(component) {
                let detail =
                    format!("object {id} has the component {component}, which is not defined before it");
                self.findings.error("reference", "3MF core 4.2.1", &detail);
            }
        }
        let raw = object.children.iter_mut().find_map(|child| child.mesh.take());
        let mesh = raw.map(|raw| self.mesh(raw, &id, &kind, unit_mm));
        let read = ModelObject { name, kind, mesh, components };
        if !model.objects.contains_key(&id) {
            model.order.push(id.clone());
            model.objects.insert(id, read);
        }
    }

    fn mesh(&mut self, raw: RawMesh, id: &str, kind: &str, unit_mm: f64) -> Mesh {
        let findings = &mut self.findings;
        if let Some((count, first)) = &raw.invalid {
            let problem = if first.contains(',') {
                "numbers have a decimal point, not a comma"
            } else {
                "a coordinate is a number"
            };
            let detail = format!("object {id} has a vertex {first}; {problem}");
            findings.add("number", Level::Error, *count, "3MF core 4.1.3.1", &detail);
        }
        let vertices = raw.positions.len();
        let exists = |triangle: &[u32; 3]| triangle.iter().all(|v| (*v as usize) < vertices);
        let number = raw.triangles.len() + raw.without_indices;
        let mut triangles = raw.triangles;
        triangles.retain(exists);
        let outside = number - triangles.len();
        if outside > 0 {
            let detail =
                format!("{outside} triangles of object {id} refer to none of its {vertices} vertices");
            findings.add("index", Level::Error, outside, "3MF core 4.1.4.1", &detail);
        }
        let repeated = triangles.iter().filter(|[a, b, c]| a == b || b == c || c == a).count();
        if repeated > 0 {
            let detail = format!("{repeated} triangles of object {id} refer to a vertex twice");
            findings.add("index", Level::Error, repeated, "3MF core 4.1.4.1", &detail);
        }
        if number == 0 || (kind == "model" && number < 4) {
            let detail = format!("object {id} has {number} triangles, a solid has at least 4");
            findings.error("triangles", "3MF core 4.1.4", &detail);
        }
        if let Some((count, first)) = &raw.irregular {
            let detail = format!("object {id} has a vertex {first}, which the schema does not accept");
            findings.add("value", Level::Error, *count, "3MF core B.1.1", &detail);
        }
        if raw.invalid_properties > 0 {
            let (count, what) = (raw.invalid_properties, "properties p1, p2 or p3 of triangles");
            let detail = format!("{count} {what} of object {id} are not indices");
            findings.add("value", Level::Error, count, "3MF core B.1.1", &detail);
        }
        raw.sets.check(id, number, findings);
        let positions = raw.positions.into_iter().map(|p| p * unit_mm).collect();
        Mesh::new(positions, triangles)
    }

    /// The object and the transform of an item or a component.
    fn placement(&mut self, element: &Element, part: &str, unit_mm: f64) -> (ObjectRef, Transform) {
        let path = element.attribute_in(PRODUCTION, "path").map(normalized);
        let id = resource_id(element.attribute("objectid").unwrap_or_default());
        let object = (path.unwrap_or_else(|| part.to_owned()), id);
        let Some(text) = element.attribute("transform") else { return (object, Transform::IDENTITY) };
        let transform = Transform::parse(text, unit_mm).unwrap_or_else(|| {
            let detail = "a transform does not have twelve finite numbers";
            self.findings.error("transform", "3MF core 3.3", detail);
            Transform::IDENTITY
        });
        if transform.determinant() == 0.0 {
            self.findings.warning("transform", "3MF core 3.3", "a transform flattens its object");
        }
        (object, transform)
    }

    /// Refuses required extensions that change the meaning of the model.
    fn check_extensions(&mut self, root: &Element) -> Result<(), ThreeMfReadError> {
        let prefixes = |name| root.attribute(name).unwrap_or_default().split_whitespace();
        for prefix in prefixes("requiredextensions") {
            match root.prefixes.get(prefix) {
                Some(namespace) if is_supported(namespace) => {}
                Some(namespace) => {
                    let problem = format!("the required extension {namespace} is not supported");
                    return Err(ThreeMfReadError::Unsupported(problem));
                }
                None => {
                    let detail = format!("the required extension {prefix} is not declared");
                    self.findings.error("extension", "3MF core 3.4", &detail);
                }
            }
        }
        for prefix in prefixes("recommendedextensions") {
            let namespace = root.prefixes.get(prefix).map_or(prefix, |namespace| &**namespace);
            if !is_supported(namespace) {
                let detail = format!("the recommended extension {namespace} is not supported");
                self.findings.warning("extension", "3MF core 3.4", &detail);
            }
        }
        Ok(())
    }

    /// Reports elements and attributes outside of the specification, and missing ones.
    fn check_names(&mut self, document: &Document) {
        for (name, count) in &document.unknown {
            let is_usual = SLICER_ATTRIBUTES.contains(&name.as_str());
            let level = if is_usual { Level::Note } else { Level::Error };
            let detail = format!("{name} is not in the core specification");
            self.findings.add("vocabulary", level, *count, "3MF core 2.3.2", &detail);
        }
        for (name, count) in &document.forbidden {
            let detail = format!("{name} is not allowed");
            let paragraph = if name.starts_with("xml:space") { "3MF core 2.3.4" } else { "3MF core 2.3.2" };
            self.findings.add("vocabulary", Level::Error, *count, paragraph, &detail);
        }
        for (problem, count) in &document.values {
            let paragraph = match problem.split_once('=') {
                Some(("preserve" | "type", _)) => "3MF core 3.4.1",
                Some(("xml:lang", _)) => "3MF core 3.4",
                _ => "3MF core B.1.1",
            };
            self.findings.add("value", Level::Error, *count, paragraph, problem);
        }
        for (name, count) in &document.missing {
            self.findings.add("attribute", Level::Error, *count, "3MF core B.1.1", name);
        }
        for (problem, count) in &document.materials {
            self.findings.add("materials", Level::Error, *count, "3MF materials B", problem);
        }
    }

    /// Reports children of the model that are missing, repeated or in another order.
    fn check_order(&mut self, root: &Element) {
        const ORDER: [&str; 3] = ["metadata", "resources", "build"];
        for name in ["resources", "build"] {
            let count = root.children.iter().filter(|child| child.is_core(name)).count();
            if count != 1 {
                let detail = format!("the model has {count} elements <{name}>, not one");
                self.findings.error("model", "3MF core 3.4", &detail);
            }
        }
        let core = root.children.iter().filter(|child| child.namespace == Namespace::Core);
        let order: Vec<_> =
            core.filter_map(|child| ORDER.iter().position(|name| *name == child.name)).collect();
        if !order.is_sorted() {
            let detail = "metadata, resources and build are not in this order";
            self.findings.error("model", "3MF core B.1.1", detail);
        }
    }

    /// Reports core elements whose children the schema does not accept in their number or order.
    fn check_structure(&mut self, element: &Element) {
        let children: Vec<&str> = element
            .children
            .iter()
            .filter(|child| child.namespace == Namespace::Core)
            .map(|child| child.name.as_str())
            .collect();
        let count = |name: &str| children.iter().filter(|child| **child == name).count();
        let problem = match element.name.as_str() {
            "mesh" if children != ["vertices", "triangles"] => {
                Some(("triangles", "a <mesh> does not consist of one <vertices> and one <triangles>"))
            }
            "basematerials" if count("base") == 0 => Some(("material", "a <basematerials> has no <base>")),
            "components" if count("component") == 0 => Some(("object", "a <components> has no <component>")),
            "metadatagroup" if count("metadata") == 0 => {
                Some(("metadata", "a <metadatagroup> has no <metadata>"))
            }
            "resources" if !children.is_sorted_by_key(|child| *child == "object") => {
                Some(("model", "a <basematerials> follows an <object>"))
            }
            "object" | "item"
                if count("metadatagroup") > 1
                    || children.iter().skip(1).any(|child| *child == "metadatagroup") =>
            {
                Some(("metadata", "a <metadatagroup> is not the only one, or not the first element"))
            }
            _ => None,
        };
        if let Some((check, detail)) = problem {
            self.findings.error(check, "3MF core B.1.1", detail);
        }
        for child in element.children.iter().filter(|child| child.namespace == Namespace::Core) {
            self.check_structure(child);
        }
    }

    /// Reports elements without the unique identifier of the production extension, if the model
    /// requires the extension.
    fn check_identifiers(&mut self, root: &Element) {
        let required = root.attribute("requiredextensions").unwrap_or_default().split_whitespace();
        let mut namespaces = required.filter_map(|prefix| root.prefixes.get(prefix));
        if !namespaces.any(|namespace| **namespace == *PRODUCTION) {
            return;
        }
        let builds = || root.core("build").filter(|build| build.core("item").next().is_some());
        let items = builds().flat_map(|build| build.core("item"));
        let objects = || root.core("resources").flat_map(|resources| resources.core("object"));
        let components =
            objects().flat_map(|object| object.core("components")).flat_map(|all| all.core("component"));
        let all = [
            ("build", "3MF production 4.1", builds().collect::<Vec<_>>()),
            ("item", "3MF production 4.1.1", items.collect()),
            ("object", "3MF production 4.2", objects().collect()),
            ("component", "3MF production 4.2.1", components.collect()),
        ];
        for (name, paragraph, elements) in all {
            let has_none = |element: &&&Element| {
                !element.attribute_in(PRODUCTION, "UUID").is_some_and(|text| is_uuid(text.trim()))
            };
            let count = elements.iter().filter(has_none).count();
            if count > 0 {
                let detail = format!("{count} elements <{name}> without a UUID");
                self.findings.add("identifier", Level::Error, count, paragraph, &detail);
            }
            for element in elements {
                let Some(uuid) = element.attribute_in(PRODUCTION, "UUID") else { continue };
                if !self.uuids.insert((name, uuid.trim().to_ascii_lowercase())) {
                    let detail = format!("two elements <{name}> have the same UUID");
                    self.findings.warning("identifier", paragraph, &detail);
                }
            }
        }
    }

    fn check_metadata(&mut self, root: &Element) {
        self.check_metadata_of(root);
        let items = root.core("build").flat_map(|build| build.core("item"));
        let objects = root.core("resources").flat_map(|resources| resources.core("object"));
        for group in items.chain(objects).flat_map(|element| element.core("metadatagroup")) {
            self.check_metadata_of(group);
        }
    }

    /// Checks the metadata of the model, or of an object or an item.
    fn check_metadata_of(&mut self, parent: &Element) {
        let mut names = HashSet::new();
        for element in parent.core("metadata") {
            let Some(name) = element.attribute("name") else { continue };
            if !names.insert(name) {
                self.findings.error("metadata", "3MF core 3.4.1", &format!("{name} occurs twice"));
            }
            match name.split_once(':') {
                Some((_, local)) if local.is_empty() || local.contains(':') => {
                    let detail = format!("the metadata name {name} is not a qualified name");
                    self.findings.error("metadata", "3MF core 3.4.1", &detail);
                }
                Some((prefix, _)) if element.prefixes.contains_key(prefix) => {}
                Some((prefix, _)) => {
                    let detail = format!("the namespace {prefix} of {name} is not declared");
                    self.findings.error("metadata", "3MF core 3.4.1", &detail);
                }
                None if is_metadata(name) => {}
                None if name.trim().is_empty() => {
                    self.findings.error("metadata", "3MF core 3.4.1", "metadata has an empty name");
                }
                // Producers must not write it, and readers ignore it.
                None => {
                    let detail = format!("{name} is not in the specification and has no namespace");
                    self.findings.warning("metadata", "3MF core 3.4.1", &detail);
                }
            }
        }
    }

    fn check_ids(&mut self, resources: &Element) {
        let mut ids = HashSet::new();
        for resource in &resources.children {
            let Some(id) = resource.attribute("id").map(resource_id) else { continue };
            if !ids.insert(id.clone()) {
                let detail = format!("two resources have the id {id}");
                self.findings.error("reference", "3MF core 3.4.2", &detail);
            }
            if !id.parse::<u32>().is_ok_and(|number| number > 0 && number < 1 << 31) {
                let detail = format!("the id {id:?} is not a number from 1 to 2147483647");
                self.findings.error("reference", "3MF core B.1.1", &detail);
            }
        }
    }

    /// Reports base materials without a valid colour.
    fn check_materials(&mut self, resources: &Element) {
        let bases = resources.core("basematerials").flat_map(|group| group.core("base"));
        for color in bases.filter_map(|base| base.attribute("displaycolor")) {
            if !materials::is_color(color) {
                let detail = format!("the colour {color} is not #RRGGBB or #RRGGBBAA");
                self.findings.error("material", "3MF core 5.1.1", &detail);
            }
        }
    }

    /// Reports properties of an object that refer to no group.
    fn check_properties(&mut self, object: &Element, groups: &HashMap<String, Group>) {
        let id = object.attribute("id").unwrap_or_default();
        let (pid, pindex) = (object.attribute("pid"), object.attribute("pindex"));
        let meshes = || object.core("mesh").filter_map(|mesh| mesh.mesh.as_ref());
        if pindex.is_some() && pid.is_none() {
            let detail = format!("object {id} has a pindex without pid");
            self.findings.error("property", "3MF core 4", &detail);
        }
        let is_incomplete = pid.is_none() || pindex.is_none();
        if is_incomplete && meshes().any(|mesh| mesh.has_property) {
            let detail =
                format!("triangles of object {id} have a property, but the object has no pid and pindex");
            self.findings.warning("property", "3MF core 4", &detail);
        }
        let uses = || meshes().flat_map(|mesh| &mesh.properties);
        let of_triangles = uses().filter_map(|properties| properties.pid.as_deref());
        for group in pid.into_iter().chain(of_triangles) {
            if !groups.contains_key(&resource_id(group)) {
                let detail = format!("object {id} has a property of the group {group}, which does not exist");
                self.findings.error("property", "3MF core 4", &detail);
            }
        }
        let size = pid.and_then(|pid| groups.get(&resource_id(pid))?.size);
        let index = pindex.and_then(index).map(|index| index as usize);
        if let (Some(size), Some(index)) = (size, index)
            && index >= size
        {
            let detail = format!("object {id} has the property {index} of a group of {size}");
            self.findings.error("property", "3MF core 4", &detail);
        }
        for TriangleProperties { pid: of_triangle, greatest, gradients } in uses() {
            let group = of_triangle.as_deref().or(pid).and_then(|pid| groups.get(&resource_id(pid)));
            let Some(group) = group else { continue };
            if let Some(size) = group.size.filter(|size| *greatest as usize >= *size) {
                let detail =
                    format!("a triangle of object {id} has the property {greatest} of a group of {size}");
                self.findings.error("property", "3MF core 4.1.4.1", &detail);
            }
            if *gradients > 0 && group.is_base {
                let detail =
                    format!("{gradients} triangles of object {id} have a gradient of base materials");
                self.findings.add("property", Level::Error, *gradients, "3MF core 4.1.4.1", &detail);
            }
        }
    }
}

/// A group of properties to which objects and triangles refer.
struct Group {
    /// Number of properties; `None` in a group of an extension that is not read.
    size: Option<usize>,
    /// Whether it has base materials, which have no gradients.
    is_base: bool,
}

impl Group {
    fn of(resource: &Element) -> Self {
        let is_base = resource.is_core("basematerials");
        let size = if is_base {
            Some(resource.core("base").count())
        } else {
            let is_read = resource.namespace.is(materials::NAMESPACE);
            materials::property_of(&resource.name).filter(|_| is_read).map(|_| resource.properties)
        };
        Self { size, is_base }
    }
}

/// Whether a text is a UUID of 32 hexadecimal digits in five groups.
fn is_uuid(text: &str) -> bool {
    let lengths = text.split('-').map(str::len);
    lengths.eq([8, 4, 4, 4, 12]) && text.bytes().all(|byte| byte == b'-' || byte.is_ascii_hexdigit())
}

/// The value of metadata in the namespace of pinswitch.
fn own_metadata(root: &Element, key: &str) -> Option<String> {
    let has_key = |element: &&Element| {
        let (prefix, name) =
            element.attribute("name").and_then(|name| name.split_once(':')).unwrap_or_default();
        name == key && element.prefixes.get(prefix).is_some_and(|namespace| **namespace == *OWN)
    };
    root.core("metadata").find(has_key).map(|element| element.text.clone())
}
