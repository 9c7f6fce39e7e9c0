//! DXF: the profiles of each printed part.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_solid::files::dxf;

pub(super) const FORMAT: Format = Format {
    name: "dxf",
    about: "Profiles of the printed parts, for CAD and laser cutters",
    inclusion: Inclusion::Named,
    make,
};

fn make(built: &Built, _: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let file = |part: &crate::parts::Part| OutputFile::new(format!("{}.dxf", part.name), dxf(&part.solid));
    Ok(built.printed().iter().map(|p| file(p.part())).collect())
}
