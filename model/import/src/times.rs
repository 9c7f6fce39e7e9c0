//! The times of the rows of a file.

use crate::clock;
use crate::decimal::Decimal;
use crate::file::FileReading;
use crate::map::Map;
use crate::quantity::Quantity;

/// Seconds of a day, and the step back by which a time of day shows midnight.
const DAY_S: u128 = 86_400;
const MIDNIGHT_STEP_S: f64 = -43_200.0;

/// Returns the time of each row in seconds, as the file counts it, and whether it is that of a
/// clock; `None` without a column of times.
pub(crate) fn times(file: &FileReading, map: &Map) -> Option<(Vec<Option<Decimal>>, bool)> {
    let Some(time) = file.column(Quantity::Time) else {
        let rate = map.sample_rate_hz?;
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 rows")]
        let at = |i: usize| Decimal::from_f64(i as f64 / rate.to_f64());
        return Some(((0..file.rows.len()).map(at).collect(), false));
    };
    if !time.is_clock {
        return Some((file.rows.iter().map(|row| file.value(*row, time)).collect(), false));
    }
    let date = file.column(Quantity::Date);
    let sheet = &file.recording.sheet;
    let (mut previous, mut days) = (None::<f64>, 0_u128);
    let mut all = Vec::with_capacity(file.rows.len());
    for row in &file.rows {
        let moment = file.moment(sheet.cell(*row, time.index)).map(|mut moment| {
            if moment.day.is_none()
                && let Some(date) = date
            {
                moment.day =
                    clock::parse(sheet.cell(*row, date.index), file.date_order).and_then(|date| date.day);
            }
            moment
        });
        let seconds = moment.map(|moment| {
            let seconds = moment.seconds();
            let value = seconds.to_f64();
            if moment.day.is_none() && previous.is_some_and(|before| value - before < MIDNIGHT_STEP_S) {
                days += 1;
            }
            previous = Some(value);
            if moment.day.is_none() { seconds.plus(Decimal::new(days * DAY_S, 0)) } else { seconds }
        });
        all.push(seconds);
    }
    Some((all, true))
}
