//! What the name of a column shows: quantity, unit, direction, load, wrap angle and trial.

use pinswitch_friction::Direction;

use crate::decimal::Decimal;
use crate::direction_words::direction_in_name;
use crate::number::{self, DecimalSign, SignEvidence, sign_evidence};
use crate::quantity::Quantity;
use crate::unit::{Dimension, Unit};
use crate::vocabulary::{is_friction, quantities, words};

/// What the name of a column shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NameReading {
    pub(crate) quantity: Option<Quantity>,
    pub(crate) unit: Option<&'static Unit>,
    /// Direction of a column that has the readings of one direction.
    pub(crate) direction: Option<Direction>,
    /// Load of a column that has the readings at one load.
    pub(crate) load: Option<(Decimal, &'static Unit)>,
    /// Wrap angle in degrees of a column that has the readings at one angle.
    pub(crate) angle: Option<Decimal>,
    /// Trial of a column that has one reading of each row.
    pub(crate) repetition: Option<u32>,
    /// Whether a word of the name, not only its unit, names the quantity.
    pub(crate) is_named: bool,
}

/// Reads a column name; `row_unit` is its unit in a row of units.
pub(crate) fn read(name: &str, row_unit: Option<&'static Unit>) -> NameReading {
    // The unit of "Force x 10 [N]" is 10 N, which is none: without a unit, the column is a question.
    if row_unit.is_none() && has_factor(name) {
        let known = read_words(name, row_unit);
        return NameReading { unit: None, repetition: None, ..known };
    }
    read_words(name, row_unit)
}

fn read_words(name: &str, row_unit: Option<&'static Unit>) -> NameReading {
    if let Some(quantity) = Quantity::of_table_column(name) {
        let unit = Unit::parse(quantity.base_unit());
        return NameReading {
            quantity: Some(quantity),
            unit: row_unit.or(unit),
            is_named: true,
            ..NameReading::default()
        };
    }
    if let Some(unit) = row_unit {
        return combine(name, Some(unit)).unwrap_or_else(|| combine(name, None).unwrap_or_default());
    }
    for (stem, unit) in unit_splits(name) {
        if let Some(reading) = combine(&stem, Some(unit)) {
            return reading;
        }
    }
    combine(name, None).unwrap_or_default()
}

/// Splits a name into the rest and a unit, in every way that it may be written.
fn unit_splits(name: &str) -> Vec<(String, &'static Unit)> {
    let mut splits = Vec::new();
    let mut add = |stem: &str, unit: &str| {
        if let Some(unit) = Unit::parse(unit) {
            splits.push((stem.trim().to_owned(), unit));
        }
    };
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        if let Some(start) = name.rfind(open)
            && let Some(length) = name[start..].find(close)
        {
            let inside = &name[start + 1..start + length];
            add(&format!("{} {}", &name[..start], &name[start + length + close.len_utf8()..]), inside);
        }
    }
    if let Some((stem, unit)) = name.split_once('/') {
        add(stem, unit);
    }
    for separator in [" in ", ", ", ":", ",", "_", " ", "-", "."] {
        // "5 kg" is a load, not a 5 in kilograms.
        if let Some((stem, unit)) = name.rsplit_once(separator)
            // Within brackets is a unit that is not known as a whole, such as `[x10 N]` or `[pi rad]`.
            && !has_open_bracket(stem)
            && (separator != " " || (load_in(name).is_none() && angle_in(name).is_none()))
        {
            add(stem, unit);
        }
    }
    // A single letter is a symbol only in its own case: `n` counts readings.
    if name.chars().count() > 1 || Unit::parse(name).is_some_and(|unit| unit.name == name) {
        add("", name);
    }
    splits
}

/// Whether a bracket is open at the end of a text.
fn has_open_bracket(text: &str) -> bool {
    [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')]
        .into_iter()
        .any(|(open, close)| text.rfind(open).is_some_and(|at| !text[at..].contains(close)))
}

/// Whether a name has a factor before its unit, such as `Force x 10` or `F * 2`. The letter is a factor only before a power of
/// ten: `x 1` is an axis.
fn has_factor(stem: &str) -> bool {
    let is_power = |digits: &str| digits.starts_with("10") && digits[1..].bytes().all(|byte| byte == b'0');
    let mut before = ' ';
    let mut characters = stem.char_indices();
    characters.any(|(at, c)| {
        let rest = stem[at + c.len_utf8()..].trim_start();
        let digits = &rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())];
        let is_factor = match c {
            '*' | '\u{d7}' => !digits.is_empty(),
            'x' | 'X' => !before.is_alphanumeric() && is_power(digits),
            _ => false,
        };
        before = c;
        is_factor
    })
}

/// Combines the words of a stem with a unit; `None` if they contradict each other.
fn combine(stem: &str, unit: Option<&'static Unit>) -> Option<NameReading> {
    let words = words(stem);
    let fits = |quantity: &Quantity| unit.is_none_or(|unit| quantity.dimensions().contains(&unit.dimension));
    let direction = match stem.trim_end().chars().next_back() {
        Some('+') => Some(Direction::Concentric),
        Some('-' | '\u{2212}') => Some(Direction::Eccentric),
        _ => direction_in_name(&words),
    };
    let (load, angle) = (load_in(stem), angle_in(stem));
    let possible = quantities(&words);
    let is_force = |unit: &Unit| unit.dimension == Dimension::Force;
    let named = possible.iter().copied().find(fits);
    let by_unit = unit.and_then(|unit| match unit.dimension {
        Dimension::Force => Some(Quantity::Force),
        Dimension::Time if words.is_empty() => Some(Quantity::Time),
        Dimension::Length if words.is_empty() => Some(Quantity::Position),
        Dimension::Angle if words.is_empty() => Some(Quantity::WrapAngle),
        // A logger of one load cell.
        Dimension::Signal if words.is_empty() => Some(Quantity::Force),
        _ => None,
    });
    let quantity = match (named, by_unit) {
        // A unit that contradicts every word.
        (None, None) if unit.is_some() && (!possible.is_empty() || words.is_empty()) => return None,
        // "Load up [N]" is a reading, "Load [N]" may be the declared load.
        (Some(Quantity::Load), _) if direction.is_some() && unit.is_none_or(is_force) => {
            Some(Quantity::Force)
        }
        (Some(quantity), _) => Some(quantity),
        (None, by_unit) if possible.is_empty() || unit.is_some_and(is_force) => by_unit,
        _ => None,
    };
    // A column that is named by its direction, load or trial alone: "pull", "2 kg up", "Trial 3
    // [N]".
    let number = words.iter().find_map(|word| word.parse::<u32>().ok()).filter(|n| *n <= 1000);
    let is_reading = unit.is_none_or(|unit| Quantity::Force.dimensions().contains(&unit.dimension));
    let quantity = match quantity {
        None if direction.is_some() && is_reading => Some(Quantity::Force),
        None if (load.is_some() || angle.is_some()) && is_reading && possible.is_empty() => {
            Some(Quantity::Force)
        }
        Some(Quantity::Repetition | Quantity::Series) if unit.is_some_and(is_force) => Some(Quantity::Force),
        other => other,
    };
    let quantity = quantity.filter(|quantity| *quantity != Quantity::Force || !is_friction(&words));
    let is_wide = quantity == Some(Quantity::Force);
    Some(NameReading {
        quantity,
        unit,
        direction: direction.filter(|_| is_wide),
        load: load.filter(|_| is_wide),
        angle: angle.filter(|_| is_wide),
        repetition: number.filter(|_| is_wide && load.is_none() && angle.is_none()),
        is_named: named.is_some() || direction.is_some(),
    })
}

/// Finds a load in a stem, such as `5 kg` or `10N`.
pub(crate) fn load_in(stem: &str) -> Option<(Decimal, &'static Unit)> {
    value_in(stem, Quantity::Load)
}

/// Finds a wrap angle in a stem, such as `90 deg`, in degrees.
fn angle_in(stem: &str) -> Option<Decimal> {
    value_in(stem, Quantity::WrapAngle).map(|(value, unit)| value.times(unit.factor))
}

/// Finds a number with a unit of a quantity. A separator before three digits has two readings: see [`either_load`].
fn value_in(stem: &str, quantity: Quantity) -> Option<(Decimal, &'static Unit)> {
    texts_in(stem, quantity).find_map(|(text, unit)| {
        let value =
            number::parse(&text.replace(',', "."), DecimalSign::Point).filter(|_| !is_either(text))?;
        value.1.is_none().then_some((value.0, unit))
    })
}

/// Finds a load with a separator before three digits, such as `1,000 g`: with a decimal separator, and with one for thousands.
pub(crate) fn either_load(stem: &str) -> Option<[(Decimal, &'static Unit); 2]> {
    let (text, unit) = texts_in(stem, Quantity::Load).find(|(text, _)| is_either(text))?;
    let value = |sign| number::parse(text, sign).map(|(value, _)| (value, unit));
    let (point, comma) = (value(DecimalSign::Point)?, value(DecimalSign::Comma)?);
    Some(if text.contains(',') { [comma, point] } else { [point, comma] })
}

fn is_either(text: &str) -> bool {
    matches!(sign_evidence(text), Some(SignEvidence::EitherPoint | SignEvidence::EitherComma))
}

/// The numbers of a stem that a unit of the quantity follows.
fn texts_in(stem: &str, quantity: Quantity) -> impl Iterator<Item = (&str, &'static Unit)> {
    let starts = stem.char_indices().filter(|(at, c)| {
        c.is_ascii_digit() && !stem[..*at].ends_with(|p: char| p.is_alphanumeric() || p == '.' || p == ',')
    });
    starts.filter_map(move |(at, _)| {
        let rest = &stem[at..];
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == ',')).unwrap_or(rest.len());
        let after = rest[digits..].trim_start_matches(' ');
        let letters = after.find(|c: char| !(c.is_alphabetic() || c == '°')).unwrap_or(after.len());
        let unit = Unit::parse(&after[..letters]).filter(|u| quantity.dimensions().contains(&u.dimension))?;
        Some((&rest[..digits], unit))
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn units_are_found_in_names() {
        for (name, quantity, unit) in [
            ("Force [kN]", Quantity::Force, "kN"),
            ("Load (lbf)", Quantity::Load, "lbf"),
            ("t/ms", Quantity::Time, "ms"),
            ("time_ms", Quantity::Time, "ms"),
            ("force_N", Quantity::Force, "N"),
            ("Kraft in mN", Quantity::Force, "mN"),
            ("Zeit, s", Quantity::Time, "s"),
            ("Weg mm", Quantity::Position, "mm"),
            ("v/mm/s", Quantity::Speed, "mm/s"),
            ("Last [kg]", Quantity::Load, "kg"),
            ("load_mass_g", Quantity::LoadMass, "g"),
            ("speed_pct", Quantity::Speed, "%"),
            ("kN", Quantity::Force, "kN"),
            ("Response [N]", Quantity::Force, "N"),
            ("millis", Quantity::Time, "ms"),
        ] {
            let reading = read(name, None);
            assert_eq!(reading.quantity, Some(quantity), "{name}");
            assert_eq!(reading.unit.map(|unit| unit.name), Some(unit), "{name}");
        }
        for name in ["Response (Trigger) [m/s^2]", "Temperature [C]", "Comment", "Source_file"] {
            assert_eq!(read(name, None).quantity, None, "{name}");
        }
    }

    #[test]
    fn a_factor_before_the_unit_is_no_unit() {
        for name in ["Force [x10 N]", "Force x 10 [N]", "Force (*1000 N)", "Angle (x π rad)"] {
            assert_eq!(read(name, None).unit, None, "{name}");
        }
        assert_eq!(read("Angle [pi rad]", None).unit.map(|unit| unit.name), Some("pi rad"));
        assert_eq!((read("n", None).quantity, read("N", None).quantity), (None, Some(Quantity::Force)));
        assert_eq!(read("Fx [N]", None).unit.map(|unit| unit.name), Some("N"));
        for name in ["X1 [mm]", "F_x1 [N]", "accel x 2 [mm]", "x 1 [mm]"] {
            assert!(read(name, None).unit.is_some(), "{name}");
        }
    }

    #[test]
    fn a_thousand_in_a_name_has_two_readings() {
        assert_eq!(load_in("1,000 g up"), None);
        let [small, large] = either_load("1,000 g up").unwrap().map(|(value, _)| value.to_f64());
        assert_eq!([small, large], [1.0, 1000.0]);
        assert_eq!(either_load("1.500 kg").unwrap().map(|(value, _)| value.to_f64()), [1.5, 1500.0]);
        assert!(either_load("1.5 kg").is_none() && load_in("1.5 kg").is_some());
    }

    #[test]
    fn wide_columns_name_what_differs() {
        let lifted = read("F_heben [N]", None);
        assert_eq!((lifted.quantity, lifted.direction), (Some(Quantity::Force), Some(Direction::Concentric)));
        let released = read("Release (N)", None);
        assert_eq!(
            (released.quantity, released.direction),
            (Some(Quantity::Force), Some(Direction::Eccentric))
        );
        let at_load = read("F down 2.5 kg [N]", None);
        assert_eq!(at_load.load.map(|l| (l.0.to_f64(), l.1.name)), Some((2.5, "kg")));
        assert_eq!(at_load.direction, Some(Direction::Eccentric));
        assert_eq!(read("Trial 3 [N]", None).repetition, Some(3));
        let at_angle = read("45° up [N]", None);
        assert_eq!((at_angle.angle.map(Decimal::to_f64), at_angle.repetition), (Some(45.0), None));
        assert_eq!(read("F- (N)", None).direction, Some(Direction::Eccentric));
        assert_eq!(read("Fup", None).direction, Some(Direction::Concentric));
        // Friction may be the pull or the pull minus the load.
        let quantities = |names: [&str; 2]| names.map(|name| read(name, None).quantity);
        assert_eq!(quantities(["friction (N)", "Reibkraft up [N]"]), [None, None]);
        let others = ["Friction test load [N]", "friction test time [s]"];
        assert_eq!(quantities(others), [Some(Quantity::Load), Some(Quantity::Time)]);
        // Forces at both ends of the tendon.
        assert_eq!((read("F_in [N]", None).direction, read("F_out [N]", None).direction), (None, None));
    }

    proptest! {
        #[test]
        fn any_name_is_read(name in any::<String>()) {
            let _ = read(&name, None);
        }

        #[test]
        fn names_of_signs_are_read(name in "[a-zA-Z0-9 .,_/()\\[\\]°µ-]{0,30}") {
            let _ = read(&name, None);
        }
    }
}
