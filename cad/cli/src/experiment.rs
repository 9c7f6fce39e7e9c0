//! `pinswitch experiment DIR --out PLAN`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::experiment::{
    ExperimentError, Known, MOST_RUNS, Proposal, RigLimits, propose, write_runs,
};
use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{ModelFile, Report};
use pinswitch_report::run_sheet;
use pinswitch_switch::output::OutputFile;

use super::calibrate::{FORM, forget_form};
use super::own_effects::OwnEffects;
use super::{Failure, print, print_json};
use crate::input::{read_file, read_text_file, was_read};
use crate::write::write_set;

/// Propose the runs that settle most of what a calibration left open, per minute of work.
///
/// Rivals that the data could not tell apart, effects of consequence that it did not exclude, and effects that it could not
/// see. Writes next-runs.csv (the runs, in order), run-sheet.html (to print), experiment.json (how probably each question
/// is settled, and what no run on this rig can settle) and, where the calibration drew a form, discovered.toml: what
/// `calibrate --plan` needs to tell whether it came again.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch experiment calibration --minutes 60 --out next
  pinswitch init rig --out rig.toml
  pinswitch experiment calibration --rig rig.toml --out next
  pinswitch simulate --runs next/next-runs.csv --model calibration/model.toml --out rehearsal")]
pub(super) struct Arguments {
    /// The folder that `calibrate` wrote.
    calibration: PathBuf,
    /// Minutes of work there are.
    #[arg(long, default_value_t = 60.0, value_parser = minutes)]
    minutes: f64,
    /// What the rig can do and what its time costs; without it, the paper's rig.
    #[arg(long, value_name = "TOML")]
    rig: Option<PathBuf>,
    /// Folder for the plan.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    own: OwnEffects,
    /// Print experiment.json instead of a summary.
    #[arg(long)]
    json: bool,
}

/// Most minutes: a week of eight hours a day.
const MAX_MINUTES: f64 = 2_400.0;

fn minutes(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|m| *m > 0.0 && *m <= MAX_MINUTES)
        .ok_or_else(|| format!("give a time above 0 and up to {MAX_MINUTES} minutes"))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folder = &arguments.calibration;
    let rig = match &arguments.rig {
        None => RigLimits::default(),
        Some(path) => RigLimits::parse(&read_text_file(path)?, &path.display().to_string())
            .map_err(Failure::bad_input)?,
    };
    let report = report(folder)?;
    let path = folder.join("model.toml");
    let model =
        ModelFile::parse(&read_text_file(&path)?, &path.display().to_string()).map_err(Failure::bad_input)?;
    let path = folder.join("residuals.csv");
    let table = PlateauTable::read(read_file(&path)?.as_slice(), &path.display().to_string())
        .map_err(Failure::bad_input)?;
    let name = folder.display().to_string();
    let vocabulary = with_form(arguments.own.vocabulary()?, folder, &report)?;
    if let Some(id) = not_defined(&report, &model, &vocabulary) {
        return Err(Failure::bad_input(format!(
            "{}: it was calibrated with the effect '{id}', which nothing here defines; give its file by --effects, as for calibrate",
            folder.join("report.json").display()
        )));
    }
    let known =
        Known { report: &report, model: &model, rows: &table.rows, vocabulary: &vocabulary, name: &name };
    let proposal = propose(known, &rig, arguments.minutes, Levels::default()).map_err(|e| match e {
        ExperimentError::NoTime { .. } => Failure::bad_input(format!("--minutes: {e}")),
        ExperimentError::CellTooSmall { .. } => {
            let file = arguments.rig.as_ref().map_or_else(String::new, |rig| format!("{}: ", rig.display()));
            Failure::bad_input(format!("{file}{e}"))
        }
        other => Failure::bad_input(other),
    })?;
    let mut json = serde_json::to_vec_pretty(&proposal).map_err(Failure::failed)?;
    json.push(b'\n');
    let file = |name: &str, bytes: Vec<u8>| OutputFile { name: name.to_owned(), bytes };
    let mut files = vec![
        file("next-runs.csv", write_runs(&proposal.runs).into_bytes()),
        file("run-sheet.html", run_sheet(&name, &proposal).into_bytes()),
        file("experiment.json", json),
    ];
    // The form that is asked about goes with the plan, so that what comes of it can be told.
    let form = folder.join(FORM);
    let asks = report.effects.iter().any(|found| found.form.is_some()) && form.is_file();
    if was_read(&arguments.out.join(FORM)) {
        // The plan goes into the folder of the calibration, where the form lies already.
    } else if asks {
        files.push(file(FORM, read_text_file(&form)?.into_bytes()));
    } else {
        forget_form(&arguments.out)?;
    }
    write_set(&arguments.out, &files)?;
    if arguments.json { print_json(&proposal) } else { print(summary(&proposal, &arguments.out).as_bytes()) }
}

fn report(folder: &Path) -> Result<Report, Failure> {
    let path = folder.join("report.json");
    let text = read_text_file(&path)?;
    serde_json::from_str(&text).map_err(|e| {
        Failure::bad_input(format!("{}: {e}; give the folder as `calibrate` wrote it", path.display()))
    })
}

/// An effect that a calibration tried, and that neither the model on file nor the vocabulary defines.
fn not_defined<'a>(report: &'a Report, model: &ModelFile, vocabulary: &Vocabulary) -> Option<&'a str> {
    let mut tried = report.candidates.iter().map(|candidate| candidate.id.as_str());
    tried.find(|id| vocabulary.named(id).is_none() && model.vocabulary().named(id).is_none())
}

/// A vocabulary with the form that the calibration drew, if it drew one.
fn with_form(vocabulary: Vocabulary, folder: &Path, report: &Report) -> Result<Vocabulary, Failure> {
    let mut forms = report.effects.iter().filter_map(|found| found.form.as_ref());
    if !forms.any(|form| vocabulary.named(&form.id).is_none()) {
        return Ok(vocabulary);
    }
    let path = folder.join(FORM);
    vocabulary.read(&read_text_file(&path)?, &path.display().to_string()).map_err(Failure::bad_input)
}

/// A probability in percent: nothing is certain.
fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.99 => ">99".to_owned(),
        p if p < 0.01 => "<1".to_owned(),
        p => format!("{:.0}", 100.0 * p),
    }
}

/// A count with its noun.
fn counted(count: f64, noun: &str) -> String {
    format!("{count:.0} {noun}{}", if count == 1.0 { "" } else { "s" })
}

fn summary(proposal: &Proposal, out: &Path) -> String {
    let mut text = String::new();
    if proposal.questions.is_empty() && proposal.unanswerable.is_empty() {
        text.push_str("nothing is open: every effect that matters is found without a rival, or excluded\n");
    }
    for q in &proposal.questions {
        text.push_str(&format!(
            "{:>4} % to settle {} or {}; by the paper's protocol repeated: {} %\n",
            percent(q.resolved_probability),
            q.between[0],
            q.between[1],
            percent(q.by_repeating)
        ));
    }
    for u in &proposal.unanswerable {
        text.push_str(&format!("not on this rig: {} or {}: {}\n", u.between[0], u.between[1], u.why));
    }
    if proposal.runs.len() >= MOST_RUNS {
        text.push_str(&format!(
            "a plan has at most {MOST_RUNS} runs: what is left of the time is for another, after these are calibrated\n"
        ));
    }
    if proposal.runs.is_empty() {
        text.push_str("no run is worth making for it\n");
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
    fn one_is_no_plural() {
        assert_eq!(
            (counted(1.0, "run"), counted(0.0, "minute")),
            ("1 run".to_owned(), "0 minutes".to_owned())
        );
    }
}
