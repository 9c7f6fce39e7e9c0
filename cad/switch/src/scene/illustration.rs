//! Pictures of steps: bodies in place, bodies in motion with arrows, and call-outs.

use super::arrow::{Target, motion_arrow};
use super::bench::{Bench, Bodies};
use super::overlay::{Canvas, Pixel, gap, size};
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};
use pinswitch_solid::render::{Body, Frame, Picture, Projection, Rendering, View, render_in};

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
    /// One.
    One,
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
/// Most letters in a line of a call-out.
const MOST_LETTERS: usize = 16;
/// Share of the width of a picture, left of which a body has its call-out at the left.
const LEFT_SHARE: f64 = 0.4;
/// Distance from the edge of a body that the end of a leader line keeps where it can, as a part of the width of the picture, and
/// the detour for it in such distances.
const EDGE_SHARE: usize = 130;
const EDGE_PENALTY: usize = 8;
/// Largest difference of shades of an even surface, and the detour for it in distances from the edge.
const EVEN: u8 = 12;
const MARK_PENALTY: usize = 5;
/// Depth by which a body must be in front of an arrow to hide it, mm: an arrow on a surface is visible.
const HIDING_MM: f64 = 0.5;

/// A body of the picture, with the move or note to which it belongs.
struct Shown {
    name: String,
    body: Body,
}

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

    fn mesh(self, mesh: Mesh) -> Mesh {
        let turned = mesh.positions.iter().map(|p| self.point(*p)).collect();
        Mesh::new(turned, mesh.triangles)
    }

    fn vector(self, v: Vector3) -> Vector3 {
        self.point(Point3::from(v)).coords
    }
}

impl Illustration {
    /// Draws the picture.
    pub fn draw(&self, bodies: &Bodies, width: u32, height: u32) -> Picture {
        let shown = self.shown(bodies);
        let arrows = self.arrow_ends(&shown);
        let also: Vec<Point3> = arrows.iter().flatten().copied().collect();
        let plain: Vec<Body> = shown.iter().map(|s| s.body.clone()).collect();
        let callouts = self.callouts();
        let frame = Frame { width, height, left: 0, right: 0 };
        let roughly = Projection::new(&plain, &also, self.view, frame);
        let middle = |name: &String| {
            let (low, high) = shown.iter().find(|s| s.name == *name)?.body.mesh.bounds()?;
            Some(roughly.pixel(nalgebra::center(&low, &high))[0])
        };
        let is_left = |names: &[String]| {
            let columns: Vec<f64> = names.iter().filter_map(middle).collect();
            columns.iter().sum::<f64>() / (columns.len().max(1) as f64) < LEFT_SHARE * f64::from(width)
        };
        let lettering = |label: &str, is_left: bool| {
            let lines = wrapped(label);
            Lettering { size: size(&lines, width), lines, is_left, at: [0.0; 2], anchor: None }
        };
        let of_bodies = callouts.iter().map(|(names, label)| lettering(label, is_left(names)));
        let of_tools = self.arrows.iter().map(|arrow| {
            let column = roughly.pixel(self.upright.point(arrow.ends[0]))[0];
            lettering(&arrow.label, column < LEFT_SHARE * f64::from(width))
        });
        let mut letterings: Vec<Lettering> = of_bodies.chain(of_tools).collect();
        let column = |left: bool| {
            let widest =
                letterings.iter().filter(|l| l.is_left == left).map(|l| l.size[0]).fold(0.0, f64::max);
            if widest > 0.0 { (widest + 2.0 * gap(width)).ceil() as u32 } else { 0 }
        };
        let frame = Frame { left: column(true), right: column(false), ..frame };
        let rendering = render_in(&plain, &also, self.view, frame);
        let projection = rendering.projection;
        for ((names, _), lettering) in callouts.iter().zip(&mut letterings) {
            lettering.anchor = anchor(&shown, names, &rendering, width);
        }
        for (arrow, lettering) in self.arrows.iter().zip(&mut letterings[callouts.len()..]) {
            lettering.anchor = Some(projection.pixel(self.upright.point(arrow.ends[0])));
        }
        place(&mut letterings, frame);
        let mut picture = rendering.picture.clone();
        let mut canvas = Canvas::new(&mut picture);
        for [from, to] in &arrows {
            let is_hidden = |share: f64| rendering.hides(from + (to - from) * share, HIDING_MM);
            canvas.arrow(projection.pixel(*from), projection.pixel(*to), is_hidden);
        }
        for l in &letterings {
            if let Some(anchor) = l.anchor {
                canvas.leader(l.leader_start(width), anchor);
            }
        }
        // A call-out of a hidden body would name nothing.
        for l in letterings.iter().filter(|l| l.anchor.is_some()) {
            canvas.write(&l.lines, l.at);
        }
        picture
    }

    /// Bodies of the picture in its orientation: present ones first.
    fn shown(&self, bodies: &Bodies) -> Vec<Shown> {
        let moved = |name: &String| self.moves.iter().any(|m| m.bodies.contains(name));
        let present = self.present.iter().filter(|name| !moved(name)).filter_map(|name| {
            let item = bodies.find(self.bench, name)?;
            let colour = if item.is_silicone { item.colour } else { lighter(item.colour) };
            let body = Body { mesh: self.upright.mesh(item.mesh.clone()), colour };
            Some(Shown { name: name.clone(), body })
        });
        let moving = self.moves.iter().flat_map(|m| {
            m.bodies.iter().filter_map(|name| {
                let item = bodies.find(self.bench, name)?;
                let mesh = self.upright.mesh(item.mesh.clone().translated(m.by));
                Some(Shown { name: name.clone(), body: Body { mesh, colour: item.colour } })
            })
        });
        present.chain(moving).collect()
    }

    /// Call-outs: bodies and text.
    fn callouts(&self) -> Vec<(Vec<String>, &str)> {
        let of_moves = self.moves.iter().filter(|m| !m.label.is_empty());
        let of_moves = of_moves.map(|m| (m.bodies.clone(), m.label.as_str()));
        of_moves.chain(self.notes.iter().map(|(name, text)| (vec![name.clone()], text.as_str()))).collect()
    }

    /// First and last points of all arrows, in the orientation of the picture.
    fn arrow_ends(&self, shown: &[Shown]) -> Vec<[Point3; 2]> {
        let mut all: Vec<[Point3; 2]> =
            self.arrows.iter().map(|arrow| arrow.ends.map(|p| self.upright.point(p))).collect();
        let targets: Vec<(&String, Target<'_>)> =
            shown.iter().filter_map(|s| Some((&s.name, Target::new(&s.body.mesh)?))).collect();
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
                Arrows::One => vec![&moved],
                Arrows::Each => moved.chunks(1).collect(),
            };
            let arrow = |group: &[&Target<'_>]| motion_arrow(group, &others, by, m.motion, toward_camera);
            all.extend(groups.into_iter().filter_map(arrow));
        }
        all
    }
}

/// The text of a call-out with its place.
struct Lettering {
    lines: Vec<String>,
    size: Pixel,
    is_left: bool,
    at: Pixel,
    anchor: Option<Pixel>,
}

impl Lettering {
    /// The end of the leader line at the text.
    fn leader_start(&self, width: u32) -> Pixel {
        let air = gap(width) / 3.0;
        let column = if self.is_left { self.at[0] + self.size[0] + air } else { self.at[0] - air };
        [column, self.at[1] + self.size[1] / 2.0]
    }
}

/// Breaks a text after spaces into lines of [`MOST_LETTERS`] where possible, in capitals.
fn wrapped(label: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in label.split(' ') {
        // The font has a multiplication sign in place of a small x.
        let word = if word == "x" { word.to_owned() } else { word.to_ascii_uppercase() };
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= MOST_LETTERS => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// Returns the visible pixel of one of the bodies nearest to the middle of its visible pixels, for the body with most of them,
/// away from its edges, and on an even surface, where possible.
fn anchor(shown: &[Shown], names: &[String], rendering: &Rendering, width: u32) -> Option<Pixel> {
    let (width, around) = (width as usize, width as usize / EDGE_SHARE);
    let owners = &rendering.bodies;
    let numbers = shown.iter().enumerate().filter(|(_, s)| names.contains(&s.name)).map(|(i, _)| i);
    let is_own = |i: usize, number: usize| {
        owners.get(i).copied().flatten().is_some_and(|owner| usize::from(owner) == number)
    };
    let pixels = numbers.map(|number| {
        let own = (0..owners.len()).step_by(3).filter(|i| is_own(*i, number)).collect::<Vec<_>>();
        (number, own)
    });
    let (number, pixels) = pixels.max_by_key(|(_, own)| own.len()).filter(|(_, own)| !own.is_empty())?;
    let place = |i: usize| [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
    let mean = [0, 1].map(|k| pixels.iter().map(|i| place(*i)[k]).sum::<f64>() / pixels.len() as f64);
    let is_inside = |i: usize| {
        let neighbours =
            [i + around, i.wrapping_sub(around), i + around * width, i.wrapping_sub(around * width)];
        neighbours.into_iter().all(|i| is_own(i, number))
    };
    // Engraved text has other shades than the face around it.
    let shade = |i: usize| &rendering.picture.pixels[3 * i..3 * i + 3];
    let is_even = |i: usize| {
        let near = |j: usize| shade(i).iter().zip(shade(j)).all(|(a, b)| a.abs_diff(*b) <= EVEN);
        (1..=2 * around)
            .step_by(2)
            .all(|k| near(i + k) && near(i - k) && near(i + k * width) && near(i - k * width))
    };
    let margin = 2 * around * (width + 1);
    let off = |i: usize| {
        let [x, y] = place(i);
        let edge = if is_inside(i) { 0.0 } else { (EDGE_PENALTY * around) as f64 };
        let is_far = (margin..owners.len().saturating_sub(margin)).contains(&i);
        let marks = if is_far && is_even(i) { 0.0 } else { (MARK_PENALTY * around) as f64 };
        libm::hypot(x - mean[0], y - mean[1]) + edge + marks
    };
    let nearest = pixels.into_iter().map(|i| (off(i), i)).min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(place(nearest.1))
}

/// Places the texts of each side in the order of their bodies, without overlap.
fn place(letterings: &mut [Lettering], frame: Frame) {
    let gap = gap(frame.width);
    for left in [true, false] {
        let mut column: Vec<&mut Lettering> = letterings.iter_mut().filter(|l| l.is_left == left).collect();
        let row = |l: &Lettering| l.anchor.map_or(0.0, |a| a[1]);
        column.sort_by(|a, b| row(a).total_cmp(&row(b)));
        let mut free = gap;
        for l in &mut column {
            let wanted = row(l) - l.size[1] / 2.0;
            l.at[1] = wanted.max(free);
            free = l.at[1] + l.size[1] + gap;
            l.at[0] = if left {
                f64::from(frame.left) - gap - l.size[0]
            } else {
                f64::from(frame.width - frame.right) + gap
            };
        }
        let mut most = f64::from(frame.height) - gap;
        for l in column.iter_mut().rev() {
            l.at[1] = l.at[1].min(most - l.size[1]);
            most = l.at[1] - gap;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lettering(row: f64, is_left: bool) -> Lettering {
        let lines = wrapped("left support l");
        Lettering { size: size(&lines, 1600), lines, is_left, at: [0.0; 2], anchor: Some([800.0, row]) }
    }

    /// Texts do not overlap each other or the edge of the picture, wherever their bodies are.
    #[test]
    fn callouts_do_not_overlap() {
        let frame = Frame { width: 1600, height: 1100, left: 450, right: 450 };
        for rows in [[500.0, 510.0, 505.0, 20.0, 1090.0, 1095.0], [0.0; 6], [1099.0; 6]] {
            let mut all: Vec<Lettering> = rows.iter().map(|row| lettering(*row, false)).collect();
            all.push(lettering(300.0, true));
            place(&mut all, frame);
            for (i, a) in all.iter().enumerate() {
                assert!(a.at[0] >= 0.0 && a.at[0] + a.size[0] <= 1600.0);
                assert!(a.at[1] >= 0.0 && a.at[1] + a.size[1] <= 1100.0, "{rows:?}");
                for b in &all[..i] {
                    let is_apart = a.is_left != b.is_left
                        || a.at[1] + a.size[1] < b.at[1]
                        || b.at[1] + b.size[1] < a.at[1];
                    assert!(is_apart, "{rows:?}");
                }
            }
        }
    }

    #[test]
    fn labels_break_after_words() {
        assert_eq!(wrapped("2 screws M3 x 25"), ["2 SCREWS M3 x 25"]);
        assert_eq!(wrapped("guide pulley with bearing"), ["GUIDE PULLEY", "WITH BEARING"]);
        assert_eq!(wrapped("proxy"), ["PROXY"]);
    }
}
