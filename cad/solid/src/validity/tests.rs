//! Each defect is detected, named and located; valid bodies pass.

use super::budget::Allowance;
use super::examine::{Expectation, examine, examine_within};
use super::fault::Level;
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

/// A cone of `sides` facets around its tip, and as many around the centre of its base.
fn cone(sides: u32) -> Mesh {
    let angle = |i: u32| f64::from(i) / f64::from(sides) * std::f64::consts::TAU;
    let rim = (0..sides).map(|i| Point3::new(20.0 * libm::cos(angle(i)), 20.0 * libm::sin(angle(i)), 0.0));
    let ends = [Point3::new(0.0, 0.0, 20.0), Point3::origin()];
    let triangles = (0..sides).flat_map(|i| {
        let (a, b) = (2 + i, 2 + (i + 1) % sides);
        [[0, a, b], [1, b, a]]
    });
    Mesh::new(ends.into_iter().chain(rim).collect(), triangles.collect())
}

/// The boxes of all facets around the tip meet.
#[test]
fn facets_around_a_point_are_judged() {
    let mut cone = cone(10_000);
    let examination = examine(&cone, &Expectation::default());
    assert_eq!((examination.faults, examination.incomplete), (vec![], vec![]));
    // A corner of the rim is outside, across the cone: facets at the tip pass through others there.
    cone.positions[5000] = Point3::new(25.0, 0.01, 10.0);
    assert!(faults(&cone).contains(&"self-intersection"));
}

/// A search that a mesh makes quadratic ends, and the mesh is not called valid.
#[test]
fn excessive_searches_are_incomplete() {
    let needle = |i: usize| {
        let shift = i as f64 * 0.2;
        let far = Point3::new(100.0 + shift, 100.0 - shift, 100.0);
        let near = Point3::new(shift, -shift, 0.0);
        let up = Vector3::new(0.0, 0.0, 0.05);
        let side = Vector3::new(0.05, -0.05, 0.0);
        let positions = vec![near, near + side, far, far + up];
        Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    };
    let mut all = Mesh::default();
    for i in 0..3000 {
        all = joined(all, needle(i));
    }
    let examination = examine(&all, &Expectation::default());
    let checks: Vec<_> = examination.incomplete.iter().map(|one| (one.check, one.level)).collect();
    assert_eq!(checks, [("self-intersection", Level::Error)], "{:?}", examination.faults);
    assert!(!examination.is_valid());
}

/// A facet without area closes a T-junction: it touches its neighbours, which do not intersect.
#[test]
fn a_sliver_is_one_fault() {
    let mut split = cube_with_a_sliver(1.0, [0.0; 3]);
    let examination = examine(&split, &Expectation::default());
    assert_eq!(examination.faults.iter().map(|f| f.check).collect::<Vec<_>>(), ["degenerate facet"]);
    assert!(examination.is_valid() && !examination.is_flawless());
    // A facet that passes through another next to a sliver is found.
    let divided = split.triangles.iter().find(|t| t.contains(&8)).unwrap();
    let apex = divided.iter().find(|v| ![0, 1, 8].contains(*v)).unwrap();
    split.positions[*apex as usize] = Point3::new(5.0, 5.0, 15.0);
    assert!(faults(&split).contains(&"self-intersection"));
}

/// A cube with an edge that is split in one facet only, closed by a facet without area.
fn cube_with_a_sliver(scale: f64, shift: [f64; 3]) -> Mesh {
    let mut mesh = cube();
    mesh.positions.push(Point3::new(5.0, 0.0, 0.0));
    let t = mesh.triangles.iter().position(|t| t.contains(&0) && t.contains(&1)).unwrap();
    let corners = mesh.triangles[t];
    let (a, b) = if (0..3).any(|k| corners[k] == 0 && corners[(k + 1) % 3] == 1) { (0, 1) } else { (1, 0) };
    let replaced = |from: u32| corners.map(|v| if v == from { 8 } else { v });
    mesh.triangles[t] = replaced(b);
    mesh.triangles.extend([replaced(a), [a, b, 8]]);
    mesh.positions.iter_mut().for_each(|p| *p = *p * scale + Vector3::from(shift));
    mesh
}

/// Slivers excuse contact, whatever the size of the facets next to them, and no overlap.
#[test]
fn slivers_do_not_hide_an_overlap() {
    for scale in [0.1, 1.0, 10.0] {
        let first = cube_with_a_sliver(scale, [0.0; 3]);
        for (overlap_mm, is_found) in [(-0.01, false), (1e-3, true), (0.01, true)] {
            let aside = 10.0 * scale - overlap_mm;
            let second = cube_with_a_sliver(scale, [aside, 0.3 * scale, 0.2 * scale]);
            let mut both = first.clone();
            both.triangles.extend(second.triangles.iter().map(|t| t.map(|v| v + 9)));
            both.positions.extend(second.positions);
            let found = faults(&both).contains(&"self-intersection");
            assert_eq!(found, is_found, "{scale}, {overlap_mm} mm");
        }
    }
}

/// A closed prism around the z axis from -5 to 5 mm, of `n` sides.
fn wire(n: u32, radius: f64) -> Mesh {
    let at = |i: u32, z: f64| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
    };
    let mut positions: Vec<Point3> = (0..n).map(|i| at(i, -5.0)).chain((0..n).map(|i| at(i, 5.0))).collect();
    positions.extend([Point3::new(0.0, 0.0, -5.0), Point3::new(0.0, 0.0, 5.0)]);
    let side = |i: u32| {
        let (a, b) = (i, (i + 1) % n);
        [[a, b, n + b], [a, n + b, n + a], [2 * n, b, a], [2 * n + 1, n + a, n + b]]
    };
    Mesh::new(positions, (0..n).flat_map(side).collect())
}

/// All facets of a thin wire are thin, and it intersects what it passes through.
#[test]
fn a_wire_through_a_plate_intersects() {
    let wire = wire(20, 2e-5);
    assert!(!faults(&wire).contains(&"self-intersection"), "{:?}", faults(&wire));
    let mut both = cube();
    // Through the diagonal of two facets.
    both.positions.iter_mut().for_each(|p| *p = Point3::new(p.x - 5.0, p.y - 5.0, (p.z - 5.0) / 5.0));
    let first = both.positions.len() as u32;
    both.positions.extend(&wire.positions);
    both.triangles.extend(wire.triangles.iter().map(|t| t.map(|v| v + first)));
    assert!(faults(&both).contains(&"self-intersection"), "{:?}", faults(&both));
}

/// Many small crowds are bounded as one large crowd is.
#[test]
fn meshes_of_a_file_share_their_allowance() {
    let mut nested = Mesh::default();
    for i in 0..240 {
        let (first, scale) = (nested.positions.len() as u32, 1.0 + f64::from(i) * 1e-3);
        let cube = cube();
        // Oblique, so that the boxes of near facets overlap.
        let place = |p: &Point3| {
            let p = (p.coords - Vector3::new(5.0, 5.0, 5.0)) * scale;
            Point3::new(p.x + 0.3 * p.y, p.y + 0.3 * p.z, p.z + 0.3 * p.x)
        };
        nested.positions.extend(cube.positions.iter().map(place));
        nested.triangles.extend(cube.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    // Number of examinations before one is incomplete.
    let complete = |mut allowance: Allowance| {
        (0..200)
            .take_while(|_| {
                let examination = examine_within(&nested, &Expectation::default(), &mut allowance);
                !examination.incomplete.iter().any(|one| one.check == "self-intersection")
            })
            .count()
    };
    let (unshared, short) = (complete(Allowance::default()), complete(Allowance::of_bytes(0)));
    // A file of few bytes may unpack to many facets.
    assert!(0 < short && short < unshared && unshared < 200, "{short} {unshared}");
}

/// A flat plate of a fine grid, whose facets touch twelve others in their plane, is judged within the
/// allowance of its 3MF, whose texts compress to 6.4 bytes a facet.
#[test]
fn a_fine_grid_is_judged_within_the_allowance_of_its_file() {
    let (cells, facets) = (200, 161_600);
    let mut plate = Mesh::default();
    let side = cells as u32 + 1;
    for z in [0.0, 2.0] {
        let points = (0..side * side).map(|i| Point3::new(f64::from(i % side), f64::from(i / side), z));
        plate.positions.extend(points);
    }
    let quad = |a: u32, b: u32, c: u32, d: u32| [[a, b, c], [a, c, d]];
    let top = side * side;
    for i in (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x)) {
        let (b, c, d) = (i + 1, i + 1 + side, i + side);
        plate.triangles.extend(quad(i, d, c, b));
        plate.triangles.extend(quad(top + i, top + b, top + c, top + d));
    }
    let last = side - 1;
    for k in 0..last {
        for (a, b) in [
            (k, k + 1),
            (last + k * side, last + (k + 1) * side),
            (last * side + k + 1, last * side + k),
            ((k + 1) * side, k * side),
        ] {
            plate.triangles.extend(quad(a, b, top + b, top + a));
        }
    }
    assert_eq!(plate.triangles.len(), facets);
    let expected = Expectation { min_wall_mm: 0.4, ..Expectation::default() };
    let mut allowance = Allowance::of_bytes(facets * 64 / 10);
    let examination = examine_within(&plate, &expected, &mut allowance);
    assert!(examination.is_flawless(), "{examination:?}");
    assert!(!examine_within(&plate, &expected, &mut Allowance::of_bytes(0)).is_valid());
}

#[test]
fn collapsed_facets_are_left_out() {
    let mut cube = cube();
    cube.triangles.push([0, 0, 1]);
    let examination = examine(&cube, &Expectation::default());
    assert_eq!(examination.faults.iter().map(|f| f.check).collect::<Vec<_>>(), ["degenerate facet"]);
    assert!(examination.is_valid());
}

#[test]
fn cracks_differ_from_holes() {
    let cracked = |width: f64| {
        let mut cube = cube();
        let corner = cube.positions[7] + Vector3::new(width, 0.0, 0.0);
        cube.positions.push(corner);
        let facet = cube.triangles.iter().position(|t| t.contains(&7)).unwrap();
        cube.triangles[facet] = cube.triangles[facet].map(|v| if v == 7 { 8 } else { v });
        examine(&cube, &Expectation::default())
    };
    for (width, text) in [(1e-6, "within 1.0e-6 mm"), (3e-4, "within 3.0e-4 mm")] {
        let examination = cracked(width);
        let [crack] = &examination.faults[..] else { panic!("{:?}", examination.faults) };
        assert_eq!((crack.check, crack.level, crack.count), ("crack", Level::Error, 4));
        assert!(crack.detail.contains(text), "{crack}");
        assert_eq!(examination.facts.bodies, 1);
    }
    assert_eq!(cracked(0.1).faults[0].check, "open edge");
}

#[test]
fn the_unit_is_questioned_first() {
    let small = |factor: f64| {
        let mut cone = cone(3000);
        cone.positions.iter_mut().for_each(|p| *p *= factor);
        examine(&cone, &Expectation { min_wall_mm: 0.4, ..Expectation::default() })
    };
    // In metres, and a part in inches with facets finer than any printer.
    for factor in [0.001, 0.04] {
        let examination = small(factor);
        assert_eq!(examination.faults[0].check, "size", "{examination:?}");
        assert!(examination.faults[0].detail.contains("metres"), "{examination:?}");
        assert!(!examination.faults.iter().any(|fault| fault.check == "thin wall"));
    }
}

/// The facets of a part in metres are small, as the part is.
#[test]
fn a_part_in_metres_is_judged_as_in_millimetres() {
    let overlapping = joined(cube(), cube().translated(Vector3::new(3.0, 4.0, 5.0)));
    for (mut mesh, expected) in [(cone(300), &["size"][..]), (overlapping, &["size", "self-intersection"])] {
        assert!(!faults(&mesh).contains(&"size"));
        mesh.positions.iter_mut().for_each(|p| *p *= 1e-6);
        assert_eq!(faults(&mesh), expected);
    }
}
