//! One body: its exact solid in print orientation, its role, and its pose in the assembly.

use std::sync::OnceLock;

use serde::Serialize;

use super::omission::LeftOut;
use crate::design::Design;
use pinswitch_solid::mesh::{Mesh, Vector3};
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{CapError, Facing, Solid, ThinPlace};
use pinswitch_solid::validity::Expectation;

/// Tolerance of the thickness of walls of exactly two lines, mm.
const THIN_ROUNDING_MM: f64 = 1e-6;

/// The material of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Substance {
    /// Printed.
    Plastic,
    /// Cast.
    Silicone,
    /// Bought.
    Steel,
}

/// The role of a part, with its material, its colour, and its displacement in the exploded view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// The rigid, grooved sector.
    Shell,
    /// A part of the casting mould.
    Mould,
    /// A side support.
    Support {
        /// -1 for the support at z = 0, +1 for the one at the other end.
        outwards_z: f64,
    },
    /// The rigid copy of the silicone layer.
    Proxy,
    /// The cast layer.
    Layer,
    /// A steel pin.
    Pin {
        /// Number, from 0, by increasing angle.
        index: usize,
    },
    /// The tendon, taut over its bed.
    Tendon,
    /// A mounting part.
    Mount,
    /// A part of the rig on its table: a foot, the cell mount, or a part of the drive.
    Stand,
    /// The distal link of a joint, outside the right support.
    DistalLink,
    /// A separate part: coupon, guide pulley.
    Accessory,
}

impl Role {
    /// Returns the material of parts with this role.
    pub const fn material(self) -> Substance {
        match self {
            Self::Layer => Substance::Silicone,
            Self::Pin { .. } | Self::Tendon => Substance::Steel,
            _ => Substance::Plastic,
        }
    }

    /// Returns the colour in pictures: red, green, blue.
    pub const fn colour(self) -> [u8; 3] {
        match self {
            Self::Pin { .. } => [205, 210, 218],
            Self::Tendon => [72, 82, 96],
            Self::Mount | Self::DistalLink => [168, 158, 140],
            Self::Stand => [140, 158, 168],
            Self::Layer => [120, 190, 225],
            Self::Support { .. } => [236, 178, 74],
            Self::Mould => [150, 178, 126],
            Self::Shell => [226, 226, 220],
            Self::Proxy | Self::Accessory => [196, 170, 205],
        }
    }

    /// Returns the displacement in the exploded view, mm, in the frame of the assembly.
    pub fn explode_offset_mm(self) -> Vector3 {
        match self {
            Self::Support { outwards_z } => Vector3::new(0.0, 0.0, 12.0 * outwards_z),
            Self::Proxy | Self::Layer => Vector3::new(0.0, 7.0, 0.0),
            Self::Pin { .. } => Vector3::new(0.0, 14.0, 0.0),
            Self::Tendon => Vector3::new(0.0, 20.0, 0.0),
            Self::Mount => Vector3::new(0.0, 0.0, -24.0),
            Self::DistalLink => Vector3::new(0.0, 0.0, 36.0),
            Self::Shell | Self::Mould | Self::Accessory | Self::Stand => Vector3::zeros(),
        }
    }
}

/// One body. Its solid is in print orientation, with its lower end at z = 0 and the pulley's axis at the origin.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name, and stem of its file.
    pub name: String,
    /// Role.
    pub role: Role,
    /// Exact solid.
    pub solid: Solid,
    /// Pose in the assembly; `None` for tools such as the mould.
    pub pose: Option<Pose>,
    /// Pose in the assembled mould, for the parts of a split mould.
    pub tool_pose: Option<Pose>,
    /// Features that do not fit.
    pub left_out: Vec<LeftOut>,
    /// Engraved lines.
    pub engraved: Vec<String>,
    /// The solid in the orientation of its drawing, if that differs: about its own axis, or with its sides parallel to those of
    /// the paper.
    pub drawn: Option<Solid>,
    /// Limit in mm and thin places below it, once they are known. Private, since they belong to the solid.
    pub(super) thin: OnceLock<(f64, Vec<ThinPlace>)>,
}

impl Part {
    pub(super) fn new(name: impl Into<String>, role: Role, solid: Solid, pose: Option<Pose>) -> Self {
        Self {
            name: name.into(),
            role,
            solid,
            pose,
            tool_pose: None,
            left_out: Vec::new(),
            engraved: Vec::new(),
            drawn: None,
            thin: OnceLock::new(),
        }
    }

    /// Returns the material.
    pub const fn material(&self) -> Substance {
        self.role.material()
    }

    /// The same part with another solid, for a drawing.
    #[must_use]
    pub(crate) fn with_solid(&self, solid: Solid) -> Self {
        Self { solid, drawn: None, thin: OnceLock::new(), ..self.clone() }
    }

    /// Returns the expected properties of a valid mesh of the part: one body, and the exact volume
    /// within the bound of the chord tolerance.
    pub fn expectation(&self, design: &Design) -> Expectation {
        let bound = self.solid.volume_bound_mm3(design.tolerance());
        Expectation {
            bodies: Some(1),
            volume_mm3: Some((self.solid.volume_mm3(), bound)),
            ..Expectation::default()
        }
    }

    /// Returns the widest bridge in print orientation, mm: the largest shorter side of the bounding boxes of all downward faces
    /// above the bed; 0 without one.
    pub fn widest_bridge_mm(&self) -> f64 {
        let rings: Vec<(&Contour, f64)> = self.solid.rings().collect();
        let bed = self.solid.bounds().map_or(0.0, |(low, _)| low.z);
        self.solid
            .caps()
            .filter(|(facing, _)| *facing == Facing::Down)
            .filter_map(|(_, members)| members.first().map(|outline| rings[*outline]))
            .filter(|(_, z_mm)| *z_mm > bed + 1e-9)
            .map(|(contour, _)| {
                let (low, high) = contour.bounds();
                (high.x - low.x).min(high.y - low.y)
            })
            .fold(0.0, f64::max)
    }

    /// Meshes the solid, about the pulley's axis.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        self.solid.mesh(design.tolerance())
    }

    /// Returns the displacement from the pulley's axis to the print bed, mm: the middle of the bounding box is on the z axis, and
    /// the lower end at z = 0.
    pub fn print_shift_mm(&self) -> Vector3 {
        self.solid.bounds().map_or(Vector3::zeros(), |(low, high)| {
            let middle = nalgebra::center(&low, &high);
            Vector3::new(-middle.x, -middle.y, -low.z)
        })
    }

    /// Meshes the solid on the print bed.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn print_mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        Ok(self.mesh(design)?.translated(self.print_shift_mm()))
    }

    /// Returns the places of a printed part with less than two printed lines of material, the thinnest first.
    pub fn thin_places(&self, design: &Design) -> Vec<ThinPlace> {
        if self.material() != Substance::Plastic {
            return Vec::new();
        }
        let limit_mm = 2.0 * design.configuration().print.line_mm - THIN_ROUNDING_MM;
        let (known_limit_mm, places) = self.thin.get_or_init(|| (limit_mm, self.solid.thin_places(limit_mm)));
        if *known_limit_mm == limit_mm { places.clone() } else { self.solid.thin_places(limit_mm) }
    }

    /// The same part with the known thin places of a part with an equal solid.
    #[must_use]
    pub(crate) fn known_by(mut self, twin: &Self) -> Self {
        self.thin = twin.thin.clone();
        self
    }
}
