//! Lines, arrows and lettering on a picture.

use crate::parts::{LETTER_HEIGHT, LETTER_WIDTH, letter_strokes};
use pinswitch_solid::render::Picture;

/// A place on a picture: column and row, pixels.
pub(super) type Pixel = [f64; 2];

/// Colour of lettering and leader lines.
const INK: [u8; 3] = [38, 42, 48];
/// Colour of arrows of motion.
const MOTION: [u8; 3] = [214, 74, 26];
/// Colour of arrows behind a body.
const HIDDEN: [u8; 3] = [236, 150, 118];
/// Colour around lines, so that they are visible on every body.
const HALO: [u8; 3] = [250, 250, 248];

/// Sizes in a picture of [`REFERENCE_PX`], pixels: height of a letter, width of its strokes, width of leader lines and of their
/// halo, radius of their ends, width of arrows, length and half of the width of their heads, length of a dash.
const LETTER_PX: f64 = 31.0;
const STROKE_PX: f64 = 4.2;
const LEADER_PX: f64 = 3.0;
const HALO_PX: f64 = 4.0;
const DOT_PX: f64 = 7.0;
const ARROW_PX: f64 = 9.0;
const HEAD_PX: f64 = 34.0;
const HEAD_HALF_PX: f64 = 17.0;
const DASH_PX: f64 = 16.0;
/// Number of places along an arrow at which it may end.
const ENDS: u32 = 64;
/// Share of the visible length of an arrow that ends behind a body.
const BEFORE: f64 = 0.85;
/// Width of the picture to which these sizes belong, pixels.
const REFERENCE_PX: f64 = 1600.0;
/// Advance from letter to letter, and from line to line, in heights of a letter.
const ADVANCE: f64 = (LETTER_WIDTH + 1.5) / LETTER_HEIGHT;
const LINE: f64 = 1.55;

/// Draws on a picture, with sizes in proportion to its width.
pub(super) struct Canvas<'a> {
    picture: &'a mut Picture,
    unit: f64,
}

impl<'a> Canvas<'a> {
    pub(super) fn new(picture: &'a mut Picture) -> Self {
        let unit = unit(picture.width);
        Self { picture, unit }
    }

    /// Draws the shape whose signed distance to a pixel is `outside`, in a box.
    fn fill(&mut self, [low, high]: [Pixel; 2], colour: [u8; 3], outside: impl Fn(Pixel) -> f64) {
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        let first = low.map(|v| (v - 1.0).max(0.0) as usize);
        let last = [high[0], high[1]].map(|v| (v + 2.0).max(0.0) as usize);
        for row in first[1]..last[1].min(height) {
            for column in first[0]..last[0].min(width) {
                let cover = (0.5 - outside([column as f64 + 0.5, row as f64 + 0.5])).clamp(0.0, 1.0);
                if cover > 0.0 {
                    let pixel = &mut self.picture.pixels[(row * width + column) * 3..][..3];
                    for (old, new) in pixel.iter_mut().zip(colour) {
                        *old = (f64::from(*old) + (f64::from(new) - f64::from(*old)) * cover).round() as u8;
                    }
                }
            }
        }
    }

    /// Draws a line with round ends.
    fn line(&mut self, from: Pixel, to: Pixel, width: f64, colour: [u8; 3]) {
        let half = width / 2.0;
        let low = [from[0].min(to[0]) - half, from[1].min(to[1]) - half];
        let high = [from[0].max(to[0]) + half, from[1].max(to[1]) + half];
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length2 = (dx * dx + dy * dy).max(1e-9);
        self.fill([low, high], colour, |[x, y]| {
            let along = (((x - from[0]) * dx + (y - from[1]) * dy) / length2).clamp(0.0, 1.0);
            libm::hypot(x - from[0] - along * dx, y - from[1] - along * dy) - half
        });
    }

    /// Draws a triangle.
    fn triangle(&mut self, corners: [Pixel; 3], margin: f64, colour: [u8; 3]) {
        let coordinate = |k: usize| corners.map(|c| c[k]);
        let low = [0, 1].map(|k| coordinate(k).into_iter().fold(f64::INFINITY, f64::min) - margin);
        let high = [0, 1].map(|k| coordinate(k).into_iter().fold(f64::NEG_INFINITY, f64::max) + margin);
        let [a, b, c] = corners;
        let turn = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum();
        let beyond = |p: Pixel, a: Pixel, b: Pixel| {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            -turn * (dx * (p[1] - a[1]) - dy * (p[0] - a[0])) / libm::hypot(dx, dy).max(1e-9)
        };
        self.fill([low, high], colour, |p| {
            beyond(p, a, b).max(beyond(p, b, c)).max(beyond(p, c, a)) - margin
        });
    }

    /// Draws an arrow of motion, as far as it is visible. A part of it that `is_hidden`, by its share of the length, is dashed and
    /// pale, and so is an arrow of which nothing is visible.
    pub(super) fn arrow(&mut self, from: Pixel, to: Pixel, is_hidden: impl Fn(f64) -> bool) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let full = libm::hypot(dx, dy);
        if full < 1.0 {
            return;
        }
        let along = [dx / full, dy / full];
        // The end is what matters: a head behind a body would be missed.
        let visible =
            (1..=ENDS).rev().map(|i| f64::from(i) / f64::from(ENDS)).find(|share| !is_hidden(*share));
        // An end that goes behind a body stops before it, so that it does not point to that body.
        let visible = visible.map(|share| if share < 1.0 { share * BEFORE } else { share });
        let visible = visible.filter(|share| share * full > HEAD_PX * self.unit);
        let length = visible.unwrap_or(1.0) * full;
        let to = [from[0] + along[0] * length, from[1] + along[1] * length];
        let head = (HEAD_PX * self.unit).min(0.7 * length);
        let half = head * HEAD_HALF_PX / HEAD_PX;
        let at = |distance: f64| [from[0] + along[0] * distance, from[1] + along[1] * distance];
        let foot = at(length - head);
        let corners = [
            to,
            [foot[0] - along[1] * half, foot[1] + along[0] * half],
            [foot[0] + along[1] * half, foot[1] - along[0] * half],
        ];
        let (width, halo, dash) = (ARROW_PX * self.unit, HALO_PX * self.unit, DASH_PX * self.unit);
        let shaft = length - head;
        let steps = (shaft / (dash / 2.0)).ceil().max(1.0);
        // Stretches of the shaft with equal visibility, of half a dash.
        let stretches: Vec<(f64, f64, bool)> = (0..steps as u32)
            .map(|step| {
                let [start, end] = [0.0, 1.0].map(|k| (f64::from(step) + k) / steps * shaft);
                (start, end, is_hidden((start + end) / 2.0 / full))
            })
            .collect();
        let head_colour = if visible.is_some() { MOTION } else { HIDDEN };
        for (start, end, _) in stretches.iter().filter(|(.., hidden)| !hidden) {
            self.line(at(*start), at(*end), width + 2.0 * halo, HALO);
        }
        self.triangle(corners, halo, HALO);
        for (number, (start, end, hidden)) in stretches.iter().enumerate() {
            if !hidden {
                self.line(at(*start), at(*end), width, MOTION);
            } else if number % 4 < 2 {
                self.line(at(*start), at(*end), width / 2.0, HIDDEN);
            }
        }
        self.triangle(corners, 0.0, head_colour);
    }

    /// Draws a leader line from a lettering to a dot on a body.
    pub(super) fn leader(&mut self, from: Pixel, to: Pixel) {
        let (width, halo, dot) = (LEADER_PX * self.unit, HALO_PX * self.unit, DOT_PX * self.unit);
        self.line(from, to, width + halo, HALO);
        self.line(to, to, 2.0 * dot + halo, HALO);
        self.line(from, to, width, INK);
        self.line(to, to, 2.0 * dot, INK);
    }

    /// Writes lines of text from the upper left corner of the first letter.
    pub(super) fn write(&mut self, lines: &[String], at: Pixel) {
        let height = LETTER_PX * self.unit;
        let scale = height / LETTER_HEIGHT;
        for (number, line) in lines.iter().enumerate() {
            for (column, letter) in line.chars().enumerate() {
                let left = at[0] + column as f64 * ADVANCE * height;
                let base = at[1] + height * (1.0 + LINE * number as f64);
                let place = |[x, y]: [f64; 2]| [left + x * scale, base - y * scale];
                for stroke in strokes(letter) {
                    for ends in stroke.windows(2) {
                        self.line(place(ends[0]), place(ends[1]), STROKE_PX * self.unit, INK);
                    }
                }
            }
        }
    }
}

/// Returns the strokes of a letter: those for engraving, except where sharp angles, which do not print, make a letter easier to
/// read.
fn strokes(letter: char) -> Vec<Vec<[f64; 2]>> {
    let points: &[[f64; 2]] = match letter.to_ascii_uppercase() {
        'M' => &[[0.0, 0.0], [0.0, 6.0], [2.0, 3.0], [4.0, 6.0], [4.0, 0.0]],
        'N' => &[[0.0, 0.0], [0.0, 6.0], [4.0, 0.0], [4.0, 6.0]],
        'V' => &[[0.0, 6.0], [2.0, 0.0], [4.0, 6.0]],
        'W' => &[[0.0, 6.0], [1.0, 0.0], [2.0, 4.0], [3.0, 0.0], [4.0, 6.0]],
        'O' => return letter_strokes('0').unwrap_or_default(),
        ',' => &[[1.0, 0.8], [0.4, -1.2]],
        _ => return letter_strokes(letter).unwrap_or_default(),
    };
    vec![points.to_vec()]
}

/// Size of a pixel of the reference in a picture of this width.
pub(super) fn unit(width: u32) -> f64 {
    f64::from(width) / REFERENCE_PX
}

/// Width and height of a lettering, pixels.
pub(super) fn size(lines: &[String], width: u32) -> Pixel {
    let height = LETTER_PX * unit(width);
    let longest = lines.iter().map(|l| l.chars().count()).max().unwrap_or(0) as f64;
    let rows = lines.len().saturating_sub(1) as f64;
    [(longest * ADVANCE - 1.5 / LETTER_HEIGHT).max(0.0) * height, height * (1.0 + LINE * rows)]
}

/// Distance of two letterings, pixels.
pub(super) fn gap(width: u32) -> f64 {
    LETTER_PX * unit(width) * 0.9
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank() -> Picture {
        Picture { width: 400, height: 200, pixels: vec![250; 400 * 200 * 3] }
    }

    fn is_drawn(picture: &Picture, [column, row]: [usize; 2]) -> bool {
        picture.pixels[(row * 400 + column) * 3 + 2] < 120
    }

    #[test]
    fn arrows_point_to_their_end() {
        let mut picture = blank();
        Canvas::new(&mut picture).arrow([50.0, 100.0], [200.0, 100.0], |_| false);
        assert!(is_drawn(&picture, [100, 100]) && is_drawn(&picture, [198, 100]));
        assert!(!is_drawn(&picture, [204, 100]) && !is_drawn(&picture, [44, 100]));
        // The head is wider than the shaft.
        assert!(is_drawn(&picture, [194, 102]) && !is_drawn(&picture, [100, 103]));
    }

    #[test]
    fn lettering_is_within_its_size() {
        let mut picture = blank();
        let lines = ["PINS".to_owned(), "M3 X 25".to_owned()];
        let [width, height] = size(&lines, 400);
        Canvas::new(&mut picture).write(&lines, [20.0, 30.0]);
        let drawn = |column: usize| (0..200).any(|row| is_drawn(&picture, [column, row]));
        let columns: Vec<usize> = (0..400).filter(|c| drawn(*c)).collect();
        let rows: Vec<usize> =
            (0..200).filter(|row| (0..400).any(|c| is_drawn(&picture, [c, *row]))).collect();
        assert!(columns[0] >= 19 && columns[columns.len() - 1] as f64 <= 21.0 + width);
        assert!(rows[0] >= 29 && rows[rows.len() - 1] as f64 <= 31.0 + height);
    }
}
