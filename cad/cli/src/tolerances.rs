//! `pinswitch tolerances CONFIG`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt};
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::tolerances::{
    Allocation, Analysis, ChainDimension, Contribution, DEVIATIONS_PER_TOLERANCE, Linear, NORMAL_95,
    Simulated, link,
};
use schemars::JsonSchema;
use serde::Serialize;

use super::source::Source;
use super::terminal::to_json;
use super::tolerances_text::{csv, table};
use super::{Failure, print_json, print_text};
use crate::write::SetFolder;

/// Most characters of a quoted argument.
const MAX_QUOTE: usize = 40;
/// Largest tolerance of a measured process, relative to the nominal dimension.
const MAX_RELATIVE: f64 = 0.5;
/// Largest tolerance of a measured position, mm.
const MAX_POSITION_MM: f64 = 5.0;

/// Compute how much the tolerance of each dimension contributes to the scatter of the threshold.
///
/// The threshold is the load at which silicone carries half of the friction, by the physics law. Each dimension has the
/// tolerance that its process gives (print, casting, purchase). The scatter follows to first order from derivatives, and
/// from simulated switches. With --scatter, tolerances for a wanted scatter are allotted at the least cost: with the
/// reciprocal cost model, by Lagrange's multiplier. If the best processes do not reach it, the exit code is 1, and the
/// smallest scatter that they reach is printed.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch tolerances three-double
  pinswitch tolerances mine.toml --scatter 2.5
  pinswitch tolerances mine.toml --scatter 10% --out out/tolerances
  pinswitch tolerances mine.toml --measured layer_thickness=0.05 --measured hardness=2 --json

cad/doc/tolerances.md lists the dimensions, their tolerances and the sources.")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Wanted half width of the 95 % interval of the threshold, in newtons or as a share such as 10%.
    #[arg(long, value_name = "N|PERCENT")]
    scatter: Option<Scatter>,
    /// Tolerance of your own process instead of the assumed one, as in --measured layer_thickness=0.05; may be repeated.
    #[arg(long, value_name = "DIMENSION=PLUS_MINUS")]
    measured: Vec<Measured>,
    /// Number of simulated switches.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u64).range(2..=1_000_000))]
    draws: u64,
    /// Seed of the simulated switches.
    #[arg(long, value_name = "SEED", default_value_t = super::SEED)]
    seed: u64,
    /// Folder for tolerances.csv and tolerances.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
}

/// Wanted scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scatter {
    /// In newtons.
    Newtons(f64),
    /// As a share of the threshold.
    Share(f64),
}

impl FromStr for Scatter {
    type Err = Diagnostic;

    /// Parses `2.5` as newtons and `10%` as a share.
    fn from_str(text: &str) -> Result<Self, Diagnostic> {
        let (number, scale, kind): (_, _, fn(f64) -> Self) = match text.trim().strip_suffix('%') {
            Some(percent) => (percent, 0.01, Self::Share),
            None => (text, 1.0, Self::Newtons),
        };
        let help = "give newtons such as 2.5, or a share such as 10%";
        let value = number.trim().parse::<f64>().map_err(|_| {
            Diagnostic::new(codes::MALFORMED_VALUE, format!("{:?} is not a number", excerpt(text, MAX_QUOTE)))
                .with_help(help)
        })?;
        if value.is_finite() && value > 0.0 {
            Ok(kind(value * scale))
        } else {
            Err(Diagnostic::new(codes::OUT_OF_RANGE, "the scatter is not positive").with_help(help))
        }
    }
}

impl Scatter {
    fn newtons(self, threshold_n: f64) -> f64 {
        match self {
            Self::Newtons(n) => n,
            Self::Share(share) => share * threshold_n,
        }
    }
}

/// Measured tolerance of a dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measured(ChainDimension, f64);

impl FromStr for Measured {
    type Err = Diagnostic;

    fn from_str(text: &str) -> Result<Self, Diagnostic> {
        let names = || ChainDimension::ALL.map(ChainDimension::as_str).join(", ");
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        let dimension = ChainDimension::from_name(name.trim()).ok_or_else(|| {
            Diagnostic::new(codes::UNKNOWN_WORD, format!("unknown dimension {:?}", excerpt(name, MAX_QUOTE)))
                .with_help(format!("give one of {}", names()))
        })?;
        let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
        let value = value.ok_or_else(|| {
            Diagnostic::new(codes::OUT_OF_RANGE, "the tolerance is not a number of at least 0")
                .with_help(format!("give the half width of the tolerance in {}", dimension.unit()))
        })?;
        Ok(Self(dimension, value))
    }
}

/// Content of `--json` and tolerances.json.
#[derive(Serialize, JsonSchema)]
pub(super) struct Report {
    /// Name and version of the format.
    schema: &'static str,
    /// Name of the switch.
    pub(super) name: String,
    /// Threshold of the nominal switch, N.
    pub(super) threshold_n: f64,
    /// Law of the threshold and of its derivatives.
    law: &'static str,
    /// Standard deviations within a tolerance.
    deviations_per_tolerance: f64,
    /// Each dimension with its contribution to the scatter.
    pub(super) dimensions: Vec<Contribution>,
    /// Scatter of the threshold to first order.
    pub(super) linear: Linear,
    /// Scatter of the threshold of simulated switches.
    pub(super) simulated: Simulated,
    /// Play of the pins.
    pub(super) play: Play,
    /// Tolerances for the wanted scatter; null without `--scatter`.
    pub(super) allocation: Option<Allotted>,
}

/// Play of a pin in its slot, and how far groove and slot can be apart.
#[derive(Serialize, JsonSchema)]
pub(super) struct Play {
    /// Half of the difference between the widths of slot and pin, mm.
    pub(super) half_mm: f64,
    /// Distance between groove and slot within which 95 % of the pins are with the process, mm.
    pub(super) groove_to_slot_mm: f64,
    /// Largest distance that the drawing allows, mm.
    pub(super) drawing_mm: f64,
}

/// Allotted tolerances, with simulated switches.
#[derive(Serialize, JsonSchema)]
pub(super) struct Allotted {
    /// Method.
    method: &'static str,
    /// Source of the method.
    source: &'static str,
    /// Whether the best processes reach the wanted scatter.
    pub(super) possible: bool,
    /// Tolerances and scatter.
    #[serde(flatten)]
    pub(super) allocation: Allocation,
    /// Simulated switches with these tolerances; `None` if the wanted scatter is not reached.
    pub(super) simulated: Option<Simulated>,
}

const METHOD: &str = "least cost by Lagrange's multiplier, with reciprocal costs";
const METHOD_SOURCE: &str =
    "Loosli, Manufacturing Tolerance Cost Minimization Using Discrete Optimization, ADCATS report 87-4, 1987";

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let design = arguments.source.design()?;
    let measured: Vec<_> = arguments.measured.iter().map(|m| (m.0, m.1)).collect();
    let analysis = Analysis::new(&design, &measured).map_err(|e| arguments.source.refusal(&e))?;
    check_measured(&analysis, &arguments.measured)?;
    let out = arguments.out.as_deref().map(SetFolder::lock).transpose()?;
    let draws = usize::try_from(arguments.draws).unwrap_or(usize::MAX);
    let simulate =
        |tolerances: &[f64]| analysis.simulate(tolerances, draws, arguments.seed).map_err(Failure::failed);
    let allocation = match arguments.scatter {
        None => None,
        Some(scatter) => {
            let allocation = analysis.allocate(scatter.newtons(analysis.threshold_n));
            let simulated = allocation.tolerances.as_deref().map(simulate).transpose()?;
            let possible = allocation.tolerances.is_some();
            Some(Allotted { method: METHOD, source: METHOD_SOURCE, possible, allocation, simulated })
        }
    };
    let of = |dimension| {
        let tolerance = |c: &Contribution| c.link.process.plus_minus;
        analysis.contributions.iter().find(|c| c.link.dimension == dimension).map_or(0.0, tolerance)
    };
    let report = Report {
        schema: "pinswitch.tolerances/1",
        name: design.configuration().switch.name.to_string(),
        threshold_n: analysis.threshold_n,
        law: "physics",
        deviations_per_tolerance: DEVIATIONS_PER_TOLERANCE,
        linear: analysis.linear,
        simulated: simulate(&analysis.process())?,
        play: Play {
            half_mm: design.configuration().support.slot_clearance_mm / 2.0,
            groove_to_slot_mm: NORMAL_95 / DEVIATIONS_PER_TOLERANCE
                * [ChainDimension::GroovePosition, ChainDimension::SlotPosition]
                    .map(|dimension| of(dimension).powi(2))
                    .iter()
                    .sum::<f64>()
                    .sqrt(),
            drawing_mm: [ChainDimension::GroovePosition, ChainDimension::SlotPosition]
                .map(|dimension| link(&design, dimension).drawing)
                .iter()
                .sum(),
        },
        dimensions: analysis.contributions,
        allocation,
    };
    if let Some(out) = out {
        out.replace(&[
            OutputFile { name: "tolerances.csv".to_owned(), bytes: csv(&report).into_bytes() },
            OutputFile { name: "tolerances.json".to_owned(), bytes: to_json(&report)? },
        ])?;
        log::info!("{}: tolerances.csv, tolerances.json", out.folder().display());
    }
    if arguments.json {
        print_json(&report)?
    } else {
        print_text(&table(&report))?
    }
    match report.allocation.as_ref().filter(|allotted| !allotted.possible) {
        None => Ok(()),
        Some(Allotted { allocation, .. }) => Err(Failure::failed(
            Diagnostic::new(
                codes::SCATTER_NOT_REACHED,
                format!(
                    "the best processes reach a scatter of \u{b1}{:.2} N, not \u{b1}{:.2} N",
                    allocation.best_n, allocation.wanted_n
                ),
            )
            .with_location(Location::file("--scatter"))
            .with_help(format!(
                "allow at least {:.2} N, or measure each switch and change its layer",
                (allocation.best_n * 100.0).ceil() / 100.0
            )),
        )),
    }
}

/// Checks that measured tolerances are plausible.
fn check_measured(analysis: &Analysis, measured: &[Measured]) -> Result<(), Failure> {
    for Measured(dimension, value) in measured {
        let nominal = analysis
            .contributions
            .iter()
            .find(|c| c.link.dimension == *dimension)
            .map_or(0.0, |c| c.link.nominal);
        let most = if nominal > 0.0 { MAX_RELATIVE * nominal } else { MAX_POSITION_MM };
        if *value > most {
            return Err(Failure::bad_input(
                Diagnostic::new(
                    codes::OUT_OF_RANGE,
                    format!("the tolerance is above {most} {}", dimension.unit()),
                )
                .with_location(Location::field("--measured", format!("{}={value}", dimension.as_str())))
                .with_help("give the half width of the tolerance, not the dimension"),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_is_newtons_or_a_share() {
        assert_eq!("2.5".parse(), Ok(Scatter::Newtons(2.5)));
        assert_eq!("10%".parse(), Ok(Scatter::Share(0.1)));
        assert_eq!(Scatter::Share(0.1).newtons(20.0), 2.0);
        for text in ["", "%", "0", "-1", "nan", "inf%", "x"] {
            assert!(text.parse::<Scatter>().is_err(), "{text}");
        }
    }

    #[test]
    fn measured_tolerances_have_a_dimension() {
        let parsed = "layer_thickness=0.05".parse();
        assert_eq!(parsed, Ok(Measured(ChainDimension::LayerThickness, 0.05)));
        for text in ["layer_thickness", "layer_thickness=x", "layer_thickness=-1", "no_such=1"] {
            assert!(text.parse::<Measured>().is_err(), "{text}");
        }
    }
}
