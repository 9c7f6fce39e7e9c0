//! The files of a set beside its STL: 3MF, STEP, drawings, guide and page, all from the same parts and curve.

use serde::Serialize;

use super::guide::printing_guide;
use super::set::{OutputFile, Set, SetError, make_set_with};
use super::{friction_csv, manifest::with_files};
use crate::config::to_toml;
use crate::design::Design;
use crate::formats::{
    Object, Package, Placement, StepPart, drawing_svg, dxf, step_assembly, step_part, three_mf,
};
use crate::page::page_html;
use crate::parts::{Part, printed, reference_bodies};
use crate::render::{View, render};
use crate::scene::{SceneError, assembled, plate};
use pinswitch_model::FrictionCurve;

/// A kind of file that a set may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// One binary STL per part.
    Stl,
    /// assembly.3mf: all printed parts on one plate.
    ThreeMf,
    /// One exact solid per part, and the assembly.
    Step,
    /// drawing.svg: a dimensioned sheet.
    Drawing,
    /// The profiles of each printed part.
    Dxf,
    /// PRINTING.md with its pictures.
    Guide,
    /// report.html.
    Page,
}

/// Pixels of the pictures of the guide, across.
const PICTURE_WIDTH: u32 = 900;
/// Pixels of the thumbnail, along each side.
const THUMBNAIL: u32 = 256;

/// Makes the files of `design` in these formats, with curve and manifest.
///
/// # Errors
/// [`SetError`]; nothing is handed out if one of them cannot be made.
pub fn make_set_in(design: &Design, curve: &FrictionCurve, formats: &[Format]) -> Result<Set, SetError> {
    let mut set = make_set_with(design, curve)?;
    set.files.retain(|f| f.name != "manifest.json");
    if !formats.contains(&Format::Stl) {
        set.files.retain(|f| !f.name.ends_with(".stl"));
    }
    let parts = printed(design)?;
    let wants = |format| formats.contains(&format);
    let mut add = |name: String, bytes: Vec<u8>| set.files.push(OutputFile { name, bytes });
    if wants(Format::ThreeMf) {
        add("assembly.3mf".to_owned(), package(design, &parts, curve)?);
    }
    if wants(Format::Step) {
        for file in steps(design, &parts)? {
            add(file.name, file.bytes);
        }
    }
    if wants(Format::Drawing) {
        let title = format!("{}, made by pinswitch {}", set.manifest.name, env!("CARGO_PKG_VERSION"));
        add("drawing.svg".to_owned(), drawing_svg(&title, &parts).into_bytes());
    }
    if wants(Format::Dxf) {
        for part in &parts {
            add(format!("{}.dxf", part.name), dxf(&part.solid).into_bytes());
        }
    }
    if wants(Format::Guide) {
        let view = View { turn_deg: 30.0, rise_deg: 40.0 };
        add("assembly.png".to_owned(), picture(&assembled(design, 1.0)?, view, PICTURE_WIDTH, 3, 4)?);
        let above = View { turn_deg: 0.0, rise_deg: 55.0 };
        add("plate.png".to_owned(), picture(&plate(design)?, above, PICTURE_WIDTH, 3, 4)?);
        add("PRINTING.md".to_owned(), printing_guide(design, &set.manifest, true).into_bytes());
    }
    // The page carries the manifest as it stands before the page itself is listed.
    with_files(&mut set.manifest, &set.files);
    if wants(Format::Page) {
        let page =
            page_html(design, &set.manifest, curve, None).map_err(|e| SetError::Encoding(e.to_string()))?;
        set.files.push(OutputFile { name: "report.html".to_owned(), bytes: page.into_bytes() });
        with_files(&mut set.manifest, &set.files);
    }
    let mut bytes =
        serde_json::to_vec_pretty(&set.manifest).map_err(|e| SetError::Encoding(e.to_string()))?;
    bytes.push(b'\n');
    set.files.push(OutputFile { name: "manifest.json".to_owned(), bytes });
    Ok(set)
}

impl From<SceneError> for SetError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Configuration(e) => Self::Configuration(e),
            SceneError::Cap { part, source } => Self::Cap { part, source },
        }
    }
}

fn picture(
    bodies: &[crate::render::Body],
    view: View,
    width: u32,
    up: u32,
    across: u32,
) -> Result<Vec<u8>, SetError> {
    render(bodies, view, width, width * up / across).png().map_err(|e| SetError::Encoding(e.to_string()))
}

fn package(design: &Design, parts: &[Part], curve: &FrictionCurve) -> Result<Vec<u8>, SetError> {
    let name = &design.configuration().switch.name;
    let objects = parts
        .iter()
        .map(|part| {
            let mesh = part
                .print_mesh(design)
                .map_err(|source| SetError::Cap { part: part.name.clone(), source })?;
            Ok(Object { name: part.name.clone(), part_number: format!("{name}/{}", part.name), mesh })
        })
        .collect::<Result<Vec<_>, SetError>>()?;
    let above = View { turn_deg: 20.0, rise_deg: 50.0 };
    let package = Package {
        metadata: vec![
            ("Title", format!("{name}: friction switch")),
            ("Designer", "pinswitch".to_owned()),
            (
                "Description",
                format!(
                    "Printed parts of a friction switch, pins in grooves {:?}",
                    design.configuration().layout.pins
                ),
            ),
            ("LicenseTerms", "The program is MIT licensed; what it makes is yours.".to_owned()),
            ("Application", concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned()),
        ],
        own_metadata: vec![("layout", design.label()), ("configuration", to_toml(design.configuration()))],
        thumbnail: picture(&plate(design)?, above, THUMBNAIL, 1, 1)?,
        attachments: vec![("friction.csv".to_owned(), friction_csv(curve).into_bytes())],
    };
    three_mf(&objects, &package).map_err(|e| SetError::Encoding(e.to_string()))
}

fn steps(design: &Design, parts: &[Part]) -> Result<Vec<OutputFile>, SetError> {
    let reference = reference_bodies(design)?;
    let step = |part: &Part| OutputFile {
        name: format!("{}.step", part.name),
        bytes: step_part(StepPart { name: &part.name, solid: &part.solid }).into_bytes(),
    };
    let mut files: Vec<OutputFile> = parts.iter().map(step).collect();
    // As in every picture: the proxy stands in for the silicone only where there is none.
    let rigid = reference.iter().all(|b| b.name != "silicone-layer");
    let placed: Vec<(StepPart<'_>, Placement)> = parts
        .iter()
        .filter(|p| rigid || p.name != "proxy")
        .chain(&reference)
        .filter_map(|part| {
            let pose = part.pose?;
            let placement = Placement { flipped: pose.flipped, z_mm: pose.z_mm };
            Some((StepPart { name: &part.name, solid: &part.solid }, placement))
        })
        .collect();
    let assembly = step_assembly(&design.configuration().switch.name, &placed);
    files.push(OutputFile { name: "assembly.step".to_owned(), bytes: assembly.into_bytes() });
    Ok(files)
}
