//! Where a batch is written: a folder, or an object store. Every file appears whole or not at all.

#[cfg(feature = "cloud")]
mod cloud;
mod folder;
#[cfg(feature = "cloud")]
mod store;

#[cfg(feature = "cloud")]
use std::sync::Arc;

#[cfg(feature = "cloud")]
use object_store::{ObjectStore, path::Path as StorePath};

pub(crate) use folder::remedy;
pub use folder::{DestinationLock, Folder, is_dead_link, remedy_at, temporary_file};
#[cfg(feature = "cloud")]
pub use store::Store;

/// Prefix of folders for files that are not yet whole.
pub(super) const PARTIAL: &str = ".partial-";

/// A place that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}; {remedy}")]
pub struct DestinationError {
    /// The file, with its destination.
    pub place: String,
    /// What went wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: &'static str,
    /// Whether every other file would fail too: a full disk, a read-only folder.
    pub is_fatal: bool,
}

/// A destination of files, named by relative paths with `/`.
#[derive(Debug)]
pub enum Destination {
    /// A folder of this machine, or of a network.
    Folder(Folder),
    /// An object store; equal files are kept once and named by the manifests.
    #[cfg(feature = "cloud")]
    Store(Store),
}

/// Forwards a call to the folder or the store, and adds the file's name to its error.
macro_rules! ask {
    ($destination:expr, $name:expr, $place:ident => $answer:expr) => {
        match $destination {
            Destination::Folder($place) => $answer.map_err(|e| $place.failed($name, &e)),
            #[cfg(feature = "cloud")]
            Destination::Store($place) => $answer.map_err(|e| $place.failed($name, &e)),
        }
    };
}

impl Destination {
    /// A folder's path, also as a `file://` URL, or, with the feature `cloud`, a URL such as `s3://bucket/sweep`.
    /// `partial` names the folder for files that are not yet whole: one per running process.
    ///
    /// # Errors
    /// [`DestinationError`] for a URL of no known store.
    pub fn open(text: &str, partial: &str) -> Result<Self, DestinationError> {
        match text.strip_prefix("file://") {
            Some(path) => Ok(Self::Folder(Folder::new(&folder_of_url(text, path)?, partial))),
            None if !text.contains("://") => Ok(Self::Folder(Folder::new(text, partial))),
            None => Self::open_store(text),
        }
    }

    #[cfg(not(feature = "cloud"))]
    fn open_store(text: &str) -> Result<Self, DestinationError> {
        Err(no_store(text, "this build writes to folders only"))
    }

    #[cfg(feature = "cloud")]
    fn open_store(text: &str) -> Result<Self, DestinationError> {
        let (store, prefix) = cloud::open(text).map_err(|problem| no_store(text, &problem))?;
        Self::in_store(text, store, prefix)
    }

    /// The prefix of a store that is already open.
    ///
    /// # Errors
    /// [`DestinationError`] if the threads that a cloud store needs cannot be started.
    #[cfg(feature = "cloud")]
    pub fn in_store(
        url: &str,
        store: Arc<dyn ObjectStore>,
        prefix: StorePath,
    ) -> Result<Self, DestinationError> {
        let failed = |e: std::io::Error| DestinationError {
            place: url.to_owned(),
            problem: e.to_string(),
            remedy: "let this process start threads",
            is_fatal: true,
        };
        Store::new(url, store, prefix).map(Self::Store).map_err(failed)
    }

    /// Whether equal files are linked, so that each variant's folder holds its parts; otherwise manifests name them.
    pub fn links(&self) -> bool {
        matches!(self, Self::Folder(_))
    }

    /// The whole file `name`; `None` if there is none.
    ///
    /// # Errors
    /// [`DestinationError`] for a file that is there but cannot be read.
    pub fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DestinationError> {
        ask!(self, name, place => place.get(name))
    }

    /// The size of file `name` in bytes; `None` if there is none.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be determined.
    pub fn size(&self, name: &str) -> Result<Option<u64>, DestinationError> {
        ask!(self, name, place => place.size(name))
    }

    /// Writes file `name`, replacing an older one.
    ///
    /// # Errors
    /// [`DestinationError`]; the older file is untouched.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        ask!(self, name, place => place.put(name, bytes))
    }

    /// Makes `name` the same file as `content`: a hard link, or a copy where the file system refuses one.
    ///
    /// # Errors
    /// [`DestinationError`] if neither is possible.
    pub fn link(&self, content: &str, name: &str) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.link(content, name).map_err(|e| folder.failed(name, &e)),
            // Manifests name the content: a second object would cost storage twice.
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(()),
        }
    }

    /// Whether two names are links to one file; no two objects of a store are.
    pub fn is_same(&self, one: &str, other: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.is_same(one, other),
            #[cfg(feature = "cloud")]
            Self::Store(_) => false,
        }
    }

    /// A file on this machine, to be filled and then handed to [`Self::put_file`].
    ///
    /// # Errors
    /// [`DestinationError`] if none can be made.
    pub fn local_file(&self) -> Result<tempfile::NamedTempFile, DestinationError> {
        let made = match self {
            Self::Folder(folder) => folder.local_file(),
            #[cfg(feature = "cloud")]
            Self::Store(_) => tempfile::NamedTempFile::new(),
        };
        made.map_err(|e| self.local_error("a temporary file", &e))
    }

    /// Moves a finished local file to `name`.
    ///
    /// # Errors
    /// [`DestinationError`]; an older file is untouched.
    pub fn put_file(&self, name: &str, file: tempfile::NamedTempFile) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.put_file(name, file).map_err(|e| folder.failed(name, &e)),
            #[cfg(feature = "cloud")]
            Self::Store(_) => {
                let bytes = std::fs::read(file.path()).map_err(|e| self.local_error(name, &e))?;
                self.put(name, &bytes)
            }
        }
    }

    /// Names of the folders directly under `folder`.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be determined.
    pub fn folders(&self, folder: &str) -> Result<Vec<String>, DestinationError> {
        let mut names = ask!(self, folder, place => place.folders(folder))?;
        names.sort();
        Ok(names)
    }

    /// Refuses `name` if it is there, and a folder or not as `is_folder` says; a store has no folders, and nothing in the
    /// way.
    ///
    /// # Errors
    /// [`DestinationError`] as for a system call that failed with `kind`.
    pub(super) fn refuse_if(
        &self,
        name: &str,
        is_folder: bool,
        kind: std::io::ErrorKind,
    ) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => match folder.is_folder(name) {
                Ok(there) if there == Some(is_folder) => Err(folder.failed(name, &kind.into())),
                Ok(_) => Ok(()),
                Err(e) => Err(folder.failed(name, &e)),
            },
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(()),
        }
    }

    /// What stands directly in `folder`, and whether it is a folder; a store has nothing in the way.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be determined.
    pub(super) fn entries(&self, folder: &str) -> Result<Vec<(String, bool)>, DestinationError> {
        match self {
            Self::Folder(place) => place.entries(folder).map_err(|e| place.failed(folder, &e)),
            #[cfg(feature = "cloud")]
            Self::Store(_) => Ok(Vec::new()),
        }
    }

    /// Whether nothing is there yet.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be determined.
    pub fn is_empty(&self) -> Result<bool, DestinationError> {
        ask!(self, "", place => place.is_empty())
    }

    /// Locks the destination for this process: no other process writes the same shard at the same time, and what a killed
    /// run left half written is removed. The lock ends with the process, however that ends.
    ///
    /// # Errors
    /// [`DestinationError`] if another process holds it, or nothing can be written there.
    pub fn lock(&self) -> Result<DestinationLock, DestinationError> {
        let folder = match self {
            Self::Folder(folder) => folder,
            // Objects appear whole, and shards have names of their own.
            #[cfg(feature = "cloud")]
            Self::Store(_) => return Ok(DestinationLock::not_needed()),
        };
        let claim = folder.lock().map_err(|e| folder.failed("", &e))?;
        claim.ok_or_else(|| DestinationError {
            place: self.name(),
            problem: "another run is writing the same shard here".to_owned(),
            remedy: "wait for it or end it, or give another --out",
            is_fatal: true,
        })
    }

    /// Its name, as given.
    pub fn name(&self) -> String {
        match self {
            Self::Folder(folder) => folder.root.display().to_string(),
            #[cfg(feature = "cloud")]
            Self::Store(store) => store.url.clone(),
        }
    }

    fn local_error(&self, name: &str, error: &std::io::Error) -> DestinationError {
        match self {
            Self::Folder(folder) => folder.failed(name, error),
            #[cfg(feature = "cloud")]
            Self::Store(store) => DestinationError {
                place: format!("{}/{name}", store.url),
                problem: error.to_string(),
                remedy: "make room for temporary files on this machine",
                is_fatal: true,
            },
        }
    }
}

/// The folder that the `path` of a `file://` URL names: absolute, with its escapes undone.
fn folder_of_url(url: &str, path: &str) -> Result<String, DestinationError> {
    if !path.starts_with('/') {
        return Err(no_store(url, "a file:// URL names a folder from the root, such as file:///data/sweep"));
    }
    let decoded = percent_encoding::percent_decode_str(path).decode_utf8();
    decoded.map(Into::into).map_err(|e| no_store(url, &format!("its escapes are no text: {e}")))
}

/// The error for a URL that no store answers to.
fn no_store(text: &str, problem: &str) -> DestinationError {
    DestinationError {
        place: text.to_owned(),
        problem: problem.to_owned(),
        remedy: "give a folder, file:// or, in a build with --features cloud, s3://, gs:// or az://",
        is_fatal: true,
    }
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
    fn every_destination_keeps_and_gives_files() {
        let folder = tempfile::tempdir().unwrap();
        for place in all(folder.path()) {
            assert!(place.is_empty().unwrap());
            let claim = place.lock().unwrap();
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
            assert_eq!(place.size("v/c").unwrap(), place.links().then_some(3));
            drop(claim);
            assert!(!place.is_empty().unwrap());
        }
    }

    #[test]
    fn a_folder_is_claimed_once_and_swept() {
        let folder = tempfile::tempdir().unwrap();
        let open = |partial| Destination::open(folder.path().to_str().unwrap(), partial).unwrap();
        let partial = folder.path().join(".partial-1-of-2");
        std::fs::create_dir(&partial).unwrap();
        std::fs::write(partial.join("7"), "half, by a run that was killed").unwrap();
        let claim = open(".partial-1-of-2").lock().unwrap();
        assert!(!partial.join("7").exists());
        let second = open(".partial-1-of-2").lock();
        assert!(second.unwrap_err().to_string().contains("another run is writing the same shard"));
        assert!(open(".partial-2-of-2").lock().is_ok());
        drop(claim);
        assert!(!partial.exists() && open(".partial-1-of-2").lock().is_ok());
    }

    #[test]
    fn file_urls_name_absolute_folders_and_their_escapes_are_undone() {
        for url in ["file://", "file://data", "file:///%ff"] {
            let error = Destination::open(url, "").unwrap_err().to_string();
            assert!(error.starts_with(&format!("{url}: ")), "{error}");
        }
        assert_eq!(Destination::open("file:///a%20b", "").unwrap().name(), "/a b");
    }

    #[test]
    fn unknown_stores_are_refused() {
        let error = Destination::open("gopher://x/y", "").unwrap_err().to_string();
        assert!(error.starts_with("gopher://x/y: "), "{error}");
    }
}
