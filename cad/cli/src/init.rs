//! `pinswitch init NAME`.

use std::path::PathBuf;

use clap::Args;

use super::source::read_text;
use super::{Failure, print};
use crate::write::write_file;
use pinswitch_switch::templates::STARTERS;

/// Write a template out, to start a configuration of your own.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch init three-double --out my-switch.toml
  pinswitch init effects --out mine.toml
  pinswitch init reference")]
pub(super) struct Arguments {
    /// Name of a template; `reference` shows every parameter with its unit, range, default and reason. `sweep` starts a
    /// batch, `effects` effects of your own, `plan` a simulated rig, `run` the description of raw logs, `rig` what a rig can do.
    name: String,
    /// File to write; without it the template goes to standard output.
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite the file if it exists.
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.name.as_str();
    let text = match STARTERS.iter().find(|starter| starter.0 == name) {
        Some((_, text)) => (*text).to_owned(),
        None => read_text(name)?.0,
    };
    let Some(path) = &arguments.out else { return print(text.as_bytes()) };
    if path.is_dir() {
        let file = path.join(format!("{}.toml", arguments.name));
        return Err(Failure::bad_input(format!(
            "{}: is a folder; give the name of a file, such as {}",
            path.display(),
            file.display()
        )));
    }
    if path.exists() && !arguments.force {
        return Err(Failure::bad_input(format!("{}: exists; give --force to overwrite it", path.display())));
    }
    write_file(path, text.as_bytes()).map_err(Failure::from)
}
