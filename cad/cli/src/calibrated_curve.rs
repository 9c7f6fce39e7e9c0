//! Curves of calibrated models.

use std::path::Path;

use pinswitch_calibration::ModelFile;
use pinswitch_friction::FrictionCurve;
use pinswitch_switch::design::Design;

use super::Failure;
use super::input::read_text_file;

/// Reads a model.toml or baseline.toml that `calibrate` wrote; also returns its name for errors.
///
/// # Errors
/// [`Failure::bad_input`] with the file and its first error.
pub(super) fn read_model(path: &Path) -> Result<(ModelFile, String), Failure> {
    let name = path.display().to_string();
    let text = read_text_file(path)?;
    let model = ModelFile::parse(&text, &name).map_err(Failure::bad_input)?;
    Ok((model, name))
}

/// Predicts the curve of `design` with the model of a file.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be used, or if the design differs from the rig in a way that the model does
/// not cover.
pub(super) fn calibrated_curve(design: &Design, model: &Path) -> Result<FrictionCurve, Failure> {
    let (model, name) = read_model(model)?;
    pinswitch_app::calibrated_curve(design, &model, &name).map_err(Failure::bad_input)
}
