//! Any bytes as an STL: a mesh that can be examined, or one error.
#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use pinswitch_solid::files::read_stl;
use pinswitch_solid::validity::{Expectation, examine};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(stl) = read_stl(&mut Cursor::new(bytes)) {
        let _ = examine(&stl.mesh, &Expectation::default());
    }
});
