//! Values in the names of files, such as `2kg_3.csv`.

use std::collections::BTreeMap;

use pinswitch_diagnostic::{Diagnostic, Location, codes};

use crate::decimal::Decimal;
use crate::name;
use crate::quantity::Quantity;
use crate::unit::Dimension;

/// A pattern of file names, such as `{load_g}g_{trial}.csv`.
///
/// ```
/// use pinswitch_import::Pattern;
///
/// let pattern = Pattern::parse("{load_g}g_{trial}.csv")?;
/// let values = pattern.values("500g_2.csv").ok_or("does not match")?;
/// assert_eq!(values["load_mass_g"], "500");
/// assert_eq!(values["repetition"], "2");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    parts: Vec<Part>,
}

#[derive(Clone, Debug, PartialEq)]
enum Part {
    Text(String),
    Field(Field),
}

#[derive(Clone, Debug, PartialEq)]
struct Field {
    /// Constant that the field sets; `None` for a field that is ignored.
    constant: Option<&'static str>,
    is_number: bool,
    factor: Decimal,
}

impl Pattern {
    /// Parses a pattern. A field is a name in braces, such as `{load_kg}`, `{direction}` or
    /// `{trial}`; `{_}` is ignored.
    ///
    /// # Errors
    /// A [`Diagnostic`] for an unknown field and for braces without a partner.
    pub fn parse(text: &str) -> Result<Self, Diagnostic> {
        let refused = |problem: &str| {
            Diagnostic::new(codes::PATTERN_MISMATCH, problem)
                .with_location(Location::field("--pattern", text))
                .with_help("write it like \"{load_g}g_{trial}.csv\"; fields are load_g, load_kg, load_N, direction, trial, \
                    angle_deg, speed_pct, series, session, mount, operator, specimen and _")
        };
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}').ok_or_else(|| refused("a brace is not closed"))?;
            if !before.is_empty() {
                parts.push(Part::Text(before.to_owned()));
            }
            if matches!(parts.last(), Some(Part::Field(_))) {
                return Err(refused("two fields without a text between them"));
            }
            parts.push(Part::Field(field(name).ok_or_else(|| refused(&format!("unknown field '{name}'")))?));
            rest = after;
        }
        if !rest.is_empty() {
            parts.push(Part::Text(rest.to_owned()));
        }
        if parts.iter().all(|part| matches!(part, Part::Text(_))) {
            return Err(refused("no field in braces"));
        }
        Ok(Self { parts })
    }

    /// Returns the constants in a file name; `None` if it does not match.
    pub fn values(&self, file_name: &str) -> Option<BTreeMap<String, String>> {
        let mut values = BTreeMap::new();
        matches(&self.parts, file_name, &mut values).then_some(values)
    }
}

fn field(name: &str) -> Option<Field> {
    if name == "_" {
        return Some(Field { constant: None, is_number: false, factor: Decimal::ONE });
    }
    let reading = name::read(name, None);
    let unit = reading.unit;
    let factor = unit.map_or(Decimal::ONE, |unit| unit.factor);
    let number = |constant| Some(Field { constant: Some(constant), is_number: true, factor });
    let word = |constant| Some(Field { constant: Some(constant), is_number: false, factor: Decimal::ONE });
    let is_mass = unit.is_some_and(|unit| unit.dimension == Dimension::Mass);
    match reading.quantity? {
        Quantity::Load | Quantity::LoadMass if is_mass => number("load_mass_g"),
        Quantity::Load if unit.is_some() => number("load_N"),
        Quantity::WrapAngle => number("wrap_angle_deg"),
        Quantity::Speed if unit.is_none_or(|unit| unit.dimension == Dimension::Share) => number("speed_pct"),
        Quantity::Repetition => number("repetition"),
        Quantity::Dwell => number("dwell_s"),
        Quantity::Direction => word("direction"),
        Quantity::Series => word("series"),
        Quantity::Session => word("session"),
        Quantity::Mount => word("mount"),
        Quantity::Operator => word("operator"),
        Quantity::Specimen => word("specimen"),
        Quantity::Substrate => word("substrate"),
        Quantity::Pins => word("pins"),
        _ => None,
    }
}

/// Matches the parts against a text. Each field takes the shortest text that lets the rest match;
/// every field is followed by a text, so that the work is bounded by the lengths of both.
fn matches(parts: &[Part], text: &str, values: &mut BTreeMap<String, String>) -> bool {
    match parts {
        [] => text.is_empty(),
        [Part::Text(literal), rest @ ..] => {
            text.strip_prefix(literal.as_str()).is_some_and(|after| matches(rest, after, values))
        }
        [Part::Field(field), rest @ ..] => {
            for (end, c) in text.char_indices() {
                let end = end + c.len_utf8();
                let fits_next = match rest.first() {
                    Some(Part::Text(literal)) => text[end..].starts_with(literal.as_str()),
                    _ => end == text.len(),
                };
                if fits_next
                    && let Some(value) = field.value(&text[..end])
                    && matches(rest, &text[end..], values)
                {
                    if let Some(constant) = field.constant {
                        values.insert(constant.to_owned(), value);
                    }
                    return true;
                }
            }
            false
        }
    }
}

impl Field {
    fn value(&self, text: &str) -> Option<String> {
        if !self.is_number {
            return Some(text.to_owned());
        }
        // A comma, or the p of "2p5", is the decimal sign in a file name.
        let number = Decimal::parse(&text.replace([',', 'p'], "."))?;
        Some(number.times(self.factor).to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_give_values() {
        let values = |pattern: &str, name: &str| Pattern::parse(pattern).unwrap().values(name);
        let found = values("{load_kg}kg_{angle_deg}deg_{direction}.csv", "2p5kg_90deg_up.csv").unwrap();
        let found: Vec<_> = found.iter().map(|(k, v)| format!("{k}={v}")).collect();
        assert_eq!(found, ["direction=up", "load_mass_g=2500", "wrap_angle_deg=90"]);
        assert!(values("{load_N}N.csv", "xN.csv").is_none());
        assert!(values("run{_}_{load_N}N.csv", "run7_12.5N.csv").is_some());
        for pattern in ["plain.csv", "{load_g", "{load_g}{trial}", "{colour}.csv"] {
            assert!(Pattern::parse(pattern).is_err(), "{pattern}");
        }
    }
}
