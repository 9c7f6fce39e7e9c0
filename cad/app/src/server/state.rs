//! The state of the followed configuration, and long polls for the next state.

use std::sync::Arc;
use std::time::Duration;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::page::changed_values;
use sha2::{Digest, Sha256};
use tokio::sync::watch;

use super::{ConfigurationSource, ServerError};

/// The last valid configuration, and the error since then, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) version: u64,
    /// SHA-256 of the file: the page compares it with the file that it last showed or wrote.
    stamp: Arc<str>,
    /// Values that differ from the defaults, as JSON.
    values: Arc<str>,
    pub(super) trouble: Option<String>,
}

impl State {
    /// Reads the configuration in the content of the followed file, or in the template, and builds its parts.
    ///
    /// # Errors
    /// [`ServerError`] if the parts cannot be built.
    pub(super) fn build(
        source: &dyn ConfigurationSource,
        content: &[u8],
        version: u64,
    ) -> Result<Self, ServerError> {
        let design = source.design(content).map_err(ServerError::Configuration)?;
        let built = Built::new(design).map_err(|e| ServerError::Configuration(Diagnostic::from(e)))?;
        let values = changed_values(built.design().configuration());
        let values = serde_json::to_string(&values).map_err(ServerError::internal)?;
        Ok(Self { version, stamp: stamp(content).into(), values: values.into(), trouble: None })
    }

    /// Identifies this state among those of all runs of the server.
    fn token(&self) -> String {
        format!("{}-{}", self.version, self.stamp)
    }
}

/// SHA-256 of the content of a file, in hexadecimal digits.
pub(super) fn stamp(content: &[u8]) -> String {
    Sha256::digest(content).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Waits for a state whose token is not `known`, or for the timeout. Returns the present state
/// as JSON: token, stamp, values, `source` and trouble. `source` is included since
/// the server may have been restarted with another file.
pub(super) async fn values_after(
    mut states: watch::Receiver<State>,
    known: &str,
    timeout: Duration,
    source: &serde_json::Value,
) -> String {
    let _ = tokio::time::timeout(timeout, states.wait_for(|state| state.token() != known)).await;
    let state = states.borrow();
    let trouble = serde_json::to_string(&state.trouble).unwrap_or_else(|_| "null".to_owned());
    format!(
        r#"{{"version":"{}","stamp":"{}","values":{},"source":{source},"trouble":{trouble}}}"#,
        state.token(),
        state.stamp,
        state.values
    )
}
