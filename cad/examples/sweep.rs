//! A sweep in code: every variant of a configuration made in parallel, with one table of all.
//!
//! `cargo run --release --example sweep`

use pinswitch::batch::{
    Destination, Observer, Options, Shard, Sweep, SweepSource, VariantOutcome, Variants, mesh_file,
    partial_folder, run,
};

const SWEEP: &str = r#"
[sweep]
name = "radius-and-pins"
base = "three-double"
parts = ["shell", "support-left", "support-right"]
[axes]
"shell.outer_radius_mm" = { from = 18, to = 22, step = 2 }
"layout.pins" = [[5, 8, 11], [4, 6, 8, 10, 12]]
[[constraints]]
require = "land_on_shell_mm >= 1.0"
because = "a land of two printed lines, and a little"
"#;

/// Prints what was refused; a program with a window would draw its progress here.
struct Printer;

impl Observer for Printer {
    fn variant_done(&self, outcome: &VariantOutcome) {
        if let VariantOutcome::Refused(reason) = outcome {
            println!("refused: {reason}");
        }
    }

    fn stop_requested(&self) -> bool {
        false
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let (file, out) = (folder.path().join("sweep.toml"), folder.path().join("out"));
    std::fs::write(&file, SWEEP)?;

    let source = SweepSource::read(&file)?;
    let variants = Variants::new(Sweep::new(&source)?, &source);
    let destination = Destination::open(&out.to_string_lossy(), &partial_folder(Shard::WHOLE))?;
    let options = Options {
        shard: Shard::WHOLE,
        threads: 0,
        fail_fast: false,
        mesh_maker: mesh_file,
        slicer: None,
        kernel: None,
    };
    let tally = run(&variants, &source, &destination, options, &Printer)?;
    println!("{} made, {} refused, {} failed", tally.made, tally.refused, tally.failed);
    println!("{} part files, {} of them different", tally.parts, tally.distinct_parts);

    let mut table = csv::Reader::from_path(out.join("variants.csv"))?;
    let header = table.headers()?.clone();
    for row in table.records() {
        let row = row?;
        let cell =
            |name: &str| header.iter().zip(&row).find(|(h, _)| *h == name).map_or("", |(_, cell)| cell);
        let shown = ["id", "status", "friction_n", "threshold_n"].map(cell);
        println!("{:40}{:10}{:20}{}", shown[0], shown[1], shown[2], shown[3]);
    }
    Ok(())
}
