//! `pinswitch predict --rows TABLE`: curves of configurations, or readings of a calibrated model.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgMatches, Args, Command, FromArgMatches};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pinswitch_batch::{
    ConfigurationTable, CurveFormat, CurveFunction, CurveJob, CurveOutcome, CurveTableError, CurveTally,
    predict_rows,
};
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::loads_n;

use super::calibrated_curve::read_model;
use super::law::LawChoice;
use super::source::Source;
use super::terminal::warn;
use super::{Failure, print_data};
use crate::write::{check_file, lock_policy, write_error, write_file};

/// Names of columns of a plateau table. Parameters of a configuration have a dot in their names.
const PLATEAU_COLUMNS: [&str; 6] = ["series", "substrate", "pins", "load_N", "direction", "force_N"];
/// Most threads, as in `batch`.
const MAX_THREADS: i64 = 256;

/// Rows of a table: configurations, or readings of a calibrated model.
#[derive(Args, Clone, Debug)]
pub(super) struct Rows {
    /// model.toml or baseline.toml of a calibration; predicts the rows, or the curve of each configuration.
    #[arg(long, value_name = "TOML", conflicts_with = "law")]
    pub(super) model: Option<PathBuf>,
    /// Table to predict; its header decides how. Columns with names of parameters (layout.pins, shell.width_mm): each
    /// row changes CONFIG, and --out gets one line per row and load. Columns of a plateau table (load_N, direction, ...),
    /// with --model: each row gets predicted_N and sd_N; force_N is not used.
    #[arg(long, value_name = "CSV|PARQUET", conflicts_with = "json")]
    rows: Option<PathBuf>,
    /// The rows are of the session that was fitted: a drift has its value at their times, not its mean.
    #[arg(long, requires = "rows")]
    fitted_session: bool,
    /// File for the result: CSV or Parquet by its ending for curves, CSV for readings [default for readings: standard
    /// output]. The same command resumes a run that was stopped or killed.
    #[arg(long, value_name = "FILE", requires = "rows")]
    out: Option<PathBuf>,
    /// Threads for the curves of a table, up to 256 [default: one per processor].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        requires = "rows",
        value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS)
    )]
    threads: u16,
}

/// Meaning of the rows of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    Configurations,
    Plateaus,
}

/// A configuration, which is required unless rows are given.
#[derive(Clone, Debug)]
pub(super) struct SourceUnlessRows(pub(super) Option<Source>);

impl FromArgMatches for SourceUnlessRows {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        matches.contains_id("config").then(|| Source::from_arg_matches(matches)).transpose().map(Self)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for SourceUnlessRows {
    fn augment_args(command: Command) -> Command {
        Source::augment_args(command)
            .mut_arg("config", |config| config.required(false).required_unless_present("rows"))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl Rows {
    /// Predicts the rows, with `source` as the base of configurations; `None` without `--rows`.
    pub(super) fn run(&self, source: Option<&Source>, law: &LawChoice) -> Option<Result<(), Failure>> {
        let rows = self.rows.as_ref()?;
        Some(crate::input::read_file(rows).and_then(|bytes| {
            let names = ConfigurationTable::column_names(&bytes);
            match self.meaning(&names, rows, source.is_some())? {
                Meaning::Plateaus => self.predict_readings(rows, &bytes),
                Meaning::Configurations => self.predict_curves(rows, bytes, source, law),
            }
        }))
    }

    /// Decides the meaning of a table by the names of its columns, and checks the other arguments.
    fn meaning(&self, names: &[String], rows: &Path, has_base: bool) -> Result<Meaning, Failure> {
        let refused = |code: Code, problem: String, help: &str| {
            let location = Location::file(rows.display().to_string());
            Err(Failure::bad_input(Diagnostic::new(code, problem).with_location(location).with_help(help)))
        };
        let parameter =
            names.iter().find(|name| Configuration::PARAMETERS.iter().any(|p| p.path() == **name));
        let plateau = names.iter().find(|name| PLATEAU_COLUMNS.contains(&name.as_str()));
        match (parameter, plateau) {
            (Some(parameter), Some(plateau)) => refused(
                codes::OTHER_KIND_OF_FILE,
                format!(
                    "ambiguous table: {parameter} is a parameter, and {plateau} is a column of a plateau table"
                ),
                "remove one of both kinds of columns: for curves keep the parameters, for readings the others",
            ),
            (None, Some(_)) if self.model.is_none() => refused(
                codes::USAGE,
                "a plateau table needs a calibrated model".to_owned(),
                "give --model, or a table whose columns are parameters such as layout.pins",
            ),
            (None, Some(_)) if has_base => refused(
                codes::USAGE,
                "a plateau table needs no configuration".to_owned(),
                "omit the configuration, or give a table whose columns are parameters such as layout.pins",
            ),
            (None, Some(_)) => Ok(Meaning::Plateaus),
            // The reader of plateau tables describes what is missing.
            (None, None) if self.model.is_some() && !has_base => Ok(Meaning::Plateaus),
            _ => Ok(Meaning::Configurations),
        }
    }

    fn predict_readings(&self, rows: &Path, bytes: &[u8]) -> Result<(), Failure> {
        let Some(model) = &self.model else { return Ok(()) };
        let (model, model_name) = read_model(model)?;
        let table =
            PlateauTable::read_conditions(bytes, &rows.display().to_string()).map_err(Failure::bad_input)?;
        let session = if self.fitted_session { Session::Fitted } else { Session::New };
        if session == Session::New && model.drifts() {
            log::info!(
                "the model drifts with time: rows are predicted as a new session, with its mean; use --fitted-session for rows of the calibrated one"
            );
        }
        let (predicted, sd) = model.predict(&table.rows, session, &model_name).map_err(Failure::bad_input)?;
        let csv = table.with_columns(&["predicted_N", "sd_N"], &[predicted, sd], 5);
        match &self.out {
            Some(path) => write_file(path, csv.as_bytes()).map_err(Failure::from),
            None => print_data(csv.as_bytes()),
        }
    }

    fn predict_curves(
        &self,
        rows: &Path,
        bytes: Vec<u8>,
        source: Option<&Source>,
        law: &LawChoice,
    ) -> Result<(), Failure> {
        let refused = |problem: &str, help: &str| {
            Failure::bad_input(Diagnostic::new(codes::USAGE, problem).with_help(help))
        };
        if self.fitted_session {
            return Err(refused("--fitted-session is for plateau tables", "omit it"));
        }
        let base = source.ok_or_else(|| {
            refused(
                "no configuration for the rows to change",
                "give a file or template, such as three-double",
            )
        })?;
        let out = self.out.as_deref().ok_or_else(|| {
            refused("no file for the curves", "give --out FILE, which ends with .csv or .parquet")
        })?;
        CurveFormat::of_file(out).map_err(Failure::bad_input)?;
        let base = base.configuration()?;
        let table =
            ConfigurationTable::read(bytes, &rows.display().to_string()).map_err(Failure::bad_input)?;
        let model = self.model.as_deref().map(read_model).transpose()?;
        check_output(out)?;
        let by_law =
            |design: &Design| law.curve(design.contact(), &loads_n(design)).map_err(Diagnostic::from);
        let by_model = |design: &Design| match &model {
            Some((model, name)) => pinswitch_app::calibrated_curve(design, model, name),
            None => by_law(design),
        };
        let law: Option<(String, CurveFunction<'_>)> = match (&model, law.name()) {
            (Some((model, _)), _) => {
                // A model from a pipe has no recorded hash.
                let sha256 = self.model.as_deref().and_then(crate::input::sha256_read);
                Some((sha256.unwrap_or_else(|| format!("{model:?}")), &by_model))
            }
            (None, Some(name)) => Some((name.to_owned(), &by_law)),
            (None, None) => None,
        };
        let bar = progress_bar(table.count())?;
        let job = CurveJob {
            table: &table,
            base: &base,
            law,
            threads: usize::from(self.threads),
            policy: lock_policy(),
            progress: &|rows| bar.inc(rows),
        };
        let outcome = predict_rows(&job, out);
        bar.finish_and_clear();
        report(out, &outcome.map_err(failure)?)
    }
}

/// Checks that a file can have this path, before the curves are computed.
fn check_output(out: &Path) -> Result<(), Failure> {
    check_file(out)?;
    if std::fs::metadata(out).is_ok_and(|existing| !existing.is_file()) {
        let location = Location::file(out.display().to_string());
        let error = Diagnostic::new(codes::NOT_A_FILE, "not an ordinary file").with_location(location);
        return Err(Failure::bad_input(error.with_help("give a file, next to which a run can be resumed")));
    }
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder.filter(|folder| !folder.is_dir()) {
        Some(_) => Err(write_error(out, std::io::ErrorKind::NotFound.into()).into()),
        None => Ok(()),
    }
}

fn failure(error: CurveTableError) -> Failure {
    match error {
        CurveTableError::File { path, source } => write_error(&path, source).into(),
        CurveTableError::Input(error) => Failure::bad_input(error),
        other => Failure::failed(other),
    }
}

fn progress_bar(rows: u64) -> Result<ProgressBar, Failure> {
    let bar = ProgressBar::new(rows);
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} rows, {per_sec}, {eta} left");
    bar.set_style(style.map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?);
    if log::max_level() < log::LevelFilter::Info {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    Ok(bar)
}

fn report(out: &Path, outcome: &CurveOutcome) -> Result<(), Failure> {
    let CurveTally { predicted, refused, failed } = outcome.tally;
    let rows = outcome.tally.rows();
    let existing = match outcome.existing {
        0 => String::new(),
        existing => format!("; {existing} existed before"),
    };
    let out = out.display();
    log::info!("{out}: {predicted} of {rows} rows predicted, {refused} refused, {failed} failed{existing}");
    let help = "see columns status and reason";
    if refused > 0 {
        warn(
            Diagnostic::new(codes::VARIANTS_FAILED, format!("{refused} of {rows} rows refused"))
                .with_help(help),
        );
    }
    if failed > 0 {
        return Err(Failure::failed(
            Diagnostic::new(codes::VARIANTS_FAILED, format!("{failed} of {rows} rows failed"))
                .with_help(help),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(columns: &[&str], model: bool, base: bool) -> Result<Meaning, String> {
        let model = model.then(|| PathBuf::from("model.toml"));
        let rows = Rows { model, rows: None, fitted_session: false, out: None, threads: 0 };
        let names: Vec<_> = columns.iter().map(|name| (*name).to_owned()).collect();
        rows.meaning(&names, Path::new("t.csv"), base).map_err(|e| e.to_string())
    }

    #[test]
    fn the_header_decides_the_meaning() {
        use Meaning::{Configurations, Plateaus};
        assert_eq!(meaning(&["layout.pins"], false, true), Ok(Configurations));
        assert_eq!(meaning(&["layout.pins"], true, true), Ok(Configurations));
        assert_eq!(meaning(&["shell.with_mm"], false, true), Ok(Configurations));
        assert_eq!(meaning(&["series", "load_N", "bath.temp"], true, false), Ok(Plateaus));
        assert_eq!(meaning(&["other"], true, false), Ok(Plateaus));
        for (columns, model, base, problem) in [
            (
                &["layout.pins", "load_N"][..],
                true,
                true,
                "t.csv: ambiguous table: layout.pins is a parameter",
            ),
            (&["load_N"], false, true, "t.csv: a plateau table needs a calibrated model; give --model"),
            (&["load_N"], true, true, "t.csv: a plateau table needs no configuration; omit"),
        ] {
            let error = meaning(columns, model, base).unwrap_err();
            assert!(error.starts_with(problem), "{error}");
        }
    }
}
