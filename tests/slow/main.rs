//! Tests that take minutes: the closed loop on many rigs, random configurations, killed batches.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../harness/mod.rs"]
mod harness;
#[path = "../harness/readers.rs"]
mod readers;

mod attributed;
mod batch_kill;
mod bounds;
mod campaign;
mod changed_digits;
mod closed_loop;
mod effects_aside;
mod kills;
mod next_experiment;
mod places;
mod proposals;
mod random_configurations;
mod second_rig;
mod several_sessions;
mod study_tables;
mod undeclared_effect;
