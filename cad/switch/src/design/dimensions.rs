//! Every dimension that follows from a configuration, computed in one place. Lengths in mm, angles in radians.

use std::f64::consts::FRAC_PI_2;

use pinswitch_solid::files::BED_EDGE_MM;

use crate::config::{Configuration, SlotKind, Slots};

/// Grid to which pins are cut, mm.
const PIN_LENGTH_STEP_MM: f64 = 0.5;

/// How far the stops stay below the silicone's surface, and their least height, mm.
const STOP_DEPTH_MM: f64 = 0.2;
/// What chamfers on both sides leave of a stop on the bed, mm.
const STOP_FOOT_MM: f64 = 0.05;
/// Half of the widest span, in radians, at which the layers of a gang mould nest in each other.
const MOST_NESTED_RAD: f64 = 1.3;

/// A configuration with what follows from it, whether it can be built or not; cad/doc/dimensions.md explains each.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimensions {
    configuration: Configuration,
}

/// A slot of a side support, in the radial direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Width: pin and clearance.
    pub width_mm: f64,
    /// Radius at which a pin's centre ends when it is sunk flush, less the margin.
    pub inner_mm: f64,
    /// Radius of a resting pin's centre.
    pub outer_mm: f64,
    /// Depth from the plate's inner face.
    pub depth_mm: f64,
}

impl Slot {
    /// Radius of the slot's end towards the axis.
    pub fn inner_edge_mm(&self) -> f64 {
        self.inner_mm - self.width_mm / 2.0
    }
}

impl Dimensions {
    pub(crate) const fn new(configuration: Configuration) -> Self {
        Self { configuration }
    }

    /// The values that the user may set.
    pub const fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// Angle between neighbouring grooves, in degrees.
    pub fn pitch_deg(&self) -> f64 {
        self.configuration.segment.span_deg / self.configuration.segment.grooves as f64
    }

    /// Angle between neighbouring grooves.
    pub fn pitch_rad(&self) -> f64 {
        self.configuration.segment.span_deg.to_radians() / self.configuration.segment.grooves as f64
    }

    /// Half of the pitch, or a right angle where a single groove has more to itself.
    pub fn half_pitch_rad(&self) -> f64 {
        (self.pitch_rad() / 2.0).min(FRAC_PI_2)
    }

    /// Chord between the centres of neighbouring grooves on the shell.
    pub fn groove_chord_mm(&self) -> f64 {
        2.0 * self.shell_radius_mm() * libm::sin(self.pitch_rad() / 2.0)
    }

    /// What stands between neighbouring grooves on the shell, where it is narrowest.
    pub fn land_mm(&self) -> f64 {
        let half_chord = self.shell_radius_mm() * libm::sin(self.pitch_deg().to_radians() / 2.0);
        2.0 * (half_chord - self.configuration.segment.groove_radius_mm)
    }

    /// What stands beyond the outermost groove of the shell: half a land, the margin, and the stop with its gap.
    pub fn end_wall_mm(&self) -> f64 {
        self.land_mm() / 2.0 + self.shell_end_shift_mm()
    }

    /// How far the stops reach beyond the layer's ends, with the gap before them; 0 without stops.
    pub fn stop_reach_mm(&self) -> f64 {
        self.stops_mm()
            .map_or(0.0, |[thickness, _]| self.configuration.silicone.side_clearance_mm + thickness)
    }

    /// Thickness and height of the stops: lower than the layer, over whose ends the tendon may run. `None` where none are
    /// wanted, or where they are too thin or too low to print.
    pub fn stops_mm(&self) -> Option<[f64; 2]> {
        let c = &self.configuration;
        let height = c.shell.stop_height_mm.min(c.silicone.thickness_mm - STOP_DEPTH_MM);
        let least = c.print.least_wall_mm.max(2.0 * c.print.elephant_foot_mm + STOP_FOOT_MM);
        (c.shell.stop_mm >= least && height >= STOP_DEPTH_MM).then_some([c.shell.stop_mm, height])
    }

    /// How far the ends of shell and supports lie outside the radial planes of the span.
    pub fn shell_end_shift_mm(&self) -> f64 {
        self.configuration.segment.end_margin_mm + self.stop_reach_mm()
    }

    /// Side of a print bed below which there is no use in asking whether the parts fit: the chord of the shell's outer face
    /// and the free edges. Every part but the coupon is longer than that.
    pub fn least_bed_mm(&self) -> f64 {
        let half = self.half_span_rad().min(FRAC_PI_2);
        2.0 * self.configuration.shell.outer_radius_mm * libm::sin(half) + 2.0 * BED_EDGE_MM
    }

    /// Angles of all groove centres, ascending.
    pub fn groove_angles_rad(&self) -> Vec<f64> {
        let span = self.configuration.segment.span_deg.to_radians();
        let pitch = self.pitch_rad();
        (0..self.configuration.segment.grooves).map(|i| -span / 2.0 + (i as f64 + 0.5) * pitch).collect()
    }

    /// Angles of the occupied grooves, ascending; grooves that do not exist are left out.
    pub fn pin_angles_rad(&self) -> Vec<f64> {
        let all = self.groove_angles_rad();
        let mut pins = self.configuration.layout.pins.clone();
        pins.sort_unstable();
        pins.iter().filter_map(|i| all.get(i.checked_sub(1)?).copied()).collect()
    }

    /// Half of the grooved span.
    pub fn half_span_rad(&self) -> f64 {
        self.configuration.segment.span_deg.to_radians() / 2.0
    }

    /// Inner radius of shell, supports and mould core.
    pub fn inner_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm - self.configuration.shell.wall_mm
    }

    /// Radius of the shell's outer face, on which the silicone lies.
    pub const fn shell_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm
    }

    /// Radius of the silicone's surface, which the tendon touches.
    pub fn contact_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm + self.configuration.silicone.thickness_mm
    }

    /// Width of the silicone layer along the axis.
    pub fn layer_width_mm(&self) -> f64 {
        self.configuration.shell.width_mm - 2.0 * self.configuration.silicone.side_clearance_mm
    }

    /// Outer diameter of the coated tendon.
    pub fn tendon_diameter_mm(&self) -> f64 {
        self.configuration.tendon.rope_diameter_mm + 2.0 * self.configuration.tendon.coating_mm
    }

    /// Diameter of the pulley over that of the tendon.
    pub fn bend_ratio(&self) -> f64 {
        2.0 * self.contact_radius_mm() / self.tendon_diameter_mm()
    }

    /// The slots of the side supports.
    pub fn slot(&self) -> Slot {
        let c = &self.configuration;
        let outer_mm = self.contact_radius_mm();
        Slot {
            width_mm: c.pins.diameter_mm + c.support.slot_clearance_mm,
            inner_mm: outer_mm - c.pins.diameter_mm / 2.0 - c.support.travel_margin_mm,
            outer_mm,
            depth_mm: match c.support.slot_kind {
                SlotKind::Blind => c.support.plate_mm - c.support.slot_floor_mm,
                SlotKind::Through => c.support.plate_mm,
            },
        }
    }

    /// Angles of the grooves that get a slot.
    pub fn slot_angles_rad(&self) -> Vec<f64> {
        match self.configuration.support.slots {
            Slots::All => self.groove_angles_rad(),
            Slots::Occupied => self.pin_angles_rad(),
        }
    }

    /// Outer radius of the side supports.
    pub fn support_radius_mm(&self) -> f64 {
        let c = &self.configuration;
        self.contact_radius_mm() + c.pins.diameter_mm / 2.0 + c.support.rise_mm
    }

    /// Length to which the pins are cut, rounded down to half a millimetre.
    pub fn pin_length_mm(&self) -> f64 {
        let c = &self.configuration;
        let room = c.shell.width_mm + 2.0 * self.slot().depth_mm - c.pins.end_play_mm;
        // A hair more, so that 18.0 computed as 17.999... is still 18.0.
        ((room + 1e-9) / PIN_LENGTH_STEP_MM).floor() * PIN_LENGTH_STEP_MM
    }

    /// How far the pins reach into each support.
    pub fn pin_overhang_mm(&self) -> f64 {
        (self.pin_length_mm() - self.configuration.shell.width_mm) / 2.0
    }

    /// Radius on which the fastener holes lie: the middle of the wall under the grooves.
    pub fn fastener_radius_mm(&self) -> f64 {
        let c = &self.configuration;
        c.shell.outer_radius_mm - (c.shell.wall_mm + c.segment.groove_radius_mm) / 2.0
    }

    /// Angles of the fastener holes, ascending.
    pub fn fastener_angles_rad(&self) -> Vec<f64> {
        let c = &self.configuration;
        let outermost = self.half_span_rad() - c.fasteners.end_distance_mm / self.fastener_radius_mm();
        match c.fasteners.count {
            0 => Vec::new(),
            1 => vec![0.0],
            n => (0..n).map(|i| outermost * (2.0 * i as f64 / (n as f64 - 1.0) - 1.0)).collect(),
        }
    }

    /// Whether the layers of a gang mould nest in each other: bowed less than half a turn.
    pub(crate) fn gang_nests(&self) -> bool {
        self.half_span_rad() < MOST_NESTED_RAD
    }

    /// The engraved label: the configured text, or pins x step / first groove.
    pub fn label(&self) -> String {
        let configuration = &self.configuration;
        if !configuration.label.text.is_empty() {
            return configuration.label.text.clone();
        }
        let mut pins = configuration.layout.pins.clone();
        pins.sort_unstable();
        let steps: Vec<_> = pins.windows(2).map(|w| w[1] - w[0]).collect();
        match (pins.first(), steps.first()) {
            (None, _) => "BARE".to_owned(),
            (Some(only), None) => format!("1/{only}"),
            (Some(first), Some(step)) if steps.iter().all(|s| s == step) => {
                format!("{}x{step}/{first}", pins.len())
            }
            // Any other pattern: its occupancy as a hexadecimal number, groove 1 the lowest bit.
            _ => format!("{:X}", pins.iter().fold(0u64, |bits, i| bits | 1 << (i - 1))),
        }
    }
}
