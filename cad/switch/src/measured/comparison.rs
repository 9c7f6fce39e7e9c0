//! A made switch next to its plan.

use pinswitch_friction::physics::Bed;
use pinswitch_friction::{FrictionCurve, NORMAL_95, Transition, predict};
use schemars::JsonSchema;
use serde::Serialize;

use super::{Measured, mean};
use crate::design::Design;
use crate::prediction::loads_n;

/// One measured quantity next to its planned value.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
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
            .map(|(quantity, readings)| {
                let alone = with(self.bed(contact.bed(), |key| key == quantity.key));
                MeasuredQuantity {
                    key: quantity.key,
                    name: quantity.name,
                    unit: quantity.unit,
                    planned: (quantity.planned)(design),
                    measured: mean(readings),
                    readings: readings.len(),
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
