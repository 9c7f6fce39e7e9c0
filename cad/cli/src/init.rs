//! `pinswitch init NAME`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::source::read_text;
use super::{Failure, print};
use crate::write::write_file;
use pinswitch_diagnostic::excerpt;
use pinswitch_switch::templates::{EXAMPLES, names};

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

/// Commands by whose names a file may be looked for, and the kind of file that each of them needs.
const NEEDS: [(&str, &str); 5] =
    [("batch", "sweep"), ("simulate", "plan"), ("power", "plan"), ("segment", "run"), ("experiment", "rig")];

/// What to write instead of a name that nothing has.
fn unknown(name: &str) -> Failure {
    let lower = name.to_lowercase();
    let kinds: Vec<&str> = EXAMPLES.iter().map(|starter| starter.0).collect();
    let meant = match NEEDS.iter().find(|(command, _)| *command == lower) {
        Some((command, kind)) => format!("`{command}` needs `pinswitch init {kind}`"),
        None => {
            let likeness = |known: &&str| strsim::jaro_winkler(&lower, known);
            let near = kinds.iter().copied().chain(names());
            let near = near.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or_default();
            format!("the nearest is `pinswitch init {near}`")
        }
    };
    Failure::bad_input(format!(
        "{}: no such template or kind of file; {meant}; the kinds are {}, and `pinswitch layouts` lists the templates",
        excerpt(name, 80),
        kinds.join(", ")
    ))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.name.as_str();
    let text = match EXAMPLES.iter().find(|starter| starter.0 == name) {
        Some((_, text)) => (*text).to_owned(),
        None => match read_text(name) {
            Ok((text, _)) => text,
            Err(_) if !Path::new(name).exists() => return Err(unknown(name)),
            Err(failure) => return Err(failure),
        },
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_of_file_is_found_by_a_name_that_is_near_or_by_its_command() {
        for (name, meant) in [
            ("rigs", "the nearest is `pinswitch init rig`"),
            ("effect", "the nearest is `pinswitch init effects`"),
            ("Plan", "the nearest is `pinswitch init plan`"),
            ("REFERENCE", "the nearest is `pinswitch init reference`"),
            ("three-dubble", "the nearest is `pinswitch init three-double`"),
            ("power", "`power` needs `pinswitch init plan`"),
            ("Segment", "`segment` needs `pinswitch init run`"),
        ] {
            let said = unknown(name).message().to_owned();
            assert!(said.starts_with(name) && said.contains(meant), "{said}");
            assert!(said.contains("the kinds are sweep, effects, plan, run, rig"), "{said}");
        }
    }
}
