//! `--slice`: print times and filament of a set, from an installed slicer.

use pinswitch_diagnostic::Diagnostic;
use pinswitch_slicer::{
    PROGRAM_VARIABLE, PrintSettings, SETTINGS_FILE, SLICING_FILE, Slicer, SlicerError, Slicing, find,
};
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::named;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;

use super::Failure;
use super::terminal::{to_json, warn};

/// Finds the slicer of this machine. Without one, warns with what to install and returns `None`.
///
/// # Errors
/// [`Failure`] if the slicer that the environment names cannot be used.
pub(super) fn installed() -> Result<Option<Slicer>, Failure> {
    let variable = |name: &str| std::env::var_os(name);
    let slicer = find(variable(PROGRAM_VARIABLE).as_deref(), variable("PATH").as_deref()).map_err(failure)?;
    if slicer.is_none() {
        warn(
            Diagnostic::new("no slicer is installed: print times are left out, everything else is made").with_help(
                format!(
                    "install PrusaSlicer (Debian, Ubuntu: apt-get install prusa-slicer; others: \
                     https://www.prusa3d.com/prusaslicer) so that `prusa-slicer` is on PATH, or set {PROGRAM_VARIABLE} \
                     to its program"
                ),
            ),
        );
    }
    Ok(slicer)
}

/// Returns the failure of a slicer's error, with its exit code.
pub(super) fn failure(error: SlicerError) -> Failure {
    let is_bad_input = error.is_bad_input();
    let diagnostic = Diagnostic::from(error);
    if is_bad_input { Failure::bad_input(diagnostic) } else { Failure::failed(diagnostic) }
}

/// Slices every part and plate of a set; returns the results and the files to add to the set.
///
/// # Errors
/// [`Failure`] if the set cannot be made, or the slicer fails.
pub(super) fn slicing(
    slicer: Slicer,
    built: &Built,
    prediction: &Prediction,
) -> Result<(Slicing, Vec<OutputFile>), Failure> {
    // Parts and plates are sliced, whichever formats are written.
    let printable = named(&["stl", "3mf"]).map_err(Failure::failed)?;
    let printable = Set::new(built, prediction, &printable).map_err(Failure::failed)?;
    let settings = PrintSettings::from_configuration(built.design().configuration());
    let slicer = slicer.prepared(&settings).map_err(failure)?;
    let log_file = |file: &str| log::info!("slicing {file}");
    let slicing = Slicing::new(&slicer, settings, &printable.files, log_file).map_err(failure)?;
    let files = vec![
        OutputFile::new(SLICING_FILE, to_json(&slicing)?),
        OutputFile::new(SETTINGS_FILE, slicer.settings_text().as_bytes()),
    ];
    Ok((slicing, files))
}
