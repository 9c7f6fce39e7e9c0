//! The bill of materials: what to buy, cut, weigh and pour.

use serde::Serialize;

use crate::config::MouldKind;
use crate::design::Design;
use crate::parts::cavity_mm3;
use pinswitch_friction::Substrate;

/// Lengths in which screws are sold, mm.
const SCREW_LENGTHS_MM: [f64; 17] =
    [6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0, 70.0, 80.0, 100.0, 120.0];
/// Clearance holes and the screws that go through them, mm.
const SCREWS: [(f64, &str); 6] =
    [(1.8, "M1.6"), (2.2, "M2"), (2.7, "M2.5"), (3.2, "M3"), (4.3, "M4"), (5.3, "M5")];
/// A nut and its washer, in screw diameters.
const NUT: f64 = 1.2;

/// Pins to cut.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pins {
    /// In use.
    pub number: usize,
    /// Beyond those.
    pub spares: usize,
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
}

/// Silicone to weigh and pour.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Silicone {
    /// Volume of the cast layer, mm³ before shrinkage.
    pub layer_mm3: f64,
    /// What to pour into the mould, ml: layer and overfill.
    pub pour_ml: f64,
    /// Mass of that, g.
    pub pour_g: f64,
    /// What to mix, g: with waste, and no less than can be weighed.
    pub mix_g: f64,
    /// Base in the mix, g.
    pub base_g: f64,
    /// Curing agent in the mix, g.
    pub agent_g: f64,
}

/// Tendon to cut.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tendon {
    /// Diameter of the bare rope, mm.
    pub rope_diameter_mm: f64,
    /// Outer diameter with its coating, mm.
    pub outer_diameter_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
}

/// Screws with nuts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fasteners {
    /// Number of screws, each with a nut.
    pub number: usize,
    /// Thread, the largest that the holes take.
    pub thread: &'static str,
    /// Length, mm, through shell, both plates and the nut.
    pub length_mm: f64,
}

/// The bill of materials of one set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bill {
    /// Steel pins.
    pub pins: Pins,
    /// Silicone; absent for a rigid proxy.
    pub silicone: Option<Silicone>,
    /// Tendon.
    pub tendon: Tendon,
    /// Fasteners; absent without holes.
    pub fasteners: Option<Fasteners>,
}

/// What `design` needs beside its printed parts.
pub fn bill_of_materials(design: &Design) -> Bill {
    let c = design.configuration();
    let (layer_mm3, overfill_mm3) = cavity_mm3(design);
    let silicone =
        (c.layout.substrate == Substrate::Silicone && c.mould.kind != MouldKind::None).then(|| {
            let pour_ml = (layer_mm3 + overfill_mm3) / 1000.0;
            let pour_g = pour_ml * c.silicone.density_g_cm3;
            let mix_g = (pour_g * c.silicone.waste_factor).max(c.silicone.least_mix_g);
            let agent_g = mix_g / (c.silicone.mix_ratio + 1.0);
            Silicone { layer_mm3, pour_ml, pour_g, mix_g, base_g: mix_g - agent_g, agent_g }
        });
    Bill {
        pins: Pins {
            number: c.layout.pins.len(),
            spares: if c.layout.pins.is_empty() { 0 } else { c.pins.spares },
            diameter_mm: c.pins.diameter_mm,
            length_mm: design.pin_length_mm(),
        },
        silicone,
        tendon: Tendon {
            rope_diameter_mm: c.tendon.rope_diameter_mm,
            outer_diameter_mm: design.tendon_diameter_mm(),
            length_mm: c.tendon.length_mm,
        },
        fasteners: fasteners(design),
    }
}

fn fasteners(design: &Design) -> Option<Fasteners> {
    let c = design.configuration();
    let hole = c.fasteners.hole_diameter_mm;
    let thread =
        SCREWS.iter().rev().find(|(clearance, _)| *clearance <= hole).map_or("smaller than M1.6", |s| s.1);
    let stack = c.shell.width_mm + 2.0 * c.support.plate_mm + NUT * hole;
    let length_mm = SCREW_LENGTHS_MM.into_iter().find(|l| *l >= stack).unwrap_or(stack.ceil());
    (c.fasteners.count > 0).then_some(Fasteners { number: c.fasteners.count, thread, length_mm })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configuration;

    #[test]
    fn the_default_bill_can_be_bought_and_weighed() {
        let design = Design::new(Configuration::default()).unwrap();
        let bill = bill_of_materials(&design);
        let silicone = bill.silicone.unwrap();
        assert_eq!(silicone.mix_g, 11.0);
        assert!((silicone.base_g - 10.0).abs() < 1e-12 && (silicone.agent_g - 1.0).abs() < 1e-12);
        let screws = bill.fasteners.unwrap();
        assert_eq!((screws.thread, screws.length_mm, screws.number), ("M3", 25.0, 2));
        assert_eq!((bill.pins.length_mm, bill.pins.spares), (18.0, 0));
    }
}
