//! What trees, stars and shortcuts find is what plain loops over all facets, edges and pairs find.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::facet_tree::{Bounds, FacetTree, boxes_meet, corner_box};
use super::plane::Plane;
use super::triangle_pair::{Corners, meet, surely_apart};
use super::{Expectation, intersections, stars, walls};
use crate::mesh::{Mesh, Point3};

fn number(i: usize) -> u32 {
    u32::try_from(i).unwrap()
}

/// Triangles without common vertices: anywhere, or on a lattice, where many touch, overlap in a plane or have no area.
fn soup(most: usize) -> impl Strategy<Value = Mesh> {
    let of =
        move |point: BoxedStrategy<[f64; 3]>| prop::collection::vec(prop::array::uniform3(point), 1..most);
    prop_oneof![
        of(prop::array::uniform3(-3.0..3.0_f64).boxed()),
        of(prop::array::uniform3(0..5_i32).prop_map(|p| p.map(f64::from)).boxed()),
    ]
    .prop_map(|triangles| {
        let positions: Vec<Point3> = triangles.iter().flatten().map(|p| Point3::from(*p)).collect();
        let numbers = (0..triangles.len()).map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(number));
        Mesh::new(positions, numbers.collect())
    })
}

/// Triangles on few vertices, so that they share corners, edges and more; some name a vertex twice.
fn tangle(most: usize) -> impl Strategy<Value = Mesh> {
    let triangles = prop::collection::vec(prop::array::uniform3(0..12_u32), 1..most);
    let lattice = prop::collection::vec(prop::array::uniform3(0..3_i32).prop_map(|p| p.map(f64::from)), 12);
    let anywhere = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12);
    (prop_oneof![lattice, anywhere], triangles)
        .prop_map(|(points, triangles)| Mesh::new(points.into_iter().map(Point3::from).collect(), triangles))
}

fn corners(mesh: &Mesh, f: usize) -> Corners {
    mesh.triangles[f].map(|v| (v, mesh.positions[v as usize]))
}

/// All pairs of facets with exact boxes that meet, the lesser number first.
fn pairs(mesh: &Mesh) -> Vec<(usize, usize)> {
    let all = 0..mesh.triangles.len();
    let near = |i: usize, j: usize| boxes_meet(corner_box(mesh, i), corner_box(mesh, j));
    all.clone()
        .flat_map(|i| all.clone().skip(i + 1).map(move |j| (i, j)))
        .filter(|(i, j)| near(*i, *j))
        .collect()
}

fn pairs_of_tree(mesh: &Mesh) -> Vec<(usize, usize)> {
    let tree = FacetTree::new(mesh);
    let (mut found, mut near) = (Vec::new(), Vec::new());
    for leaf in 0..tree.leaves() {
        tree.pairs_from(leaf, &mut near, |a, b| {
            let (a, b) = (tree.facet(a), tree.facet(b));
            found.push((a.min(b), a.max(b)));
        });
    }
    found.retain(|(i, j)| boxes_meet(corner_box(mesh, *i), corner_box(mesh, *j)));
    found.sort_unstable();
    found
}

/// The count of each edge fault, of repeated facets and of split vertices, by looking each up.
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
    let split = (0..mesh.positions.len()).filter(|v| fans(mesh, number(*v)) > 1).count();
    let all = [
        ("open edge", edges(|u| u[0] + u[1] == 1)),
        ("non-manifold edge", edges(|u| u[0] + u[1] > 2)),
        ("flipped facet", edges(|u| u[0] + u[1] == 2 && u[1] != 1)),
        ("repeated facet", keys.values().map(|n| n - 1).sum()),
        ("non-manifold vertex", split),
    ];
    all.into_iter().filter(|(_, n)| *n > 0).collect()
}

/// Groups of corners at `v` that hang together through edges at `v`.
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
    fn the_tree_finds_the_pairs_of_a_loop_over_all(mesh in soup(150)) {
        prop_assert_eq!(pairs_of_tree(&mesh), pairs(&mesh));
    }

    #[test]
    fn the_tree_finds_what_meets_a_box(mesh in soup(150), p in prop::array::uniform3(-3.0..3.0_f64)) {
        let (low, high) = (Point3::from(p), Point3::from(p.map(|x| x + 0.7)));
        let tree = FacetTree::new(&mesh);
        let (mut near, mut found) = (Vec::new(), Vec::new());
        tree.leaves_meeting(&Bounds::around(low, high), 0, &mut near);
        tree.slots_meeting(&Bounds::around(low, high), &near, |slot| found.push(tree.facet(slot)));
        found.retain(|f| boxes_meet((low, high), corner_box(&mesh, *f)));
        found.sort_unstable();
        let all = (0..mesh.triangles.len()).filter(|f| boxes_meet((low, high), corner_box(&mesh, *f)));
        prop_assert_eq!(found, all.collect::<Vec<_>>());
    }

    #[test]
    fn crossings_are_those_of_a_loop_over_all(mesh in prop_oneof![soup(60).boxed(), tangle(40).boxed()]) {
        let same = |i: usize, j: usize| mesh.triangles[i].iter().all(|v| mesh.triangles[j].contains(v));
        let crossing: Vec<_> = pairs(&mesh)
            .into_iter()
            .filter(|(i, j)| !same(*i, *j) && meet(&corners(&mesh, *i), &corners(&mesh, *j)))
            .collect();
        let fault = intersections::self_intersections(&mesh, &FacetTree::new(&mesh));
        prop_assert_eq!(fault.as_ref().map_or(0, |f| f.count), crossing.len());
        let first = crossing.first().map(|(i, _)| corners(&mesh, *i)[0].1.coords.into());
        prop_assert_eq!(fault.and_then(|f| f.at_mm), first);
    }

    #[test]
    fn what_is_surely_apart_does_not_meet(mesh in tangle(12)) {
        let plane = |f: usize| Plane::of(mesh.corners(mesh.triangles[f]));
        for i in 0..mesh.triangles.len() {
            for j in (0..mesh.triangles.len()).filter(|j| *j != i) {
                let (s, t) = (corners(&mesh, i), corners(&mesh, j));
                prop_assert!(!(surely_apart((&s, &plane(i)), (&t, &plane(j))) && meet(&s, &t)), "{s:?} {t:?}");
            }
        }
    }

    #[test]
    fn stars_count_what_tables_count(mesh in tangle(40)) {
        let found = stars::examine(&mesh);
        let faults = found.edges.iter().chain(&found.repeated).chain(&found.vertices);
        prop_assert_eq!(faults.map(|f| (f.check, f.count)).collect::<BTreeMap<_, _>>(), counts_by_tables(&mesh));
    }
}

/// A wavy sheet on `side` by `side` squares, of which every tenth row stands up through its neighbour.
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
    let low = Mesh::new((0..side * side).map(at).collect(), triangles.map(|t| t.map(number)).collect());
    let high =
        Mesh::new(low.positions.iter().map(|p| Point3::new(p.y, p.x, p.z)).collect(), low.triangles.clone());
    let first = number(low.positions.len());
    Mesh::new(
        [low.positions, high.positions].concat(),
        low.triangles.into_iter().chain(high.triangles.into_iter().map(|t| t.map(|v| v + first))).collect(),
    )
}

#[test]
fn large_meshes_are_the_same_on_any_number_of_threads() {
    let mesh = sheet(100);
    assert_eq!(pairs_of_tree(&mesh), pairs(&mesh));
    let expected = Expectation { min_wall_mm: 0.5, longest_side_mm: (0.0, 10.0), ..Expectation::default() };
    let examined = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| super::examine(&mesh, &expected))
    };
    let alone = examined(1);
    let checks: Vec<_> = alone.faults.iter().map(|f| f.check).collect();
    assert_eq!(checks, ["size", "open edge", "self-intersection", "thin wall"]);
    assert_eq!(alone, examined(4));
}

#[test]
fn walls_of_facets_without_area_or_bounds_are_left_out() {
    let (far, point) = (f64::from(f32::MAX) * 4.0, Point3::new(1.0, 2.0, 3.0));
    let positions = vec![point, point, point, Point3::new(-far, -far, -far), Point3::new(far, far, far)];
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 3, 4], [3, 4, 2]]);
    assert_eq!(walls::thin_walls(&mesh, &FacetTree::new(&mesh), 0.4), None);
}
