//! `pinswitch schema`.

use clap::{Args, ValueEnum};
use pinswitch_switch::{config, measured};

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
    /// The readings of a made switch, as for `--measured`.
    Measured,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    print_json(&match arguments.kind {
        Kind::Configuration => config::json_schema(),
        Kind::Measured => measured::json_schema(),
    })
}
