//! Any bytes as a table of plateaus: rows or one error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pinswitch_calibration::table::PlateauTable;

fuzz_target!(|bytes: &[u8]| {
    let _ = PlateauTable::read(bytes, "fuzz.csv");
});
