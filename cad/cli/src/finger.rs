//! `pinswitch finger`: the gains of a tendon-driven finger with a friction switch.

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_friction::finger::{
    FingerPoint, FlexionWrap, JointCurve, JointPath, MeasuredGain, MotorSizing, extra_holding_of, finger,
    measured_gains, over_joint,
};
use pinswitch_friction::published::{HUMAN_FORCE_DIFFERENCE, HUMAN_PEAK_DIFFERENCE, HUMAN_PEAK_JOINT_DEG};
use pinswitch_friction::{Contact, FrictionCurve, Law, PredictionStatus};
use pinswitch_report::{FingerLayout, finger_svg};
use pinswitch_switch::design::Design;
use pinswitch_switch::output::OutputFile;
use serde::Serialize;

use super::finger_text::{csv, table};
use super::law::LawChoice;
use super::range::Range;
use super::source::Source;
use super::terminal::to_json;
use super::{Failure, print_json, print_text};
use crate::write::SetFolder;

/// Conditions that are compared by default.
const PUBLISHED: [&str; 4] = ["six-single", "three-double", "three-single", "silicone-only"];
/// Light load over the joint, as a share of the heavy load.
const LIGHT_SHARE: f64 = 0.1;
/// Heaviest load in N: the upper bound of friction.load_max_n.
const MAX_LOAD_N: f64 = 1000.0;
/// Most flexions of a curve over the joint, one degree apart.
const MAX_FLEXIONS: u32 = 181;

/// Lists the assumptions; `model/doc/finger.md` gives the reasons.
fn assumptions(path: &JointPath) -> Vec<String> {
    vec![
        "motor mass is proportional to torque, on the same drum; the motor holds by torque alone, without a brake or a \
         self-locking gear"
            .to_owned(),
        "friction carries its full share of a held load".to_owned(),
        format!("the tendon runs straight along both links, the pins are centred on it, and {path}"),
    ]
}

/// Compare the gains of layouts in a finger with the human finger.
///
/// The gains are listed over the load and over the angle of the joint.
///
/// Force difference, (T_c - T_e)/F: tension to pull minus tension to hold, as a share of the load; 9 to 12 % in the human
/// finger. Extra holding, F/T_e - 1: load held beyond the motor's tension, about half the force difference. Motor mass is
/// proportional to torque.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch finger
  pinswitch finger three-double my-switch.toml --json
  pinswitch finger --out out/finger
  pinswitch finger three-double --joint 0..60 --wrap-at-straight 20")]
pub(super) struct Arguments {
    /// Configurations or templates [default: the published layouts and bare silicone].
    configs: Vec<String>,
    #[command(flatten)]
    law: LawChoice,
    /// Flexions of the joint in degrees; the published segment allows a wrap of 89.45.
    #[arg(long, value_name = "A..B", default_value = "0..89")]
    joint: Range<f64>,
    /// Wrap angle of the tendon on the switch at the straight finger, in degrees.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    wrap_at_straight: f64,
    /// Increase of the wrap angle per degree of flexion, in degrees.
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    wrap_per_flexion: f64,
    /// Heavy load over the joint in newtons; the light load is a tenth of it [default: the heaviest of each curve].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    load: Option<f64>,
    /// Folder for finger.svg, finger.csv and finger.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON, with every load and every flexion of each curve.
    #[arg(long)]
    json: bool,
}

/// The gains of one layout.
#[derive(Serialize)]
pub(super) struct Layout {
    pub(super) name: String,
    pub(super) law: Law,
    pub(super) trust: PredictionStatus,
    pub(super) reasons: Vec<String>,
    /// Wrap angle of `points` in degrees.
    pub(super) wrap_deg: f64,
    /// Gains over the load.
    pub(super) points: Vec<FingerPoint>,
    pub(super) measured: Vec<MeasuredGain>,
    pub(super) motor: Option<MotorSizing>,
    /// Gains over the joint, at the light and at the heavy load.
    pub(super) over_joint: Vec<JointCurve>,
}

/// The human finger, for comparison.
#[derive(Serialize)]
struct Human {
    force_difference: [f64; 2],
    /// The same as extra holding.
    extra_holding: [f64; 2],
    largest_force_difference: f64,
    largest_at_joint_deg: f64,
}

/// Content of `--json` and finger.json.
#[derive(Serialize)]
pub(super) struct Report {
    human: Human,
    pub(super) assumptions: Vec<String>,
    joint_path: JointPath,
    pub(super) layouts: Vec<Layout>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path =
        JointPath::new(arguments.wrap_at_straight, arguments.wrap_per_flexion).map_err(Failure::bad_input)?;
    let joints_deg = flexions(arguments.joint, &path)?;
    if let Some(load) = arguments.load.filter(|load| !(*load > 0.0 && *load <= MAX_LOAD_N)) {
        return Err(Failure::bad_input(
            Diagnostic::new(format!("the load is outside 0 < load <= {MAX_LOAD_N}"))
                .with_location(Location::field("--load", format!("{load:?}")))
                .with_help("give the load on the tendon in newtons"),
        ));
    }
    let names: Vec<&str> = if arguments.configs.is_empty() {
        PUBLISHED.to_vec()
    } else {
        arguments.configs.iter().map(String::as_str).collect()
    };
    let out = arguments.out.as_deref().map(SetFolder::lock).transpose()?;
    let layouts =
        names.iter().map(|name| layout(name, arguments, &path, &joints_deg)).collect::<Result<_, _>>()?;
    let (low, high) = HUMAN_FORCE_DIFFERENCE;
    let report = Report {
        human: Human {
            force_difference: [low, high],
            extra_holding: [low, high].map(extra_holding_of),
            largest_force_difference: HUMAN_PEAK_DIFFERENCE,
            largest_at_joint_deg: HUMAN_PEAK_JOINT_DEG,
        },
        assumptions: assumptions(&path),
        joint_path: path,
        layouts,
    };
    if let Some(out) = out {
        out.replace(&files(&report)?)?;
        log::info!("{}: finger.svg, finger.csv, finger.json", out.folder().display());
    }
    if arguments.json { print_json(&report) } else { print_text(&table(&report)) }
}

/// Returns the flexions of the range in degrees, one degree apart, and its upper end.
fn flexions(range: Range<f64>, path: &JointPath) -> Result<Vec<f64>, Failure> {
    for end in [range.from, range.to] {
        path.wrap_deg(end).map_err(|e| Failure::bad_input(Diagnostic::from(e).or_in_file("--joint")))?;
    }
    let whole = (0..MAX_FLEXIONS).map(|i| range.from + f64::from(i)).take_while(|deg| *deg < range.to);
    Ok(whole.chain([range.to]).collect())
}

fn layout(
    name: &str,
    arguments: &Arguments,
    path: &JointPath,
    joints_deg: &[f64],
) -> Result<Layout, Failure> {
    let design: Design = Source::new(name).design()?;
    let curve: FrictionCurve = arguments.law.prediction(&design)?.curve;
    let contact = design.contact();
    let points = finger(&curve);
    let heavy_n = arguments.load.or(points.last().map(|p| p.load_n)).unwrap_or_default();
    let predicted = |contact: &Contact, loads_n: &[f64]| arguments.law.curve(contact, loads_n);
    let over_joint = [LIGHT_SHARE * heavy_n, heavy_n]
        .into_iter()
        .map(|load_n| over_joint(contact, path, joints_deg, load_n, predicted))
        .collect::<Result<_, _>>()
        .map_err(Failure::bad_input)?;
    Ok(Layout {
        name: design.configuration().switch.name.to_string(),
        law: curve.law,
        trust: curve.status,
        reasons: curve.reasons.clone(),
        wrap_deg: contact.wrap_rad().to_degrees(),
        measured: measured_gains(contact),
        motor: MotorSizing::of(&points),
        points,
        over_joint,
    })
}

fn files(report: &Report) -> Result<Vec<OutputFile>, Failure> {
    let layouts: Vec<FingerLayout<'_>> = report
        .layouts
        .iter()
        .map(|l| FingerLayout {
            name: &l.name,
            wrap_deg: l.wrap_deg,
            over_load: &l.points,
            measured: &l.measured,
            over_joint: &l.over_joint,
            measured_joint_deg: report.joint_path.measured_joint_deg(),
        })
        .collect();
    let file = |name: &str, bytes: Vec<u8>| OutputFile { name: name.to_owned(), bytes };
    let svg = finger_svg(&layouts).map_err(Failure::failed)?;
    Ok(vec![
        file("finger.svg", svg.into_bytes()),
        file("finger.csv", csv(report).into_bytes()),
        file("finger.json", to_json(report)?),
    ])
}
