//! As measured: the curve of a switch whose parts were measured after they were made, and what to do about it.
//!
//! A file lists what was measured, one reading or several:
//!
//! ```
//! use pinswitch_switch::config::{Configuration, assign};
//! use pinswitch_switch::{design::Design, measured::Measured};
//!
//! let mut planned = Configuration::default();
//! assign(&mut planned, "layout.pins=[5, 8, 11]")?;
//! let design = Design::new(planned)?;
//! let measured = Measured::read("layer_thickness_mm = [2.11, 2.09, 2.10]\nhardness_shore_a = 46\n", "mine.toml")?;
//! let comparison = measured.compare(&design);
//! assert!(comparison.measured_threshold_n < comparison.planned_threshold_n);
//! assert!(comparison.advice.iter().any(|advice| advice.contains("silicone.thickness_mm = 1.9")));
//! # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
//! ```

mod advice;
mod comparison;
mod quantity;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_friction::physics::Bed;
use toml_edit::{Document, Item, Value};

use self::quantity::{HARDNESS, QUANTITIES, Quantity};
use crate::config::parameter::number;
use crate::config::{DIALECT, closed_object, syntax_error};
use crate::design::Design;
use crate::process::relative_modulus_sd;

pub use comparison::{Comparison, MeasuredQuantity};

/// Standard deviation of a durometer's reading, Shore A. Chosen: its resolution.
const DUROMETER_SHORE_A: f64 = 1.0;

/// The readings of a made switch.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Each quantity with its readings, in the order of [`QUANTITIES`].
    readings: Vec<(&'static Quantity, Vec<f64>)>,
}

impl Measured {
    /// Reads `text`; `file` names it in errors. Each key has one positive number, or a list of readings.
    ///
    /// # Errors
    /// A [`Diagnostic`] with the line, for invalid TOML, an unknown key, a reading that is not a number within the range of
    /// its quantity, and a file without any.
    pub fn read(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let at = |span: Option<std::ops::Range<usize>>| Location::in_text(file, text, span.unwrap_or(0..0));
        let document: Document<String> =
            text.parse().map_err(|e: toml_edit::TomlError| syntax_error(at(e.span()), e.message()))?;
        let keys = || QUANTITIES.iter().map(|q| q.key).collect::<Vec<_>>().join(", ");
        let mut readings = Vec::new();
        for (key, item) in document.as_table().iter() {
            let location = at(item.span());
            let Some(quantity) = QUANTITIES.iter().find(|q| q.key == key) else {
                return Err(Diagnostic::new(codes::UNKNOWN_FIELD, format!("unknown quantity {key:?}"))
                    .with_location(location)
                    .with_help(format!("the quantities are {}", keys())));
            };
            let [low, high] = quantity.range;
            let help = format!("give one reading or a list of them, from {low} to {high} {}", quantity.unit);
            let refuse = |code: Code, problem: &str| {
                let location = location.clone().with_field(key, item.to_string().trim());
                Diagnostic::new(code, problem).with_location(location).with_help(help.clone())
            };
            let values: Vec<f64> = match item {
                Item::Value(Value::Array(list)) => list.iter().map(number).collect::<Option<Vec<f64>>>(),
                Item::Value(value) => number(value).map(|reading| vec![reading]),
                _ => None,
            }
            .filter(|values| !values.is_empty())
            .ok_or_else(|| refuse(codes::WRONG_TYPE, "not a reading"))?;
            if values.iter().any(|v| !(low..=high).contains(v)) {
                return Err(refuse(codes::OUT_OF_RANGE, &format!("outside {low} to {high}")));
            }
            readings.push((quantity, values));
        }
        if readings.is_empty() {
            let problem = Diagnostic::new(codes::MISSING_FIELD, "nothing is measured")
                .with_location(Location::file(file));
            return Err(problem.with_help(format!("give at least one of {}", keys())));
        }
        readings.sort_by_key(|(quantity, _)| QUANTITIES.iter().position(|q| q.key == quantity.key));
        Ok(Self { readings })
    }

    /// Returns the mean of the readings of a quantity.
    fn mean(&self, key: &str) -> Option<f64> {
        self.readings.iter().find(|(quantity, _)| quantity.key == key).map(|(_, readings)| mean(readings))
    }

    /// Returns a bed with these measured quantities, of those whose key `include` accepts.
    fn bed(&self, planned: &Bed, include: impl Fn(&str) -> bool) -> Bed {
        let mut bed = *planned;
        for (quantity, readings) in self.readings.iter().filter(|(quantity, _)| include(quantity.key)) {
            (quantity.apply)(&mut bed, mean(readings));
        }
        bed
    }

    /// Returns the same design, made: its parts are those of the plan, its contact has the measured values. A measured
    /// hardness has the uncertainty of a durometer in place of the scatter of castings.
    #[must_use]
    pub fn apply(&self, design: &Design) -> Design {
        let contact = design.contact().clone();
        let bed = self.bed(contact.bed(), |_| true);
        let scatter = match self.mean(HARDNESS) {
            None => contact.modulus_scatter(),
            Some(shore_a) => relative_modulus_sd(shore_a, DUROMETER_SHORE_A),
        };
        design.with_contact(contact.with_bed(bed).with_modulus_scatter(scatter))
    }
}

/// Returns the JSON Schema (2020-12) of a file of readings.
pub fn json_schema() -> serde_json::Value {
    let property = |quantity: &Quantity| {
        let [low, high] = quantity.range;
        let reading = serde_json::json!({ "type": "number", "minimum": low, "maximum": high });
        serde_json::json!({
            "description": format!("{}, {low} to {high} {}: one reading or several", quantity.name, quantity.unit),
            "anyOf": [reading, { "type": "array", "items": reading, "minItems": 1 }],
        })
    };
    let mut schema = closed_object(QUANTITIES.iter().map(|q| (q.key.to_owned(), property(q))).collect());
    schema["$schema"] = serde_json::json!(DIALECT);
    schema["title"] = serde_json::json!("Readings of a made friction switch (pinswitch)");
    schema["minProperties"] = serde_json::json!(1);
    schema
}

/// Mean of at least one reading.
fn mean(readings: &[f64]) -> f64 {
    readings.iter().sum::<f64>() / readings.len() as f64
}

#[cfg(test)]
mod tests;
