//! Times of a batch: counting its variants, checking one, making many with and without equal parts.

#![allow(clippy::expect_used)]

use divan::{Bencher, black_box};
use pinswitch_batch::{
    Destination, Observer, Options, Shard, Sweep, SweepSource, VariantOutcome, Variants, mesh_file,
    partial_folder, run,
};
use pinswitch_switch::design::Design;

fn main() {
    divan::main();
}

/// Five parts a variant, and none of them equal to another variant's.
const DIFFERENT: &str = r#"
[sweep]
base = "three-double"
parts = ["shell", "mould-core", "mould-ring", "support-left", "support-right"]
[axes]
"shell.outer_radius_mm" = { from = 19.5, to = 24.5, count = 20 }
"shell.width_mm" = { from = 13, to = 15, count = 5 }
"#;
/// All parts equal but for their labels.
const EQUAL: &str = r#"
[sweep]
base = "three-double"
parts = ["shell", "mould-core", "mould-ring", "support-left", "support-right"]
[set]
"label.engrave" = false
[axes]
"tendon.length_mm" = { from = 200, to = 299, count = 100 }
"#;
/// A hundred thousand variants.
const MANY: &str = r#"
[axes]
"shell.width_mm" = { from = 13, to = 15, count = 100 }
"tendon.length_mm" = { from = 200, to = 400, count = 1000 }
"#;

fn plan(sweep: &str) -> (Variants, SweepSource) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("sweep.toml");
    std::fs::write(&path, sweep).expect("a file");
    let source = SweepSource::read(&path).expect("a sweep");
    (Variants::new(Sweep::new(&source).expect("a sweep"), &source), source)
}

struct Unwatched;

impl Observer for Unwatched {
    fn variant_done(&self, _: &VariantOutcome) {}
    fn stop_requested(&self) -> bool {
        false
    }
}

fn hundred(bencher: Bencher, sweep: &str) {
    let (variants, source) = plan(sweep);
    let options = Options {
        shard: Shard::WHOLE,
        threads: 0,
        fail_fast: true,
        mesh_maker: mesh_file,
        slicer: None,
        kernel: None,
    };
    bencher.with_inputs(|| tempfile::tempdir().expect("a temporary folder")).bench_local_refs(|folder| {
        let place = folder.path().join("b").display().to_string();
        let destination = Destination::open(&place, &partial_folder(Shard::WHOLE)).expect("a folder");
        run(&variants, &source, &destination, options, &Unwatched).expect("a batch")
    });
}

#[divan::bench]
fn count_and_name_100_000_variants(bencher: Bencher) {
    bencher.bench_local(|| plan(black_box(MANY)));
}

#[divan::bench]
fn check_one_variant(bencher: Bencher) {
    let (variants, _) = plan(DIFFERENT);
    bencher.bench_local(|| Design::new(variants.get(black_box(57)).configuration));
}

#[divan::bench(sample_count = 5)]
fn a_hundred_variants_of_different_parts(bencher: Bencher) {
    hundred(bencher, DIFFERENT);
}

#[divan::bench(sample_count = 5)]
fn a_hundred_variants_of_equal_parts(bencher: Bencher) {
    hundred(bencher, EQUAL);
}
