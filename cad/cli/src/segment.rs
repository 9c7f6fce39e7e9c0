//! `pinswitch segment RUN.toml --out plateaus.csv`.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use flate2::read::MultiGzDecoder;
use pinswitch_calibration::segmentation::{Log, RunPlan, Segmented, SeriesPlan, segment};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use serde::Serialize;

use super::{Failure, print};
use crate::write::write_set;
use pinswitch_plot::log_svg;
use pinswitch_switch::set::OutputFile;

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
    /// Leave out the SVG of each log.
    #[arg(long)]
    no_plots: bool,
}

/// Findings of one log, as they are written.
#[derive(Serialize)]
struct Entry<'a> {
    file: &'a str,
    eccentric: usize,
    concentric: usize,
    findings: &'a [pinswitch_calibration::segmentation::Finding],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.run.display().to_string();
    let text =
        std::fs::read_to_string(&arguments.run).map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
    let plan = RunPlan::parse(&text, &name).map_err(Failure::bad_input)?;
    let folder = arguments.run.parent().unwrap_or_else(|| Path::new("."));
    let stem =
        arguments.out.file_stem().map_or_else(|| "plateaus".into(), |s| s.to_string_lossy().into_owned());
    let (mut rows, mut files, mut report, mut summary) = (Vec::new(), Vec::new(), Vec::new(), String::new());
    let mut start_s = 0.0;
    for (index, series) in plan.series.iter().enumerate() {
        let path = folder.join(&series.file);
        let bytes = read_log(&path)?;
        let log = Log::parse(&bytes, &path.display().to_string()).map_err(Failure::bad_input)?;
        let found = segment(&log, &plan.rig);
        rows.extend(plateau_rows(&plan, series, index, &found, start_s));
        start_s += log.time_s.last().copied().unwrap_or(0.0);
        let count = |concentric: bool| {
            found.plateaus.iter().filter(|p| (p.direction.sign() > 0.0) == concentric).count()
        };
        let entry = Entry {
            file: &series.file,
            eccentric: count(false),
            concentric: count(true),
            findings: &found.findings,
        };
        summary.push_str(&format!(
            "{}: {} eccentric, {} concentric",
            series.file, entry.eccentric, entry.concentric
        ));
        for finding in &found.findings {
            summary.push_str(&format!("; {finding}"));
        }
        summary.push('\n');
        report.push(serde_json::to_value(&entry).map_err(Failure::failed)?);
        if !arguments.no_plots {
            let svg = log_svg(&series.file, &log, &found).map_err(Failure::failed)?;
            let log_stem =
                series.file.trim_end_matches(".gz").trim_end_matches(".csv").replace(['/', '\\'], "-");
            files.push(OutputFile { name: format!("{stem}-{log_stem}.svg"), bytes: svg.into_bytes() });
        }
    }
    if rows.is_empty() {
        return Err(Failure::bad_input(format!(
            "{name}: no plateau in any log; power_W must exceed 2 W while the actuator runs"
        )));
    }
    let mut json = serde_json::to_vec_pretty(&serde_json::json!({
        "schema": "pinswitch.segmentation/1", "series": report,
    }))
    .map_err(Failure::failed)?;
    json.push(b'\n');
    files.push(OutputFile { name: format!("{stem}.json"), bytes: json });
    let table =
        arguments.out.file_name().map_or_else(|| "plateaus.csv".into(), |n| n.to_string_lossy().into_owned());
    files.push(OutputFile { name: table, bytes: PlateauTable::write(&rows).into_bytes() });
    let out = arguments.out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    write_set(out, &files).map_err(Failure::failed)?;
    print(summary.as_bytes())
}

/// The bytes of a log, unpacked if its name ends in `.gz`.
fn read_log(path: &Path) -> Result<Vec<u8>, Failure> {
    let bad = |e: std::io::Error| Failure::bad_input(format!("{}: {e}", path.display()));
    let raw = std::fs::read(path).map_err(bad)?;
    if path.extension().is_none_or(|e| e != "gz") {
        return Ok(raw);
    }
    let mut text = Vec::new();
    MultiGzDecoder::new(raw.as_slice()).read_to_end(&mut text).map_err(bad)?;
    Ok(text)
}

fn plateau_rows(
    plan: &RunPlan,
    series: &SeriesPlan,
    index: usize,
    found: &Segmented,
    start_s: f64,
) -> Vec<PlateauRow> {
    found
        .plateaus
        .iter()
        .map(|p| PlateauRow {
            series: index.to_string(),
            substrate: series.substrate,
            pins: series.pins.clone(),
            sweep: series.sweep,
            load_mass_g: series.load_mass_g,
            load_n: series.load_n(&plan.rig),
            speed_pct: series.speed_pct,
            dwell_s: plan.rig.dwell_s,
            direction: p.direction,
            repetition: p.repetition,
            position_mm: p.position_mm,
            time_s: start_s + p.time_s,
            force_n: p.force_n,
            wrap_angle_deg: plan.rig.wrap_angle_deg,
        })
        .collect()
}
