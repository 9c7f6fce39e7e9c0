//! The engine of the configurator: a page asks, in JSON, and is answered with JSON or with the bytes of files. The same
//! engine runs in a worker of the page, compiled to WebAssembly, and behind the local server of `pinswitch view`; the
//! files are those of the command line, byte for byte. `cad/doc/configurator.md` lists the questions.
//!
//! ```
//! use pinswitch_app::{Answer, Engine};
//!
//! let mut engine = Engine::default();
//! let Answer::Json(text) = engine.answer(r#"{"ask": "design", "values": {"layout.pins": [5, 8, 11]}}"#) else {
//!     return Err("a design is told in JSON");
//! };
//! assert!(text.contains(r#""trouble":null"#));
//! let bytes = engine.answer(r#"{"ask": "file", "values": {"layout.pins": [5, 8, 11]}, "name": "shell.stl"}"#);
//! assert!(matches!(bytes, Answer::Bytes(_)));
//! # Ok::<(), &str>(())
//! ```

mod calibrated_curve;
mod calibrated_switch;
mod calibration;
mod design;
mod facts;
mod files;
mod kept;
#[cfg(target_arch = "wasm32")]
mod module;
pub mod page;
mod predicted;
mod request;
mod search;
pub mod slim;
mod trouble;
mod values;

use files::Made;
use kept::Kept;
use request::Request;
use serde::Serialize;

pub use calibrated_curve::calibrated_curve;
pub use calibrated_switch::CalibratedSwitch;
pub use request::{Pace, Values, pace};
pub use values::{configuration, values};

/// What a question is answered with.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// JSON.
    Json(String),
    /// The content of a file.
    Bytes(Vec<u8>),
}

impl Answer {
    /// The answer to a question that has none, with the reason.
    fn error(reason: impl std::fmt::Display) -> Self {
        Self::Json(serde_json::json!({ "error": reason.to_string() }).to_string())
    }

    fn json(value: &impl Serialize) -> Self {
        serde_json::to_string(value).map_or_else(Self::error, Self::Json)
    }
}

/// Answers questions, one at a time; keeps the files of the last design, since several are asked for in a row, and its curve,
/// since most changes leave it as it is.
#[derive(Debug, Default)]
pub struct Engine {
    made: Option<Made>,
    kept: Kept,
}

impl Engine {
    /// The answer to a question in JSON; what cannot be answered says why, as `{"error": "..."}`.
    pub fn answer(&mut self, question: &str) -> Answer {
        let request = match serde_json::from_str(question) {
            Ok(request) => request,
            Err(e) => return Answer::error(format!("the question is none: {e}")),
        };
        match request {
            Request::Facts => Answer::json(&facts::facts()),
            Request::Design { design, quality } => {
                Answer::json(&design::answer(&mut self.kept, &design, quality))
            }
            Request::Open { toml, file } => Answer::json(&values::opened(&toml, &file)),
            Request::Files { design } => self.files(&design, |made| made.list()),
            Request::File { design, name } => self.files(&design, |made| made.file(&name)),
            Request::Zip { design } => self.files(&design, Made::zip),
            Request::Search(wanted) => search::answer(&wanted),
            Request::Model { toml, file } => Answer::json(&calibration::checked_model(&toml, &file)),
            Request::Calibrate { csv, file } => calibration::answer(&csv, &file),
        }
    }
}
