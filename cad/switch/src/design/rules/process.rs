//! Rules for materials and cure: what contradicts itself is refused, what cannot be made is a warning.

use super::Direction::{Lower, Raise, Set};
use super::{Assessment, Inspection, Rule, Severity, advise, require};
use crate::config::{Choice, MouldKind};
use crate::process::{Coating, Process, nearest_pin_mm, pin_is_sold};
use pinswitch_diagnostic::codes;
use pinswitch_friction::Substrate;

/// Coldest cure that counts as one, °C; 0 leaves it to the shrinkage.
const LEAST_CURE_C: f64 = 18.0;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::CURE_TOO_COLD,
        field: "process.cure_c",
        severity: Severity::Error,
        assess: cure_is_warm,
    },
    Rule {
        code: codes::CURE_AGAINST_SHRINKAGE,
        field: "process.cure_c",
        severity: Severity::Error,
        assess: cure_agrees_with_the_mould,
    },
    Rule {
        code: codes::COATING_CONTRADICTION,
        field: "process.coating",
        severity: Severity::Error,
        assess: bare_rope_has_no_coating,
    },
    Rule {
        code: codes::CURE_AGAINST_SHRINKAGE,
        field: "mould.shrinkage_pct",
        severity: Severity::Warning,
        assess: shrinkage_can_be_made,
    },
    Rule {
        code: codes::HARDNESS_NOT_REACHED,
        field: "silicone.hardness_shore_a",
        severity: Severity::Warning,
        assess: hardness_can_be_made,
    },
    Rule {
        code: codes::MIX_RATIO_WITHOUT_EFFECT,
        field: "silicone.mix_ratio",
        severity: Severity::Warning,
        assess: ratio_of_the_product,
    },
    Rule {
        code: codes::CURE_INHIBITED,
        field: "process.material",
        severity: Severity::Warning,
        assess: mould_lets_silicone_cure,
    },
    Rule {
        code: codes::PIN_NOT_SOLD,
        field: "pins.diameter_mm",
        severity: Severity::Warning,
        assess: pins_are_sold,
    },
];

/// Whether the set casts a layer of a silicone whose data are known.
fn casts(i: &Inspection<'_>) -> bool {
    let c = i.configuration();
    c.layout.substrate == Substrate::Silicone
        && c.mould.kind != MouldKind::None
        && c.process.silicone.data().is_some()
}

fn cure_is_warm(i: &Inspection<'_>) -> Assessment {
    let cure_c = i.configuration().process.cure_c;
    require(cure_c == 0.0 || cure_c >= LEAST_CURE_C, || {
        (
            format!(
                "colder than a room (at least {LEAST_CURE_C} C, or 0 for the cure of the mould's shrinkage)"
            ),
            &[Raise("process.cure_c"), Set("process.cure_c", "0.0")],
        )
    })
}

/// A configured temperature must give the shrinkage that the mould compensates, and spare the mould.
fn cure_agrees_with_the_mould(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if !casts(i) || c.process.cure_c == 0.0 {
        return Assessment::NotApplicable;
    }
    let conflict = Process::of(c).mould_conflict();
    require(conflict.is_none(), || {
        (
            conflict.map(|conflict| conflict.problem).unwrap_or_default(),
            &[
                Set("process.cure_c", "0.0"),
                Lower("process.cure_c"),
                Raise("process.oven_c"),
                Raise("mould.shrinkage_pct"),
                Lower("mould.shrinkage_pct"),
                Set("process.silicone", "\"sylgard-184\""),
                Set("process.material", "\"abs\""),
            ],
        )
    })
}

fn bare_rope_has_no_coating(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let is_consistent = c.process.coating != Coating::Bare || c.tendon.coating_mm == 0.0;
    require(is_consistent, || {
        (
            format!("the coating of the tendon is {} mm thick (tendon.coating_mm)", c.tendon.coating_mm),
            &[Set("tendon.coating_mm", "0.0"), Set("process.coating", "\"polyamide\"")],
        )
    })
}

fn shrinkage_can_be_made(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if !casts(i) || c.process.cure_c > 0.0 {
        return Assessment::NotApplicable;
    }
    let conflict = Process::of(c).mould_conflict();
    advise(conflict.is_none(), || {
        conflict.map(|conflict| (conflict.problem, conflict.help)).unwrap_or_default()
    })
}

fn hardness_can_be_made(i: &Inspection<'_>) -> Assessment {
    if !casts(i) {
        return Assessment::NotApplicable;
    }
    let conflict = Process::of(i.configuration()).hardness_conflict();
    advise(conflict.is_none(), || {
        conflict.map(|conflict| (conflict.problem, conflict.help)).unwrap_or_default()
    })
}

/// The ratio of a product is on its package.
fn ratio_of_the_product(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let Some((silicone, ratio)) = c.process.silicone.data().and_then(|s| Some((s, s.mix_ratio?))) else {
        return Assessment::NotApplicable;
    };
    let default = crate::config::Configuration::default().silicone.mix_ratio;
    let ours = c.silicone.mix_ratio;
    advise(!casts(i) || ours == ratio || ours == default, || {
        (
            format!("silicone.mix_ratio = {ours} has no effect: {} is mixed {ratio}:1", silicone.name),
            "remove it, or set process.silicone to \"other\"".to_owned(),
        )
    })
}

fn mould_lets_silicone_cure(i: &Inspection<'_>) -> Assessment {
    if !casts(i) {
        return Assessment::NotApplicable;
    }
    let material = i.configuration().process.material.data();
    advise(material.inhibition.is_none(), || {
        (
            format!("silicone stays tacky on a fresh mould of {}", material.name),
            material.inhibition.unwrap_or_default().to_owned(),
        )
    })
}

fn pins_are_sold(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let (stock, diameter) = (c.process.pins, c.pins.diameter_mm);
    if c.layout.pins.is_empty() {
        return Assessment::NotApplicable;
    }
    advise(pin_is_sold(stock, diameter), || {
        (
            format!("process.pins = \"{}\": not sold with a diameter of {diameter} mm", stock.as_str()),
            nearest_pin_mm(stock, diameter, i.widest_pin_mm()).map_or_else(
                || "set process.pins to another kind: none of this one fits the grooves".to_owned(),
                |on_sale| format!("set pins.diameter_mm to {on_sale}"),
            ),
        )
    })
}
