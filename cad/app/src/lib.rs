//! The engine of the configurator: a page sends requests in JSON and gets JSON or the bytes of a
//! file.
//!
//! One engine serves two front ends. Compiled to WebAssembly it runs in a worker of the page; with
//! the feature `server` it runs behind the local server of `pinswitch view` (`server::Server`).
//! Both return the files of `pinswitch generate`, byte for byte. `cad/doc/configurator.md` lists
//! the requests.
//!
//! # Vocabulary
//!
//! - [`Engine`] answers requests, one at a time, and keeps the parts and curves of the last
//!   designs.
//! - [`Answer`] is JSON or the content of a file.
//! - [`Values`] are the values of a configuration that differ from the defaults, by `table.key`;
//!   [`configuration`] and [`changed_values`] convert them.
//! - [`CalibratedSwitch`] and [`calibrated_curve`] apply a calibrated model to a design whose
//!   dimensions differ from the rig's.
//! - [`shared_texts`] clears texts in the module that the page (`pinswitch_switch::formats::page`) also contains.
//!
//! # Examples
//!
//! A design, and one of its files:
//!
//! ```
//! use pinswitch_app::{Answer, Engine};
//!
//! let mut engine = Engine::default();
//! let Answer::Json(text) = engine.answer(r#"{"command": "design", "values": {"layout.pins": [5, 8, 11]}}"#) else {
//!     return Err("a design is JSON");
//! };
//! assert!(text.contains(r#""trouble":null"#));
//! let shell = engine.answer(r#"{"command": "file", "values": {"layout.pins": [5, 8, 11]}, "name": "shell.stl"}"#);
//! assert!(matches!(shell, Answer::Bytes(_)));
//! # Ok::<(), &str>(())
//! ```
//!
//! Values of the page and a configuration:
//!
//! ```
//! use pinswitch_app::{Values, changed_values, configuration};
//!
//! let values: Values = [("shell.width_mm".to_owned(), 12.5.into())].into();
//! let configuration = configuration(&values)?;
//! assert_eq!(configuration.shell.width_mm, 12.5);
//! assert_eq!(changed_values(&configuration), values);
//! # Ok::<(), pinswitch_switch::config::ConfigError>(())
//! ```

mod bench;
mod cache;
mod calibrated_curve;
mod calibrated_switch;
mod calibration;
mod design;
mod design_search;
mod facts;
mod files;
mod measurement_file;
#[cfg(target_arch = "wasm32")]
mod module;
mod next_runs;
mod prediction_cache;
mod reach;
mod refusal;
mod request;
#[cfg(feature = "server")]
pub mod server;
pub mod shared_texts;
mod template_curves;
mod values;

use cache::Cache;
use files::FileSet;
use request::Request;
use serde::Serialize;

pub use calibrated_curve::{calibrated_curve, calibrated_curve_at};
pub use calibrated_switch::CalibratedSwitch;
pub use pinswitch_switch::formats::page::{Values, changed_values};
pub use values::configuration;

/// The answer to a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// JSON.
    Json(String),
    /// The content of a file.
    Bytes(Vec<u8>),
}

impl Answer {
    /// Returns `{"error": "..."}`, the answer to a request that cannot be answered.
    fn error(reason: impl std::fmt::Display) -> Self {
        Self::Json(serde_json::json!({ "error": reason.to_string() }).to_string())
    }

    fn json(value: &impl Serialize) -> Self {
        serde_json::to_string(value).map_or_else(Self::error, Self::Json)
    }
}

/// Answers requests, one at a time.
///
/// An engine keeps the files of the last design, since a page requests several in a row, and curves
/// and parts, since most changes of a design leave them unchanged.
#[derive(Debug, Default)]
pub struct Engine {
    files: Option<FileSet>,
    cache: Cache,
}

impl Engine {
    /// Returns the answer to a request in JSON; `{"error": "..."}` if it cannot be answered.
    pub fn answer(&mut self, request: &str) -> Answer {
        let request = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(e) => return Answer::error(format!("invalid request: {e}")),
        };
        match request {
            Request::Facts => Answer::json(&facts::facts()),
            Request::Templates => Answer::json(&template_curves::answer()),
            Request::Design { design, quality } => {
                Answer::json(&design::answer(&mut self.cache, &design, quality))
            }
            Request::Reach { values, field } => Answer::json(&reach::answer(&values, &field)),
            Request::Open { toml, file } => Answer::json(&values::open(&toml, &file)),
            Request::Files { design } => self.with_files(&design, FileSet::list),
            Request::File { design, name } => self.with_files(&design, |files| files.content(&name)),
            Request::Zip { design } => self.with_files(&design, FileSet::zip),
            Request::Search(request) => design_search::answer(&request),
            Request::Model { toml, file } => Answer::json(&calibration::check_model(&toml, &file)),
            Request::Import { data, file, set } => measurement_file::answer(&data, &file, &set),
            Request::Calibrate { csv, file } => calibration::answer(&csv, &file),
            Request::Sample => calibration::sample(),
            Request::Experiment { csv, file, minutes } => next_runs::answer(&csv, &file, minutes),
        }
    }
}
