//! Indexed triangle meshes.

/// A point in space, in millimetres.
pub type Point3 = nalgebra::Point3<f64>;
/// A displacement in space, in millimetres.
pub type Vector3 = nalgebra::Vector3<f64>;

/// A triangle mesh. Seen from outside, triangles are counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in millimetres.
    pub positions: Vec<Point3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Creates a mesh from vertices and triangles.
    pub fn new(positions: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles }
    }

    /// Returns the corners of triangle `t`.
    pub fn corners(&self, t: [u32; 3]) -> [Point3; 3] {
        let [a, b, c] = t;
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// Returns the corners of every triangle.
    pub fn facets(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.triangles.iter().map(|t| self.corners(*t))
    }

    /// Returns the volume in mm³ by the divergence theorem along x, y and z. The three are equal
    /// for a closed mesh.
    pub fn axis_volumes_mm3(&self) -> [f64; 3] {
        axis_volumes_about(self.middle(), self.facets())
    }

    /// Returns the volume in mm³, the mean of the three axis integrals.
    pub fn volume_mm3(&self) -> f64 {
        mean(self.axis_volumes_mm3())
    }

    /// Centre of the bounding box; the origin without vertices.
    pub(crate) fn middle(&self) -> Point3 {
        self.bounds().map_or(Point3::origin(), |(low, high)| nalgebra::center(&low, &high))
    }

    /// Returns the area of the surface in mm².
    pub fn surface_mm2(&self) -> f64 {
        self.facets().map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0).sum()
    }

    /// Returns the lower and upper corner of the bounding box; `None` without vertices.
    pub fn bounds(&self) -> Option<(Point3, Point3)> {
        self.positions.iter().map(|p| (*p, *p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
    }

    /// Returns the mesh translated by `by`.
    #[must_use]
    pub fn translated(mut self, by: Vector3) -> Self {
        self.positions.iter_mut().for_each(|p| *p += by);
        self
    }

    /// Returns the mesh rotated by 180 degrees about the y axis.
    #[must_use]
    pub fn flipped_about_y(mut self) -> Self {
        self.positions.iter_mut().for_each(|p| *p = Point3::new(-p.x, p.y, -p.z));
        self
    }
}

/// Volume in mm³ of a closed surface by the divergence theorem along x, y and z, relative to
/// `middle`. Relative to the centre of its bounding box, a part far from the origin loses no
/// digits.
pub(crate) fn axis_volumes_about(middle: Point3, facets: impl Iterator<Item = [Point3; 3]>) -> [f64; 3] {
    let mut sums = Vector3::zeros();
    for [a, b, c] in facets {
        let normal = (b - a).cross(&(c - a)) / 2.0;
        let centroid = ((a - middle) + (b - middle) + (c - middle)) / 3.0;
        sums += normal.component_mul(&centroid);
    }
    [sums.x, sums.y, sums.z]
}

/// The mean of three axis integrals.
pub(crate) fn mean(axes: [f64; 3]) -> f64 {
    axes.iter().sum::<f64>() / 3.0
}
