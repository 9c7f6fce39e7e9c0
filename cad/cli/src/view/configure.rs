//! What the configurator asks of the local server: questions to the engine, the values of the file, and to write them back.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use http_body_util::{BodyExt, Limited};
use hyper::body::{Bytes, Incoming};
use pinswitch_app::{Answer, Engine, Pace, Values, configuration, pace, values};
use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::config::{Configuration, parameter::Parameter, rewritten};
use serde::Deserialize;

use super::apart::Apart;
use super::stamp;
use crate::input::read_text_file;
use crate::source::Source;
use crate::write::write_back;

/// Largest question: a table that is too large is refused by the engine, with what to do instead.
const LARGEST: usize = 64 << 20;

/// The engines, each for one question at a time, and what the server was started with.
#[derive(Debug)]
pub(super) struct Configurator {
    /// Designs: a page waits for each.
    quick: Mutex<Engine>,
    /// Files, which nobody's sliders wait for.
    files: Mutex<Engine>,
    /// This program, which answers in a process of its own what takes longer; without one the second engine does.
    program: Option<PathBuf>,
    source: Source,
    file: Option<Followed>,
}

/// The file that is followed.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    pub(super) path: PathBuf,
    /// Whether it is a text, into which values can be written.
    pub(super) is_text: bool,
}

/// What is to be written.
#[derive(Deserialize)]
struct Saved {
    values: Values,
    /// The stamp of the file as the page knows it. Another file is written over only if the page has asked.
    #[serde(default)]
    stamp: Option<String>,
    /// Whether a file that is gone is to be written anew.
    #[serde(default)]
    anew: bool,
}

/// What was written.
struct Written {
    file: String,
    stamp: String,
    /// Fields whose new values an option of the command line hides, with that option.
    hidden: Vec<(&'static str, String)>,
}

/// Why nothing was written.
enum NotSaved {
    /// The file is another one than the page knows: its stamp and its values.
    Differs { stamp: String, values: Values },
    /// The file is no longer there.
    Gone,
    /// Anything else.
    Because(String),
}

impl From<String> for NotSaved {
    fn from(reason: String) -> Self {
        Self::Because(reason)
    }
}

/// The body of a question, or why there is none.
pub(super) async fn question(body: Incoming) -> Result<Bytes, Diagnostic> {
    let body = Limited::new(body, LARGEST).collect().await;
    body.map(http_body_util::Collected::to_bytes)
        .map_err(|_| Diagnostic::new(format!("the question is larger than {} MB", LARGEST >> 20)))
}

impl Configurator {
    pub(super) fn new(source: Source, file: Option<Followed>) -> Self {
        let program = std::env::current_exe().ok();
        Self { quick: Mutex::default(), files: Mutex::default(), program, source, file }
    }

    /// What the server was started with, as JSON: the file that is followed, whether it can be saved, and whether the command
    /// line said what to show.
    pub(super) fn beginning(&self) -> serde_json::Value {
        let file = self.file.as_ref();
        serde_json::json!({
            "file": file.map(|file| file.path.display().to_string()),
            "saves": file.is_some_and(|file| file.is_text),
            "said": self.source.has_arguments(),
        })
    }

    /// An engine's answer. It computes beside the server, which goes on answering. A search or a calibration ends where the page
    /// no longer waits for it.
    pub(super) async fn answer(self: Arc<Self>, question: Bytes) -> Answer {
        let pace = pace(&question);
        if let (Pace::Long, Some(program)) = (pace, &self.program) {
            match Apart::start(program) {
                // What ended a process would end the server, or hold up what others ask: it is not tried again here.
                Ok(apart) => return Answer::Json(apart.answer(question).await.unwrap_or_else(stopped)),
                Err(e) => log::warn!("{}: {e}; answering without it", program.display()),
            }
        }
        let answered = tokio::task::spawn_blocking(move || {
            let engine = if pace == Pace::Quick { &self.quick } else { &self.files };
            let mut engine = engine.lock().unwrap_or_else(PoisonError::into_inner);
            engine.answer(&String::from_utf8_lossy(&question))
        });
        answered.await.unwrap_or_else(|e| Answer::Json(stopped(e)))
    }

    /// Writes values into the file: what it says otherwise, and nothing else. A file that was changed since the page last
    /// read it is left as it is, and told.
    pub(super) fn save(&self, question: &[u8]) -> String {
        match self.saved(question) {
            Ok(Written { file, stamp, hidden }) => {
                serde_json::json!({ "saved": file, "stamp": stamp, "hidden": hidden }).to_string()
            }
            Err(NotSaved::Differs { stamp, values }) => {
                serde_json::json!({ "differs": { "stamp": stamp, "values": values } }).to_string()
            }
            Err(NotSaved::Gone) => serde_json::json!({ "gone": true }).to_string(),
            Err(NotSaved::Because(reason)) => error(&reason),
        }
    }

    fn saved(&self, question: &[u8]) -> Result<Written, NotSaved> {
        let nothing = || "no file of text is followed: start `pinswitch view FILE.toml`".to_owned();
        let file = &self.file.as_ref().filter(|file| file.is_text).ok_or_else(nothing)?.path;
        let name = file.display().to_string();
        let saved: Saved = serde_json::from_slice(question).map_err(|e| e.to_string())?;
        let wanted = configuration(&saved.values).map_err(|e| e.to_string())?;
        let is_gone = !file.exists() && !file.is_symlink();
        if is_gone && !saved.anew {
            return Err(NotSaved::Gone);
        }
        let text = if is_gone { Ok(String::new()) } else { read_text_file(file) };
        let text = text.map_err(|e| e.to_string())?;
        // As the page has it: a preset lies under the file, options over it, and its name is that of the file if it has none.
        let shown = self.source.configuration_from(&text).map_err(|e| e.to_string())?;
        let now = stamp(text.as_bytes());
        if !is_gone && saved.stamp.is_some_and(|known| known != now) {
            return Err(NotSaved::Differs { stamp: now, values: values(&shown) });
        }
        let text = rewritten(&text, &name, &shown, &wanted).map_err(|e| e.to_string())?;
        write_back(file, text.as_bytes()).map_err(|e| Diagnostic::from(e).to_string())?;
        let hidden = hidden(&self.source, &shown, &wanted);
        Ok(Written { file: name, stamp: stamp(text.as_bytes()), hidden })
    }
}

/// Options of the command line, and the fields that they give and that were changed nevertheless.
fn hidden(source: &Source, shown: &Configuration, wanted: &Configuration) -> Vec<(&'static str, String)> {
    let differs = |field: &str| {
        let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == field);
        let text = |p: &Parameter<Configuration>, of| (p.get)(of).to_string();
        parameter.is_some_and(|p| text(p, shown) != text(p, wanted))
    };
    source
        .options()
        .filter(|(_, field)| differs(field))
        .map(|(option, field)| (option, field.to_owned()))
        .collect()
}

fn stopped(why: impl std::fmt::Display) -> String {
    error(&format!("the engine stopped: {why}"))
}

fn error(reason: &str) -> String {
    serde_json::json!({ "error": reason }).to_string()
}
