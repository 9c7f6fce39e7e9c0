//! What the configurator asks of the local server: questions to the engine, the values of the file, and to write them back.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use http_body_util::{BodyExt, Limited};
use hyper::body::{Bytes, Incoming};
use pinswitch_switch::config::{read, rewritten};
use pinswitch_web::{Answer, Engine, Values, configuration};
use serde::Deserialize;

use crate::input::read_text_file;
use crate::source::lent_name;
use crate::write::write_back;

/// Largest question: a table that is too large is refused by the engine, with what to do instead.
const LARGEST: usize = 64 << 20;

/// The engine, for one question at a time, and the file that may be written.
#[derive(Debug)]
pub(super) struct Configurator {
    engine: Mutex<Engine>,
    file: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Saved {
    values: Values,
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

    /// Writes values into the file: what it says otherwise, and nothing else.
    pub(super) fn save(&self, question: &[u8]) -> String {
        match self.saved(question) {
            Ok(file) => serde_json::json!({ "saved": file }).to_string(),
            Err(reason) => error(&reason),
        }
    }

    fn saved(&self, question: &[u8]) -> Result<String, String> {
        let file = self.file.as_ref().ok_or("no file is followed: start `pinswitch view FILE`")?;
        let name = file.display().to_string();
        let saved: Saved = serde_json::from_slice(question).map_err(|e| e.to_string())?;
        let mut configuration = configuration(&saved.values).map_err(|e| e.to_string())?;
        let text = read_text_file(file).map_err(|e| e.message().to_owned())?;
        let (before, places) = read(&text, &name).map_err(|e| e.to_string())?;
        // The name that the file lent the set is no value that somebody chose.
        if !places.sets("switch.name") && configuration.switch.name == lent_name(&name) {
            configuration.switch.name = before.switch.name;
        }
        let text = rewritten(&text, &name, &configuration).map_err(|e| e.to_string())?;
        write_back(file, text.as_bytes()).map_err(|e| e.to_string())?;
        Ok(name)
    }
}

fn error(reason: &str) -> String {
    serde_json::json!({ "error": reason }).to_string()
}
