//! `rig-bill.csv`: everything to buy for the rig.

use super::{BoughtItem, Drive, RigFacts};
use crate::rig::wiring::SUPPLY_V;

/// Returns all items: mechanical ones, load, measurement and drive.
pub(super) fn items(facts: &RigFacts) -> Vec<BoughtItem> {
    let mut all = facts.items.clone();
    all.push(BoughtItem::new(
        1,
        format!("Hook of {} g, or another one whose mass is set as rig.hook_mass_g", facts.hook_mass_g),
        "between tendon and weights; part of every load",
    ));
    for (i, weight) in facts.weights_g.iter().enumerate() {
        let item = format!("Weight of {weight} g");
        let load = format!(
            "load {} of {}: {:.3} N with the hook",
            i + 1,
            facts.weights_g.len(),
            facts.load_n(*weight)
        );
        all.push(BoughtItem::new(1, item, load));
    }
    all.push(BoughtItem::new(
        1,
        format!("{}, range {} N", facts.cell, facts.cell_limit_n),
        "force of the tendon at the drive",
    ));
    all.push(BoughtItem::new(
        1,
        format!("Bridge amplifier, {} Hz or faster", facts.sample_rate_hz),
        "between load cell and logger",
    ));
    let (channels, signals) = match facts.drive {
        Drive::Actuator { .. } => (3, "force, position and trigger"),
        Drive::Crank { .. } => (2, "force and trigger"),
    };
    all.push(BoughtItem::new(
        1,
        format!("Logger with {channels} channels at {} Hz, which writes CSV", facts.sample_rate_hz),
        signals,
    ));
    if let Drive::Crank { .. } = facts.drive {
        all.push(BoughtItem::new(1, "Push button", "trigger"));
    }
    if let Drive::Actuator { full_speed_mm_s } = facts.drive {
        all.push(BoughtItem::new(
            1,
            format!(
                "Linear actuator, {SUPPLY_V} V, stroke {} mm, {full_speed_mm_s} mm/s at 100 %, {:.0} N or more, with a \
                 potentiometer",
                facts.stroke_mm,
                2.0 * facts.heaviest_n()
            ),
            "drive",
        ));
        all.push(BoughtItem::new(1, format!("Supply, {SUPPLY_V} V, 5 A or more"), "drive"));
        all.push(BoughtItem::new(
            1,
            format!("H-bridge driver, {SUPPLY_V} V, 5 A or more, with speed, direction and enable inputs"),
            "drive",
        ));
        all.push(BoughtItem::new(1, "Emergency stop switch, 10 A", "in the supply line of the driver"));
    }
    all
}

/// Returns the bill as CSV.
pub fn bill_csv(facts: &RigFacts) -> String {
    let cell = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = "quantity,item,purpose\n".to_owned();
    for item in items(facts) {
        text.push_str(&format!("{},{},{}\n", item.quantity, cell(&item.item), cell(&item.purpose)));
    }
    text
}
