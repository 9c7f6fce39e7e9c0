//! Tests that take seconds: the binary end to end, the bytes that it writes, and the claims of
//! README and the documents.
//!
//! A new test belongs here unless it takes more than some seconds (`slow`) or needs another program
//! (`programs`). tests/README.md lists what each file protects.

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
mod explain;
mod export;
mod few_series;
mod finger;
mod fit;
mod formats;
mod golden;
mod implausible_tables;
mod import;
mod input_files;
mod inverse;
mod laboratories;
mod mesh_files;
mod next_experiment;
mod own_effects;
mod pictures;
mod predict_rows;
mod process;
mod provenance;
mod readme;
mod reference_shell;
mod release;
mod report_documents;
mod report_schemas;
mod rig_set;
mod schemas;
mod segment_raw;
mod several_sessions;
mod slicing;
mod small_bench;
mod solid_files;
mod structure;
mod table_columns;
mod terminal;
mod tolerances;
mod transactions;
mod verification;
mod view;
mod writing;
