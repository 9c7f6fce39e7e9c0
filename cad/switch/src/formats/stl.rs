//! One binary STL per printed part, in print orientation.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parallel::map_each;
use crate::prediction::Prediction;

pub(super) const FORMAT: Format =
    Format { name: "stl", about: "One binary STL per part", inclusion: Inclusion::Default, make };

fn make(built: &Built, _: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    map_each(built.printed().iter().collect(), |part| {
        let bytes = part.stl().map_err(SetError::encoding)?;
        Ok(OutputFile::new(format!("{}.stl", part.part().name), bytes))
    })
    .into_iter()
    .collect()
}
