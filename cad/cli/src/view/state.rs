//! What the preview shows now, and waiting for what comes next.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

/// The last valid page and the error since then, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) version: u64,
    /// SHA-256 of the file that it was read from: a configurator tells by it whether the file is the one that it knows.
    pub(super) stamp: Arc<str>,
    /// JSON of the page's data.
    pub(super) data: Arc<str>,
    pub(super) page: Arc<str>,
    /// JSON of the values that differ from the defaults.
    pub(super) values: Arc<str>,
    pub(super) trouble: Option<String>,
}

impl State {
    /// What differs from that of any other state, of another run of the server, too.
    fn token(&self) -> String {
        format!("{}-{}", self.version, self.stamp)
    }

    /// JSON for a page that shows `version`.
    fn since(&self, version: u64) -> String {
        let data = if self.version > version && self.trouble.is_none() { &*self.data } else { "null" };
        let trouble = serde_json::to_string(&self.trouble).unwrap_or_else(|_| "null".to_owned());
        format!(r#"{{"version":{},"trouble":{trouble},"data":{data}}}"#, self.version)
    }
}

/// Waits for a state other than that with the token `known`, with a timeout; gives its token, stamp, values and trouble as
/// JSON, for a configurator, with what the server began with. The server may have been started anew since, with another file.
pub(super) async fn values_after(
    mut states: watch::Receiver<State>,
    known: &str,
    timeout: Duration,
    beginning: &serde_json::Value,
) -> String {
    let _ = tokio::time::timeout(timeout, states.wait_for(|state| state.token() != known)).await;
    let state = states.borrow();
    let trouble = serde_json::to_string(&state.trouble).unwrap_or_else(|_| "null".to_owned());
    format!(
        r#"{{"version":"{}","stamp":"{}","values":{},"begun":{beginning},"trouble":{trouble}}}"#,
        state.token(),
        state.stamp,
        state.values
    )
}

/// The JSON of the state after `version`; waits for it, with a timeout.
pub(super) async fn after(mut states: watch::Receiver<State>, version: u64, timeout: Duration) -> String {
    // Neither a timeout nor the end of the program is an error: the state of then is the answer.
    let _ = tokio::time::timeout(timeout, states.wait_for(|state| state.version > version)).await;
    let state = states.borrow();
    state.since(version)
}
