//! What programs say that nobody here wrote: slicers, mesh checkers, a browser, Slurm. Each test says `SKIPPED` and why
//! where its program is absent.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../harness/mod.rs"]
mod harness;

mod bucket;
mod configurator;
mod gltf;
mod hardware;
mod judges;
mod page;
mod recipes;
