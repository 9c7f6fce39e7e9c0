//! The curve of a design by the file of a calibrated model.

use std::path::Path;

use pinswitch_calibration::ModelFile;
use pinswitch_friction::FrictionCurve;
use pinswitch_switch::design::Design;

use super::Failure;

/// The curve of `design` by the model of that file.
///
/// # Errors
/// [`Failure::BadInput`] names the file and its fault, or what of the design the rig does not have.
pub(super) fn calibrated_curve(design: &Design, model: &Path) -> Result<FrictionCurve, Failure> {
    let name = model.display().to_string();
    let text = crate::input::read_text_file(model)?;
    let file = ModelFile::parse(&text, &name).map_err(Failure::bad_input)?;
    pinswitch_app::calibrated_curve(design, &file, &name).map_err(Failure::bad_input)
}
