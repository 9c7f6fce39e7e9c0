//! `pinswitch predict --model MODEL --rows TABLE --out FILE`: predicted readings of a calibrated model.

use std::path::{Path, PathBuf};

use clap::{ArgMatches, Args, Command, FromArgMatches};
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::PlateauTable;

use super::calibrated_curve::read_model;
use super::source::Source;
use super::{Failure, print_data};
use crate::write::write_file;

/// Rows of a plateau table, predicted by a calibrated model.
#[derive(Args, Clone, Debug)]
pub(super) struct Rows {
    /// model.toml or baseline.toml of a calibration; predicts the rows, or the curve of the configuration.
    #[arg(long, value_name = "TOML", conflicts_with = "law")]
    pub(super) model: Option<PathBuf>,
    /// Plateau table whose rows are predicted; its force_N is not used.
    #[arg(long, value_name = "CSV", requires = "model")]
    rows: Option<PathBuf>,
    /// The rows are of the session that was fitted: a drift has its value at their times, not its mean.
    #[arg(long, requires = "rows")]
    fitted_session: bool,
    /// File for the table with predicted_N and sd_N [default: standard output].
    #[arg(long, value_name = "CSV", requires = "rows")]
    out: Option<PathBuf>,
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
        Source::augment_args(command).mut_arg("config", |config| {
            config.required(false).required_unless_present("rows").conflicts_with("rows")
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl Rows {
    /// Predicts the rows; `None` if none are given.
    pub(super) fn run(&self) -> Option<Result<(), Failure>> {
        let (model, rows) = self.model.as_ref().zip(self.rows.as_ref())?;
        Some(self.predict(model, rows))
    }

    fn predict(&self, model: &Path, rows: &Path) -> Result<(), Failure> {
        let (model, model_name) = read_model(model)?;
        let bytes = crate::input::read_file(rows)?;
        let table = PlateauTable::read_conditions(bytes.as_slice(), &rows.display().to_string())
            .map_err(Failure::bad_input)?;
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
}
