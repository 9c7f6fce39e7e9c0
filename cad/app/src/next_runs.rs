//! The next runs: what to measure after a table of plateaus.

use pinswitch_calibration::ModelFile;
use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::experiment::{Known, RigLimits, propose, write_runs};
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_report::run_sheet;
use serde::Serialize;

use crate::Answer;
use crate::calibration::calibrated;

/// Longest session in minutes: a week of eight hours a day.
const MAX_MINUTES: f64 = 2_400.0;

/// What the page shows of a plan.
#[derive(Serialize)]
struct NextRuns {
    minutes: f64,
    runs: usize,
    /// Open questions, each with the probability that these runs answer it.
    questions: Vec<([String; 2], f64)>,
    /// `next-runs.csv` and `run-sheet.html`, as `pinswitch experiment` writes them.
    csv: String,
    sheet: String,
}

/// Plans the runs after a table, for the rig of the paper or one without a switch; `file` is the name of the table.
pub(crate) fn answer(csv: &str, file: &str, minutes: f64) -> Answer {
    planned(csv, file, minutes).map_or_else(Answer::error, |planned| Answer::json(&planned))
}

fn planned(csv: &str, file: &str, minutes: f64) -> Result<NextRuns, Diagnostic> {
    if !(minutes > 0.0 && minutes <= MAX_MINUTES) {
        return Err(Diagnostic::new(codes::OUT_OF_RANGE, format!("{minutes} minutes"))
            .with_help(format!("give more than 0 and at most {MAX_MINUTES} minutes")));
    }
    let (table, calibration) = calibrated(csv, file)?;
    let rig = RigLimits::of_plain_table(&table.rows).unwrap_or_default();
    let (model, vocabulary) = (ModelFile::new(&calibration.augmented), Vocabulary::built_in());
    let known = Known {
        report: &calibration.report,
        model: &model,
        rows: &table.rows,
        vocabulary: &vocabulary,
        name: file,
    };
    let proposal = propose(known, &rig, minutes)?;
    Ok(NextRuns {
        minutes: proposal.minutes,
        runs: proposal.runs.len(),
        questions: proposal.questions.iter().map(|q| (q.between.clone(), q.resolved_probability)).collect(),
        csv: write_runs(&proposal.runs),
        sheet: run_sheet(file, &proposal, &rig),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::SAMPLE;

    #[test]
    fn the_sample_has_its_effect_and_a_next_session() {
        let planned = planned(SAMPLE, "sample.csv", 20.0).unwrap();
        assert!(planned.minutes <= 20.0 && planned.runs > 5 && planned.sheet.contains("<html"));
        assert_eq!(planned.csv.lines().count(), planned.runs + 1);
        assert!(planned.questions.iter().all(|(_, p)| (0.0..=1.0).contains(p)));
        let (_, calibration) = calibrated(SAMPLE, "sample.csv").unwrap();
        assert_eq!(
            calibration.report.effects.iter().map(|e| &*e.id).collect::<Vec<_>>(),
            ["coating_ploughing"]
        );
    }
}
