//! `--slice`: which slicer there is, and what it says of a set.

use super::Failure;
use pinswitch_slicer::{
    PROGRAM_VARIABLE, PrintSettings, SETTINGS_FILE, SLICING_FILE, Slicer, SlicerError, Slicing, find,
};
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::named;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;

/// The slicer of this machine. Where there is none, a warning says what to install, and the work goes on without.
pub(super) fn installed() -> Result<Option<Slicer>, Failure> {
    let variable = |name: &str| std::env::var_os(name);
    let found = find(variable(PROGRAM_VARIABLE).as_deref(), variable("PATH").as_deref());
    let found = found.map_err(failure)?;
    if found.is_none() {
        log::warn!(
            "no slicer is installed, so nothing says how long it prints: install PrusaSlicer (Debian, Ubuntu: apt-get install \
             prusa-slicer; others: https://www.prusa3d.com/prusaslicer) so that `prusa-slicer` is on PATH, or set \
             {PROGRAM_VARIABLE} to its program; everything else is made"
        );
    }
    Ok(found)
}

pub(super) fn failure(error: SlicerError) -> Failure {
    if error.is_bad_input() { Failure::bad_input(error) } else { Failure::failed(error) }
}

/// What a slicer says of a set, and the files to keep of it.
pub(super) fn slicing(
    slicer: Slicer,
    built: &Built,
    prediction: &Prediction,
) -> Result<(Slicing, Vec<OutputFile>), Failure> {
    // Parts and plates are sliced whichever formats are kept.
    let printable = named(&["stl", "3mf"]).map_err(Failure::failed)?;
    let printable = Set::new(built, prediction, &printable).map_err(Failure::failed)?;
    let settings = PrintSettings::from_configuration(built.design().configuration());
    let slicer = slicer.prepared(&settings).map_err(failure)?;
    let begun = |file: &str| log::info!("slicing {file}");
    let slicing = Slicing::new(&slicer, settings, &printable.files, begun).map_err(failure)?;
    let mut json = serde_json::to_vec_pretty(&slicing).map_err(Failure::failed)?;
    json.push(b'\n');
    let files = vec![
        OutputFile::new(SLICING_FILE, json),
        OutputFile::new(SETTINGS_FILE, slicer.settings_text().as_bytes()),
    ];
    Ok((slicing, files))
}
