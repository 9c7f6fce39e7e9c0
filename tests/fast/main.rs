//! Everything that takes seconds: the real binary end to end, the bytes it writes, what README and documents say.
//!
//! A new test goes here unless it takes more than some seconds (`slow`) or needs a program that nobody here wrote
//! (`programs`). tests/README.md says which file protects what.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../harness/mod.rs"]
mod harness;
#[path = "../harness/readers.rs"]
mod readers;

mod bad_input;
mod batch;
mod batch_bad_input;
mod batch_damage;
mod command_line;
mod corpus;
mod documents;
mod few_series;
mod finger;
mod fit;
mod formats;
mod golden;
mod implausible_tables;
mod input_files;
mod inverse;
mod next_experiment;
mod own_effects;
mod pictures;
mod readme;
mod reference_shell;
mod segment_raw;
mod several_sessions;
mod slicing;
mod solid_files;
mod table_columns;
mod verification;
mod view;
mod writing;
