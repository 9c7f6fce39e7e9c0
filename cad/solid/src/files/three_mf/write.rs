//! Writes a package: printed parts as named, coloured objects in their places on one plate.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use pinswitch_diagnostic::{Diagnostic, codes};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::core_spec::{CORE, MODEL_TYPE, OWN};
use crate::files::plate::Placement;
use crate::mesh::Mesh;

/// A printed part.
#[derive(Clone, Debug)]
pub struct Object<'a> {
    /// Name that slicers show.
    pub name: &'a str,
    /// Part number: the same in every run, different for different configurations.
    pub part_number: String,
    /// Mesh in print orientation.
    pub mesh: &'a Mesh,
    /// Index of its material in [`Package::materials`]; a larger one for no material.
    pub material: usize,
    /// Place on the plate; the number of the plate is ignored.
    pub place: Placement,
}

/// A material, and the colour in which viewers show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseMaterial {
    /// Name.
    pub name: String,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// The content of a package in addition to its objects.
#[derive(Clone, Debug, Default)]
pub struct Package {
    /// Metadata with names of the core specification (title, designer, description, licence).
    pub metadata: Vec<(&'static str, String)>,
    /// Metadata in the namespace of pinswitch.
    pub own_metadata: Vec<(&'static str, String)>,
    /// Materials of the objects.
    pub materials: Vec<BaseMaterial>,
    /// Thumbnail as PNG; empty for none.
    pub thumbnail: Vec<u8>,
    /// Attached files by their names in `Metadata/`, such as the friction curve.
    pub attachments: Vec<(String, Vec<u8>)>,
}

/// A package that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the 3MF: {0}")]
pub struct ThreeMfError(#[from] zip::result::ZipError);

impl From<ThreeMfError> for Diagnostic {
    fn from(error: ThreeMfError) -> Self {
        Self::from_error(codes::INTERNAL_ERROR, error)
    }
}

const RELATIONSHIPS: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
const THUMBNAIL_TYPE: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail";
/// Type of the relationship to an attachment, which printers ignore.
const ATTACHMENT_TYPE: &str = "urn:pinswitch:attachment:1";

/// Returns the bytes of a 3MF file with `objects` in their places. The same input gives the same
/// bytes.
///
/// # Errors
/// [`ThreeMfError`] if the archive cannot be written.
pub fn three_mf(objects: &[Object<'_>], package: &Package) -> Result<Vec<u8>, ThreeMfError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // The epoch of the archive: with time stamps, every run would give other bytes.
    let options =
        SimpleFileOptions::default().last_modified_time(DateTime::default()).unix_permissions(0o644);
    let mut add = |name: &str, bytes: &[u8]| -> Result<(), ThreeMfError> {
        // Pictures are compressed already.
        let is_picture = name.ends_with(".png");
        let method = if is_picture { CompressionMethod::Stored } else { CompressionMethod::Deflated };
        archive.start_file(name, options.compression_method(method))?;
        archive.write_all(bytes).map_err(zip::result::ZipError::from)?;
        Ok(())
    };
    add("[Content_Types].xml", content_types(package).as_bytes())?;
    add("_rels/.rels", root_relationships(package).as_bytes())?;
    add("3D/3dmodel.model", model(objects, package).as_bytes())?;
    if !package.attachments.is_empty() {
        add("3D/_rels/3dmodel.model.rels", attachment_relationships(package).as_bytes())?;
    }
    if !package.thumbnail.is_empty() {
        add("Metadata/thumbnail.png", &package.thumbnail)?;
    }
    for (name, bytes) in &package.attachments {
        add(&format!("Metadata/{name}"), bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

const DECLARATION: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

fn content_types(package: &Package) -> String {
    let mut types = vec![
        ("rels", "application/vnd.openxmlformats-package.relationships+xml"),
        ("model", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
    ];
    if !package.thumbnail.is_empty() {
        types.push(("png", "image/png"));
    }
    for (extension, content) in [("csv", "text/csv"), ("svg", "image/svg+xml"), ("json", "application/json")]
    {
        if package.attachments.iter().any(|(name, _)| name.ends_with(&format!(".{extension}"))) {
            types.push((extension, content));
        }
    }
    let defaults = types.iter().fold(String::new(), |mut text, (extension, content)| {
        let _ = write!(text, r#"<Default Extension="{extension}" ContentType="{content}"/>"#);
        text
    });
    format!(
        r#"{DECLARATION}<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">{defaults}</Types>"#
    )
}

fn root_relationships(package: &Package) -> String {
    let thumbnail = if package.thumbnail.is_empty() {
        String::new()
    } else {
        format!(r#"<Relationship Id="thumbnail" Type="{THUMBNAIL_TYPE}" Target="/Metadata/thumbnail.png"/>"#)
    };
    format!(
        r#"{DECLARATION}<Relationships xmlns="{RELATIONSHIPS}"><Relationship Id="model" Type="{MODEL_TYPE}" Target="/3D/3dmodel.model"/>{thumbnail}</Relationships>"#
    )
}

fn attachment_relationships(package: &Package) -> String {
    let all = package.attachments.iter().enumerate().fold(String::new(), |mut text, (i, (name, _))| {
        let _ = write!(
            text,
            r#"<Relationship Id="attachment{i}" Type="{ATTACHMENT_TYPE}" Target="/Metadata/{}"/>"#,
            escaped(name)
        );
        text
    });
    format!(r#"{DECLARATION}<Relationships xmlns="{RELATIONSHIPS}">{all}</Relationships>"#)
}

fn model(objects: &[Object<'_>], package: &Package) -> String {
    let mut text =
        format!(r#"{DECLARATION}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}" xmlns:ps="{OWN}">"#);
    text.push('\n');
    let own = package.own_metadata.iter().map(|(name, value)| (format!("ps:{name}"), value));
    let core = package.metadata.iter().map(|(name, value)| ((*name).to_owned(), value));
    for (name, value) in core.chain(own) {
        let _ = writeln!(text, r#"<metadata name="{}">{}</metadata>"#, escaped(&name), escaped(value));
    }
    text.push_str("<resources>\n");
    let materials_id = objects.len() + 1;
    if !package.materials.is_empty() {
        let _ = writeln!(text, r#"<basematerials id="{materials_id}">"#);
        for BaseMaterial { name, colour: [red, green, blue] } in &package.materials {
            let name = escaped(name);
            let _ =
                writeln!(text, r##"<base name="{name}" displaycolor="#{red:02X}{green:02X}{blue:02X}"/>"##);
        }
        text.push_str("</basematerials>\n");
    }
    for (i, object) in objects.iter().enumerate() {
        let material = match object.material {
            known if known < package.materials.len() => format!(r#" pid="{materials_id}" pindex="{known}""#),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            r#"<object id="{}" type="model" name="{}" partnumber="{}"{material}><mesh><vertices>"#,
            i + 1,
            escaped(object.name),
            escaped(&object.part_number)
        );
        for p in &object.mesh.positions {
            // Single precision as in the STL, in the fewest digits that read back to the same
            // value.
            let _ =
                writeln!(text, r#"<vertex x="{}" y="{}" z="{}"/>"#, single(p.x), single(p.y), single(p.z));
        }
        text.push_str("</vertices><triangles>\n");
        for [a, b, c] in &object.mesh.triangles {
            let _ = writeln!(text, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#);
        }
        text.push_str("</triangles></mesh></object>\n");
    }
    text.push_str("</resources>\n<build>\n");
    for (i, Object { place, .. }) in objects.iter().enumerate() {
        // Rows are the images of x, y and z (core specification, 3.3).
        let turn = if place.is_turned { "0 1 0 -1 0 0 0 0 1" } else { "1 0 0 0 1 0 0 0 1" };
        // Adding zero turns -0 into +0.
        let at = place.shift.map(|v| v + 0.0);
        let _ =
            writeln!(text, r#"<item objectid="{}" transform="{turn} {} {} {}"/>"#, i + 1, at.x, at.y, at.z);
    }
    text.push_str("</build>\n</model>\n");
    text
}

/// A coordinate in single precision, with -0 as +0.
#[allow(clippy::cast_possible_truncation)]
fn single(value: f64) -> f32 {
    value as f32 + 0.0
}

/// Escapes `text` for an XML attribute or element.
fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() && c != '\n' && c != '\t' => {}
            c => out.push(c),
        }
        out
    })
}
