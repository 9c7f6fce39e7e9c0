//! Pictures with call-outs and arrows.

use super::overlay::{Canvas, Pixel, gap, size};
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::render::{Body, Frame, Picture, Projection, Rendering, View, render_in};

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
const MARK_PENALTY: usize = 14;
/// Depth by which a body must be in front of an arrow to hide it, mm: an arrow on a surface is visible.
const HIDING_MM: f64 = 0.5;

/// A text with a leader line.
pub(super) enum Annotation {
    /// To the most visible of these bodies.
    Named {
        /// Names of the bodies.
        bodies: Vec<String>,
        /// Text.
        label: String,
    },
    /// To a point.
    Pointed {
        /// The point.
        from: Point3,
        /// Text.
        label: String,
    },
}

/// Bodies with annotations.
pub(super) struct Annotated {
    pub(super) bodies: Vec<Body>,
    /// Names of the bodies.
    pub(super) names: Vec<String>,
    pub(super) annotations: Vec<Annotation>,
    /// First and last points of arrows.
    pub(super) arrows: Vec<[Point3; 2]>,
    pub(super) view: View,
}

impl Annotated {
    /// Draws the picture.
    pub(super) fn draw(&self, width: u32, height: u32) -> Picture {
        let also: Vec<Point3> = self.arrows.iter().flatten().copied().collect();
        let frame = Frame { width, height, left: 0, right: 0 };
        let roughly = Projection::new(&self.bodies, &also, self.view, frame);
        let mut letterings: Vec<Lettering> = self
            .annotations
            .iter()
            .map(|annotation| {
                let lines = wrapped(annotation.label());
                let is_left = self.column(annotation, roughly) < LEFT_SHARE * f64::from(width);
                Lettering { size: size(&lines, width), lines, is_left, at: [0.0; 2], anchor: None }
            })
            .collect();
        let column = |left: bool| {
            let widest =
                letterings.iter().filter(|l| l.is_left == left).map(|l| l.size[0]).fold(0.0, f64::max);
            if widest > 0.0 { (widest + 2.0 * gap(width)).ceil() as u32 } else { 0 }
        };
        let frame = Frame { left: column(true), right: column(false), ..frame };
        let rendering = render_in(&self.bodies, &also, self.view, frame);
        for (annotation, lettering) in self.annotations.iter().zip(&mut letterings) {
            lettering.anchor = match annotation {
                Annotation::Named { bodies, .. } => anchor(&self.names, bodies, &rendering, width),
                Annotation::Pointed { from, .. } => Some(rendering.projection.pixel(*from)),
            };
        }
        place(&mut letterings, frame);
        let mut picture = rendering.picture.clone();
        let mut canvas = Canvas::new(&mut picture);
        for [from, to] in &self.arrows {
            let is_hidden = |share: f64| rendering.hides(from + (to - from) * share, HIDING_MM);
            canvas.arrow(rendering.projection.pixel(*from), rendering.projection.pixel(*to), is_hidden);
        }
        // A call-out of a hidden body would name nothing.
        for l in &letterings {
            let Some(anchor) = l.anchor else { continue };
            canvas.leader(l.leader_start(width), anchor);
        }
        for l in letterings.iter().filter(|l| l.anchor.is_some()) {
            canvas.write(&l.lines, l.at);
        }
        picture
    }

    /// The column of an annotation, before its text takes room.
    fn column(&self, annotation: &Annotation, roughly: Projection) -> f64 {
        let middle = |name: &String| {
            let number = self.names.iter().position(|other| other == name)?;
            let (low, high) = self.bodies.get(number)?.mesh.bounds()?;
            Some(roughly.pixel(nalgebra::center(&low, &high))[0])
        };
        match annotation {
            Annotation::Named { bodies, .. } => {
                let columns: Vec<f64> = bodies.iter().filter_map(middle).collect();
                columns.iter().sum::<f64>() / columns.len().max(1) as f64
            }
            Annotation::Pointed { from, .. } => roughly.pixel(*from)[0],
        }
    }
}

impl Annotation {
    fn label(&self) -> &str {
        match self {
            Self::Named { label, .. } | Self::Pointed { label, .. } => label,
        }
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
fn anchor(shown: &[String], names: &[String], rendering: &Rendering, width: u32) -> Option<Pixel> {
    let (width, around) = (width as usize, width as usize / EDGE_SHARE);
    let owners = &rendering.bodies;
    let numbers = shown.iter().enumerate().filter(|(_, name)| names.contains(name)).map(|(i, _)| i);
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
