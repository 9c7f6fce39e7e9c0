//! Reads any STL file, and prints its dimensions and faults.
//!
//! `cargo run --release --example check_stl [FILE]`; without a file it checks a cube with a hole in
//! its surface.

use std::fs::File;
use std::io::{BufReader, Cursor};

use pinswitch::solid::files::{StlFile, read_stl, stl_bytes};
use pinswitch::solid::profile::{ChordTolerance, Contour, Point2};
use pinswitch::solid::solid::Solid;
use pinswitch::solid::validity::{Expectation, examine};

/// Returns a cube without one of its triangles, read from the bytes of its file.
fn broken_cube() -> Result<StlFile, Box<dyn std::error::Error>> {
    let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
    let outline = Contour::polygon(square.map(|(x, y)| Point2::new(x, y)).to_vec());
    let mut mesh = Solid::prism(&outline, &[], 0.0, 10.0, 0.0)?.mesh(ChordTolerance::new(0.01)?)?;
    mesh.triangles.pop();
    Ok(read_stl(&mut Cursor::new(stl_bytes(&mesh)?))?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let stl = match std::env::args_os().nth(1) {
        Some(path) => read_stl(&mut BufReader::new(File::open(path)?))?,
        None => broken_cube()?,
    };
    // Any number of bodies and any volume, but walls of at least 0.4 mm.
    let examination = examine(&stl.mesh, &Expectation { min_wall_mm: 0.4, ..Expectation::default() });
    let facts = &examination.facts;
    println!("{} triangles over {} vertices, {} bodies", facts.triangles, facts.vertices, facts.bodies);
    println!(
        "{:.3} mm3, {:.3} mm2, from {:?} to {:?} mm",
        facts.volume_mm3, facts.surface_mm2, facts.low_mm, facts.high_mm
    );
    if stl.contrary_normals > 0 {
        println!("{} stored normals contradict the order of the vertices", stl.contrary_normals);
    }
    println!("{}", if examination.is_valid() { "valid" } else { "NOT VALID" });
    for fault in &examination.faults {
        // The text begins with `fault.check`, the name of the check; `count` and `at_mm` are
        // further fields.
        println!("  {fault}");
    }
    Ok(())
}
