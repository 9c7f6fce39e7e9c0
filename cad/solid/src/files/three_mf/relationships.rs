//! Relationships and content types of a package (Open Packaging Conventions).

use std::collections::HashMap;

use super::archive::Archive;
use super::core_spec::{CONTENT_TYPES, MODEL_TYPE, PRINT_TICKET_TYPE, SECURE_CONTENT, THUMBNAIL_TYPE};
use super::document::{Element, read_document};
use super::error::ThreeMfReadError;
use super::findings::Findings;
use super::part_name::{extension, normalized, relationships_of, resolved};

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
    is_external: bool,
}

/// Reads the relationships of a part, or of the package if `source` is empty; `None` if there are
/// none.
pub(super) fn relationships(
    archive: &mut Archive<'_>,
    source: &str,
) -> Result<Option<Vec<Relationship>>, ThreeMfReadError> {
    let part = relationships_of(source);
    let Some(text) = archive.text(&part)? else { return Ok(None) };
    let root = read_document(&text, &part)?.root;
    let relationship = |element: &Element| {
        Some(Relationship {
            kind: element.attribute("Type")?.to_owned(),
            target: resolved(source, element.attribute("Target")?),
            is_external: element.attribute("TargetMode") == Some("External")
                || element.attribute("Target").is_some_and(is_absolute_uri),
        })
    };
    let elements = root.children.iter().filter(|element| element.name == "Relationship");
    Ok(Some(elements.filter_map(relationship).collect()))
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
    pub(super) fn read(archive: &mut Archive<'_>) -> Result<Option<Self>, ThreeMfReadError> {
        let Some(text) = archive.text(CONTENT_TYPES)? else { return Ok(None) };
        let root = read_document(&text, CONTENT_TYPES)?.root;
        let entries = |name: &'static str, key: &'static str| {
            let elements = root.children.iter().filter(move |element| element.name == name);
            elements.filter_map(move |e| Some((e.attribute(key)?, e.attribute("ContentType")?.to_owned())))
        };
        Ok(Some(Self {
            defaults: entries("Default", "Extension").map(|(k, v)| (k.to_ascii_lowercase(), v)).collect(),
            overrides: entries("Override", "PartName").map(|(k, v)| (normalized(k), v)).collect(),
        }))
    }

    /// The content type of a part.
    fn of(&self, part: &str) -> Option<&str> {
        let by_extension = || self.defaults.get(&extension(part));
        self.overrides.get(&normalized(part)).or_else(by_extension).map(String::as_str)
    }

    /// Checks that the model in `part` has its content type.
    pub(super) fn check_model(&self, part: &str, findings: &mut Findings) {
        match self.of(part) {
            // Every reader finds the model by its relationship.
            None => findings.warning("content types", "OPC M2.4", &format!("{part} has no content type")),
            Some(found) if found != MODEL_CONTENT => {
                let detail = format!("{part} has the content type {found}, not that of a 3D model");
                findings.error("content types", "3MF core 2.1.1", &detail);
            }
            Some(_) => {}
        }
    }
}

/// Checks the relationships of `source`, empty for the package.
///
/// # Errors
/// [`ThreeMfReadError::Unsupported`] if the content is encrypted.
pub(super) fn check(
    all: &[Relationship],
    source: &str,
    archive: &Archive<'_>,
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
    for (i, one) in all.iter().enumerate().take(MAX_COMPARED) {
        let is_same = |other: &Relationship| {
            other.kind == one.kind && normalized(&other.target) == normalized(&one.target)
        };
        if all[..i].iter().any(is_same) && !one.is_external {
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
        }
    }
    Ok(())
}

/// Most relationships of a part that are compared with each other.
const MAX_COMPARED: usize = 500;
