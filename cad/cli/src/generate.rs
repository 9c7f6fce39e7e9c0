//! `pinswitch generate CONFIG`.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use pinswitch_diagnostic::{Diagnostic, Location, codes};

use super::as_measured::{self, AsMeasured};
use super::calibrated_curve::calibrated_curve;
use super::law::LawChoice;
use super::second_kernel::requested_kernel;
use super::slicing;
use super::source::{Fix, LoadedDesign, Source};
use super::terminal::{escaped_json, warn};
use super::{Failure, print_data, print_text};
use crate::input::sha256_read;
use crate::write::{PublishError, SetFolder};
use pinswitch_switch::feasibility;
use pinswitch_switch::formats::{ALL, FORMATS, Inclusion, default_names, named};
use pinswitch_switch::output::{BuildError, OutputFile};
use pinswitch_switch::prediction::Prediction;
use pinswitch_switch::set::Set;

/// Make the printable parts of a configuration, with their predicted friction curve.
///
/// Writes one folder: the parts as binary STL (millimetres, print orientation) and on one plate as 3MF, friction.csv and
/// friction.svg (the predicted curve with its band), a drawing for a workshop (drawing.svg, drawing.pdf, drawing.dxf),
/// PRINTING.md with pictures, report.html (open it in a browser), and manifest.json (every parameter, derived dimension,
/// volume, hash, and the bill of materials). If a part or a file cannot be made, nothing is written. The set appears
/// whole: its manifest comes last. Files that only the previous set contained are removed unless you edited them; other
/// files are never changed.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch generate three-double
  pinswitch generate my-switch.toml --out parts --preset printer-fff-0.4
  pinswitch generate three-double --format stl,step
  pinswitch generate three-double --slice
  pinswitch generate three-double --verify
  pinswitch generate my-switch.toml --measured measured.toml
  pinswitch generate three-double --set layout.pins=[4,8,12] --set support.slots=occupied")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Folder to write into [default: out/NAME].
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A model.toml written by `calibrate`: the curve comes from it, without the effects of the rig.
    #[arg(long, value_name = "TOML", conflicts_with = "law")]
    model: Option<PathBuf>,
    #[command(flatten)]
    measured: AsMeasured,
    /// Kinds of files to write, in addition to the curve and the manifest.
    #[arg(long, value_parser = formats(), value_name = "FORMAT", value_delimiter = ',', default_values = default_names())]
    format: Vec<String>,
    #[command(flatten)]
    law: LawChoice,
    /// Estimate print time and filament of each part and plate with an installed PrusaSlicer (`prusa-slicer` on PATH, or
    /// PINSWITCH_SLICER): a table here, slicing.json and settings.ini in the set.
    #[arg(long)]
    slice: bool,
    /// Verify every mesh with a second geometry kernel, truck-modeling: volume, surface, bounding box and distances must agree
    /// within what the chord tolerance allows. The manifest records the differences; a larger one is an error.
    #[arg(long)]
    verify: bool,
    /// If the configuration cannot be built, make the set of the nearest one that can: print every change with its reason, and
    /// write the fixed configuration to fixed.toml in the set.
    #[arg(long)]
    fix: bool,
    /// Replace a set that was made from another configuration, and files that do not belong to a set.
    #[arg(long)]
    force: bool,
    /// Print the manifest as JSON.
    #[arg(long)]
    json: bool,
}

/// The formats by name, from their registry.
fn formats() -> PossibleValuesParser {
    let all = PossibleValue::new(ALL).help("Everything");
    let by_name = FORMATS.iter().filter(|f| f.inclusion != Inclusion::Always);
    let values: Vec<_> = by_name.map(|f| PossibleValue::new(f.name).help(f.about)).chain([all]).collect();
    PossibleValuesParser::new(values)
}

/// Name of the file with a fixed configuration.
const FIXED: &str = "fixed.toml";

fn refused(error: PublishError) -> Failure {
    match error {
        PublishError::Write(e) => e.into(),
        other => Failure::bad_input(other),
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kernel = requested_kernel(arguments.verify)?;
    let slicer = if arguments.slice { slicing::installed()? } else { None };
    let (LoadedDesign { design, origin, law }, fix) = if arguments.fix {
        let (design, fix) = arguments.source.load_fixed()?;
        (design, Some(fix))
    } else {
        (arguments.source.load()?, None)
    };
    let made = arguments.measured.of(&design)?;
    let prediction = match &arguments.model {
        _ if made.is_some() => Prediction::of(made.as_ref().map_or(&design, |(made, _)| made)),
        Some(model) => Prediction::with_curve(&design, calibrated_curve(&design, model)?),
        None => arguments.law.or_of_set(law.as_deref()).prediction(&design)?,
    };
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(&design.configuration().switch.name));
    // Claimed before the work: of two runs at once, one is told so at once.
    let place = SetFolder::lock(&folder)?;
    let origin = origin.entry(&folder);
    if !arguments.force {
        place.check_source(&origin).map_err(refused)?;
    }
    let built = feasibility::build(design).map_err(|e| match e {
        BuildError::Configuration(e) => arguments.source.refusal(&e),
        other => Failure::failed(other),
    })?;
    let verifications = kernel.map(|kernel| built.verified(kernel)).transpose().map_err(Failure::failed)?;
    let names: Vec<&str> = arguments.format.iter().map(String::as_str).collect();
    let formats = named(&names).map_err(Failure::bad_input)?;
    let mut set = Set::new(&built, &prediction, &formats).map_err(Failure::failed)?;
    if let Some(verifications) = verifications {
        set = set.verified(verifications).map_err(Failure::failed)?;
    }
    // What the slicer refuses is said at the end: the parts are made all the same.
    let sliced = slicer.map(|slicer| slicing::slicing(slicer, &built, &prediction)).transpose();
    if let Ok(Some((slicing, files))) = &sliced {
        set = set.sliced(slicing.entry(), files.clone()).map_err(Failure::failed)?;
    }
    if let Some(fix) = &fix {
        set =
            set.with_file(OutputFile::new(FIXED, fix.text.clone().into_bytes())).map_err(Failure::failed)?;
    }
    if let Some((_, comparison)) = &made {
        set = set.measured(comparison.clone()).map_err(Failure::failed)?;
    }
    if let Some(hash) = arguments.model.as_deref().and_then(sha256_read) {
        set = set.predicted_from(hash).map_err(Failure::failed)?;
    }
    let set = set.made_from(origin.clone()).map_err(Failure::failed)?;
    for changed in place.publish(&set.files, arguments.force).map_err(refused)? {
        let location = Location::file(folder.join(changed).display().to_string());
        warn(
            Diagnostic::new(codes::CHANGED_FILE, "was changed since it was written, and stays")
                .with_location(location),
        );
    }
    if let Some(fix) = &fix {
        report_fix(fix, &folder);
    }
    report(arguments, &set, &folder, &prediction);
    if let Some((_, comparison)) = &made {
        as_measured::report(comparison);
    }
    if let (Some((slicing, _)), false) = (sliced?, arguments.json) {
        print_text(&slicing.table())?;
    }
    if arguments.json {
        let bytes = set.manifest.bytes().map_err(Failure::failed)?;
        print_data(escaped_json(&String::from_utf8_lossy(&bytes)).as_bytes())?;
    }
    Ok(())
}

/// Reports each change of a fixed configuration, or that there is none.
fn report_fix(fix: &Fix, folder: &Path) {
    for change in &fix.changes {
        // The parts are not those of the file: also with --quiet.
        warn(Diagnostic::new(codes::CONFIGURATION_CHANGED, format!("changed {change}")));
    }
    match fix.changes.len() {
        0 => log::info!("nothing to fix: the configuration can be built"),
        _ => log::info!("{}: the changed configuration", folder.join(FIXED).display()),
    }
}

/// Reports the set, with its warnings.
fn report(arguments: &Arguments, set: &Set, folder: &Path, prediction: &Prediction) {
    for warning in &set.manifest.warnings {
        warn(warning);
    }
    for part in &set.manifest.parts {
        log::debug!("{}: {:.3} mm3", part.file, part.volume_mm3);
    }
    let friction = &set.manifest.friction;
    log::info!(
        "{}: {} parts; {}{:.2} N of friction at {:.2} N of load ({:.2} to {:.2} N, {})",
        folder.display(),
        set.manifest.parts.len(),
        friction.threshold_n.map(|n| format!("switches at {n:.1} N; ")).unwrap_or_default(),
        friction.friction_n,
        friction.load_n,
        friction.band_n[0],
        friction.band_n[1],
        serde_json::to_value(friction.trust)
            .ok()
            .and_then(|t| t.as_str().map(str::to_owned))
            .unwrap_or_default(),
    );
    if let Some(kernel) = set.manifest.parts.iter().find_map(|p| p.verification.as_ref()).map(|v| v.kernel) {
        log::info!("{} meshes agree with {kernel}", set.manifest.parts.len());
    }
    if let Some(model) = &arguments.model {
        log::info!("the curve comes from {}", model.display());
        prediction.curve.reasons.iter().for_each(|reason| log::info!("{reason}"));
    }
}
