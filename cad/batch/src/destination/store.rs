//! A prefix of an object store: a bucket, a folder behind a URL, or memory.

use std::sync::Arc;

use object_store::path::Path;
use object_store::{Error, ObjectStore, ObjectStoreExt};
use pinswitch_diagnostic::codes;

use super::DestinationError;

/// Most characters of a store's answer in an error.
const MAX_ANSWER: usize = 240;

/// A prefix of an object store.
#[derive(Debug)]
pub struct Store {
    pub(super) url: String,
    store: Arc<dyn ObjectStore>,
    prefix: Path,
    runtime: tokio::runtime::Runtime,
}

impl Store {
    /// A prefix of a store that is already open.
    pub(super) fn new(url: &str, store: Arc<dyn ObjectStore>, prefix: Path) -> std::io::Result<Self> {
        Ok(Self {
            url: url.to_owned(),
            store,
            prefix,
            runtime: tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?,
        })
    }

    /// The error of a request for object `name`.
    pub(super) fn error(&self, name: &str, error: Error) -> DestinationError {
        // Servers answer with lines or pages; the first words are the message.
        let answer = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        let problem = match answer.char_indices().nth(MAX_ANSWER) {
            Some((end, _)) => format!("{}...", &answer[..end]),
            None => answer,
        };
        let help = "check that the store is reachable, and its variables (AWS_..., GOOGLE_..., AZURE_...)";
        DestinationError::new(codes::CANNOT_WRITE, format!("{}/{name}", self.url), problem, help, true)
    }

    pub(super) fn get(&self, name: &str) -> Result<Option<Vec<u8>>, Error> {
        let bytes = self.wait(async { self.store.get(&self.path(name)).await?.bytes().await });
        Ok(if_exists(bytes)?.map(|bytes| bytes.to_vec()))
    }

    pub(super) fn size(&self, name: &str) -> Result<Option<u64>, Error> {
        Ok(if_exists(self.wait(self.store.head(&self.path(name))))?.map(|facts| facts.size))
    }

    pub(super) fn put(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.wait(self.store.put(&self.path(name), bytes.to_vec().into())).map(drop)
    }

    pub(super) fn folders(&self, folder: &str) -> Result<Vec<String>, Error> {
        let list = self.wait(self.store.list_with_delimiter(Some(&self.path(folder))))?;
        Ok(list.common_prefixes.iter().filter_map(|p| p.filename().map(str::to_owned)).collect())
    }

    pub(super) fn is_empty(&self) -> Result<bool, Error> {
        let list = self.wait(self.store.list_with_delimiter(Some(&self.prefix)))?;
        Ok(list.objects.is_empty() && list.common_prefixes.is_empty())
    }

    /// Returns the path of an object.
    fn path(&self, name: &str) -> Path {
        name.split('/')
            .filter(|part| !part.is_empty())
            .fold(self.prefix.clone(), |path, part| path.join(part))
    }

    /// Blocks until a request is complete, in the runtime that cloud stores need.
    fn wait<T>(&self, request: impl Future<Output = T>) -> T {
        let _guard = self.runtime.enter();
        futures_executor::block_on(request)
    }
}

/// Returns `Ok(None)` for a missing object.
fn if_exists<T>(outcome: Result<T, Error>) -> Result<Option<T>, Error> {
    match outcome {
        Ok(value) => Ok(Some(value)),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(e) => Err(e),
    }
}
