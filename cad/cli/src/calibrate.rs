//! `pinswitch calibrate TABLE --out DIR`.

mod plan_match;
mod plans;
mod spinner;
mod summary;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{
    Calibration, ExternalInput, ProvenanceReport, SessionPlan, SessionReport, calibrate, calibrate_below,
    explain_published,
};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_report::{
    DATA_PACKAGE, FORM_FILE, FORM_HEADER, UNEXPLAINED, calibration_files, data_package, published_page,
    published_plot,
};
use pinswitch_switch::output::OutputFile;

use super::data_package::has_own_descriptor;
use super::terminal::to_json;
use super::user_effects::UserEffects;
use super::{Failure, SEED, print_json, print_text};
use crate::input::{InputFile, files_read, was_read};
use crate::write::SetFolder;
use plans::{plans, with_forms};
use spinner::Spinner;
use summary::summary;

/// Refit the paper's model to a plateau table and infer the effects that it lacks.
///
/// Reports the probability of each effect, the held-out error with and without them, and the expected error of a new
/// session. The verdict is none, inconclusive, attributed, ambiguous or unattributed. Writes the best model for
/// `predict` and `generate`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch calibrate plateaus.csv --out calibration
  pinswitch calibrate plateaus.csv --effects mine.toml --out calibration
  pinswitch calibrate first.csv second.csv --plan next --out joined
  pinswitch calibrate plateaus.csv --out calibration --json")]
pub(super) struct Arguments {
    /// Plateau table (CSV, one row per repetition). Several tables are sessions of one rig, each with its own offsets,
    /// drift and mounts.
    #[arg(required_unless_present = "published", value_name = "TABLE")]
    tables: Vec<PathBuf>,
    /// Folder for report.json, report.html, residuals.csv, baseline.toml, model.toml, provenance.json,
    /// datapackage.json and the plots.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Calibrate on the seven maxima of the paper instead of a table.
    #[arg(long, conflicts_with_all = ["tables", "fit_below", "user_effects"])]
    published: bool,
    /// Fit the loads up to this percentage of the highest one, and test both models on the others.
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(10..100))]
    fit_below: Option<u8>,
    /// Plan that the second table followed: the folder written by `experiment`. The report then answers the
    /// questions of the plan. Repeat it for the third table, and so on.
    #[arg(long, value_name = "DIR", conflicts_with = "published")]
    plan: Vec<PathBuf>,
    #[command(flatten)]
    effects: UserEffects,
    /// Print report.json (with --published: published.json) instead of a summary.
    #[arg(long)]
    json: bool,
}

/// Name of this command in a manifest.
const COMMAND: &str = "calibrate";
/// Refuses a folder whose form was read as input: a later step would remove it.
pub(super) fn check_stale_form(folder: &Path) -> Result<(), Failure> {
    let path = folder.join(FORM_FILE);
    if was_read(&path) {
        return Err(Failure::bad_input(
            Diagnostic::new(codes::OUTPUT_IS_INPUT, "the file is an input, and --out would remove it")
                .with_location(Location::file(path.display().to_string()))
                .with_help("give another folder with --out"),
        ));
    }
    Ok(())
}

/// Returns the name of the form of an earlier run, if the folder contains one. A file that a user has edited at its
/// begin stays.
pub(super) fn stale_form(folder: &SetFolder) -> Result<&'static [&'static str], Failure> {
    let existing = folder.existing(FORM_FILE)?;
    let is_stale = existing.is_some_and(|bytes| bytes.starts_with(FORM_HEADER.as_bytes()));
    Ok(if is_stale { &[FORM_FILE] } else { &[] })
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.published {
        return published(arguments);
    }
    // Locked before the work, which may take minutes.
    let out = SetFolder::lock(&arguments.out)?;
    has_own_descriptor(&out, COMMAND)?;
    let vocabulary = with_forms(arguments.effects.vocabulary()?, &arguments.plan)?;
    let plans = plans(&arguments.plan, &arguments.tables, &vocabulary)?;
    let (mut table, name) = joined(&arguments.tables)?;
    let sessions = match arguments.tables.split_last() {
        Some((_, earlier)) if !earlier.is_empty() => earlier_sessions(earlier, &plans, &vocabulary)?,
        _ => Vec::new(),
    };
    let spinner = Spinner::new(table.rows.len());
    let calibration = match arguments.fit_below {
        None => calibrate(&table.rows, &vocabulary, SEED),
        Some(percent) => {
            let share = f64::from(percent) / 100.0;
            let calibration = calibrate_below(&table.rows, share, &vocabulary, SEED);
            let highest = table.rows.iter().map(|r| r.load_n).fold(0.0, f64::max);
            table.retain(|row| row.load_n <= share * highest);
            calibration
        }
    };
    spinner.end();
    let mut calibration =
        calibration.map_err(|e| Failure::bad_input(Diagnostic::from(e).or_in_file(&name)))?;
    calibration.report.ignored_columns = table.ignored_columns();
    calibration.report.provenance = Some(provenance());
    if !sessions.is_empty() {
        let last = session_report(&arguments.tables, &plans, &table, &calibration);
        calibration.report.sessions = sessions.into_iter().chain([last]).collect();
    }
    let mut files = files(&table, &calibration, &name)?;
    let stale = if calibration.form.is_some() {
        &[]
    } else {
        check_stale_form(&arguments.out)?;
        stale_form(&out)?
    };
    let contents: Vec<_> = files.iter().map(|file| (file.name.clone(), file.bytes.clone())).collect();
    let (package, bytes) = data_package(&title_of(&name), &sources(), &contents).map_err(Failure::failed)?;
    files.insert(0, OutputFile { name: package, bytes });
    out.replace_listed(&files, COMMAND, stale)?;
    if arguments.json { print_json(&calibration.report) } else { print_text(&summary(&calibration.report)) }
}

/// Returns name and SHA-256 of each file that this command has read.
fn sources() -> BTreeSet<(String, String)> {
    let named = |(path, input): (PathBuf, InputFile)| {
        Some((path.file_name()?.to_string_lossy().into_owned(), input.sha256))
    };
    files_read().into_iter().filter_map(named).collect()
}

/// Returns the external ones of the files that this command has read.
fn provenance() -> ProvenanceReport {
    let input = |(path, input): (PathBuf, InputFile)| {
        let file = path.file_name()?.to_string_lossy().into_owned();
        input.is_external.then_some(ExternalInput { file, sha256: input.sha256 })
    };
    let mut external: Vec<_> = files_read().into_iter().filter_map(input).collect();
    external.sort_by(|a, b| (&a.file, &a.sha256).cmp(&(&b.file, &b.sha256)));
    ProvenanceReport { external }
}

/// Reads and joins the tables; also returns their names for errors.
fn joined(paths: &[PathBuf]) -> Result<(PlateauTable, String), Failure> {
    let bad_input = Failure::bad_input;
    let mut tables = Vec::new();
    for path in paths {
        let name = path.display().to_string();
        let bytes = crate::input::read_file(path)?;
        let table = PlateauTable::read(bytes.as_slice(), &name).map_err(bad_input)?;
        tables.push((table, name));
    }
    let names: Vec<&str> = tables.iter().map(|(_, name)| name.as_str()).collect();
    let name = names.join(" + ");
    let table = match tables.len() {
        1 => tables.remove(0).0,
        _ => PlateauTable::joined(tables).map_err(bad_input)?,
    };
    table.require_baseline(&name).map_err(bad_input)?;
    Ok((table, name))
}

/// Calibrates the first table, the first two, and so on, and reports each result.
fn earlier_sessions(
    paths: &[PathBuf],
    plans: &[Option<SessionPlan>],
    vocabulary: &Vocabulary,
) -> Result<Vec<SessionReport>, Failure> {
    let until = |count: usize| {
        let paths = &paths[..count];
        let (table, name) = joined(paths)?;
        let calibration = calibrate(&table.rows, vocabulary, SEED)
            .map_err(|e| Failure::bad_input(Diagnostic::from(e).or_in_file(&name)))?;
        Ok(session_report(paths, plans, &table, &calibration))
    };
    (1..=paths.len()).map(until).collect()
}

/// Returns the result after these tables, with the answers to the plan of the last one.
fn session_report(
    paths: &[PathBuf],
    plans: &[Option<SessionPlan>],
    table: &PlateauTable,
    calibration: &Calibration,
) -> SessionReport {
    let last = paths.last().map_or_else(String::new, |path| path.display().to_string());
    let highest_n = table.rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
    let plan = paths.len().checked_sub(2).and_then(|nth| plans.get(nth)).cloned().flatten();
    SessionReport {
        asked: plan.map(|plan| plan.answered(&calibration.report, highest_n)),
        ..SessionReport::after(last, &calibration.report)
    }
}

/// Calibrates on the maxima of the paper.
fn published(arguments: &Arguments) -> Result<(), Failure> {
    let all = explain_published();
    let mut text = format!(
        "{:<20} {:>14}   {:>25}   constants\n",
        "explanation", "in-sample RMSE", "leave-one-layout-out RMSE"
    );
    for e in &all {
        let constants: Vec<String> = e.constants.iter().map(|(n, v)| format!("{n} = {v:.4}")).collect();
        text.push_str(&format!(
            "{:<20} {:>12.1} %   {:>25}   {}\n",
            e.id,
            e.rms_pct,
            e.left_out_rms_pct.map_or("-".to_owned(), |pct| format!("{pct:.1} %")),
            constants.join(", ")
        ));
    }
    let plot = published_plot(&all).map_err(Failure::failed)?;
    let html = published_page(&all, &plot);
    let file = |name: &str, bytes: Vec<u8>| OutputFile { name: name.to_owned(), bytes };
    let files = [
        file("report.html", html.into_bytes()),
        file("maxima.svg", plot.svg.into_bytes()),
        file("published.json", to_json(&all)?),
    ];
    text.push_str("unexplained, see report.html:\n");
    UNEXPLAINED.iter().for_each(|open| text.push_str(&format!("  {open}.\n")));
    let out = SetFolder::lock(&arguments.out)?;
    let stale: &[&str] = if has_own_descriptor(&out, COMMAND)? { &[DATA_PACKAGE] } else { &[] };
    out.replace_listed(&files, COMMAND, stale)?;
    if arguments.json { print_json(&all) } else { print_text(&text) }
}

/// Returns the name of a table without its folder.
fn title_of(name: &str) -> String {
    Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// Makes every file in memory, before the first one is written.
fn files(table: &PlateauTable, calibration: &Calibration, name: &str) -> Result<Vec<OutputFile>, Failure> {
    let files = calibration_files(&title_of(name), table, calibration).map_err(Failure::failed)?;
    let mut files: Vec<OutputFile> =
        files.into_iter().map(|(name, bytes)| OutputFile { name, bytes }).collect();
    files.push(OutputFile { name: "report.json".to_owned(), bytes: to_json(&calibration.report)? });
    Ok(files)
}
