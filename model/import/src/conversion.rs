//! The conversion of a column to the unit that is written; what its unit leaves open is a question.

use crate::column::{Column, SAMPLE_ROWS, reference};
use crate::decimal::Decimal;
use crate::header::Header;
use crate::map::{ColumnChoice, Map};
use crate::number;
use crate::quantity::Quantity;
use crate::question::Question;
use crate::sheet::Sheet;
use crate::unit::{Dimension, NEWTON_PER_GRAM, Unit};
use pinswitch_diagnostic::codes;

/// Shortest usual time between two samples that is assumed to be in seconds: that of 10 kHz, less rounding. Days, as spreadsheets
/// count them, have shorter ones.
const SHORTEST_STEP_S: f64 = 0.99e-4;
/// Largest speed as a share of the full speed, with overspeed.
const MAX_SHARE: f64 = 2.0;
/// Largest wrap angle in radians: two revolutions.
const MAX_RADIANS: f64 = 12.6;

/// Sets the factor from the unit; a unit that is not known becomes a question.
pub(crate) fn set_factor(
    column: &mut Column,
    sheet: &Sheet,
    header: &Header,
    map: &Map,
    questions: &mut Vec<Question>,
) {
    let quantity = column.quantity;
    // A map without the unit of its row is for files in its own units.
    let choice = map.column(&column.name, column.index + 1).filter(|choice| !choice.is_unit_decided);
    let mapped = choice.and_then(|choice| choice.row_unit.or(choice.unit).zip(choice.unit));
    if let (Some((known, unit)), Some(row)) = (mapped, column.row_unit)
        && known != row
    {
        let name = reference(column);
        let problem = format!(
            "column '{}' is in {} here, and was in {} where the map was made",
            column.name, row.name, known.name
        );
        let readings = vec![
            (format!("it is in {}", row.name), format!("unit.{name}={}", row.name)),
            (format!("it is in {}, as in the map", unit.name), format!("unit.{name}={}", unit.name)),
        ];
        questions.push(Question::new(codes::UNKNOWN_UNIT, problem, readings));
        return;
    }
    if quantity.dimensions().is_empty() || column.is_clock {
        return;
    }
    let decided = map.column(&column.name, column.index + 1);
    if column.has_factor {
        questions.extend(decided.and_then(|choice| unit_and_factor(column, choice)));
        return;
    }
    let given = map.force_unit.filter(|_| quantity == Quantity::Force);
    let named = column.unit.or(given);
    column.is_assumed = named.is_none();
    let Some(unit) = named.or_else(|| assumed_unit(column, sheet, header)) else {
        let question = unknown_unit(column);
        if !questions.contains(&question) {
            questions.push(question);
        }
        return;
    };
    column.unit = Some(unit);
    if !quantity.dimensions().contains(&unit.dimension) {
        let problem = format!("column '{}': {} in {}", column.name, quantity.as_str(), unit.name);
        let readings = vec![
            (
                "the unit is another one".to_owned(),
                format!("unit.{}={}", reference(column), quantity.base_unit()),
            ),
            ("the column is not needed".to_owned(), format!("column.{}=ignore", reference(column))),
        ];
        questions.push(Question::new(codes::UNKNOWN_UNIT, problem, readings));
        return;
    }
    match (quantity, unit.dimension) {
        (_, Dimension::Signal) => {
            let base = quantity.base_unit();
            let problem = format!(
                "column '{}' in {} needs a calibration line: {base} = factor x {} + offset",
                column.name, unit.name, unit.name
            );
            let readings = vec![
                (
                    format!("{base} per {}, and the reading in {base} at 0", unit.name),
                    format!("factor.{0}=0.001\noffset.{0}=0", reference(column)),
                ),
                ("the column is not needed".to_owned(), format!("column.{}=ignore", reference(column))),
            ];
            questions.push(Question::new(codes::UNKNOWN_UNIT, problem, readings));
        }
        (Quantity::Position, Dimension::Angle) => {
            column.ignore("an angle: its millimetres per degree are the option factor.NAME")
        }
        (Quantity::Speed, Dimension::Speed) => match map.full_speed_mm_s {
            Some(full) => {
                let percent = Decimal::from_f64(100.0 / full.to_f64()).unwrap_or(Decimal::ONE);
                column.factor = unit.factor.times(percent);
            }
            None => {
                column.ignore("a speed in length per time: the option full_speed_mm_s makes it a percentage")
            }
        },
        // A workbook stores 50 % as 0.5, and shows 50 %.
        (Quantity::Speed, Dimension::Share)
            if decided.is_none_or(|c| c.unit.is_none()) && {
                let values = sampled(column, sheet, header);
                values.iter().any(|v| *v > 0.0) && values.iter().all(|v| (0.0..=MAX_SHARE).contains(v))
            } =>
        {
            let name = reference(column);
            let problem = format!("column '{}' in {} has no value above {MAX_SHARE}", column.name, unit.name);
            let readings = vec![
                ("they are shares: 1 is the full speed".to_owned(), format!("factor.{name}=100")),
                ("they are percent: 1 is a hundredth of the full speed".to_owned(), format!("unit.{name}=%")),
            ];
            questions.push(Question::new(codes::UNKNOWN_UNIT, problem, readings));
        }
        (Quantity::Force, Dimension::Mass) => column.factor = unit.factor.times(NEWTON_PER_GRAM),
        _ => column.factor = unit.factor,
    }
}

/// A unit and a factor that a person gave for the same column have two readings: the factor is that of the written values, or
/// one in addition to the unit.
fn unit_and_factor(column: &Column, choice: &ColumnChoice) -> Option<Question> {
    let unit = choice.unit.filter(|unit| choice.is_factor_decided && unit.dimension != Dimension::Signal)?;
    let of_unit = match (column.quantity, unit.dimension) {
        (Quantity::Force, Dimension::Mass) => unit.factor.times(NEWTON_PER_GRAM),
        _ => unit.factor,
    };
    let (factor, base) = (column.factor, column.quantity.base_unit());
    if of_unit == factor || of_unit == Decimal::ONE {
        return None;
    }
    let name = reference(column);
    Some(Question::new(
        codes::UNKNOWN_UNIT,
        format!("column '{}' has the unit {} and the factor {factor}", column.name, unit.name),
        [
            (
                format!("{factor} {base} for a written 1"),
                format!("unit.{name}={base}\nfactor.{name}={factor}"),
            ),
            (
                format!("{factor} {} for a written 1", unit.name),
                format!("unit.{name}={base}\nfactor.{name}={}", factor.times(of_unit)),
            ),
        ],
    ))
}

/// Returns the numbers in the first rows of a column.
fn sampled(column: &Column, sheet: &Sheet, header: &Header) -> Vec<f64> {
    let sign = if (header.first_data..sheet.len())
        .take(SAMPLE_ROWS)
        .any(|row| sheet.cell(row, column.index).contains('.'))
    {
        number::DecimalSign::Point
    } else {
        number::DecimalSign::Comma
    };
    let rows = (header.first_data..sheet.len()).take(SAMPLE_ROWS);
    rows.filter_map(|row| number::parse(sheet.cell(row, column.index), sign))
        .map(|(v, _)| v.to_f64())
        .collect()
}

/// Returns the unit that the values of a column without a unit show.
fn assumed_unit(column: &Column, sheet: &Sheet, header: &Header) -> Option<&'static Unit> {
    let values = sampled(column, sheet, header);
    match column.quantity {
        Quantity::WrapAngle if values.iter().any(|angle| *angle > MAX_RADIANS) => Unit::parse("deg"),
        // No load cell has a sample every 0.1 ms and writes fractions of milliseconds.
        Quantity::Time => {
            let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0).collect();
            let mut sorted = steps.clone();
            sorted.sort_by(f64::total_cmp);
            let usual = sorted.get(sorted.len() / 2);
            let is_seconds =
                usual.is_some_and(|step| *step >= SHORTEST_STEP_S) && steps.iter().all(|step| *step < 1.0);
            if is_seconds { Unit::parse("s") } else { None }
        }
        _ => None,
    }
}

fn unknown_unit(column: &Column) -> Question {
    let units: &[&str] = match column.quantity {
        Quantity::Load => &["N", "kg", "g", "lbf"],
        Quantity::LoadMass => &["g", "kg"],
        Quantity::Force => &["N", "kN", "kgf", "lbf", "counts"],
        Quantity::Time => &["s", "ms", "d"],
        Quantity::Dwell => &["s", "ms"],
        Quantity::Position => &["mm", "m", "in"],
        Quantity::WrapAngle => &["deg", "rad", "pi rad", "turns"],
        Quantity::Speed => &["%", "mm/s"],
        _ => &["W", "mW"],
    };
    if column.quantity == Quantity::Force && column.is_wide() {
        let readings = units.iter().map(|unit| ((*unit).to_owned(), format!("force_unit={unit}")));
        return Question::new(codes::UNKNOWN_UNIT, "the columns of forces have no unit", readings);
    }
    let problem = format!("column '{}' has no unit", column.name);
    let mut readings: Vec<_> =
        units.iter().map(|unit| ((*unit).to_owned(), format!("unit.{}={unit}", reference(column)))).collect();
    if column.quantity == Quantity::Speed {
        readings
            .push(("shares: 1 is the full speed".to_owned(), format!("factor.{}=100", reference(column))));
    }
    if !matches!(column.quantity, Quantity::Load | Quantity::Force) {
        readings.push(("leave it out".to_owned(), format!("column.{}=ignore", reference(column))));
    }
    Question::new(codes::UNKNOWN_UNIT, problem, readings)
}
