//! Fuzz targets: one for each reader of `tests/harness/readers.rs`, which says what must hold.

pub use libfuzzer_sys;

#[path = "../../tests/harness/readers.rs"]
pub mod readers;

/// The target of the reader of this name.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(
            // The hook of the fuzzer ends the process at once, also where a reader catches what a library panics at. What is
            // not caught still ends it.
            init: std::panic::set_hook(Box::new(|panic| eprintln!("{panic}"))),
            |bytes: &[u8]| {
                if let Err(fault) = $crate::readers::judge($name, bytes) {
                    panic!("{fault}");
                }
            }
        );
    };
}
