//! `pinswitch predict CONFIG`.

use clap::Args;

use super::predict_rows::{Rows, SourceUnlessRows};
use super::{Failure, print, print_json};
use crate::output::{curve_of, friction_csv};

/// Predict the friction curve of a configuration, without making parts.
///
/// The curve carries its law, its band, and one word on how far to trust it: published, interpolated or extrapolated.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch predict three-double
  pinswitch predict three-double --set layout.pins=[4,8,12] --json")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: SourceUnlessRows,
    #[command(flatten)]
    rows: Rows,
    /// Print JSON instead of CSV.
    #[arg(long)]
    json: bool,
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
    let curve = curve_of(&design, design.contact());
    for reason in &curve.reasons {
        log::info!("{reason}");
    }
    if arguments.json { print_json(&curve) } else { print(friction_csv(&curve).as_bytes()) }
}
