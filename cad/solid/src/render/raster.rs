//! Faces in samples of a picture: which is nearest at each sample, and the colours of the pixels.

use super::{Body, Projection, SAMPLES};
use crate::mesh::{Point3, Vector3};

/// Rows of samples per band, which fits in the processor's cache.
pub(super) const BAND_SAMPLES: usize = 16 * SAMPLES;
// [`Band::whole_face`] names each sample of a pixel.
const _: () = assert!(SAMPLES == 2);
/// Share of a sample in its pixel.
const SAMPLE_SHARE: f32 = 1.0 / (SAMPLES * SAMPLES) as f32;
const BACKGROUND: [f32; 3] = [250.0, 250.0, 248.0];
/// Depth of a background sample.
const NOTHING: f32 = f32::NEG_INFINITY;
/// Brightness of an edge relative to its face.
const EDGE_SHADE: f32 = 0.35;

/// A triangle that faces the camera, in sample coordinates, with its depth as a plane.
pub(super) struct Face {
    /// Corners from the highest to the lowest, as column and row.
    corners: [[f64; 2]; 3],
    /// Change in column per row of the sides: highest to lowest corner, highest to middle, middle
    /// to lowest.
    slopes: [f64; 3],
    /// Depth in mm at the origin of the picture, and its slopes per column and row.
    depth: [f64; 3],
    colour: [f32; 3],
    /// Colour of a pixel whose samples are all of this face.
    bytes: [u8; 3],
    /// Number of the body.
    body: u16,
}

/// The triangles that face the camera, placed in the picture.
pub(super) fn visible_faces(bodies: &[Body], projection: &Projection) -> Vec<Face> {
    let seen: Vec<Vec<Point3>> =
        bodies.iter().map(|b| b.mesh.positions.iter().map(|p| projection.camera * p).collect()).collect();
    let light = Vector3::new(0.35, 0.55, 0.85).normalize();
    let face = |positions: &[Point3], t: &[u32; 3], colour: [u8; 3], body: u16| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let normal = Some((b - a).cross(&(c - a))).filter(|n| n.z > 0.0)?.try_normalize(0.0)?;
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
pub(super) fn by_band(faces: &[Face], rows: usize) -> Vec<Vec<u32>> {
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
            bytes: colour.map(|value| to_byte((0..SAMPLES * SAMPLES).map(|_| value * SAMPLE_SHARE).sum())),
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
pub(super) struct Band {
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
    pub(super) fn new(columns: usize, edge_mm: f32) -> Self {
        let (depths, faces, touched) = (Vec::new(), Vec::new(), Vec::new());
        Self { columns, edge_mm, first_row: 0, rows: 0, depths, faces, touched }
    }

    pub(super) fn clear(&mut self, first_row: usize, end_row: usize) {
        (self.first_row, self.rows) = (first_row, end_row - first_row);
        self.depths.clear();
        self.depths.resize(self.rows * self.columns, NOTHING);
        self.faces.resize(self.rows * self.columns, 0);
        self.touched.clear();
        self.touched.resize(self.rows, (self.columns, 0));
    }

    /// Draws the samples whose centre is in `face` and that are nearer than the present ones.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn fill(&mut self, face: &Face, number: u32) {
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
    pub(super) fn shade(
        &self,
        rows: usize,
        faces: &[Face],
        pixels: &mut Vec<u8>,
        owners: &mut Vec<Option<u16>>,
    ) {
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
                if let Some(face) = self.whole_face(row, column, &lines) {
                    pixels.extend(faces[face as usize].bytes);
                    owners.push(Some(faces[face as usize].body));
                    continue;
                }
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
    pub(super) fn depths(&self, rows: usize, depths_mm: &mut Vec<f32>) {
        for row in (0..rows).step_by(SAMPLES) {
            depths_mm.extend(self.depths[row * self.columns..][..self.columns].iter().step_by(SAMPLES));
        }
    }

    /// The face that has all samples of the pixel with its first sample in this row and column, if no edge crosses it. Its
    /// colour is then that of [`Self::pixel`], in a fraction of the time.
    #[inline(always)]
    fn whole_face(&self, row: usize, column: usize, lines: &[&[f32]; SAMPLES + 1]) -> Option<u32> {
        let faces =
            |i: usize| self.faces.get((row + i) * self.columns + column..).and_then(|f| f.first_chunk::<2>());
        let ([a, b], [c, d]) = (*faces(0)?, *faces(1)?);
        if a != b || a != c || a != d {
            return None;
        }
        let depths = |i: usize| lines[i].get(column..).and_then(|line| line.first_chunk::<3>());
        let ([p, q, right], [r, s, lower_right], [below, below_right, _]) =
            (*depths(0)?, *depths(1)?, *depths(2)?);
        // The difference of background and a body is infinite, and that of background and background no number.
        let is_flat = |a: f32, b: f32| (a - b).abs() <= self.edge_mm;
        let inside = is_flat(p, q) && is_flat(p, r) && is_flat(q, s) && is_flat(r, s);
        let around =
            is_flat(q, right) && is_flat(s, lower_right) && is_flat(r, below) && is_flat(s, below_right);
        (inside && around).then_some(a)
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
            let share = if is_edge { EDGE_SHADE } else { 1.0 } * SAMPLE_SHARE;
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
    use crate::mesh::Mesh;
    use crate::render::{Frame, View};

    /// Where one face has all samples of a pixel, its colour is the mean of the samples.
    #[test]
    fn pixels_of_one_face_have_the_mean_of_their_samples() {
        let at = Point3::new;
        let tilted = |z: f64| vec![at(-2.0, -1.0, z), at(3.0, -1.5, 0.3 * z), at(0.4, 2.0, 2.0 * z)];
        let body = |z: f64, colour| Body { mesh: Mesh::new(tilted(z), vec![[0, 1, 2]]), colour };
        let bodies = [body(0.0, [201, 99, 34]), body(0.8, [13, 77, 250])];
        let frame = Frame { width: 40, height: 30, left: 0, right: 0 };
        let projection = Projection::new(&bodies, &[], View { turn_deg: 20.0, rise_deg: 60.0 }, frame);
        let faces = visible_faces(&bodies, &projection);
        let (columns, rows) = (40 * SAMPLES, 30 * SAMPLES);
        let mut band = Band::new(columns, 0.05);
        band.clear(0, rows);
        (0u32..).zip(&faces).for_each(|(number, face)| band.fill(face, number));
        let (mut whole, mut mixed) = (0, 0);
        for row in (0..rows - SAMPLES).step_by(SAMPLES) {
            let lines = std::array::from_fn(|i| &band.depths[(row + i) * columns..(row + i + 1) * columns]);
            for column in (0..columns).step_by(SAMPLES) {
                let mean = band.pixel(row, column, &lines, &faces).map(to_byte);
                match band.whole_face(row, column, &lines) {
                    Some(face) => {
                        assert_eq!(faces[face as usize].bytes, mean, "{row} {column}");
                        whole += 1;
                    }
                    None => mixed += 1,
                }
            }
        }
        assert!(whole > 100 && mixed > 100, "{whole} {mixed}");
    }
}
