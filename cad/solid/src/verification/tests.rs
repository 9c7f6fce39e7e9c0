//! Right meshes are confirmed, wrong ones refused with the quantity that differs.

use super::*;
use crate::mesh::{Mesh, Vector3};
use crate::profile::{ChordTolerance, Contour, Edge, Point2};
use crate::solid::{CapCache, Solid};

fn tolerance() -> ChordTolerance {
    ChordTolerance::new(0.01).unwrap()
}

/// A washer of 8 mm radius.
fn washer() -> Solid {
    let hole = Contour::circle(Point2::origin(), 4.0).reversed();
    Solid::prism(&Contour::circle(Point2::origin(), 8.0), &[hole], 0.0, 2.0, 0.0).unwrap()
}

/// A substitute kernel: polygons with their corners on the curves.
const INSCRIBED: Kernel = Kernel::new("inscribed polygons", |solid, _| {
    let polygon = |contour: &Contour| {
        let points = |edge: &Edge| -> Vec<Point2> {
            let Edge::Arc(arc) = edge else { panic!("a washer has arcs only") };
            (0..50).map(|k| arc.point_at(f64::from(k) / 50.0, arc.radius_mm)).collect()
        };
        Contour::polygon(contour.edges().iter().flat_map(points).collect())
    };
    let mut inscribed = Solid::new();
    let rings: Vec<_> = solid.rings().map(|(contour, z_mm)| inscribed.ring(polygon(contour), z_mm)).collect();
    solid.walls().for_each(|(lower, upper)| inscribed.wall(rings[lower], rings[upper]));
    for (facing, members) in solid.caps() {
        let holes: Vec<_> = members[1..].iter().map(|i| rings[*i]).collect();
        inscribed.cap(facing, rings[members[0]], &holes);
    }
    inscribed
        .mesh_with(tolerance(), &CapCache::new(0))
        .map_err(|e| KernelError { kernel: "inscribed polygons", problem: e.to_string() })
});

/// Every kernel of this build, and the substitute.
fn kernels() -> impl Iterator<Item = Kernel> {
    second_kernel().into_iter().chain([INSCRIBED])
}

fn refusal(mesh: &Mesh, kernel: Kernel) -> VerificationError {
    verify(&washer(), mesh, tolerance(), kernel).unwrap_err()
}

#[test]
fn a_right_mesh_is_confirmed() {
    let solid = washer();
    for kernel in kernels() {
        let mesh = solid.mesh(tolerance()).unwrap();
        let verification = verify(&solid, &mesh, tolerance(), kernel).unwrap();
        assert!(verification.closed);
        for (difference, limit) in [
            (verification.volume_relative, verification.volume_limit),
            (verification.area_relative, verification.area_limit),
            (verification.bounds_mm, verification.bounds_limit_mm),
            (verification.distance_mm[0], verification.distance_limit_mm[0]),
            (verification.distance_mm[1], verification.distance_limit_mm[1]),
        ] {
            assert!(difference > 0.0 && difference <= limit && limit < 0.05, "{verification:?}");
        }
    }
}

#[test]
fn a_moved_vertex_is_refused() {
    for kernel in kernels() {
        let mesh = washer().mesh(tolerance()).unwrap();
        for vertex in [3, mesh.positions.len() / 2 + 5, mesh.positions.len() - 7] {
            let p = mesh.positions[vertex];
            // A vertex may move along its wall. Across it, a right one is within the tolerance on
            // the outer side, so that three times the tolerance may still be within both tolerances
            // on the inner side.
            let radial = Vector3::new(p.x, p.y, 0.0).normalize();
            for by in [radial, -radial, Vector3::z(), -Vector3::z()] {
                let mut moved = mesh.clone();
                moved.positions[vertex] += by * 0.04;
                let error = refusal(&moved, kernel);
                let is_located = matches!(
                    error,
                    VerificationError::Distant { .. }
                        | VerificationError::Differs { quantity: Quantity::LowerBound(_), .. }
                        | VerificationError::Differs { quantity: Quantity::UpperBound(_), .. }
                );
                assert!(is_located, "{error}");
            }
        }
    }
}

#[test]
fn a_scaled_part_is_refused() {
    for kernel in kernels() {
        for factor in [1.002, 0.998] {
            let mut scaled = washer().mesh(tolerance()).unwrap();
            scaled.positions.iter_mut().for_each(|p| *p *= factor);
            let error = refusal(&scaled, kernel);
            assert!(
                !matches!(error, VerificationError::Kernel(_) | VerificationError::Open { .. }),
                "{error}"
            );
        }
    }
}

#[test]
fn a_removed_or_flipped_facet_is_refused() {
    for kernel in kernels() {
        let mut open = washer().mesh(tolerance()).unwrap();
        open.triangles.pop();
        assert_eq!(refusal(&open, kernel), VerificationError::Open { of: "pinswitch" });
        let mut flipped = washer().mesh(tolerance()).unwrap();
        flipped.triangles[0].swap(0, 1);
        assert_eq!(refusal(&flipped, kernel), VerificationError::Open { of: "pinswitch" });
        assert_eq!(refusal(&Mesh::default(), kernel), VerificationError::Open { of: "pinswitch" });
    }
}

#[test]
fn another_solid_is_refused() {
    let disc = Solid::prism(&Contour::circle(Point2::origin(), 8.0), &[], 0.0, 2.0, 0.0).unwrap();
    for kernel in kernels() {
        let error = refusal(&disc.mesh(tolerance()).unwrap(), kernel);
        let VerificationError::Differs { quantity: Quantity::Volume, ours, kernels, limit, .. } = error
        else {
            panic!("{error}")
        };
        assert!((ours - kernels).abs() > limit && limit < 3.0, "{ours} {kernels} {limit}");
        let diagnostic = pinswitch_diagnostic::Diagnostic::from(error);
        assert!(diagnostic.problem().starts_with("volume differs: 402."), "{diagnostic}");
    }
}

#[test]
fn a_failing_kernel_is_an_error() {
    let panics = Kernel::new("panicking", |_, _| panic!("on purpose"));
    let mesh = washer().mesh(tolerance()).unwrap();
    assert!(matches!(refusal(&mesh, panics), VerificationError::Kernel(_)));
    let empty = Kernel::new("empty", |_, _| Ok(Mesh::default()));
    assert_eq!(refusal(&mesh, empty), VerificationError::Open { of: "empty" });
}
