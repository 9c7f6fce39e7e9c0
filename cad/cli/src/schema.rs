//! `pinswitch schema`.

use clap::{Args, ValueEnum};
use pinswitch_calibration::effects::effects_schema;
use pinswitch_calibration::experiment::RigLimits;
use pinswitch_calibration::segmentation::RunPlan;
use pinswitch_simulation::Plan;
use pinswitch_switch::{config, measured, request};

use super::{Failure, print_json};

/// Print the JSON Schema of a file that you write, for an editor that completes and checks TOML.
///
/// Keep it next to your files, and name it in their first line: `#:schema ./switch.schema.json`.
#[derive(Args, Debug)]
#[command(after_help = "Example: pinswitch schema configuration > switch.schema.json")]
pub(super) struct Arguments {
    /// Kind of file.
    #[arg(value_enum)]
    kind: Kind,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// A configuration, as for `generate`.
    Configuration,
    /// Effects of your own, as for `calibrate --effects`.
    Effects,
    /// A map of an import, as for `import --map`.
    Import,
    /// The readings of a made switch, as for `--measured`.
    Measured,
    /// A synthetic rig, as for `simulate`.
    Plan,
    /// A request, as for `design --request`.
    Request,
    /// The limits of a rig, as for `experiment --rig`.
    Rig,
    /// The logs of a run, as for `segment`.
    Run,
    /// A sweep, as for `batch`.
    Sweep,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.kind {
        Kind::Configuration => print_json(&config::json_schema()),
        Kind::Effects => print_json(&effects_schema()),
        Kind::Import => print_json(&pinswitch_import::map_schema()),
        Kind::Measured => print_json(&measured::json_schema()),
        Kind::Plan => print_json(&schemars::schema_for!(Plan)),
        Kind::Request => print_json(&request::request_schema()),
        Kind::Rig => print_json(&schemars::schema_for!(RigLimits)),
        Kind::Run => print_json(&schemars::schema_for!(RunPlan)),
        Kind::Sweep => print_json(&pinswitch_batch::json_schema()),
    }
}
