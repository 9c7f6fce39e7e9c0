//! The drawing: one sheet of the assembly and one for each part, as SVG, PDF and DXF (cad/doc/drawing.md).
//!
//! `pinswitch_drafting` draws parts and knows paper. This module knows a switch: its parts with their names, fits and notes,
//! its bought hardware, and its assembly.

mod assembly_hardware;
mod assembly_pictures;
mod assembly_sheet;
mod fits;
mod part_sheet;
mod parts_list;
mod words;

use super::{Format, Inclusion};
use crate::built::Built;
use crate::config::{self, Configuration};
use crate::documents::{Manifest, layout_text};
use crate::output::{OutputFile, SetError};
use crate::parts::{Part, Role};
use crate::prediction::Prediction;
use part_sheet::part_sheet;
use parts_list::{designation, part_number};
use pinswitch_drafting::{Paper, Projection, Sheet, TitleBlock, drawing_dxf, drawing_pdf, drawing_svg};
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::solid::Solid;

pub(super) const FORMAT: Format = Format {
    name: "drawing",
    about: "drawing.svg, .pdf and .dxf: dimensioned sheets of the assembly and of every part",
    inclusion: Inclusion::Default,
    make,
};

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let sheets = sheets(built);
    let title = format!("{}, made by {}", manifest.name, manifest.generator);
    Ok(vec![
        OutputFile::new("drawing.svg", drawing_svg(&sheets, &title)),
        OutputFile::new("drawing.pdf", drawing_pdf(&sheets, &title)),
        OutputFile::new("drawing.dxf", drawing_dxf(&sheets)),
    ])
}

/// Returns all sheets of a set: the assembly, the printed parts, the layer and a pin.
///
/// ```
/// use pinswitch_switch::{built::Built, config::Configuration, design::Design, formats::drawing::sheets};
///
/// let sheets = sheets(&Built::new(Design::new(Configuration::default())?)?);
/// assert_eq!(sheets[0].name, "assembly");
/// assert!(sheets.iter().all(|s| pinswitch_drafting::collisions(s).is_empty()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn sheets(built: &Built) -> Vec<Sheet> {
    let c = built.design().configuration();
    let paper = match c.drawing.paper {
        config::Paper::A4 => Paper::A4,
        config::Paper::A3 => Paper::A3,
    };
    let pin = single_pin(built);
    let printed = built.printed().iter().map(|p| p.part());
    let layer = built.reference().iter().map(|b| &b.part).filter(|p| p.role == Role::Layer);
    let parts: Vec<&Part> = printed.chain(layer).chain(&pin).collect();
    let number_of_sheets = parts.len() + 1;
    let mut all = Vec::with_capacity(number_of_sheets);
    let title = |number: usize, name: &str, material: String| {
        title_block(built, c, (number, number_of_sheets), name, material)
    };
    let first = TitleBlock {
        document_type: "Assembly drawing".to_owned(),
        general_tolerance: "see the sheets of the parts".to_owned(),
        ..title(1, "assembly", "see parts list".to_owned())
    };
    all.extend(assembly_sheet::assembly_sheet(built, first, paper));
    for (i, part) in parts.iter().enumerate() {
        let material = part.material();
        let name = words::material(built.design(), material);
        let block = TitleBlock {
            general_tolerance: words::general_tolerance(material),
            surface_texture: words::surface_texture(part).to_owned(),
            ..title(i + 2, &part.name, name)
        };
        all.extend(part_sheet(built.design(), part, &block, paper));
    }
    all
}

fn title_block(
    built: &Built,
    c: &Configuration,
    sheet: (usize, usize),
    name: &str,
    material: String,
) -> TitleBlock {
    TitleBlock {
        product: ("Switch".to_owned(), c.switch.name.to_string()),
        variant: ("Layout".to_owned(), layout_text(c)),
        title: designation(name),
        part_number: part_number(built, name),
        material,
        status: "Not approved".to_owned(),
        revision: "A".to_owned(),
        projection: match c.drawing.projection {
            config::Projection::First => Projection::First,
            config::Projection::Third => Projection::Third,
        },
        date: (!c.drawing.date.is_empty()).then(|| c.drawing.date.clone()),
        sheet,
        generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
        ..TitleBlock::default()
    }
}

/// A pin about its own axis. All pins are equal.
fn single_pin(built: &Built) -> Option<Part> {
    let pin = &built.reference().iter().find(|b| matches!(b.part.role, Role::Pin { .. }))?.part;
    let radius_mm = built.design().configuration().pins.diameter_mm / 2.0;
    let outline = Contour::circle(Point2::origin(), radius_mm);
    let solid = Solid::prism(&outline, &[], 0.0, built.design().pin_length_mm(), 0.0).ok()?;
    let mut single = pin.with_solid(solid);
    single.name = "pin".to_owned();
    single.pose = None;
    Some(single)
}

#[cfg(test)]
mod tests;
