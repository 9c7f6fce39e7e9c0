//! Names of the core specification: namespaces, parts, elements with their attributes, metadata,
//! units.

/// Namespace of the core specification.
pub(super) const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// Namespace of pinswitch's own metadata.
pub(super) const OWN: &str = "urn:pinswitch:configuration:1";
/// Namespace of the production extension: objects in separate parts.
pub(super) const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
/// Namespace of instances of schemas, which no element or attribute may have.
pub(super) const XSI: &str = "http://www.w3.org/2001/XMLSchema-instance";
/// Type of the relationship to the model.
pub(super) const MODEL_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
/// Part with the relationships of a package.
pub(super) const RELATIONSHIPS: &str = "_rels/.rels";
/// Part with the content types of a package.
pub(super) const CONTENT_TYPES: &str = "[Content_Types].xml";
/// Name of the model part in most packages.
pub(super) const USUAL_MODEL: &str = "3D/3dmodel.model";
/// Type of the relationship to a thumbnail.
pub(super) const THUMBNAIL_TYPE: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail";
/// Type of the relationship to a print ticket.
pub(super) const PRINT_TICKET_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket";
/// Type of the relationship to the core properties of a package.
pub(super) const CORE_PROPERTIES_TYPE: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/metadata/core-properties";
/// Beginning of the namespaces and relationship types of encrypted content.
pub(super) const SECURE_CONTENT: &str = "http://schemas.microsoft.com/3dmanufacturing/securecontent/";
/// Types of objects.
pub(super) const OBJECT_TYPES: [&str; 5] = ["model", "solidsupport", "support", "surface", "other"];
/// Attributes that slicers write without a namespace: Bambu Studio and its descendants mark triangles
/// that a person painted.
pub(super) const SLICER_ATTRIBUTES: [&str; 6] = [
    "printable of <item>",
    "paint_color of <triangle>",
    "paint_supports of <triangle>",
    "paint_seam of <triangle>",
    "paint_fuzzy_skin of <triangle>",
    "face_property of <triangle>",
];

/// Elements of the core namespace with their attributes.
const ELEMENTS: [(&str, &[&str]); 16] = [
    ("model", &["unit", "requiredextensions", "recommendedextensions"]),
    ("metadata", &["name", "preserve", "type"]),
    ("metadatagroup", &[]),
    ("resources", &[]),
    // The materials extension adds `displaypropertiesid` to both.
    ("basematerials", &["id", "displaypropertiesid"]),
    ("base", &["name", "displaycolor", "displaypropertiesid"]),
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
];
/// Elements with the elements of the core namespace in them (schema, B.1.1).
const CHILDREN: [(&str, &[&str]); 11] = [
    ("model", &["metadata", "resources", "build"]),
    ("resources", &["basematerials", "object"]),
    ("basematerials", &["base"]),
    ("metadatagroup", &["metadata"]),
    ("object", &["metadatagroup", "mesh", "components"]),
    ("mesh", &["vertices", "triangles"]),
    ("vertices", &["vertex"]),
    ("triangles", &["triangle"]),
    ("components", &["component"]),
    ("build", &["item"]),
    ("item", &["metadatagroup"]),
];
/// Elements with a place for elements of other namespaces, in addition to unknown ones.
const EXTENSIBLE: [&str; 6] = ["model", "resources", "object", "mesh", "component", "item"];
/// Names of metadata without a namespace.
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
/// Namespaces of extensions that leave meshes unchanged or that the reader supports: materials,
/// production, triangle sets.
const EXTENSIONS: [&str; 3] = [super::materials::NAMESPACE, PRODUCTION, super::triangle_sets::NAMESPACE];

/// Returns the attributes of an element; `None` for an unknown element.
pub(super) fn attributes(element: &str) -> Option<&'static [&'static str]> {
    ELEMENTS.iter().find(|(name, _)| *name == element).map(|(_, known)| *known)
}

/// Returns the elements of the core namespace that an element may contain.
pub(super) fn children(element: &str) -> &'static [&'static str] {
    CHILDREN.iter().find(|(name, _)| *name == element).map_or(&[], |(_, children)| *children)
}

/// Returns whether an element may contain elements of other namespaces.
pub(super) fn accepts_foreign(element: &str) -> bool {
    EXTENSIBLE.contains(&element) || attributes(element).is_none()
}

/// Returns whether metadata of this name may have no namespace.
pub(super) fn is_metadata(name: &str) -> bool {
    METADATA.contains(&name)
}

/// Returns the length of a unit in mm.
pub(super) fn unit_mm(name: &str) -> Option<f64> {
    UNITS.iter().find(|(unit, _)| *unit == name).map(|(_, mm)| *mm)
}

/// Returns whether a file that requires the extension of this namespace can be examined.
pub(super) fn is_supported(namespace: &str) -> bool {
    EXTENSIONS.contains(&namespace)
}

/// Returns the required attributes of an element. Those of vertices and triangles are checked where
/// their values are read.
pub(super) fn required_attributes(element: &str) -> &'static [&'static str] {
    match element {
        "metadata" => &["name"],
        "basematerials" | "object" => &["id"],
        "base" => &["name", "displaycolor"],
        "component" | "item" => &["objectid"],
        _ => &[],
    }
}
