//! `pinswitch predict CONFIG`.

use clap::Args;
use pinswitch_friction::FrictionCurve;
use serde::Serialize;

use super::calibrated_curve::calibrated_curve;
use super::law::{LawChoice, side_by_side};
use super::predict_rows::{Rows, SourceUnlessRows};
use super::{Failure, print, print_json};
use pinswitch_switch::documents::friction_csv;
use pinswitch_switch::prediction::Prediction;

/// Predict the friction curve of a configuration, without making parts.
///
/// The curve carries its law, its band, and one word on how far to trust it: published, interpolated or extrapolated.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch predict three-double
  pinswitch predict three-double --set layout.pins=[4,8,12] --json
  pinswitch predict three-double --law physics")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: SourceUnlessRows,
    #[command(flatten)]
    rows: Rows,
    #[command(flatten)]
    law: LawChoice,
    /// Print JSON instead of CSV; the other laws' curves stand beside it under other_laws.
    #[arg(long)]
    json: bool,
}

/// The curve, and those of other laws for comparison.
#[derive(Serialize)]
struct Output {
    #[serde(flatten)]
    curve: FrictionCurve,
    other_laws: Vec<FrictionCurve>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(outcome) = arguments.rows.run() {
        return outcome;
    }
    let source = arguments.source.0.as_ref().ok_or_else(|| {
        Failure::bad_input(
            "predict needs a configuration, or --model and --rows; see pinswitch predict --help",
        )
    })?;
    let design = source.design()?;
    let Prediction { curve, others } = match &arguments.rows.model {
        Some(model) => Prediction::with_curve(&design, calibrated_curve(&design, model)?),
        None => arguments.law.prediction(&design)?,
    };
    log::info!("{}", side_by_side(&curve, &others));
    for reason in &curve.reasons {
        log::info!("{reason}");
    }
    if arguments.json {
        print_json(&Output { curve, other_laws: others })
    } else {
        print(friction_csv(&curve).as_bytes())
    }
}
