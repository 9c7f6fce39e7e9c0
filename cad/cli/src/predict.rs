//! `pinswitch predict CONFIG`.

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::FrictionCurve;
use pinswitch_switch::documents::friction_csv;
use pinswitch_switch::prediction::Prediction;
use schemars::JsonSchema;
use serde::Serialize;

use super::as_measured::{self, AsMeasured};
use super::calibrated_curve::calibrated_curve;
use super::law::{LawChoice, compare_laws};
use super::predict_rows::{Rows, SourceUnlessRows};
use super::{Failure, print_data, print_json};

/// Predict the friction curve of a configuration, or of every row of a table, without making parts.
///
/// A curve has a law, a 95 % band and a status: published, interpolated or extrapolated. With --rows, each row of a CSV or
/// Parquet table changes the configuration, and all curves become one table.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch predict three-double
  pinswitch predict three-double --set layout.pins=[4,8,12] --json
  pinswitch predict three-double --law physics
  pinswitch predict three-double --rows configurations.csv --out curves.parquet
  pinswitch predict --model model.toml --rows plateaus.csv --out predicted.csv")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: SourceUnlessRows,
    #[command(flatten)]
    rows: Rows,
    #[command(flatten)]
    law: LawChoice,
    #[command(flatten)]
    measured: AsMeasured,
    /// Print JSON instead of CSV, with the curves of the other laws under other_laws.
    #[arg(long)]
    json: bool,
}

/// The curve, and the curves of the other laws for comparison.
#[derive(Serialize, JsonSchema)]
pub(super) struct Output {
    /// The curve.
    #[serde(flatten)]
    curve: FrictionCurve,
    /// Curves of the other laws that apply, at fewer loads.
    other_laws: Vec<FrictionCurve>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(outcome) = arguments.rows.run(arguments.source.0.as_ref(), &arguments.law) {
        return outcome;
    }
    let source = arguments.source.0.as_ref().ok_or_else(|| {
        Failure::bad_input(
            Diagnostic::new(codes::USAGE, "no configuration and no rows")
                .with_help("give a configuration, or --model and --rows; see `pinswitch predict --help`"),
        )
    })?;
    let design = source.design()?;
    let made = arguments.measured.of(&design)?;
    if let Some((_, comparison)) = &made {
        as_measured::report(comparison);
    }
    let Prediction { curve, others } = match &arguments.rows.model {
        _ if made.is_some() => Prediction::of(made.as_ref().map_or(&design, |(made, _)| made)),
        Some(model) => Prediction::with_curve(&design, calibrated_curve(&design, model)?),
        None => arguments.law.prediction(&design)?,
    };
    log::info!("{}", compare_laws(&curve, &others));
    for reason in &curve.reasons {
        log::info!("{reason}");
    }
    if arguments.json {
        print_json(&Output { curve, other_laws: others })
    } else {
        print_data(friction_csv(&curve).as_bytes())
    }
}
