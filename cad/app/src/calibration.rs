//! Calibration with a table of measured plateaus that was dropped on the page.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{
    Calibration, EffectReport, Estimate, ModelFile, Report, SessionReport, calibrate,
};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_report::friction_words;
use serde::Serialize;

use crate::Answer;
use crate::bench::{MeasuredPoint, Residual, points, residuals};
use crate::refusal::Refusal;

/// Largest table that is read, in megabytes: some hundred thousand rows, minutes of computation in
/// a browser.
pub(crate) const MAX_TABLE_MB: usize = 20;
const MAX_TABLE_BYTES: usize = MAX_TABLE_MB * 1_000_000;
/// Seed of the interval of the expected error; it is fixed, so that a table has one result.
const SEED: u64 = 1;

/// A simulated table with one effect: every tenth series of
/// `pinswitch simulate --randomised --effect coating_ploughing=0.024`.
pub(crate) const SAMPLE: &str = include_str!("sample.csv");

/// A table to try.
#[derive(Serialize)]
struct Sample {
    csv: &'static str,
    file: &'static str,
}

/// Least probability that is shown, and most of them.
const LEAST_PROBABILITY: f64 = 0.05;
const MOST_PROBABILITIES: usize = 6;

/// What the page shows of a calibration.
#[derive(Serialize)]
struct Summary {
    verdict: &'static str,
    /// Friction coefficient of a rig without a switch, in words.
    friction: Option<String>,
    /// Held-out error of the baseline, of least squares with drag, offset and gain, and of the augmented model, N: as
    /// `pinswitch calibrate` prints them.
    before_n: f64,
    least_squares_n: Option<f64>,
    after_n: f64,
    /// Expected error of a new session, N.
    promise_n: Option<f64>,
    noise_n: f64,
    adequate: bool,
    /// Ids of detected effects, each with its rivals. The page has words for them.
    effects: Vec<Vec<String>>,
    /// Ids of effects that are not excluded at their size of consequence.
    not_excluded: Vec<String>,
    /// Effects of the vocabulary and structures without a name, the most probable first.
    probabilities: Vec<(String, f64)>,
    /// Constants of the detected effects.
    sizes: Vec<EffectSize>,
    /// Measured friction.
    points: Vec<MeasuredPoint>,
    /// Residuals before and after.
    residuals: Vec<Residual>,
    /// The text of `model.toml`; empty for a rig without a switch: its model does not predict a part.
    model: String,
}

/// A constant of a detected effect.
#[derive(Serialize)]
struct EffectSize {
    id: String,
    name: String,
    value: f64,
    /// 95 % interval.
    ci95: [f64; 2],
    unit: String,
}

/// Whether a text is a calibrated model, or why it is refused.
#[derive(Debug, Serialize)]
pub(crate) struct CheckedModel {
    is_model: bool,
    trouble: Option<Refusal>,
}

/// Checks the text of a model before a design uses it; `file` is its name in errors.
pub(crate) fn check_model(text: &str, file: &str) -> CheckedModel {
    let trouble = ModelFile::parse(text, file).err().map(Into::into);
    CheckedModel { is_model: trouble.is_none(), trouble }
}

/// Calibrates with a table; `file` is its name in errors.
pub(crate) fn answer(csv: &str, file: &str) -> Answer {
    summary(csv, file).map_or_else(Answer::error, |summary| Answer::json(&summary))
}

/// Returns a table to try a calibration with.
pub(crate) fn sample() -> Answer {
    Answer::json(&Sample { csv: SAMPLE, file: "sample.csv" })
}

/// Reads a table and calibrates with it; `file` is its name in errors.
///
/// # Errors
/// A [`Diagnostic`] if the table is too long, or cannot be read or fitted.
pub(crate) fn calibrated(csv: &str, file: &str) -> Result<(PlateauTable, Calibration), Diagnostic> {
    if csv.len() > MAX_TABLE_BYTES {
        let mb = csv.len() / 1_000_000;
        let problem = format!("the table has {mb} MB, and a page reads at most {MAX_TABLE_MB} MB");
        return Err(Diagnostic::new(codes::FILE_TOO_LARGE, problem)
            .with_location(Location::file(file))
            .with_help(format!("run `pinswitch calibrate {file}`")));
    }
    let table = PlateauTable::read(csv.as_bytes(), file).map_err(Diagnostic::from)?;
    table.require_baseline(file).map_err(Diagnostic::from)?;
    let calibration = calibrate(&table.rows, &Vocabulary::built_in(), SEED)
        .map_err(|e| Diagnostic::from(e).or_in_file(file))?;
    Ok((table, calibration))
}

fn summary(csv: &str, file: &str) -> Result<Summary, Diagnostic> {
    let (table, calibration) = calibrated(csv, file)?;
    let report = &calibration.report;
    let model = ModelFile::new(&calibration.augmented);
    let is_switch = table.rows.iter().any(|row| row.substrate.is_some());
    let SessionReport { effects, not_excluded, .. } = SessionReport::after(file.to_owned(), report);
    Ok(Summary {
        verdict: report.verdict.as_str(),
        friction: friction_words(report),
        before_n: report.baseline.heldout_series_rmse_n,
        least_squares_n: report.least_squares_n,
        after_n: report.augmented.heldout_series_rmse_n,
        promise_n: report.promise_n,
        noise_n: report.noise_floor_n,
        adequate: report.adequate,
        effects,
        not_excluded,
        probabilities: probabilities(report),
        sizes: sizes(report),
        points: points(&table),
        residuals: residuals(&table, &calibration),
        model: if is_switch { model.to_text()? } else { String::new() },
    })
}

/// Returns effects and structures by their probability, the most probable first, of at least [`LEAST_PROBABILITY`].
fn probabilities(report: &Report) -> Vec<(String, f64)> {
    let effects = report.candidates.iter().map(|c| (c.id.clone(), c.probability));
    let structures = report.structures.iter().map(|s| (s.name.clone(), s.probability));
    let mut all: Vec<_> = effects.chain(structures).filter(|(_, p)| *p >= LEAST_PROBABILITY).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(MOST_PROBABILITIES);
    all
}

/// Returns the constants of the effects of the model.
fn sizes(report: &Report) -> Vec<EffectSize> {
    let of = |effect: &EffectReport| {
        let size = |(name, e): (&String, &Estimate)| EffectSize {
            id: effect.id.clone(),
            name: name.clone(),
            value: e.value,
            ci95: e.ci95,
            unit: e.unit.clone(),
        };
        effect.parameters.iter().map(size).collect::<Vec<_>>()
    };
    report.effects.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_and_effect_has_words() {
        let words = include_str!("../../switch/page/text.js");
        let vocabulary = Vocabulary::built_in();
        let effects = vocabulary.acting_order().iter().map(|effect| effect.id());
        for word in effects.chain(["none", "inconclusive", "attributed", "ambiguous", "unattributed"]) {
            assert!(words.contains(&format!("{word}: ")), "{word} is missing in text.js");
        }
    }

    /// Returns a table of silicone at twelve loads; `force` gives the reading for a load (N) and a
    /// direction (1: concentric).
    fn table(force: impl Fn(f64, f64) -> f64) -> String {
        let mut text =
            "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,\
                        position_mm,time_s,force_N\n"
                .to_owned();
        for row in 0..72 {
            let (series, repetition) = (row / 6, row % 6 / 2 + 1);
            let load_n = 5.0 + 4.0 * f64::from(series);
            let (direction, sign) = [("eccentric", -1.0), ("concentric", 1.0)][row as usize % 2];
            let noise_n = 0.01 * f64::from(row * 37 % 11 - 5);
            text.push_str(&format!(
                "{series},silicone,,up,{:.1},{load_n},52,3,{direction},{repetition},{},{},{:.4}\n",
                load_n / 9.80665e-3,
                20 * repetition,
                10 * row,
                force(load_n, sign) + noise_n,
            ));
        }
        text
    }

    /// Exchanged directions, forces in grams, forces of the wrong sign, no forces, and a force that
    /// is independent of the load.
    #[test]
    fn implausible_tables_give_no_model() {
        let answer_to = |force: &dyn Fn(f64, f64) -> f64| match answer(&table(force), "x.csv") {
            Answer::Json(text) => text,
            Answer::Bytes(_) => panic!("bytes"),
        };
        let plausible = answer_to(&|load, sign| load * (1.0 + 0.25 * sign));
        assert!(plausible.contains("\"model\":\""), "{plausible}");
        for implausible in [
            answer_to(&|load, sign| load * (1.0 - 0.25 * sign)),
            answer_to(&|load, sign| 102.0 * load * (1.0 + 0.25 * sign)),
            answer_to(&|load, sign| -load * (1.0 + 0.25 * sign)),
            answer_to(&|_, _| 0.0),
            answer_to(&|_, sign| 20.0 * (1.0 + 0.25 * sign)),
        ] {
            assert!(implausible.contains("\"error\"") && implausible.contains("x.csv"), "{implausible}");
        }
    }

    #[test]
    fn other_files_are_refused_by_name() {
        for text in ["", "a,b\n1,2\n", "\u{0}PK"] {
            let Answer::Json(answer) = answer(text, "x.csv") else { panic!("bytes") };
            assert!(answer.contains("error") && answer.contains("x.csv"), "{answer}");
        }
        let large = answer(&" ".repeat(MAX_TABLE_BYTES + 1), "large.csv");
        assert!(matches!(large, Answer::Json(text) if text.contains("pinswitch calibrate large.csv")));
    }
}
