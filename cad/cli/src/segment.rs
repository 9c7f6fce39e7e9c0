//! `pinswitch segment RUN.toml --out plateaus.csv`.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::read::MultiGzDecoder;
use pinswitch_calibration::segmentation::{RunPlan, RunSegmentation, SegmentedRun};
use pinswitch_calibration::table::PlateauTable;

use super::{Failure, print};
use crate::write::write_set;
use pinswitch_report::log_svg;
use pinswitch_switch::config::Name;
use pinswitch_switch::output::OutputFile;

/// Turn raw 200 Hz logs into a plateau table, and list what is wrong with each log.
///
/// Beside the table: a JSON file with the findings, and one SVG per log with its plateaus marked.
#[derive(Args, Debug)]
#[command(after_help = "Example: pinswitch segment run.toml --out plateaus.csv")]
pub(super) struct Arguments {
    /// The description of the run; its logs lie beside it.
    run: PathBuf,
    /// Where the plateau table goes.
    #[arg(long, value_name = "CSV")]
    out: PathBuf,
    /// Let the description name logs outside its own folder.
    #[arg(long)]
    read_outside: bool,
    /// Leave out the SVG of each log.
    #[arg(long)]
    no_plots: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.run.display().to_string();
    let text = crate::input::read_text_file(&arguments.run)?;
    let plan = RunPlan::parse(&text, &name).map_err(Failure::bad_input)?;
    let folder = arguments.run.parent().unwrap_or_else(|| Path::new("."));
    let stem =
        arguments.out.file_stem().map_or_else(|| "plateaus".into(), |s| s.to_string_lossy().into_owned());
    let (mut run, mut files) = (RunSegmentation::new(&plan), Vec::new());
    for series in &plan.series {
        let path = folder.join(&series.file);
        if !arguments.read_outside && lies_outside(&path, folder) {
            return Err(Failure::bad_input(format!(
                "{name}: series.file = {:?} lies outside the folder of the description; copy it beside, or allow it with \
                 --read-outside",
                series.file
            )));
        }
        let (log, found) =
            run.add(series, &read_log(&path)?, &path.display().to_string()).map_err(Failure::bad_input)?;
        if !arguments.no_plots {
            let svg = log_svg(&series.file, &log, &found).map_err(Failure::failed)?;
            let log_stem =
                series.file.trim_end_matches(".gz").trim_end_matches(".csv").replace(['/', '\\'], "-");
            // A log is named by a path; its figure is a file beside the table.
            let mut name = format!("{}.svg", Name::cleaned(&format!("{stem}-{log_stem}")));
            if files.iter().any(|file: &OutputFile| file.name == name) {
                name = format!("{}.svg", Name::cleaned(&format!("{}-{stem}-{log_stem}", files.len() + 1)));
            }
            files.push(OutputFile { name, bytes: svg.into_bytes() });
        }
    }
    let SegmentedRun { rows, report } = run.finish(&name).map_err(Failure::bad_input)?;
    // Through a value, whose keys are sorted: the bytes of the report before it had a type.
    let value = serde_json::to_value(&report).map_err(Failure::failed)?;
    let mut json = serde_json::to_vec_pretty(&value).map_err(Failure::failed)?;
    json.push(b'\n');
    files.push(OutputFile { name: format!("{stem}.json"), bytes: json });
    let table =
        arguments.out.file_name().map_or_else(|| "plateaus.csv".into(), |n| n.to_string_lossy().into_owned());
    files.push(OutputFile { name: table, bytes: PlateauTable::write(&rows).into_bytes() });
    let out = arguments.out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    write_set(out, &files)?;
    let summary: String = report.series.iter().map(|series| format!("{series}\n")).collect();
    print(summary.as_bytes())
}

/// Whether the existing file `path` is neither in `folder` nor below, once links are followed.
fn lies_outside(path: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let both = path.canonicalize().ok().zip(folder.canonicalize().ok());
    both.is_some_and(|(path, folder)| !path.starts_with(folder))
}

/// Most bytes of a log, unpacked: a day at 200 Hz and 25 bytes a line is 430 MB.
const MAX_LOG: u64 = 1 << 29;

/// The bytes of a log, unpacked if its name ends in `.gz`.
fn read_log(path: &Path) -> Result<Vec<u8>, Failure> {
    let raw = crate::input::read_file(path)?;
    if path.extension().is_none_or(|e| e != "gz") {
        return Ok(raw);
    }
    let mut text = Vec::new();
    let unpacked = MultiGzDecoder::new(raw.as_slice()).take(MAX_LOG + 1).read_to_end(&mut text);
    let name = path.display();
    unpacked.map_err(|e| Failure::bad_input(format!("{name}: {e}; give a whole file, packed by gzip")))?;
    if text.len() as u64 > MAX_LOG {
        let remedy = "give a log of one session";
        return Err(Failure::bad_input(format!("{name}: unpacks to more than {MAX_LOG} bytes; {remedy}")));
    }
    Ok(text)
}
