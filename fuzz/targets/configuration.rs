//! Any text as a configuration: a design or one error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pinswitch_switch::config::read;
use pinswitch_switch::design::Design;

fuzz_target!(|text: &str| {
    if let Ok((configuration, _)) = read(text, "fuzz.toml") {
        let _ = Design::new(configuration);
    }
});
