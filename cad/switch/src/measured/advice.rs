//! What to do about a made switch that differs from its plan.

use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};
use pinswitch_friction::{Transition, predict};

use super::comparison::Comparison;
use super::quantity::{HARDNESS, PIN, SLOT, THICKNESS};
use super::{DUROMETER_SHORE_A, Measured};
use crate::design::Design;
use crate::prediction::loads_n;
use crate::process::{Process, mix_ratio};

/// Least and largest clearance between pin and slot, mm (cad/doc/print-limits.md).
const CLEARANCE_MM: [f64; 2] = [0.1, 0.4];
/// Hardnesses among which one is proposed, Shore A: those of the silicones on sale (cad/doc/process.md), and beyond.
const HARDNESSES_SHORE_A: [f64; 2] = [20.0, 75.0];
/// Steps of the search for a hardness that restores the threshold.
const BISECTIONS: usize = 30;

impl Measured {
    /// What to do about the differences, most useful first.
    pub(super) fn advice(&self, design: &Design, comparison: &Comparison) -> Vec<String> {
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
            // Pins that stick or tilt are a change.
            let change = if advice.is_empty() { "nothing to change: " } else { "" };
            advice.push(format!(
                "{change}the threshold differs by {:+.2} N, and castings scatter by ±{scatter:.2} N (95 %)",
                made - planned
            ));
            return advice;
        }
        advice.push(format!(
            "use the corrected curve: this switch switches at {made:.2} N, not at {planned:.2} N"
        ));
        let hardness = self.hardness_to_cast(design, planned);
        // The hardness makes up for the thickness: who changes both is off by as much again.
        let or = if hardness.is_some() { "or, with an unchanged hardness, " } else { "" };
        advice.extend(hardness);
        if let Some(thickness) = self.mean(THICKNESS) {
            let wanted = design.configuration().silicone.thickness_mm;
            let next = (100.0 * (2.0 * wanted - thickness)).round() / 100.0;
            if (next - wanted).abs() >= 0.01 {
                advice.push(format!(
                    "{or}to cast {wanted} mm from the next mould, generate it with silicone.thickness_mm = {next}"
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
        let bed = self.bed(design.contact().bed(), |key| key != HARDNESS);
        let threshold = |shore_a: f64| {
            let bed = Bed { modulus_mpa: modulus_of_shore_a_mpa(shore_a), ..bed };
            let curve = predict(&design.contact().clone().with_bed(bed), &loads);
            // Beyond the curve, the pins carry every load.
            Transition::of(&curve).map_or(f64::INFINITY, |t| t.threshold_n)
        };
        let [mut soft, mut hard] = HARDNESSES_SHORE_A;
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
