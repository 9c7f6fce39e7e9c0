//! Tests with external programs: slicers, mesh checkers, a browser, Slurm, Snakemake, linters. Where its
//! program is absent, a test prints `SKIPPED` and the reason.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../harness/mod.rs"]
mod harness;

mod book;
mod bucket;
mod configurator;
mod data_package;
mod editors;
mod gltf;
mod hardware;
mod judges;
mod recipes;
mod release;
