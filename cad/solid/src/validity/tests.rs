//! Each defect is detected, named and located; valid bodies pass.

use super::examine::{Expectation, examine};
use crate::mesh::{Mesh, Point3, Vector3};

/// An axis-parallel box.
fn block(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let at = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        Point3::new(pick(0), pick(1), pick(2))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(at).collect(), triangles)
}

fn cube() -> Mesh {
    block([0.0; 3], [10.0; 3])
}

fn inverted(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

fn joined(mut a: Mesh, b: Mesh) -> Mesh {
    let first = u32::try_from(a.positions.len()).unwrap();
    a.positions.extend(b.positions);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}

fn checks(mesh: &Mesh, expected: &Expectation) -> Vec<&'static str> {
    examine(mesh, expected).faults.iter().map(|f| f.check).collect()
}

fn faults(mesh: &Mesh) -> Vec<&'static str> {
    checks(mesh, &Expectation::default())
}

#[test]
fn valid_bodies_pass() {
    assert!(faults(&cube()).is_empty());
    let apart = joined(cube(), cube().translated(Vector3::new(20.0, 0.0, 0.0)));
    assert!(faults(&apart).is_empty());
    let hollow = joined(cube(), inverted(block([4.0; 3], [6.0; 3])));
    let hollow = examine(&hollow, &Expectation { bodies: Some(1), ..Expectation::default() });
    assert!(hollow.is_valid());
    assert_eq!((hollow.facts.bodies, hollow.facts.voids), (1, 1));
    assert!((hollow.facts.volume_mm3 - 992.0).abs() < 1e-9);
}

#[test]
fn every_defect_is_named() {
    let mut hole = cube();
    hole.triangles.pop();
    assert_eq!(faults(&hole), ["open edge"]);

    let mut flipped = cube();
    flipped.triangles[0].swap(1, 2);
    assert_eq!(faults(&flipped), ["flipped facet"]);

    assert_eq!(faults(&inverted(cube())), ["inside out"]);
    assert_eq!(faults(&joined(cube(), block([4.0; 3], [6.0; 3]))), ["inside out"]);

    let mut twice = cube();
    twice.triangles.push(twice.triangles[0]);
    assert_eq!(faults(&twice), ["repeated facet", "non-manifold edge"]);

    let mut pushed = cube();
    pushed.positions[0] = Point3::new(12.0, 5.0, 5.0);
    assert_eq!(faults(&pushed), ["self-intersection"]);

    let overlapping = joined(cube(), cube().translated(Vector3::new(5.0, 5.0, 5.0)));
    assert_eq!(faults(&overlapping), ["self-intersection"]);

    let mut nowhere = cube();
    nowhere.positions[3].y = f64::NAN;
    assert_eq!(faults(&nowhere), ["not finite"]);
    assert_eq!(faults(&Mesh::default()), ["empty"]);

    let mut flat = cube();
    flat.positions.push(Point3::new(5.0, 0.0, 0.0));
    flat.triangles.push([0, 8, 1]);
    assert!(faults(&flat).contains(&"degenerate facet"));
}

#[test]
fn touching_bodies_are_not_manifold() {
    let mut corner = joined(cube(), cube().translated(Vector3::new(10.0, 10.0, 10.0)));
    // The second cube's first vertex is the first cube's last.
    corner.triangles.iter_mut().flatten().for_each(|v| *v = if *v == 8 { 7 } else { *v });
    assert_eq!(faults(&corner), ["non-manifold vertex"]);
    let wall = joined(cube(), cube().translated(Vector3::new(10.0, 0.0, 0.0)));
    assert_eq!(faults(&wall), ["self-intersection"]);
}

#[test]
fn unmet_expectations_are_faults() {
    let two = joined(cube(), cube().translated(Vector3::new(20.0, 0.0, 0.0)));
    let one = Expectation { bodies: Some(1), ..Expectation::default() };
    assert_eq!(checks(&two, &one), ["bodies"]);
    let heavy = Expectation { volume_mm3: Some((999.0, 0.5)), ..Expectation::default() };
    assert_eq!(checks(&cube(), &heavy), ["volume"]);
    let sheet = block([0.0; 3], [10.0, 10.0, 0.15]);
    let printable = Expectation { min_wall_mm: 0.4, ..Expectation::default() };
    assert_eq!(checks(&sheet, &printable), ["thin wall"]);
    assert!(checks(&cube(), &printable).is_empty());
}

#[test]
fn faults_have_place_and_extent() {
    let mut hole = cube();
    hole.triangles.remove(0);
    let examination = examine(&hole, &Expectation::default());
    let text = examination.faults[0].to_string();
    assert!(text.contains("3 edges have only one facet") && text.contains("mm)"), "{text}");
}
