//! A column of a sheet: what it contains, in which unit, and with which factor.

use pinswitch_friction::Direction;

use crate::decimal::Decimal;
use crate::quantity::Quantity;
use crate::unit::Unit;
use crate::vocabulary;

/// Rows in which the kind of a column's cells is examined.
pub(crate) const SAMPLE_ROWS: usize = 500;

/// Why a column of texts is not read.
pub(crate) const NOT_NUMBERS: &str = "its cells are not numbers";

/// A column of a sheet.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) quantity: Quantity,
    pub(crate) unit: Option<&'static Unit>,
    /// Unit in the row of units.
    pub(crate) row_unit: Option<&'static Unit>,
    /// Factor to the unit of the column that is written.
    pub(crate) factor: Decimal,
    pub(crate) offset: Decimal,
    /// Whether the cells are dates or times of day.
    pub(crate) is_clock: bool,
    /// Direction, load, wrap angle in degrees and trial of a column of a wide table.
    pub(crate) direction: Option<Direction>,
    pub(crate) load: Option<(Decimal, &'static Unit)>,
    pub(crate) angle: Option<Decimal>,
    pub(crate) repetition: Option<u32>,
    /// Why the column is not read.
    pub(crate) reason: &'static str,
    /// Whether a word of the name names the quantity.
    pub(crate) is_named: bool,
    /// Whether another column has the same name.
    pub(crate) is_repeated: bool,
    /// Whether the unit follows from the values.
    pub(crate) is_assumed: bool,
    /// Whether the user decided the quantity.
    pub(crate) is_decided: bool,
    /// Whether the user gave the factor.
    pub(crate) has_factor: bool,
    /// Whether an empty cell has the value of the one above.
    pub(crate) is_filled: bool,
}

impl Column {
    /// Text of what distinguishes the readings of one column from those of another.
    pub(crate) fn key(&self) -> String {
        let direction = self.direction.map(Direction::as_str);
        let load = self.load.map(|(value, unit)| value.times(unit.factor).to_f64());
        format!("{direction:?} {load:?} {:?} {:?}", self.angle.map(Decimal::to_f64), self.repetition)
    }

    /// Whether the column has the readings of one direction, load, angle or trial of a wide table.
    pub(crate) fn is_wide(&self) -> bool {
        self.direction.is_some() || self.load.is_some() || self.angle.is_some() || self.repetition.is_some()
    }

    /// Whether the column is what a drive was commanded, not what was measured.
    pub(crate) fn is_set_value(&self) -> bool {
        const WORDS: [&str; 7] =
            ["target", "setpoint", "command", "commanded", "demand", "desired", "reference"];
        let words = vocabulary::words(&self.name);
        words.iter().any(|word| WORDS.contains(&word.as_str()) || word.starts_with("soll"))
    }

    pub(crate) fn is_wide_by_words(&self) -> bool {
        self.direction.is_some() || self.load.is_some() || self.angle.is_some()
    }

    pub(crate) fn ignore(&mut self, reason: &'static str) {
        self.quantity = Quantity::Ignore;
        self.reason = reason;
    }
}

/// Name of a column in a message; its number if another column has the same name.
pub(crate) fn shown(column: &Column) -> String {
    if column.is_repeated { format!("column {}", column.index + 1) } else { format!("'{}'", column.name) }
}

/// Name of a column in an option; its number if it has none.
pub(crate) fn reference(column: &Column) -> String {
    if column.name.is_empty() || column.is_repeated || column.name.contains(['=', '\'', '\n']) {
        (column.index + 1).to_string()
    } else {
        column.name.clone()
    }
}
