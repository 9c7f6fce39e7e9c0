//! `pinswitch export CONFIG --to FORMAT --out DIR`.

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::{Args, ValueEnum};
use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::{Contact, FrictionCurve};
use pinswitch_robot::{FMU_LIBRARY, FMU_SOURCE, Finger, Surface, fmu_sources, zip_fmu};
use pinswitch_switch::design::Design;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::prediction::loads_n;

use super::Failure;
use super::calibrated_curve::calibrated_curve;
use super::law::LawChoice;
use super::source::Source;
use super::terminal::warn;
use crate::write::SetFolder;

/// Wrap angles of the table of a finger, from the straight to the flexed one.
const WRAPS: u32 = 15;
/// Smallest wrap angle of a table, degrees. Hosts interpolate to zero friction at zero wrap.
const LEAST_WRAP_DEG: f64 = 2.0;
/// Most models of a distribution.
const MOST_DRAWS: i64 = 10_000;

/// Export a switch for a robot simulator.
///
/// Writes the tensions of the switch over load and wrap angle (switch.json, switch.csv), and a model that uses them. The
/// simulators themselves have no friction that depends on tension and direction; a host adds it (cad/doc/robots.md). With
/// --model, the table has the wrap angle of the configuration only.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch export three-double --to mujoco --out out/finger
  pinswitch export three-double --to mujoco --draws 20 --seed 1 --out out/fingers
  pinswitch export my-switch.toml --to fmu --model calibration/model.toml --out out/fmu
  pinswitch export three-double --to csv --out out/table")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Kind of model.
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// Folder for the files.
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// model.toml of a calibration; its curve, without the effects of the rig, replaces the law's.
    #[arg(long, value_name = "TOML", conflicts_with = "law")]
    model: Option<PathBuf>,
    #[command(flatten)]
    law: LawChoice,
    /// Also write N models with frictions drawn from the band of the curve, in the folders draw-001, draw-002, ...
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=MOST_DRAWS))]
    draws: u32,
    /// Seed of the draws.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    finger: FingerOptions,
}

/// Dimensions of the two-link finger. The paper prints none: every default is assumed.
#[derive(Args, Debug)]
struct FingerOptions {
    /// Length of the proximal link in mm.
    #[arg(long, value_name = "MM", default_value_t = Finger::default().proximal_mm)]
    proximal: f64,
    /// Length of the distal link in mm.
    #[arg(long, value_name = "MM", default_value_t = Finger::default().distal_mm)]
    distal: f64,
    /// Mass of the distal link in g.
    #[arg(long, value_name = "G", default_value_t = Finger::default().distal_mass_g)]
    distal_mass: f64,
    /// Mass at the fingertip in g.
    #[arg(long, value_name = "G", default_value_t = Finger::default().payload_g)]
    payload: f64,
    /// Largest flexion in degrees.
    #[arg(long, value_name = "DEG", default_value_t = Finger::default().flexion_deg)]
    flexion: f64,
    /// Wrap angle of the tendon at the straight finger, in degrees.
    #[arg(long, value_name = "DEG", default_value_t = Finger::default().wrap_at_straight_deg)]
    wrap_at_straight: f64,
    /// Increase of the wrap angle per degree of flexion, in degrees.
    #[arg(long, value_name = "SHARE", default_value_t = Finger::default().wrap_per_flexion)]
    wrap_per_flexion: f64,
}

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// A two-link finger in MJCF, for MuJoCo with the host of the Python package
    Mujoco,
    /// The finger as URDF, without friction
    Urdf,
    /// A co-simulation unit of FMI 3.0 with C sources, and its library if a C compiler (`cc`) is installed
    Fmu,
    /// The table alone
    Csv,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let design = arguments.source.design()?;
    let finger = finger(arguments, &design);
    finger.check().map_err(Failure::bad_input)?;
    let out = SetFolder::lock(&arguments.out)?;
    let surface = surface(arguments, &design, &finger)?;
    let mut files = files(arguments.to, &surface, &finger)?;
    for (number, drawn) in (1..).zip(surface.draws(arguments.draws, arguments.seed)) {
        let folder = format!("draw-{number:03}");
        let path = arguments.out.join(&folder);
        std::fs::create_dir_all(&path).map_err(|e| crate::write::write_error(&path, e))?;
        let drawn = self::files(arguments.to, &drawn, &finger)?;
        files.splice(0..0, drawn.into_iter().map(|(name, bytes)| (format!("{folder}/{name}"), bytes)));
    }
    let (inner, top): (Vec<_>, Vec<_>) = files.into_iter().partition(|(name, _)| name.contains('/'));
    for (name, bytes) in inner {
        crate::write::write_file(&arguments.out.join(name), &bytes)?;
    }
    let top: Vec<OutputFile> = top.into_iter().map(|(name, bytes)| OutputFile { name, bytes }).collect();
    out.replace_listed(&top, "export", &[])?;
    let names: Vec<&str> = top.iter().map(|file| file.name.as_str()).collect();
    let draws = match arguments.draws {
        0 => String::new(),
        count => format!(", and {count} drawn models"),
    };
    log::info!("{}: {}{draws}", arguments.out.display(), names.join(", "));
    Ok(())
}

fn finger(arguments: &Arguments, design: &Design) -> Finger {
    let options = &arguments.finger;
    Finger {
        proximal_mm: options.proximal,
        distal_mm: options.distal,
        thickness_mm: design.configuration().shell.width_mm,
        distal_mass_g: options.distal_mass,
        payload_g: options.payload,
        moment_arm_mm: design.contact().bed().axis_radius_mm(),
        flexion_deg: options.flexion,
        wrap_at_straight_deg: options.wrap_at_straight,
        wrap_per_flexion: options.wrap_per_flexion,
    }
}

/// Predicts the tensions over the wrap angles of the finger; for a unit or a calibrated model, at that of the
/// configuration.
fn surface(arguments: &Arguments, design: &Design, finger: &Finger) -> Result<Surface, Failure> {
    let name = design.configuration().switch.name.to_string();
    let contact = design.contact();
    let curves: Vec<(f64, FrictionCurve)> = match &arguments.model {
        Some(model) => vec![(contact.wrap_rad(), calibrated_curve(design, model)?)],
        None if arguments.to == Format::Fmu => vec![(contact.wrap_rad(), curve(arguments, contact, design)?)],
        None => {
            let (from, to) = (finger.wrap_deg(0.0).max(LEAST_WRAP_DEG), finger.wrap_deg(finger.flexion_deg));
            let step = (to - from) / f64::from(WRAPS - 1);
            let wraps = (0..WRAPS).map(|i| from + step * f64::from(i)).map(f64::to_radians);
            // Without a change of the wrap, all angles are one.
            let wraps: Vec<f64> = if step > 0.0 { wraps.collect() } else { wraps.take(1).collect() };
            let at = |wrap_rad: f64| {
                let contact = contact.at_wrap(wrap_rad).map_err(Failure::bad_input)?;
                Ok((wrap_rad, curve(arguments, &contact, design)?))
            };
            wraps.into_iter().map(at).collect::<Result<_, Failure>>()?
        }
    };
    Surface::new(&name, curves).map_err(Failure::bad_input)
}

fn curve(arguments: &Arguments, contact: &Contact, design: &Design) -> Result<FrictionCurve, Failure> {
    arguments.law.curve(contact, &loads_n(design)).map_err(Failure::bad_input)
}

/// Returns the files of one model, the table as JSON last.
fn files(format: Format, surface: &Surface, finger: &Finger) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    const TABLE: &str = "switch.json";
    let model = match format {
        Format::Mujoco => {
            Some(("finger.xml", finger.mjcf(surface, TABLE).map_err(Failure::bad_input)?.into_bytes()))
        }
        Format::Urdf => {
            Some(("finger.urdf", finger.urdf(surface, TABLE).map_err(Failure::bad_input)?.into_bytes()))
        }
        Format::Fmu => Some(("switch.fmu", fmu(surface)?)),
        Format::Csv => None,
    };
    let model = model.map(|(name, bytes)| (name.to_owned(), bytes));
    let table = [
        ("switch.csv".to_owned(), surface.to_csv().into_bytes()),
        (TABLE.to_owned(), surface.to_json().map_err(Failure::failed)?.into_bytes()),
    ];
    Ok(model.into_iter().chain(table).collect())
}

/// Returns a unit with the library of this platform; without a compiler, with sources only.
fn fmu(surface: &Surface) -> Result<Vec<u8>, Failure> {
    let mut files = fmu_sources(surface);
    match library(&files) {
        Ok(library) => files.insert(1, library),
        Err(error) => warn(
            Diagnostic::new("no C compiler: the unit has sources and no library")
                .with_help("install a C compiler as `cc`, or compile the sources in the importing tool")
                .with_source(error),
        ),
    }
    zip_fmu(&files).map_err(Failure::failed)
}

/// Compiles the sources with `cc`; returns the library with its name in the unit.
fn library(files: &[(String, Vec<u8>)]) -> std::io::Result<(String, Vec<u8>)> {
    let folder = tempfile::tempdir()?;
    for (name, bytes) in files {
        let path = folder.path().join(name);
        path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
        std::fs::write(path, bytes)?;
    }
    let (system, ending) = match std::env::consts::OS {
        "macos" => ("darwin", "dylib"),
        "windows" => ("windows", "dll"),
        other => (other, "so"),
    };
    let name = format!("binaries/{}-{system}/{FMU_LIBRARY}.{ending}", std::env::consts::ARCH);
    let library: PathBuf = folder.path().join(Path::new("library"));
    let compiled = Command::new("cc")
        .args(["-shared", "-fPIC", "-O2", "-std=c99", "-ffp-contract=off", "-fvisibility=hidden", "-o"])
        .arg(&library)
        .arg(folder.path().join(FMU_SOURCE))
        .output()?;
    if !compiled.status.success() {
        return Err(std::io::Error::other(String::from_utf8_lossy(&compiled.stderr).into_owned()));
    }
    Ok((name, std::fs::read(library)?))
}
