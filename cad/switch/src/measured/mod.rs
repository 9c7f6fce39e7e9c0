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

use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};
use pinswitch_friction::{FrictionCurve, Transition, predict};
use serde::Serialize;
use toml_edit::{Document, Item, Value};

use crate::config::parameter::number;
use crate::config::syntax_error;
use crate::design::Design;
use crate::prediction::loads_n;
use crate::process::{Process, mix_ratio};

/// A quantity that can be measured on a made switch.
struct Quantity {
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    /// Accepted readings.
    range: [f64; 2],
    planned: fn(&Design) -> f64,
    /// Sets it in the bed of the contact; a quantity that changes only the fit of the parts does nothing.
    apply: fn(&mut Bed, f64),
}

const SLOT: usize = 7;
const PIN: usize = 0;
const THICKNESS: usize = 1;
const HARDNESS: usize = 3;

/// Every quantity, in the order in which it is reported.
static QUANTITIES: [Quantity; 8] = [
    Quantity {
        key: "pin_diameter_mm",
        name: "pin diameter",
        unit: "mm",
        range: [0.05, 6.0],
        planned: |d| d.configuration().pins.diameter_mm,
        apply: |bed, value| bed.pin_diameter_mm = value,
    },
    Quantity {
        key: "layer_thickness_mm",
        name: "layer thickness",
        unit: "mm",
        range: [0.2, 12.0],
        planned: |d| d.configuration().silicone.thickness_mm,
        apply: |bed, value| {
            bed.contact_radius_mm += value - bed.layer_mm;
            bed.layer_mm = value;
        },
    },
    Quantity {
        key: "layer_width_mm",
        name: "layer width",
        unit: "mm",
        range: [0.5, 120.0],
        planned: |d| d.layer_width_mm(),
        apply: |bed, value| bed.layer_width_mm = value,
    },
    Quantity {
        key: "hardness_shore_a",
        name: "hardness of the layer",
        unit: "Shore A",
        range: [5.0, 90.0],
        planned: |d| d.configuration().silicone.hardness_shore_a,
        apply: |bed, value| bed.modulus_mpa = modulus_of_shore_a_mpa(value),
    },
    Quantity {
        key: "tendon_diameter_mm",
        name: "tendon diameter over the coating",
        unit: "mm",
        range: [0.1, 12.0],
        planned: |d| d.tendon_diameter_mm(),
        apply: |bed, value| bed.tendon_radius_mm = value / 2.0,
    },
    Quantity {
        key: "groove_radius_mm",
        name: "radius of the grooves in the layer",
        unit: "mm",
        range: [0.05, 4.0],
        planned: |d| d.configuration().segment.groove_radius_mm,
        apply: |bed, value| bed.groove_radius_mm = value,
    },
    Quantity {
        key: "shell_radius_mm",
        name: "radius of the shell's face",
        unit: "mm",
        range: [4.0, 160.0],
        planned: |d| d.shell_radius_mm(),
        apply: |bed, value| bed.contact_radius_mm = value + bed.layer_mm,
    },
    Quantity {
        key: "slot_width_mm",
        name: "width of the slots",
        unit: "mm",
        range: [0.05, 8.0],
        planned: |d| d.slot().width_mm,
        apply: |_, _| {},
    },
];

/// Least and largest clearance between pin and slot, mm (cad/doc/print-limits.md).
const CLEARANCE_MM: [f64; 2] = [0.1, 0.4];
/// Standard deviation of a durometer's reading, Shore A. Chosen: its resolution.
const DUROMETER_SHORE_A: f64 = 1.0;
/// Half width of a normal distribution at 95 %.
const NORMAL_95: f64 = 1.96;
/// Steps of the search for a hardness that restores the threshold.
const BISECTIONS: usize = 30;

/// The readings of a made switch.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Index of the quantity and its readings.
    readings: Vec<(usize, Vec<f64>)>,
}

/// One measured quantity next to its planned value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredQuantity {
    /// Key in the file.
    pub key: &'static str,
    /// Name.
    pub name: &'static str,
    /// Unit of both values.
    pub unit: &'static str,
    /// Planned value.
    pub planned: f64,
    /// Mean of the readings.
    pub measured: f64,
    /// Number of readings.
    pub readings: usize,
    /// Change of the threshold from this quantity alone, N; absent without a threshold.
    pub threshold_change_n: Option<f64>,
    /// Relative change of friction at the heaviest load from this quantity alone.
    pub friction_change: f64,
}

/// A made switch compared with its plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Measured quantities.
    pub quantities: Vec<MeasuredQuantity>,
    /// Threshold of the plan, N; absent if it is outside of the curve.
    pub planned_threshold_n: Option<f64>,
    /// Threshold of the made switch, N.
    pub measured_threshold_n: Option<f64>,
    /// Half of the 95 % interval of the planned threshold from the scatter of castings, N.
    pub scatter_n: Option<f64>,
    /// Heaviest load of the curve, N, and friction there of the plan and of the made switch, N.
    pub load_n: f64,
    /// Friction of the plan at that load, N.
    pub planned_friction_n: f64,
    /// Friction of the made switch at that load, N.
    pub measured_friction_n: f64,
    /// What to do.
    pub advice: Vec<String>,
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
            let Some(index) = QUANTITIES.iter().position(|q| q.key == key) else {
                return Err(Diagnostic::new(format!("unknown quantity {key:?}"))
                    .with_location(location)
                    .with_help(format!("the quantities are {}", keys())));
            };
            let quantity = &QUANTITIES[index];
            let [low, high] = quantity.range;
            let help = format!("give one reading or a list of them, from {low} to {high} {}", quantity.unit);
            let refuse = |problem: &str| {
                let location = location.clone().with_field(key, item.to_string().trim());
                Diagnostic::new(problem).with_location(location).with_help(help.clone())
            };
            let values: Vec<f64> = match item {
                Item::Value(Value::Array(list)) => list.iter().map(number).collect::<Option<Vec<f64>>>(),
                Item::Value(value) => number(value).map(|reading| vec![reading]),
                _ => None,
            }
            .filter(|values| !values.is_empty())
            .ok_or_else(|| refuse("not a reading"))?;
            if values.iter().any(|v| !(low..=high).contains(v)) {
                return Err(refuse(&format!("outside {low} to {high}")));
            }
            readings.push((index, values));
        }
        if readings.is_empty() {
            let problem = Diagnostic::new("nothing is measured").with_location(Location::file(file));
            return Err(problem.with_help(format!("give at least one of {}", keys())));
        }
        readings.sort_by_key(|(index, _)| *index);
        Ok(Self { readings })
    }

    fn mean(&self, index: usize) -> Option<f64> {
        let (_, values) = self.readings.iter().find(|(i, _)| *i == index)?;
        Some(values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Returns a bed with these measured quantities, of those that `include` accepts.
    fn bed(&self, planned: &Bed, include: impl Fn(usize) -> bool) -> Bed {
        let mut bed = *planned;
        for (index, _) in self.readings.iter().filter(|(index, _)| include(*index)) {
            if let Some(mean) = self.mean(*index) {
                (QUANTITIES[*index].apply)(&mut bed, mean);
            }
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
            Some(shore_a) => {
                let modulus = modulus_of_shore_a_mpa;
                (modulus(shore_a + DUROMETER_SHORE_A) - modulus(shore_a - DUROMETER_SHORE_A))
                    / (2.0 * modulus(shore_a))
            }
        };
        design.with_contact(contact.with_bed(bed).with_modulus_scatter(scatter))
    }

    /// Compares the made switch with its plan.
    pub fn compare(&self, design: &Design) -> Comparison {
        let loads = loads_n(design);
        let contact = design.contact();
        let with = |bed: Bed| predict(&contact.clone().with_bed(bed), &loads);
        let threshold = |curve: &FrictionCurve| Transition::of(curve).map(|t| t.threshold_n);
        let heaviest = |curve: &FrictionCurve| curve.friction_n.last().copied().unwrap_or_default();
        let planned = with(*contact.bed());
        let made = with(self.bed(contact.bed(), |_| true));
        let difference = |a: Option<f64>, b: Option<f64>| Some(a? - b?);
        let quantities = self
            .readings
            .iter()
            .map(|(index, values)| {
                let quantity = &QUANTITIES[*index];
                let alone = with(self.bed(contact.bed(), |i| i == *index));
                MeasuredQuantity {
                    key: quantity.key,
                    name: quantity.name,
                    unit: quantity.unit,
                    planned: (quantity.planned)(design),
                    measured: self.mean(*index).unwrap_or_default(),
                    readings: values.len(),
                    threshold_change_n: difference(threshold(&alone), threshold(&planned)),
                    friction_change: heaviest(&alone) / heaviest(&planned) - 1.0,
                }
            })
            .collect();
        let scaled = |factor: f64| {
            let bed = contact.bed();
            threshold(&with(Bed { modulus_mpa: factor * bed.modulus_mpa, ..*bed }))
        };
        let relative = contact.modulus_scatter();
        let scatter_n = difference(scaled(1.0 + relative), scaled(1.0 - relative))
            .map(|width| NORMAL_95 * width.abs() / 2.0);
        let mut comparison = Comparison {
            quantities,
            planned_threshold_n: threshold(&planned),
            measured_threshold_n: threshold(&made),
            scatter_n,
            load_n: loads.last().copied().unwrap_or_default(),
            planned_friction_n: heaviest(&planned),
            measured_friction_n: heaviest(&made),
            advice: Vec::new(),
        };
        comparison.advice = self.advice(design, &comparison);
        comparison
    }

    /// What to do about the differences, most useful first.
    fn advice(&self, design: &Design, comparison: &Comparison) -> Vec<String> {
        let mut advice: Vec<String> = self.fit_of_pins(design).into_iter().collect();
        let (Some(planned), Some(made)) = (comparison.planned_threshold_n, comparison.measured_threshold_n)
        else {
            advice.push(format!(
                "no threshold within the loads of the curve: compare friction at {:.2} N, {:.2} N for {:.2} N",
                comparison.load_n, comparison.measured_friction_n, comparison.planned_friction_n
            ));
            return advice;
        };
        let scatter = comparison.scatter_n.unwrap_or(0.0);
        if (made - planned).abs() <= scatter {
            advice.push(format!(
                "nothing to change: the threshold differs by {:+.2} N, and castings scatter by ±{scatter:.2} N (95 %)",
                made - planned
            ));
            return advice;
        }
        advice.push(format!(
            "use the corrected curve: this switch switches at {made:.2} N, not at {planned:.2} N"
        ));
        advice.extend(self.hardness_to_cast(design, planned));
        if let Some(thickness) = self.mean(THICKNESS) {
            let wanted = design.configuration().silicone.thickness_mm;
            let next = (100.0 * (2.0 * wanted - thickness)).round() / 100.0;
            if (next - wanted).abs() >= 0.01 {
                advice.push(format!(
                    "to cast {wanted} mm from the next mould, generate it with silicone.thickness_mm = {next}"
                ));
            }
        }
        advice
    }

    /// Whether the pins slide in their slots.
    fn fit_of_pins(&self, design: &Design) -> Option<String> {
        if self.mean(SLOT).is_none() && self.mean(PIN).is_none() {
            return None;
        }
        let pin = self.mean(PIN).unwrap_or(design.configuration().pins.diameter_mm);
        let slot = self.mean(SLOT).unwrap_or(design.slot().width_mm);
        let (clearance, [least, most]) = (slot - pin, CLEARANCE_MM);
        if clearance < least {
            return Some(format!(
                "pins stick: {clearance:.2} mm of clearance, at least {least} mm needed: widen the slots to {:.2} mm",
                pin + least
            ));
        }
        (clearance > most).then(|| {
            format!(
                "pins tilt: {clearance:.2} mm of clearance, at most {most} mm allowed: print the supports again with \
                 support.slot_clearance_mm = {:.2}",
                (design.configuration().support.slot_clearance_mm - (clearance - most)).max(least)
            )
        })
    }

    /// The hardness that a new layer needs to switch at the planned load in the parts as made.
    fn hardness_to_cast(&self, design: &Design, planned_n: f64) -> Option<String> {
        let loads = loads_n(design);
        let bed = self.bed(design.contact().bed(), |index| index != HARDNESS);
        let threshold = |shore_a: f64| {
            let bed = Bed { modulus_mpa: modulus_of_shore_a_mpa(shore_a), ..bed };
            let curve = predict(&design.contact().clone().with_bed(bed), &loads);
            // Beyond the curve, the pins carry every load.
            Transition::of(&curve).map_or(f64::INFINITY, |t| t.threshold_n)
        };
        let (mut soft, mut hard) = (20.0, 75.0);
        if !(threshold(soft) < planned_n && threshold(hard) > planned_n) {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(soft, hard);
            if threshold(middle) < planned_n { soft = middle } else { hard = middle }
        }
        let shore_a = (10.0 * soft).round() / 10.0;
        let mut next = design.configuration().clone();
        if (shore_a - next.silicone.hardness_shore_a).abs() < DUROMETER_SHORE_A {
            return None;
        }
        next.silicone.hardness_shore_a = shore_a;
        let process = Process::of(&next);
        let how = match (process.silicone, process.mould_cure, process.post_cure) {
            (Some(silicone), Some(cure), post) => {
                let post = post.map_or(String::new(), |post| format!(", then post-cure it for {post}"));
                format!("{} {}:1, {cure} in the mould{post}", silicone.name, mix_ratio(&next))
            }
            _ => process
                .conflicts
                .first()
                .map_or_else(|| "see the package of your silicone".to_owned(), |c| c.help.clone()),
        };
        Some(format!(
            "to switch at {planned_n:.2} N with these parts, cast a layer of {shore_a} Shore A: {how}"
        ))
    }
}

impl Comparison {
    /// Returns the comparison as a document.
    pub fn text(&self) -> String {
        use std::fmt::Write as _;
        let mut text = "# As measured\n\n| quantity | planned | measured | readings | threshold | friction |\n|---|---|---|---|---|---|\n".to_owned();
        for q in &self.quantities {
            let threshold = q.threshold_change_n.map_or_else(|| "-".to_owned(), |n| format!("{n:+.2} N"));
            let _ = writeln!(
                text,
                "| {} | {:.3} {unit} | {:.3} {unit} | {} | {threshold} | {:+.1} % |",
                q.name,
                q.planned,
                q.measured,
                q.readings,
                100.0 * q.friction_change,
                unit = q.unit
            );
        }
        let newtons =
            |n: Option<f64>| n.map_or_else(|| "outside the curve".to_owned(), |n| format!("{n:.2} N"));
        let _ = write!(
            text,
            "\nThe last two columns are the changes from each quantity alone; friction at {:.2} N.\n\n| | planned | as measured |\n\
             |---|---|---|\n| switches at | {} | {} |\n| friction at {:.2} N | {:.2} N | {:.2} N |\n\n## What to do\n\n",
            self.load_n,
            newtons(self.planned_threshold_n),
            newtons(self.measured_threshold_n),
            self.load_n,
            self.planned_friction_n,
            self.measured_friction_n
        );
        for advice in &self.advice {
            let (first, rest) = advice.split_at(1);
            let _ = writeln!(text, "- {}{rest}.", first.to_uppercase());
        }
        text
    }
}

#[cfg(test)]
mod tests;
