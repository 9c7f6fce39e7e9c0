//! Reads a package: its meshes in millimetres, what breaks the specification, and the configuration in it.

use std::collections::{BTreeMap, HashMap};
use std::io::{Cursor, Read};

use roxmltree::{Document, Node, ParsingOptions};
use zip::ZipArchive;

use super::vocabulary::{attributes, is_metadata, is_understood, unit_mm};
use super::{CORE, MODEL_TYPE, OWN};
use crate::mesh::{Mesh, Point3};
use crate::validity::Fault;

/// Namespace of parts that lie in files of their own.
pub(super) const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
const RELATIONSHIPS: &str = "_rels/.rels";
const CONTENT_TYPES: &str = "[Content_Types].xml";
/// Where the model lies in most packages.
const USUAL_MODEL: &str = "3D/3dmodel.model";
/// Longest part of a package, unpacked: a small file can hold endless zeros.
const MAX_PART: u64 = 1 << 30;
/// Most elements of a model: some five million triangles with their vertices.
const MAX_NODES: u32 = 8_000_000;
/// Components within components.
const MAX_DEPTH: usize = 16;
/// Most objects that are placed: components of components multiply.
const MAX_STEPS: usize = 10_000;
/// Most meshes that are examined again because they are built in another size.
const MAX_SCALED: usize = 100;
/// Most solids that are kept in their places.
const MAX_BUILT: usize = 500;
/// And most triangles of all of them.
const MAX_BUILT_TRIANGLES: usize = 10_000_000;
/// How far a turn may be off by rounding.
const RIGID: f64 = 1e-4;
/// How far below zero a part may lie, mm: what rounding leaves.
const ROUNDING_MM: f64 = 1e-3;

/// A mesh of a package, in its own coordinates.
#[derive(Clone, Debug)]
pub struct PackagedMesh {
    /// Its name, or its number.
    pub name: String,
    /// Whether it is to be printed as a solid: other meshes are supports and surfaces, which need not be closed.
    pub is_solid: bool,
    /// The mesh, in millimetres.
    pub mesh: Mesh,
}

/// What a package holds.
#[derive(Clone, Debug, Default)]
pub struct ThreeMf {
    /// Its meshes, in the order of the file.
    pub meshes: Vec<PackagedMesh>,
    /// Where it breaks the specification.
    pub faults: Vec<Fault>,
    /// Each solid as it stands on the plate: the number of its build item from 0, its name, and its mesh in place. Solids of
    /// one item are one object.
    pub built: Vec<(usize, String, Mesh)>,
    /// The configuration that made it, if this program wrote it.
    pub configuration: Option<String>,
    /// The law of its curve, where it is not the one that is used unless another is asked for.
    pub law: Option<String>,
}

/// Why a file is no 3MF that could be judged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ThreeMfReadError {
    /// The archive cannot be unpacked.
    #[error("its ZIP archive cannot be read ({0}); save it again")]
    Archive(String),
    /// No model in it.
    #[error("a ZIP archive without a 3D model in it; give a 3MF")]
    NoModel,
    /// A part is longer than any model.
    #[error("{part} is longer than {MAX_PART} bytes unpacked; export it coarser")]
    TooLong {
        /// Name of the part.
        part: String,
    },
    /// A part is no XML.
    #[error("{part}: {problem}; save it again")]
    Malformed {
        /// Name of the part.
        part: String,
        /// What is wrong.
        problem: String,
    },
}

/// Reads a 3MF. Nothing is repaired: what can be read beside a fault is.
///
/// # Errors
/// [`ThreeMfReadError`] if there is no model that could be judged.
pub fn read_three_mf(bytes: &[u8]) -> Result<ThreeMf, ThreeMfReadError> {
    let mut parts = Parts::open(bytes)?;
    let mut found = ThreeMf::default();
    if parts.text(CONTENT_TYPES)?.is_none() {
        found.faults.push(fault("content types", format!("{CONTENT_TYPES} is missing")));
    }
    let model_part = match parts.text(RELATIONSHIPS)? {
        Some(text) => related_model(&text)?,
        None => None,
    };
    if model_part.is_none() {
        found.faults.push(fault("relationships", format!("{RELATIONSHIPS} names no 3D model")));
    }
    let name = model_part.unwrap_or_else(|| USUAL_MODEL.to_owned());
    let text = parts.text(&name)?.ok_or(ThreeMfReadError::NoModel)?;
    let model = Model::read(&text, &name, &mut found)?;
    let mut models = BTreeMap::from([(name.clone(), model)]);
    // Parts in files of their own.
    while let Some(missing) = missing_part(&models) {
        let model = match parts.text(&missing)? {
            Some(text) => Model::read(&text, &missing, &mut found)?,
            None => {
                found.faults.push(fault("reference", format!("{missing} is missing")));
                Model::default()
            }
        };
        models.insert(missing, model);
    }
    let (scaled, built) = placed(&models, &name, &mut found.faults);
    found.built = built;
    let main = models.remove(&name).into_iter();
    found.meshes = main.chain(models.into_values()).flat_map(Model::meshes).chain(scaled).collect();
    Ok(found)
}

fn fault(check: &'static str, detail: String) -> Fault {
    Fault { check, count: 1, at_mm: None, detail }
}

/// The files of a package.
struct Parts<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
}

/// What is wrong with an archive whose list of parts cannot be read. The library's words are its own business.
const CUT_OFF: &str = "it is cut off or damaged";

impl<'a> Parts<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, ThreeMfReadError> {
        let archive =
            ZipArchive::new(Cursor::new(bytes)).map_err(|_| ThreeMfReadError::Archive(CUT_OFF.to_owned()))?;
        Ok(Self { archive })
    }

    /// A part as text; `None` if there is none of the name.
    fn text(&mut self, part: &str) -> Result<Option<String>, ThreeMfReadError> {
        let file = match self.archive.by_name(part) {
            Ok(file) => file,
            Err(zip::result::ZipError::FileNotFound) => return Ok(None),
            Err(_) => return Err(ThreeMfReadError::Archive(format!("{part} in it is damaged"))),
        };
        let mut bytes = Vec::new();
        let read = file.take(MAX_PART + 1).read_to_end(&mut bytes);
        read.map_err(|_| ThreeMfReadError::Archive(format!("{part} in it is damaged")))?;
        if bytes.len() as u64 > MAX_PART {
            return Err(ThreeMfReadError::TooLong { part: part.to_owned() });
        }
        String::from_utf8(bytes).map(Some).map_err(|_| ThreeMfReadError::Malformed {
            part: part.to_owned(),
            problem: "it is not UTF-8".to_owned(),
        })
    }
}

fn parsed<'a>(text: &'a str, part: &str) -> Result<Document<'a>, ThreeMfReadError> {
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    // Some programs write a byte order mark.
    Document::parse_with_options(text.trim_start_matches('\u{feff}'), options)
        .map_err(|e| ThreeMfReadError::Malformed { part: part.to_owned(), problem: e.to_string() })
}

/// The part that the relationships call the model.
fn related_model(text: &str) -> Result<Option<String>, ThreeMfReadError> {
    let document = parsed(text, RELATIONSHIPS)?;
    let model = document.descendants().find(|n| n.attribute("Type") == Some(MODEL_TYPE));
    Ok(model.and_then(|n| n.attribute("Target")).map(|path| path.trim_start_matches('/').to_owned()))
}

/// A place in a model: of an object, by its part and number.
type Place = (String, String);

/// An object of a model.
#[derive(Debug)]
struct ReadObject {
    name: String,
    kind: String,
    mesh: Option<Mesh>,
    components: Vec<(Place, Transform)>,
}

/// A model part: objects by their numbers in the order of the file, and what is to be built.
#[derive(Debug, Default)]
struct Model {
    order: Vec<String>,
    objects: HashMap<String, ReadObject>,
    items: Vec<(Place, Transform)>,
}

impl Model {
    fn read(text: &str, part: &str, found: &mut ThreeMf) -> Result<Self, ThreeMfReadError> {
        let document = parsed(text, part)?;
        let root = document.root_element();
        if root.tag_name().name() != "model" || root.tag_name().namespace() != Some(CORE) {
            return Err(ThreeMfReadError::Malformed {
                part: part.to_owned(),
                problem: "its root is no model of the 3MF core specification".to_owned(),
            });
        }
        found.faults.extend(unknown_words(root));
        found.faults.extend(missing_extensions(root));
        found.faults.extend(metadata_faults(root));
        let unit = root.attribute("unit").unwrap_or("millimeter");
        let unit_mm = unit_mm(unit).unwrap_or_else(|| {
            found.faults.push(fault("unit", format!("{unit} is no unit of the specification")));
            1.0
        });
        let own = |wanted: &str| {
            let is_it = |n: &Node<'_, '_>| {
                let (prefix, name) =
                    n.attribute("name").and_then(|name| name.split_once(':')).unwrap_or_default();
                name == wanted && root.lookup_namespace_uri(Some(prefix)) == Some(OWN)
            };
            core(root, "metadata").find(is_it).and_then(|n| n.text()).map(str::to_owned)
        };
        found.configuration = found.configuration.take().or_else(|| own("configuration"));
        found.law = found.law.take().or_else(|| own("law"));
        let mut model = Self::default();
        for object in core(root, "resources").flat_map(|resources| core(resources, "object")) {
            model.add(object, part, unit_mm, &mut found.faults);
        }
        for item in core(root, "build").flat_map(|build| core(build, "item")) {
            model.items.push(placement(item, part, unit_mm, &mut found.faults));
        }
        Ok(model)
    }

    fn add(&mut self, object: Node<'_, '_>, part: &str, unit_mm: f64, faults: &mut Vec<Fault>) {
        let id = object.attribute("id").unwrap_or_default().to_owned();
        let read = ReadObject {
            name: object.attribute("name").map_or_else(|| format!("object {id}"), str::to_owned),
            kind: object.attribute("type").unwrap_or("model").to_owned(),
            mesh: core(object, "mesh").next().map(|mesh| read_mesh(mesh, &id, unit_mm, faults)),
            components: core(object, "components")
                .flat_map(|all| core(all, "component"))
                .map(|component| placement(component, part, unit_mm, faults))
                .collect(),
        };
        if self.objects.insert(id.clone(), read).is_some() {
            faults.push(fault("reference", format!("two objects have the id {id}")));
        } else {
            self.order.push(id);
        }
    }

    fn meshes(mut self) -> Vec<PackagedMesh> {
        let take = |id: &String| {
            let object = self.objects.remove(id)?;
            let is_solid = matches!(object.kind.as_str(), "model" | "solidsupport");
            Some(PackagedMesh { name: object.name, is_solid, mesh: object.mesh? })
        };
        self.order.iter().filter_map(take).collect()
    }
}

/// Children of the core namespace.
fn core<'a, 'input: 'a>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |n| n.tag_name().name() == name && n.tag_name().namespace() == Some(CORE))
}

/// Elements and attributes that the specification does not know, each once.
fn unknown_words(root: Node<'_, '_>) -> Vec<Fault> {
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
    let fault = |(word, count): (String, usize)| Fault {
        check: "vocabulary",
        count,
        at_mm: None,
        detail: format!("{word} is not in the core specification"),
    };
    unknown.into_iter().map(fault).collect()
}

fn missing_extensions(root: Node<'_, '_>) -> Vec<Fault> {
    let required = root.attribute("requiredextensions").unwrap_or_default();
    let unread = required.split_whitespace().filter_map(|prefix| {
        let namespace = root.lookup_namespace_uri(Some(prefix));
        match namespace {
            Some(known) if is_understood(known) => None,
            Some(other) => Some(format!("it needs the extension {other}, which is not read here")),
            None => Some(format!("it needs the extension {prefix}, which it does not declare")),
        }
    });
    unread.map(|detail| fault("extension", detail)).collect()
}

fn metadata_faults(root: Node<'_, '_>) -> Vec<Fault> {
    let names: Vec<&str> = core(root, "metadata").filter_map(|n| n.attribute("name")).collect();
    let flaw = |(i, name): (usize, &&str)| {
        let declared = |prefix: &str| root.lookup_namespace_uri(Some(prefix)).is_some();
        let is_known = name.split_once(':').map_or(is_metadata(name), |(prefix, _)| declared(prefix));
        if names[..i].contains(name) {
            Some(fault("metadata", format!("{name} is there twice")))
        } else if is_known {
            None
        } else {
            Some(fault("metadata", format!("{name} is not in the specification and has no namespace")))
        }
    };
    names.iter().enumerate().filter_map(flaw).collect()
}

fn read_mesh(mesh: Node<'_, '_>, id: &str, unit_mm: f64, faults: &mut Vec<Fault>) -> Mesh {
    let mut unread: Vec<String> = Vec::new();
    let mut number = |node: Node<'_, '_>, name: &str| -> f64 {
        let text = node.attribute(name);
        let value = text.and_then(|v| v.trim().parse().ok());
        if value.is_none() {
            unread.push(text.map_or_else(|| format!("without {name}"), |v| format!("with {name}=\"{v}\"")));
        }
        value.unwrap_or(f64::NAN)
    };
    let positions: Vec<Point3> = core(mesh, "vertices")
        .flat_map(|all| core(all, "vertex"))
        .map(|v| Point3::new(number(v, "x"), number(v, "y"), number(v, "z")) * unit_mm)
        .collect();
    if let Some(first) = unread.first() {
        let comma = if first.contains(',') { "; numbers have a point, not a comma" } else { "" };
        faults.push(Fault {
            check: "number",
            count: unread.len(),
            at_mm: None,
            detail: format!("object {id} has a vertex {first}, which says no number{comma}"),
        });
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
        faults.push(Fault {
            check: "index",
            count: outside,
            at_mm: None,
            detail: format!(
                "{outside} triangles of object {id} name a vertex that is not among its {}",
                positions.len()
            ),
        });
    }
    Mesh::new(positions, triangles)
}

/// Rows of a transform: `x' = x m[0] + y m[1] + z m[2] + m[3]`.
type Transform = [[f64; 3]; 4];

const STILL: Transform = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];

/// Where an item or a component puts which object.
fn placement(node: Node<'_, '_>, part: &str, unit_mm: f64, faults: &mut Vec<Fault>) -> (Place, Transform) {
    let path = node.attribute((PRODUCTION, "path")).map(|path| path.trim_start_matches('/'));
    let place = (path.unwrap_or(part).to_owned(), node.attribute("objectid").unwrap_or_default().to_owned());
    let Some(text) = node.attribute("transform") else { return (place, STILL) };
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|v| v.parse().ok()).collect();
    let is_number = numbers.len() == 12 && numbers.iter().all(|v| v.is_finite());
    let mut transform = STILL;
    if is_number {
        for (i, row) in transform.iter_mut().enumerate() {
            let scale = if i == 3 { unit_mm } else { 1.0 };
            for (j, value) in row.iter_mut().enumerate() {
                *value = numbers[3 * i + j] * scale;
            }
        }
    } else {
        faults.push(fault("transform", "a transform is not twelve numbers".to_owned()));
    }
    (place, transform)
}

/// A part that is named and not read yet.
fn missing_part(models: &BTreeMap<String, Model>) -> Option<String> {
    let of_objects = |model: &Model| -> Vec<String> {
        model.objects.values().flat_map(|o| &o.components).map(|((part, _), _)| part.clone()).collect()
    };
    let of_items =
        |model: &Model| -> Vec<String> { model.items.iter().map(|((part, _), _)| part.clone()).collect() };
    models
        .values()
        .flat_map(|m| [of_objects(m), of_items(m)].concat())
        .find(|part| !models.contains_key(part))
}

/// Follows what is to be built down to its meshes, and says what cannot be built. Meshes that are built in another size
/// or shape than their own are returned as they are built.
fn placed(
    models: &BTreeMap<String, Model>,
    main: &str,
    faults: &mut Vec<Fault>,
) -> (Vec<PackagedMesh>, Vec<(usize, String, Mesh)>) {
    let items = models.get(main).map_or(&[][..], |model| &model.items);
    if items.is_empty() {
        faults.push(fault("build", "nothing is to be built".to_owned()));
    }
    let (mut steps, mut scaled, mut built) = (0, Vec::new(), Vec::new());
    for (item, (place, transform)) in items.iter().enumerate() {
        let mut way =
            Way { models, bounds: None, faults, steps, scaled: &mut scaled, item, built: &mut built };
        way.follow(place, *transform, 0);
        steps = way.steps;
        // What reaches over an edge of the bed, slicers centre; what lies below or beside it is a mistake.
        let is_outside =
            |(low, high): &(Point3, Point3)| low.z < -ROUNDING_MM || high.x < 0.0 || high.y < 0.0;
        if let Some((low, _)) = way.bounds.filter(is_outside) {
            let at = [low.x, low.y, low.z].map(|v| format!("{v:.2}")).join(" ");
            let detail = format!("object {} stands below or beside the bed, from {at} mm", place.1);
            faults.push(fault("outside", detail));
        }
    }
    (scaled, built)
}

/// The way from an item down to its meshes.
struct Way<'a> {
    models: &'a BTreeMap<String, Model>,
    /// Lower and upper corner of all that was met.
    bounds: Option<(Point3, Point3)>,
    faults: &'a mut Vec<Fault>,
    /// Objects met, on the ways of all items.
    steps: usize,
    /// Meshes that are built otherwise than they are.
    scaled: &'a mut Vec<PackagedMesh>,
    /// The number of the item, and all solids of all items in place.
    item: usize,
    built: &'a mut Vec<(usize, String, Mesh)>,
}

impl Way<'_> {
    /// Whether a mesh in its place is kept: a few numbers in a file may ask for any number of copies.
    fn keeps(&self, mesh: &Mesh) -> bool {
        let kept: usize = self.built.iter().map(|(_, _, m)| m.triangles.len()).sum();
        self.built.len() < MAX_BUILT && kept + mesh.triangles.len() <= MAX_BUILT_TRIANGLES
    }

    fn follow(&mut self, (part, id): &Place, transform: Transform, depth: usize) {
        self.steps += 1;
        let Some(object) = self.models.get(part).and_then(|model| model.objects.get(id)) else {
            self.faults.push(fault("reference", format!("there is no object {id}")));
            return;
        };
        if depth > MAX_DEPTH || self.steps == MAX_STEPS {
            self.faults.push(fault("reference", format!("object {id} is made of itself, or of too many")));
        }
        if depth > MAX_DEPTH || self.steps >= MAX_STEPS {
            return;
        }
        if determinant(&transform) <= 0.0 {
            self.faults.push(fault("mirrored", format!("a transform mirrors or flattens object {id}")));
        }
        for p in object.mesh.iter().flat_map(|mesh| &mesh.positions) {
            let p = moved(&transform, *p);
            let (low, high) = self.bounds.unwrap_or((p, p));
            self.bounds = Some((low.inf(&p), high.sup(&p)));
        }
        let is_solid = matches!(object.kind.as_str(), "model" | "solidsupport");
        if let Some(mesh) = object.mesh.as_ref().filter(|m| is_solid && self.keeps(m)) {
            let positions = mesh.positions.iter().map(|p| moved(&transform, *p)).collect();
            self.built.push((self.item, object.name.clone(), Mesh::new(positions, mesh.triangles.clone())));
        }
        if let Some(mesh) =
            object.mesh.as_ref().filter(|_| !is_rigid(&transform) && self.scaled.len() < MAX_SCALED)
        {
            let positions = mesh.positions.iter().map(|p| moved(&transform, *p)).collect();
            let mesh = Mesh::new(positions, mesh.triangles.clone());
            self.scaled.push(PackagedMesh {
                name: format!("{}, as it is built", object.name),
                is_solid,
                mesh,
            });
        }
        for (place, inner) in &object.components {
            self.follow(place, after(inner, &transform), depth + 1);
        }
    }
}

/// Whether a transform turns and moves only.
fn is_rigid(m: &Transform) -> bool {
    (0..3).all(|i| {
        (0..3).all(|j| {
            let product: f64 = (0..3).map(|k| m[i][k] * m[j][k]).sum();
            (product - f64::from(u8::from(i == j))).abs() < RIGID
        })
    })
}

fn moved(m: &Transform, p: Point3) -> Point3 {
    let at = |j: usize| p.x * m[0][j] + p.y * m[1][j] + p.z * m[2][j] + m[3][j];
    Point3::new(at(0), at(1), at(2))
}

/// First `inner`, then `outer`.
fn after(inner: &Transform, outer: &Transform) -> Transform {
    let turned = |row: [f64; 3], shift: f64| {
        let at = |j: usize| (0..3).map(|k| row[k] * outer[k][j]).sum::<f64>() + shift * outer[3][j];
        [at(0), at(1), at(2)]
    };
    [turned(inner[0], 0.0), turned(inner[1], 0.0), turned(inner[2], 0.0), turned(inner[3], 1.0)]
}

fn determinant(m: &Transform) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

#[cfg(test)]
mod tests;
