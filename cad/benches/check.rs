//! Benchmarks of `pinswitch check` on meshes of other programs: read a large binary STL, and check
//! it.

#![allow(clippy::expect_used, clippy::cast_precision_loss)]

use std::f64::consts::TAU;
use std::io::Cursor;

use divan::{Bencher, black_box};
use pinswitch_solid::files::{read_stl, stl_bytes};
use pinswitch_solid::mesh::{Mesh, Point3};
use pinswitch_solid::validity::{Expectation, examine};

fn main() {
    divan::main();
}

/// Returns a closed wavy torus of `2 * around * across` triangles.
fn torus(around: u32, across: u32) -> Mesh {
    let at = |i: u32, j: u32| {
        let (u, v) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
        let tube = 10.0 + (9.0 * u).sin() * (7.0 * v).cos();
        let out = 30.0 + tube * v.cos();
        Point3::new(out * u.cos(), out * u.sin(), tube * v.sin())
    };
    let number = |i: u32, j: u32| i % around * across + j % across;
    let squares = || (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    let triangles = squares().flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(squares().map(|(i, j)| at(i, j)).collect(), triangles.collect())
}

/// Numbers of squares around and across the torus: compact triangles, and long thin ones.
const SQUARES: [(u32, u32); 3] = [(40, 25), (1000, 500), (20_000, 25)];

#[divan::bench(args = SQUARES, sample_count = 5)]
fn read(bencher: Bencher, (around, across): (u32, u32)) {
    let bytes = stl_bytes(&torus(around, across)).expect("writing to memory");
    bencher.bench_local(|| read_stl(&mut Cursor::new(black_box(&bytes))));
}

#[divan::bench(args = SQUARES, sample_count = 5)]
fn examination(bencher: Bencher, (around, across): (u32, u32)) {
    let mesh = torus(around, across);
    let expected = Expectation { min_wall_mm: 0.4, ..Expectation::default() };
    bencher.bench_local(|| examine(black_box(&mesh), &expected));
}

#[divan::bench(args = SQUARES, sample_count = 5)]
fn intersections_left_out(bencher: Bencher, (around, across): (u32, u32)) {
    let mesh = torus(around, across);
    let expected = Expectation { intersections: false, ..Expectation::default() };
    bencher.bench_local(|| examine(black_box(&mesh), &expected));
}
