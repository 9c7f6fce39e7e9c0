//! Dimensions derived from a configuration, computed in one place. Lengths are in mm, angles in
//! radians.

use std::f64::consts::FRAC_PI_2;

use pinswitch_solid::files::BED_EDGE_MM;

use crate::config::{Configuration, SlotKind, Slots};

/// Step to which pin lengths are rounded, mm.
const PIN_LENGTH_STEP_MM: f64 = 0.5;

/// Distance of the stops below the surface of the silicone, and their least height, mm.
const STOP_DEPTH_MM: f64 = 0.2;
/// Least width of a stop on the bed between its two chamfers, mm.
const STOP_FOOT_MM: f64 = 0.05;

/// A configuration with its derived dimensions, whether or not it can be built.
/// cad/doc/dimensions.md explains each dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimensions {
    configuration: Configuration,
}

/// A radial slot of a side support.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Width: pin diameter and clearance.
    pub width_mm: f64,
    /// Radius of the centre of a pin that is sunk flush, less the margin.
    pub inner_mm: f64,
    /// Radius of the centre of a resting pin.
    pub outer_mm: f64,
    /// Depth below the inner face of the plate.
    pub depth_mm: f64,
}

impl Slot {
    /// Returns the radius of the inner end of the slot.
    pub fn inner_edge_mm(&self) -> f64 {
        self.inner_mm - self.width_mm / 2.0
    }
}

impl Dimensions {
    pub(crate) const fn new(configuration: Configuration) -> Self {
        Self { configuration }
    }

    /// Returns the values that the user can set.
    pub const fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// Returns the angle between neighbouring grooves, in degrees.
    pub fn pitch_deg(&self) -> f64 {
        self.configuration.segment.span_deg / self.configuration.segment.grooves as f64
    }

    /// Returns the angle between neighbouring grooves.
    pub fn pitch_rad(&self) -> f64 {
        self.configuration.segment.span_deg.to_radians() / self.configuration.segment.grooves as f64
    }

    /// Returns half of the pitch, at most a right angle, which a single groove can exceed.
    pub fn half_pitch_rad(&self) -> f64 {
        (self.pitch_rad() / 2.0).min(FRAC_PI_2)
    }

    /// Returns the chord between the centres of neighbouring grooves on the shell.
    pub fn groove_chord_mm(&self) -> f64 {
        2.0 * self.shell_radius_mm() * libm::sin(self.pitch_rad() / 2.0)
    }

    /// Returns the narrowest width of the shell between neighbouring grooves.
    pub fn land_mm(&self) -> f64 {
        let half_chord = self.shell_radius_mm() * libm::sin(self.pitch_deg().to_radians() / 2.0);
        2.0 * (half_chord - self.configuration.segment.groove_radius_mm)
    }

    /// Returns the diameter of the widest pin that fits the grooves of the shell, mm.
    pub fn widest_pin_mm(&self) -> f64 {
        let c = self.configuration();
        2.0 * c.segment.groove_radius_mm - c.pins.tolerance_mm
    }

    /// Returns the width of the shell beyond the outermost groove: half a land, the margin, and the
    /// stop with its gap.
    pub fn end_wall_mm(&self) -> f64 {
        self.land_mm() / 2.0 + self.shell_end_shift_mm()
    }

    /// Returns the distance by which the stops extend beyond the ends of the layer, including the
    /// gap; 0 without stops.
    pub fn stop_reach_mm(&self) -> f64 {
        self.stops_mm()
            .map_or(0.0, |[thickness, _]| self.configuration.silicone.side_clearance_mm + thickness)
    }

    /// Returns the thickness and the height of the stops. They are lower than the layer, since the
    /// tendon may cross its ends. `None` without stops, or where they are too thin or too low to
    /// print.
    pub fn stops_mm(&self) -> Option<[f64; 2]> {
        let c = &self.configuration;
        let height = c.shell.stop_height_mm.min(c.silicone.thickness_mm - STOP_DEPTH_MM);
        let least = c.print.least_wall_mm.max(2.0 * c.print.elephant_foot_mm + STOP_FOOT_MM);
        (c.shell.stop_mm >= least && height >= STOP_DEPTH_MM).then_some([c.shell.stop_mm, height])
    }

    /// Returns the distance of the ends of shell and supports from the radial planes of the span.
    pub fn shell_end_shift_mm(&self) -> f64 {
        self.configuration.segment.end_margin_mm + self.stop_reach_mm()
    }

    /// Returns the least side of a print bed that can fit the parts: the chord of the outer face of
    /// the shell and the free edges of the bed. Every part except the coupon is longer than the
    /// chord.
    pub fn least_bed_mm(&self) -> f64 {
        let half = self.half_span_rad().min(FRAC_PI_2);
        2.0 * self.configuration.shell.outer_radius_mm * libm::sin(half) + 2.0 * BED_EDGE_MM
    }

    /// Returns the angles of all groove centres, ascending.
    pub fn groove_angles_rad(&self) -> Vec<f64> {
        let span = self.configuration.segment.span_deg.to_radians();
        let pitch = self.pitch_rad();
        (0..self.configuration.segment.grooves).map(|i| -span / 2.0 + (i as f64 + 0.5) * pitch).collect()
    }

    /// Returns the angles of the occupied grooves, ascending. Numbers of grooves that do not exist
    /// are skipped.
    pub fn pin_angles_rad(&self) -> Vec<f64> {
        let all = self.groove_angles_rad();
        let mut pins = self.configuration.layout.pins.clone();
        pins.sort_unstable();
        pins.iter().filter_map(|i| all.get(i.checked_sub(1)?).copied()).collect()
    }

    /// Returns half of the grooved span.
    pub fn half_span_rad(&self) -> f64 {
        self.configuration.segment.span_deg.to_radians() / 2.0
    }

    /// Returns the inner radius of shell, supports and mould core.
    pub fn inner_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm - self.configuration.shell.wall_mm
    }

    /// Returns the radius of the outer face of the shell, which carries the silicone.
    pub const fn shell_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm
    }

    /// Returns the radius of the surface of the silicone, which the tendon touches.
    pub fn contact_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm + self.configuration.silicone.thickness_mm
    }

    /// Returns the width of the silicone layer along the axis.
    pub fn layer_width_mm(&self) -> f64 {
        self.configuration.shell.width_mm - 2.0 * self.configuration.silicone.side_clearance_mm
    }

    /// Returns the outer diameter of the coated tendon.
    pub fn tendon_diameter_mm(&self) -> f64 {
        self.configuration.tendon.rope_diameter_mm + 2.0 * self.configuration.tendon.coating_mm
    }

    /// Returns the ratio of the diameters of pulley and tendon.
    pub fn bend_ratio(&self) -> f64 {
        2.0 * self.contact_radius_mm() / self.tendon_diameter_mm()
    }

    /// Returns the slots of the side supports.
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

    /// Returns the angles of the grooves with a slot.
    pub fn slot_angles_rad(&self) -> Vec<f64> {
        match self.configuration.support.slots {
            Slots::All => self.groove_angles_rad(),
            Slots::Occupied => self.pin_angles_rad(),
        }
    }

    /// Returns the outer radius of the side supports.
    pub fn support_radius_mm(&self) -> f64 {
        let c = &self.configuration;
        self.contact_radius_mm() + c.pins.diameter_mm / 2.0 + c.support.rise_mm
    }

    /// Returns the length of the pins, rounded down to half a millimetre.
    pub fn pin_length_mm(&self) -> f64 {
        let c = &self.configuration;
        let room = c.shell.width_mm + 2.0 * self.slot().depth_mm - c.pins.end_play_mm;
        // The small term keeps 18.0 if it was computed as 17.999...
        ((room + 1e-9) / PIN_LENGTH_STEP_MM).floor() * PIN_LENGTH_STEP_MM
    }

    /// Returns the length of a pin within each support.
    pub fn pin_overhang_mm(&self) -> f64 {
        (self.pin_length_mm() - self.configuration.shell.width_mm) / 2.0
    }

    /// Returns the radius of the circle of the fastener holes: the middle of the wall under the
    /// grooves.
    pub fn fastener_radius_mm(&self) -> f64 {
        let c = &self.configuration;
        c.shell.outer_radius_mm - (c.shell.wall_mm + c.segment.groove_radius_mm) / 2.0
    }

    /// Returns the angles of the fastener holes, ascending.
    pub fn fastener_angles_rad(&self) -> Vec<f64> {
        let c = &self.configuration;
        let outermost = self.half_span_rad() - c.fasteners.end_distance_mm / self.fastener_radius_mm();
        match c.fasteners.count {
            0 => Vec::new(),
            1 => vec![0.0],
            n => (0..n).map(|i| outermost * (2.0 * i as f64 / (n as f64 - 1.0) - 1.0)).collect(),
        }
    }

    /// Returns the engraved label: the configured text, or the number of pins, their step and the
    /// first groove.
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
            // Any other pattern: its occupancy as a hexadecimal number with groove 1 as the lowest
            // bit.
            _ => format!("{:X}", pins.iter().fold(0u64, |bits, i| bits | 1 << (i - 1))),
        }
    }
}
