//! A friction switch: its configuration, rules, parts, friction curve and files.
//!
//! The crate does no input or output, reads neither clock nor environment, and starts threads only with the feature
//! `parallel`.
//!
//! Data flows one way: [`config`] → [`design`] → [`parts`] → [`built`] → [`set`], and [`design`] → [`prediction`] → [`set`].
//!
//! ```
//! use pinswitch_switch::{built::Built, config, design::Design, formats, prediction::Prediction, set::Set};
//!
//! let (configuration, _) = config::read("[layout]\npins = [5, 8, 11]\n", "mine.toml")?;
//! let built = Built::new(Design::new(configuration)?)?;
//! let prediction = Prediction::of(built.design());
//! let set = Set::new(&built, &prediction, &formats::named(&["stl", "3mf"])?)?;
//! assert!(set.files.iter().any(|f| f.name == "assembly.3mf"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::disallowed_methods)]

pub mod built;
pub mod config;
pub mod design;
pub mod design_search;
pub mod documents;
pub mod feasibility;
pub mod formats;
pub mod hardware;
pub mod measured;
pub mod output;
mod parallel;
pub mod parts;
pub mod plates;
pub mod prediction;
pub mod process;
pub mod request;
pub mod rig;
pub mod scene;
pub mod set;
pub mod templates;
pub mod tolerances;
pub mod warnings;
