//! Logs: force over time.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::Direction;

use crate::decimal::Decimal;
use crate::direction_words;
use crate::file::FileReading;
use crate::map::Map;
use crate::quantity::Quantity;
use crate::question::Question;
use crate::times::times;

/// The columns of a log, one value for each sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogColumns {
    /// Time in seconds, as the file counts it; of a clock, since the first sample.
    pub time_s: Vec<f64>,
    /// Reading of the load cell in newtons.
    pub force_n: Vec<f64>,
    /// Position of the actuator in millimetres.
    pub position_mm: Option<Vec<f64>>,
    /// Power of the actuator in watts.
    pub power_w: Option<Vec<f64>>,
    /// Speed of the actuator in percent.
    pub speed_pct: Option<Vec<f64>>,
    /// Load in newtons.
    pub load_n: Option<Vec<f64>>,
    /// Direction of the move, where a column names it.
    pub direction: Option<Vec<Option<Direction>>>,
}

impl LogColumns {
    /// Writes the log as CSV with the columns that it has. A value that is not known is an empty
    /// cell.
    pub fn to_csv(&self) -> String {
        self.lines(self.time_s.len())
    }

    /// Writes the names and the first `count` samples.
    pub(crate) fn lines(&self, count: usize) -> String {
        let optional = [
            (Quantity::Position, &self.position_mm),
            (Quantity::Power, &self.power_w),
            (Quantity::Speed, &self.speed_pct),
            (Quantity::Load, &self.load_n),
        ];
        let mut out = String::from("time_s,force_N");
        for (quantity, _) in optional.iter().filter(|(_, values)| values.is_some()) {
            out.push(',');
            out.push_str(quantity.column());
        }
        if self.direction.is_some() {
            out.push_str(",direction");
        }
        out.push('\n');
        for (i, (time, force)) in self.time_s.iter().zip(&self.force_n).enumerate().take(count) {
            out.push_str(&format!("{time},{force}"));
            for values in optional.iter().filter_map(|(_, values)| values.as_ref()) {
                out.push(',');
                if let Some(value) = values.get(i).filter(|value| value.is_finite()) {
                    out.push_str(&value.to_string());
                }
            }
            if let Some(directions) = &self.direction {
                out.push(',');
                out.push_str(directions.get(i).copied().flatten().map_or("", Direction::as_str));
            }
            out.push('\n');
        }
        out
    }
}

/// Makes a log of the rows of a file; what is missing becomes a question.
///
/// # Errors
/// A [`Diagnostic`] without a time.
pub(crate) fn build(
    file: &FileReading,
    map: &Map,
    questions: &mut Vec<Question>,
) -> Result<LogColumns, Diagnostic> {
    let forces: Vec<_> = file.forces().collect();
    let [force] = forces.as_slice() else {
        return Err(Diagnostic::new(
            codes::NO_FORCE_COLUMN,
            format!("a log has one column of forces, and this one has {}", forces.len()),
        )
        .with_location(Location::file(&file.name))
        .with_help("leave out the others, as in --set 'column.NAME=ignore'"));
    };
    let Some((times, is_clock)) = times(file, map) else {
        return Err(Diagnostic::new(
            codes::NO_FORCE_COLUMN,
            "no column is the time, and no load or direction makes it a plateau table",
        )
        .with_location(Location::file(&file.name))
        .with_help("name the time, as in --set 'column.NAME=time', or give --set sample_rate_hz=80"));
    };
    let origin = if is_clock {
        times.iter().copied().flatten().next().unwrap_or(Decimal::ZERO)
    } else {
        Decimal::ZERO
    };
    let sign = |value: Decimal| if map.force_sign == Some(true) { value.negated() } else { value };
    let mut log = LogColumns::default();
    let mut used = Vec::new();
    for (row, time) in file.rows.iter().zip(&times) {
        if let (Some(time), Some(force)) = (time, file.value(*row, force)) {
            log.time_s.push(time.plus(origin.negated()).to_f64());
            log.force_n.push(sign(force).to_f64());
            used.push(*row);
        }
    }
    let numbers = |quantity| {
        let column = file.column(quantity)?;
        Some(
            used.iter()
                .map(|row| file.value(*row, column).map_or(f64::NAN, Decimal::to_f64))
                .collect::<Vec<f64>>(),
        )
    };
    log.position_mm = numbers(Quantity::Position);
    log.power_w = numbers(Quantity::Power);
    log.speed_pct = numbers(Quantity::Speed);
    log.load_n = numbers(Quantity::Load).or_else(|| {
        let mass = numbers(Quantity::LoadMass)?;
        Some(
            mass.iter()
                .map(|grams| {
                    Decimal::from_f64(*grams)
                        .map_or(f64::NAN, |g| g.times(crate::unit::NEWTON_PER_GRAM).to_f64())
                })
                .collect(),
        )
    });
    if let Some(column) = file.column(Quantity::Direction) {
        let cell = |row: &usize| file.recording.sheet.cell(*row, column.index);
        let of = |word: &str| map.directions.get(word).copied().or_else(|| direction_words::direction(word));
        if let Some(unknown) = used.iter().map(cell).find(|word| !word.is_empty() && of(word).is_none()) {
            questions.push(crate::table::unknown_direction(unknown, Some(column)));
        }
        log.direction = Some(used.iter().map(|row| of(cell(row))).collect());
    }
    if log.time_s.is_empty() {
        return Err(Diagnostic::new(codes::TABLE_WITHOUT_ROWS, "no row has a time and a force")
            .with_location(Location::file(&file.name)));
    }
    Ok(log)
}
