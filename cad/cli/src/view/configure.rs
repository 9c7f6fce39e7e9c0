//! What the configurator asks of the local server: questions to the engine, the values of the file, and to write them back.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use http_body_util::{BodyExt, Limited};
use hyper::body::{Bytes, Incoming};
use pinswitch_switch::config::{Name, read, rewritten};
use pinswitch_web::{Answer, Engine, Values, configuration, values};
use serde::Deserialize;

use super::stamp;
use crate::input::read_text_file;
use crate::write::write_back;

/// Largest question: a table that is too large is refused by the engine, with what to do instead.
const LARGEST: usize = 64 << 20;

/// The engine, for one question at a time, and the file that may be written.
#[derive(Debug)]
pub(super) struct Configurator {
    engine: Mutex<Engine>,
    file: Option<PathBuf>,
}

/// What is to be written.
#[derive(Deserialize)]
struct Saved {
    values: Values,
    /// The stamp of the file as the page knows it. Another file is written over only if the page has asked.
    #[serde(default)]
    stamp: Option<String>,
}

/// Why nothing was written.
enum NotSaved {
    /// The file is another one than the page knows: its stamp and its values.
    Differs { stamp: String, values: Values },
    /// Anything else.
    Because(String),
}

impl From<String> for NotSaved {
    fn from(reason: String) -> Self {
        Self::Because(reason)
    }
}

/// The body of a question, or why there is none.
pub(super) async fn question(body: Incoming) -> Result<Bytes, String> {
    let body = Limited::new(body, LARGEST).collect().await;
    body.map(http_body_util::Collected::to_bytes)
        .map_err(|_| format!("the question is larger than {} MB", LARGEST >> 20))
}

impl Configurator {
    pub(super) fn new(file: Option<PathBuf>) -> Self {
        Self { engine: Mutex::default(), file }
    }

    /// The name of the file that is followed, as a JSON value.
    pub(super) fn file(&self) -> serde_json::Value {
        self.file.as_ref().map(|file| file.display().to_string()).into()
    }

    /// The engine's answer. It computes beside the server, which goes on answering.
    pub(super) async fn answer(self: Arc<Self>, question: Bytes) -> Answer {
        let answered = tokio::task::spawn_blocking(move || {
            let mut engine = self.engine.lock().unwrap_or_else(PoisonError::into_inner);
            engine.answer(&String::from_utf8_lossy(&question))
        });
        answered.await.unwrap_or_else(|e| Answer::Json(error(&format!("the engine stopped: {e}"))))
    }

    /// Writes values into the file: what it says otherwise, and nothing else. A file that was changed since the page last
    /// read it is left as it is, and told.
    pub(super) fn save(&self, question: &[u8]) -> String {
        match self.saved(question) {
            Ok((file, stamp)) => serde_json::json!({ "saved": file, "stamp": stamp }).to_string(),
            Err(NotSaved::Differs { stamp, values }) => {
                serde_json::json!({ "differs": { "stamp": stamp, "values": values } }).to_string()
            }
            Err(NotSaved::Because(reason)) => error(&reason),
        }
    }

    fn saved(&self, question: &[u8]) -> Result<(String, String), NotSaved> {
        let nothing = || "no file is followed: start `pinswitch view FILE`".to_owned();
        let file = self.file.as_ref().ok_or_else(nothing)?;
        let name = file.display().to_string();
        let saved: Saved = serde_json::from_slice(question).map_err(|e| e.to_string())?;
        let mut configuration = configuration(&saved.values).map_err(|e| e.to_string())?;
        let text = read_text_file(file).map_err(|e| e.message().to_owned())?;
        let (before, places) = read(&text, &name).map_err(|e| e.to_string())?;
        let lent = Name::lent_by(&name);
        let is_lent = !places.sets("switch.name");
        let now = stamp(text.as_bytes());
        if saved.stamp.is_some_and(|known| known != now) {
            let mut before = before;
            if is_lent {
                before.switch.name = lent;
            }
            return Err(NotSaved::Differs { stamp: now, values: values(&before) });
        }
        // The name that the file lent the set is no value that somebody chose.
        if is_lent && configuration.switch.name == lent {
            configuration.switch.name = before.switch.name;
        }
        let text = rewritten(&text, &name, &configuration).map_err(|e| e.to_string())?;
        write_back(file, text.as_bytes()).map_err(|e| e.to_string())?;
        Ok((name, stamp(text.as_bytes())))
    }
}

fn error(reason: &str) -> String {
    serde_json::json!({ "error": reason }).to_string()
}
