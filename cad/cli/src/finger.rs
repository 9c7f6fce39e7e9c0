//! `pinswitch finger`: the gains of a tendon-driven finger with a friction switch.

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::finger::{
    FingerPoint, FlexionWrap, JointCurve, JointPath, MeasuredGain, MotorSizing, extra_holding_of, finger,
    measured_gains, over_joint,
};
use pinswitch_friction::published::{HUMAN_FORCE_DIFFERENCE, HUMAN_PEAK_DIFFERENCE, HUMAN_PEAK_JOINT_DEG};
use pinswitch_friction::{Contact, FrictionCurve, Law, PredictionStatus};
use pinswitch_report::{FingerLayout, finger_svg};
use pinswitch_switch::design::{Design, Joint};
use pinswitch_switch::output::OutputFile;
use schemars::JsonSchema;
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

/// Assumed flexions in degrees; the published segment allows a wrap of 89.45.
const ASSUMED_FLEXIONS: Range<f64> = Range { from: 0.0, to: 89.0 };

/// Lists the assumptions; `model/doc/finger.md` gives the reasons. Those about the path of the tendon apply to layouts
/// without a joint, and one about guides to those with a joint.
fn assumptions(path: &JointPath, layouts: &[Layout]) -> Vec<String> {
    let mut all = vec![
        "motor mass is proportional to torque, on the same drum; the motor holds by torque alone, without a brake or a \
         self-locking gear"
            .to_owned(),
        "friction carries its full share of a held load".to_owned(),
    ];
    let is_mixed = layouts.iter().any(|l| l.joint.is_some()) && layouts.iter().any(|l| l.joint.is_none());
    for layout in layouts {
        let of = if is_mixed { format!("{}: ", layout.name) } else { String::new() };
        let assumption = match &layout.joint {
            None => format!(
                "{of}the tendon runs straight along both links, the pins are centred on it, and {path}"
            ),
            Some(joint) => format!(
                "{of}no friction in guide and anchor, where the tendon turns by at most {:.1} deg",
                joint.guide_turn_deg.max(joint.anchor_turn_deg)
            ),
        };
        if !all.contains(&assumption) {
            all.push(assumption);
        }
    }
    all
}

/// Compare the gains of layouts in a finger with the human finger.
///
/// The gains are listed over the load and over the angle of the joint.
///
/// Force difference, (T_c - T_e)/F: tension to pull minus tension to hold, as a share of the load; 9 to 12 % in the human
/// finger. Extra holding, F/T_e - 1: load held beyond the motor's tension, about half the force difference. Motor mass is
/// proportional to torque.
///
/// The wrap over the joint is computed from the parts of a configuration with `mount.kind = "joint"`, and assumed for every
/// other one.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch finger
  pinswitch finger three-double my-switch.toml --json
  pinswitch finger --out out/finger
  pinswitch finger three-double --joint 0..60 --wrap-at-straight 20
  pinswitch finger my-joint.toml --out out/joint")]
pub(super) struct Arguments {
    /// Configurations or templates [default: the published layouts and bare silicone].
    configs: Vec<String>,
    #[command(flatten)]
    law: LawChoice,
    /// Flexions of the joint in degrees [default: between the stops of a joint, 0..89 without one].
    #[arg(long, value_name = "A..B")]
    joint: Option<Range<f64>>,
    /// Assumed wrap angle at the straight finger, in degrees; not for a configuration with a joint [default: 0].
    #[arg(long, value_name = "DEG")]
    wrap_at_straight: Option<f64>,
    /// Assumed increase of the wrap angle per degree of flexion, in degrees; not for a joint [default: 1].
    #[arg(long, value_name = "SHARE")]
    wrap_per_flexion: Option<f64>,
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
#[derive(Serialize, JsonSchema)]
pub(super) struct Layout {
    /// Name of the switch.
    pub(super) name: String,
    /// Law of the friction at the wrap angle of the configuration.
    pub(super) law: Law,
    /// Support of its prediction by measurements.
    pub(super) trust: PredictionStatus,
    /// Reasons of that status.
    pub(super) reasons: Vec<String>,
    /// Wrap angle of `points` in degrees.
    pub(super) wrap_deg: f64,
    /// Gains over the load.
    pub(super) points: Vec<FingerPoint>,
    /// Gains at the loads that the paper measured.
    pub(super) measured: Vec<MeasuredGain>,
    /// The motor that holds the heaviest load; null without a load.
    pub(super) motor: Option<MotorSizing>,
    /// Gains over the joint, at the light and at the heavy load.
    pub(super) over_joint: Vec<JointCurve>,
    /// The joint from whose parts the wrap is computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joint: Option<JointGeometry>,
    /// Flexion of the measured points in degrees.
    #[serde(skip)]
    measured_joint_deg: Option<f64>,
}

/// Geometry of a joint between its stops.
#[derive(Serialize, JsonSchema)]
pub(super) struct JointGeometry {
    /// Flexion at the stops in degrees.
    pub(super) flexion_deg: [f64; 2],
    /// Wrap angle at the stops in degrees.
    pub(super) wrap_deg: [f64; 2],
    /// Least and largest moment arm of the tendon on the distal link in mm.
    pub(super) moment_arm_mm: [f64; 2],
    /// Largest turn of the tendon in its guide in degrees.
    pub(super) guide_turn_deg: f64,
    /// Largest turn of the tendon at its anchor in degrees.
    pub(super) anchor_turn_deg: f64,
}

impl JointGeometry {
    fn new(joint: &Joint) -> Self {
        let [guide_turn_deg, anchor_turn_deg] = joint.largest_turns_rad().map(f64::to_degrees);
        Self {
            flexion_deg: joint.flexion_deg,
            wrap_deg: joint.flexion_deg.map(|deg| joint.contact(deg).wrap_rad().to_degrees()),
            moment_arm_mm: joint.moment_arms_mm(),
            guide_turn_deg,
            anchor_turn_deg,
        }
    }
}

/// The human finger, for comparison.
#[derive(Serialize, JsonSchema)]
struct Human {
    /// Least and largest usual force difference, a fraction.
    force_difference: [f64; 2],
    /// The same as extra holding.
    extra_holding: [f64; 2],
    /// Largest force difference, a fraction.
    largest_force_difference: f64,
    /// Flexion at which it was measured, degrees.
    largest_at_joint_deg: f64,
}

/// Content of `--json` and finger.json.
#[derive(Serialize, JsonSchema)]
pub(super) struct Report {
    /// The human finger.
    human: Human,
    /// What is assumed about finger and motor.
    pub(super) assumptions: Vec<String>,
    /// Assumed wrap over the joint; absent if every layout has a joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    joint_path: Option<JointPath>,
    /// Each switch.
    pub(super) layouts: Vec<Layout>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = JointPath::new(
        arguments.wrap_at_straight.unwrap_or_default(),
        arguments.wrap_per_flexion.unwrap_or(1.0),
    )
    .map_err(Failure::bad_input)?;
    if let Some(range) = arguments.joint {
        flexions(range, &path)?;
    }
    if let Some(load) = arguments.load.filter(|load| !(*load > 0.0 && *load <= MAX_LOAD_N)) {
        return Err(Failure::bad_input(
            Diagnostic::new(codes::OUT_OF_RANGE, format!("the load is outside 0 < load <= {MAX_LOAD_N}"))
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
    let layouts: Vec<Layout> =
        names.iter().map(|name| layout(name, arguments, &path)).collect::<Result<_, _>>()?;
    let (low, high) = HUMAN_FORCE_DIFFERENCE;
    let report = Report {
        human: Human {
            force_difference: [low, high],
            extra_holding: [low, high].map(extra_holding_of),
            largest_force_difference: HUMAN_PEAK_DIFFERENCE,
            largest_at_joint_deg: HUMAN_PEAK_JOINT_DEG,
        },
        assumptions: assumptions(&path, &layouts),
        joint_path: layouts.iter().any(|l| l.joint.is_none()).then_some(path),
        layouts,
    };
    if let Some(out) = out {
        out.replace(&files(&report)?)?;
        log::info!("{}: finger.svg, finger.csv, finger.json", out.folder().display());
    }
    if arguments.json { print_json(&report) } else { print_text(&table(&report)) }
}

/// Returns the flexions of the range in degrees, one degree apart, and its upper end.
fn flexions(range: Range<f64>, path: &impl FlexionWrap) -> Result<Vec<f64>, Failure> {
    for end in [range.from, range.to] {
        path.wrap(end).map_err(|e| Failure::bad_input(Diagnostic::from(e).or_in_file("--joint")))?;
    }
    let whole = (0..MAX_FLEXIONS).map(|i| range.from + f64::from(i)).take_while(|deg| *deg < range.to);
    Ok(whole.chain([range.to]).collect())
}

/// Refuses an assumption about the finger for a configuration with a joint.
pub(super) fn refuse_assumptions(name: &str, given: &[(&str, Option<f64>)]) -> Result<(), Failure> {
    match given.iter().find_map(|(option, value)| value.map(|value| (*option, value))) {
        None => Ok(()),
        Some((option, value)) => Err(Failure::bad_input(
            Diagnostic::new(
                codes::CONFLICTING_SETTINGS,
                format!("{name} has a joint, whose parts determine links, stops and wrap"),
            )
            .with_location(Location::field(option, value.to_string()))
            .with_help("leave the option out, or give a configuration without a joint"),
        )),
    }
}

fn layout(name: &str, arguments: &Arguments, path: &JointPath) -> Result<Layout, Failure> {
    let design: Design = Source::new(name).design()?;
    let curve: FrictionCurve = arguments.law.prediction(&design)?.curve;
    let points = finger(&curve);
    let heavy_n = arguments.load.or(points.last().map(|p| p.load_n)).unwrap_or_default();
    let loads_n = [LIGHT_SHARE * heavy_n, heavy_n];
    let joint = design.joint();
    let (over_joint, measured_joint_deg) = match &joint {
        Some(joint) => {
            let given = [
                ("--wrap-at-straight", arguments.wrap_at_straight),
                ("--wrap-per-flexion", arguments.wrap_per_flexion),
            ];
            refuse_assumptions(name, &given)?;
            let [from, to] = joint.flexion_deg;
            let range = arguments.joint.unwrap_or(Range { from, to });
            (curves(design.contact(), arguments, joint, range, loads_n)?, joint.measured_joint_deg())
        }
        None => {
            let range = arguments.joint.unwrap_or(ASSUMED_FLEXIONS);
            (curves(design.contact(), arguments, path, range, loads_n)?, path.measured_joint_deg())
        }
    };
    let contact = design.contact();
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
        joint: joint.as_ref().map(JointGeometry::new),
        measured_joint_deg,
    })
}

/// Returns the gains over the joint at each load.
fn curves(
    contact: &Contact,
    arguments: &Arguments,
    path: &impl FlexionWrap,
    range: Range<f64>,
    loads_n: [f64; 2],
) -> Result<Vec<JointCurve>, Failure> {
    let joints_deg = flexions(range, path)?;
    let predicted = |contact: &Contact, loads_n: &[f64]| arguments.law.curve(contact, loads_n);
    loads_n
        .into_iter()
        .map(|load_n| over_joint(contact, path, &joints_deg, load_n, predicted))
        .collect::<Result<_, _>>()
        .map_err(Failure::bad_input)
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
            measured_joint_deg: l.measured_joint_deg,
            has_joint: l.joint.is_some(),
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
