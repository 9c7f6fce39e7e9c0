//! A user-defined part, unrelated to switches: a bracket with rounded corners and a hole.
//!
//! An exact contour becomes a prism, and the prism a mesh. The example checks the mesh, and writes
//! an STL file of the mesh and a STEP file of the exact solid.
//!
//! `cargo run --release --example own_part [FOLDER]`

use std::path::PathBuf;

use pinswitch::solid::files::{StepPart, step_part, stl_bytes};
use pinswitch::solid::mesh::Vector3;
use pinswitch::solid::profile::{ChordTolerance, Contour, Pen, Point2};
use pinswitch::solid::solid::Solid;
use pinswitch::solid::validity::{Expectation, examine};

/// Returns a rectangle about the origin with rounded corners, counter-clockwise.
fn plate(width_mm: f64, depth_mm: f64, corner_mm: f64) -> Contour {
    let (x, y, r) = (width_mm / 2.0, depth_mm / 2.0, corner_mm);
    let at = Point2::new;
    Pen::at(at(r - x, -y))
        .line_to(at(x - r, -y))
        .arc_to(at(x - r, r - y), at(x, r - y), true)
        .line_to(at(x, y - r))
        .arc_to(at(x - r, y - r), at(x - r, y), true)
        .line_to(at(r - x, y))
        .arc_to(at(r - x, y - r), at(-x, y - r), true)
        .line_to(at(-x, r - y))
        .arc_to(at(r - x, r - y), at(r - x, -y), true)
        .close()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    // Outlines are counter-clockwise and holes clockwise: the material is on the left.
    let hole = Contour::circle(Point2::new(5.0, 0.0), 3.4 / 2.0).reversed();
    let bracket = Solid::prism(&plate(30.0, 16.0, 3.0), &[hole], 0.0, 4.0, 0.3)?;
    let mesh = bracket.mesh(ChordTolerance::new(0.01)?)?;

    let exact_mm3 = bracket.volume_mm3();
    let expected =
        Expectation { bodies: Some(1), volume_mm3: Some((exact_mm3, 0.5)), ..Expectation::default() };
    let examination = examine(&mesh, &expected);
    println!("exact volume {exact_mm3:.4} mm3, mesh {:.4} mm3", examination.facts.volume_mm3);
    println!("{} triangles, {} faults", examination.facts.triangles, examination.faults.len());
    examination.faults.iter().for_each(|fault| println!("  {fault}"));

    let step = step_part(StepPart { name: "bracket", solid: &bracket }, Vector3::zeros());
    for (name, bytes) in [("bracket.stl", stl_bytes(&mesh)?), ("bracket.step", step.into_bytes())] {
        let path = folder.join(name);
        std::fs::write(&path, &bytes)?;
        println!("{}: {} bytes", path.display(), bytes.len());
    }
    Ok(())
}
