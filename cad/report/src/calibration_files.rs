//! The files of a calibration.

use pinswitch_calibration::effects::own_effects_text;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{Calibration, ModelFile};
use pinswitch_diagnostic::{Diagnostic, codes};

use crate::{page, plots};

/// File of a form that was fitted to unattributed structure.
pub const FORM_FILE: &str = "discovered.toml";
/// Begin of that file, by which a later run recognises it.
pub const FORM_HEADER: &str =
    "# Fitted by `pinswitch calibrate`, not confirmed. Test it on other data; to rename the effect, edit a copy.
#   pinswitch calibrate next.csv --effects discovered.toml --out DIR
";
/// Digits after the decimal point of a residual in newtons.
const DECIMALS: usize = 5;

/// Returns the files of a calibration with their names, except `report.json`: the formula of unattributed structure, if
/// there is one, the page, the residuals of each row, both models and the plots. `title` is the title of the page.
///
/// # Errors
/// A [`Diagnostic`] if a plot cannot be drawn, or a model cannot be written as TOML.
pub fn calibration_files(
    title: &str,
    table: &PlateauTable,
    calibration: &Calibration,
) -> Result<Vec<(String, Vec<u8>)>, Diagnostic> {
    let Calibration { evidence, baseline, augmented, .. } = calibration;
    let plots = plots(calibration).map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
    let html = page(title, calibration, &plots);
    let residual = |predicted: &[f64]| -> Vec<f64> {
        table.rows.iter().zip(predicted).map(|(row, predicted)| row.force_n - predicted).collect()
    };
    let residuals = table.with_columns(
        &["baseline_N", "residual_baseline_N", "model_N", "residual_model_N", "weight"],
        &[
            baseline.predicted_n.clone(),
            residual(&baseline.predicted_n),
            augmented.predicted_n.clone(),
            residual(&augmented.predicted_n),
            evidence.weights(),
        ],
        DECIMALS,
    );
    let form = calibration.form.as_ref().map(|form| {
        let text = format!("{FORM_HEADER}{}", own_effects_text([&form.definition]));
        (FORM_FILE.to_owned(), text.into_bytes())
    });
    let mut files: Vec<_> = form.into_iter().collect();
    files.extend([
        ("report.html".to_owned(), html.into_bytes()),
        ("residuals.csv".to_owned(), residuals.into_bytes()),
        ("baseline.toml".to_owned(), ModelFile::new(baseline).to_text()?.into_bytes()),
        ("model.toml".to_owned(), ModelFile::new(augmented).to_text()?.into_bytes()),
    ]);
    files.extend(plots.into_iter().map(|plot| (plot.file, plot.svg.into_bytes())));
    Ok(files)
}
