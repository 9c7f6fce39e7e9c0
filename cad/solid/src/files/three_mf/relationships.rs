//! Relationships and content types of a package (Open Packaging Conventions).

use std::collections::{HashMap, HashSet};

use super::archive::Archive;
use super::core_spec::{
    CONTENT_TYPES, CORE_PROPERTIES_TYPE, MODEL_TYPE, PRINT_TICKET_TYPE, SECURE_CONTENT, THUMBNAIL_TYPE,
};
use super::document::{Element, read_document};
use super::error::ThreeMfReadError;
use super::findings::Findings;
use super::part_name::{extension, normalized, relationships_of, resolved};
use super::xml::MAX_NAME_BYTES;
use crate::validity::Level;

/// Content type of a model part (core specification, C.1).
const MODEL_CONTENT: &str = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml";
/// Content types of thumbnails (core specification, 6.1).
const IMAGES: [&str; 2] = ["image/jpeg", "image/png"];

/// A relationship.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Relationship {
    pub(super) kind: String,
    /// The part that it refers to.
    pub(super) target: String,
    /// Its target in the form in which equivalent names are equal.
    pub(super) key: String,
    id: Option<String>,
    is_external: bool,
    has_fragment: bool,
}

/// Reads the relationships of a part, or of the package if `source` is empty; `None` if there are
/// none.
pub(super) fn relationships(
    archive: &mut Archive<'_>,
    source: &str,
    findings: &mut Findings,
) -> Result<Option<Vec<Relationship>>, ThreeMfReadError> {
    let part = relationships_of(source);
    let Some(text) = archive.text(&part)? else { return Ok(None) };
    let root = read_document(&text, &part)?.root;
    let mut all = Vec::new();
    for element in root.children.iter().filter(|element| element.name == "Relationship") {
        let (kind, target) = (element.attribute("Type"), element.attribute("Target"));
        if kind.into_iter().chain(target).any(|text| text.len() > MAX_NAME_BYTES) {
            let bound = format!("{part} has a relationship of more than {MAX_NAME_BYTES} bytes");
            return Err(ThreeMfReadError::Bound(bound));
        }
        let (Some(kind), Some(written)) = (kind, target) else {
            let detail = format!("{part} has a relationship without Type or Target");
            findings.error("relationships", if kind.is_none() { "OPC M1.27" } else { "OPC M1.28" }, &detail);
            continue;
        };
        let target = resolved(source, written);
        all.push(Relationship {
            kind: kind.to_owned(),
            key: normalized(&target),
            target,
            id: element.attribute("Id").map(str::to_owned),
            is_external: element.attribute("TargetMode") == Some("External") || is_absolute_uri(written),
            has_fragment: written.contains('#'),
        });
    }
    Ok(Some(all))
}

/// Whether a text is a name of XML without a colon, as an id is (`xsd:ID`).
fn is_id(text: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '\u{b7}');
    text.starts_with(|c: char| c.is_alphabetic() || c == '_') && text.chars().all(is_part)
}

/// Whether a target begins with the scheme of an absolute URI, or with the drive of a path.
fn is_absolute_uri(target: &str) -> bool {
    let is_scheme = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
    target.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(is_scheme)
    })
}

/// Content types of parts.
#[derive(Debug)]
pub(super) struct ContentTypes {
    defaults: HashMap<String, String>,
    overrides: HashMap<String, String>,
}

impl ContentTypes {
    /// Reads the content types of a package; `None` if there are none.
    pub(super) fn read(
        archive: &mut Archive<'_>,
        findings: &mut Findings,
    ) -> Result<Option<Self>, ThreeMfReadError> {
        let Some(text) = archive.text(CONTENT_TYPES)? else { return Ok(None) };
        let root = read_document(&text, CONTENT_TYPES)?.root;
        let entries = |name: &'static str, key: &'static str| {
            let elements = root.children.iter().filter(move |element| element.name == name);
            elements.filter_map(move |e| Some((e.attribute(key)?, e.attribute("ContentType")?.to_owned())))
        };
        for element in &root.children {
            if let Some((problem, paragraph)) = problem_of_type(element) {
                findings.error("content types", paragraph, &format!("{CONTENT_TYPES}: {problem}"));
            }
        }
        let mut types = Self { defaults: HashMap::new(), overrides: HashMap::new() };
        let mut repeated = Vec::new();
        for (extension, kind) in entries("Default", "Extension") {
            if types.defaults.insert(extension.to_ascii_lowercase(), kind).is_some() {
                repeated.push(extension);
            }
        }
        for (part, kind) in entries("Override", "PartName") {
            if types.overrides.insert(normalized(part), kind).is_some() {
                repeated.push(part);
            }
        }
        for name in repeated {
            let detail = format!("{CONTENT_TYPES} has two content types for {name}");
            findings.error("content types", "OPC M2.5", &detail);
        }
        Ok(Some(types))
    }

    /// Reports parts without a content type. Slicers add settings without one, which no relationship
    /// refers to and no other reader needs: a warning.
    pub(super) fn check_parts(&self, archive: &Archive<'_>, model: &str, findings: &mut Findings) {
        for name in archive.names().filter(|name| normalized(name) != normalized(CONTENT_TYPES)) {
            if self.of(name).is_none() {
                let is_needed = extension(name) == "rels" || normalized(name) == model;
                let level = if is_needed { Level::Error } else { Level::Warning };
                let detail = format!("{name} has no content type");
                findings.add("content types", level, 1, "OPC M2.4", &detail);
            }
        }
    }

    /// The content type of a part.
    fn of(&self, part: &str) -> Option<&str> {
        let by_extension = || self.defaults.get(&extension(part));
        self.overrides.get(&normalized(part)).or_else(by_extension).map(String::as_str)
    }

    /// Checks that the model in `part` has its content type.
    pub(super) fn check_model(&self, part: &str, findings: &mut Findings) {
        match self.of(part) {
            // Reported with the parts without a content type.
            None => {}
            Some(found) if found != MODEL_CONTENT => {
                let detail = format!("{part} has the content type {found}, not that of a 3D model");
                findings.error("content types", "3MF core 2.1.1", &detail);
            }
            Some(_) => {}
        }
    }
}

/// Returns what is wrong with an entry of the content types, with the paragraph that it breaks.
fn problem_of_type(entry: &Element) -> Option<(String, &'static str)> {
    let (key, paragraph) = match entry.name.as_str() {
        "Default" => ("Extension", "OPC M2.6"),
        "Override" => ("PartName", "OPC M2.7"),
        other => return Some((format!("it has an element <{other}>"), "OPC M2.5")),
    };
    let Some(name) = entry.attribute(key) else {
        return Some((format!("<{}> without {key}", entry.name), paragraph));
    };
    let kind = entry.attribute("ContentType").unwrap_or_default();
    if !is_media_type(kind) {
        return Some((format!("the content type {kind:?} of {name} is not a media type"), "OPC M1.14"));
    }
    let is_extension = !name.is_empty() && !name.contains(['/', '.']);
    match entry.name.as_str() {
        "Default" if !is_extension => Some((format!("{name:?} is not an extension"), paragraph)),
        "Override" if !name.starts_with('/') => {
            Some((format!("the part name {name:?} does not begin with a slash"), "OPC M1.4"))
        }
        _ => None,
    }
}

/// Whether a text is a media type, such as `image/png` (RFC 2616, 3.7), without a comment.
fn is_media_type(text: &str) -> bool {
    let is_token = |token: &str| {
        let is_part = |c: char| c.is_ascii_alphanumeric() || "!#$%&'*+-.^_`|~".contains(c);
        !token.is_empty() && token.chars().all(is_part)
    };
    let kind = text.split(';').next().unwrap_or_default().trim();
    kind.split_once('/').is_some_and(|(kind, of_kind)| is_token(kind) && is_token(of_kind))
}

/// Checks the relationships of `source`, empty for the package.
///
/// # Errors
/// [`ThreeMfReadError::Unsupported`] if the content is encrypted.
pub(super) fn check(
    all: &[Relationship],
    source: &str,
    archive: &mut Archive<'_>,
    types: Option<&ContentTypes>,
    findings: &mut Findings,
) -> Result<(), ThreeMfReadError> {
    if all.iter().any(|one| one.kind.starts_with(SECURE_CONTENT)) {
        return Err(ThreeMfReadError::Unsupported("its content is encrypted".to_owned()));
    }
    let of_kind = |kind: &'static str| all.iter().filter(move |one| one.kind == kind);
    let is_model = source.is_empty();
    if is_model && of_kind(MODEL_TYPE).count() > 1 {
        let detail = "the package has more than one relationship to a 3D model";
        findings.error("relationships", "3MF core 2.1", detail);
    }
    if of_kind(PRINT_TICKET_TYPE).count() > 1 {
        findings.error("relationships", "3MF core 2.1.4", "the model has more than one print ticket");
    }
    if is_model && of_kind(CORE_PROPERTIES_TYPE).count() > 1 {
        let detail = "the package has more than one relationship to core properties";
        findings.error("relationships", "OPC M4.1", detail);
    }
    let (mut ids, mut pairs) = (HashSet::new(), HashSet::new());
    for one in all {
        match one.id.as_deref() {
            Some(id) if is_id(id) && ids.insert(id) => {}
            Some(id) => {
                let detail = format!("the relationship id {id:?} is not a name, or not unique");
                findings.error("relationships", "OPC M1.26", &detail);
            }
            None => {
                let detail = format!("the relationship to {} has no Id", one.target);
                findings.error("relationships", "OPC M1.26", &detail);
            }
        }
        if one.has_fragment {
            let detail = format!("the relationship to {} has a fragment", one.target);
            findings.warning("relationships", "OPC O1.6", &detail);
        }
        if !one.is_external && !pairs.insert((&one.kind, &one.key)) {
            let detail = format!("two relationships of one type to {}", one.target);
            findings.error("relationships", "3MF core 2.1.1", &detail);
        }
        let is_core = [MODEL_TYPE, PRINT_TICKET_TYPE, THUMBNAIL_TYPE].contains(&one.kind.as_str());
        if one.is_external {
            findings.error(
                "relationships",
                "3MF core 2.1.1",
                "a relationship refers to an external resource",
            );
        } else if is_core && !archive.contains(&one.target) {
            let detail = format!("{} is missing, which a relationship refers to", one.target);
            findings.error("relationships", "3MF core 2.1.1", &detail);
        } else if one.kind == THUMBNAIL_TYPE
            && !types.and_then(|types| types.of(&one.target)).is_some_and(|found| IMAGES.contains(&found))
        {
            let detail = format!("the thumbnail {} has not the content type of a JPEG or PNG", one.target);
            findings.error("thumbnail", "3MF core 2.1.3", &detail);
        } else if one.kind == THUMBNAIL_TYPE
            && !archive
                .beginning(&one.target)
                .is_some_and(|bytes| IMAGE_SIGNATURES.iter().any(|signature| bytes.starts_with(signature)))
        {
            let detail = format!("the thumbnail {} is not a JPEG or PNG", one.target);
            findings.error("thumbnail", "3MF core 2.1.3", &detail);
        } else if !is_core
            && archive.contains(&one.target)
            && types.is_some_and(|types| types.of(&one.target).is_none())
        {
            let detail = format!("{} has no content type, and a relationship refers to it", one.target);
            findings.error("content types", "OPC M2.4", &detail);
        }
    }
    Ok(())
}

/// First bytes of a PNG and of a JPEG.
const IMAGE_SIGNATURES: [&[u8]; 2] = [b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"];
