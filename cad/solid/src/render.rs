//! Pictures of parts: a software renderer with a depth buffer and two by two samples per pixel.

use nalgebra::{Rotation3, Unit};

use crate::mesh::{Mesh, Point3, Vector3};

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

/// Samples per pixel along each axis.
const SAMPLES: usize = 2;
/// Rows of samples per band, which fits in the processor's cache.
const BAND_SAMPLES: usize = 16 * SAMPLES;
/// Margin around the bodies as a share of the picture.
const MARGIN: f64 = 0.06;
const BACKGROUND: [f32; 3] = [250.0, 250.0, 248.0];
/// Depth of a background sample.
const NOTHING: f32 = f32::NEG_INFINITY;
/// Difference in depth, mm, above which an edge is drawn; for large scenes, in sizes of a sample, so
/// that oblique faces have none.
const EDGE_MM: f32 = 0.35;
const EDGE_SAMPLES: f64 = 2.5;
/// Brightness of an edge relative to its face.
const EDGE_SHADE: f32 = 0.35;

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

/// Bits per channel of the colours that a palette distinguishes: steps of 4 of 255 are invisible.
const PALETTE_BITS: u32 = 6;
/// Most colours of a palette.
const PALETTE: usize = 256;

impl Picture {
    /// Returns the picture as PNG with a palette of at most 256 colours, the most frequent ones. It is a third as large as
    /// that of [`Self::png`].
    ///
    /// # Errors
    /// As [`Self::png`].
    pub fn indexed_png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let (palette, indices) = self.indexed();
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette.concat());
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::NoFilter);
        encoder.write_header()?.write_image_data(&indices)?;
        Ok(bytes)
    }

    /// Returns a palette, and the index of each pixel in it.
    fn indexed(&self) -> (Vec<[u8; 3]>, Vec<u8>) {
        let bin = |rgb: &[u8]| {
            rgb.iter().fold(0, |bin, v| bin << PALETTE_BITS | usize::from(v >> (8 - PALETTE_BITS)))
        };
        let mut counts = vec![0u32; 1 << (3 * PALETTE_BITS)];
        let mut first = vec![[0u8; 3]; counts.len()];
        for rgb in self.pixels.chunks_exact(3) {
            let bin = bin(rgb);
            if counts[bin] == 0 {
                first[bin] = [rgb[0], rgb[1], rgb[2]];
            }
            counts[bin] += 1;
        }
        let mut used: Vec<usize> = (0..counts.len()).filter(|bin| counts[*bin] > 0).collect();
        used.sort_by_key(|bin| (std::cmp::Reverse(counts[*bin]), *bin));
        let palette: Vec<[u8; 3]> = used.iter().take(PALETTE).map(|bin| first[*bin]).collect();
        let nearest = |colour: [u8; 3]| {
            let off =
                |p: &[u8; 3]| -> u32 { (0..3).map(|k| u32::from(p[k].abs_diff(colour[k])).pow(2)).sum() };
            palette.iter().enumerate().min_by_key(|(_, p)| off(p)).map_or(0, |(i, _)| i)
        };
        let mut index_of_bin = vec![0u8; counts.len()];
        for (rank, bin) in used.into_iter().enumerate() {
            let index = if rank < palette.len() { rank } else { nearest(first[bin]) };
            index_of_bin[bin] = u8::try_from(index).unwrap_or(0);
        }
        let indices = self.pixels.chunks_exact(3).map(|rgb| index_of_bin[bin(rgb)]).collect();
        (palette, indices)
    }

    /// Returns the picture as PNG.
    ///
    /// # Errors
    /// That of the encoder; writing to memory does not fail.
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

/// A triangle that faces the camera, in sample coordinates, with its depth as a plane.
struct Face {
    /// Corners from the highest to the lowest, as column and row.
    corners: [[f64; 2]; 3],
    /// Change in column per row of the sides: highest to lowest corner, highest to middle, middle
    /// to lowest.
    slopes: [f64; 3],
    /// Depth in mm at the origin of the picture, and its slopes per column and row.
    depth: [f64; 3],
    colour: [f32; 3],
    /// Number of the body.
    body: u16,
}

/// The triangles that face the camera, placed in the picture.
fn visible_faces(bodies: &[Body], projection: &Projection) -> Vec<Face> {
    let seen: Vec<Vec<Point3>> =
        bodies.iter().map(|b| b.mesh.positions.iter().map(|p| projection.camera * p).collect()).collect();
    let light = Vector3::new(0.35, 0.55, 0.85).normalize();
    let face = |positions: &[Point3], t: &[u32; 3], colour: [u8; 3], body: u16| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).filter(|n| n.z > 0.0)?;
        #[allow(clippy::cast_possible_truncation)]
        let brightness = (0.45 + 0.55 * normal.dot(&light).max(0.0)) as f32;
        Face::new([a, b, c].map(|p| projection.place(p)), colour.map(|v| f32::from(v) * brightness), body)
    };
    let each = (0..=u16::MAX).zip(bodies.iter().zip(&seen));
    let triangles: usize = bodies.iter().map(|body| body.mesh.triangles.len()).sum();
    // About half of the triangles of closed bodies face the camera.
    let mut faces = Vec::with_capacity(triangles / 2);
    for (number, (body, positions)) in each {
        faces.extend(body.mesh.triangles.iter().filter_map(|t| face(positions, t, body.colour, number)));
    }
    faces
}

/// Indices of the faces in each band of rows, ascending.
#[allow(clippy::cast_possible_truncation)]
fn by_band(faces: &[Face], rows: usize) -> Vec<Vec<u32>> {
    let mut bands = vec![Vec::new(); rows.div_ceil(BAND_SAMPLES)];
    for (number, face) in (0u32..).zip(faces) {
        // The first row of a band is also the last of the band above.
        let (highest, lowest) = face.rows();
        let first = first_from(highest - 1.0, rows).saturating_sub(1) / BAND_SAMPLES;
        let last = first_from(lowest, rows) / BAND_SAMPLES;
        for band in bands.iter_mut().take(last + 1).skip(first) {
            band.push(number);
        }
    }
    bands
}

impl Face {
    /// Creates a face; `None` for a triangle seen edge-on, or between the rows or columns of samples.
    fn new([a, b, c]: [Point3; 3], colour: [f32; 3], body: u16) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let area = ab.x * ac.y - ab.y * ac.x;
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let has_sample = |k: usize| libm::ceil(low[k] - 0.5) < high[k] - 0.5;
        if area == 0.0 || !has_sample(0) || !has_sample(1) {
            return None;
        }
        let across = (ab.z * ac.y - ac.z * ab.y) / area;
        let down = (ab.x * ac.z - ac.x * ab.z) / area;
        let mut corners = [a, b, c].map(|p| [p.x, p.y]);
        corners.sort_by(|p, q| p[1].total_cmp(&q[1]));
        let [top, middle, bottom] = corners;
        // No row intersects a side along a row.
        let slope = |p: [f64; 2], q: [f64; 2]| if q[1] > p[1] { (q[0] - p[0]) / (q[1] - p[1]) } else { 0.0 };
        Some(Self {
            corners,
            slopes: [slope(top, bottom), slope(top, middle), slope(middle, bottom)],
            depth: [a.z - across * a.x - down * a.y, across, down],
            colour,
            body,
        })
    }

    /// Rows of the highest and the lowest corner.
    const fn rows(&self) -> (f64, f64) {
        (self.corners[0][1], self.corners[2][1])
    }

    /// Columns where a horizontal line at `y`, between the highest and lowest corner, enters and
    /// leaves the triangle. Faces that share a side agree, because a side is always followed from
    /// its higher end.
    fn span(&self, y: f64) -> (f64, f64) {
        let [top, middle, _] = self.corners;
        let long = top[0] + self.slopes[0] * (y - top[1]);
        let short = if y < middle[1] {
            top[0] + self.slopes[1] * (y - top[1])
        } else {
            middle[0] + self.slopes[2] * (y - middle[1])
        };
        (long.min(short), long.max(short))
    }
}

/// A band of rows: the depth of each sample, and the index of its face.
struct Band {
    columns: usize,
    edge_mm: f32,
    first_row: usize,
    rows: usize,
    depths: Vec<f32>,
    faces: Vec<u32>,
    /// First column of each row with a face, and the one after the last.
    touched: Vec<(usize, usize)>,
}

impl Band {
    fn new(columns: usize, edge_mm: f32) -> Self {
        let (depths, faces, touched) = (Vec::new(), Vec::new(), Vec::new());
        Self { columns, edge_mm, first_row: 0, rows: 0, depths, faces, touched }
    }

    fn clear(&mut self, first_row: usize, end_row: usize) {
        (self.first_row, self.rows) = (first_row, end_row - first_row);
        self.depths.clear();
        self.depths.resize(self.rows * self.columns, NOTHING);
        self.faces.resize(self.rows * self.columns, 0);
        self.touched.clear();
        self.touched.resize(self.rows, (self.columns, 0));
    }

    /// Draws the samples whose centre is in `face` and that are nearer than the present ones.
    #[allow(clippy::cast_possible_truncation)]
    fn fill(&mut self, face: &Face, number: u32) {
        let top = self.first_row as f64 + 0.5;
        let (highest, lowest) = face.rows();
        for row in first_from(highest - top, self.rows)..first_from(lowest - top, self.rows) {
            let y = top + row as f64;
            let (left, right) = face.span(y);
            let (from, to) = (first_from(left - 0.5, self.columns), first_from(right - 0.5, self.columns));
            if from >= to {
                continue;
            }
            let touched = &mut self.touched[row];
            *touched = (touched.0.min(from), touched.1.max(to));
            let start = row * self.columns;
            let depths = &mut self.depths[start + from..start + to];
            let faces = &mut self.faces[start + from..start + to];
            let [origin, across, down] = face.depth;
            let mut depth = origin + down * y + across * (from as f64 + 0.5);
            for (known, owner) in depths.iter_mut().zip(faces) {
                if depth as f32 > *known {
                    *known = depth as f32;
                    *owner = number;
                }
                depth += across;
            }
        }
    }

    /// Appends the pixels of `rows` rows of samples: the means of their samples, darker at steps in
    /// depth, and the body of the first sample.
    fn shade(&self, rows: usize, faces: &[Face], pixels: &mut Vec<u8>, owners: &mut Vec<Option<u16>>) {
        for row in (0..rows).step_by(SAMPLES) {
            let lines: [&[f32]; SAMPLES + 1] = std::array::from_fn(|i| {
                // The last row has none below it, and no edge.
                let i = (row + i).min(self.rows - 1);
                &self.depths[i * self.columns..(i + 1) * self.columns]
            });
            let touched = &self.touched[row..(row + SAMPLES + 1).min(self.rows)];
            let (from, to) = touched.iter().fold((self.columns, 0), |(a, b), (c, d)| (a.min(*c), b.max(*d)));
            // A pixel depends on one more column than it has.
            let from = (from.saturating_sub(SAMPLES) / SAMPLES * SAMPLES).min(self.columns);
            let to = to.next_multiple_of(SAMPLES).min(self.columns).max(from);
            add_background(from / SAMPLES, pixels, owners);
            for column in (from..to).step_by(SAMPLES) {
                // One more column than the pixel has, except for the last.
                let seen = column..(column + SAMPLES + 1).min(self.columns);
                if lines.iter().all(|line| line[seen.clone()].iter().all(|depth| *depth == NOTHING)) {
                    pixels.extend(BACKGROUND.map(to_byte));
                    owners.push(None);
                } else {
                    let face = self.faces[row * self.columns + column] as usize;
                    owners.push((lines[0][column] != NOTHING).then(|| faces[face].body));
                    pixels.extend(self.pixel(row, column, &lines, faces).map(to_byte));
                }
            }
            add_background((self.columns - to) / SAMPLES, pixels, owners);
        }
    }

    /// Appends the depths of the first samples of the pixels of `rows` rows of samples.
    fn depths(&self, rows: usize, depths_mm: &mut Vec<f32>) {
        for row in (0..rows).step_by(SAMPLES) {
            depths_mm.extend(self.depths[row * self.columns..][..self.columns].iter().step_by(SAMPLES));
        }
    }

    /// The colour of the pixel with its first sample in this row and column.
    fn pixel(&self, row: usize, column: usize, lines: &[&[f32]; SAMPLES + 1], faces: &[Face]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (i, j) in (0..SAMPLES * SAMPLES).map(|sample| (sample / SAMPLES, column + sample % SAMPLES)) {
            let depth = lines[i][j];
            let colour = if depth == NOTHING {
                BACKGROUND
            } else {
                faces[self.faces[(row + i) * self.columns + j] as usize].colour
            };
            let right = lines[i].get(j + 1).copied().unwrap_or(depth);
            let is_edge =
                is_step(depth, right, self.edge_mm) || is_step(depth, lines[i + 1][j], self.edge_mm);
            let share = if is_edge { EDGE_SHADE } else { 1.0 } / (SAMPLES * SAMPLES) as f32;
            (0..3).for_each(|k| sum[k] += colour[k] * share);
        }
        sum
    }
}

/// Appends pixels of the background.
fn add_background(count: usize, pixels: &mut Vec<u8>, owners: &mut Vec<Option<u16>>) {
    pixels.extend(std::iter::repeat_n(BACKGROUND.map(to_byte), count).flatten());
    owners.resize(owners.len() + count, None);
}

/// Whether there is an edge between samples of these depths: one is background, or they differ by
/// more than `edge_mm`.
fn is_step(a: f32, b: f32, edge_mm: f32) -> bool {
    a != b && ((a == NOTHING) != (b == NOTHING) || (a - b).abs() > edge_mm)
}

/// Rounds a colour between 0 and 255.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn to_byte(value: f32) -> u8 {
    (value + 0.5) as u8
}

/// The least integer from `x` on, within 0 and `most`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn first_from(x: f64, most: usize) -> usize {
    // The cast truncates, and turns negative numbers into zero.
    let floor = x as usize;
    (floor + usize::from((floor as f64) < x)).min(most)
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

    #[test]
    fn palettes_keep_the_frequent_colours() {
        let body = |colour| Body { mesh: corner(0.0, 0.0), colour };
        let picture = render(&[body([200, 90, 30])], View { turn_deg: 0.0, rise_deg: 90.0 }, 64, 48);
        let (palette, indices) = picture.indexed();
        assert!(palette.len() > 2 && palette.len() <= 256);
        for (rgb, index) in picture.pixels.chunks_exact(3).zip(indices) {
            let off = (0..3).map(|k| rgb[k].abs_diff(palette[usize::from(index)][k])).max().unwrap();
            assert!(off < 4, "{rgb:?} for {:?}", palette[usize::from(index)]);
        }
        assert!(picture.indexed_png().unwrap().len() < picture.png().unwrap().len());
    }
}
