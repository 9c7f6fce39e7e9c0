//! Affine transforms of items and components.

use super::value::{is_number, number};
use crate::mesh::{Mesh, Point3};

/// Largest deviation of a rotation matrix from orthogonality that counts as rounding.
const RIGID: f64 = 1e-4;

/// An affine transform by the rows of its matrix: `x' = x m[0] + y m[1] + z m[2] + m[3]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform([[f64; 3]; 4]);

impl Transform {
    /// The identity.
    pub(super) const IDENTITY: Self =
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]);

    /// Parses exactly twelve finite numbers (`ST_Matrix3D`), the translation in units of `unit_mm`;
    /// `None` for any other text.
    pub(super) fn parse(text: &str, unit_mm: f64) -> Option<Self> {
        let mut words = text.split_ascii_whitespace();
        let mut numbers = [0.0; 12];
        for value in &mut numbers {
            *value = words.next().filter(|word| is_number(word)).and_then(number)?;
        }
        if words.next().is_some() {
            return None;
        }
        let scale = |row: usize| if row == 3 { unit_mm } else { 1.0 };
        Some(Self(std::array::from_fn(|i| std::array::from_fn(|j| numbers[3 * i + j] * scale(i)))))
    }

    /// Whether the transform only rotates and translates.
    pub(super) fn is_rigid(&self) -> bool {
        let m = &self.0;
        (0..3).all(|i| {
            (0..3).all(|j| {
                let product: f64 = (0..3).map(|k| m[i][k] * m[j][k]).sum();
                (product - f64::from(u8::from(i == j))).abs() < RIGID
            })
        })
    }

    /// The bits of the linear part, which determine size and shape of a mesh.
    pub(super) fn shape(&self) -> [u64; 9] {
        std::array::from_fn(|i| self.0[i / 3][i % 3].to_bits())
    }

    /// Determinant of the linear part: negative for a transform that mirrors, zero for one that
    /// flattens.
    pub(super) fn determinant(&self) -> f64 {
        let m = &self.0;
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }

    /// Applies the transform to a point.
    pub(super) fn point(&self, p: Point3) -> Point3 {
        let m = &self.0;
        let at = |j: usize| p.x * m[0][j] + p.y * m[1][j] + p.z * m[2][j] + m[3][j];
        Point3::new(at(0), at(1), at(2))
    }

    /// Applies the transform to a mesh. Mirrored facets are reversed, so that they keep facing
    /// outward: a transform does not change the sign of the volume (core specification, 3.3).
    pub(super) fn mesh(&self, mesh: &Mesh) -> Mesh {
        let mut triangles = mesh.triangles.clone();
        if self.determinant() < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Mesh::new(mesh.positions.iter().map(|p| self.point(*p)).collect(), triangles)
    }

    /// Returns the transform that applies `self` first and `outer` second.
    pub(super) fn then(&self, outer: &Self) -> Self {
        let row = |row: [f64; 3], shift: f64| {
            let at = |j: usize| (0..3).map(|k| row[k] * outer.0[k][j]).sum::<f64>() + shift * outer.0[3][j];
            [at(0), at(1), at(2)]
        };
        let m = &self.0;
        Self([row(m[0], 0.0), row(m[1], 0.0), row(m[2], 0.0), row(m[3], 1.0)])
    }
}
