//! Any text as a model file: a model or one error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pinswitch_calibration::ModelFile;

fuzz_target!(|text: &str| {
    let _ = ModelFile::parse(text, "fuzz.toml");
});
