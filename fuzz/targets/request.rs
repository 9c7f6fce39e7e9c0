//! See `tests/harness/readers.rs`.
#![no_main]

pinswitch_fuzz::target!("request");
