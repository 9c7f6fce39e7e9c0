//! Whether effects of one's own have values on a table: a formula may take the logarithm of what is zero there.

use crate::calibrate::CalibrationError;
use crate::inference::{Model, Observations, Term};
use crate::table::PlateauRow;

/// Every effect of one's own has a number on every row, wherever its fit may start.
pub(crate) fn has_values(
    baseline: &Model,
    data: &Observations,
    rows: &[PlateauRow],
) -> Result<(), CalibrationError> {
    let vocabulary = &baseline.vocabulary;
    for effect in vocabulary.own().filter_map(|own| vocabulary.named(&own.definition().id)) {
        for start in effect.starts(&baseline.frame) {
            let predicted = baseline.with_term(Term::Named(effect), &start).predict(&data.points);
            if let Some(row) = predicted.iter().position(|n| !n.is_finite()) {
                let PlateauRow { load_n, speed_pct, dwell_s, repetition, time_s, .. } = &rows[row];
                let told = format!(
                    "load_n {load_n}, speed_pct {speed_pct}, dwell_s {dwell_s}, repetition {repetition}, time_s {time_s}"
                );
                let constants = effect.parameters().iter().zip(&start);
                let values: Vec<String> = constants
                    .map(|(constant, value)| format!("{} = {}", constant.name, rounded(*value)))
                    .collect();
                return Err(CalibrationError::NoValue {
                    id: effect.id().to_owned(),
                    values: values.join(", "),
                    row: row + 1,
                    told,
                });
            }
        }
    }
    Ok(())
}

/// A number with four digits, which say where a fit begins.
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
    fn the_place_at_which_a_fit_would_begin_is_named() {
        let good = include_str!("../../../templates/rig/effects.toml");
        // With c at its start of 52 it has numbers on every row. At the heaviest load, beyond what a formula is tried on when it is
        // read, it has none with a greater c, where a fit may begin, too.
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
        let data = Observations::new(&baseline.frame, &rows).unwrap();
        let said = has_values(&baseline, &data, &rows).unwrap_err().to_string();
        assert!(said.starts_with("effect 'lubricant_dip' has no number where a = 0.1, c = "), "{said}");
        let c: f64 = said.split("c = ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
        assert!(c > 60.0 && said.contains(", w = 8, at which a fit may begin, in row "), "{said}");
    }
}
