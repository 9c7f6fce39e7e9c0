//! One body: its exact solid in print orientation, what it is for, and its place in the assembly.

use std::sync::OnceLock;

use serde::Serialize;

use super::LeftOut;
use crate::design::Design;
use pinswitch_solid::mesh::{Mesh, Vector3};
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{CapError, Facing, Solid, ThinPlace};
use pinswitch_solid::validity::Expectation;

/// What a part is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Material {
    /// Printed.
    Abs,
    /// Cast.
    Silicone,
    /// Bought.
    Steel,
}

/// What a part is for: decides its material, its colour, and how it comes out of the assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// The rigid, grooved sector.
    Shell,
    /// A piece of the casting mould.
    Mould,
    /// A side support.
    Support {
        /// -1 at z = 0, +1 at the other end: the side of the switch on which it lies.
        outwards_z: f64,
    },
    /// The rigid copy of the silicone layer.
    Proxy,
    /// The cast layer.
    Layer,
    /// A steel pin.
    Pin {
        /// Its number, from 0, along increasing angle.
        index: usize,
    },
    /// The tendon, taut over its bed.
    Tendon,
    /// What the switch is mounted by.
    Mount,
    /// Anything beside the switch: coupon, guide pulley.
    Accessory,
}

impl Role {
    /// What parts of this role are made of.
    pub const fn material(self) -> Material {
        match self {
            Self::Layer => Material::Silicone,
            Self::Pin { .. } | Self::Tendon => Material::Steel,
            _ => Material::Abs,
        }
    }

    /// The colour in pictures: red, green, blue.
    pub const fn colour(self) -> [u8; 3] {
        match self {
            Self::Pin { .. } => [205, 210, 218],
            Self::Tendon => [72, 82, 96],
            Self::Mount => [168, 158, 140],
            Self::Layer => [120, 190, 225],
            Self::Support { .. } => [236, 178, 74],
            Self::Mould => [150, 178, 126],
            Self::Shell => [226, 226, 220],
            Self::Proxy | Self::Accessory => [196, 170, 205],
        }
    }

    /// How far the part moves in an exploded view, mm in the assembly's frame.
    pub fn explode_offset_mm(self) -> Vector3 {
        match self {
            Self::Support { outwards_z } => Vector3::new(0.0, 0.0, 12.0 * outwards_z),
            Self::Proxy | Self::Layer => Vector3::new(0.0, 7.0, 0.0),
            Self::Pin { .. } => Vector3::new(0.0, 14.0, 0.0),
            Self::Tendon => Vector3::new(0.0, 20.0, 0.0),
            Self::Mount => Vector3::new(0.0, 0.0, -24.0),
            Self::Shell | Self::Mould | Self::Accessory => Vector3::zeros(),
        }
    }
}

/// One body: an exact solid, standing on z = 0 in print orientation, the pulley's axis at the origin.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name, and stem of its file.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// The exact solid.
    pub solid: Solid,
    /// Where it sits in the assembly; `None` for tools such as the mould.
    pub pose: Option<Pose>,
    /// Where it sits among the tools that are put together with it: the parts of a split mould.
    pub tool_pose: Option<Pose>,
    /// What was asked for and found no room on it.
    pub left_out: Vec<LeftOut>,
    /// What is engraved in it, line by line.
    pub engraved: Vec<String>,
    /// The solid as a workshop draws it, where that is not as it lies in the set: about its own axis, or with its sides
    /// along the paper.
    pub drawn: Option<Solid>,
    /// Its thin places, once they were looked for: those under so many millimetres. Private, so that nobody gives it another
    /// solid and keeps them.
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

    /// What it is made of.
    pub const fn material(&self) -> Material {
        self.role.material()
    }

    /// The same with another solid, as a drawing shows it: nothing is known of that yet.
    #[must_use]
    pub(crate) fn with_solid(&self, solid: Solid) -> Self {
        Self { solid, drawn: None, thin: OnceLock::new(), ..self.clone() }
    }

    /// What its mesh is compared with: one body, and the exact volume within what the chord tolerance allows.
    pub fn expectation(&self, design: &Design) -> Expectation {
        let bound = self.solid.volume_bound_mm3(design.tolerance());
        Expectation {
            bodies: Some(1),
            volume_mm3: Some((self.solid.volume_mm3(), bound)),
            ..Expectation::default()
        }
    }

    /// Widest ceiling to be bridged when it is printed, mm: over all faces that look down from above the bed, the shorter
    /// side of their bounding box. 0 without any.
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

    /// The mesh about the pulley's axis, standing on z = 0.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        self.solid.mesh(design.tolerance())
    }

    /// The displacement from the pulley's axis to the print bed, mm: the middle of the bounding box comes to lie on the z
    /// axis, and the part to stand on z = 0.
    pub fn print_shift_mm(&self) -> Vector3 {
        self.solid.bounds().map_or(Vector3::zeros(), |(low, high)| {
            let middle = nalgebra::center(&low, &high);
            Vector3::new(-middle.x, -middle.y, -low.z)
        })
    }

    /// The mesh as it is written, on the print bed.
    ///
    /// # Errors
    /// [`CapError`] if contours cross, which a valid design excludes.
    pub fn print_mesh(&self, design: &Design) -> Result<Mesh, CapError> {
        Ok(self.mesh(design)?.translated(self.print_shift_mm()))
    }
}
