//! Pictures of parts: a software renderer with a depth buffer and two by two samples per pixel.

mod picture;
mod raster;

use nalgebra::{Rotation3, Unit};

use crate::mesh::{Mesh, Point3, Vector3};
use raster::{BAND_SAMPLES, Band, by_band, visible_faces};

pub use picture::Picture;

/// A body to draw.
#[derive(Clone, Debug)]
pub struct Body {
    /// Mesh.
    pub mesh: Mesh,
    /// Colour: red, green, blue.
    pub colour: [u8; 3],
}

/// Direction of the camera, which looks at the centre of all bodies in parallel projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Angle about the z axis, degrees.
    pub turn_deg: f64,
    /// Elevation above the horizon, degrees.
    pub rise_deg: f64,
}

impl View {
    /// The rotation into the frame of the camera, which looks along -z.
    fn camera(self) -> Rotation3<f64> {
        let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::z()), self.turn_deg.to_radians());
        let rise = (self.rise_deg - 90.0).to_radians();
        Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::x()), rise) * turn
    }

    /// Returns the direction toward the camera, a unit vector.
    pub fn toward_camera(self) -> Vector3 {
        self.camera().inverse() * Vector3::z()
    }
}

/// Samples per pixel along each axis.
const SAMPLES: usize = 2;
/// Margin around the bodies as a share of the picture.
const MARGIN: f64 = 0.06;
/// Difference in depth, mm, above which an edge is drawn; for large scenes, in sizes of a sample, so
/// that oblique faces have none.
const EDGE_MM: f32 = 0.35;
const EDGE_SAMPLES: f64 = 2.5;
/// Size of a picture, and the columns at its sides that bodies leave free, all in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Width.
    pub width: u32,
    /// Height.
    pub height: u32,
    /// Width of the free column at the left.
    pub left: u32,
    /// Width of the free column at the right.
    pub right: u32,
}

/// A picture with the body of each pixel and the projection, from which annotations are placed.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The picture.
    pub picture: Picture,
    /// The projection.
    pub projection: Projection,
    /// Number of the body in each pixel, in rows; `None` for the background.
    pub bodies: Vec<Option<u16>>,
    /// Distance of each pixel's body toward the camera, mm; least for the background.
    depths_mm: Vec<f32>,
}

impl Rendering {
    /// Returns whether a body hides a point: it is nearer to the camera by more than `margin_mm`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn hides(&self, point: Point3, margin_mm: f64) -> bool {
        let [column, row] = self.projection.pixel(point);
        let (width, height) = (f64::from(self.picture.width), f64::from(self.picture.height));
        let is_inside = (0.0..width).contains(&column) && (0.0..height).contains(&row);
        let index = |column: f64, row: f64| row as usize * self.picture.width as usize + column as usize;
        is_inside
            && f64::from(self.depths_mm[index(column, row)]) > (self.projection.camera * point).z + margin_mm
    }
}

/// A parallel projection of space onto the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    camera: Rotation3<f64>,
    middle: Point3,
    /// Samples per mm.
    scale: f64,
    /// Column and row of the middle, in samples.
    centre: [f64; 2],
}

impl Projection {
    /// Returns the size of a sample, mm.
    fn sample_mm(&self) -> f64 {
        self.scale.recip()
    }

    /// Creates the projection in which the bodies and the points `also` fill a frame.
    pub fn new(bodies: &[Body], also: &[Point3], view: View, frame: Frame) -> Self {
        let camera = view.camera();
        let points = bodies.iter().flat_map(|b| &b.mesh.positions).chain(also).map(|p| camera * p);
        let (low, high) = points
            .map(|p| (p, p))
            .reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
            .unwrap_or((Point3::origin(), Point3::new(1.0, 1.0, 1.0)));
        let free = f64::from(frame.width.saturating_sub(frame.left + frame.right)) * SAMPLES as f64;
        let rows = f64::from(frame.height) * SAMPLES as f64;
        let (size, room) = (high - low, 1.0 - 2.0 * MARGIN);
        let scale = (free * room / size.x).min(rows * room / size.y);
        let centre = [f64::from(frame.left) * SAMPLES as f64 + free / 2.0, rows / 2.0];
        Self { camera, middle: nalgebra::center(&low, &high), scale, centre }
    }

    /// Returns the column and row of a point, in pixels from the upper left corner.
    pub fn pixel(&self, point: Point3) -> [f64; 2] {
        let placed = self.place(self.camera * point);
        [placed.x / SAMPLES as f64, placed.y / SAMPLES as f64]
    }

    /// Maps a point of the camera's frame to column, row and depth.
    fn place(&self, p: Point3) -> Point3 {
        let [column, row] = self.centre;
        Point3::new(
            column + (p.x - self.middle.x) * self.scale,
            row - (p.y - self.middle.y) * self.scale,
            p.z,
        )
    }
}

/// Draws `bodies`, scaled to fill a picture of `width` by `height` pixels.
///
/// ```
/// use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
/// use pinswitch_solid::render::{Body, View, render};
/// use pinswitch_solid::solid::Solid;
///
/// let disc = Solid::prism(&Contour::circle(Point2::origin(), 10.0), &[], 0.0, 3.0, 0.0)?;
/// let body = Body { mesh: disc.mesh(ChordTolerance::new(0.05)?)?, colour: [200, 120, 60] };
/// let picture = render(&[body], View { turn_deg: 30.0, rise_deg: 35.0 }, 80, 60);
/// assert_eq!(picture.pixels.len(), 80 * 60 * 3);
/// assert!(picture.png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(bodies: &[Body], view: View, width: u32, height: u32) -> Picture {
    render_in(bodies, &[], view, Frame { width, height, left: 0, right: 0 }).picture
}

/// Draws `bodies`, scaled so that they and the points `also` fill a frame.
pub fn render_in(bodies: &[Body], also: &[Point3], view: View, frame: Frame) -> Rendering {
    let Frame { width, height, .. } = frame;
    let (columns, rows) = (width as usize * SAMPLES, height as usize * SAMPLES);
    let projection = Projection::new(bodies, also, view, frame);
    let faces = visible_faces(bodies, &projection);
    let mut pixels = Vec::with_capacity(width as usize * height as usize * 3);
    let mut owners = Vec::with_capacity(width as usize * height as usize);
    let mut depths_mm = Vec::with_capacity(width as usize * height as usize);
    #[allow(clippy::cast_possible_truncation)]
    let mut band = Band::new(columns, EDGE_MM.max((EDGE_SAMPLES * projection.sample_mm()) as f32));
    for (number, faces_of_band) in by_band(&faces, rows).into_iter().enumerate() {
        let first = number * BAND_SAMPLES;
        let last = (first + BAND_SAMPLES).min(rows);
        // One more row than is shown: edges depend on the sample below.
        band.clear(first, (last + 1).min(rows));
        for face in faces_of_band {
            band.fill(&faces[face as usize], face);
        }
        band.shade(last - first, &faces, &mut pixels, &mut owners);
        band.depths(last - first, &mut depths_mm);
    }
    Rendering { picture: Picture { width, height, pixels }, projection, bodies: owners, depths_mm }
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
        let frame = Frame { width: 33, height: 33, left: 0, right: 0 };
        let rendering = render_in(&bodies, &[], View { turn_deg: 0.0, rise_deg: 90.0 }, frame);
        let is_hidden = [0.0, 0.9, 1.0, 2.0].map(|z| rendering.hides(Point3::new(0.0, 0.0, z), 0.05));
        assert_eq!(is_hidden, [true, true, false, false]);
        assert!(!rendering.hides(Point3::new(9.0, 0.0, 0.0), 0.05), "outside of the picture");
        assert!(picture.png().unwrap().starts_with(b"\x89PNG"));
    }

    fn corner(x: f64, y: f64) -> Mesh {
        let at = |dx: f64, dy: f64| Point3::new(x + dx, y + dy, 0.0);
        Mesh::new(vec![at(0.0, 0.0), at(4.0, 0.0), at(0.0, 4.0)], vec![[0, 1, 2]])
    }

    /// The body of each pixel, and the pixel of each point, agree with the picture.
    #[test]
    fn projection_and_bodies_match_the_picture() {
        let bodies = [
            Body { mesh: corner(0.0, 0.0), colour: [255, 0, 0] },
            Body { mesh: corner(6.0, 2.0), colour: [0, 0, 255] },
        ];
        let frame = Frame { width: 120, height: 60, left: 40, right: 10 };
        let view = View { turn_deg: 0.0, rise_deg: 90.0 };
        let Rendering { picture, projection, bodies: owners, .. } = render_in(&bodies, &[], view, frame);
        for (number, [x, y]) in [(0, [1.0, 1.0]), (1, [7.0, 3.0])] {
            let [column, row] = projection.pixel(Point3::new(x, y, 0.0)).map(|v| v as usize);
            assert_eq!(owners[row * 120 + column], Some(number));
            let channel = if number == 0 { 0 } else { 2 };
            assert!(picture.pixels[(row * 120 + column) * 3 + channel] > 100);
        }
        // Nothing is in the columns at the sides.
        let free = |column: usize| (0..60).all(|row| owners[row * 120 + column].is_none());
        assert!((0..40).chain(110..120).all(free));
    }
}
