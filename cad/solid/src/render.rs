//! Pictures of parts: a small software renderer with a depth buffer and four samples per pixel, two along each side.

use nalgebra::{Rotation3, Unit};

use crate::mesh::{Mesh, Point3, Vector3};

/// A body to draw.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its triangles.
    pub mesh: Mesh,
    /// Its colour: red, green, blue.
    pub colour: [u8; 3],
}

/// Where the camera stands: looking at the middle of everything, without perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Turn about the z axis, degrees.
    pub turn_deg: f64,
    /// Height above the horizon, degrees.
    pub rise_deg: f64,
}

/// A picture: width, height, and rows of red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Three bytes per pixel.
    pub pixels: Vec<u8>,
}

/// Samples per pixel, along each side.
const SAMPLES: usize = 2;
/// Rows of pixels that are drawn at a time: their samples fit in the processor's cache.
const BAND_ROWS: usize = 16;
/// Share of the picture that is left free around the bodies.
const MARGIN: f64 = 0.06;
const BACKGROUND: [f32; 3] = [250.0, 250.0, 248.0];
/// Depth of a sample that nothing covers.
const NOTHING: f32 = f32::NEG_INFINITY;
/// Step in depth, mm, at which an edge shows.
const EDGE_MM: f32 = 0.35;
/// Brightness of an edge.
const EDGE_SHADE: f32 = 0.35;

impl Picture {
    /// The picture as PNG.
    ///
    /// # Errors
    /// The encoder's error; memory does not fail.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::Balanced);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        Ok(bytes)
    }
}

/// Draws `bodies`, scaled to fill a picture of `width` by `height` pixels.
pub fn render(bodies: &[Body], view: View, width: u32, height: u32) -> Picture {
    let (columns, rows) = (width as usize * SAMPLES, height as usize * SAMPLES);
    let faces = visible_faces(bodies, view, columns, rows);
    let mut pixels = Vec::with_capacity(width as usize * height as usize * 3);
    let mut band = Band::new(columns);
    for first in (0..rows).step_by(BAND_ROWS * SAMPLES) {
        let last = (first + BAND_ROWS * SAMPLES).min(rows);
        // One row more than is shown: an edge is seen against the sample below.
        band.clear(first, (last + 1).min(rows));
        for (number, face) in faces.iter().enumerate() {
            band.fill(face, number);
        }
        band.shade(last - first, &faces, &mut pixels);
    }
    Picture { width, height, pixels }
}

/// A triangle that faces the camera, in samples of the picture, with its depth as a plane.
struct Face {
    /// Corners, across and down.
    corners: [[f64; 2]; 3],
    /// Rows between which it lies.
    rows: (f64, f64),
    /// Depth in mm at the picture's origin, and its slope across and down.
    depth: [f64; 3],
    colour: [f32; 3],
}

/// The triangles that face the camera, placed in the picture.
fn visible_faces(bodies: &[Body], view: View, columns: usize, rows: usize) -> Vec<Face> {
    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::z()), view.turn_deg.to_radians());
    let tilt =
        Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::x()), (view.rise_deg - 90.0).to_radians());
    let camera = tilt * turn;
    let seen: Vec<Vec<Point3>> =
        bodies.iter().map(|b| b.mesh.positions.iter().map(|p| camera * p).collect()).collect();
    let Some((low, high)) =
        seen.iter().flatten().map(|p| (*p, *p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
    else {
        return Vec::new();
    };
    let size = high - low;
    let room = 1.0 - 2.0 * MARGIN;
    let scale = (columns as f64 * room / size.x).min(rows as f64 * room / size.y);
    let middle = nalgebra::center(&low, &high);
    let place = |p: Point3| {
        let across = columns as f64 / 2.0 + (p.x - middle.x) * scale;
        Point3::new(across, rows as f64 / 2.0 - (p.y - middle.y) * scale, p.z)
    };
    let light = Vector3::new(0.35, 0.55, 0.85).normalize();
    let face = |positions: &[Point3], t: &[u32; 3], colour: [u8; 3]| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).filter(|n| n.z > 0.0)?;
        #[allow(clippy::cast_possible_truncation)]
        let brightness = (0.45 + 0.55 * normal.dot(&light).max(0.0)) as f32;
        Face::new([a, b, c].map(place), colour.map(|v| f32::from(v) * brightness))
    };
    let each = bodies.iter().zip(&seen);
    each.flat_map(|(body, positions)| {
        body.mesh.triangles.iter().filter_map(move |t| face(positions, t, body.colour))
    })
    .collect()
}

impl Face {
    /// `None` for a triangle that is seen edge on.
    fn new([a, b, c]: [Point3; 3], colour: [f32; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let area = ab.x * ac.y - ab.y * ac.x;
        if area == 0.0 {
            return None;
        }
        let across = (ab.z * ac.y - ac.z * ab.y) / area;
        let down = (ab.x * ac.z - ac.x * ab.z) / area;
        Some(Self {
            corners: [a, b, c].map(|p| [p.x, p.y]),
            rows: (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)),
            depth: [a.z - across * a.x - down * a.y, across, down],
            colour,
        })
    }

    /// Where a horizontal line at `y` enters and leaves the triangle; `None` if it misses it.
    fn span(&self, y: f64) -> Option<(f64, f64)> {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .filter(|(u, v)| (u[1] <= y) != (v[1] <= y))
            .map(|(u, v)| u[0] + (v[0] - u[0]) * (y - u[1]) / (v[1] - u[1]))
            .map(|x| (x, x))
            .reduce(|(low, high), (x, _)| (low.min(x), high.max(x)))
    }
}

/// Some rows of samples: the depth of each, and the number of the face that covers it.
struct Band {
    columns: usize,
    first_row: usize,
    rows: usize,
    depths: Vec<f32>,
    faces: Vec<u32>,
}

impl Band {
    fn new(columns: usize) -> Self {
        Self { columns, first_row: 0, rows: 0, depths: Vec::new(), faces: Vec::new() }
    }

    fn clear(&mut self, first_row: usize, end_row: usize) {
        (self.first_row, self.rows) = (first_row, end_row - first_row);
        self.depths.clear();
        self.depths.resize(self.rows * self.columns, NOTHING);
        self.faces.resize(self.rows * self.columns, 0);
    }

    /// Fills the samples whose middle lies in `face`; the nearer sample stays.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn fill(&mut self, face: &Face, number: usize) {
        let clamp = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        let top = self.first_row as f64 + 0.5;
        for row in
            clamp((face.rows.0 - top).ceil(), self.rows)..clamp((face.rows.1 - top).floor() + 1.0, self.rows)
        {
            let y = top + row as f64;
            let Some((left, right)) = face.span(y) else { continue };
            let (from, to) =
                (clamp((left - 0.5).ceil(), self.columns), clamp((right - 0.5).ceil(), self.columns));
            let start = row * self.columns;
            let depths = &mut self.depths[start + from..start + to.max(from)];
            let faces = &mut self.faces[start + from..start + to.max(from)];
            let [origin, across, down] = face.depth;
            let mut depth = origin + down * y + across * (from as f64 + 0.5);
            for (known, owner) in depths.iter_mut().zip(faces) {
                if depth as f32 > *known {
                    *known = depth as f32;
                    *owner = number as u32;
                }
                depth += across;
            }
        }
    }

    /// Appends the pixels of `rows` rows of samples: the mean of a pixel's samples, darkened at steps in depth.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn shade(&self, rows: usize, faces: &[Face], pixels: &mut Vec<u8>) {
        for row in (0..rows).step_by(SAMPLES) {
            for column in (0..self.columns).step_by(SAMPLES) {
                let mut sum = [0.0f32; 3];
                for sample in 0..SAMPLES * SAMPLES {
                    let i = (row + sample / SAMPLES) * self.columns + column + sample % SAMPLES;
                    let covered = self.depths[i] > NOTHING;
                    let colour = if covered { faces[self.faces[i] as usize].colour } else { BACKGROUND };
                    let shade = if self.is_edge(i) { EDGE_SHADE } else { 1.0 };
                    (0..3).for_each(|k| sum[k] += colour[k] * shade);
                }
                // Half is added and the rest cut off, which rounds: no colour is negative or above 255.
                pixels.extend(sum.map(|v| (v / (SAMPLES * SAMPLES) as f32 + 0.5) as u8));
            }
        }
    }

    /// Whether the sample to the right or below lies on another face: a jump in depth.
    fn is_edge(&self, i: usize) -> bool {
        let jump = |j: usize| {
            let (a, b) = (self.depths[i], self.depths[j]);
            a != b && ((a == NOTHING) != (b == NOTHING) || (a - b).abs() > EDGE_MM)
        };
        let right = !(i + 1).is_multiple_of(self.columns) && jump(i + 1);
        right || (i + self.columns < self.depths.len() && jump(i + self.columns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_body_hides_the_farther() {
        let square = |z: f64| {
            let at = |x: f64, y: f64| Point3::new(x, y, z);
            Mesh::new(
                vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
                vec![[0, 1, 2], [0, 2, 3]],
            )
        };
        let bodies = [
            Body { mesh: square(1.0), colour: [255, 0, 0] },
            Body { mesh: square(0.0), colour: [0, 255, 0] },
        ];
        let picture = render(&bodies, View { turn_deg: 0.0, rise_deg: 90.0 }, 33, 33);
        let middle = &picture.pixels[(16 * 33 + 16) * 3..][..3];
        assert!(middle[0] > 100 && middle[1] == 0, "{middle:?}");
        assert_eq!(&picture.pixels[..3], &[250, 250, 248]);
        assert!(picture.png().unwrap().starts_with(b"\x89PNG"));
    }
}
