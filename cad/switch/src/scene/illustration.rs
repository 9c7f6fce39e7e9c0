//! Pictures of steps: bodies in place, bodies in motion with arrows, and call-outs.

use super::annotated::{Annotated, Annotation};
use super::arrow::{Target, Way, motion_arrow};
use super::bench::{Bench, Bodies};
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::render::{Body, Picture, View};

/// What a body does in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// It moves along a straight line to its place.
    Into,
    /// It moves along a straight line away from its place, and is gone afterwards.
    Away,
    /// It is poured, bent or peeled, and needs no straight path to its place.
    Flexible,
    /// It is peeled or cut off, and is gone afterwards.
    FlexibleAway,
    /// It is shown in its place, without an arrow.
    Still,
}

impl Motion {
    /// Returns whether the bodies are in their place after the step.
    pub const fn stays(self) -> bool {
        !matches!(self, Self::Away | Self::FlexibleAway)
    }

    /// Returns whether the bodies need a free straight path.
    pub const fn is_straight(self) -> bool {
        matches!(self, Self::Into | Self::Away)
    }
}

/// The arrows of bodies that move together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrows {
    /// None: other bodies of the same step have the same motion.
    None,
    /// One, where the bodies have material.
    One,
    /// One on the axis of the pulley.
    OnAxis,
    /// One for each body.
    Each,
}

/// Bodies that a step moves together.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Name in the call-out; empty for none.
    pub label: String,
    /// Motion.
    pub motion: Motion,
    /// Displacement from the place to where the picture shows the bodies, mm, in the frame of the bench.
    pub by: Vector3,
    /// Arrows.
    pub arrows: Arrows,
}

/// The motion of a tool or a liquid.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolArrow {
    /// First and last point in the frame of the bench.
    pub ends: [Point3; 2],
    /// Name in the call-out.
    pub label: String,
}

/// Orientation of a bench in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Upright {
    /// The axis of the pulley is vertical, as on the workbench.
    Axis,
    /// The grooves are up, and the axis is horizontal, from left to right.
    Grooves,
    /// The same, turned around the axis by an angle in radians, from the load side upward.
    Turned(f64),
}

/// The picture of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Illustration {
    /// Bench.
    pub bench: Bench,
    /// Bodies that earlier steps put into place.
    pub present: Vec<String>,
    /// Bodies that this step adds, moves or removes.
    pub moves: Vec<Move>,
    /// Call-outs of present bodies: name and text.
    pub notes: Vec<(String, String)>,
    /// Arrows of tools or liquids.
    pub arrows: Vec<ToolArrow>,
    /// Orientation.
    pub upright: Upright,
    /// Direction of the camera.
    pub view: View,
}

/// Share of white in the colour of bodies that earlier steps put into place.
const PRESENT_WHITE: f64 = 0.62;
fn lighter(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|v| (f64::from(v) + (246.0 - f64::from(v)) * PRESENT_WHITE).round() as u8)
}

impl Upright {
    fn point(self, p: Point3) -> Point3 {
        match self {
            Self::Axis => p,
            Self::Grooves => Point3::new(p.z, p.x, p.y),
            Self::Turned(angle_rad) => {
                let (sin, cos) = (libm::sin(angle_rad), libm::cos(angle_rad));
                Point3::new(p.z, cos * p.x + sin * p.y, cos * p.y - sin * p.x)
            }
        }
    }

    /// A displaced mesh in this orientation.
    fn mesh(self, mesh: &Mesh, by: Vector3) -> Mesh {
        let turned = mesh.positions.iter().map(|p| self.point(p + by)).collect();
        Mesh::new(turned, mesh.triangles.clone())
    }

    fn vector(self, v: Vector3) -> Vector3 {
        self.point(Point3::from(v)).coords
    }
}

impl Illustration {
    /// Draws the picture.
    pub fn draw(&self, bodies: &Bodies, width: u32, height: u32) -> Picture {
        let (names, bodies): (Vec<String>, Vec<Body>) = self.shown(bodies).unzip();
        let tools = self.arrows.iter().map(|arrow| Annotation::Pointed {
            from: self.upright.point(arrow.ends[0]),
            label: arrow.label.clone(),
        });
        Annotated {
            arrows: self.arrow_ends(&names, &bodies),
            annotations: self.callouts().chain(tools).collect(),
            bodies,
            names,
            view: self.view,
        }
        .draw(width, height)
    }

    /// Bodies of the picture in its orientation: present ones first.
    fn shown<'a>(&'a self, bodies: &'a Bodies) -> impl Iterator<Item = (String, Body)> + 'a {
        let moved = |name: &String| self.moves.iter().any(|m| m.bodies.contains(name));
        let present = self.present.iter().filter(move |name| !moved(name)).filter_map(|name| {
            let item = bodies.find(self.bench, name)?;
            let colour = if item.is_silicone { item.colour } else { lighter(item.colour) };
            Some((name.clone(), Body { mesh: self.upright.mesh(&item.mesh, Vector3::zeros()), colour }))
        });
        let moving = self.moves.iter().flat_map(move |m| {
            m.bodies.iter().filter_map(move |name| {
                let item = bodies.find(self.bench, name)?;
                let mesh = self.upright.mesh(&item.mesh, m.by);
                Some((name.clone(), Body { mesh, colour: item.colour }))
            })
        });
        present.chain(moving)
    }

    /// Call-outs of bodies.
    fn callouts(&self) -> impl Iterator<Item = Annotation> {
        let of_moves = self.moves.iter().filter(|m| !m.label.is_empty());
        let of_moves = of_moves.map(|m| (m.bodies.clone(), m.label.clone()));
        let of_notes = self.notes.iter().map(|(name, text)| (vec![name.clone()], text.clone()));
        of_moves.chain(of_notes).map(|(bodies, label)| Annotation::Named { bodies, label })
    }

    /// First and last points of all arrows, in the orientation of the picture.
    fn arrow_ends(&self, names: &[String], bodies: &[Body]) -> Vec<[Point3; 2]> {
        let mut all: Vec<[Point3; 2]> =
            self.arrows.iter().map(|arrow| arrow.ends.map(|p| self.upright.point(p))).collect();
        let targets: Vec<(&String, Target<'_>)> = names
            .iter()
            .zip(bodies)
            .filter_map(|(name, body)| Some((name, Target::new(&body.mesh)?)))
            .collect();
        let toward_camera = self.view.toward_camera();
        for m in self.moves.iter().filter(|m| m.motion != Motion::Still) {
            let by = self.upright.vector(m.by);
            let of = |is_moved: bool| -> Vec<&Target<'_>> {
                let wanted = targets.iter().filter(|(name, _)| m.bodies.contains(name) == is_moved);
                wanted.map(|(_, target)| target).collect()
            };
            let (moved, others) = (of(true), of(false));
            let groups: Vec<&[&Target<'_>]> = match m.arrows {
                Arrows::None => Vec::new(),
                Arrows::One | Arrows::OnAxis => vec![&moved],
                Arrows::Each => moved.chunks(1).collect(),
            };
            let axis = (m.arrows == Arrows::OnAxis).then(Point3::origin);
            let way = Way { by, motion: m.motion, axis };
            let arrow = |group: &[&Target<'_>]| motion_arrow(group, &others, &way, toward_camera);
            all.extend(groups.into_iter().filter_map(arrow));
        }
        all
    }
}
