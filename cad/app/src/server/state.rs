//! The state of the followed configuration, and long polls for the next state.

use std::sync::Arc;
use std::time::Duration;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::built::Built;
use pinswitch_switch::formats::named;
use pinswitch_switch::formats::page::{PageData, page_html};
use pinswitch_switch::set::Set;
use sha2::{Digest, Sha256};
use tokio::sync::watch;

use super::{ConfigurationSource, ServerError};
use crate::values::changed_values;

/// The last valid page, and the error since then, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) version: u64,
    /// SHA-256 of the file: the configurator compares it with the file that it last showed or
    /// wrote.
    stamp: Arc<str>,
    /// Data of the page as JSON.
    data: Arc<str>,
    pub(super) page: Arc<str>,
    /// Values that differ from the defaults, as JSON.
    values: Arc<str>,
    pub(super) trouble: Option<String>,
}

impl State {
    /// Builds the page of a set and its data from the content of the followed file, or from the
    /// template.
    ///
    /// # Errors
    /// [`ServerError`] if the configuration cannot be built, or if the page cannot be made.
    pub(super) fn build(
        source: &dyn ConfigurationSource,
        content: &[u8],
        version: u64,
    ) -> Result<Self, ServerError> {
        let design = source.design(content).map_err(ServerError::Configuration)?;
        let prediction = source.prediction(&design).map_err(ServerError::Configuration)?;
        let refused = |e: Diagnostic| ServerError::Configuration(e);
        let built = Built::new(design).map_err(|e| refused(Diagnostic::from(e)))?;
        let formats = named(&["stl"]).map_err(ServerError::Internal)?;
        let set = Set::new(&built, &prediction, &formats).map_err(|e| refused(Diagnostic::from(e)))?;
        let data = PageData::new(&built, &prediction, &set.manifest, Some(version));
        // Without a picture, which takes longer than the rest: the browser draws the assembly.
        let page = page_html(&data, "").map_err(ServerError::internal)?;
        let values = changed_values(built.design().configuration());
        let values = serde_json::to_string(&values).map_err(ServerError::internal)?;
        let data = data.json().map_err(ServerError::internal)?;
        let stamp = stamp(content).into();
        Ok(Self {
            version,
            stamp,
            data: data.into(),
            page: page.into(),
            values: values.into(),
            trouble: None,
        })
    }

    /// Identifies this state among those of all runs of the server.
    fn token(&self) -> String {
        format!("{}-{}", self.version, self.stamp)
    }

    /// JSON for a page of the set that shows `version`.
    fn since(&self, version: u64) -> String {
        let data = if self.version > version && self.trouble.is_none() { &*self.data } else { "null" };
        let trouble = serde_json::to_string(&self.trouble).unwrap_or_else(|_| "null".to_owned());
        format!(r#"{{"version":{},"trouble":{trouble},"data":{data}}}"#, self.version)
    }
}

/// SHA-256 of the content of a file, in hexadecimal digits.
pub(super) fn stamp(content: &[u8]) -> String {
    Sha256::digest(content).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Waits for a state whose token is not `known`, or for the timeout. Returns the present state for
/// a configurator as JSON: token, stamp, values, `source` and trouble. `source` is included since
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

/// Waits for a state after `version`, or for the timeout. Returns the present state for a page of
/// the set as JSON.
pub(super) async fn data_after(
    mut states: watch::Receiver<State>,
    version: u64,
    timeout: Duration,
) -> String {
    // After a timeout and at the end of the program the answer is the present state.
    let _ = tokio::time::timeout(timeout, states.wait_for(|state| state.version > version)).await;
    let state = states.borrow();
    state.since(version)
}
