//! Our own files read back, and what a STEP file may be wrong about.

use super::*;
use crate::files::{StepPart, step_assembly, step_part};
use crate::pose::Pose;
use crate::profile::{Contour, Pen, Point2, polar};
use crate::solid::Solid;

fn fine() -> ChordTolerance {
    ChordTolerance::new(0.005).unwrap()
}

/// A plate with a hole.
fn plate() -> Solid {
    let corner = |x, y| Point2::new(x, y);
    let outline =
        Contour::polygon(vec![corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 10.0), corner(0.0, 10.0)]);
    let hole = Contour::circle(Point2::new(8.0, 5.0), 3.0).reversed();
    Solid::prism(&outline, &[hole], 0.0, 5.0, 0.0).unwrap()
}

fn text() -> String {
    step_part(StepPart { name: "plate", solid: &plate() })
}

#[test]
fn what_is_written_is_read_with_its_name_place_and_volume() {
    let solid = plate();
    let found = read_step(&text(), fine()).unwrap();
    assert!(found.faults.is_empty() && found.solids.len() == 1, "{found:?}");
    let read = &found.solids[0];
    assert_eq!((read.name.as_str(), read.untriangulated), ("plate", 0));
    assert!(examine(&read.mesh, &Expectation::default()).is_valid());
    let exact = solid.volume_mm3();
    assert!((read.mesh.volume_mm3() / exact - 1.0).abs() < 2e-3, "{} {exact}", read.mesh.volume_mm3());

    let part = StepPart { name: "plate", solid: &solid };
    let two = [(part, Pose::upright(0.0)), (part, Pose::upright(7.0))];
    let found = read_step(&step_assembly("two", &two), fine()).unwrap();
    let mut heights: Vec<f64> =
        found.solids.iter().flat_map(|s| &s.placements).map(|placed| placed[(2, 3)]).collect();
    heights.sort_by(f64::total_cmp);
    assert_eq!(heights, [0.0, 7.0]);
}

#[test]
fn units_are_heard() {
    let volume = |text: &str| read_step(text, fine()).unwrap().solids[0].mesh.volume_mm3();
    let (text, milli) = (text(), ".MILLI.,.METRE.");
    assert!(text.contains(milli));
    let of_mm = volume(&text);
    let centi = volume(&text.replace(milli, ".CENTI.,.METRE."));
    assert!((centi / of_mm - 1e3).abs() < 5.0, "{centi} {of_mm}");
    let refused = |text: &str| read_step(text, fine()).unwrap_err().to_string();
    assert!(refused(&text.replace(milli, ".YOCTO.,.METRE.")).contains("is not known here"));
    assert!(refused(&text.replace("GLOBAL_UNIT_ASSIGNED_CONTEXT", "NOTHING")).contains("no unit of length"));
}

#[test]
fn what_is_broken_is_named() {
    let text = text();
    let refused = |text: &str| read_step(text, fine()).unwrap_err().to_string();
    for cut in [10, text.len() / 2, text.len() - 20] {
        assert!(refused(&text[..cut]).contains("no whole STEP file"), "{cut}");
    }
    assert!(refused(&text.replace("HEADER;", "")).contains("no whole STEP file"));
    assert!(refused(&text.replace("FILE_SCHEMA", "FILE_SCHEMA_")).contains("names no schema"));
    assert!(refused(&text.replace("CYLINDRICAL_SURFACE", "SURFACE_OF_NOTHING")).contains("not read here"));
    // The line is that of the entity, comments and texts with semicolons before it or not.
    let at = text.find("#20=").unwrap();
    let line = text[..at].matches('\n').count() + 2;
    let broken = format!("{}/* a;\n */ {}", &text[..at], text[at..].replacen("#20=", "#20=)", 1));
    let said = refused(&broken);
    assert!(said.contains(&format!("line {line} is no entity: #20=)")), "{said}");
    assert!(refused(&text.replace("AUTOMOTIVE_DESIGN", "IFC4")).contains("its schema is IFC4"));
    // A radius below nothing, and a shell that says that it is open, bound no solid, whatever the facets look like.
    let fault = |text: &str, check: &str| {
        let found = read_step(text, fine()).unwrap();
        found.faults.iter().any(|f| f.check == check)
    };
    let at = text.find("=CYLINDRICAL_SURFACE(").unwrap();
    let end = at + text[at..].find(");").unwrap();
    let radius = at + text[at..end].rfind(',').unwrap() + 1;
    assert!(fault(&format!("{}-{}", &text[..radius], &text[radius..]), "radius"));
    assert!(fault(&text.replace("CLOSED_SHELL", "OPEN_SHELL"), "open shell"));
    // A face that is not there.
    let shell = text.find("CLOSED_SHELL('',(#").unwrap() + "CLOSED_SHELL('',(#".len();
    let end = shell + text[shell..].find(',').unwrap();
    let dangling = format!("{}99999{}", &text[..shell], &text[end..]);
    let found = read_step(&dangling, fine()).unwrap();
    assert_eq!(found.faults[0].check, "reference");
    assert!(!examine(&found.solids[0].mesh, &Expectation::default()).is_valid());
}

#[test]
fn a_long_narrow_twisted_face_is_followed_without_folds() {
    // A sector whose ends lie beside radial planes: its chamfer joins arcs over different angles.
    let corner = |radius: f64, side: f64| polar(radius, side * (0.78 + libm::asin(4.0 / radius)));
    let outline = Pen::at(corner(27.4, -1.0))
        .line_to(corner(11.5, -1.0))
        .arc_to(Point2::origin(), corner(11.5, 1.0), false)
        .line_to(corner(27.4, 1.0))
        .arc_to(Point2::origin(), corner(27.4, -1.0), true)
        .close();
    assert!(outline.area_mm2() > 0.0);
    let solid = Solid::prism(&outline, &[], 0.0, 3.0, 0.2).unwrap();
    let text = step_part(StepPart { name: "plate", solid: &solid });
    assert!(text.contains("RATIONAL_B_SPLINE_SURFACE"));
    let found = read_step(&text, ChordTolerance::new(0.01).unwrap()).unwrap();
    let verdict = examine(&found.solids[0].mesh, &Expectation::default());
    assert!(verdict.is_valid(), "{:?}", verdict.faults);
    assert!((found.solids[0].mesh.volume_mm3() / solid.volume_mm3() - 1.0).abs() < 2e-3);
}

#[test]
fn a_face_that_is_turned_over_stays_a_fault() {
    let text = text();
    let at = text.find("ADVANCED_FACE").unwrap();
    let line_end = text[at..].find(';').unwrap() + at;
    let face = &text[at..=line_end];
    let turned =
        if face.contains(".T.)") { face.replace(".T.)", ".F.)") } else { face.replace(".F.)", ".T.)") };
    let found = read_step(&text.replacen(face, &turned, 1), fine()).unwrap();
    assert!(!examine(&found.solids[0].mesh, &Expectation::default()).is_valid());
}
