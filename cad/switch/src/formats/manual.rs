//! MANUAL.html and MANUAL.pdf: the guide with large pictures, each in one file.

mod html;
mod pdf;

use std::collections::BTreeMap;

use super::guide::document::{Block, PictureSource};
use super::guide::scenes::named_parts;
use super::guide::{PLATE_VIEW, document, step_picture, step_pictures};
use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::plates::plates;
use crate::prediction::Prediction;
use crate::scene::{Bodies, labelled_plate};

pub(super) const FORMAT: Format = Format {
    name: "manual",
    about: "MANUAL.html and MANUAL.pdf: the guide with large pictures, each in one file",
    // Its pictures take several times as long as all other files of a set.
    inclusion: Inclusion::Named,
    make,
};

/// Width and height of the pictures, pixels.
const PIXELS: (u32, u32) = (1600, 1100);

/// Pictures as PNG, by their file names in PRINTING.md.
type Pictures = BTreeMap<String, Vec<u8>>;

fn make(built: &Built, prediction: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    manual(built, prediction, manifest, PIXELS)
}

/// Makes both files with pictures of this width and height.
fn manual(
    built: &Built,
    prediction: &Prediction,
    manifest: &Manifest,
    pixels: (u32, u32),
) -> Result<Vec<OutputFile>, SetError> {
    let plates = plates(built);
    let bodies = Bodies::new(built);
    let document = document(built, prediction, manifest, &plates, &bodies);
    let mut pictures: Pictures =
        step_pictures(&document, &bodies, pixels)?.into_iter().map(|file| (file.name, file.bytes)).collect();
    for block in &document.blocks {
        let Block::Picture { file, source, .. } = block else { continue };
        let picture = match source {
            PictureSource::Exploded => named_parts(&bodies).draw(&bodies, pixels.0, pixels.1),
            PictureSource::Plate(index) => {
                let Some(shown) = plates.get(*index) else { continue };
                labelled_plate(shown, PLATE_VIEW, pixels)
            }
        };
        pictures.insert(file.clone(), picture.indexed_png().map_err(SetError::encoding)?);
    }
    Ok(vec![
        OutputFile::new("MANUAL.html", html::html(&document, &pictures)),
        OutputFile::new("MANUAL.pdf", pdf::pdf(&document, &pictures)),
    ])
}

/// The picture of a step, by its number in the document.
fn of_step(pictures: &Pictures, number: usize) -> Option<(String, &Vec<u8>)> {
    let name = step_picture(number);
    pictures.get(&name).map(|png| (name, png))
}

#[cfg(test)]
mod tests;
