//! XML documents of a package: a small tree of elements, with meshes read as they come.

use std::collections::BTreeMap;
use std::rc::Rc;

use pinswitch_diagnostic::excerpt;

use super::archive::malformed;
use super::core_spec::{CORE, PRODUCTION, XSI, accepts_foreign, attributes, children, required_attributes};
use super::error::ThreeMfReadError;
use super::materials;
use super::triangle_sets::{self, TriangleSets};
use super::value::{index, is_number, number, problem};
use super::xml::{Attribute, Event, NamespaceId, XmlError, XmlReader};
use crate::mesh::Point3;

/// Most elements that are kept: all but vertices, triangles and the content of extensions.
const MAX_ELEMENTS: usize = 100_000;
/// Most bytes that the kept elements may take.
const MAX_KEPT_BYTES: usize = 48 << 20;
/// Bytes that an element and an attribute take in addition to their texts, with those of allocation.
const ELEMENT_BYTES: usize = 320;
const ATTRIBUTE_BYTES: usize = 128;
/// Longest value that a finding quotes, in characters.
const MAX_QUOTED: usize = 60;
/// Most names outside of the specification that are listed.
const MAX_UNKNOWN: usize = 20;

/// The namespace of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Namespace {
    None,
    Core,
    Other(Rc<str>),
}

impl Namespace {
    /// Whether this is the namespace of an extension.
    pub(super) fn is(&self, uri: &str) -> bool {
        matches!(self, Self::Other(known) if &**known == uri)
    }
}

/// An element with its attributes, children and text.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) namespace: Namespace,
    pub(super) name: String,
    attributes: Vec<(Namespace, String, String)>,
    pub(super) children: Vec<Element>,
    pub(super) text: String,
    /// Number of properties in a group of the materials extension.
    pub(super) properties: usize,
    /// The content of a mesh of the core namespace.
    pub(super) mesh: Option<RawMesh>,
    /// Namespaces by the prefixes of the names in `name` and `requiredextensions`.
    pub(super) prefixes: BTreeMap<String, Rc<str>>,
}

impl Element {
    /// The value of an attribute without a namespace.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        let is_wanted = |(ns, known, _): &&(_, String, _)| *ns == Namespace::None && known == name;
        self.attributes.iter().find(is_wanted).map(|(.., value)| &**value)
    }

    /// The value of an attribute in the namespace of an extension.
    pub(super) fn attribute_in(&self, namespace: &str, name: &str) -> Option<&str> {
        let is_wanted = |(ns, known, _): &&(Namespace, String, _)| ns.is(namespace) && known == name;
        self.attributes.iter().find(is_wanted).map(|(.., value)| &**value)
    }

    /// Whether this is the element `name` of the core namespace.
    pub(super) fn is_core(&self, name: &str) -> bool {
        self.namespace == Namespace::Core && self.name == name
    }

    /// Children in the core namespace.
    pub(super) fn core<'a>(&'a self, name: &'static str) -> impl Iterator<Item = &'a Self> {
        self.children.iter().filter(move |child| child.is_core(name))
    }
}

/// The content of a mesh, in the unit of its model.
#[derive(Clone, Debug, Default)]
pub(super) struct RawMesh {
    pub(super) positions: Vec<Point3>,
    /// Triangles with three indices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Number of triangles without three indices.
    pub(super) without_indices: usize,
    /// Number of coordinates that are not numbers, and the first of them.
    pub(super) invalid: Option<(usize, String)>,
    /// Number of coordinates that readers accept and the schema does not, and the first of them.
    pub(super) irregular: Option<(usize, String)>,
    /// Whether a triangle has a property.
    pub(super) has_property: bool,
    /// Properties of triangles, by their groups.
    pub(super) properties: Vec<TriangleProperties>,
    /// Number of `p1`, `p2` and `p3` that are not indices.
    pub(super) invalid_properties: usize,
    pub(super) sets: TriangleSets,
}

/// Properties of the triangles that refer to one group.
#[derive(Clone, Debug)]
pub(super) struct TriangleProperties {
    /// The group, or none for that of the object.
    pub(super) pid: Option<String>,
    /// The greatest index.
    pub(super) greatest: u32,
    /// Number of triangles whose corners have different properties.
    pub(super) gradients: usize,
}

/// A document, and what in it is outside of the core specification.
#[derive(Debug)]
pub(super) struct Document {
    pub(super) root: Element,
    /// Names outside of the specification, with their numbers of occurrences.
    pub(super) unknown: BTreeMap<String, usize>,
    /// Required attributes that are missing.
    pub(super) missing: BTreeMap<String, usize>,
    /// Elements of the materials extension without a required attribute.
    pub(super) materials: BTreeMap<String, usize>,
    /// Attributes of the namespaces `xml` and `xsi` that the specification forbids.
    pub(super) forbidden: BTreeMap<String, usize>,
    /// Values of attributes that are not of their type.
    pub(super) values: BTreeMap<String, usize>,
}

/// Builds a document from the events of the reader.
struct Builder<'a> {
    reader: XmlReader<'a>,
    open: Vec<Element>,
    elements: usize,
    /// Bytes that the kept elements take.
    kept: usize,
    /// The core namespace, once it is declared.
    core: Option<NamespaceId>,
    /// The vertex or triangle that is being read.
    leaf: Option<&'static str>,
    document: Option<Element>,
    unknown: BTreeMap<String, usize>,
    missing: BTreeMap<String, usize>,
    materials: BTreeMap<String, usize>,
    forbidden: BTreeMap<String, usize>,
    values: BTreeMap<String, usize>,
}

/// Counts an occurrence of a name, of not too many names.
fn count(names: &mut BTreeMap<String, usize>, name: String) {
    if names.len() < MAX_UNKNOWN || names.contains_key(&name) {
        *names.entry(name).or_default() += 1;
    }
}

/// Reads a document.
///
/// # Errors
/// [`ThreeMfReadError`] if the text is not well-formed or exceeds a bound.
pub(super) fn read_document(text: &str, part: &str) -> Result<Document, ThreeMfReadError> {
    let mut builder = Builder {
        reader: XmlReader::new(text),
        open: Vec::new(),
        elements: 0,
        kept: 0,
        core: None,
        leaf: None,
        document: None,
        unknown: BTreeMap::new(),
        missing: BTreeMap::new(),
        materials: BTreeMap::new(),
        forbidden: BTreeMap::new(),
        values: BTreeMap::new(),
    };
    builder.run().map_err(|error| match error {
        XmlError::Malformed(line, problem) => malformed(part, &format!("line {line}: {problem}")),
        XmlError::Bound(bound) => ThreeMfReadError::Bound(format!("{part} has {bound}")),
    })?;
    let Builder { document, unknown, missing, materials, forbidden, values, .. } = builder;
    let root = document.ok_or_else(|| malformed(part, "the document has no element"))?;
    Ok(Document { root, unknown, missing, materials, forbidden, values })
}

impl Builder<'_> {
    fn run(&mut self) -> Result<(), XmlError> {
        // Depth inside of an element that is not kept.
        let mut skipped = 0_usize;
        loop {
            match self.reader.next()? {
                Event::Start { namespace, name } => {
                    if let Some(leaf) = self.leaf.filter(|_| skipped == 1) {
                        count(&mut self.unknown, format!("<{name}> in <{leaf}>"));
                    }
                    if skipped > 0 {
                        self.in_extension(namespace, name);
                        skipped += 1;
                    } else if !self.start(namespace, name)? {
                        skipped = 1;
                    }
                }
                Event::End if skipped > 0 => {
                    skipped -= 1;
                    self.leaf = self.leaf.filter(|_| skipped > 0);
                }
                Event::End => self.end(),
                Event::Text(text) => self.text(&text, skipped)?,
                Event::Eof => return Ok(()),
            }
        }
    }

    /// Handles an element in one that is not kept.
    fn in_extension(&mut self, namespace: Option<NamespaceId>, name: &str) {
        let is_of_sets = namespace.is_some_and(|id| self.reader.id_of(triangle_sets::NAMESPACE) == Some(id));
        let mesh = self.open.last_mut().and_then(|element| element.mesh.as_mut());
        if let Some(mesh) = mesh.filter(|_| is_of_sets) {
            let attributes = &self.reader.attributes;
            mesh.sets.element(name, |wanted| value(attributes, wanted));
        }
    }

    /// Handles text in an element, or at a depth inside of one that is not kept.
    fn text(&mut self, text: &str, skipped: usize) -> Result<(), XmlError> {
        if text.bytes().all(|byte| byte.is_ascii_whitespace()) && !self.in_metadata() {
            return Ok(());
        }
        if let Some(leaf) = self.leaf.filter(|_| skipped == 1) {
            count(&mut self.unknown, format!("text in <{leaf}>"));
        }
        let Some(element) = self.open.last_mut().filter(|_| skipped == 0) else { return Ok(()) };
        if element.is_core("metadata") {
            element.text.push_str(text);
            return self.keep(text.len());
        }
        if element.namespace == Namespace::Core {
            count(&mut self.unknown, format!("text in <{}>", element.name));
        }
        Ok(())
    }

    fn in_metadata(&self) -> bool {
        self.open.last().is_some_and(|element| element.is_core("metadata"))
    }

    /// Counts bytes that are kept.
    fn keep(&mut self, bytes: usize) -> Result<(), XmlError> {
        self.kept += bytes;
        if self.kept > MAX_KEPT_BYTES {
            return Err(XmlError::Bound(format!(
                "attributes and metadata of more than {MAX_KEPT_BYTES} bytes"
            )));
        }
        Ok(())
    }

    /// Handles the start of an element; returns whether it is kept.
    fn start(&mut self, namespace: Option<NamespaceId>, name: &str) -> Result<bool, XmlError> {
        self.core = self.core.or_else(|| self.reader.id_of(CORE));
        let namespace = self.named(namespace);
        if namespace == Namespace::Core {
            self.check_core(name);
        }
        self.check_place(&namespace, name);
        let is_in_core = |open: &[Element], name| open.last().is_some_and(|parent| parent.is_core(name));
        if namespace == Namespace::Core {
            if name == "vertex" && is_in_core(&self.open, "vertices") {
                self.vertex();
                self.leaf = Some("vertex");
                return Ok(false);
            }
            if name == "triangle" && is_in_core(&self.open, "triangles") {
                self.triangle();
                self.leaf = Some("triangle");
                return Ok(false);
            }
        } else if namespace.is(materials::NAMESPACE) {
            let values: Vec<_> = self.reader.attributes.iter().filter(|a| a.namespace.is_none()).collect();
            let problem = materials::problem(name, |wanted| {
                values.iter().find(|a| a.name == wanted).map(|a| &*a.value)
            });
            if let Some(problem) = problem {
                count(&mut self.materials, problem);
            }
            if let Some(group) = self.open.last_mut()
                && group.namespace.is(materials::NAMESPACE)
                && materials::property_of(&group.name) == Some(name)
            {
                group.properties += 1;
            }
        }
        // Elements of extensions matter only as resources: their ids are unique there.
        let is_kept = match self.open.last() {
            None => true,
            Some(parent) if self.is_plain() => parent.namespace != Namespace::Core,
            Some(parent) if namespace == Namespace::Core => parent.namespace == Namespace::Core,
            Some(_) => is_in_core(&self.open, "resources"),
        };
        if !is_kept {
            return Ok(false);
        }
        self.elements += 1;
        if self.elements > MAX_ELEMENTS {
            let bound =
                format!("more than {MAX_ELEMENTS} XML elements in addition to vertices and triangles");
            return Err(XmlError::Bound(bound));
        }
        // Other attributes of core elements are only counted.
        let production = self.reader.id_of(PRODUCTION);
        let known = if namespace == Namespace::Core { self::attributes(name) } else { None };
        let is_read = |a: &&Attribute<'_>| match a.namespace {
            None => known.is_none_or(|known| known.contains(&a.name) || a.name == "printable"),
            some => some == production,
        };
        let read = self.reader.attributes.iter().filter(is_read);
        let attributes: Vec<_> = read
            .map(|a| (self.named(a.namespace), a.name.to_owned(), a.value.clone().into_owned()))
            .collect();
        let bytes = attributes.iter().map(|(_, key, value)| ATTRIBUTE_BYTES + key.len() + value.len());
        self.keep(ELEMENT_BYTES + name.len() + bytes.sum::<usize>())?;
        let mut prefixes = BTreeMap::new();
        for (_, key, value) in &attributes {
            let names = match key.as_str() {
                "name" if name == "metadata" => value.split(':').take(1).collect(),
                "requiredextensions" | "recommendedextensions" => value.split_whitespace().collect(),
                _ => Vec::new(),
            };
            for prefix in names.into_iter().take(MAX_UNKNOWN) {
                if let Some(id) = self.reader.lookup(prefix) {
                    prefixes.insert(prefix.to_owned(), self.reader.namespace(id));
                }
            }
        }
        let mesh = (namespace == Namespace::Core && name == "mesh").then(RawMesh::default);
        let (name, text, children) = (name.to_owned(), String::new(), Vec::new());
        self.open.push(Element {
            namespace,
            name,
            attributes,
            children,
            text,
            properties: 0,
            mesh,
            prefixes,
        });
        Ok(true)
    }

    /// Whether the document is a plain one of the package, without the core namespace.
    fn is_plain(&self) -> bool {
        self.open.iter().all(|element| element.namespace != Namespace::Core)
    }

    fn end(&mut self) {
        let Some(element) = self.open.pop() else { return };
        match self.open.last_mut() {
            Some(parent) => parent.children.push(element),
            None => self.document = Some(element),
        }
    }

    fn named(&self, id: Option<NamespaceId>) -> Namespace {
        let Some(id) = id else { return Namespace::None };
        if self.core == Some(id) {
            return Namespace::Core;
        }
        Namespace::Other(self.reader.namespace(id))
    }

    /// Records an element in a place where the schema does not have it.
    fn check_place(&mut self, namespace: &Namespace, name: &str) {
        let is_known =
            |parent: &&Element| parent.namespace == Namespace::Core && attributes(&parent.name).is_some();
        let Some(parent) = self.open.last().filter(is_known) else { return };
        let problem = match namespace {
            Namespace::Core if attributes(name).is_none() || children(&parent.name).contains(&name) => return,
            Namespace::Core => format!("<{name}> in <{}>", parent.name),
            Namespace::None => format!("<{name}> without a namespace in <{}>", parent.name),
            Namespace::Other(_) if accepts_foreign(&parent.name) => return,
            Namespace::Other(_) => format!("<{name}> of another namespace in <{}>", parent.name),
        };
        count(&mut self.unknown, problem);
    }

    /// Records names outside of the specification, required attributes that are missing, and values
    /// that are not of their type.
    fn check_core(&mut self, element: &str) {
        let Some(known) = attributes(element) else {
            count(&mut self.unknown, format!("<{element}>"));
            return;
        };
        for attribute in &self.reader.attributes {
            match attribute.namespace {
                None if !known.contains(&attribute.name) => {
                    count(&mut self.unknown, format!("{} of <{element}>", attribute.name));
                }
                None => {
                    if let Some(problem) = problem(element, attribute.name, &attribute.value) {
                        let value = excerpt(&attribute.value, MAX_QUOTED);
                        let problem = format!("{}={value:?} of <{element}> {problem}", attribute.name);
                        count(&mut self.values, problem);
                    }
                }
                Some(0) if attribute.name == "lang" => {
                    if !is_language(&attribute.value) {
                        let value = excerpt(&attribute.value, MAX_QUOTED);
                        count(
                            &mut self.values,
                            format!("xml:lang={value:?} of <{element}> is not a language"),
                        );
                    }
                }
                Some(0) => count(&mut self.forbidden, format!("xml:{} of <{element}>", attribute.name)),
                Some(id) if self.reader.id_of(XSI) == Some(id) => {
                    count(&mut self.forbidden, format!("xsi:{} of <{element}>", attribute.name));
                }
                Some(id) if self.core == Some(id) => {
                    count(&mut self.unknown, format!("{} of <{element}> with a namespace", attribute.name));
                }
                Some(_) => {}
            }
        }
        for name in required_attributes(element) {
            if !self.reader.attributes.iter().any(|a| a.namespace.is_none() && a.name == *name) {
                count(&mut self.missing, format!("<{element}> without {name}"));
            }
        }
    }

    /// The mesh that is being read.
    fn mesh(open: &mut [Element]) -> Option<&mut RawMesh> {
        open.iter_mut().rev().nth(1).and_then(|mesh| mesh.mesh.as_mut())
    }

    fn vertex(&mut self) {
        let attributes = &self.reader.attributes;
        let Some(mesh) = Self::mesh(&mut self.open) else { return };
        let mut coordinates = [f64::NAN; 3];
        for (coordinate, name) in coordinates.iter_mut().zip(["x", "y", "z"]) {
            let value = value(attributes, name);
            match value.and_then(number) {
                Some(number) => {
                    *coordinate = number;
                    if let Some(text) = value.filter(|text| !is_number(text)) {
                        let first = || format!("with {name}=\"{text}\"");
                        mesh.irregular.get_or_insert_with(|| (0, first())).0 += 1;
                    }
                }
                None => {
                    let first = || {
                        value.map_or_else(|| format!("without {name}"), |v| format!("with {name}=\"{v}\""))
                    };
                    mesh.invalid.get_or_insert_with(|| (0, first())).0 += 1;
                }
            }
        }
        mesh.positions.push(Point3::from(coordinates));
    }

    fn triangle(&mut self) {
        let attributes = &self.reader.attributes;
        let Some(mesh) = Self::mesh(&mut self.open) else { return };
        let corner = |name| value(attributes, name).and_then(index);
        match (corner("v1"), corner("v2"), corner("v3")) {
            (Some(a), Some(b), Some(c)) => mesh.triangles.push([a, b, c]),
            _ => mesh.without_indices += 1,
        }
        let pid = value(attributes, "pid");
        let indices = ["p1", "p2", "p3"].map(|name| value(attributes, name).map(index));
        if pid.is_none() && indices == [None; 3] {
            return;
        }
        mesh.has_property = true;
        mesh.invalid_properties += indices.iter().filter(|given| **given == Some(None)).count();
        let given = || indices.iter().filter_map(|index| index.flatten());
        let place = mesh.properties.iter().position(|known| known.pid.as_deref() == pid);
        let place = place.unwrap_or_else(|| {
            let pid = pid.map(str::to_owned);
            mesh.properties.push(TriangleProperties { pid, greatest: 0, gradients: 0 });
            mesh.properties.len() - 1
        });
        let all = &mut mesh.properties[place];
        all.greatest = all.greatest.max(given().max().unwrap_or(0));
        all.gradients += usize::from(given().min() != given().max());
        // Other groups of an object with many are not compared.
        mesh.properties.truncate(MAX_UNKNOWN);
    }
}

/// Whether a text is a language by its form, or empty (`xs:language` or an empty text).
fn is_language(text: &str) -> bool {
    let is_subtag = |(i, part): (usize, &str)| {
        (1..=8).contains(&part.len())
            && part.bytes().all(|byte| byte.is_ascii_alphabetic() || (i > 0 && byte.is_ascii_digit()))
    };
    text.trim().is_empty() || text.trim().split('-').enumerate().all(is_subtag)
}

fn value<'b>(attributes: &'b [Attribute<'_>], name: &str) -> Option<&'b str> {
    attributes.iter().find(|a| a.namespace.is_none() && a.name == name).map(|a| &*a.value)
}
