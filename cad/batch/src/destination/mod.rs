//! Destinations of a batch: a folder, or an object store. A file is written completely or not at
//! all.

#[cfg(feature = "cloud")]
mod cloud;
mod folder;
#[cfg(feature = "cloud")]
mod store;

use std::error::Error;
#[cfg(feature = "cloud")]
use std::sync::Arc;

#[cfg(feature = "cloud")]
use object_store::{ObjectStore, path::Path as StorePath};
use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_store::{Busy, LockPolicy};

pub use folder::{DestinationLock, Folder};
#[cfg(feature = "cloud")]
pub use store::Store;

/// Prefix of folders for unfinished files.
pub(super) const PARTIAL: &str = ".partial-";

/// A path of a destination that cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{diagnostic}")]
pub struct DestinationError {
    diagnostic: Diagnostic,
    help: &'static str,
    is_fatal: bool,
    is_refusal: bool,
}

impl DestinationError {
    /// An error at a file with its destination; `is_fatal` if every other file would fail, too.
    fn new(code: Code, path: String, problem: impl Into<String>, help: &'static str, is_fatal: bool) -> Self {
        let diagnostic = Diagnostic::new(code, problem).with_location(Location::file(path)).with_help(help);
        Self { diagnostic, help, is_fatal, is_refusal: false }
    }

    /// The error of temporary files on this machine.
    pub(super) fn temporary(error: std::io::Error) -> Self {
        let problem = format!("cannot use the temporary folder: {error}");
        let help = "make room for temporary files on this machine";
        let diagnostic = Diagnostic::new(codes::CANNOT_WRITE, problem).with_help(help).with_source(error);
        Self { diagnostic, help, is_fatal: true, is_refusal: true }
    }

    fn with_source(self, source: impl Error + Send + Sync + 'static) -> Self {
        Self { diagnostic: self.diagnostic.with_source(source), ..self }
    }

    /// Returns the remedy.
    pub fn help(&self) -> &'static str {
        self.help
    }

    /// Returns whether every other file would fail, too, as on a full disk or in a read-only
    /// folder.
    pub fn is_fatal(&self) -> bool {
        self.is_fatal
    }

    /// Returns whether the system refuses a valid path, as on a full disk or in a read-only folder;
    /// otherwise the path itself may be wrong.
    pub fn is_refusal(&self) -> bool {
        self.is_refusal
    }
}

impl From<DestinationError> for Diagnostic {
    fn from(error: DestinationError) -> Self {
        error.diagnostic
    }
}

/// A destination of files, which have relative paths with `/`.
#[derive(Debug)]
pub enum Destination {
    /// A local or network folder.
    Folder(Folder),
    /// An object store. Equal files are stored once, and manifests contain their paths.
    #[cfg(feature = "cloud")]
    Store(Store),
}

/// Forwards a call to the folder or the store, and adds the file's name to its error.
macro_rules! forward {
    ($destination:expr, $name:expr, $place:ident => $call:expr) => {
        match $destination {
            Destination::Folder($place) => $call.map_err(|e| $place.error($name, e)),
            #[cfg(feature = "cloud")]
            Destination::Store($place) => $call.map_err(|e| $place.error($name, e)),
        }
    };
}

impl Destination {
    /// Opens the path or `file://` URL of a folder or, with the feature `cloud`, a URL such as
    /// `s3://bucket/sweep`. `partial` is the name of the folder for unfinished files, which no
    /// other running process uses.
    ///
    /// # Errors
    /// An empty path, or a URL of an unknown store.
    pub fn open(text: &str, partial: &str) -> Result<Self, DestinationError> {
        let folder = |path: &str| Ok(Self::Folder(Folder::new(path, partial)));
        match text.strip_prefix("file://") {
            Some(path) => folder(&folder_of_url(text, path)?),
            None if text.is_empty() => Err(DestinationError::new(
                codes::USAGE,
                text.to_owned(),
                "the path is empty",
                "give a folder with --out",
                true,
            )),
            None if !text.contains("://") => folder(text),
            None => Self::open_store(text),
        }
    }

    /// The destination with another policy than [`LockPolicy::Refuse`] for a folder in use.
    #[must_use]
    pub fn with_lock_policy(self, policy: LockPolicy) -> Self {
        match self {
            Self::Folder(folder) => Self::Folder(folder.with_lock_policy(policy)),
            #[cfg(feature = "cloud")]
            Self::Store(_) => self,
        }
    }

    #[cfg(not(feature = "cloud"))]
    fn open_store(text: &str) -> Result<Self, DestinationError> {
        Err(unknown_store(codes::FEATURE_NOT_BUILT, text, "this build supports folders only"))
    }

    #[cfg(feature = "cloud")]
    fn open_store(text: &str) -> Result<Self, DestinationError> {
        let (store, prefix) = cloud::open(text)?;
        Self::in_store(text, store, prefix)
    }

    /// A prefix of a store that is already open.
    ///
    /// # Errors
    /// Threads that cannot be started; a cloud store needs one.
    #[cfg(feature = "cloud")]
    pub fn in_store(
        url: &str,
        store: Arc<dyn ObjectStore>,
        prefix: StorePath,
    ) -> Result<Self, DestinationError> {
        Store::new(url, store, prefix).map(Self::Store).map_err(|e| {
            let problem = format!("cannot start a thread: {e}");
            DestinationError::new(
                codes::CANNOT_START,
                url.to_owned(),
                problem,
                "allow this process to start threads",
                true,
            )
            .with_source(e)
        })
    }

    /// Returns whether equal files are linked, so that each variant's folder contains its parts;
    /// otherwise manifests contain their paths.
    pub fn has_links(&self) -> bool {
        matches!(self, Self::Folder(_))
    }

    /// Reads file `name`; `None` if it does not exist.
    ///
    /// # Errors
    /// A file that exists and cannot be read.
    pub fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DestinationError> {
        forward!(self, name, place => place.get(name))
    }

    /// Returns the size of file `name` in bytes; `None` if it does not exist.
    ///
    /// # Errors
    /// A size that cannot be determined.
    pub fn size(&self, name: &str) -> Result<Option<u64>, DestinationError> {
        forward!(self, name, place => place.size(name))
    }

    /// Writes file `name`, and replaces an older one.
    ///
    /// # Errors
    /// A file that cannot be written; the older file is unchanged.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.put(name, bytes).map_err(|e| folder.write_error(name, e)),
            #[cfg(feature = "cloud")]
            Self::Store(store) => store.put(name, bytes).map_err(|e| store.error(name, e)),
        }
    }

    /// Makes `name` a hard link to `content`, or a copy if the file system does not support links.
    ///
    /// # Errors
    /// A file that cannot be linked or copied.
    pub fn link(&self, content: &str, name: &str) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.link(content, name).map_err(|e| folder.write_error(name, e)),
            // Manifests contain the path of the content: a second object would double the storage.
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(()),
        }
    }

    /// Returns whether two names are links to one file; objects of a store never are.
    pub fn is_same(&self, one: &str, other: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.is_same(one, other),
            #[cfg(feature = "cloud")]
            Self::Store(_) => false,
        }
    }

    /// Creates a file on this machine, to be written and passed to [`Self::put_file`].
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn local_file(&self) -> Result<tempfile::NamedTempFile, DestinationError> {
        match self {
            Self::Folder(folder) => {
                folder.local_file().map_err(|e| folder.write_error("a temporary file", e))
            }
            #[cfg(feature = "cloud")]
            Self::Store(_) => tempfile::NamedTempFile::new().map_err(DestinationError::temporary),
        }
    }

    /// Moves a finished local file to `name`.
    ///
    /// # Errors
    /// A file that cannot be written; an older file is unchanged.
    pub fn put_file(&self, name: &str, file: tempfile::NamedTempFile) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.put_file(name, file).map_err(|e| folder.write_error(name, e)),
            #[cfg(feature = "cloud")]
            Self::Store(_) => {
                let bytes = std::fs::read(file.path()).map_err(DestinationError::temporary)?;
                self.put(name, &bytes)
            }
        }
    }

    /// Returns the names of the folders in `folder`, sorted.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn folders(&self, folder: &str) -> Result<Vec<String>, DestinationError> {
        let mut names = forward!(self, folder, place => place.folders(folder))?;
        names.sort();
        Ok(names)
    }

    /// Refuses an existing `name` that is a folder, if `is_folder`, or that is not. A store has no
    /// folders, and no obstructions.
    ///
    /// # Errors
    /// The error of a system call that fails with `kind`.
    pub(super) fn refuse_if(
        &self,
        name: &str,
        is_folder: bool,
        kind: std::io::ErrorKind,
    ) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => match folder.is_folder(name) {
                Ok(existing) if existing == Some(is_folder) => Err(folder.error(name, kind.into())),
                Ok(_) => Ok(()),
                Err(e) => Err(folder.error(name, e)),
            },
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(()),
        }
    }

    /// Lists the entries of `folder`, each with whether it is a folder; none for a store, which has
    /// no obstructions.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub(super) fn entries(&self, folder: &str) -> Result<Vec<(String, bool)>, DestinationError> {
        match self {
            Self::Folder(place) => place.entries(folder).map_err(|e| place.error(folder, e)),
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(Vec::new()),
        }
    }

    /// Returns whether the destination is empty or does not exist.
    ///
    /// # Errors
    /// A destination that cannot be read.
    pub fn is_empty(&self) -> Result<bool, DestinationError> {
        forward!(self, "", place => place.is_empty())
    }

    /// Locks the destination, so that a concurrent run of the same shard fails immediately, and
    /// removes unfinished files of a killed run. The system releases the lock when the process
    /// ends, even if it is killed.
    ///
    /// # Errors
    /// A destination that another process has locked, or that cannot be written.
    pub fn lock(&self) -> Result<DestinationLock, DestinationError> {
        let folder = match self {
            Self::Folder(folder) => folder,
            // Objects are written completely, and shards write different objects.
            #[cfg(feature = "cloud")]
            Self::Store(_) => return Ok(DestinationLock::unlocked()),
        };
        folder.lock().map_err(|e| match e.get_ref().and_then(|e| e.downcast_ref::<Busy>()) {
            Some(busy) => {
                let problem = format!("another run is writing the same shard here{}", busy.holder());
                let help = "wait for it (--wait SECONDS) or end it, or give another --out";
                DestinationError::new(codes::FOLDER_IN_USE, self.name(), problem, help, true)
            }
            None => folder.write_error("", e),
        })
    }

    /// Returns its path or URL, as given.
    pub fn name(&self) -> String {
        match self {
            Self::Folder(folder) => folder.root.display().to_string(),
            #[cfg(feature = "cloud")]
            Self::Store(store) => store.url.clone(),
        }
    }
}

/// Returns the folder of a `file://` URL with this `path`: absolute, with escapes decoded.
fn folder_of_url(url: &str, path: &str) -> Result<String, DestinationError> {
    if !path.starts_with('/') {
        return Err(unknown_store(
            codes::MALFORMED_VALUE,
            url,
            "a file:// URL needs an absolute path, such as file:///data/sweep",
        ));
    }
    let decoded = percent_encoding::percent_decode_str(path).decode_utf8();
    decoded.map(Into::into).map_err(|e| {
        unknown_store(codes::MALFORMED_VALUE, url, format!("escapes are not UTF-8: {e}")).with_source(e)
    })
}

/// The error for a URL that is not a destination.
fn unknown_store(code: Code, url: &str, problem: impl Into<String>) -> DestinationError {
    let help = "give a folder, file:// or, in a build with --features cloud, s3://, gs:// or az://";
    DestinationError::new(code, url.to_owned(), problem, help, true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::path::Path;

    fn all(folder: &Path) -> Vec<Destination> {
        let local = folder.join("store");
        std::fs::create_dir(&local).unwrap();
        vec![
            Destination::open(folder.join("plain").to_str().unwrap(), ".partial-1-of-1").unwrap(),
            Destination::open(&format!("file://{}", local.display()), ".partial-1-of-1").unwrap(),
            #[cfg(feature = "cloud")]
            Destination::in_store(
                "memory:///",
                Arc::new(object_store::memory::InMemory::new()),
                StorePath::from("sweep"),
            )
            .unwrap(),
        ]
    }

    #[test]
    fn destinations_store_files() {
        let folder = tempfile::tempdir().unwrap();
        for place in all(folder.path()) {
            assert!(place.is_empty().unwrap());
            let lock = place.lock().unwrap();
            assert_eq!(place.get("a/b").unwrap(), None);
            place.put("a/b", b"one").unwrap();
            place.put("a/b", b"two").unwrap();
            assert_eq!(place.get("a/b").unwrap().as_deref(), Some(&b"two"[..]));
            assert_eq!(place.size("a/b").unwrap(), Some(3));
            assert_eq!(place.size("a/c").unwrap(), None);
            assert_eq!(place.folders("").unwrap_or_default().iter().filter(|n| *n == "a").count(), 1);
            let mut file = place.local_file().unwrap();
            file.write_all(b"table").unwrap();
            place.put_file("t.csv", file).unwrap();
            assert_eq!(place.get("t.csv").unwrap().as_deref(), Some(&b"table"[..]));
            place.link("a/b", "v/c").unwrap();
            place.link("a/b", "v/c").unwrap();
            assert_eq!(place.size("v/c").unwrap(), place.has_links().then_some(3));
            drop(lock);
            assert!(!place.is_empty().unwrap());
        }
    }

    #[test]
    fn one_run_locks_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let open = |partial| Destination::open(folder.path().to_str().unwrap(), partial).unwrap();
        let partial = folder.path().join(".partial-1-of-2");
        std::fs::create_dir(&partial).unwrap();
        std::fs::write(partial.join("7"), "half of a file, from a killed run").unwrap();
        let lock = open(".partial-1-of-2").lock().unwrap();
        assert!(!partial.join("7").exists());
        let second = open(".partial-1-of-2").lock();
        assert!(second.unwrap_err().to_string().contains("another run is writing the same shard"));
        assert!(open(".partial-2-of-2").lock().is_ok());
        drop(lock);
        assert!(!partial.exists() && open(".partial-1-of-2").lock().is_ok());
    }

    #[test]
    fn file_urls_are_decoded() {
        for url in ["file://", "file://data", "file:///%ff"] {
            let error = Destination::open(url, "").unwrap_err().to_string();
            assert!(error.starts_with(&format!("{url}: ")), "{error}");
        }
        assert_eq!(Destination::open("file:///a%20b", "").unwrap().name(), "/a b");
    }

    #[test]
    fn an_empty_path_is_refused() {
        let error = Destination::open("", "").unwrap_err().to_string();
        assert_eq!(error, "the path is empty; give a folder with --out");
    }

    #[test]
    fn unknown_stores_are_refused() {
        let error = Destination::open("gopher://x/y", "").unwrap_err().to_string();
        assert!(error.starts_with("gopher://x/y: "), "{error}");
    }
}
