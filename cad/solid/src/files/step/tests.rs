//! STEP files, read back with a parser that shares no code with the writer.

use super::step_file::{StepError, StepFile, StepSolid};
use super::{StepPart, step_assembly, step_part};
use crate::mesh::Vector3;
use crate::pose::Pose;
use crate::profile::{Contour, Pen, Point2, polar};
use crate::solid::Solid;

/// Largest relative error of the volume with twisted walls. Such a wall joins its arcs at equal
/// angles, its spline at equal parameters, which differ inside of each piece of π/32 (surface.rs).
const TWISTED: f64 = 4e-6;

/// A plate with a hole.
fn plate(chamfer_mm: f64) -> Solid {
    let outline = Contour::polygon(
        [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
    );
    let hole = Contour::circle(Point2::new(8.0, 5.0), 3.0).reversed();
    Solid::prism(&outline, &[hole], 0.0, 5.0, chamfer_mm).unwrap()
}

/// A sector whose ends are parallel to radial planes: its chamfer joins arcs over different angles.
fn twisted_sector() -> Solid {
    let corner = |radius: f64, side: f64| polar(radius, side * (0.78 + libm::asin(4.0 / radius)));
    let outline = Pen::at(corner(27.4, -1.0))
        .line_to(corner(11.5, -1.0))
        .arc_to(Point2::origin(), corner(11.5, 1.0), false)
        .line_to(corner(27.4, 1.0))
        .arc_to(Point2::origin(), corner(27.4, -1.0), true)
        .close();
    Solid::prism(&outline, &[], 0.0, 3.0, 0.2).unwrap()
}

fn text(solid: &Solid) -> String {
    step_part(StepPart { name: "plate", solid }, Vector3::zeros())
}

fn solids(text: &str) -> Result<Vec<StepSolid>, StepError> {
    StepFile::parse(text)?.solids()
}

/// Number of faces of the exact solid: one for each edge of a wall, and the caps.
fn face_count(solid: &Solid) -> usize {
    let rings: Vec<_> = solid.rings().collect();
    let walls: usize = solid.walls().map(|(lower, _)| rings[lower].0.edges().len()).sum();
    walls + solid.caps().count()
}

#[test]
fn a_written_solid_is_exact() {
    for (chamfer_mm, faces) in [(0.0, 8), (0.4, 14)] {
        let solid = plate(chamfer_mm);
        let [read] = &solids(&text(&solid)).unwrap()[..] else { panic!("one solid is written") };
        assert_eq!((read.name.as_str(), read.faces, read.genus), ("plate", faces, 1));
        assert_eq!((face_count(&solid), read.has_splines), (faces, false));
        assert!((read.volume_mm3 / solid.volume_mm3() - 1.0).abs() < 1e-12, "{read:?}");
    }
}

#[test]
fn twisted_walls_keep_their_volume() {
    let solid = twisted_sector();
    let [read] = &solids(&text(&solid)).unwrap()[..] else { panic!("one solid is written") };
    assert_eq!((read.faces, read.genus, read.has_splines), (face_count(&solid), 0, true));
    assert!((read.volume_mm3 / solid.volume_mm3() - 1.0).abs() < TWISTED, "{read:?}");
}

#[test]
fn assemblies_place_their_parts() {
    let solid = plate(0.0);
    let part = StepPart { name: "it's a plate", solid: &solid };
    let poses = [Pose::upright(0.0), Pose { flipped: true, z_mm: 7.0 }];
    let file = StepFile::parse(&step_assembly("two", &poses.map(|pose| (part, pose)))).unwrap();
    assert_eq!(file.solids().unwrap().len(), 2);
    let placements = file.placements().unwrap();
    assert!(placements.iter().all(|placement| placement.name == part.name), "{placements:?}");
    let frames: Vec<_> = placements.iter().map(|p| (p.origin_mm, p.x, p.z)).collect();
    let upright = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(frames, [upright, ([0.0, 0.0, 7.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0])]);
}

/// The reader of these tests refuses what the writer must not write: without that, it would prove
/// nothing.
#[test]
fn damaged_files_are_refused() {
    let whole = text(&plate(0.4));
    let after = |keyword: &str| whole.find(keyword).unwrap() + keyword.len();
    // A radius of the wrong sign.
    let cylinder = after("=CYLINDRICAL_SURFACE(");
    let radius = cylinder + whole[cylinder..].find(");").unwrap();
    let radius = whole[..radius].rfind(',').unwrap() + 1;
    // A shell without its first face.
    let first = after("CLOSED_SHELL('',(");
    let second = first + whole[first..].find(',').unwrap() + 1;
    // A face that is reversed.
    let face = after("=ADVANCED_FACE(");
    let face_end = face + whole[face..].find(';').unwrap();
    let reversed = match whole[face..face_end].strip_suffix(".T.)") {
        Some(rest) => format!("{rest}.F.)"),
        None => whole[face..face_end].replace(".F.)", ".T.)"),
    };
    for (damaged, problem) in [
        (whole[..whole.len() / 2].to_owned(), "sections"),
        (whole.replace(".MILLI.", ".CENTI."), "units"),
        (whole.replace("CLOSED_SHELL", "OPEN_SHELL"), "CLOSED_SHELL"),
        (format!("{}-{}", &whole[..radius], &whole[radius..]), "leaves the surface"),
        (format!("{}{}", &whole[..first], &whole[second..]), "has 1 faces"),
        (format!("{}#99999,{}", &whole[..first], &whole[second..]), "does not exist"),
        (format!("{}{reversed}{}", &whole[..face], &whole[face_end..]), "against the outward normal"),
        (whole.replacen("EDGE_LOOP('',(#", "EDGE_LOOP('',(#1,#", 1), "not one of"),
        (whole.replacen("CARTESIAN_POINT('',(20.0,", "CARTESIAN_POINT('',(20.1,", 1), "line"),
    ] {
        assert_ne!(damaged, whole, "{problem}");
        let error = solids(&damaged).unwrap_err().to_string();
        assert!(error.contains(problem), "{problem}: {error}");
    }
}
