//! `pinswitch segment RUN.toml --out plateaus.csv`.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::read::MultiGzDecoder;
use pinswitch_calibration::segmentation::{RunPlan, RunSegmentation, SegmentedRun};
use pinswitch_calibration::table::PlateauTable;
use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_import::Map;
use pinswitch_report::log_svg;
use pinswitch_switch::config::Name;
use pinswitch_switch::output::OutputFile;

use super::terminal::to_json;
use super::{Failure, print_data, print_text};
use crate::write::SetFolder;

/// Convert raw logs to a plateau table.
///
/// Prints the faults of each log. Also writes, next to the table, a JSON file with the faults, one SVG per log with its
/// plateaus marked, and provenance.json.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch segment run.toml --out plateaus.csv
  pinswitch segment run.toml --no-plots --out plateaus.csv --json")]
pub(super) struct Arguments {
    /// Description of the run, in the folder of its logs.
    run: PathBuf,
    /// File for the plateau table.
    #[arg(long, value_name = "CSV")]
    out: PathBuf,
    /// Allow logs outside the folder of the description.
    #[arg(long)]
    read_outside: bool,
    /// Write no SVG files.
    #[arg(long)]
    no_plots: bool,
    /// Print the JSON file instead of a summary.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.run.display().to_string();
    let text = crate::input::read_text_file(&arguments.run)?;
    let plan = RunPlan::parse(&text, &name).map_err(Failure::bad_input)?;
    let folder = arguments.run.parent().unwrap_or_else(|| Path::new("."));
    let map = plan.map.as_ref().map(|file| read_map(&folder.join(file))).transpose()?;
    let stem =
        arguments.out.file_stem().map_or_else(|| "plateaus".into(), |s| s.to_string_lossy().into_owned());
    let (mut run, mut files) = (RunSegmentation::new(&plan), Vec::new());
    for series in &plan.series {
        let mut logs = Vec::new();
        for file in series.file_names() {
            let path = folder.join(file);
            if !arguments.read_outside && is_outside(&path, folder) {
                let location = Location::file(&name).with_field("series.file", format!("{file:?}"));
                return Err(Failure::bad_input(
                    Diagnostic::new(
                        codes::OUTSIDE_THE_FOLDER,
                        "the log is outside the folder of the description",
                    )
                    .with_location(location)
                    .with_help("copy it into the folder, or allow it with --read-outside"),
                ));
            }
            let (bytes, name) = (read_log(&path)?, path.display().to_string());
            let bytes = match &map {
                Some(map) => map.read_log(&bytes, &name).map_err(Failure::bad_input)?.to_csv().into_bytes(),
                None => bytes,
            };
            logs.push((bytes, name));
        }
        let (log, segmented) = run.add(series, &logs).map_err(Failure::bad_input)?;
        if !arguments.no_plots {
            let svg = log_svg(series.name(), &log, &segmented).map_err(Failure::failed)?;
            let log_stem =
                series.name().trim_end_matches(".gz").trim_end_matches(".csv").replace(['/', '\\'], "-");
            // The name of a log may be a path; its figure is a file next to the table.
            let mut name = format!("{}.svg", Name::cleaned(&format!("{stem}-{log_stem}")));
            if files.iter().any(|file: &OutputFile| file.name == name) {
                name = format!("{}.svg", Name::cleaned(&format!("{}-{stem}-{log_stem}", files.len() + 1)));
            }
            files.push(OutputFile { name, bytes: svg.into_bytes() });
        }
    }
    let SegmentedRun { rows, report } = run.finish(&name).map_err(Failure::bad_input)?;
    // As a value, whose keys are sorted: readers of the file rely on its bytes.
    let value = serde_json::to_value(&report)
        .map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?;
    let json = to_json(&value)?;
    files.push(OutputFile { name: format!("{stem}.json"), bytes: json.clone() });
    let table =
        arguments.out.file_name().map_or_else(|| "plateaus.csv".into(), |n| n.to_string_lossy().into_owned());
    files.push(OutputFile { name: table, bytes: PlateauTable::write(&rows).into_bytes() });
    let out = arguments.out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    SetFolder::shared(out)?.replace_listed(&files, "segment", &[])?;
    if arguments.json {
        return print_data(&json);
    }
    let summary: String = report.series.iter().map(|series| format!("{series}\n")).collect();
    print_text(&summary)
}

/// Reads the map with which `import` reads the logs of a machine.
fn read_map(path: &Path) -> Result<Map, Failure> {
    let text = crate::input::read_text_file(path)?;
    Map::parse(&text, &path.display().to_string()).map_err(Failure::bad_input)
}

/// Whether the existing file `path` is outside of `folder`, once links are followed.
fn is_outside(path: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let both = path.canonicalize().ok().zip(folder.canonicalize().ok());
    both.is_some_and(|(path, folder)| !path.starts_with(folder))
}

/// Longest log in bytes, unpacked: a day at 200 Hz and 25 bytes a line is 430 MB.
const MAX_LOG: u64 = 1 << 29;

/// Reads a log, and unpacks it if its name ends in `.gz`.
///
/// # Errors
/// [`Failure::bad_input`] if it cannot be read or unpacked, or is too long.
fn read_log(path: &Path) -> Result<Vec<u8>, Failure> {
    let raw = crate::input::read_file(path)?;
    if path.extension().is_none_or(|e| e != "gz") {
        return Ok(raw);
    }
    let refused = |code: Code, problem: String, help: &str| {
        Diagnostic::new(code, problem)
            .with_location(Location::file(path.display().to_string()))
            .with_help(help)
    };
    let mut text = Vec::new();
    MultiGzDecoder::new(raw.as_slice()).take(MAX_LOG + 1).read_to_end(&mut text).map_err(|e| {
        let problem = refused(codes::DAMAGED_FILE, "cannot unpack".to_owned(), "give a complete gzip file");
        Failure::bad_input(problem.with_source(e))
    })?;
    if text.len() as u64 > MAX_LOG {
        let problem = format!("unpacks to more than {MAX_LOG} bytes");
        return Err(Failure::bad_input(refused(codes::FILE_TOO_LARGE, problem, "give a log of one session")));
    }
    Ok(text)
}
