//! Fuzz targets: one for each reader of `tests/harness/readers.rs`, which defines the conditions for any bytes.

pub use libfuzzer_sys;

#[path = "../../tests/harness/readers.rs"]
pub mod readers;

/// Defines the fuzz target of the reader with this name.
#[macro_export]
macro_rules! target {
    ($name:literal) => {
        $crate::libfuzzer_sys::fuzz_target!(
            // The fuzzer's own hook ends the process at every panic, even one that a reader catches. This hook only prints;
            // an uncaught panic still ends the process.
            init: std::panic::set_hook(Box::new(|panic| eprintln!("{panic}"))),
            |bytes: &[u8]| {
                if let Err(fault) = $crate::readers::judge($name, bytes) {
                    panic!("{fault}");
                }
            }
        );
    };
}
