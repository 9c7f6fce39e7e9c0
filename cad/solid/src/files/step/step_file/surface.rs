//! Surfaces of faces and edges of loops, and the integral over a face that gives the volume.

use super::entity::{StepError, Vec3};

/// Largest distance, mm, between coordinates that must agree.
pub(super) const SAME_MM: f64 = 1e-7;
/// Largest difference, rad, between angles that must agree.
const SAME_RAD: f64 = 1e-9;
/// Smallest vertical component of the unit normal of a horizontal plane.
const HORIZONTAL: f64 = 1.0 - 1e-12;

/// A frame: its origin, mm, and the directions of its x and z axes.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) origin: Vec3,
    pub(super) x: Vec3,
    pub(super) z: Vec3,
}

/// An edge in the direction of its loop.
#[derive(Clone, Copy)]
pub(super) struct LoopEdge {
    /// Number of the edge in the file.
    pub(super) edge: u64,
    /// Numbers of its first and last vertex.
    pub(super) vertices: [u64; 2],
    pub(super) ends: [Vec3; 2],
    pub(super) arc: Option<LoopArc>,
}

/// The arc of an edge: centre and radius, mm, first angle and signed angle about +z, rad.
#[derive(Clone, Copy)]
pub(super) struct LoopArc {
    pub(super) centre: Vec3,
    pub(super) radius: f64,
    pub(super) start: f64,
    pub(super) sweep: f64,
}

/// The surface of a face.
pub(super) enum Surface {
    Plane(Frame),
    /// Frame and radius, mm.
    Cylinder(Frame, f64),
    /// Frame, radius at its origin, mm, and half of the apex angle, rad.
    Cone(Frame, f64, f64),
    Spline(Box<Spline>),
}

/// A rational B-spline surface, with poles and weights of equal shape and as many knots as they need.
pub(super) struct Spline {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    poles: Vec<Vec<Vec3>>,
    weights: Vec<Vec<f64>>,
}

/// Returns the integral of `z n_z` over a face, mm³, with `n` its outward normal. The sum over all
/// faces is the volume of the solid.
///
/// Checks that the loops are on the surface and run counter-clockwise about the outward normal,
/// holes clockwise.
pub(super) fn face_integral(
    surface: &Surface,
    sense: f64,
    bounds: &[Vec<LoopEdge>],
) -> Result<f64, StepError> {
    let outline = bounds.first().ok_or("the face has no bounds")?;
    if bounds.iter().any(Vec::is_empty) {
        return Err("a loop has no edges".into());
    }
    let samples = |edge: &LoopEdge| (0..5).map(|k| edge.point(f64::from(k) / 4.0)).collect::<Vec<_>>();
    let mut points = bounds.iter().flatten().flat_map(samples);
    if let Some(off) = points.find(|p| !surface.contains(*p)) {
        return Err(format!("an edge at {off:?} leaves the surface").into());
    }
    for (i, edges) in bounds.iter().enumerate() {
        let polygon: Vec<Vec3> =
            edges.iter().flat_map(|e| (0..8).map(|k| e.point(f64::from(k) / 8.0))).collect();
        let turn = dot(area_vector(&polygon), surface.normal(outline)) * sense;
        if (turn > 0.0) != (i == 0) {
            return Err("a loop runs against the outward normal".into());
        }
    }
    match surface {
        // The axis is vertical, so that the normal is horizontal.
        Surface::Cylinder(..) => Ok(0.0),
        Surface::Plane(frame) if frame.z[2].abs() > HORIZONTAL => {
            Ok(frame.origin[2] * bounds.iter().flatten().map(LoopEdge::swept).sum::<f64>())
        }
        Surface::Plane(_) => bounds.iter().map(|edges| polygon_integral(edges)).sum(),
        Surface::Cone(..) => cone_integral(outline),
        Surface::Spline(spline) => spline.check_boundary(outline).map(|()| sense * spline.integral()),
    }
}

/// Returns the integral over a plane polygon, in triangles from its first corner.
fn polygon_integral(edges: &[LoopEdge]) -> Result<f64, StepError> {
    if edges.iter().any(|e| e.arc.is_some()) {
        return Err("an arc in a slanted plane is not supported".into());
    }
    let first = edges[0].ends[0];
    let triangle = |e: &LoopEdge| {
        let [p, q] = e.ends;
        cross(minus(p, first), minus(q, first))[2] / 2.0 * (first[2] + p[2] + q[2]) / 3.0
    };
    Ok(edges.iter().map(triangle).sum())
}

/// Returns the integral over a cone between two arcs: `-sweep ∫ z r dr`, whose integrand has degree
/// two, so that Simpson's rule is exact.
fn cone_integral(outline: &[LoopEdge]) -> Result<f64, StepError> {
    let arcs: Vec<LoopArc> = outline.iter().filter_map(|e| e.arc).collect();
    let [a, b] = arcs[..] else { return Err("a cone without two arcs is not supported".into()) };
    let (lower, upper) = if a.centre[2] < b.centre[2] { (a, b) } else { (b, a) };
    if (lower.sweep + upper.sweep).abs() > SAME_RAD {
        return Err("the arcs of a cone have different angles".into());
    }
    let at = |share: f64| {
        let mix = |x: f64, y: f64| x + (y - x) * share;
        mix(lower.centre[2], upper.centre[2]) * mix(lower.radius, upper.radius)
    };
    let mean = (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
    Ok(-lower.sweep * (upper.radius - lower.radius) * mean)
}

impl LoopEdge {
    /// Returns the point at a share of the edge, from 0 to 1.
    fn point(&self, share: f64) -> Vec3 {
        match &self.arc {
            Some(arc) => {
                let angle = arc.start + arc.sweep * share;
                let [x, y, z] = arc.centre;
                [x + arc.radius * angle.cos(), y + arc.radius * angle.sin(), z]
            }
            None => std::array::from_fn(|i| self.ends[0][i] + (self.ends[1][i] - self.ends[0][i]) * share),
        }
    }

    /// Returns half of the integral of `x dy - y dx` along the edge, mm².
    fn swept(&self) -> f64 {
        let [p, q] = self.ends;
        let bulge = self.arc.map_or(0.0, |a| a.radius.powi(2) * (a.sweep - a.sweep.sin()));
        (p[0] * q[1] - q[0] * p[1] + bulge) / 2.0
    }

    /// Returns the distance of a point from the line or circle of the edge, mm.
    fn distance(&self, p: Vec3) -> f64 {
        match &self.arc {
            Some(arc) => {
                let from = minus(p, arc.centre);
                f64::hypot(f64::hypot(from[0], from[1]) - arc.radius, from[2])
            }
            None => {
                let along = minus(self.ends[1], self.ends[0]);
                norm(cross(minus(p, self.ends[0]), along)) / norm(along)
            }
        }
    }
}

impl Surface {
    /// Returns whether a point is on the surface. [`Spline::check_boundary`] compares a spline with
    /// its loop instead.
    fn contains(&self, p: Vec3) -> bool {
        let off = match self {
            Self::Plane(frame) => dot(minus(p, frame.origin), frame.z),
            Self::Cylinder(frame, radius) => frame.radial(p).1 - radius,
            Self::Cone(frame, radius, half_angle) => {
                let along = dot(minus(p, frame.origin), frame.z);
                (frame.radial(p).1 - radius - along * half_angle.tan()) * half_angle.cos()
            }
            Self::Spline(_) => 0.0,
        };
        off.abs() <= SAME_MM
    }

    /// Returns the normal of the surface in the middle of the first arc of a loop with edges.
    fn normal(&self, outline: &[LoopEdge]) -> Vec3 {
        let middle = outline.iter().find(|e| e.arc.is_some()).unwrap_or(&outline[0]).point(0.5);
        match self {
            Self::Plane(frame) => frame.z,
            Self::Cylinder(frame, _) => frame.radial(middle).0,
            Self::Cone(frame, _, half_angle) => {
                let radial = frame.radial(middle).0;
                std::array::from_fn(|i| radial[i] * half_angle.cos() - frame.z[i] * half_angle.sin())
            }
            Self::Spline(spline) => {
                let middle = |k: &[f64]| f64::midpoint(k[0], k[k.len() - 1]);
                let [_, du, dv] = spline.at(middle(&spline.knots[0]), middle(&spline.knots[1]));
                cross(du, dv)
            }
        }
    }
}

impl Frame {
    /// Returns the unit vector from the z axis to a point, and the distance, mm.
    fn radial(&self, p: Vec3) -> (Vec3, f64) {
        let from = minus(p, self.origin);
        let along = dot(from, self.z);
        let across: Vec3 = std::array::from_fn(|i| from[i] - along * self.z[i]);
        let distance = norm(across);
        (across.map(|v| v / distance), distance)
    }
}

impl Spline {
    pub(super) fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        poles: Vec<Vec<Vec3>>,
        weights: Vec<Vec<f64>>,
    ) -> Result<Self, StepError> {
        let sizes = [poles.len(), poles.first().map_or(0, Vec::len)];
        let has_shape =
            |lengths: Vec<usize>| lengths.len() == sizes[0] && lengths.iter().all(|n| *n == sizes[1]);
        if !has_shape(poles.iter().map(Vec::len).collect())
            || !has_shape(weights.iter().map(Vec::len).collect())
        {
            return Err("the poles or weights of a spline have rows of different lengths".into());
        }
        let fits = |i: usize| sizes[i] > 0 && degrees[i] > 0 && knots[i].len() == sizes[i] + degrees[i] + 1;
        if !(fits(0) && fits(1)) {
            return Err("a spline has a wrong number of knots".into());
        }
        Ok(Self { degrees, knots, poles, weights })
    }

    /// Returns the position and both derivatives.
    fn at(&self, u: f64, v: f64) -> [Vec3; 3] {
        let (mut sums, mut weights) = ([[0.0; 3]; 3], [0.0; 3]);
        for (i, row) in self.poles.iter().enumerate() {
            for (j, pole) in row.iter().enumerate() {
                let ([nu, du], [nv, dv]) = (self.basis(0, i, u), self.basis(1, j, v));
                for (k, n) in [nu * nv, du * nv, nu * dv].into_iter().enumerate() {
                    let weight = n * self.weights[i][j];
                    weights[k] += weight;
                    (0..3).for_each(|axis| sums[k][axis] += weight * pole[axis]);
                }
            }
        }
        let position = sums[0].map(|x| x / weights[0]);
        let derivative = |k: usize| -> Vec3 {
            std::array::from_fn(|axis| (sums[k][axis] - weights[k] * position[axis]) / weights[0])
        };
        [position, derivative(1), derivative(2)]
    }

    /// Returns a basis function in one direction and its derivative (Cox-de Boor recursion).
    fn basis(&self, direction: usize, i: usize, t: f64) -> [f64; 2] {
        let (knots, degree) = (&self.knots[direction], self.degrees[direction]);
        let lower = |i: usize| de_boor(knots, degree - 1, i, t);
        let term = |i: usize| {
            let width = knots[i + degree] - knots[i];
            if width > 0.0 { degree as f64 / width * lower(i) } else { 0.0 }
        };
        [de_boor(knots, degree, i, t), term(i) - term(i + 1)]
    }

    /// Returns the integral of `z n_z`, mm³, by Gauss's rule of five points on each span.
    fn integral(&self) -> f64 {
        const GAUSS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let stations = |knots: &[f64]| -> Vec<(f64, f64)> {
            let spans = knots.windows(2).filter(|k| k[1] > k[0]);
            let nodes = |k: &[f64]| {
                let (middle, half) = (f64::midpoint(k[0], k[1]), (k[1] - k[0]) / 2.0);
                GAUSS.map(|(x, w)| (middle + half * x, half * w))
            };
            spans.flat_map(nodes).collect()
        };
        let across = stations(&self.knots[1]);
        let along = stations(&self.knots[0]);
        let value = |(u, wu): &(f64, f64)| -> f64 {
            let inner = across.iter().map(|(v, wv)| {
                let [position, du, dv] = self.at(*u, *v);
                wv * position[2] * cross(du, dv)[2]
            });
            wu * inner.sum::<f64>()
        };
        along.iter().map(value).sum()
    }

    /// Checks that the four boundary curves of the surface are edges of the loop.
    fn check_boundary(&self, outline: &[LoopEdge]) -> Result<(), StepError> {
        let ends = |k: &[f64]| [k[0], k[k.len() - 1]];
        let ([u0, u1], [v0, v1]) = (ends(&self.knots[0]), ends(&self.knots[1]));
        for k in 0..=16 {
            let share = f64::from(k) / 16.0;
            let (u, v) = (u0 + (u1 - u0) * share, v0 + (v1 - v0) * share);
            for (u, v) in [(u, v0), (u, v1), (u0, v), (u1, v)] {
                let p = self.at(u, v)[0];
                if outline.iter().all(|edge| edge.distance(p) > SAME_MM) {
                    return Err(format!("the boundary of a spline at {p:?} is not an edge").into());
                }
            }
        }
        Ok(())
    }
}

/// Returns the value at `t` of the basis function `i` of a degree.
fn de_boor(knots: &[f64], degree: usize, i: usize, t: f64) -> f64 {
    let last = knots[knots.len() - 1];
    if degree == 0 {
        let inside = knots[i] <= t && (t < knots[i + 1] || (t == last && knots[i + 1] == last));
        return f64::from(u8::from(inside && knots[i] < knots[i + 1]));
    }
    let share = |from: f64, to: f64, value: f64| if to > from { value / (to - from) } else { 0.0 };
    share(knots[i], knots[i + degree], t - knots[i]) * de_boor(knots, degree - 1, i, t)
        + share(knots[i + 1], knots[i + degree + 1], knots[i + degree + 1] - t)
            * de_boor(knots, degree - 1, i + 1, t)
}

/// Returns the vector area of a polygon, mm².
fn area_vector(polygon: &[Vec3]) -> Vec3 {
    let mut sum = [0.0; 3];
    let Some(first) = polygon.first() else { return sum };
    for (p, q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let c = cross(minus(*p, *first), minus(*q, *first));
        (0..3).for_each(|i| sum[i] += c[i] / 2.0);
    }
    sum
}

pub(super) fn minus(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn dot(a: Vec3, b: Vec3) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(super) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}
