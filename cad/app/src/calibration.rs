//! A table of measured plateaus that was dropped on the page: its verdict and its model.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::inference::Levels;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{ModelFile, SessionReport, calibrate_among};
use serde::Serialize;

use crate::Answer;
use crate::trouble::Trouble;

/// Largest table that is read, in megabytes: some hundred thousand rows, for which a browser computes minutes.
pub(crate) const LARGEST_MB: usize = 20;
const LARGEST: usize = LARGEST_MB * 1_000_000;

/// What the table says.
#[derive(Serialize)]
struct Said {
    verdict: &'static str,
    before_n: f64,
    after_n: f64,
    promise_n: Option<f64>,
    noise_n: f64,
    adequate: bool,
    /// What was found, each with what this table cannot tell it from. The page has words for them.
    effects: Vec<Vec<String>>,
    /// Effects of consequence that are not excluded.
    not_excluded: Vec<String>,
    /// The text of `model.toml`.
    model: String,
}

/// Whether a text is a calibrated model, or what is wrong with it.
#[derive(Debug, Serialize)]
pub(crate) struct CheckedModel {
    is_model: bool,
    trouble: Option<Trouble>,
}

/// Checks a model before a design uses it; `file` names it in errors.
pub(crate) fn checked_model(text: &str, file: &str) -> CheckedModel {
    let trouble = ModelFile::parse(text, file).err().map(Trouble::general);
    CheckedModel { is_model: trouble.is_none(), trouble }
}

/// Calibrates the table; `file` names it in errors.
pub(crate) fn answer(csv: &str, file: &str) -> Answer {
    said(csv, file).map_or_else(Answer::error, |said| Answer::json(&said))
}

fn said(csv: &str, file: &str) -> Result<Said, String> {
    if csv.len() > LARGEST {
        return Err(format!(
            "{file}: {} MB are more than the {} MB that a page can work on; use `pinswitch calibrate {file}`",
            csv.len() / 1_000_000,
            LARGEST_MB
        ));
    }
    let table = PlateauTable::read(csv.as_bytes(), file).map_err(|e| e.to_string())?;
    table.require_baseline(file).map_err(|e| e.to_string())?;
    let calibration = calibrate_among(&table.rows, &Vocabulary::built_in(), Levels::default())
        .map_err(|e| format!("{file}: {e}"))?;
    let (report, selection) = (&calibration.report, &calibration.selection);
    let model = ModelFile::new(&selection.augmented, &calibration.data, selection.noise);
    let SessionReport { effects, not_excluded, .. } = SessionReport::after(file.to_owned(), report);
    Ok(Said {
        verdict: report.verdict.as_str(),
        before_n: report.baseline.heldout_rmse_n,
        after_n: report.augmented.heldout_rmse_n,
        promise_n: report.promise_n,
        noise_n: report.noise_floor_n,
        adequate: report.adequate,
        effects,
        not_excluded,
        model: model.to_text().map_err(|e| e.to_string())?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verdict_and_every_effect_has_its_words_on_the_page() {
        let words = include_str!("../page/words.js");
        let vocabulary = Vocabulary::built_in();
        let effects = vocabulary.effects().map(|effect| effect.description().id);
        for word in effects.chain(["none", "inconclusive", "attributed", "ambiguous", "unattributed"]) {
            assert!(words.contains(&format!("{word}: ")), "{word} has no words in words.js");
        }
    }

    /// Silicone at twelve loads, with readings that `force` makes of a load and a direction (1: concentric).
    fn table(force: impl Fn(f64, f64) -> f64) -> String {
        let mut text =
            "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,\
                        position_mm,time_s,force_N\n"
                .to_owned();
        for row in 0..72 {
            let (series, repetition) = (row / 6, row % 6 / 2 + 1);
            let load_n = 5.0 + 4.0 * f64::from(series);
            let (direction, sign) = [("eccentric", -1.0), ("concentric", 1.0)][row as usize % 2];
            let wobble = 0.01 * f64::from(row * 37 % 11 - 5);
            text.push_str(&format!(
                "{series},silicone,,up,{:.1},{load_n},52,3,{direction},{repetition},{},{},{:.4}\n",
                load_n / 9.80665e-3,
                20 * repetition,
                10 * row,
                force(load_n, sign) + wobble,
            ));
        }
        text
    }

    /// What no switch and no rig can give is refused as the command line refuses it, and makes no model.
    #[test]
    fn what_is_impossible_is_refused() {
        let told = |force: &dyn Fn(f64, f64) -> f64| match answer(&table(force), "x.csv") {
            Answer::Json(text) => text,
            Answer::Bytes(_) => panic!("bytes"),
        };
        let sound = told(&|load, sign| load * (1.0 + 0.25 * sign));
        assert!(sound.contains("\"model\":\""), "{sound}");
        for impossible in [
            told(&|load, sign| load * (1.0 - 0.25 * sign)),
            told(&|load, sign| 102.0 * load * (1.0 + 0.25 * sign)),
            told(&|load, sign| -load * (1.0 + 0.25 * sign)),
            told(&|_, _| 0.0),
            told(&|_, sign| 20.0 * (1.0 + 0.25 * sign)),
        ] {
            assert!(impossible.contains("\"error\"") && impossible.contains("x.csv"), "{impossible}");
        }
    }

    #[test]
    fn what_is_no_table_is_told_in_words() {
        for text in ["", "a,b\n1,2\n", "\u{0}PK"] {
            let Answer::Json(answer) = answer(text, "x.csv") else { panic!("bytes") };
            assert!(answer.contains("error") && answer.contains("x.csv"), "{answer}");
        }
        let large = answer(&" ".repeat(LARGEST + 1), "large.csv");
        assert!(matches!(large, Answer::Json(text) if text.contains("pinswitch calibrate large.csv")));
    }
}
