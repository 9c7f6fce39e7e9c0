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
                return Err(CalibrationError::NoValue { id: effect.id().to_owned(), row: row + 1, told });
            }
        }
    }
    Ok(())
}
