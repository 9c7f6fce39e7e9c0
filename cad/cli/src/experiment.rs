//! `pinswitch experiment DIR --out PLAN`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::ModelFile;
use pinswitch_calibration::Report;
use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::experiment::{
    ExperimentError, Known, MOST_RUNS, Proposal, RigLimits, propose, write_runs,
};
use pinswitch_calibration::table::PlateauTable;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_report::{FORM_FILE, run_sheet};
use pinswitch_switch::output::OutputFile;

use super::calibrate::stale_form;
use super::calibrated_curve::read_model;
use super::terminal::to_json;
use super::user_effects::UserEffects;
use super::{Failure, print_json, print_text};
use crate::input::{read_file, read_text_file, was_read};
use crate::write::SetFolder;

/// Plan the runs that answer most open questions of a calibration.
///
/// The plan answers as many questions as possible per minute of work. The questions are the effects that the data could not separate, the consequential effects that it did not rule out,
/// and the effects to which it is insensitive. Writes next-runs.csv (the runs in order), run-sheet.html (to print),
/// experiment.json (the probability that each question is answered, and the questions that no run on this rig can
/// answer) and, if the calibration fitted a form, discovered.toml, which `calibrate --plan` needs to test the form.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch experiment calibration --minutes 60 --out next
  pinswitch init rig --out rig.toml
  pinswitch experiment calibration --rig rig.toml --out next
  pinswitch simulate --runs next/next-runs.csv --model calibration/model.toml --out rehearsal")]
pub(super) struct Arguments {
    /// Folder that `calibrate` wrote.
    calibration: PathBuf,
    /// Available time in minutes.
    #[arg(long, default_value_t = 60.0, value_parser = minutes)]
    minutes: f64,
    /// Limits of the rig and the time that its steps take [default: the paper's rig, or for plain
    /// contacts the settings of the table].
    #[arg(long, value_name = "TOML")]
    rig: Option<PathBuf>,
    /// Folder for the plan.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    effects: UserEffects,
    /// Print experiment.json instead of a summary.
    #[arg(long)]
    json: bool,
}

/// Longest session in minutes: a week of eight hours a day.
const MAX_MINUTES: f64 = 2_400.0;

fn minutes(text: &str) -> Result<f64, Diagnostic> {
    let value: Option<f64> = text.parse().ok();
    value.filter(|m| *m > 0.0 && *m <= MAX_MINUTES).ok_or_else(|| {
        Diagnostic::new(codes::OUT_OF_RANGE, "not a time of a session")
            .with_help(format!("give a number of minutes above 0 and up to {MAX_MINUTES}"))
    })
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = SetFolder::lock(&arguments.out)?;
    let folder = &arguments.calibration;
    let rig = match &arguments.rig {
        None => None,
        Some(path) => Some(
            RigLimits::parse(&read_text_file(path)?, &path.display().to_string())
                .map_err(Failure::bad_input)?,
        ),
    };
    let report = report(folder)?;
    let (model, _) = read_model(&folder.join("model.toml"))?;
    let path = folder.join("residuals.csv");
    let table = PlateauTable::read(read_file(&path)?.as_slice(), &path.display().to_string())
        .map_err(Failure::bad_input)?;
    let rig = rig.or_else(|| RigLimits::of_plain_table(&table.rows)).unwrap_or_default();
    let name = folder.display().to_string();
    let vocabulary = with_form(arguments.effects.vocabulary()?, folder, &report)?;
    if let Some(id) = undefined_effect(&report, &model, &vocabulary) {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::CALIBRATION_INCOMPLETE,
                format!("the calibration tested the effect '{id}', which is not defined"),
            )
            .with_location(Location::file(folder.join("report.json").display().to_string()))
            .with_help("give the file that defines it with --effects, as for calibrate"),
        ));
    }
    let known =
        Known { report: &report, model: &model, rows: &table.rows, vocabulary: &vocabulary, name: &name };
    let proposal =
        propose(known, &rig, arguments.minutes).map_err(|e| Failure::bad_input(located(e, arguments)))?;
    let file = |name: &str, bytes: Vec<u8>| OutputFile { name: name.to_owned(), bytes };
    let mut files = vec![
        file("next-runs.csv", write_runs(&proposal.runs).into_bytes()),
        file("run-sheet.html", run_sheet(&name, &proposal, &rig).into_bytes()),
        file("experiment.json", to_json(&proposal)?),
    ];
    // The plan carries the form that it tests, so that a calibration of its runs can report the result.
    let form = folder.join(FORM_FILE);
    let tests_form = report.effects.iter().any(|effect| effect.form.is_some()) && form.is_file();
    // A plan in the folder of its calibration finds the form there.
    let is_there = was_read(&arguments.out.join(FORM_FILE));
    if tests_form && !is_there {
        files.push(file(FORM_FILE, read_text_file(&form)?.into_bytes()));
    }
    let stale = if tests_form || is_there { &[] } else { stale_form(&out)? };
    out.replace_listed(&files, "experiment", stale)?;
    if arguments.json { print_json(&proposal) } else { print_text(&summary(&proposal, &arguments.out)) }
}

/// Locates an error of the planner at the option or the file that causes it.
fn located(error: ExperimentError, arguments: &Arguments) -> Diagnostic {
    let file = match &error {
        ExperimentError::NoTime { .. } => Some("--minutes".to_owned()),
        ExperimentError::CellTooSmall { .. } => arguments.rig.as_ref().map(|rig| rig.display().to_string()),
        _ => None,
    };
    let diagnostic = Diagnostic::from(error);
    match file {
        Some(file) => diagnostic.or_in_file(&file),
        None => diagnostic,
    }
}

fn report(folder: &Path) -> Result<Report, Failure> {
    let path = folder.join("report.json");
    let text = read_text_file(&path)?;
    serde_json::from_str(&text).map_err(|e| {
        Failure::bad_input(
            Diagnostic::new(codes::CALIBRATION_INCOMPLETE, "not a report of a calibration")
                .with_location(Location::file(path.display().to_string()))
                .with_help("give the folder as `calibrate` wrote it")
                .with_source(e),
        )
    })
}

/// Returns an effect that the calibration tested and that neither the model nor the vocabulary defines.
fn undefined_effect<'a>(report: &'a Report, model: &ModelFile, vocabulary: &Vocabulary) -> Option<&'a str> {
    let mut tested = report.candidates.iter().map(|candidate| candidate.id.as_str());
    tested.find(|id| vocabulary.named(id).is_none() && model.vocabulary().named(id).is_none())
}

/// Adds the form that the calibration fitted, if any, to a vocabulary.
fn with_form(vocabulary: Vocabulary, folder: &Path, report: &Report) -> Result<Vocabulary, Failure> {
    let mut forms = report.effects.iter().filter_map(|effect| effect.form.as_ref());
    if !forms.any(|form| vocabulary.named(&form.id).is_none()) {
        return Ok(vocabulary);
    }
    let path = folder.join(FORM_FILE);
    vocabulary.read(&read_text_file(&path)?, &path.display().to_string()).map_err(Failure::bad_input)
}

/// Formats a probability in percent, never as 0 or 100.
fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.99 => ">99".to_owned(),
        p if p < 0.01 => "<1".to_owned(),
        p => format!("{:.0}", 100.0 * p),
    }
}

/// Formats a count with its noun.
fn counted(count: f64, noun: &str) -> String {
    format!("{count:.0} {noun}{}", if count == 1.0 { "" } else { "s" })
}

/// Describes how a question between two effects, or between an effect and `none`, is answered.
fn task([effect, other]: &[String; 2]) -> String {
    match other.as_str() {
        "none" => format!("detect or rule out {effect}"),
        other => format!("separate {effect} from {other}"),
    }
}

fn summary(proposal: &Proposal, out: &Path) -> String {
    let mut text = String::new();
    if proposal.questions.is_empty() && proposal.unanswerable.is_empty() {
        text.push_str("no open questions: every effect that matters is either attributed without a rival or ruled out\n");
    }
    for q in &proposal.questions {
        text.push_str(&format!(
            "{:>4} % to {}; {} % by repeating the paper's protocol\n",
            percent(q.resolved_probability),
            task(&q.between),
            percent(q.by_repeating)
        ));
    }
    for u in &proposal.unanswerable {
        text.push_str(&format!("this rig cannot {}: {}\n", task(&u.between), u.why));
    }
    if proposal.runs.len() >= MOST_RUNS {
        text.push_str(&format!(
            "a plan has at most {MOST_RUNS} runs: calibrate these before you plan the rest of the time\n"
        ));
    }
    if proposal.runs.is_empty() {
        text.push_str("no run is worth its time\n");
    }
    text.push_str(&format!(
        "{}, {}: {}\n",
        counted(proposal.runs.len() as f64, "run"),
        counted(proposal.minutes.round(), "minute"),
        out.join("run-sheet.html").display()
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_run_is_singular() {
        assert_eq!(
            (counted(1.0, "run"), counted(0.0, "minute")),
            ("1 run".to_owned(), "0 minutes".to_owned())
        );
    }
}
