//! `pinswitch finger`: what a switch buys a tendon-driven finger.

use clap::Args;
use pinswitch_friction::finger::{FingerPoint, HUMAN_FINGER, finger};
use pinswitch_friction::{FrictionCurve, Law, Trust};
use serde::Serialize;

use super::law::LawChoice;
use super::source::Source;
use super::{Failure, print, print_json};
use pinswitch_switch::design::Design;

/// The conditions that are compared when none is named.
const PUBLISHED: [&str; 4] = ["six-single", "three-double", "three-single", "silicone-only"];
/// Loads of the table: light, middle, heavy, as shares of the heaviest.
const ROWS: [f64; 3] = [0.1, 0.5, 1.0];

/// Say what layouts buy at the system level: load held beyond the motor's tension, motor mass saved, cost of pulling.
///
/// Holding and giving way (eccentric use), friction carries a part of the load; pulling (concentric use), the motor must
/// overcome it. Motor mass is taken in proportion to torque.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch finger
  pinswitch finger three-double my-switch.toml --json")]
pub(super) struct Arguments {
    /// Configurations or templates [default: the published layouts and bare silicone].
    configs: Vec<String>,
    #[command(flatten)]
    law: LawChoice,
    /// Print JSON: every load of each curve.
    #[arg(long)]
    json: bool,
}

/// One layout's gains.
#[derive(Serialize)]
struct Layout {
    name: String,
    law: Law,
    trust: Trust,
    points: Vec<FingerPoint>,
}

/// What is printed with `--json`.
#[derive(Serialize)]
struct Report {
    human_finger_extra_holding: [f64; 2],
    layouts: Vec<Layout>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let names: Vec<&str> = if arguments.configs.is_empty() {
        PUBLISHED.to_vec()
    } else {
        arguments.configs.iter().map(String::as_str).collect()
    };
    let layouts: Vec<Layout> =
        names.iter().map(|name| layout(name, &arguments.law)).collect::<Result<_, _>>()?;
    if arguments.json {
        let report = Report { human_finger_extra_holding: [HUMAN_FINGER.0, HUMAN_FINGER.1], layouts };
        return print_json(&report);
    }
    print(table(&layouts).as_bytes())
}

fn layout(name: &str, law: &LawChoice) -> Result<Layout, Failure> {
    let design: Design = Source::named(name).design()?;
    let curve: FrictionCurve = law.prediction(&design)?.curve;
    Ok(Layout {
        name: design.configuration().switch.name.clone(),
        law: curve.law,
        trust: curve.trust,
        points: finger(&curve),
    })
}

fn table(layouts: &[Layout]) -> String {
    let mut text = format!(
        "{:<16} {:>8} {:>10} {:>14} {:>13} {:>10}\n",
        "layout", "load", "holds with", "extra holding", "motor saved", "pull costs"
    );
    for layout in layouts {
        let heaviest = layout.points.last().map_or(0.0, |p| p.load_n);
        for share in ROWS {
            let nearest = layout.points.iter().min_by(|a, b| {
                (a.load_n - share * heaviest).abs().total_cmp(&(b.load_n - share * heaviest).abs())
            });
            if let Some(p) = nearest {
                text += &format!(
                    "{:<16} {:>6.1} N {:>8.1} N {:>+12.1} % {:>11.1} % {:>+8.1} %\n",
                    layout.name,
                    p.load_n,
                    p.holding_n,
                    100.0 * p.extra_holding,
                    100.0 * p.motor_mass_saved,
                    100.0 * p.concentric_penalty
                );
            }
        }
    }
    text += &format!(
        "human finger: {:.0} to {:.0} % extra holding, from the friction of its tendon sheath\n",
        100.0 * HUMAN_FINGER.0,
        100.0 * HUMAN_FINGER.1
    );
    text
}
