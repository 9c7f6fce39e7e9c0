//! `--slice`: print times and filament of a set, from an installed slicer.

use std::time::Duration;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_slicer::{
    LIMIT_VARIABLE, PROGRAM_VARIABLE, PrintSettings, RunLimits, SETTINGS_FILE, SLICING_FILE, Slicer,
    SlicerError, Slicing, find,
};
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::named;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;

use super::Failure;
use super::terminal::{to_json, warn};

/// Range of [`LIMIT_VARIABLE`].
const MIN_LIMIT_S: f64 = 0.1;
const MAX_LIMIT_S: f64 = 86_400.0;

/// Finds the slicer of this machine. Without one, warns with what to install and returns `None`.
///
/// # Errors
/// [`Failure`] if the slicer that the environment names cannot be used.
pub(super) fn installed() -> Result<Option<Slicer>, Failure> {
    let variable = |name: &str| std::env::var_os(name);
    let slicer = find(variable(PROGRAM_VARIABLE).as_deref(), variable("PATH").as_deref()).map_err(failure)?;
    if slicer.is_none() {
        warn(
            Diagnostic::new(codes::SLICER_NOT_FOUND, "no slicer is installed: print times are left out, everything else is made").with_help(
                format!(
                    "install PrusaSlicer (Debian, Ubuntu: apt-get install prusa-slicer; others: \
                     https://www.prusa3d.com/prusaslicer) so that `prusa-slicer` is on PATH, or set {PROGRAM_VARIABLE} \
                     to its program"
                ),
            ),
        );
    }
    let seconds = variable(LIMIT_VARIABLE).map(|text| limit(&text.to_string_lossy())).transpose()?;
    Ok(slicer.map(|slicer| {
        let limits = RunLimits::default();
        let slicer = slicer.with_limits(RunLimits { time: seconds.unwrap_or(limits.time), ..limits });
        // Without its own path, this program cannot end the slicer when it is killed.
        match std::env::current_exe() {
            Ok(program) => {
                slicer.with_supervisor(vec![program, "--quiet".into(), "supervise".into(), "--".into()])
            }
            Err(_) => slicer,
        }
    }))
}

/// Returns the time of [`LIMIT_VARIABLE`].
fn limit(text: &str) -> Result<Duration, Failure> {
    let seconds = text.trim().parse().ok().filter(|s| (MIN_LIMIT_S..=MAX_LIMIT_S).contains(s));
    let seconds = seconds.ok_or_else(|| {
        Failure::bad_input(
            Diagnostic::new(codes::OUT_OF_RANGE, "not a time for slicing a file")
                .with_location(Location::field(LIMIT_VARIABLE, text))
                .with_help(format!("give a number of seconds from {MIN_LIMIT_S} to {MAX_LIMIT_S}")),
        )
    })?;
    Ok(Duration::from_secs_f64(seconds))
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
