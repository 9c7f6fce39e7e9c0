//! Resources of the materials extension: required attributes and references.

use std::collections::HashMap;

use super::document::{Element, Namespace};
use super::findings::Findings;
use super::value::{is_number, resource_id};

/// Namespace of the materials extension.
pub(super) const NAMESPACE: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

/// Elements of the extension with their required attributes (chapters 2 to 6).
const REQUIRED: [(&str, &[&str]); 9] = [
    ("colorgroup", &["id"]),
    ("color", &["color"]),
    ("texture2dgroup", &["id", "texid"]),
    ("tex2coord", &["u", "v"]),
    ("compositematerials", &["id", "matid", "matindices"]),
    ("composite", &["values"]),
    ("multiproperties", &["id", "pids"]),
    ("multi", &["pindices"]),
    ("texture2d", &["id", "path", "contenttype"]),
];

/// How a texture continues beyond its edges (chapter 6.1).
const TILE_STYLES: [&str; 4] = ["wrap", "mirror", "clamp", "none"];

/// Groups of properties with the element of each property (chapters 2 to 5).
const GROUPS: [(&str, &str); 4] = [
    ("colorgroup", "color"),
    ("texture2dgroup", "tex2coord"),
    ("compositematerials", "composite"),
    ("multiproperties", "multi"),
];

/// Returns the element of a property of a group; `None` for another element.
pub(super) fn property_of(group: &str) -> Option<&'static str> {
    GROUPS.iter().find(|(name, _)| *name == group).map(|(_, property)| *property)
}

/// Returns what is wrong with the attributes of an element of the extension.
pub(super) fn problem<'a>(element: &str, value: impl Fn(&str) -> Option<&'a str>) -> Option<String> {
    let (_, required) = REQUIRED.iter().find(|(name, _)| *name == element)?;
    if let Some(name) = required.iter().find(|name| value(name).is_none()) {
        return Some(format!("<{element}> without {name}"));
    }
    let color = value("color").filter(|_| element == "color");
    if color.is_some_and(|color| !is_color(color)) {
        return Some("a color is not #RRGGBB or #RRGGBBAA".to_owned());
    }
    if element == "tex2coord" && ["u", "v"].into_iter().filter_map(&value).any(|text| !is_number(text)) {
        return Some("a texture coordinate is not a number".to_owned());
    }
    let tiles = || ["tilestyleu", "tilestylev"].into_iter().filter_map(&value);
    if element == "texture2d" && tiles().any(|style| !TILE_STYLES.contains(&style)) {
        return Some("a tile style is not wrap, mirror, clamp or none".to_owned());
    }
    let content_type = value("contenttype").filter(|_| element == "texture2d");
    content_type
        .filter(|name| !["image/jpeg", "image/png"].contains(name))
        .map(|_| "the content type of a texture is not image/jpeg or image/png".to_owned())
}

/// Whether a text is a color of 6 or 8 hexadecimal digits.
pub(super) fn is_color(text: &str) -> bool {
    let digits = text.trim().strip_prefix('#').unwrap_or_default();
    matches!(digits.len(), 6 | 8) && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Checks references between the resources of a model.
pub(super) fn check_references(resources: &Element, findings: &mut Findings) {
    let kind = |element: &Element| match &element.namespace {
        Namespace::Core => element.name.clone(),
        namespace if namespace.is(NAMESPACE) => element.name.clone(),
        _ => String::new(),
    };
    let kinds: HashMap<String, String> =
        resources.children.iter().filter_map(|e| Some((resource_id(e.attribute("id")?), kind(e)))).collect();
    let is_extension = |e: &&Element| e.namespace.is(NAMESPACE);
    for element in resources.children.iter().filter(is_extension) {
        let kind_of =
            |name: &str| element.attribute(name).map(|id| kinds.get(&resource_id(id)).map(String::as_str));
        if let Some(property) = property_of(&element.name).filter(|_| element.properties == 0) {
            let detail = format!("<{}> without a <{property}>", element.name);
            findings.error("materials", "3MF materials 2 to 5", &detail);
        }
        match element.name.as_str() {
            "texture2dgroup" if kind_of("texid").is_some_and(|kind| kind != Some("texture2d")) => {
                findings.error("materials", "3MF materials 3", "texid refers to no <texture2d>");
            }
            "compositematerials" if kind_of("matid").is_some_and(|kind| kind != Some("basematerials")) => {
                findings.error("materials", "3MF materials 4", "matid refers to no <basematerials>");
            }
            "multiproperties" => check_multiproperties(element, &kinds, findings),
            _ => {}
        }
    }
}

fn check_multiproperties(element: &Element, kinds: &HashMap<String, String>, findings: &mut Findings) {
    let ids = element.attribute("pids").unwrap_or_default().split_whitespace();
    let listed: Vec<&str> = ids.map(|id| kinds.get(&resource_id(id)).map_or("", String::as_str)).collect();
    // Of one layer and the next; without methods, layers are mixed.
    let methods: Vec<&str> =
        element.attribute("blendmethods").unwrap_or_default().split_whitespace().collect();
    let count = |names: &[&str]| listed.iter().filter(|kind| names.contains(kind)).count();
    for (is_wrong, problem) in [
        (
            count(&["basematerials", "compositematerials"]) > 1,
            "more than one group of base or composite materials",
        ),
        (count(&["colorgroup"]) > 1, "more than one <colorgroup>"),
        (count(&["multiproperties"]) > 0, "another <multiproperties>"),
        (count(&[""]) > 0, "a resource that does not exist"),
    ] {
        if is_wrong {
            findings.error("materials", "3MF materials 5", &format!("<multiproperties> refers to {problem}"));
        }
    }
    // Files of the consortium that must pass do this.
    if count(&["texture2d"]) > 0 {
        let detail = "<multiproperties> refers to a <texture2d>, which is not a group of properties";
        findings.warning("materials", "3MF materials 5", detail);
    }
    if methods.len() >= listed.len().max(1) {
        let detail =
            format!("<multiproperties> has {} blendmethods for {} layers", methods.len(), listed.len());
        findings.error("materials", "3MF materials 5", &detail);
    }
    if let Some(unknown) = methods.iter().find(|method| !["mix", "multiply"].contains(method)) {
        findings.error(
            "materials",
            "3MF materials 5",
            &format!("{unknown} is not a blend method: mix or multiply"),
        );
    }
}
