//! XML documents of a package: a small tree of elements, with meshes read as they come.

use std::collections::BTreeMap;

use super::archive::malformed;
use super::core_spec::{CORE, attributes, required_attributes};
use super::error::ThreeMfReadError;
use super::materials;
use super::xml::{Attribute, Event, NamespaceId, XmlError, XmlReader};
use crate::mesh::Point3;

/// Most elements that are kept: all but vertices, triangles and the content of extensions.
const MAX_ELEMENTS: usize = 100_000;
/// Most names outside of the specification that are listed.
const MAX_UNKNOWN: usize = 20;

/// The namespace of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Namespace {
    None,
    Core,
    Other(String),
}

/// An element with its attributes, children and text.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) namespace: Namespace,
    pub(super) name: String,
    attributes: Vec<(Namespace, String, String)>,
    pub(super) children: Vec<Element>,
    pub(super) text: String,
    /// The content of a mesh of the core namespace.
    pub(super) mesh: Option<RawMesh>,
    /// Namespaces by the prefixes of the names in `name` and `requiredextensions`.
    pub(super) prefixes: BTreeMap<String, String>,
}

impl Element {
    /// The value of an attribute without a namespace.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attribute_in(&Namespace::None, name)
    }

    /// The value of an attribute in a namespace.
    pub(super) fn attribute_in(&self, namespace: &Namespace, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(ns, known, _)| ns == namespace && known == name).map(|(.., v)| &**v)
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
    /// Whether a triangle has a property without `pid`.
    pub(super) has_property: bool,
    /// Property groups of triangles.
    pub(super) groups: Vec<String>,
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
}

/// Builds a document from the events of the reader.
struct Builder<'a> {
    reader: XmlReader<'a>,
    open: Vec<Element>,
    elements: usize,
    document: Option<Element>,
    unknown: BTreeMap<String, usize>,
    missing: BTreeMap<String, usize>,
    materials: BTreeMap<String, usize>,
    forbidden: BTreeMap<String, usize>,
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
        document: None,
        unknown: BTreeMap::new(),
        missing: BTreeMap::new(),
        materials: BTreeMap::new(),
        forbidden: BTreeMap::new(),
    };
    builder.run().map_err(|error| match error {
        XmlError::Malformed(line, problem) => malformed(part, &format!("line {line}: {problem}")),
        XmlError::Bound(bound) => ThreeMfReadError::Bound(format!("{part} has {bound}")),
    })?;
    let Builder { document, unknown, missing, materials, forbidden, .. } = builder;
    let root = document.ok_or_else(|| malformed(part, "the document has no element"))?;
    Ok(Document { root, unknown, missing, materials, forbidden })
}

impl Builder<'_> {
    fn run(&mut self) -> Result<(), XmlError> {
        // Depth inside of an element that is not kept.
        let mut skipped = 0_usize;
        loop {
            match self.reader.next()? {
                Event::Start { namespace, name } => {
                    if skipped > 0 || !self.start(namespace, name)? {
                        skipped += 1;
                    }
                }
                Event::End if skipped > 0 => skipped -= 1,
                Event::End => self.end(),
                Event::Text(text) => {
                    if skipped == 0
                        && let Some(element) = self.open.last_mut()
                        && element.mesh.is_none()
                    {
                        element.text.push_str(&text);
                    }
                }
                Event::Eof => return Ok(()),
            }
        }
    }

    /// Handles the start of an element; returns whether it is kept.
    fn start(&mut self, namespace: Option<NamespaceId>, name: &str) -> Result<bool, XmlError> {
        let namespace = self.named(namespace);
        if namespace == Namespace::Core {
            self.check_core(name);
        }
        let parent = self.open.last();
        let in_core = |parent_name| parent.is_some_and(|parent| parent.is_core(parent_name));
        if namespace == Namespace::Core {
            if name == "vertex" && in_core("vertices") {
                self.vertex();
                return Ok(false);
            }
            if name == "triangle" && in_core("triangles") {
                self.triangle();
                return Ok(false);
            }
        } else if let Namespace::Other(uri) = &namespace
            && uri == materials::NAMESPACE
        {
            let values: Vec<_> = self.reader.attributes.iter().filter(|a| a.namespace.is_none()).collect();
            let problem = materials::problem(name, |wanted| {
                values.iter().find(|a| a.name == wanted).map(|a| &*a.value)
            });
            if let Some(problem) = problem {
                count(&mut self.materials, problem);
            }
        }
        // Elements of extensions matter only as resources: their ids are unique there.
        let is_kept = match parent {
            None => true,
            Some(parent) if self.is_plain() => parent.namespace != Namespace::Core,
            Some(parent) if namespace == Namespace::Core => parent.namespace == Namespace::Core,
            Some(_) => in_core("resources"),
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
        let attributes = self.reader.attributes.iter();
        let attributes: Vec<_> = attributes
            .map(|a| (self.named(a.namespace), a.name.to_owned(), a.value.clone().into_owned()))
            .collect();
        let mut prefixes = BTreeMap::new();
        for (_, key, value) in &attributes {
            let names = match key.as_str() {
                "name" if name == "metadata" => value.split(':').take(1).collect(),
                "requiredextensions" | "recommendedextensions" => value.split_whitespace().collect(),
                _ => Vec::new(),
            };
            for prefix in names.into_iter().take(MAX_UNKNOWN) {
                if let Some(id) = self.reader.lookup(prefix) {
                    prefixes.insert(prefix.to_owned(), self.reader.namespace(id).to_owned());
                }
            }
        }
        let mesh = (namespace == Namespace::Core && name == "mesh").then(RawMesh::default);
        let (name, text, children) = (name.to_owned(), String::new(), Vec::new());
        self.open.push(Element { namespace, name, attributes, children, text, mesh, prefixes });
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
        if self.reader.id_of(CORE) == Some(id) {
            return Namespace::Core;
        }
        Namespace::Other(self.reader.namespace(id).to_owned())
    }

    /// Records names outside of the specification, and required attributes that are missing.
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
                Some(0) if attribute.name == "space" => {
                    count(&mut self.forbidden, format!("xml:space of <{element}>"));
                }
                _ => {}
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
                Some(number) => *coordinate = number,
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
        let corner = |name| value(attributes, name).and_then(|text| text.trim().parse::<u32>().ok());
        match (corner("v1"), corner("v2"), corner("v3")) {
            (Some(a), Some(b), Some(c)) => mesh.triangles.push([a, b, c]),
            _ => mesh.without_indices += 1,
        }
        let has = |name| value(attributes, name).is_some();
        mesh.has_property |= has("p1") || has("pid");
        if let Some(group) = value(attributes, "pid")
            && mesh.groups.len() < MAX_UNKNOWN
            && !mesh.groups.iter().any(|known| known == group)
        {
            mesh.groups.push(group.to_owned());
        }
    }
}

fn value<'b>(attributes: &'b [Attribute<'_>], name: &str) -> Option<&'b str> {
    attributes.iter().find(|a| a.namespace.is_none() && a.name == name).map(|a| &*a.value)
}

/// A finite decimal number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}
