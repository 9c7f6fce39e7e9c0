//! Pictures of parts: a small software renderer with a depth buffer, four samples per pixel side by side.

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
const SAMPLES: usize = 3;
/// Share of the picture that is left free around the bodies.
const MARGIN: f64 = 0.06;
const BACKGROUND: [f64; 3] = [250.0, 250.0, 248.0];

impl Picture {
    /// The picture as PNG.
    ///
    /// # Errors
    /// The encoder's complaint.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        Ok(bytes)
    }
}

/// Draws `bodies`, scaled to fill a picture of `width` by `height` pixels.
pub fn render(bodies: &[Body], view: View, width: u32, height: u32) -> Picture {
    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::z()), view.turn_deg.to_radians());
    let tilt =
        Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::x()), (view.rise_deg - 90.0).to_radians());
    let camera = tilt * turn;
    let (columns, rows) = (width as usize * SAMPLES, height as usize * SAMPLES);
    let mut canvas = Canvas::new(columns, rows);
    let seen = || bodies.iter().flat_map(|b| b.mesh.positions.iter().map(|p| camera * p));
    let Some((low, high)) = seen().map(|p| (p, p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d))) else {
        return canvas.picture(width, height);
    };
    let size = high - low;
    let room = 1.0 - 2.0 * MARGIN;
    let scale = (columns as f64 * room / size.x).min(rows as f64 * room / size.y);
    let middle = nalgebra::center(&low, &high);
    let place = |p: Point3| {
        let p = camera * p;
        Point3::new(
            columns as f64 / 2.0 + (p.x - middle.x) * scale,
            rows as f64 / 2.0 - (p.y - middle.y) * scale,
            p.z,
        )
    };
    let light = Vector3::new(0.35, 0.55, 0.85).normalize();
    for body in bodies {
        for corners in body.mesh.facets() {
            let [a, b, c] = corners;
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { continue };
            let normal = camera * normal;
            if normal.z <= 0.0 {
                continue;
            }
            let brightness = 0.45 + 0.55 * normal.dot(&light).max(0.0);
            canvas.fill(corners.map(place), body.colour.map(|v| f64::from(v) * brightness));
        }
    }
    canvas.picture(width, height)
}

/// Samples with their depth.
struct Canvas {
    columns: usize,
    rows: usize,
    colours: Vec<[f64; 3]>,
    depths: Vec<f64>,
}

impl Canvas {
    fn new(columns: usize, rows: usize) -> Self {
        let count = columns * rows;
        Self { columns, rows, colours: vec![BACKGROUND; count], depths: vec![f64::NEG_INFINITY; count] }
    }

    /// Fills a triangle in canvas coordinates; the nearer sample stays.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn fill(&mut self, [a, b, c]: [Point3; 3], colour: [f64; 3]) {
        let area = (b - a).xy().perp(&(c - a).xy());
        if area == 0.0 {
            return;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let clamp = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        for row in clamp(low.y.floor(), self.rows)..clamp(high.y.ceil() + 1.0, self.rows) {
            for column in clamp(low.x.floor(), self.columns)..clamp(high.x.ceil() + 1.0, self.columns) {
                let p = nalgebra::Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                let weight = |u: Point3, v: Point3| (v - u).xy().perp(&(p - u.coords.xy())) / area;
                let (wa, wb, wc) = (weight(b, c), weight(c, a), weight(a, b));
                let depth = wa * a.z + wb * b.z + wc * c.z;
                let i = row * self.columns + column;
                if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && depth > self.depths[i] {
                    self.depths[i] = depth;
                    self.colours[i] = colour;
                }
            }
        }
    }

    /// Darkens samples at steps in depth, so that edges show, and averages the samples of each pixel.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn picture(&self, width: u32, height: u32) -> Picture {
        let mut pixels = Vec::with_capacity(width as usize * height as usize * 3);
        for row in 0..height as usize {
            for column in 0..width as usize {
                let mut sum = [0.0; 3];
                for s in 0..SAMPLES * SAMPLES {
                    let i = (row * SAMPLES + s / SAMPLES) * self.columns + column * SAMPLES + s % SAMPLES;
                    let shade = if self.is_edge(i) { 0.35 } else { 1.0 };
                    (0..3).for_each(|k| sum[k] += self.colours[i][k] * shade);
                }
                pixels.extend(sum.map(|v| (v / (SAMPLES * SAMPLES) as f64).round().clamp(0.0, 255.0) as u8));
            }
        }
        Picture { width, height, pixels }
    }

    /// Whether the sample to the right or below lies on another face: a jump in depth or in colour.
    fn is_edge(&self, i: usize) -> bool {
        let jump = |j: usize| {
            let (a, b) = (self.depths[i], self.depths[j]);
            (a.is_finite() != b.is_finite()) || (a - b).abs() > 0.35
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
