//! `pinswitch view CONFIG`: the page of a set, following its configuration.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use clap::Args;
use tiny_http::{Header, Request, Response, Server};

use super::law::LawChoice;
use super::source::Source;
use super::{Failure, print};
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::named;
use pinswitch_switch::formats::page::{PageData, page_html};
use pinswitch_switch::set::Set;

/// How often the file is polled.
const POLL_INTERVAL: Duration = Duration::from_millis(40);
/// How long a request for the next state is held before the browser repeats it.
const LONG_POLL_TIMEOUT: Duration = Duration::from_secs(20);

/// Show the page of a configuration on this machine, and rebuild it whenever the file changes.
///
/// Serves on 127.0.0.1 only. A configuration that breaks shows its error, and the last good state stays. Ends with Ctrl-C.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  pinswitch init three-double --out mine.toml && pinswitch view mine.toml")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    law: LawChoice,
    /// Port to serve on; 0 takes any that is free.
    #[arg(long, default_value_t = 8737)]
    port: u16,
}

/// The last valid page and the error since then, if any.
#[derive(Default)]
struct State {
    version: u64,
    /// JSON of the page's data.
    data: String,
    page: String,
    trouble: Option<String>,
}

/// A state that readers wait for.
#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A reader that panicked has changed nothing.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The JSON of the state after `version`; waits for it, with a timeout.
    fn after(&self, version: u64) -> String {
        let state = self.lock();
        let (state, _) = self
            .changed
            .wait_timeout_while(state, LONG_POLL_TIMEOUT, |s| s.version <= version)
            .unwrap_or_else(PoisonError::into_inner);
        let data = if state.version > version && state.trouble.is_none() { &state.data } else { "null" };
        let trouble = serde_json::to_string(&state.trouble).unwrap_or_else(|_| "null".to_owned());
        format!(r#"{{"version":{},"trouble":{trouble},"data":{data}}}"#, state.version)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let shared = Arc::new(Shared::default());
    let (page, data) = build(arguments, 1)?;
    *shared.lock() = State { version: 1, data, page, trouble: None };
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, arguments.port));
    let server = Server::http(address).map_err(|e| {
        Failure::bad_input(format!(
            "--port {}: cannot serve there: {e}; give another port, or 0 for any that is free",
            arguments.port
        ))
    })?;
    print(format!("http://{}\n", server.server_addr()).as_bytes())?;
    if let Some(file) = arguments.source.file() {
        log::info!("following {}; end with Ctrl-C", file.display());
        let (shared, arguments) = (Arc::clone(&shared), arguments.clone());
        std::thread::spawn(move || rebuild_on_change(&shared, &arguments, &file));
    }
    for request in server.incoming_requests() {
        let shared = Arc::clone(&shared);
        std::thread::spawn(move || respond(request, &shared));
    }
    Ok(())
}

/// The page and its data.
fn build(arguments: &Arguments, version: u64) -> Result<(String, String), Failure> {
    let design = arguments.source.design()?;
    let prediction = arguments.law.prediction(&design)?;
    let built = Built::new(design).map_err(Failure::bad_input)?;
    let formats = named(&["stl"]).map_err(Failure::failed)?;
    let set = Set::new(&built, &prediction, &formats).map_err(Failure::bad_input)?;
    let data = PageData::new(&built, &prediction, &set.manifest, Some(version));
    // A live page is rebuilt while somebody waits, in a browser that has shown it already: no picture.
    let page = page_html(&data, "").map_err(Failure::failed)?;
    Ok((page, data.json().map_err(Failure::failed)?))
}

/// Rebuilds whenever the file's bytes change.
fn rebuild_on_change(shared: &Shared, arguments: &Arguments, file: &Path) {
    let mut known = std::fs::read(file).ok();
    loop {
        std::thread::sleep(POLL_INTERVAL);
        let now = std::fs::read(file).ok();
        // A file that is missing for a moment is one that an editor is saving.
        if now.is_none() || now == known {
            continue;
        }
        known = now;
        let next = shared.lock().version + 1;
        let built = build(arguments, next);
        let mut state = shared.lock();
        state.version = next;
        match built {
            Ok((page, data)) => {
                (state.page, state.data, state.trouble) = (page, data, None);
                log::info!("rebuilt");
            }
            Err(failure) => {
                log::warn!("{}", failure.message());
                state.trouble = Some(failure.message().to_owned());
            }
        }
        drop(state);
        shared.changed.notify_all();
    }
}

fn respond(request: Request, shared: &Shared) {
    let url = request.url().to_owned();
    let (path, query) = url.split_once('?').unwrap_or((&url, ""));
    let response = match path {
        "/" => content(shared.lock().page.clone(), "text/html; charset=utf-8"),
        "/state" => {
            let version = query.strip_prefix("after=").and_then(|v| v.parse().ok()).unwrap_or(0);
            content(shared.after(version), "application/json")
        }
        _ => Response::from_string("no such page").with_status_code(404),
    };
    // A closed connection is no failure.
    let _ = request.respond(response);
}

fn content(text: String, kind: &str) -> Response<std::io::Cursor<Vec<u8>>> {
    let response = Response::from_string(text);
    match Header::from_bytes("Content-Type", kind) {
        Ok(header) => response.with_header(header),
        Err(()) => response,
    }
}
