//! Cracks: open edges that close when corners are joined over a distance that nobody can see.

use hashbrown::HashMap;

use crate::mesh::{Mesh, Point3};

/// Greatest width of a crack, mm. Wider gaps are holes. A tenth of the finest layer of a printer.
const MAX_WIDTH_MM: f64 = 0.01;
/// Greatest width of a crack, as a share of the longest side of the mesh.
const MAX_SHARE: f64 = 1e-4;
/// Distances that are tried.
const STEPS: i32 = 12;
/// Distances that are tried per decade.
const STEPS_PER_DECADE: f64 = 2.0;
/// Most pairs of corners per open corner that are compared.
const MAX_PAIRS: usize = 32;

/// A mesh whose cracks are closed.
pub(super) struct Joined {
    /// The mesh with corners joined; facets that this collapses are removed.
    pub(super) mesh: Mesh,
    /// The smallest distance that closes it, mm.
    pub(super) width_mm: f64,
}

/// Returns the mesh with the corners of its open edges joined, if that closes it.
pub(super) fn joined(mesh: &Mesh) -> Option<Joined> {
    let open = Open::of(mesh);
    let (low, high) = mesh.bounds()?;
    let max_width = MAX_WIDTH_MM.min(MAX_SHARE * (high - low).max());
    let pairs = open.pairs(mesh, max_width)?;
    let closes = |width: f64| open.is_closed(&open.joined(&pairs, width, mesh.positions.len()));
    // Downward from the greatest width.
    let width = |step: i32| max_width * libm::pow(10.0, f64::from(step - STEPS) / STEPS_PER_DECADE);
    let step = (0..=STEPS).find(|step| closes(width(*step)))?;
    // The smallest distance between two corners that closes the mesh.
    let within = |(distance, ..): &&(f64, u32, u32)| {
        *distance <= width(step) && (step == 0 || *distance > width(step - 1))
    };
    let candidates: Vec<f64> = pairs.iter().filter(within).map(|(distance, ..)| *distance).collect();
    let index = candidates.partition_point(|distance| !closes(*distance));
    let width_mm = candidates.get(index).copied().unwrap_or_else(|| width(step));
    let indices = open.joined(&pairs, width_mm, mesh.positions.len());
    let triangles = mesh.triangles.iter().map(|t| t.map(|v| indices[v as usize]));
    let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Some(Joined { mesh: Mesh::new(mesh.positions.clone(), triangles), width_mm })
}

/// Open edges of a mesh.
struct Open {
    /// Their vertices.
    vertices: Vec<u32>,
    /// Whether each vertex of the mesh is one of them.
    is_open: Vec<bool>,
    /// Facets with such a vertex.
    facets: Vec<[u32; 3]>,
}

impl Open {
    fn of(mesh: &Mesh) -> Self {
        let edges = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        let mut all: Vec<(u32, u32)> =
            mesh.triangles.iter().flat_map(edges).map(|(a, b)| (a.min(b), a.max(b))).collect();
        all.sort_unstable();
        let mut is_open = vec![false; mesh.positions.len()];
        for edge in all.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1) {
            is_open[edge[0].0 as usize] = true;
            is_open[edge[0].1 as usize] = true;
        }
        let vertices = (0u32..).zip(&is_open).filter(|(_, open)| **open).map(|(v, _)| v).collect();
        let has_open = |t: &&[u32; 3]| t.iter().any(|v| is_open[*v as usize]);
        let facets = mesh.triangles.iter().filter(has_open).copied().collect();
        Self { vertices, is_open, facets }
    }

    /// Pairs of open vertices within the greatest width, by distance; `None` if there are too many.
    fn pairs(&self, mesh: &Mesh, max_width: f64) -> Option<Vec<(f64, u32, u32)>> {
        let cell = |p: Point3| -> [i64; 3] {
            #[allow(clippy::cast_possible_truncation)]
            p.coords.map(|x| (x / max_width).floor() as i64).into()
        };
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        let mut pairs = Vec::new();
        let mut left = MAX_PAIRS * self.vertices.len();
        for v in &self.vertices {
            let point = mesh.positions[*v as usize];
            let [x, y, z] = cell(point);
            for i in 0..27 {
                let near = [
                    x.saturating_add(i % 3 - 1),
                    y.saturating_add(i / 3 % 3 - 1),
                    z.saturating_add(i / 9 - 1),
                ];
                for other in cells.get(&near).into_iter().flatten() {
                    left = left.checked_sub(1)?;
                    let distance = (mesh.positions[*other as usize] - point).norm();
                    if distance <= max_width {
                        pairs.push((distance, *other, *v));
                    }
                }
            }
            cells.entry([x, y, z]).or_default().push(*v);
        }
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        Some(pairs)
    }

    /// The vertex that each vertex becomes when pairs within `width` are joined.
    fn joined(&self, pairs: &[(f64, u32, u32)], width: f64, vertices: usize) -> Vec<u32> {
        let mut parents: Vec<u32> = (0u32..).take(vertices).collect();
        for (_, a, b) in pairs.iter().take_while(|(distance, ..)| *distance <= width) {
            let (a, b) = (root(&mut parents, *a), root(&mut parents, *b));
            parents[a.max(b) as usize] = a.min(b);
        }
        for v in &self.vertices {
            parents[*v as usize] = root(&mut parents, *v);
        }
        parents
    }

    /// Whether every edge at an open vertex has two opposite facets.
    fn is_closed(&self, indices: &[u32]) -> bool {
        let mut edges = Vec::new();
        for t in &self.facets {
            let [a, b, c] = t.map(|v| indices[v as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if self.is_open[from as usize] || self.is_open[to as usize] {
                    edges.push((from.min(to), from.max(to), from < to));
                }
            }
        }
        edges.sort_unstable();
        let is_pair = |uses: &[(u32, u32, bool)]| matches!(uses, [(.., false), (.., true)]);
        edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).all(is_pair)
    }
}

fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}
