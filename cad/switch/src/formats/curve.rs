//! friction.csv and friction.svg: the predicted curve, in every set.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::design::Design;
use crate::documents::{Manifest, friction_csv};
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_report::friction_svg;

pub(super) const FORMAT: Format = Format {
    name: "curve",
    about: "friction.csv and friction.svg: the predicted curve",
    inclusion: Inclusion::Always,
    make,
};

fn make(built: &Built, prediction: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    curve_files(built.design(), prediction, true)
}

/// Returns the curve of a design as a table and, with `plot`, as a figure.
///
/// # Errors
/// [`SetError::Plot`] if the plot cannot be drawn.
pub fn curve_files(
    design: &Design,
    prediction: &Prediction,
    plot: bool,
) -> Result<Vec<OutputFile>, SetError> {
    let mut files = vec![OutputFile::new("friction.csv", friction_csv(&prediction.curve))];
    if plot {
        let name = &design.configuration().switch.name;
        let svg = friction_svg(name, design.contact(), &prediction.curve, &prediction.others)?;
        files.push(OutputFile::new("friction.svg", svg));
    }
    Ok(files)
}
