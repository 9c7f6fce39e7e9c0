//! `pinswitch calibrate TABLE --out DIR`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{
    Calibration, ModelFile, Report, Verdict, calibrate, calibrate_below, explain_published,
};

use super::{Failure, print};
use crate::write::write_set;
use pinswitch_plot::{UNEXPLAINED, page, plots, published_page, published_plot};
use pinswitch_switch::output::OutputFile;

/// Refit the paper's model to a plateau table, trace what it misses to an effect, and report the error before and after.
///
/// The verdict is none, attributed, ambiguous or unattributed; the best model is written for `predict` and `generate`.
#[derive(Args, Debug)]
#[command(after_help = "Example: pinswitch calibrate plateaus.csv --out calibration")]
pub(super) struct Arguments {
    /// The plateau table (CSV, one row per repetition).
    #[arg(required_unless_present = "published")]
    table: Option<PathBuf>,
    /// Folder for report.json, report.html, residuals.csv, baseline.toml, model.toml and the plots.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Calibrate on the seven maxima printed in the paper instead of a table.
    #[arg(long, conflicts_with_all = ["table", "fit_below"])]
    published: bool,
    /// Fit only loads up to this percentage of the highest one and judge both models on the rest.
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(10..100))]
    fit_below: Option<u8>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(table) = arguments.table.as_ref().filter(|_| !arguments.published) else {
        return published(&arguments.out);
    };
    let name = table.display().to_string();
    let bytes = crate::input::read_file(table)?;
    let table = PlateauTable::read(bytes.as_slice(), &name).map_err(Failure::bad_input)?;
    table.require_baseline(&name).map_err(Failure::bad_input)?;
    let mut table = table;
    let calibration = match arguments.fit_below {
        None => calibrate(&table.rows, Levels::default()),
        Some(percent) => {
            let share = f64::from(percent) / 100.0;
            let calibration = calibrate_below(&table.rows, share, Levels::default());
            let highest = table.rows.iter().map(|r| r.load_n).fold(0.0, f64::max);
            table.retain(|row| row.load_n <= share * highest);
            calibration
        }
    }
    .map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
    let files = files(&table, &calibration, &name)?;
    write_set(&arguments.out, &files).map_err(Failure::failed)?;
    print(summary(&calibration.report).as_bytes())
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
    write_set(out, &files).map_err(Failure::failed)?;
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

/// Series to check that the terminal lists.
const SHOWN_SERIES: usize = 6;

/// The summary for the terminal.
fn summary(report: &Report) -> String {
    let verdict = match report.verdict {
        Verdict::None => "none: the paper's model explains the data down to its noise",
        Verdict::Attributed => "attributed",
        Verdict::Ambiguous => "ambiguous: this data cannot tell rivals apart",
        Verdict::Unattributed => "unattributed: structure is left that no named effect explains",
    };
    let held_out = [report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n];
    let mut text = match held_out.map(|n| format!("{n:.4} N")) {
        _ if held_out.iter().any(|n| n.is_nan()) => {
            format!("verdict: {verdict}\nheld-out error: none, there is too little to hold anything out\n")
        }
        [before, after] => format!(
            "verdict: {verdict}\nheld-out error: {before} before, {after} after (noise {:.4} N)\n",
            report.noise_floor_n
        ),
    };
    for effect in &report.effects {
        let constants: Vec<String> = effect
            .parameters
            .iter()
            .map(|(name, e)| {
                format!("{name} = {:.4} [{:.4}, {:.4}] {}", e.value, e.ci95[0], e.ci95[1], e.unit)
            })
            .collect();
        text.push_str(&format!("  {} ({}): {}\n", effect.id, effect.covariate, constants.join(", ")));
        if effect.id == "unattributed" {
            text.push_str(&format!("    {}\n", effect.formula));
        }
        for rival in &effect.rivals {
            text.push_str(&format!(
                "    or {}: {}; to settle it: {}\n",
                rival.id, rival.why, rival.experiment
            ));
        }
    }
    if let Some(e) = &report.extrapolation {
        text.push_str(&format!(
            "above {:.1} N ({} rows, none fitted): {:.2} N before, {:.2} N after; medians {:.2} and {:.2} N; \
             {:.2} N after without {} bad reading(s)\n",
            e.fitted_below_n,
            e.rows,
            e.rmse_before_n,
            e.rmse_after_n,
            e.median_before_n,
            e.median_after_n,
            e.rmse_after_without_bad_n,
            e.bad_rows
        ));
    }
    for bad in report.bad_series.iter().take(SHOWN_SERIES) {
        text.push_str(&format!(
            "  check series {} {}: off by {:+.3} N ({:+.1} standard deviations)\n",
            bad.series, bad.direction, bad.offset_n, bad.standard_deviations
        ));
    }
    if let Some(more) = report.bad_series.len().checked_sub(SHOWN_SERIES).filter(|n| *n > 0) {
        text.push_str(&format!("  and {more} more, see report.html\n"));
    }
    text
}
