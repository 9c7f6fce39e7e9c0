//! Benchmarks of a set, step by step: solids, mesh, mesh check, STL bytes, friction curve, and the
//! whole set.

#![allow(clippy::expect_used)]

use divan::{Bencher, black_box};
use pinswitch_cli::write::write_set;
use pinswitch_solid::files::stl_bytes;
use pinswitch_solid::validity::{Expectation, examine};
use pinswitch_switch::built::Built;
use pinswitch_switch::config::{Configuration, assign};
use pinswitch_switch::design::Design;
use pinswitch_switch::formats::{ALL, named};
use pinswitch_switch::parts::{Part, printed};
use pinswitch_switch::prediction::{Prediction, predicted_curve};
use pinswitch_switch::set::Set;

fn main() {
    divan::main();
}

fn design() -> Design {
    let mut configuration = Configuration::default();
    assign(&mut configuration, "layout.pins=[5, 8, 11]").expect("a shipped layout");
    Design::new(configuration).expect("a shipped layout")
}

fn shell(design: &Design) -> Part {
    printed(design).expect("a shipped layout").swap_remove(0)
}

#[divan::bench]
fn solids_of_all_parts(bencher: Bencher) {
    let design = design();
    bencher.bench_local(|| printed(black_box(&design)));
}

#[divan::bench]
fn shell_mesh(bencher: Bencher) {
    let design = design();
    let shell = shell(&design);
    bencher.bench_local(|| shell.mesh(black_box(&design)));
}

#[divan::bench]
fn shell_stl_bytes(bencher: Bencher) {
    let design = design();
    let mesh = shell(&design).mesh(&design).expect("a valid part");
    bencher.bench_local(|| stl_bytes(black_box(&mesh)));
}

#[divan::bench]
fn shell_oracle_without_intersections(bencher: Bencher) {
    let design = design();
    let mesh = shell(&design).mesh(&design).expect("a valid part");
    let expected = Expectation { intersections: false, ..Expectation::default() };
    bencher.bench_local(|| examine(black_box(&mesh), &expected));
}

#[divan::bench]
fn shell_oracle_with_intersections(bencher: Bencher) {
    let design = design();
    let mesh = shell(&design).mesh(&design).expect("a valid part");
    bencher.bench_local(|| examine(black_box(&mesh), &Expectation::default()));
}

#[divan::bench]
fn friction_curve(bencher: Bencher) {
    let design = design();
    bencher.bench_local(|| predicted_curve(black_box(&design)));
}

/// Makes the set of a design in these formats.
fn set(design: &Design, formats: &[&str]) -> Set {
    let built = Built::new(design.clone()).expect("a valid design");
    let prediction = Prediction::of(design);
    Set::new(&built, &prediction, &named(formats).expect("known formats")).expect("a valid set")
}

#[divan::bench(args = ["stl", ALL])]
fn whole_set_in_memory(bencher: Bencher, format: &str) {
    let design = design();
    bencher.bench_local(|| set(black_box(&design), &[format]));
}

#[divan::bench]
fn whole_set_written(bencher: Bencher) {
    let design = design();
    let folder = tempfile::tempdir().expect("a temporary folder");
    bencher.bench_local(|| write_set(folder.path(), &set(black_box(&design), &["stl"]).files));
}
