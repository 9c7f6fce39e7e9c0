//! A prefix of an object store: a bucket, a folder behind a URL, or memory.

use std::sync::Arc;

use object_store::path::Path;
use object_store::{Error, ObjectStore, ObjectStoreExt};

use super::DestinationError;

/// Characters of a store's answer that an error repeats.
const SHOWN: usize = 240;

/// A prefix of an object store.
#[derive(Debug)]
pub struct Store {
    pub(super) url: String,
    store: Arc<dyn ObjectStore>,
    prefix: Path,
    runtime: tokio::runtime::Runtime,
}

impl Store {
    /// The prefix of a store that is already open.
    pub(super) fn new(url: &str, store: Arc<dyn ObjectStore>, prefix: Path) -> std::io::Result<Self> {
        Ok(Self {
            url: url.to_owned(),
            store,
            prefix,
            runtime: tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?,
        })
    }

    pub(super) fn failed(&self, name: &str, error: &Error) -> DestinationError {
        // Servers answer in lines and pages: their first words tell.
        let words = error.to_string();
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        let problem = match words.char_indices().nth(SHOWN) {
            Some((end, _)) => format!("{}...", &words[..end]),
            None => words,
        };
        DestinationError {
            place: format!("{}/{name}", self.url),
            problem,
            remedy: "see that the store answers and what its variables (AWS_...) say",
            is_fatal: true,
        }
    }

    pub(super) fn get(&self, name: &str) -> Result<Option<Vec<u8>>, Error> {
        let bytes = self.wait(async { self.store.get(&self.at(name)).await?.bytes().await });
        Ok(found(bytes)?.map(|bytes| bytes.to_vec()))
    }

    pub(super) fn size(&self, name: &str) -> Result<Option<u64>, Error> {
        Ok(found(self.wait(self.store.head(&self.at(name))))?.map(|facts| facts.size))
    }

    pub(super) fn put(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.wait(self.store.put(&self.at(name), bytes.to_vec().into())).map(drop)
    }

    pub(super) fn folders(&self, folder: &str) -> Result<Vec<String>, Error> {
        let list = self.wait(self.store.list_with_delimiter(Some(&self.at(folder))))?;
        Ok(list.common_prefixes.iter().filter_map(|p| p.filename().map(str::to_owned)).collect())
    }

    pub(super) fn is_empty(&self) -> Result<bool, Error> {
        let list = self.wait(self.store.list_with_delimiter(Some(&self.prefix)))?;
        Ok(list.objects.is_empty() && list.common_prefixes.is_empty())
    }

    fn at(&self, name: &str) -> Path {
        name.split('/')
            .filter(|part| !part.is_empty())
            .fold(self.prefix.clone(), |path, part| path.join(part))
    }

    /// Blocks until the future is ready. Folders and memory need no runtime; clouds do.
    fn wait<T>(&self, answer: impl Future<Output = T>) -> T {
        let _inside = self.runtime.enter();
        futures_executor::block_on(answer)
    }
}

/// `Ok(None)` for an object that is not there.
fn found<T>(outcome: Result<T, Error>) -> Result<Option<T>, Error> {
    match outcome {
        Ok(value) => Ok(Some(value)),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(e) => Err(e),
    }
}
