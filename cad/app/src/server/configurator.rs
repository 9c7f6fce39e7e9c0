//! Requests of the configurator to the server: answers of the engine, and values to write into the
//! file.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

use hyper::body::Bytes;
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_switch::config::{Configuration, parameter::Parameter, rewritten};
use serde::Deserialize;
use tokio::sync::Semaphore;

use super::state::stamp;
use super::worker::Worker;
use super::{ConfigurationSource, SourceWriteError};
use crate::{Answer, Engine, Values, changed_values, configuration};

/// The engines, each for one request at a time, and the configuration that the server shows.
#[derive(Debug)]
pub(super) struct Configurator {
    /// Engine of designs: a page waits for each.
    designs: Mutex<Engine>,
    /// Engine of files, which take longer than a drag of a slider can wait.
    files: Mutex<Engine>,
    source: Arc<dyn ConfigurationSource>,
    /// Processes for long requests that may still be started.
    workers: Semaphore,
    /// Whether values can be written into the followed file.
    is_writable: bool,
}

/// Most processes for long requests at once.
const MAX_WORKERS: usize = 4;

/// How long a request takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Workload {
    /// Some hundredths of a second.
    Design,
    /// The files of a design: under a second.
    Files,
    /// A search or a calibration: seconds, minutes for a long table.
    Long,
}

impl Workload {
    /// Returns the workload of a request; an invalid request is answered as quickly as a design.
    fn of(request: &[u8]) -> Self {
        #[derive(Deserialize)]
        struct Kind<'a> {
            #[serde(borrow)]
            command: Cow<'a, str>,
        }
        match serde_json::from_slice::<Kind<'_>>(request).as_ref().map(|kind| &*kind.command) {
            Ok("search" | "calibrate" | "import" | "experiment") => Self::Long,
            Ok("files" | "file" | "zip") => Self::Files,
            _ => Self::Design,
        }
    }
}

/// Values to write into the file.
#[derive(Deserialize)]
struct SaveRequest {
    values: Values,
    /// Stamp of the file as the page knows it; a file with another stamp is overwritten only if the
    /// user agreed.
    #[serde(default)]
    stamp: Option<String>,
    /// Whether to create the file if it is missing.
    #[serde(default)]
    create: bool,
}

/// A file that was written.
struct SavedFile {
    file: String,
    stamp: String,
    /// Options that override changed fields, each with the field.
    overridden: Vec<(String, String)>,
}

/// Why no file was written.
enum SaveError {
    /// The file has another stamp than the page expects; its values.
    Changed { stamp: String, values: Values },
    /// The file is missing.
    Missing,
    /// Another reason.
    Other(Diagnostic),
}

impl From<Diagnostic> for SaveError {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Other(diagnostic)
    }
}

impl Configurator {
    pub(super) fn new(source: Arc<dyn ConfigurationSource>, is_writable: bool) -> Self {
        Self {
            designs: Mutex::default(),
            files: Mutex::default(),
            source,
            workers: Semaphore::new(MAX_WORKERS),
            is_writable,
        }
    }

    /// Describes what the server shows, as JSON: the followed file, whether it can be written, and
    /// whether the user named it.
    pub(super) fn source_json(&self) -> serde_json::Value {
        serde_json::json!({
            "file": self.source.file().map(|file| file.display().to_string()),
            "is_writable": self.is_writable,
            "is_explicit": self.source.is_explicit(),
        })
    }

    /// Returns the engine's answer, computed outside of the server's thread. A search or a
    /// calibration ends when the page stops waiting for it.
    pub(super) async fn answer(self: Arc<Self>, request: Bytes) -> Answer {
        let workload = Workload::of(&request);
        if let (Workload::Long, Some(command)) = (workload, self.source.worker()) {
            // Others wait for their turn, or until their page goes away.
            let _turn = self.workers.acquire().await;
            let program = command.get_program().to_string_lossy().into_owned();
            match Worker::start(command) {
                // No second attempt here: what ended a process could end the server, or delay other
                // requests.
                Ok(worker) => {
                    return Answer::Json(worker.answer(request).await.unwrap_or_else(engine_stopped));
                }
                Err(e) => log::warn!("cannot start {program}: {e}; the server computes the answer itself"),
            }
        }
        let answer = tokio::task::spawn_blocking(move || {
            let engine = if workload == Workload::Design { &self.designs } else { &self.files };
            let mut engine = engine.lock().unwrap_or_else(PoisonError::into_inner);
            engine.answer(&String::from_utf8_lossy(&request))
        });
        answer.await.unwrap_or_else(|e| Answer::Json(engine_stopped(e)))
    }

    /// Writes changed values into the file, outside of the server's thread, and returns the result as JSON.
    /// A file that has changed since the page last read it stays unchanged; its stamp and values are
    /// returned.
    pub(super) async fn save(self: Arc<Self>, request: Bytes) -> String {
        let saved = tokio::task::spawn_blocking(move || self.saved(&request)).await;
        saved.unwrap_or_else(|e| error_json(&format!("the file is not saved: {e}")))
    }

    fn saved(&self, request: &[u8]) -> String {
        match self.write(request) {
            Ok(SavedFile { file, stamp, overridden }) => {
                serde_json::json!({ "saved": file, "stamp": stamp, "overridden": overridden }).to_string()
            }
            Err(SaveError::Changed { stamp, values }) => {
                serde_json::json!({ "changed": { "stamp": stamp, "values": values } }).to_string()
            }
            Err(SaveError::Missing) => serde_json::json!({ "missing": true }).to_string(),
            Err(SaveError::Other(diagnostic)) => error_json(&diagnostic.to_string()),
        }
    }

    fn write(&self, request: &[u8]) -> Result<SavedFile, SaveError> {
        let file = self.source.file().filter(|_| self.is_writable).ok_or_else(|| {
            Diagnostic::new(codes::NOT_SAVED, "the server follows no text file")
                .with_help("start `pinswitch view FILE.toml`")
        })?;
        let name = file.display().to_string();
        let request: SaveRequest =
            serde_json::from_slice(request).map_err(|e| Diagnostic::from_error(codes::DAMAGED_FILE, e))?;
        let wanted = configuration(&request.values)?;
        let is_missing = !file.exists() && !file.is_symlink();
        if is_missing && !request.create {
            return Err(SaveError::Missing);
        }
        let text = if is_missing { String::new() } else { self.source.read_text()? };
        // With preset, options and the name from the file name, as in the page.
        let shown = self.source.configuration(&text)?;
        let current = stamp(text.as_bytes());
        if !is_missing && request.stamp.is_some_and(|known| known != current) {
            return Err(SaveError::Changed { stamp: current, values: changed_values(&shown) });
        }
        let before = text;
        let text = rewritten(&before, &name, &shown, &wanted)?;
        match self.source.write((!is_missing).then_some(&*before), &text) {
            Ok(()) => {}
            Err(SourceWriteError::Failed(diagnostic)) => return Err(SaveError::Other(diagnostic)),
            // An editor saved between the two.
            Err(SourceWriteError::Changed) => {
                let text = self.source.read_text()?;
                let values = changed_values(&self.source.configuration(&text)?);
                return Err(SaveError::Changed { stamp: stamp(text.as_bytes()), values });
            }
        }
        let overridden = self.overridden(&shown, &wanted);
        Ok(SavedFile { file: name, stamp: stamp(text.as_bytes()), overridden })
    }

    /// Returns the options that override a field whose value the page changed, each with the field.
    fn overridden(&self, shown: &Configuration, wanted: &Configuration) -> Vec<(String, String)> {
        let is_changed = |field: &str| {
            let parameter = Configuration::PARAMETERS.iter().find(|p| p.path() == field);
            let text = |p: &Parameter<Configuration>, of| (p.get)(of).to_string();
            parameter.is_some_and(|p| text(p, shown) != text(p, wanted))
        };
        let overrides = self.source.overrides().into_iter();
        overrides.filter(|o| is_changed(&o.field)).map(|o| (o.option, o.field)).collect()
    }
}

fn engine_stopped(reason: impl std::fmt::Display) -> String {
    error_json(&format!("the engine stopped: {reason}"))
}

fn error_json(reason: &str) -> String {
    serde_json::json!({ "error": reason }).to_string()
}

#[cfg(test)]
mod tests {
    use super::Workload;

    #[test]
    fn requests_have_their_workload() {
        for (request, workload) in [
            (r#"{"command": "design", "values": {}}"#, Workload::Design),
            (r#"{"values": {}, "command": "zip"}"#, Workload::Files),
            (r#"{"command": "calibrate"}"#, Workload::Long),
            ("not JSON", Workload::Design),
        ] {
            assert_eq!(Workload::of(request.as_bytes()), workload, "{request}");
        }
    }
}
