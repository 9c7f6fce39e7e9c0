//! Check that user-defined effects are finite on a table, where a formula may take the logarithm of
//! zero.

use crate::calibrate::CalibrationError;
use crate::model::{Model, Term};
use crate::table::PlateauRow;

/// Checks that every user-defined effect is finite on every row at all start values of its fit.
pub(crate) fn check_finite_effects(baseline: &Model, rows: &[PlateauRow]) -> Result<(), CalibrationError> {
    let vocabulary = &baseline.vocabulary;
    let points = baseline.frame.points(rows).unwrap_or_default();
    for effect in vocabulary.own().filter_map(|own| vocabulary.named(&own.definition().id)) {
        for start in effect.typical(&baseline.frame) {
            let predicted = baseline.with_term(Term::Named(effect.clone()), &start).predict(&points);
            if let Some(row) = predicted.iter().position(|n| !n.is_finite()) {
                let PlateauRow { load_n, speed_pct, dwell_s, repetition, time_s, .. } = &rows[row];
                let conditions = format!(
                    "load_n {load_n}, speed_pct {speed_pct}, dwell_s {dwell_s}, repetition {repetition}, time_s {time_s}"
                );
                let constants = effect.parameters().iter().zip(&start);
                let values: Vec<String> = constants
                    .map(|(constant, value)| format!("{} = {}", constant.name, rounded(*value)))
                    .collect();
                return Err(CalibrationError::NotFinite {
                    id: effect.id().to_owned(),
                    values: values.join(", "),
                    row: row + 1,
                    conditions,
                });
            }
        }
    }
    Ok(())
}

/// Rounds to four significant digits, which suffice to show a start value.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Vocabulary;
    use crate::table::Frame;
    use crate::test_session::session;

    #[test]
    fn infinite_start_values_are_named() {
        let good = include_str!("../../../templates/rig/effects.toml");
        // The formula is finite on every row at the start c = 52. At the heaviest load, above those
        // of the probe rows, it is not finite at a larger start of c.
        let text = good.replace(
            "-a * exp(-((speed_pct - c)/w)^2)",
            "a*exp(-((speed_pct - 50)/w)^2)*sqrt(1 - load_n*c/6000)",
        );
        assert_ne!(text, good);
        let vocabulary = Vocabulary::built_in().read(&text, "mine.toml").unwrap();
        let mut rows = session(1);
        let heaviest = rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
        rows.iter_mut().for_each(|row| row.load_n *= 100.0 / heaviest);
        let baseline = Model::baseline(Frame::new(&rows)).among(&vocabulary);
        let error = check_finite_effects(&baseline, &rows).unwrap_err();
        let CalibrationError::NotFinite { id, values, .. } = error else { panic!("{error}") };
        assert!(id == "lubricant_dip" && values.starts_with("a = 0.1, c = "), "{id}: {values}");
        let c: f64 = values.split("c = ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
        assert!(c > 60.0 && values.ends_with(", w = 8"), "{values}");
    }
}
