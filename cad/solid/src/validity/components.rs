//! Connected components of a closed mesh, classified by their nesting: bodies and voids.

use std::borrow::Cow;
use std::f64::consts::TAU;

use super::fault::{Fault, Level};
use crate::mesh::{Mesh, Point3, axis_volumes_about, mean};
use crate::parallel;

/// Number of bodies and voids of a closed mesh.
pub(super) struct Bodies {
    pub(super) bodies: usize,
    pub(super) voids: usize,
    /// Components with the wrong orientation.
    pub(super) fault: Option<Fault>,
    /// The bound that was exceeded before the nesting was known.
    pub(super) bound: Option<String>,
}

/// Most components that are compared with each other.
const MAX_COMPONENTS: usize = 10_000;
/// The same, for each facet of the mesh.
const FACETS_PER_FACET: usize = 8;
/// Number of boxes around a component from which nesting is not resolved.
const MAX_AROUND: usize = 256;
/// Most facets of enclosing components that all components are compared with.
const MAX_ENCLOSING_FACETS: usize = 4_000_000;

/// Classifies the connected components of a closed mesh of volume `volume_mm3`.
///
/// A component inside an even number of others bounds a body and must face outward, one inside an
/// odd number bounds a void and must face inward.
pub(super) fn bodies(mesh: &Mesh, volume_mm3: f64) -> Bodies {
    let triangles = connected(mesh);
    let components: Vec<Component> = match &triangles[..] {
        [triangles] => vec![Component { mesh, triangles, bounds: None, volume_mm3 }],
        several => {
            let middle = mesh.middle();
            several.iter().map(|triangles| Component::measured(mesh, triangles, middle)).collect()
        }
    };
    let mut bodies = Bodies { bodies: 0, voids: 0, fault: None, bound: None };
    if components.len() > MAX_COMPONENTS {
        bodies.bound = Some(format!("more than {MAX_COMPONENTS} separate surfaces"));
        return bodies;
    }
    let around = parallel::in_chunks(components.len(), |range| {
        let around = |i: usize| {
            let near = |j: &usize| *j != i && components[*j].surrounds(&components[i]);
            (0..components.len()).filter(near).take(MAX_AROUND).collect::<Vec<_>>()
        };
        range.map(around).collect::<Vec<_>>()
    })
    .concat();
    let facets: usize = around.iter().flatten().map(|j| components[*j].triangles.len()).sum();
    let is_nested = around.iter().any(|around| around.len() == MAX_AROUND);
    if is_nested || facets > MAX_ENCLOSING_FACETS + FACETS_PER_FACET * mesh.triangles.len() {
        let bound = format!(
            "more than {MAX_AROUND} surfaces or {MAX_ENCLOSING_FACETS} facets around another surface"
        );
        bodies.bound = Some(bound);
        return bodies;
    }
    let depths = parallel::in_chunks(components.len(), |range| {
        let depth = |i: usize| around[i].iter().filter(|j| components[**j].encloses(&components[i])).count();
        range.map(depth).collect::<Vec<_>>()
    });
    let mut wrong = Vec::new();
    for (component, depth) in components.iter().zip(depths.concat()) {
        let is_void = depth % 2 == 1;
        if is_void {
            bodies.voids += 1
        } else {
            bodies.bodies += 1
        }
        if is_void == (component.volume_mm3 > 0.0) {
            wrong.push((component, is_void));
        }
    }
    bodies.fault = wrong.first().map(|(component, is_void)| {
        let detail = if *is_void {
            format!("{} bodies are inside another body", wrong.len())
        } else {
            format!(
                "{} bodies face inward; the first has a volume of {:.4} mm3",
                wrong.len(),
                component.volume_mm3
            )
        };
        let fault = Fault::new("inside out", Level::Error, wrong.len(), detail);
        component.first_corner().map_or(fault.clone(), |corner| fault.at(corner))
    });
    bodies
}

/// A number of bodies other than the expected one.
pub(super) fn wrong_count(bodies: usize, expected: Option<usize>) -> Option<Fault> {
    let expected = expected?;
    let detail = format!("the mesh has {bodies} bodies, expected {expected}");
    (bodies != expected).then(|| Fault::new("bodies", Level::Error, bodies, detail))
}

/// Groups of triangles that are connected through shared vertices, in the order of their first
/// triangles.
fn connected(mesh: &Mesh) -> Vec<Cow<'_, [[u32; 3]]>> {
    let mut parents: Vec<u32> = (0u32..).take(mesh.positions.len()).collect();
    for t in &mesh.triangles {
        let first = root(&mut parents, t[0]);
        for v in &t[1..] {
            let other = root(&mut parents, *v);
            parents[other as usize] = first;
        }
    }
    let root_of_first = mesh.triangles.first().map(|t| root(&mut parents, t[0]));
    if mesh.triangles.iter().all(|t| Some(root(&mut parents, t[0])) == root_of_first) {
        return vec![Cow::Borrowed(&mesh.triangles)];
    }
    let mut indices = vec![None; mesh.positions.len()];
    let mut groups: Vec<Vec<[u32; 3]>> = Vec::new();
    for t in &mesh.triangles {
        let index = *indices[root(&mut parents, t[0]) as usize].get_or_insert(groups.len());
        if index == groups.len() {
            groups.push(Vec::new());
        }
        groups[index].push(*t);
    }
    groups.into_iter().map(Cow::Owned).collect()
}

fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        let up = parents[parents[v as usize] as usize];
        parents[v as usize] = up;
        v = up;
    }
    v
}

/// A connected component of a mesh.
struct Component<'a> {
    mesh: &'a Mesh,
    triangles: &'a [[u32; 3]],
    /// Bounding box of the vertices of its facets.
    bounds: Option<(Point3, Point3)>,
    volume_mm3: f64,
}

impl<'a> Component<'a> {
    /// One of several components, its volume integrated about `middle`.
    fn measured(mesh: &'a Mesh, triangles: &'a [[u32; 3]], middle: Point3) -> Self {
        let facets = || triangles.iter().map(|t| mesh.corners(*t));
        let bounds = facets().flatten().map(|p| (p, p)).reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
        Self { mesh, triangles, bounds, volume_mm3: mean(axis_volumes_about(middle, facets())) }
    }

    fn facets(&self) -> impl Iterator<Item = [Point3; 3]> + '_ {
        self.triangles.iter().map(|t| self.mesh.corners(*t))
    }

    fn first_corner(&self) -> Option<Point3> {
        self.facets().next().map(|corners| corners[0])
    }

    /// Whether the bounding box of `inner` is inside that of this component.
    fn surrounds(&self, inner: &Component) -> bool {
        let (Some((low, high)), Some((inner_low, inner_high))) = (self.bounds, inner.bounds) else {
            return false;
        };
        low <= inner_low && inner_high <= high
    }

    /// Whether `inner`, whose bounding box is inside, is entirely inside; components that cross are
    /// left to the intersection check.
    fn encloses(&self, inner: &Component) -> bool {
        inner.first_corner().is_some_and(|corner| winding_number(self.facets(), corner).abs() > 0.5)
    }
}

/// Winding number of a closed surface about `point`: its solid angle over that of a sphere (van
/// Oosterom & Strackee).
pub(super) fn winding_number(facets: impl Iterator<Item = [Point3; 3]>, point: Point3) -> f64 {
    let half_angles: f64 = facets
        .map(|corners| {
            let [a, b, c] = corners.map(|p| p - point);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            libm::atan2(a.dot(&b.cross(&c)), denominator)
        })
        .sum();
    half_angles / TAU
}
