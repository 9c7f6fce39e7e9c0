//! The bill of materials: pins, silicone, tendon, fasteners and hardware.

use schemars::JsonSchema;
use serde::Serialize;

use crate::config::{MouldKind, MountKind};
use crate::design::{Design, Joint, STOP_SCREW, axle_recess, stop_recess};
use crate::parts::{cavity_mm3, spacer_mm};
use crate::process::{Cure, Process, mix_ratio, silicone_density_g_cm3};
use crate::rig::bolt_mm;
use pinswitch_friction::Substrate;

/// Bearing of the guide pulley.
const BEARING: &str = "608";
/// Number of screws of the sheath stop.
pub const STOP_SCREWS: usize = 2;
/// Width of a 608 bearing (ISO 15), of an M8 washer (ISO 7089), and height of an M8 nut (ISO 4032), mm.
pub(crate) const BEARING_MM: f64 = 7.0;
pub(crate) const AXLE_WASHER_MM: f64 = 1.6;
pub(crate) const AXLE_NUT_MM: f64 = 6.8;

/// Steel pins.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Pins {
    /// Number in the switch.
    pub number: usize,
    /// Number of spares.
    pub spares: usize,
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
}

/// Silicone to cast.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Silicone {
    /// Volume of the layer before shrinkage, mm³.
    pub layer_mm3: f64,
    /// Volume of the mould, ml: the layer, and the basin, or funnel and vents.
    pub pour_ml: f64,
    /// Mass of that volume, g.
    pub pour_g: f64,
    /// Mass to mix, g, with waste, and at least the least mass that can be weighed.
    pub mix_g: f64,
    /// Base in the mix, g.
    pub base_g: f64,
    /// Curing agent in the mix, g.
    pub agent_g: f64,
    /// Product, as on its package; absent for a user-defined silicone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub product: Option<&'static str>,
    /// Base to curing agent by mass.
    pub mix_ratio: f64,
    /// Cure in the mould; absent where no cure gives the configured layer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mould_cure: Option<Cure>,
    /// Post-cure of the layer outside the mould, if it needs one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub post_cure: Option<Cure>,
}

/// The tendon.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tendon {
    /// Diameter of the bare rope, mm.
    pub rope_diameter_mm: f64,
    /// Outer diameter with its coating, mm.
    pub outer_diameter_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
}

/// Screws with their nuts or inserts.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Fasteners {
    /// Number of screws.
    pub number: usize,
    /// Thread, the largest for the holes.
    pub thread: &'static str,
    /// Length, mm: through all parts and the nut, or to the inserts.
    pub length_mm: f64,
    /// Length of the screws from the right, mm, if it differs: a mounting plate is on the left only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_length_mm: Option<f64>,
    /// Number of nuts; 0 with inserts.
    pub nuts: usize,
    /// Number of heat-set inserts.
    pub inserts: usize,
}

/// Steel dowels.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Dowels {
    /// Number.
    pub number: usize,
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
}

/// Hardware of a mounting plate.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MountHardware {
    /// Number of holes for screws of the plate, or at the end of the proximal link.
    pub holes: usize,
    /// Diameter of these holes, mm.
    pub hole_diameter_mm: f64,
    /// Number of guide pulleys, on the rig.
    #[serde(skip_serializing_if = "is_zero")]
    pub pulleys: usize,
    /// Bearing of each guide pulley, on the rig.
    pub bearing: Option<&'static str>,
    /// Bolt through each bearing, or through both links of a joint.
    pub axle: Option<String>,
    /// Sleeve that is crimped on the tendon behind its anchor, on a joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crimp_sleeve: Option<String>,
    /// Screws and nuts of the sheath stop.
    pub sheath_stop: Option<String>,
    /// Thread and length of these [`STOP_SCREWS`] screws.
    #[serde(skip)]
    pub stop_screw: Option<String>,
    /// Length of the bolt under its head, mm.
    #[serde(skip)]
    pub axle_length_mm: Option<f64>,
    /// Length of the stop's screws under their heads, mm.
    #[serde(skip)]
    pub stop_screw_length_mm: Option<f64>,
}

/// The bill of materials of one set.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Bill {
    /// Steel pins.
    pub pins: Pins,
    /// Silicone; absent with a rigid proxy.
    pub silicone: Option<Silicone>,
    /// Tendon.
    pub tendon: Tendon,
    /// Fasteners; absent without holes.
    pub fasteners: Option<Fasteners>,
    /// Dowels, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dowels: Option<Dowels>,
    /// Bearing of a separate guide pulley. The bearing of the rig is in `mount`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pulley_bearing: Option<&'static str>,
    /// Hardware of the mounting plate, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mount: Option<MountHardware>,
}

/// Returns the bill of materials of a design.
pub fn bill_of_materials(design: &Design) -> Bill {
    let c = design.configuration();
    let (layer_mm3, above_mm3) = cavity_mm3(design);
    let silicone =
        (c.layout.substrate == Substrate::Silicone && c.mould.kind != MouldKind::None).then(|| {
            let pour_ml = (layer_mm3 + above_mm3) / 1000.0;
            let pour_g = pour_ml * silicone_density_g_cm3(c);
            let mix_g = (pour_g * c.silicone.waste_factor).max(c.silicone.least_mix_g);
            let agent_g = mix_g / (mix_ratio(c) + 1.0);
            let process = Process::of(c);
            Silicone {
                product: process.silicone.map(|s| s.name),
                mix_ratio: mix_ratio(c),
                mould_cure: process.mould_cure,
                post_cure: process.post_cure,
                layer_mm3,
                pour_ml,
                pour_g,
                mix_g,
                base_g: mix_g - agent_g,
                agent_g,
            }
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
            length_mm: design.tendon_length_mm(),
        },
        fasteners: fasteners(design),
        dowels: dowels(design),
        pulley_bearing: (c.parts.guide_pulley && c.mount.kind != MountKind::Rig).then_some(BEARING),
        mount: mount(design),
    }
}

#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(number: &usize) -> bool {
    *number == 0
}

fn fasteners(design: &Design) -> Option<Fasteners> {
    let c = design.configuration();
    let fastening = design.fastening();
    let thread = fastening.thread?.name;
    let number = c.fasteners.count;
    // The rules of a design exclude screws of unavailable lengths.
    let (length_mm, right_mm) = design.screw_lengths_mm()?;
    let fasteners = match right_mm {
        Some(right_mm) => {
            let right_length_mm = (right_mm != length_mm).then_some(right_mm);
            Fasteners { number: 2 * number, thread, length_mm, right_length_mm, nuts: 0, inserts: 2 * number }
        }
        None => Fasteners { number, thread, length_mm, right_length_mm: None, nuts: number, inserts: 0 },
    };
    (number > 0).then_some(fasteners)
}

fn dowels(design: &Design) -> Option<Dowels> {
    let diameter_mm = design.configuration().fasteners.dowel_diameter_mm;
    let number = design.dowel_angles_rad().len();
    (number > 0).then(|| Dowels { number, diameter_mm, length_mm: design.dowel_length_mm() })
}

fn mount(design: &Design) -> Option<MountHardware> {
    let c = design.configuration();
    let mounting = design.mounting()?;
    // The head is in the plate; spacer, bearing, washer and nut follow.
    let stack = c.mount.plate_mm - axle_recess().depth_mm
        + spacer_mm(design)
        + BEARING_MM
        + AXLE_WASHER_MM
        + AXLE_NUT_MM;
    let axle_length_mm = mounting.axle.map(|_| bolt_mm(stack));
    let axle = axle_length_mm.map(|length| format!("M8 x {length} hexagon bolt (ISO 4017), washer and nut"));
    let joint = design.joint();
    let axle = axle.or_else(|| joint.as_ref().and_then(axle_of_joint));
    let axle_length_mm = axle_length_mm.or_else(|| joint.as_ref().and_then(|joint| joint.axle_length_mm));
    let crimp_sleeve =
        joint.map(|_| format!("crimp sleeve for a rope of {} mm", design.tendon_diameter_mm()));
    let stack = c.mount.plate_mm - stop_recess().depth_mm + design.sheath_floor_mm() + STOP_SCREW.nut_mm[1];
    let stop_screw_length_mm = mounting.sheath.and_then(|_| STOP_SCREW.at_least_mm(stack));
    let stop_screw = stop_screw_length_mm.map(|length| format!("{} x {length}", STOP_SCREW.name));
    let sheath_stop =
        stop_screw.as_ref().map(|screw| format!("{STOP_SCREWS} screws {screw} (ISO 4762) and nuts"));
    Some(MountHardware {
        holes: mounting.holes.len(),
        hole_diameter_mm: mounting.holes.first().map_or(c.mount.hole_diameter_mm, |h| 2.0 * h.radius_mm),
        pulleys: mounting.axles().count(),
        bearing: mounting.axle.map(|_| BEARING),
        axle,
        crimp_sleeve,
        sheath_stop,
        stop_screw,
        axle_length_mm,
        stop_screw_length_mm,
    })
}

/// Describes the axle of a joint with its hardware.
fn axle_of_joint(joint: &Joint) -> Option<String> {
    let length = joint.axle_length_mm?;
    let name = joint.axle.name;
    Some(format!("{name} x {length} bolt (ISO 4014), 2 washers and lock nut"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configuration;

    #[test]
    fn the_default_bill_has_available_sizes() {
        let design = Design::new(Configuration::default()).unwrap();
        let bill = bill_of_materials(&design);
        let silicone = bill.silicone.unwrap();
        assert_eq!(silicone.mix_g, 11.0);
        assert!((silicone.base_g - 10.0).abs() < 1e-12 && (silicone.agent_g - 1.0).abs() < 1e-12);
        let screws = bill.fasteners.unwrap();
        assert_eq!((screws.thread, screws.length_mm, screws.number), ("M3", 25.0, 2));
        assert_eq!((bill.pins.length_mm, bill.pins.spares), (18.0, 0));
    }

    #[test]
    fn screws_from_both_sides_do_not_meet() {
        for (plate_mm, recess_mm, width_mm) in
            [(20.0, 0.0, 14.0), (10.0, 0.0, 14.0), (5.0, 1.5, 14.0), (5.0, 0.0, 14.0), (8.0, 0.0, 20.0)]
        {
            let text = format!(
                "[fasteners]\nkind = \"insert\"\nhead_recess_mm = {recess_mm:?}\n[mount]\nkind = \"flange\"\nplate_mm = {plate_mm:?}\n[shell]\nwidth_mm = {width_mm:?}\n"
            );
            let (configuration, _) = crate::config::read(&text, "x.toml").unwrap();
            let design = Design::new(configuration).unwrap();
            let screws = bill_of_materials(&design).fasteners.unwrap();
            let c = design.configuration();
            let fastening = design.fastening();
            let sunk = |recess: Option<crate::design::Recess>| recess.map_or(0.0, |r| r.depth_mm);
            let (on_plate, on_support) = (sunk(fastening.mount_counterbore), sunk(fastening.counterbore));
            // A flange contains every head.
            assert!(on_plate >= 3.0, "{on_plate}");
            let left = screws.length_mm - (c.support.plate_mm + c.mount.plate_mm - on_plate);
            let right =
                screws.right_length_mm.unwrap_or(screws.length_mm) - (c.support.plate_mm - on_support);
            assert!(left > 0.0 && right > 0.0 && left + right < width_mm, "{plate_mm}: {left} and {right}");
        }
    }
}
