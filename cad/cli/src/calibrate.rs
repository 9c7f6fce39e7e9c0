//! `pinswitch calibrate TABLE --out DIR`.

mod plans;
mod recorded;
mod summary;
mod waiting;

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::effects::{Vocabulary, own_effects_text};
use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{
    Calibration, ModelFile, SessionPlan, SessionReport, calibrate_among, calibrate_below, explain_published,
};

use super::own_effects::OwnEffects;
use super::{Failure, print};
use crate::input::was_read;
use crate::write::write_set;
use pinswitch_report::{UNEXPLAINED, page, plots, published_page, published_plot};
use pinswitch_switch::output::OutputFile;
use plans::{plans, with_forms};
use summary::summary;
use waiting::Waiting;

/// Refit the paper's model to a plateau table, trace what it misses to an effect, and report the error before and after.
///
/// The verdict is none, inconclusive, attributed, ambiguous or unattributed; the best model is written for `predict` and `generate`.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch calibrate plateaus.csv --out calibration
  pinswitch calibrate plateaus.csv --effects mine.toml --out calibration
  pinswitch calibrate first.csv second.csv --plan next --out joined")]
pub(super) struct Arguments {
    /// The plateau table (CSV, one row per repetition); several are sessions of one rig, each with offsets, drift and
    /// mounts of its own.
    #[arg(required_unless_present = "published", value_name = "TABLE")]
    tables: Vec<PathBuf>,
    /// Folder for report.json, report.html, residuals.csv, baseline.toml, model.toml and the plots.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Calibrate on the seven maxima printed in the paper instead of a table.
    #[arg(long, conflicts_with_all = ["tables", "fit_below", "own_effects"])]
    published: bool,
    /// Fit only loads up to this percentage of the highest one and judge both models on the rest.
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(10..100))]
    fit_below: Option<u8>,
    /// The folder that `experiment` wrote, by whose runs the second table was recorded: its questions are told with what came of
    /// them. Give another for the third table, and so on.
    #[arg(long, value_name = "DIR", conflicts_with = "published")]
    plan: Vec<PathBuf>,
    #[command(flatten)]
    own: OwnEffects,
}

/// What stands above an effect that was drawn.
const DISCOVERED: &str =
    "# Drawn by `pinswitch calibrate`, not confirmed: give it a name, and let other data decide on it:
#   pinswitch calibrate next.csv --effects discovered.toml --out DIR
";

/// Its file.
pub(super) const FORM: &str = "discovered.toml";

/// Removes the form of an earlier run from the folder: it is none of this one. A file of one's own stays.
pub(super) fn forget_form(folder: &Path) -> Result<(), Failure> {
    let path = folder.join(FORM);
    if was_read(&path) {
        return Err(Failure::bad_input(format!(
            "{}: it was read, and --out would take it away; give --out a folder of its own",
            path.display()
        )));
    }
    if std::fs::read_to_string(&path).is_ok_and(|text| text.starts_with(DISCOVERED)) {
        // What cannot be removed is told of by its first line.
        let _ = std::fs::remove_file(path);
    }
    Ok(())
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.published {
        return published(&arguments.out);
    }
    let vocabulary = with_forms(arguments.own.vocabulary()?, &arguments.plan)?;
    let plans = plans(&arguments.plan, &arguments.tables, &vocabulary)?;
    let (mut table, name) = joined(&arguments.tables)?;
    let sessions = match arguments.tables.split_last() {
        Some((_, before)) if !before.is_empty() => before_the_last(before, &plans, &vocabulary)?,
        _ => Vec::new(),
    };
    let waiting = Waiting::new(table.rows.len());
    let calibration = match arguments.fit_below {
        None => calibrate_among(&table.rows, &vocabulary, Levels::default()),
        Some(percent) => {
            let share = f64::from(percent) / 100.0;
            let calibration = calibrate_below(&table.rows, share, &vocabulary, Levels::default());
            let highest = table.rows.iter().map(|r| r.load_n).fold(0.0, f64::max);
            table.retain(|row| row.load_n <= share * highest);
            calibration
        }
    };
    waiting.end();
    let mut calibration = calibration.map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
    calibration.report.ignored_columns = table.ignored_columns();
    if !sessions.is_empty() {
        let last = so_far(&arguments.tables, &plans, &table, &calibration);
        calibration.report.sessions = sessions.into_iter().chain([last]).collect();
    }
    let mut files = files(&table, &calibration, &name)?;
    if let Some(form) = &calibration.form {
        let text = format!("{DISCOVERED}{}", own_effects_text([&form.definition]));
        files.insert(0, OutputFile { name: FORM.to_owned(), bytes: text.into_bytes() });
    } else {
        forget_form(&arguments.out)?;
    }
    write_set(&arguments.out, &files)?;
    print(summary(&calibration.report).as_bytes())
}

/// The tables as one, and their names for errors.
fn joined(paths: &[PathBuf]) -> Result<(PlateauTable, String), Failure> {
    let mut tables = Vec::new();
    for path in paths {
        let name = path.display().to_string();
        let bytes = crate::input::read_file(path)?;
        let table = PlateauTable::read(bytes.as_slice(), &name).map_err(Failure::bad_input)?;
        tables.push((table, name));
    }
    let names: Vec<&str> = tables.iter().map(|(_, name)| name.as_str()).collect();
    let name = names.join(" + ");
    let table = match tables.len() {
        1 => tables.remove(0).0,
        _ => PlateauTable::joined(tables).map_err(Failure::bad_input)?,
    };
    table.require_baseline(&name).map_err(Failure::bad_input)?;
    Ok((table, name))
}

/// What was known after each table but the last.
fn before_the_last(
    paths: &[PathBuf],
    plans: &[Option<SessionPlan>],
    vocabulary: &Vocabulary,
) -> Result<Vec<SessionReport>, Failure> {
    let until = |count: usize| {
        let paths = &paths[..count];
        let (table, name) = joined(paths)?;
        let found = calibrate_among(&table.rows, vocabulary, Levels::default())
            .map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
        Ok(so_far(paths, plans, &table, &found))
    };
    (1..=paths.len()).map(until).collect()
}

/// What a calibration says after these tables, the last of them recorded by a plan.
fn so_far(
    paths: &[PathBuf],
    plans: &[Option<SessionPlan>],
    table: &PlateauTable,
    calibration: &Calibration,
) -> SessionReport {
    let last = paths.last().map_or_else(String::new, |path| path.display().to_string());
    let highest_n = table.rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
    let plan = paths.len().checked_sub(2).and_then(|nth| plans.get(nth)).cloned().flatten();
    SessionReport {
        asked: plan.map(|asked| asked.answered(&calibration.report, highest_n)),
        ..SessionReport::after(last, &calibration.report)
    }
}

/// The loop on the paper's own numbers.
fn published(out: &Path) -> Result<(), Failure> {
    let all = explain_published();
    let mut text = "explanation          RMS error   layout left out   constants\n".to_owned();
    for e in &all {
        let constants: Vec<String> = e.constants.iter().map(|(n, v)| format!("{n} = {v:.4}")).collect();
        text.push_str(&format!(
            "{:<20} {:>7.1} %   {:>15}   {}\n",
            e.id,
            e.rms_pct,
            e.left_out_rms_pct.map_or("-".to_owned(), |pct| format!("{pct:.1} %")),
            constants.join(", ")
        ));
    }
    let mut json = serde_json::to_vec_pretty(&all).map_err(Failure::failed)?;
    json.push(b'\n');
    let plot = published_plot(&all).map_err(Failure::failed)?;
    let html = published_page(&all, &plot);
    let file = |name: &str, bytes: Vec<u8>| OutputFile { name: name.to_owned(), bytes };
    let files = [
        file("report.html", html.into_bytes()),
        file("maxima.svg", plot.svg.into_bytes()),
        file("published.json", json),
    ];
    text.push_str("unexplained, see report.html:\n");
    UNEXPLAINED.iter().for_each(|open| text.push_str(&format!("  {open}.\n")));
    write_set(out, &files)?;
    print(text.as_bytes())
}

/// Everything that is written, complete in memory before the first file is.
fn files(table: &PlateauTable, calibration: &Calibration, name: &str) -> Result<Vec<OutputFile>, Failure> {
    let (selection, data) = (&calibration.selection, &calibration.data);
    let toml = |fitted| ModelFile::new(fitted, data, selection.noise).to_text().map_err(Failure::failed);
    let mut json = serde_json::to_vec_pretty(&calibration.report).map_err(Failure::failed)?;
    json.push(b'\n');
    let plots = plots(calibration).map_err(Failure::failed)?;
    let title =
        std::path::Path::new(name).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let html = page(&title, calibration, &plots);
    let before: Vec<f64> = selection.baseline.residual_n.clone();
    let after: Vec<f64> = selection.augmented.residual_n.clone();
    let predicted = |r: &[f64]| data.force_n.iter().zip(r).map(|(y, r)| y - r).collect::<Vec<f64>>();
    let residuals = table.with_columns(
        &["baseline_N", "residual_baseline_N", "model_N", "residual_model_N", "weight"],
        &[predicted(&before), before, predicted(&after), after, data.weights.clone()],
        5,
    );
    let mut files = vec![
        OutputFile { name: "report.html".to_owned(), bytes: html.into_bytes() },
        OutputFile { name: "residuals.csv".to_owned(), bytes: residuals.into_bytes() },
        OutputFile { name: "baseline.toml".to_owned(), bytes: toml(&selection.baseline)?.into_bytes() },
        OutputFile { name: "model.toml".to_owned(), bytes: toml(&selection.augmented)?.into_bytes() },
    ];
    files.extend(plots.into_iter().map(|p| OutputFile { name: p.file, bytes: p.svg.into_bytes() }));
    files.push(OutputFile { name: "report.json".to_owned(), bytes: json });
    Ok(files)
}
