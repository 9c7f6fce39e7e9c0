//! `pinswitch import SOURCE... --out NAME.csv`.

use std::io::{BufRead, IsTerminal, Read};
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::read::MultiGzDecoder;
use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_import::{Import, Map, Pattern, Source, import_with_pattern};
use pinswitch_switch::output::OutputFile;

use super::terminal::print_line;
use super::{Failure, print_json, print_text};
use crate::write::SetFolder;

/// Largest unpacked file in bytes.
const MAX_UNPACKED: u64 = 1 << 29;
/// Most files of a folder.
const MAX_FILES: usize = 2_000;
/// Ends of the names of files that are read from a folder.
const ENDINGS: [&str; 10] = ["csv", "txt", "tsv", "dat", "lvm", "xlsx", "xls", "ods", "parquet", "gz"];

/// Convert the files of a laboratory to a plateau table or a log.
///
/// Reads text with any delimiter, encoding and decimal sign, LabVIEW measurement files, workbooks
/// and Parquet. Prints what was understood. If a value has two readings, writes nothing and lists
/// the options that decide. Next to the table, writes a map (NAME.import.toml), which repeats the
/// import.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch import rig.csv --out plateaus.csv
  pinswitch import rig.csv --out plateaus.csv --set unit.Load=kg --set wrap_angle_deg=90
  pinswitch import day-1 --out plateaus.csv --pattern '{load_g}g_{trial}.csv'
  pinswitch import next.csv --out next-plateaus.csv --map plateaus.import.toml")]
pub(super) struct Arguments {
    /// Files, or folders with files.
    #[arg(required = true)]
    sources: Vec<PathBuf>,
    /// File for the plateau table or the log.
    #[arg(long, value_name = "CSV", required_unless_present = "dry_run")]
    out: Option<PathBuf>,
    /// Decisions about columns, units and words; `pinswitch init import` writes one with every key
    /// explained.
    #[arg(long, value_name = "TOML")]
    map: Option<PathBuf>,
    /// Set one value of the map, as in --set decimal=comma or --set unit.Kraft=kN; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    assignments: Vec<String>,
    /// Values in the names of files, as in '{load_g}g_{trial}.csv'.
    #[arg(long)]
    pattern: Option<String>,
    /// Print what is understood, and write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Write without confirmation. Open questions are still errors.
    #[arg(long, short)]
    yes: bool,
    /// Print what is understood as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let map = read_map(arguments)?;
    let pattern = arguments.pattern.as_deref().map(Pattern::parse).transpose().map_err(Failure::bad_input)?;
    let files = read_sources(arguments, pattern.as_ref())?;
    let sources: Vec<Source<'_>> = files.iter().map(|(name, bytes)| Source::new(name, bytes)).collect();
    let import = import_with_pattern(&sources, &map, pattern.as_ref()).map_err(Failure::bad_input)?;
    if arguments.json {
        print_json(&import.understanding)?;
    } else {
        print_text(&import.understanding.to_string())?;
    }
    let questions = import.understanding.questions.iter().map(pinswitch_import::Question::to_diagnostic);
    if let Some(failure) = Failure::bad_inputs(questions) {
        return Err(failure);
    }
    if arguments.dry_run || !is_confirmed(arguments)? {
        return Ok(());
    }
    write(arguments, &import)
}

/// Reads the map, and sets the values of the command line in it.
fn read_map(arguments: &Arguments) -> Result<Map, Failure> {
    let mut map = match &arguments.map {
        Some(path) => {
            let text = crate::input::read_text_file(path)?;
            Map::parse(&text, &path.display().to_string()).map_err(Failure::bad_input)?
        }
        None => Map::default(),
    };
    for assignment in &arguments.assignments {
        map.set(assignment).map_err(|diagnostic| {
            Failure::bad_input(diagnostic.or_at(&Location::field("--set", assignment.clone())))
        })?;
    }
    Ok(map)
}

/// Reads the files, and those of folders in the order of their names.
fn read_sources(arguments: &Arguments, pattern: Option<&Pattern>) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut files = Vec::new();
    for source in &arguments.sources {
        if !source.is_dir() {
            files.push(source.clone());
            continue;
        }
        let refused = |code: Code, problem: &str, help: &str| {
            let location = Location::file(source.display().to_string());
            Diagnostic::new(code, problem).with_location(location).with_help(help)
        };
        let entries = std::fs::read_dir(source).map_err(|e| {
            Failure::bad_input(
                refused(codes::CANNOT_READ, "cannot read the folder", "give a folder that can be read")
                    .with_source(e),
            )
        })?;
        let mut found: Vec<PathBuf> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
        found.retain(|path| path.is_file() && is_wanted(path, pattern));
        // Numbers in names count as numbers: 2 before 10.
        found.sort_by_cached_key(|path| natural_key(&file_name(path)));
        if found.is_empty() || found.len() > MAX_FILES {
            let problem = format!("{} files to import, expected 1 to {MAX_FILES}", found.len());
            let help = "name the files, or give --pattern for their names";
            return Err(Failure::bad_input(refused(codes::FILES_DO_NOT_JOIN, &problem, help)));
        }
        files.append(&mut found);
    }
    files.iter().map(|path| Ok((path.display().to_string(), read_unpacked(path)?))).collect()
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn is_wanted(path: &Path, pattern: Option<&Pattern>) -> bool {
    let name = file_name(path);
    match pattern {
        Some(pattern) => pattern.values(&name).is_some(),
        None => path.extension().is_some_and(|e| ENDINGS.iter().any(|ending| e.eq_ignore_ascii_case(ending))),
    }
}

/// Splits a name into texts and numbers, so that names sort as people count.
fn natural_key(name: &str) -> Vec<(u64, String)> {
    let mut key = vec![(0_u64, String::new())];
    for c in name.chars() {
        let last_is_number = key.last().is_some_and(|(_, text)| text.is_empty()) && key.len() > 1;
        match (c.to_digit(10), key.last_mut()) {
            (Some(digit), Some((number, _))) if last_is_number => {
                *number = number.saturating_mul(10).saturating_add(u64::from(digit));
            }
            (Some(digit), _) => key.push((u64::from(digit), String::new())),
            (None, Some((_, text))) => text.push(c),
            (None, None) => {}
        }
    }
    key
}

/// Reads a file, and unpacks it if it is a gzip archive.
fn read_unpacked(path: &Path) -> Result<Vec<u8>, Failure> {
    let raw = crate::input::read_file(path)?;
    if !raw.starts_with(b"\x1f\x8b") {
        return Ok(raw);
    }
    let refused = |code: Code, problem: String, help: &str| {
        Diagnostic::new(code, problem)
            .with_location(Location::file(path.display().to_string()))
            .with_help(help)
    };
    let mut bytes = Vec::new();
    MultiGzDecoder::new(raw.as_slice()).take(MAX_UNPACKED + 1).read_to_end(&mut bytes).map_err(|e| {
        Failure::bad_input(
            refused(codes::DAMAGED_FILE, "cannot unpack".to_owned(), "give a complete gzip file")
                .with_source(e),
        )
    })?;
    if bytes.len() as u64 > MAX_UNPACKED {
        let problem = format!("unpacks to more than {MAX_UNPACKED} bytes");
        return Err(Failure::bad_input(refused(codes::FILE_TOO_LARGE, problem, "divide the file")));
    }
    Ok(bytes)
}

/// Prompts for confirmation on a terminal. Scripts cannot answer: without a terminal, everything is
/// certain here.
fn is_confirmed(arguments: &Arguments) -> Result<bool, Failure> {
    let is_terminal = std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
    if arguments.yes || arguments.json || !is_terminal {
        return Ok(true);
    }
    // Standard output keeps a line without its end back.
    print_line("write this? [y/N]");
    let mut answer = String::new();
    let read = std::io::stdin().lock().read_line(&mut answer);
    read.map_err(|e| {
        Failure::failed(Diagnostic::new(codes::CANNOT_READ, "cannot read the answer").with_source(e))
    })?;
    let is_yes = matches!(answer.trim().to_lowercase().as_str(), "y" | "yes");
    if !is_yes {
        print_line("nothing is written");
    }
    Ok(is_yes)
}

/// Writes the table and its map, both or neither.
fn write(arguments: &Arguments, import: &Import) -> Result<(), Failure> {
    let (Some(out), Some(output)) = (&arguments.out, &import.output) else { return Ok(()) };
    let name = file_name(out);
    let stem = out.file_stem().map_or_else(|| name.clone(), |stem| stem.to_string_lossy().into_owned());
    let files = [
        OutputFile { name: format!("{stem}.import.toml"), bytes: import.map.to_toml().into_bytes() },
        OutputFile { name, bytes: output.to_csv().into_bytes() },
    ];
    let folder = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    SetFolder::shared(folder)?.replace_listed(&files, "import", &[])?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_as_people_count() {
        let mut names = vec!["10kg.csv", "2kg.csv", "a", "1kg_10.csv", "1kg_9.csv"];
        names.sort_by_cached_key(|name| natural_key(name));
        assert_eq!(names, ["1kg_9.csv", "1kg_10.csv", "2kg.csv", "10kg.csv", "a"]);
    }
}
