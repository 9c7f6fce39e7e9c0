//! Units and their exact factors.

use crate::decimal::Decimal;

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Base N.
    Force,
    /// Base g.
    Mass,
    /// Base s.
    Time,
    /// Base mm.
    Length,
    /// Base degree.
    Angle,
    /// Base percent.
    Share,
    /// Base W.
    Power,
    /// Base mm/s.
    Speed,
    /// Reading of a converter or a bridge, which needs a calibration line.
    Signal,
}

/// A unit of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Symbol.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Factor to the base of its dimension.
    pub factor: Decimal,
    aliases: &'static [&'static str],
}

/// Standard gravity in newtons per gram.
pub(crate) const NEWTON_PER_GRAM: Decimal = Decimal::new(980_665, -8);

const fn unit(
    name: &'static str,
    dimension: Dimension,
    digits: u128,
    exponent: i32,
    aliases: &'static [&'static str],
) -> Unit {
    Unit { name, dimension, factor: Decimal::new(digits, exponent), aliases }
}

/// All units. Sources: SI brochure; NIST SP 811, appendix B, for pound, ounce, inch and foot.
const UNITS: [Unit; 47] = [
    unit("N", Dimension::Force, 1, 0, &["newton", "newtons", "nw"]),
    unit("kN", Dimension::Force, 1, 3, &["kilonewton", "kilonewtons"]),
    unit("MN", Dimension::Force, 1, 6, &["meganewton"]),
    unit("mN", Dimension::Force, 1, -3, &["millinewton", "millinewtons"]),
    unit("cN", Dimension::Force, 1, -2, &["centinewton"]),
    unit("daN", Dimension::Force, 1, 1, &["dekanewton", "decanewton"]),
    unit("uN", Dimension::Force, 1, -6, &["µn", "micronewton"]),
    unit("gf", Dimension::Force, 980_665, -8, &["gram-force", "gramforce", "g-force", "p", "pond"]),
    unit("kgf", Dimension::Force, 980_665, -5, &["kp", "kilopond", "kg-force", "kgforce", "kilogram-force"]),
    unit("lbf", Dimension::Force, 44_482_216_152_605, -13, &["lb-f", "pound-force", "poundforce", "lbsf"]),
    unit("ozf", Dimension::Force, 27_801_385_095_378_125, -17, &["ounce-force"]),
    unit("g", Dimension::Mass, 1, 0, &["gram", "grams", "gramm", "gr", "grammes", "gramos", "grammi"]),
    unit("kg", Dimension::Mass, 1, 3, &["kilogram", "kilograms", "kilogramm", "kilo", "kilos", "kgs"]),
    unit("mg", Dimension::Mass, 1, -3, &["milligram", "milligrams"]),
    unit("lb", Dimension::Mass, 45_359_237, -5, &["lbs", "pound", "pounds"]),
    unit("oz", Dimension::Mass, 28_349_523_125, -9, &["ounce", "ounces"]),
    unit(
        "s",
        Dimension::Time,
        1,
        0,
        &[
            "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden", "secondes", "segundos",
            "secondi",
        ],
    ),
    unit(
        "ms",
        Dimension::Time,
        1,
        -3,
        &["msec", "msecs", "millis", "millisecond", "milliseconds", "millisekunden"],
    ),
    unit(
        "us",
        Dimension::Time,
        1,
        -6,
        &["µs", "usec", "micros", "microsecond", "microseconds", "mikrosekunden"],
    ),
    unit("ns", Dimension::Time, 1, -9, &["nanosecond", "nanoseconds"]),
    unit("min", Dimension::Time, 60, 0, &["mins", "minute", "minutes", "minuten"]),
    unit("h", Dimension::Time, 3600, 0, &["hr", "hrs", "hour", "hours", "std", "stunden"]),
    unit("d", Dimension::Time, 86_400, 0, &["day", "days", "tag", "tage", "jours", "dias", "giorni"]),
    unit("mm", Dimension::Length, 1, 0, &["millimeter", "millimeters", "millimetre", "millimetres"]),
    unit("cm", Dimension::Length, 1, 1, &["centimeter", "centimeters", "centimetre", "zentimeter"]),
    unit("m", Dimension::Length, 1, 3, &["meter", "meters", "metre", "metres"]),
    unit("um", Dimension::Length, 1, -3, &["µm", "micron", "microns", "micrometer", "micrometre"]),
    unit("in", Dimension::Length, 254, -1, &["inch", "inches", "zoll", "\""]),
    unit("ft", Dimension::Length, 3048, -1, &["feet", "foot"]),
    unit(
        "deg",
        Dimension::Angle,
        1,
        0,
        &["°", "degree", "degrees", "grad", "degre", "degres", "grados", "gradi"],
    ),
    unit("rad", Dimension::Angle, 57_295_779_513_082_320_876_798_154_814_105, -30, &["radian", "radians"]),
    unit("pi rad", Dimension::Angle, 180, 0, &["π rad", "pi*rad", "π", "pi"]),
    unit(
        "turns",
        Dimension::Angle,
        360,
        0,
        &["turn", "rev", "revs", "revolution", "revolutions", "umdrehung", "umdrehungen", "u"],
    ),
    unit("%", Dimension::Share, 1, 0, &["pct", "percent", "prozent"]),
    unit("W", Dimension::Power, 1, 0, &["watt", "watts"]),
    unit("mW", Dimension::Power, 1, -3, &["milliwatt"]),
    unit("kW", Dimension::Power, 1, 3, &["kilowatt"]),
    unit("mm/s", Dimension::Speed, 1, 0, &["mm s-1", "mm*s-1", "mmps"]),
    unit("cm/s", Dimension::Speed, 1, 1, &[]),
    unit("m/s", Dimension::Speed, 1, 3, &["m s-1", "mps"]),
    unit("mm/min", Dimension::Speed, 1_666_666_666_666_666_666_666_666_666_667, -32, &["mm/minute"]),
    unit("in/s", Dimension::Speed, 254, -1, &["inch/s"]),
    unit("V", Dimension::Signal, 1, 0, &["volt", "volts"]),
    unit("mV", Dimension::Signal, 1, 0, &["millivolt", "millivolts"]),
    unit("mV/V", Dimension::Signal, 1, 0, &[]),
    unit(
        "counts",
        Dimension::Signal,
        1,
        0,
        &["count", "cts", "lsb", "digits", "raw", "adc", "ticks", "bits"],
    ),
    unit("mA", Dimension::Signal, 1, 0, &["milliampere"]),
];

impl Unit {
    /// Finds the unit with this symbol or name; `None` if there is none. Case decides only between
    /// `mN` and `MN`.
    pub fn parse(text: &str) -> Option<&'static Self> {
        let text =
            text.trim().trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']).trim().trim_end_matches('.');
        if text.is_empty() || text.len() > 20 {
            return None;
        }
        // Greek mu and the micro sign look alike.
        let text = text.replace('\u{3bc}', "µ");
        if let Some(unit) = UNITS.iter().find(|unit| unit.name == text) {
            return Some(unit);
        }
        let lower = text.to_lowercase();
        if lower == "mn" {
            return UNITS.iter().find(|unit| unit.name == "mN");
        }
        UNITS
            .iter()
            .find(|unit| unit.name.eq_ignore_ascii_case(&lower) || unit.aliases.contains(&lower.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_unique_names() {
        for unit in &UNITS {
            assert_eq!(Unit::parse(unit.name), Some(unit));
            for alias in unit.aliases {
                assert_eq!(Unit::parse(alias), Some(unit), "{alias}");
            }
        }
    }

    #[test]
    fn spellings_of_machines_are_read() {
        for (text, name) in [
            ("(kN)", "kN"),
            ("[N]", "N"),
            ("KN", "kN"),
            ("Newtons", "N"),
            ("μs", "us"),
            ("Sec.", "s"),
            ("\"", "in"),
        ] {
            assert_eq!(Unit::parse(text).map(|unit| unit.name), Some(name), "{text}");
        }
        for text in ["", "m/s^2", "Trigger", "x"] {
            assert_eq!(Unit::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_pound_of_mass_weighs_a_pound_of_force() {
        let weight = |name| Unit::parse(name).unwrap().factor;
        assert_eq!(weight("lb").times(NEWTON_PER_GRAM).to_f64(), weight("lbf").to_f64());
        assert_eq!(weight("oz").times(NEWTON_PER_GRAM).to_f64(), weight("ozf").to_f64());
    }
}
