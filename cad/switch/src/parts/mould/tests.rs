//! The layer that the mould casts, measured on the mesh of the mould.

use proptest::prelude::*;

use super::super::{Part, printed};
use super::{cavity_mm3, one_piece};
use crate::config::{Configuration, MouldKind, assign};
use crate::design::Design;
use crate::prediction::predicted_curve;
use pinswitch_solid::mesh::{Mesh, Point3};
use pinswitch_solid::profile::{ChordTolerance, polar};
use pinswitch_solid::validity::{Expectation, examine};

/// Positions of sections and rays, which avoid vertices at round numbers.
const SHARES: [f64; 5] = [0.0137, 0.2641, 0.5173, 0.7429, 0.9871];

fn moulds() -> impl Strategy<Value = Configuration> {
    let size = (14.0..80.0f64, 20.0..160.0f64, 0.6..4.0f64, 4.0..30.0f64, 0.0..1.0f64);
    let mould = (any::<bool>(), 0.0..=5.0f64, 0.0..=10.0f64, 0.0..3.0f64, 1e-3..0.05f64, any::<bool>());
    (size, mould).prop_map(|((radius, span, under, width, margin), mould)| {
        let (one_piece, draft, overfill, shrinkage, tolerance, chamfered) = mould;
        let mut c = Configuration::default();
        c.shell.outer_radius_mm = radius;
        c.segment.span_deg = span;
        c.segment.grooves = (radius * span.to_radians() / 2.0) as usize;
        c.segment.end_margin_mm = margin;
        c.silicone.thickness_mm = c.segment.groove_radius_mm + under;
        c.shell.width_mm = width;
        c.layout.wrap_angle_deg = c.layout.wrap_angle_deg.min(span);
        c.layout.pins = Vec::new();
        c.mould.kind = if one_piece { MouldKind::OnePiece } else { MouldKind::Split };
        c.mould.draft_deg = draft;
        c.mould.overfill_mm = overfill;
        c.mould.shrinkage_pct = shrinkage;
        c.mesh.chord_tolerance_mm = tolerance;
        c.print.elephant_foot_mm = if chamfered { 0.2 } else { 0.0 };
        c.print.bed_mm = 400.0;
        c.tendon.rope_diameter_mm = 0.6;
        // Rays would hit engraved letters.
        c.label.engrave = false;
        c
    })
}

fn part<'a>(parts: &'a [Part], name: &str) -> &'a Part {
    parts.iter().find(|p| p.name == name).unwrap()
}

/// Distances from the axis at which a ray hits the mesh, ascending.
fn crossings_mm(mesh: &Mesh, angle_rad: f64, z_mm: f64) -> Vec<f64> {
    let origin = Point3::new(0.0, 0.0, z_mm);
    let along = polar(1.0, angle_rad).coords.push(0.0);
    let mut crossings: Vec<f64> = mesh
        .triangles
        .iter()
        .filter_map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let (u, v) = (b - a, c - a);
            let across = along.cross(&v);
            let normal = (origin - a).cross(&u);
            let share = 1.0 / u.dot(&across);
            let (p, q) = ((origin - a).dot(&across) * share, along.dot(&normal) * share);
            let distance = v.dot(&normal) * share;
            (p >= 0.0 && q >= 0.0 && p + q <= 1.0 && distance > 0.0).then_some(distance)
        })
        .collect();
    crossings.sort_by(f64::total_cmp);
    // A ray through an edge hits both of its facets.
    crossings.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    crossings
}

/// Signed area of the section of the mesh at `z_mm`, mm².
fn section_mm2(mesh: &Mesh, z_mm: f64) -> f64 {
    let cut = |from: Point3, to: Point3| from + (to - from) * ((z_mm - from.z) / (to.z - from.z));
    let swept = |t: &[u32; 3]| {
        let corners = t.map(|i| mesh.positions[i as usize]);
        let crossing = |upwards: bool| {
            (0..3).map(|i| (corners[i], corners[(i + 1) % 3])).find_map(|(from, to)| {
                let crosses =
                    if upwards { from.z < z_mm && to.z >= z_mm } else { from.z >= z_mm && to.z < z_mm };
                crosses.then(|| cut(from, to).xy().coords)
            })
        };
        // Viewed from outside, a facet enters the upper half space and leaves it on the right.
        Some(crossing(false)?.perp(&crossing(true)?) / 2.0)
    };
    mesh.triangles.iter().filter_map(swept).sum::<f64>()
}

/// Mesh of the tray or the core, and the height of its floor.
fn mating(design: &Design, parts: &[Part]) -> (Mesh, f64) {
    let name =
        if design.configuration().mould.kind == MouldKind::OnePiece { "mould-tray" } else { "mould-core" };
    (part(parts, name).mesh(design).unwrap(), design.configuration().mould.floor_mm)
}

#[test]
fn draft_changes_the_basin_only() {
    let with = |assignments: &[&str]| {
        let mut c = Configuration::default();
        c.mould.kind = MouldKind::OnePiece;
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        Design::new(c).unwrap()
    };
    let (upright, leaning) = (with(&[]), with(&["mould.draft_deg=3"]));
    assert_eq!(cavity_mm3(&upright).0, cavity_mm3(&leaning).0);
    assert!(cavity_mm3(&upright).1 < cavity_mm3(&leaning).1);
    assert_eq!(predicted_curve(&upright), predicted_curve(&leaning));
    assert_eq!(upright.warnings(), leaning.warnings());
    // Without a basin, a warning reports that draft is ineffective.
    let flush = with(&["mould.draft_deg=3", "mould.overfill_mm=0"]);
    assert!(
        flush.warnings().iter().any(|w| w.text().contains("mould.draft_deg = 3 has no effect")),
        "{:?}",
        flush.warnings()
    );
    let (flat, flush) = (with(&["mould.overfill_mm=0"]), one_piece(&flush).unwrap());
    assert_eq!(one_piece(&flat).unwrap().solid, flush.solid);
}

/// Also walls that draft or a chamfer twists: the error is at most proportional to the tolerance.
#[test]
fn meshes_of_the_mould_converge_to_its_volume() {
    for (kind, draft) in [("one-piece", 3.0), ("one-piece", 5.0), ("split", 0.0)] {
        let mut c = Configuration::default();
        let leaning = format!("mould.draft_deg={draft:?}");
        let kind = format!("mould.kind={kind}");
        for assignment in [&kind, &leaning, "mould.overfill_mm=10", "print.elephant_foot_mm=0.2"] {
            assign(&mut c, assignment).unwrap();
        }
        let design = Design::new(c).unwrap();
        for part in printed(&design).unwrap().iter().filter(|p| p.name.starts_with("mould")) {
            let exact = part.solid.volume_mm3();
            for tolerance_mm in [0.05, 5e-3, 5e-4, 1e-4] {
                let tolerance = ChordTolerance::new(tolerance_mm).unwrap();
                let off = part.solid.mesh(tolerance).unwrap().volume_mm3() / exact - 1.0;
                assert!(off.abs() <= 0.02 * tolerance_mm, "{}: {off} at {tolerance_mm}", part.name);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// The inner face of the layer has one radius over its width, and the layer has its thickness.
    #[test]
    fn the_cast_layer_fits_the_shell(configuration in moulds()) {
        let Ok(design) = Design::new(configuration) else { return Err(TestCaseError::reject("no such design")) };
        let c = design.configuration();
        let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
        let depth_mm = design.layer_width_mm() * scale;
        let parts = printed(&design).unwrap();
        let (mesh, floor_mm) = mating(&design, &parts);
        for across in [-0.913, -0.37, 0.011, 0.641, 0.957] {
            let angle = across * design.half_span_rad();
            let radii = SHARES.map(|share| crossings_mm(&mesh, angle, floor_mm + share * depth_mm)[1]);
            for radius in radii {
                prop_assert!((radius - radii[0]).abs() < 1e-9, "{radii:?} over the width");
                let off = radius / scale - design.shell_radius_mm();
                prop_assert!(off.abs() <= c.mesh.chord_tolerance_mm, "{off} off the shell");
            }
        }
        if c.mould.kind == MouldKind::Split {
            return Ok(());
        }
        // Thickness on the lands between grooves, and beyond the outermost.
        let pitch = 2.0 * design.half_span_rad() / c.segment.grooves as f64;
        for land in 0..=c.segment.grooves {
            let nearly = (land as f64 * pitch - design.half_span_rad()) * 0.9999;
            for share in SHARES {
                let radii = crossings_mm(&mesh, nearly, floor_mm + share * depth_mm);
                let off = (radii[2] - radii[1]) / scale - c.silicone.thickness_mm;
                prop_assert!(off.abs() <= 2.0 * c.mesh.chord_tolerance_mm, "{off} too thick");
            }
        }
    }

    /// The cavity of the mesh has the volume of the layer in the bill of materials.
    #[test]
    fn the_cavity_has_the_volume_of_the_bill(configuration in moulds()) {
        let configuration = Configuration {
            mould: crate::config::MouldTable { kind: MouldKind::OnePiece, ..configuration.mould },
            ..configuration
        };
        let Ok(design) = Design::new(configuration) else { return Err(TestCaseError::reject("no such design")) };
        let c = design.configuration();
        let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
        let (layer_mm3, basin_mm3) = cavity_mm3(&design);
        let nominal = super::super::silicone_layer(&design).unwrap().solid.volume_mm3();
        prop_assert!((layer_mm3 / nominal / scale.powi(3) - 1.0).abs() < 1e-12);
        let parts = printed(&design).unwrap();
        let (mesh, floor_mm) = mating(&design, &parts);
        let (depth_mm, body_mm2) = (design.layer_width_mm() * scale, section_mm2(&mesh, 0.5 * floor_mm));
        for share in SHARES {
            let open_mm2 = body_mm2 - section_mm2(&mesh, floor_mm + share * depth_mm);
            // Only arcs that are too flat to be split lose area.
            prop_assert!((open_mm2 * depth_mm / layer_mm3 - 1.0).abs() < 3e-4, "{open_mm2}");
        }
        // Simpson's rule over the basin: its section is quadratic in height.
        let at = |share: f64| body_mm2 - section_mm2(&mesh, floor_mm + depth_mm + share * c.mould.overfill_mm);
        if c.mould.overfill_mm > 0.01 {
            let mean = (at(1e-9) + 4.0 * at(0.5) + at(1.0 - 1e-9)) / 6.0;
            let off = (mean * c.mould.overfill_mm - basin_mm3).abs();
            prop_assert!(off <= 2.0 * c.mesh.chord_tolerance_mm * basin_mm3 / (c.silicone.thickness_mm / 2.0), "{off}");
        }
    }

    /// The volume of the mesh of every part of the mould is within the bound of the tolerance.
    #[test]
    fn meshes_of_the_mould_keep_its_volume(configuration in moulds()) {
        let Ok(design) = Design::new(configuration) else { return Err(TestCaseError::reject("no such design")) };
        for part in printed(&design).unwrap().iter().filter(|p| p.name.starts_with("mould")) {
            let exact = part.solid.volume_mm3();
            for tolerance_mm in [0.05, 5e-3, 5e-4] {
                let tolerance = ChordTolerance::new(tolerance_mm).unwrap();
                let off = (part.solid.mesh(tolerance).unwrap().volume_mm3() - exact).abs();
                let bound = part.solid.volume_bound_mm3(tolerance);
                prop_assert!(off <= bound, "{}: {off} at {tolerance_mm}, bound {bound}", part.name);
            }
        }
    }
}

#[test]
fn thick_end_walls_have_no_sharp_corners() {
    for set in
        [&["mould.wall_mm=8"][..], &["mould.wall_mm=5", "shell.wall_mm=11"], &["segment.end_margin_mm=5"]]
    {
        let mut c = Configuration::default();
        set.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c).unwrap();
        for part in [super::split::core(&design), super::split::ring(&design), super::lid::lid(&design)] {
            let part = part.unwrap();
            let mesh = part.solid.mesh(design.tolerance()).unwrap();
            let report = examine(&mesh, &Expectation { min_wall_mm: 0.4, ..Expectation::default() });
            assert!(report.is_flawless(), "{set:?}, {}: {:?}", part.name, report.faults);
        }
    }
}
