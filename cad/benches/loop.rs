//! Benchmarks of the calibration of a table of 3000 rows, and of the segmentation of a raw log.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::Read;
use std::path::Path;

use divan::{Bencher, black_box};
use pinswitch_calibration::calibrate;
use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::segmentation::{Log, Rig, segment};
use pinswitch_calibration::table::PlateauTable;

fn main() {
    divan::main();
}

/// Returns the unpacked content of a file of `tests/data`.
fn unpack(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name);
    let mut bytes = Vec::new();
    flate2::read::MultiGzDecoder::new(std::fs::File::open(path).expect("test data"))
        .read_to_end(&mut bytes)
        .expect("a gzip file");
    bytes
}

/// At most 2 s on one core.
#[divan::bench(args = ["set-01", "set-04", "set-14", "set-16"], sample_count = 5)]
fn calibration(bencher: Bencher, name: &str) {
    let table = PlateauTable::read(unpack(&format!("{name}.csv.gz")).as_slice(), name).expect("a table");
    let vocabulary = Vocabulary::built_in();
    bencher.bench_local(|| calibrate(black_box(&table.rows), &vocabulary, 1));
}

/// One of 77 logs; at most 3 s for all of them.
#[divan::bench]
fn segmentation_of_one_log(bencher: Bencher) {
    let rig = Rig {
        wrap_angle_deg: 63.89,
        sample_rate_hz: Some(200.0),
        hook_mass_g: 62.53,
        stroke_mm: Some(152.4),
        on_s: Some(0.5),
        dwell_s: Some(3.0),
        ..Rig::default()
    };
    let text = unpack("raw/silicone_5002g.csv.gz");
    bencher.bench_local(|| Log::parse(black_box(&text), "log").map(|log| segment(&log, &rig, None)));
}
