//! What can be measured on a made switch.

use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};

use crate::design::Design;

/// A quantity that can be measured on a made switch.
#[derive(Debug)]
pub(super) struct Quantity {
    /// Key in the file.
    pub(super) key: &'static str,
    /// Name in texts.
    pub(super) name: &'static str,
    /// Unit of its readings.
    pub(super) unit: &'static str,
    /// Accepted readings.
    pub(super) range: [f64; 2],
    /// Its value in the plan.
    pub(super) planned: fn(&Design) -> f64,
    /// Sets it in the bed of the contact; a quantity that changes only the fit of the parts does nothing.
    pub(super) apply: fn(&mut Bed, f64),
}

pub(super) const PIN: &str = "pin_diameter_mm";
pub(super) const SLOT: &str = "slot_width_mm";
pub(super) const THICKNESS: &str = "layer_thickness_mm";
pub(super) const HARDNESS: &str = "hardness_shore_a";

/// Every quantity, in the order in which it is reported.
pub(super) static QUANTITIES: [Quantity; 8] = [
    quantity(
        PIN,
        ("pin diameter", "mm"),
        [0.05, 6.0],
        |d| d.configuration().pins.diameter_mm,
        |bed, value| bed.pin_diameter_mm = value,
    ),
    quantity(
        THICKNESS,
        ("layer thickness", "mm"),
        [0.2, 12.0],
        |d| d.configuration().silicone.thickness_mm,
        |bed, value| {
            bed.contact_radius_mm += value - bed.layer_mm;
            bed.layer_mm = value;
        },
    ),
    quantity(
        "layer_width_mm",
        ("layer width", "mm"),
        [0.5, 120.0],
        |d| d.layer_width_mm(),
        |bed, value| bed.layer_width_mm = value,
    ),
    quantity(
        HARDNESS,
        ("hardness of the layer", "Shore A"),
        [5.0, 90.0],
        |d| d.configuration().silicone.hardness_shore_a,
        |bed, value| bed.modulus_mpa = modulus_of_shore_a_mpa(value),
    ),
    quantity(
        "tendon_diameter_mm",
        ("tendon diameter over the coating", "mm"),
        [0.1, 12.0],
        |d| d.tendon_diameter_mm(),
        |bed, value| bed.tendon_radius_mm = value / 2.0,
    ),
    quantity(
        "groove_radius_mm",
        ("radius of the grooves in the layer", "mm"),
        [0.05, 4.0],
        |d| d.configuration().segment.groove_radius_mm,
        |bed, value| bed.groove_radius_mm = value,
    ),
    quantity(
        "shell_radius_mm",
        ("radius of the shell's face", "mm"),
        [4.0, 160.0],
        |d| d.shell_radius_mm(),
        |bed, value| bed.contact_radius_mm = value + bed.layer_mm,
    ),
    quantity(SLOT, ("width of the slots", "mm"), [0.05, 8.0], |d| d.slot().width_mm, |_, _| {}),
];

const fn quantity(
    key: &'static str,
    (name, unit): (&'static str, &'static str),
    range: [f64; 2],
    planned: fn(&Design) -> f64,
    apply: fn(&mut Bed, f64),
) -> Quantity {
    Quantity { key, name, unit, range, planned, apply }
}
