//! `pinswitch init NAME`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_switch::templates::{EXAMPLES, RIGS, names};

use super::schema::schema_of_example;
use super::source::read_text;
use super::{Failure, print_data};
use crate::write::write_file;

/// Write a template to a file, to start a configuration from.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch init three-double --out my-switch.toml
  pinswitch init three-double --schema --out my-switch.toml
  pinswitch init effects --out mine.toml
  pinswitch init rig --kind capstan --out rig.toml
  pinswitch init reference")]
pub(super) struct Arguments {
    /// Name of a template. `reference` lists every parameter with its unit, range, default and reason. Starting files
    /// of other kinds: `sweep` for a batch, `configurations` for a table to predict, `effects` for user-defined effects, `plan` for a simulated rig, `run` for
    /// raw logs, `rig` for the limits of a rig, `import` for the columns of a file, `measured` for the readings of a made switch, `request` for a design.
    name: String,
    /// Kind of rig, with the name `rig` [default: the paper's].
    #[arg(long, value_name = "KIND", value_parser = RIGS.map(|(kind, _)| kind))]
    kind: Option<String>,
    /// File to write [default: standard output].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Also write the JSON Schema of the file next to it (my-switch.schema.json), and name it in the first line, so that
    /// an editor completes and checks the values.
    #[arg(long, requires = "out")]
    schema: bool,
    /// Overwrite the files if they exist.
    #[arg(long)]
    force: bool,
}

/// Name of the example that is a CSV; the others are TOML files.
pub(super) const CONFIGURATIONS: &str = "configurations";

/// Commands whose names may be given by mistake, and the kind of file that each needs.
const NEEDS: [(&str, &str); 6] = [
    ("batch", "sweep"),
    ("simulate", "plan"),
    ("power", "plan"),
    ("segment", "run"),
    ("experiment", "rig"),
    ("design", "request"),
];

/// Returns the failure of a name that no template has, with the most similar one.
fn unknown(name: &str) -> Failure {
    let lower = name.to_lowercase();
    let kinds: Vec<&str> = EXAMPLES.iter().map(|starter| starter.0).collect();
    let suggestion = match NEEDS.iter().find(|(command, _)| *command == lower) {
        Some((command, kind)) => format!("`{command}` needs `pinswitch init {kind}`"),
        None => {
            let similarity = |known: &&str| strsim::jaro_winkler(&lower, known);
            let nearest = kinds.iter().copied().chain(names());
            let nearest = nearest.max_by(|a, b| similarity(a).total_cmp(&similarity(b))).unwrap_or_default();
            format!("the nearest is `pinswitch init {nearest}`")
        }
    };
    let help = format!(
        "{suggestion}; the kinds are {}, and `pinswitch layouts` lists the templates",
        kinds.join(", ")
    );
    let problem = "no such template or kind of file";
    Failure::bad_input(
        Diagnostic::new(codes::FILE_NOT_FOUND, problem).with_location(Location::file(name)).with_help(help),
    )
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.name.as_str();
    let kind = arguments.kind.as_deref().and_then(|kind| RIGS.iter().find(|rig| rig.0 == kind));
    if kind.is_some() && name != "rig" {
        let problem =
            Diagnostic::new(codes::USAGE, "only `rig` has kinds").with_location(Location::file("--kind"));
        return Err(Failure::bad_input(problem.with_help("use `pinswitch init rig --kind KIND`")));
    }
    let text = match kind.or_else(|| EXAMPLES.iter().find(|starter| starter.0 == name)) {
        Some((_, text)) => (*text).to_owned(),
        None => match read_text(name) {
            Ok((text, _)) => text,
            Err(_) if !Path::new(name).exists() => return Err(unknown(name)),
            Err(failure) => return Err(failure),
        },
    };
    let Some(path) = &arguments.out else { return print_data(text.as_bytes()) };
    let refused = |path: &Path, code: Code, problem: &str, help: String| {
        let location = Location::file(path.display().to_string());
        Err(Failure::bad_input(Diagnostic::new(code, problem).with_location(location).with_help(help)))
    };
    if path.is_dir() {
        let ending = if name == CONFIGURATIONS { "csv" } else { "toml" };
        let file = path.join(format!("{name}.{ending}"));
        return refused(
            path,
            codes::NOT_A_FILE,
            "is a folder",
            format!("give the name of a file, such as {}", file.display()),
        );
    }
    let schema = if arguments.schema { Some(path.with_extension("schema.json")) } else { None };
    for file in schema.as_deref().into_iter().chain([path.as_path()]) {
        if file.exists() && !arguments.force {
            let help = "give --force to overwrite it".to_owned();
            return refused(file, codes::FILE_IN_THE_WAY, "exists already", help);
        }
    }
    let Some(file) = schema else { return write_file(path, text.as_bytes()).map_err(Failure::from) };
    let Some(content) = schema_of_example(name)? else {
        return refused(path, codes::USAGE, "a CSV has no schema", "omit --schema".to_owned());
    };
    write_file(&file, &content)?;
    let named = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    write_file(path, format!("#:schema ./{named}\n{text}").as_bytes()).map_err(Failure::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_without_a_switch_are_valid() {
        for (kind, text) in RIGS {
            let rig = pinswitch_calibration::experiment::RigLimits::parse(text, kind).unwrap();
            assert!(!rig.silicone && rig.layouts.is_empty() && !rig.plain_wraps_deg.is_empty(), "{kind}");
        }
    }

    #[test]
    fn a_similar_name_is_suggested() {
        for (name, suggestion) in [
            ("rigs", "the nearest is `pinswitch init rig`"),
            ("effect", "the nearest is `pinswitch init effects`"),
            ("Plan", "the nearest is `pinswitch init plan`"),
            ("REFERENCE", "the nearest is `pinswitch init reference`"),
            ("three-dubble", "the nearest is `pinswitch init three-double`"),
            ("power", "`power` needs `pinswitch init plan`"),
            ("Segment", "`segment` needs `pinswitch init run`"),
        ] {
            let failure = unknown(name);
            let [diagnostic] = failure.diagnostics() else { panic!("{failure}") };
            assert_eq!(diagnostic.location(), Some(&Location::file(name)));
            let help = diagnostic.help().unwrap();
            assert!(help.starts_with(suggestion), "{help}");
            assert!(
                help.contains(
                    "the kinds are sweep, configurations, effects, plan, run, rig, import, measured, request,"
                ),
                "{help}"
            );
        }
    }
}
