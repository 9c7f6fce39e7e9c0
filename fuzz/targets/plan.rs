//! Any text as the plan of a simulated rig: a plan or one error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pinswitch_simulation::Plan;

fuzz_target!(|text: &str| {
    let _ = Plan::parse(text, "fuzz.toml");
});
