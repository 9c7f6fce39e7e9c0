//! What the core specification knows: elements with their attributes, metadata, units.

/// Elements of the core namespace with their attributes; those of other namespaces mean nothing to it.
const ELEMENTS: [(&str, &[&str]); 17] = [
    ("model", &["unit", "requiredextensions", "recommendedextensions"]),
    ("metadata", &["name", "preserve", "type"]),
    ("metadatagroup", &[]),
    ("resources", &[]),
    ("basematerials", &["id"]),
    ("base", &["name", "displaycolor"]),
    ("object", &["id", "type", "thumbnail", "partnumber", "name", "pid", "pindex"]),
    ("mesh", &[]),
    ("vertices", &[]),
    ("vertex", &["x", "y", "z"]),
    ("triangles", &[]),
    ("triangle", &["v1", "v2", "v3", "p1", "p2", "p3", "pid"]),
    ("components", &[]),
    ("component", &["objectid", "transform"]),
    ("build", &[]),
    ("item", &["objectid", "transform", "partnumber"]),
    // Of the first edition of the specification; readers skip them.
    ("multiproperties", &[]),
];
/// Names of metadata that need no namespace.
const METADATA: [&str; 9] = [
    "Title",
    "Designer",
    "Description",
    "Copyright",
    "LicenseTerms",
    "Rating",
    "CreationDate",
    "ModificationDate",
    "Application",
];
/// Units with their length in millimetres.
const UNITS: [(&str, f64); 6] = [
    ("micron", 1e-3),
    ("millimeter", 1.0),
    ("centimeter", 10.0),
    ("inch", 25.4),
    ("foot", 304.8),
    ("meter", 1e3),
];
/// Extensions that change nothing of a mesh, or that are read: materials, production (parts in files of their own), slices,
/// beams beside the mesh, secure content, boolean, displacement are told apart by their namespaces.
const EXTENSIONS: [&str; 3] = [
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    super::read::PRODUCTION,
    "http://schemas.3mf.io/3dmanufacturing/triangle/2023/07",
];

/// The attributes of an element; `None` if there is no such element.
pub(super) fn attributes(element: &str) -> Option<&'static [&'static str]> {
    ELEMENTS.iter().find(|(name, _)| *name == element).map(|(_, known)| *known)
}

/// Whether metadata of this name may stand without a namespace.
pub(super) fn is_metadata(name: &str) -> bool {
    METADATA.contains(&name)
}

/// Millimetres of a unit.
pub(super) fn unit_mm(name: &str) -> Option<f64> {
    UNITS.iter().find(|(unit, _)| *unit == name).map(|(_, mm)| *mm)
}

/// Whether a file that needs the extension of this namespace can be examined.
pub(super) fn is_understood(namespace: &str) -> bool {
    EXTENSIONS.contains(&namespace)
}
