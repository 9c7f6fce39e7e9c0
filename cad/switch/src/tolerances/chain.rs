//! The chain of dimensions from pins, grooves, slots and layer to the threshold: nominal values, tolerances with their
//! sources, and the dimensions of a made switch.

use crate::process::Process;
use pinswitch_friction::physics::{Bed, MadeDimensions, modulus_of_shore_a_mpa};
use schemars::JsonSchema;
use serde::Serialize;

use crate::design::Design;
use crate::request::Tolerances;

/// Standard deviations within a tolerance: a tolerance of ±t is ± two standard deviations, as in [`Tolerances`].
pub const DEVIATIONS_PER_TOLERANCE: f64 = 2.0;
/// Largest dimension in each range of [`IT9_MM`], mm.
const IT_RANGES_MM: [f64; 8] = [3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0];
/// Widths of the tolerance grade IT9 by range of nominal size, mm (ISO 286-1:2010, table 1).
const IT9_MM: [f64; 9] = [0.025, 0.030, 0.036, 0.043, 0.052, 0.062, 0.074, 0.087, 0.100];

/// Tolerance of small printed features, such as grooves and slots, mm: [`Tolerances`] has the source.
const PRINTED_FEATURE_MM: f64 = 0.1;
/// Largest excess of the width of a slot by the fit on its drawing, +0.1/0, mm.
pub const SLOT_EXCESS_MM: f64 = 0.1;
/// Tolerance of printed heights: 0.254 mm and 0.1 % of the height (Stratasys' guide for ABS).
const PRINTED_HEIGHT_MM: (f64, f64) = (0.254, 0.001);
/// Tolerance of the outer diameter of a coated tendon, mm. Assumed.
const TENDON_MM: f64 = 0.05;
/// Tolerance of the wrap angle on a rig or a joint, degrees. Assumed.
const WRAP_DEG: f64 = 1.0;
/// Tolerance of ground pins, mm: half the width of h6 up to 3 mm (ISO 286-2:2010).
const GROUND_PIN_MM: f64 = 0.003;
/// Tolerance of the hardness of a batch that is measured and selected, Shore A. Chosen: readings of one durometer repeat
/// within 2 points.
const SELECTED_HARDNESS: f64 = 2.0;
/// Tolerance of a tendon that is measured and selected, mm: a micrometer's reading on a soft coating. Chosen.
const SELECTED_TENDON_MM: f64 = 0.02;
/// Tolerance of a wrap angle that is set with a template, degrees. Chosen.
const SET_WRAP_DEG: f64 = 0.25;

/// Dimension of the chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ChainDimension {
    /// Diameter of the pins, which are cut from one rod.
    PinDiameter,
    /// Depth of all grooves: the printer makes all ribs of the mould wider or narrower.
    GrooveDepth,
    /// Height of each pin over the silicone: the depth of its own groove.
    PinHeight,
    /// Position of each groove along the wrap.
    GroovePosition,
    /// Position of each slot along the wrap.
    SlotPosition,
    /// Width of each slot.
    SlotWidth,
    /// Thickness of the layer.
    LayerThickness,
    /// Width of the layer.
    LayerWidth,
    /// Radius of the shell's outer face.
    ShellRadius,
    /// Hardness of the silicone.
    Hardness,
    /// Outer diameter of the coated tendon.
    TendonDiameter,
    /// Wrap angle of the tendon.
    WrapAngle,
}

impl ChainDimension {
    /// All dimensions of the chain.
    pub const ALL: [Self; 12] = [
        Self::PinDiameter,
        Self::GrooveDepth,
        Self::PinHeight,
        Self::GroovePosition,
        Self::SlotPosition,
        Self::SlotWidth,
        Self::LayerThickness,
        Self::LayerWidth,
        Self::ShellRadius,
        Self::Hardness,
        Self::TendonDiameter,
        Self::WrapAngle,
    ];

    /// Returns the name on the command line and in files, such as `pin_diameter`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::PinDiameter => "pin_diameter",
            Self::GrooveDepth => "groove_depth",
            Self::PinHeight => "pin_height",
            Self::GroovePosition => "groove_position",
            Self::SlotPosition => "slot_position",
            Self::SlotWidth => "slot_width",
            Self::LayerThickness => "layer_thickness",
            Self::LayerWidth => "layer_width",
            Self::ShellRadius => "shell_radius",
            Self::Hardness => "hardness",
            Self::TendonDiameter => "tendon_diameter",
            Self::WrapAngle => "wrap_angle",
        }
    }

    /// Returns the dimension with a name such as `pin_diameter`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dimension| dimension.as_str() == name)
    }

    /// Returns a description for a person.
    pub const fn title(self) -> &'static str {
        match self {
            Self::PinDiameter => "pin diameter",
            Self::GrooveDepth => "groove depth, all",
            Self::PinHeight => "pin height, each",
            Self::GroovePosition => "groove position, each",
            Self::SlotPosition => "slot position, each",
            Self::SlotWidth => "slot width, each",
            Self::LayerThickness => "layer thickness",
            Self::LayerWidth => "layer width",
            Self::ShellRadius => "shell radius",
            Self::Hardness => "hardness of the silicone",
            Self::TendonDiameter => "tendon diameter",
            Self::WrapAngle => "wrap angle",
        }
    }

    /// Returns the unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Hardness => "Shore A",
            Self::WrapAngle => "deg",
            _ => "mm",
        }
    }

    /// Whether each pin has one of its own, independent of the others.
    pub const fn is_of_each_pin(self) -> bool {
        matches!(self, Self::PinHeight | Self::GroovePosition | Self::SlotPosition | Self::SlotWidth)
    }
}

/// Tolerance of a dimension, with its source.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SourcedTolerance {
    /// Half width of the tolerance zone, ±, in the unit of the dimension.
    pub plus_minus: f64,
    /// Origin of the number.
    pub source: &'static str,
}

/// Dimension of the chain of one switch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Link {
    /// Dimension.
    pub dimension: ChainDimension,
    /// Nominal value, in its unit; of a position, the distance along the wrap from the nominal place, 0.
    pub nominal: f64,
    /// Number of independent occurrences: one, or one of each pin.
    pub count: usize,
    /// Tolerance that the drawing requires, ±: that of the process, or a smaller one that the function needs.
    pub drawing: f64,
    /// Tolerance that the process gives.
    pub process: SourcedTolerance,
    /// Smallest tolerance that the best process gives.
    pub best: SourcedTolerance,
}

const MILLED: &str = "milled mould or part, IT9 (ISO 286-1)";

/// Returns half of the width of IT9 for a nominal size in mm.
fn it9_mm(nominal_mm: f64) -> f64 {
    let range = IT_RANGES_MM.partition_point(|largest| *largest < nominal_mm);
    IT9_MM[range.min(IT9_MM.len() - 1)] / 2.0
}

/// Returns the tolerances of `dimension` of a design: what the process gives, and the best process.
pub fn link(design: &Design, dimension: ChainDimension) -> Link {
    let c = design.configuration();
    let sd = Tolerances::default();
    let two = |sd: f64| DEVIATIONS_PER_TOLERANCE * sd;
    let bed = design.contact().bed();
    let process_scatter = Process::of(c).hardness_shore_a.map(|[_, scatter]| scatter);
    let printed = "print: small features of fused deposition are within 0.1 mm (Xometry's guide)";
    let position = (PRINTED_FEATURE_MM, printed, it9_mm(design.contact_radius_mm()), MILLED);
    let (nominal, (process, source, best, best_source)) = match dimension {
        ChainDimension::PinDiameter => (
            c.pins.diameter_mm,
            (
                c.pins.tolerance_mm,
                "as bought: pins.tolerance_mm",
                GROUND_PIN_MM.min(c.pins.tolerance_mm),
                "ground pin, h6 (ISO 286-2)",
            ),
        ),
        ChainDimension::GrooveDepth => (
            c.segment.groove_radius_mm,
            (
                two(sd.groove_diameter_mm / 2.0),
                "print: diameters of small features are within 0.1 mm (Xometry's guide); cast in the mould",
                it9_mm(c.segment.groove_radius_mm),
                MILLED,
            ),
        ),
        ChainDimension::PinHeight => (
            bed.protrusion_mm(),
            (
                two(sd.groove_diameter_mm / 2.0),
                "assumed: as large as the deviation that all grooves share",
                it9_mm(c.segment.groove_radius_mm),
                MILLED,
            ),
        ),
        ChainDimension::GroovePosition | ChainDimension::SlotPosition => (0.0, position),
        ChainDimension::SlotWidth => {
            let width_mm = design.slot().width_mm + SLOT_EXCESS_MM / 2.0;
            let fit = "drawing: +0.1/0, the fit of the pin; the coupon shows how the machine reaches it";
            (width_mm, (SLOT_EXCESS_MM / 2.0, fit, it9_mm(width_mm), MILLED))
        }
        ChainDimension::LayerThickness => (
            c.silicone.thickness_mm,
            (
                two(sd.layer_mm),
                "assumed: cast in the gap between two printed faces, each within 0.1 mm",
                it9_mm(c.silicone.thickness_mm),
                MILLED,
            ),
        ),
        ChainDimension::LayerWidth => {
            let width_mm = design.layer_width_mm();
            (
                width_mm,
                (
                    PRINTED_HEIGHT_MM.0 + PRINTED_HEIGHT_MM.1 * width_mm,
                    "print: 0.254 mm + 0.1 % in height (Stratasys' guide for ABS); cast in the mould",
                    it9_mm(width_mm),
                    MILLED,
                ),
            )
        }
        ChainDimension::ShellRadius => (
            design.shell_radius_mm(),
            (
                two(sd.radius_mm),
                "print: desktop printers are specified to about 1 % of 20 mm",
                it9_mm(design.shell_radius_mm()),
                MILLED,
            ),
        ),
        ChainDimension::Hardness => (
            c.silicone.hardness_shore_a,
            (
                two(process_scatter.unwrap_or(sd.hardness_shore_a)),
                if process_scatter.is_some() {
                    "cast: the scatter between castings of process.silicone"
                } else {
                    "as bought: rubbers are sold to 5 points"
                },
                SELECTED_HARDNESS,
                "chosen: batch measured with a durometer and selected",
            ),
        ),
        ChainDimension::TendonDiameter => (
            design.tendon_diameter_mm(),
            (
                TENDON_MM,
                "assumed: coated rope as bought",
                SELECTED_TENDON_MM,
                "chosen: measured with a micrometer and selected",
            ),
        ),
        ChainDimension::WrapAngle => (
            c.layout.wrap_angle_deg,
            (
                WRAP_DEG,
                "assumed: guide pulleys of a rig, or stops of a joint",
                SET_WRAP_DEG,
                "chosen: set with a template",
            ),
        ),
    };
    let pins = design.contact().all_pins().count();
    // Groove and slot share half of the play on each side, so that the pin stays free.
    let drawing = match dimension {
        ChainDimension::GroovePosition | ChainDimension::SlotPosition => {
            process.min(c.support.slot_clearance_mm / 4.0)
        }
        _ => process,
    };
    Link {
        dimension,
        nominal,
        drawing,
        count: if dimension.is_of_each_pin() { pins } else { 1 },
        process: SourcedTolerance { plus_minus: process, source },
        best: SourcedTolerance { plus_minus: best.min(process), source: best_source },
    }
}

/// Returns the whole chain of a design.
pub fn chain(design: &Design) -> Vec<Link> {
    ChainDimension::ALL.into_iter().map(|dimension| link(design, dimension)).collect()
}

/// Deviations of a made switch from its nominal dimensions, one number per occurrence, in the order of a chain.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Deviations {
    values: Vec<f64>,
    starts: Vec<usize>,
}

impl Deviations {
    /// Creates deviations of zero.
    pub(super) fn zero(chain: &[Link]) -> Self {
        let mut starts = vec![0];
        for link in chain {
            starts.push(starts[starts.len() - 1] + link.count);
        }
        Self { values: vec![0.0; starts[chain.len()]], starts }
    }

    /// Returns the deviations of the link of this index.
    pub(super) fn of_mut(&mut self, link: usize) -> &mut [f64] {
        &mut self.values[self.starts[link]..self.starts[link + 1]]
    }

    /// Returns one deviation of the link of this index; 0 for an occurrence that does not exist.
    fn get(&self, dimension: ChainDimension, occurrence: usize) -> f64 {
        let link = ChainDimension::ALL.iter().position(|one| *one == dimension).unwrap_or_default();
        self.values[self.starts[link]..self.starts[link + 1]].get(occurrence).copied().unwrap_or_default()
    }
}

/// Returns the dimensions of a switch with these deviations.
///
/// A pin rests in its groove, and its slot limits it: it is at the position of the groove, but no farther from the
/// middle of the slot than half of the play. Dimensions stay positive.
pub(super) fn made(design: &Design, deviations: &Deviations) -> MadeDimensions {
    let c = design.configuration();
    let bed = design.contact().bed();
    let by = |dimension| deviations.get(dimension, 0);
    let nominal = MadeDimensions::nominal(design.contact());
    let positive = |nominal: f64, by: f64| (nominal + by).max(0.02 * nominal);
    let layer_mm = positive(bed.layer_mm, by(ChainDimension::LayerThickness));
    let position_mm = |pin: usize| {
        let clearance_mm = c.support.slot_clearance_mm + SLOT_EXCESS_MM / 2.0;
        let width_mm = clearance_mm + deviations.get(ChainDimension::SlotWidth, pin);
        let half_play_mm = ((width_mm - by(ChainDimension::PinDiameter)) / 2.0).max(0.0);
        let slot_mm = deviations.get(ChainDimension::SlotPosition, pin);
        let groove_mm = deviations.get(ChainDimension::GroovePosition, pin);
        groove_mm.clamp(slot_mm - half_play_mm, slot_mm + half_play_mm)
    };
    let hardness = c.silicone.hardness_shore_a + by(ChainDimension::Hardness);
    MadeDimensions {
        wrap_rad: nominal.wrap_rad + by(ChainDimension::WrapAngle).to_radians(),
        bed: Bed {
            pin_diameter_mm: positive(bed.pin_diameter_mm, by(ChainDimension::PinDiameter)),
            groove_radius_mm: positive(bed.groove_radius_mm, by(ChainDimension::GrooveDepth)),
            // The contact is on the surface of the layer.
            contact_radius_mm: positive(bed.contact_radius_mm, by(ChainDimension::ShellRadius)) + layer_mm
                - bed.layer_mm,
            layer_mm,
            layer_width_mm: positive(bed.layer_width_mm, by(ChainDimension::LayerWidth)),
            tendon_radius_mm: positive(bed.tendon_radius_mm, by(ChainDimension::TendonDiameter) / 2.0),
            modulus_mpa: modulus_of_shore_a_mpa(hardness.clamp(1.0, 95.0)),
            ..*bed
        },
        pin_angles_rad: (nominal.pin_angles_rad.iter().enumerate())
            .map(|(pin, angle)| angle + position_mm(pin) / bed.contact_radius_mm)
            .collect(),
        pin_heights_mm: (0..nominal.pin_heights_mm.len())
            .map(|pin| deviations.get(ChainDimension::PinHeight, pin))
            .collect(),
    }
}
