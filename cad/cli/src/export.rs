//! `pinswitch export CONFIG --to FORMAT --out DIR`.

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::{Args, ValueEnum};
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::finger::{FlexionWrap, JointPath, Wrap};
use pinswitch_friction::{Contact, FrictionCurve};
use pinswitch_robot::{FMU_LIBRARY, FMU_SOURCE, Finger, Surface, fmu_sources, zip_fmu};
use pinswitch_switch::design::Design;
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::prediction::loads_n;

use super::calibrated_curve::calibrated_curve;
use super::finger::refuse_assumptions;
use super::law::LawChoice;
use super::source::Source;
use super::terminal::warn;
use super::{Failure, print_data};
use crate::write::SetFolder;

const COMMAND: &str = "export";
/// Rows of the table of a finger, from the straight to the flexed one.
const WRAPS: u32 = 15;
/// Smallest wrap angle of a table, degrees. Hosts interpolate to zero friction at zero wrap.
const LEAST_WRAP_DEG: f64 = 2.0;
/// Most models of a distribution.
const MOST_DRAWS: i64 = 10_000;

/// Export a switch for a robot simulator.
///
/// Writes the tensions of the switch over load and wrap angle (switch.json, switch.csv), and a model that uses them. The
/// simulators themselves have no friction that depends on tension and direction; a host adds it (cad/doc/robots.md). With
/// --model or --law paper, the table has the wrap angle of the configuration only.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch export three-double --to mujoco --out out/finger
  pinswitch export three-double --to mujoco --draws 20 --seed 1 --out out/fingers
  pinswitch export my-switch.toml --to fmu --model calibration/model.toml --out out/fmu
  pinswitch export three-double --to csv --out out/table --json")]
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
    /// Also write N models with frictions drawn from the band of the curve, numbered from 001.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=MOST_DRAWS))]
    draws: u32,
    /// Seed of the draws.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    finger: FingerOptions,
    /// Print switch.json.
    #[arg(long)]
    json: bool,
}

/// Dimensions of the two-link finger. The paper prints none: every default is assumed.
#[derive(Args, Debug)]
struct FingerOptions {
    /// Length of the proximal link in mm [default: 60]; not for a configuration with a joint.
    #[arg(long, value_name = "MM")]
    proximal: Option<f64>,
    /// Length of the distal link in mm [default: 50]; not for a joint.
    #[arg(long, value_name = "MM")]
    distal: Option<f64>,
    /// Mass of the distal link in g.
    #[arg(long, value_name = "G", default_value_t = Finger::default().distal_mass_g)]
    distal_mass: f64,
    /// Mass at the fingertip in g.
    #[arg(long, value_name = "G", default_value_t = Finger::default().payload_g)]
    payload: f64,
    /// Largest flexion in degrees [default: 89]; not for a joint.
    #[arg(long, value_name = "DEG")]
    flexion: Option<f64>,
    /// Wrap angle of the tendon at the straight finger, in degrees [default: 0]; not for a joint.
    #[arg(long, value_name = "DEG")]
    wrap_at_straight: Option<f64>,
    /// Increase of the wrap angle per degree of flexion, in degrees [default: 1]; not for a joint.
    #[arg(long, value_name = "SHARE")]
    wrap_per_flexion: Option<f64>,
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
    let finger = finger(arguments, &design)?;
    finger.check().map_err(Failure::bad_input)?;
    let out = SetFolder::lock(&arguments.out)?;
    let surface = surface(arguments, &design, &finger)?;
    let mut all = Vec::new();
    for (number, drawn) in (1..).zip(surface.draws(arguments.draws, arguments.seed)) {
        all.extend(files(arguments.to, &drawn, &finger, &format!("-{number:03}"))?);
    }
    let top = files(arguments.to, &surface, &finger, "")?;
    let names: Vec<String> = top.iter().map(|file| file.name.clone()).collect();
    all.extend(top);
    // Models of an earlier export that this one does not have.
    let earlier = out.written_by(COMMAND)?;
    let stale: Vec<&str> =
        earlier.iter().map(String::as_str).filter(|name| all.iter().all(|file| file.name != *name)).collect();
    out.replace_listed(&all, COMMAND, &stale)?;
    let draws = match arguments.draws {
        0 => String::new(),
        count => format!(", and {count} drawn models"),
    };
    log::info!("{}: {}{draws}", arguments.out.display(), names.join(", "));
    if arguments.json { print_data(surface.to_json().map_err(Failure::failed)?.as_bytes()) } else { Ok(()) }
}

/// Returns the finger of a joint, or an assumed one.
fn finger(arguments: &Arguments, design: &Design) -> Result<Finger, Failure> {
    let options = &arguments.finger;
    let assumed = Finger {
        thickness_mm: design.configuration().shell.width_mm,
        distal_mass_g: options.distal_mass,
        payload_g: options.payload,
        ..Finger::default()
    };
    if let Some(joint) = design.joint() {
        let given = [
            ("--proximal", options.proximal),
            ("--distal", options.distal),
            ("--flexion", options.flexion),
            ("--wrap-at-straight", options.wrap_at_straight),
            ("--wrap-per-flexion", options.wrap_per_flexion),
        ];
        refuse_assumptions(&design.configuration().switch.name.to_string(), &given)?;
        let [least_mm, largest_mm] = joint.moment_arms_mm();
        return Ok(Finger {
            proximal_mm: joint.proximal.length_mm,
            distal_mm: joint.distal.length_mm,
            moment_arm_mm: f64::midpoint(least_mm, largest_mm),
            flexion_deg: joint.flexion_deg,
            wrap_deg: joint.flexion_deg.map(|deg| joint.contact(deg).wrap_rad().to_degrees()),
            ..assumed
        });
    }
    let path =
        JointPath::new(options.wrap_at_straight.unwrap_or_default(), options.wrap_per_flexion.unwrap_or(1.0))
            .map_err(Failure::bad_input)?;
    let flexion_deg = [assumed.flexion_deg[0], options.flexion.unwrap_or(assumed.flexion_deg[1])];
    let wrap = |deg: f64| path.wrap_deg(deg).map_err(Failure::bad_input);
    Ok(Finger {
        proximal_mm: options.proximal.unwrap_or(assumed.proximal_mm),
        distal_mm: options.distal.unwrap_or(assumed.distal_mm),
        moment_arm_mm: design.contact().bed().axis_radius_mm(),
        flexion_deg,
        wrap_deg: [wrap(flexion_deg[0])?, wrap(flexion_deg[1])?],
        ..assumed
    })
}

/// Predicts the tensions over the wrap angles of the finger; at that of the configuration for a unit without a joint, a
/// calibrated model, or the law of the paper.
///
/// The rows of a joint are the contacts at equal steps of its flexion, each at the wrap angle that the model of the finger
/// has there.
fn surface(arguments: &Arguments, design: &Design, finger: &Finger) -> Result<Surface, Failure> {
    let name = design.configuration().switch.name.to_string();
    let contact = design.contact();
    let curves: Vec<(f64, FrictionCurve)> = match &arguments.model {
        Some(model) => vec![(contact.wrap_rad(), calibrated_curve(design, model)?)],
        None if arguments.law.is_of_one_wrap() || arguments.to == Format::Fmu && design.joint().is_none() => {
            vec![(contact.wrap_rad(), curve(arguments, contact, design)?)]
        }
        None => {
            let at = |wrap_deg: f64, wrap: Wrap| {
                let contact = contact
                    .at_wrap_about(wrap.wrap_deg.to_radians(), wrap.middle_deg.to_radians())
                    .map_err(Failure::bad_input)?;
                Ok((wrap_deg.to_radians(), curve(arguments, &contact, design)?))
            };
            match design.joint() {
                Some(joint) => steps(finger.flexion_deg)
                    .into_iter()
                    .map(|deg| Ok((finger.wrap_deg_at(deg), joint.wrap(deg).map_err(Failure::bad_input)?)))
                    .filter(|row: &Result<(f64, Wrap), Failure>| {
                        row.as_ref().map_or(true, |(deg, wrap)| deg.min(wrap.wrap_deg) >= LEAST_WRAP_DEG)
                    })
                    .map(|row| row.and_then(|(deg, wrap)| at(deg, wrap)))
                    .collect::<Result<_, Failure>>()?,
                None => steps([finger.wrap_deg[0].max(LEAST_WRAP_DEG), finger.wrap_deg[1]])
                    .into_iter()
                    .map(|deg| at(deg, Wrap { wrap_deg: deg, middle_deg: 0.0 }))
                    .collect::<Result<_, Failure>>()?,
            }
        }
    };
    Surface::new(&name, curves).map_err(Failure::bad_input)
}

/// Returns equal steps between two angles; one angle if the second is not larger.
fn steps([from, to]: [f64; 2]) -> Vec<f64> {
    let step = (to - from) / f64::from(WRAPS - 1);
    let all = (0..WRAPS).map(|i| from + step * f64::from(i));
    if step > 0.0 { all.collect() } else { vec![from] }
}

fn curve(arguments: &Arguments, contact: &Contact, design: &Design) -> Result<FrictionCurve, Failure> {
    arguments.law.curve(contact, &loads_n(design)).map_err(Failure::bad_input)
}

/// Returns the files of one model, the table as JSON last. `suffix` follows the name of each.
fn files(
    format: Format,
    surface: &Surface,
    finger: &Finger,
    suffix: &str,
) -> Result<Vec<OutputFile>, Failure> {
    let table = format!("switch{suffix}.json");
    let file = |name: String, bytes: Vec<u8>| OutputFile { name, bytes };
    let model = match format {
        Format::Mujoco => {
            let xml = finger.mjcf(surface, &table).map_err(Failure::bad_input)?;
            Some(file(format!("finger{suffix}.xml"), xml.into_bytes()))
        }
        Format::Urdf => {
            let urdf = finger.urdf(surface, &table).map_err(Failure::bad_input)?;
            Some(file(format!("finger{suffix}.urdf"), urdf.into_bytes()))
        }
        Format::Fmu => Some(file(format!("switch{suffix}.fmu"), fmu(surface)?)),
        Format::Csv => None,
    };
    let csv = file(format!("switch{suffix}.csv"), surface.to_csv().into_bytes());
    let json = file(table, surface.to_json().map_err(Failure::failed)?.into_bytes());
    Ok(model.into_iter().chain([csv, json]).collect())
}

/// Returns a unit with the library of this platform; without a compiler, with sources only.
fn fmu(surface: &Surface) -> Result<Vec<u8>, Failure> {
    let mut files = fmu_sources(surface);
    match library(&files) {
        Ok(library) => files.insert(1, library),
        Err(error) => warn(
            Diagnostic::new(codes::CANNOT_START, "no C compiler: the unit has sources and no library")
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
