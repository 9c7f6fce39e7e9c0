//! PRINTING.md: how to print, cast, assemble, check and use a set, with its dimensions.

mod assemble;
mod cast;
mod check;
mod cover;
mod cure;
pub(super) mod document;
pub(super) mod figure;
mod fit;
mod footing;
pub(super) mod inline;
mod markdown;
mod print;
pub(super) mod scenes;
mod shopping;
mod usage;

use self::document::{Block, Document, number};
use super::{Format, Inclusion};
use crate::built::Built;
use crate::design::Design;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parallel::map_each;
use crate::parts::touches;
use crate::plates::{Plate, plates};
use crate::prediction::Prediction;
use crate::scene::{Bodies, exploded_png, labelled_plate};
use pinswitch_friction::Substrate;
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format =
    Format { name: "guide", about: "PRINTING.md with pictures", inclusion: Inclusion::Default, make };

/// Width and height of the picture of a plate, pixels.
const PLATE_PIXELS: (u32, u32) = (900, 675);
/// Width and height of the picture of a step, pixels.
const STEP_PIXELS: (u32, u32) = (420, 290);
/// Direction of the camera above a plate.
pub(super) const PLATE_VIEW: View = View { turn_deg: 0.0, rise_deg: 72.0 };

fn make(built: &Built, prediction: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let plates = plates(built);
    let bodies = Bodies::new(built);
    let mut document = document(built, prediction, manifest, &plates, &bodies);
    document.blocks.push(Block::Paragraph(
        "`pinswitch generate` with `--format manual` writes this guide as `MANUAL.html` and `MANUAL.pdf`, with large pictures."
            .to_owned(),
    ));
    let mut files = vec![OutputFile::new("assembly.png", exploded_png(built)?)];
    for p in &plates {
        files.push(OutputFile::new(
            p.picture(),
            labelled_plate(p, PLATE_VIEW, PLATE_PIXELS).indexed_png().map_err(SetError::encoding)?,
        ));
    }
    files.extend(step_pictures(&document, &bodies, STEP_PIXELS)?);
    files.push(OutputFile::new("PRINTING.md", markdown::markdown(&document)));
    Ok(files)
}

/// The name of the picture of a step, numbered from 1.
pub(super) fn step_picture(number: usize) -> String {
    format!("step-{number}.png")
}

/// Draws the pictures of all steps, in their order.
///
/// # Errors
/// [`SetError::Encoding`] if a picture cannot be encoded.
pub(super) fn step_pictures(
    document: &Document,
    bodies: &Bodies,
    (width, height): (u32, u32),
) -> Result<Vec<OutputFile>, SetError> {
    let pictures = document.steps().filter_map(|step| step.picture.as_ref()).collect();
    map_each(pictures, |(number, picture): &(usize, _)| {
        let png = picture.draw(bodies, width, height).indexed_png().map_err(SetError::encoding)?;
        Ok(OutputFile::new(step_picture(*number), png))
    })
    .into_iter()
    .collect()
}

/// Returns the document of a set.
pub(super) fn document(
    built: &Built,
    prediction: &Prediction,
    manifest: &Manifest,
    plates: &[Plate<'_>],
    bodies: &Bodies,
) -> Document {
    let design = built.design();
    let mut blocks = cover::cover(design, prediction, manifest);
    blocks.extend(number(vec![
        ("Parts and tools", shopping::shopping(design, manifest)),
        ("Print", print::print(built, manifest, plates)),
        ("Cast the silicone", cast::cast(design, manifest, bodies)),
        ("Fit the pins", fit::fit(design, manifest, bodies)),
        ("Assemble", assemble::assemble(built, manifest, bodies)),
        ("Check", check::check(design, manifest)),
        ("Use", usage::usage(design, prediction, manifest, bodies)),
    ]));
    Document { title: format!("How to make {}", manifest.name), blocks }
}

/// The contact of the unloaded tendon with silicone or proxy.
fn bed_contact(design: &Design) -> String {
    let c = design.configuration();
    let bed = if c.layout.substrate == Substrate::Silicone { "silicone" } else { "proxy" };
    let places: Vec<String> = touches(design)
        .iter()
        .filter(|t| t.pin.is_none())
        .map(|t| format!("{:.1} to {:.1} deg", t.from_rad.to_degrees(), t.to_rad.to_degrees()))
        .collect();
    if places.is_empty() && design.contact().pins().count() > 0 {
        return format!(" A limp tendon touches only its pins; load presses it onto the {bed} between them.");
    }
    let radius = design.tendon_axis_radius_mm() - design.tendon_diameter_mm() / 2.0;
    if design.contact().pins().count() == 0 {
        return format!(
            " It touches the {bed} over the full wrap, {:.1} mm.",
            2.0 * design.half_wrap_rad() * radius
        );
    }
    let length: f64 =
        touches(design).iter().filter(|t| t.pin.is_none()).map(|t| (t.to_rad - t.from_rad) * radius).sum();
    format!(
        " A limp tendon also touches the {bed} at {} from the middle of the wrap, {length:.1} mm in total. Its bending stiffness lifts it at light loads; higher \
         loads increase the contact.",
        places.join(" and ")
    )
}

/// The support of the tendon: the pins, if there is one within the wrap.
fn carried_by(design: &Design) -> &'static str {
    match (design.contact().pins().count() > 0, design.configuration().layout.substrate) {
        (true, _) => "pins",
        (false, Substrate::Silicone) => "silicone layer",
        (false, Substrate::Abs) => "proxy",
    }
}

/// `groove 5`, `grooves 5, 8 and 11`.
fn groove_list(grooves: &[usize]) -> String {
    let words: Vec<String> = grooves.iter().map(ToString::to_string).collect();
    match words.as_slice() {
        [.., last] if words.len() > 1 => {
            format!("grooves {} and {last}", words[..words.len() - 1].join(", "))
        }
        _ => format!("groove {}", words.join("")),
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod text_tests;
