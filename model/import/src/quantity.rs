//! What a column contains.

use crate::unit::Dimension;

/// What a column contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Name of the series.
    Series,
    /// `silicone`, `abs` or `plain`.
    Substrate,
    /// Occupied grooves.
    Pins,
    /// Order of the loads.
    Sweep,
    /// Declared load; as a mass it is also the load mass.
    Load,
    /// Declared mass of the weight.
    LoadMass,
    /// Speed of the actuator.
    Speed,
    /// Pause before the reading.
    Dwell,
    /// Direction of the move.
    Direction,
    /// Number of the repetition.
    Repetition,
    /// Position of the actuator.
    Position,
    /// Time, elapsed or of a clock.
    Time,
    /// Day of a clock time.
    Date,
    /// Reading of the load cell.
    Force,
    /// Wrap angle of the tendon.
    WrapAngle,
    /// Power of the actuator.
    Power,
    /// Session, such as a day.
    Session,
    /// Number of the mount.
    Mount,
    /// Person who measured.
    Operator,
    /// Printed part or tendon.
    Specimen,
    /// Copied unchanged, under its own name.
    Copy,
    /// Not read.
    Ignore,
}

/// Every quantity with its word in a map and its column in a plateau table or log.
const WORDS: [(Quantity, &str, &str); 22] = [
    (Quantity::Series, "series", "series"),
    (Quantity::Substrate, "substrate", "substrate"),
    (Quantity::Pins, "pins", "pins"),
    (Quantity::Sweep, "sweep", "sweep"),
    (Quantity::LoadMass, "load_mass", "load_mass_g"),
    (Quantity::Load, "load", "load_N"),
    (Quantity::Speed, "speed", "speed_pct"),
    (Quantity::Dwell, "dwell", "dwell_s"),
    (Quantity::Direction, "direction", "direction"),
    (Quantity::Repetition, "repetition", "repetition"),
    (Quantity::Position, "position", "position_mm"),
    (Quantity::Time, "time", "time_s"),
    (Quantity::Date, "date", ""),
    (Quantity::Force, "force", "force_N"),
    (Quantity::WrapAngle, "wrap_angle", "wrap_angle_deg"),
    (Quantity::Power, "power", "power_W"),
    (Quantity::Session, "session", "session"),
    (Quantity::Mount, "mount", "mount"),
    (Quantity::Operator, "operator", "operator"),
    (Quantity::Specimen, "specimen", "specimen"),
    (Quantity::Copy, "copy", ""),
    (Quantity::Ignore, "ignore", ""),
];

impl Quantity {
    /// Returns the quantity with this word or column name.
    pub fn parse(word: &str) -> Option<Self> {
        let same = |other: &str| !other.is_empty() && other.eq_ignore_ascii_case(word);
        WORDS.iter().find(|(_, name, column)| same(name) || same(column)).map(|(quantity, ..)| *quantity)
    }

    /// Returns the quantity of a column of a plateau table, by its exact name.
    pub(crate) fn of_table_column(name: &str) -> Option<Self> {
        WORDS
            .iter()
            .find(|(.., column)| !column.is_empty() && *column == name)
            .map(|(quantity, ..)| *quantity)
    }

    /// Returns the word in a map.
    pub fn as_str(self) -> &'static str {
        WORDS.iter().find(|(quantity, ..)| *quantity == self).map_or("", |(_, name, _)| name)
    }

    /// Returns the column of a plateau table or log; empty without one.
    pub fn column(self) -> &'static str {
        WORDS.iter().find(|(quantity, ..)| *quantity == self).map_or("", |(.., column)| column)
    }

    /// All words and names of columns that [`Self::parse`] reads.
    pub(crate) fn all_words() -> Vec<&'static str> {
        let mut words: Vec<&str> = WORDS.iter().flat_map(|(_, name, column)| [*name, *column]).collect();
        words.retain(|word| !word.is_empty());
        words.sort_unstable();
        words.dedup();
        words
    }

    /// All words, for messages.
    pub(crate) fn words() -> String {
        WORDS.map(|(_, name, _)| name).join(", ")
    }

    /// Whether the cells are numbers.
    pub(crate) fn is_number(self) -> bool {
        !self.dimensions().is_empty() || self == Self::Repetition
    }

    /// Dimensions that the quantity may have; empty for words and whole numbers.
    pub(crate) fn dimensions(self) -> &'static [Dimension] {
        match self {
            Self::Load => &[Dimension::Force, Dimension::Mass],
            Self::LoadMass => &[Dimension::Mass],
            Self::Speed => &[Dimension::Share, Dimension::Speed],
            Self::Dwell | Self::Time => &[Dimension::Time],
            Self::Position => &[Dimension::Length, Dimension::Angle, Dimension::Signal],
            Self::Force => &[Dimension::Force, Dimension::Mass, Dimension::Signal],
            Self::WrapAngle => &[Dimension::Angle],
            Self::Power => &[Dimension::Power],
            _ => &[],
        }
    }

    /// Unit of the column that is written.
    pub(crate) fn base_unit(self) -> &'static str {
        match self {
            Self::Load | Self::Force => "N",
            Self::LoadMass => "g",
            Self::Speed => "%",
            Self::Dwell | Self::Time => "s",
            Self::Position => "mm",
            Self::WrapAngle => "deg",
            Self::Power => "W",
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_columns_name_a_quantity() {
        for (quantity, word, column) in WORDS {
            assert_eq!(Quantity::parse(word), Some(quantity));
            assert_eq!((quantity.as_str(), quantity.column()), (word, column));
            if !column.is_empty() {
                assert_eq!(Quantity::of_table_column(column), Some(quantity));
            }
        }
    }
}
