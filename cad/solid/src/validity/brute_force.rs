//! Comparison of trees, one-rings and shortcuts with plain loops over all facets, edges and pairs.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::budget::Pool;
use super::bvh::{Bounds, Bvh, boxes_overlap, corner_box};
use super::examine::{Expectation, examine};
use super::plane::Plane;
use super::slivers::Slivers;
use super::triangle_intersection::{Corners, are_disjoint, intersect};
use super::{connectivity, self_intersection, wall_thickness};
use crate::mesh::{Mesh, Point3};

fn index(i: usize) -> u32 {
    u32::try_from(i).unwrap()
}

/// Triangles without shared vertices: anywhere, or on a lattice, where many touch, are coplanar or
/// degenerate.
fn soup(most: usize) -> impl Strategy<Value = Mesh> {
    let of =
        move |point: BoxedStrategy<[f64; 3]>| prop::collection::vec(prop::array::uniform3(point), 1..most);
    prop_oneof![
        of(prop::array::uniform3(-3.0..3.0_f64).boxed()),
        of(prop::array::uniform3(0..5_i32).prop_map(|p| p.map(f64::from)).boxed()),
    ]
    .prop_map(|triangles| {
        let positions: Vec<Point3> = triangles.iter().flatten().map(|p| Point3::from(*p)).collect();
        let indices = (0..triangles.len()).map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(index));
        Mesh::new(positions, indices.collect())
    })
}

/// Triangles on few vertices, which share corners, edges and more; some name a vertex twice.
fn tangle(most: usize) -> impl Strategy<Value = Mesh> {
    let triangles = prop::collection::vec(prop::array::uniform3(0..12_u32), 1..most);
    let lattice = prop::collection::vec(prop::array::uniform3(0..3_i32).prop_map(|p| p.map(f64::from)), 12);
    let anywhere = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12);
    (prop_oneof![lattice, anywhere], triangles)
        .prop_map(|(points, triangles)| Mesh::new(points.into_iter().map(Point3::from).collect(), triangles))
}

/// Facets of all sizes and angles around two vertices, most of them narrow.
fn fan() -> impl Strategy<Value = Mesh> {
    let direction = || {
        prop_oneof![
            prop::array::uniform3(-1.0..1.0_f64),
            prop::array::uniform3(-2..3_i32).prop_map(|p| p.map(f64::from)),
        ]
    };
    let facet = (0..8_u32, direction(), prop::array::uniform3(-0.05..0.05_f64));
    prop::collection::vec(facet, 70..110).prop_map(|facets| {
        let mut positions = vec![Point3::origin(), Point3::new(0.5, 0.0, 0.0)];
        let mut triangles = Vec::new();
        for (i, (kind, a, offset)) in facets.into_iter().enumerate() {
            let (first, scale) = (index(positions.len()), if kind == 0 { 20.0 } else { 1.0 });
            positions.push(Point3::from(a));
            positions.push(Point3::from(a) + nalgebra::Vector3::from(offset) * scale);
            triangles.push([u32::from(kind == 7 && i > 65), first, first + 1]);
        }
        Mesh::new(positions, triangles)
    })
}

fn corners(mesh: &Mesh, f: usize) -> Corners {
    mesh.triangles[f].map(|v| (v, mesh.positions[v as usize]))
}

/// All pairs of facets with exact boxes that overlap, the lesser index first.
fn pairs(mesh: &Mesh) -> Vec<(usize, usize)> {
    let all = 0..mesh.triangles.len();
    let near = |i: usize, j: usize| boxes_overlap(corner_box(mesh, i), corner_box(mesh, j));
    all.clone()
        .flat_map(|i| all.clone().skip(i + 1).map(move |j| (i, j)))
        .filter(|(i, j)| near(*i, *j))
        .collect()
}

fn pairs_of_tree(mesh: &Mesh) -> Vec<(usize, usize)> {
    let bvh = Bvh::new(mesh);
    let (mut pairs, mut near) = (Vec::new(), Vec::new());
    for leaf in 0..bvh.leaves() {
        bvh.pairs_from(leaf, &mut near, |a, b| {
            let (a, b) = (bvh.facet(a), bvh.facet(b));
            pairs.push((a.min(b), a.max(b)));
        });
    }
    pairs.retain(|(i, j)| boxes_overlap(corner_box(mesh, *i), corner_box(mesh, *j)));
    pairs.sort_unstable();
    pairs
}

/// The count of each fault of edges, facets and vertices, from tables.
fn counts_by_tables(mesh: &Mesh) -> BTreeMap<&'static str, usize> {
    let mut uses: BTreeMap<(u32, u32), [usize; 2]> = BTreeMap::new();
    let mut keys: BTreeMap<[u32; 3], usize> = BTreeMap::new();
    for t in &mesh.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            uses.entry((a.min(b), a.max(b))).or_default()[usize::from(a < b)] += 1;
        }
        let mut key = *t;
        key.sort_unstable();
        *keys.entry(key).or_default() += 1;
    }
    let edges = |wrong: fn(&[usize; 2]) -> bool| uses.values().filter(|u| wrong(u)).count();
    let split = (0..mesh.positions.len()).filter(|v| fans(mesh, index(*v)) > 1).count();
    let all = [
        ("open edge", edges(|u| u[0] + u[1] == 1)),
        ("non-manifold edge", edges(|u| u[0] + u[1] > 2)),
        ("flipped facet", edges(|u| u[0] + u[1] == 2 && u[1] != 1)),
        ("repeated facet", keys.values().map(|n| n - 1).sum()),
        ("non-manifold vertex", split),
    ];
    all.into_iter().filter(|(_, n)| *n > 0).collect()
}

/// Number of groups of facets at `v` that are connected through edges at `v`.
fn fans(mesh: &Mesh, v: u32) -> usize {
    let others = |t: &[u32; 3]| t.iter().copied().filter(|i| *i != v).collect::<Vec<_>>();
    let mut left: Vec<Vec<u32>> =
        mesh.triangles.iter().flat_map(|t| t.iter().filter(|i| **i == v).map(|_| others(t))).collect();
    let mut groups = 0;
    while let Some(seed) = left.pop() {
        groups += 1;
        let mut front = vec![seed];
        while let Some(f) = front.pop() {
            let (joined, rest) = left.into_iter().partition(|g| f.iter().any(|i| g.contains(i)));
            left = rest;
            front.extend::<Vec<Vec<u32>>>(joined);
        }
    }
    groups
}

proptest! {
    #[test]
    fn the_tree_finds_all_pairs(mesh in soup(150)) {
        prop_assert_eq!(pairs_of_tree(&mesh), pairs(&mesh));
    }

    #[test]
    fn the_tree_finds_all_in_a_box(mesh in soup(150), p in prop::array::uniform3(-3.0..3.0_f64)) {
        let (low, high) = (Point3::from(p), Point3::from(p.map(|x| x + 0.7)));
        let bvh = Bvh::new(&mesh);
        let (mut near, mut facets) = (Vec::new(), Vec::new());
        bvh.leaves_overlapping(&Bounds::around(low, high), 0, &mut near);
        bvh.slots_overlapping(&Bounds::around(low, high), &near, |slot| facets.push(bvh.facet(slot)));
        facets.retain(|f| boxes_overlap((low, high), corner_box(&mesh, *f)));
        facets.sort_unstable();
        let all = (0..mesh.triangles.len()).filter(|f| boxes_overlap((low, high), corner_box(&mesh, *f)));
        prop_assert_eq!(facets, all.collect::<Vec<_>>());
    }

    #[test]
    fn all_intersections_are_found(mesh in prop_oneof![soup(60).boxed(), tangle(40).boxed()]) {
        let same = |i: usize, j: usize| mesh.triangles[i].iter().all(|v| mesh.triangles[j].contains(v));
        let crossing: Vec<_> = pairs(&mesh)
            .into_iter()
            .filter(|(i, j)| !same(*i, *j) && intersect(&corners(&mesh, *i), &corners(&mesh, *j)))
            .collect();
        let slivers = Slivers::of(&mesh, 1e-5);
        let crossing: Vec<_> = crossing.into_iter().filter(|(i, j)| slivers.accept(&corners(&mesh, *i), &corners(&mesh, *j))).collect();
        let fault = self_intersection::search(&mesh, &Bvh::new(&mesh), 1e-5, Pool::UNSHARED).fault;
        prop_assert_eq!(fault.as_ref().map_or(0, |f| f.count), crossing.len());
        let first = crossing.first().map(|(i, _)| corners(&mesh, *i)[0].1.coords.into());
        prop_assert_eq!(fault.and_then(|f| f.at_mm), first);
    }

    /// Facets around a vertex with very many of them are compared by angle.
    #[test]
    fn all_intersections_of_a_fan_are_found(mesh in fan()) {
        let all = 0..mesh.triangles.len();
        let pairs = all.clone().flat_map(|i| all.clone().skip(i + 1).map(move |j| (i, j)));
        let same = |i: usize, j: usize| mesh.triangles[i].iter().all(|v| mesh.triangles[j].contains(v));
        let crossing = pairs.filter(|(i, j)| !same(*i, *j) && intersect(&corners(&mesh, *i), &corners(&mesh, *j)));
        let slivers = Slivers::of(&mesh, 1e-5);
        let crossing = crossing.filter(|(i, j)| slivers.accept(&corners(&mesh, *i), &corners(&mesh, *j)));
        let bvh = Bvh::new(&mesh);
        prop_assert!(!bvh.hub_slots().is_empty());
        let fault = self_intersection::search(&mesh, &bvh, 1e-5, Pool::UNSHARED).fault;
        prop_assert_eq!(fault.map_or(0, |f| f.count), crossing.count());
    }

    #[test]
    fn disjoint_triangles_do_not_intersect(mesh in tangle(12)) {
        let plane = |f: usize| Plane::of(mesh.corners(mesh.triangles[f]));
        for i in 0..mesh.triangles.len() {
            for j in (0..mesh.triangles.len()).filter(|j| *j != i) {
                let (s, t) = (corners(&mesh, i), corners(&mesh, j));
                prop_assert!(!(are_disjoint((&s, &plane(i)), (&t, &plane(j))) && intersect(&s, &t)), "{s:?} {t:?}");
            }
        }
    }

    #[test]
    fn one_rings_count_as_tables_do(mesh in tangle(40)) {
        let connectivity = connectivity::check(&mesh);
        let faults = connectivity.edges.iter().chain(&connectivity.repeated).chain(&connectivity.vertices);
        prop_assert_eq!(faults.map(|f| (f.check, f.count)).collect::<BTreeMap<_, _>>(), counts_by_tables(&mesh));
    }
}

/// A wavy sheet of `side` by `side` squares, in which every tenth row intersects its neighbour.
fn sheet(side: usize) -> Mesh {
    let at = |i: usize| {
        let (row, column) = ((i / side) as f64, (i % side) as f64);
        Point3::new(
            column + if row % 10.0 == 0.0 { 0.6 } else { 0.0 },
            row,
            libm::sin(row * 0.7) + libm::cos(column * 0.3),
        )
    };
    let squares = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
    let triangles = squares.flat_map(|i| [[i, i + 1, i + side], [i + side + 1, i + side, i + 1]]);
    let low = Mesh::new((0..side * side).map(at).collect(), triangles.map(|t| t.map(index)).collect());
    let high =
        Mesh::new(low.positions.iter().map(|p| Point3::new(p.y, p.x, p.z)).collect(), low.triangles.clone());
    let first = index(low.positions.len());
    Mesh::new(
        [low.positions, high.positions].concat(),
        low.triangles.into_iter().chain(high.triangles.into_iter().map(|t| t.map(|v| v + first))).collect(),
    )
}

#[test]
fn threads_do_not_change_the_outcome() {
    let mesh = sheet(100);
    assert_eq!(pairs_of_tree(&mesh), pairs(&mesh));
    let expected = Expectation { min_wall_mm: 0.5, longest_side_mm: (0.0, 10.0), ..Expectation::default() };
    let examined = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| examine(&mesh, &expected))
    };
    let alone = examined(1);
    let checks: Vec<_> = alone.faults.iter().map(|f| f.check).collect();
    assert_eq!(checks, ["size", "open edge", "self-intersection", "thin wall"]);
    assert_eq!(alone, examined(4));
}

#[test]
fn degenerate_facets_have_no_wall() {
    let (far, point) = (f64::from(f32::MAX) * 4.0, Point3::new(1.0, 2.0, 3.0));
    let positions = vec![point, point, point, Point3::new(-far, -far, -far), Point3::new(far, far, far)];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 3, 4], [3, 4, 2]]);
    assert_eq!(wall_thickness::search(&mesh, &Bvh::new(&mesh), 0.4, Pool::UNSHARED).fault, None);
}
