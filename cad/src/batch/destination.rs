//! Where a batch is written: a folder, or an object store. Every file appears whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use object_store::path::Path as StorePath;
use object_store::{ObjectStore, ObjectStoreExt};

/// A place that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct DestinationError {
    /// The file, with its destination.
    pub place: String,
    /// What went wrong.
    pub problem: String,
    /// Whether it would go wrong for every other file too: a full disk, a folder that must not be written.
    pub hopeless: bool,
}

/// A destination of files, named by relative paths with `/`.
#[derive(Debug)]
pub enum Destination {
    /// A folder of this machine, or of a network.
    Folder(Folder),
    /// An object store; equal files are kept once and named by the manifests.
    Store(Store),
}

/// A folder, with a folder inside it for files that are not yet whole.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    partial: PathBuf,
    counter: AtomicU64,
}

/// A prefix of an object store.
#[derive(Debug)]
pub struct Store {
    url: String,
    store: Arc<dyn ObjectStore>,
    prefix: StorePath,
    #[cfg(feature = "cloud")]
    runtime: tokio::runtime::Runtime,
}

impl Destination {
    /// A folder's path, or a URL such as `file:///data/sweep`, `memory:///` or, with the feature `cloud`,
    /// `s3://bucket/sweep`. `partial` names the folder for files that are not yet whole: one per running process.
    ///
    /// # Errors
    /// [`DestinationError`] for a URL of no known store.
    pub fn open(text: &str, partial: &str) -> Result<Self, DestinationError> {
        let Some(url) = text.contains("://").then(|| url::Url::parse(text)) else {
            let root = PathBuf::from(text);
            let partial = root.join(partial);
            return Ok(Self::Folder(Folder { root, partial, counter: AtomicU64::new(0) }));
        };
        let refused = |problem: String| DestinationError {
            place: text.to_owned(),
            problem: format!(
                "{problem}; give a folder, file:// or, in a build with --features cloud, s3://, gs:// or az://"
            ),
            hopeless: true,
        };
        let url = url.map_err(|e| refused(e.to_string()))?;
        let environment = std::env::vars()
            .filter(|(key, _)| ["AWS_", "AZURE_", "GOOGLE_"].iter().any(|prefix| key.starts_with(prefix)));
        let environment = environment.map(|(key, value)| (key.to_ascii_lowercase(), value));
        let (store, prefix) =
            object_store::parse_url_opts(&url, environment).map_err(|e| refused(e.to_string()))?;
        Self::in_store(text, store.into(), prefix)
    }

    /// The prefix of a store that is already open.
    ///
    /// # Errors
    /// [`DestinationError`] if the threads that a cloud store needs cannot be started.
    pub fn in_store(
        url: &str,
        store: Arc<dyn ObjectStore>,
        prefix: StorePath,
    ) -> Result<Self, DestinationError> {
        // Built once for all: only the first call takes effect.
        #[cfg(feature = "cloud")]
        let _ = rustls::crypto::ring::default_provider().install_default();
        #[cfg(feature = "cloud")]
        let runtime =
            tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().map_err(
                |e| DestinationError { place: url.to_owned(), problem: e.to_string(), hopeless: true },
            )?;
        Ok(Self::Store(Store {
            url: url.to_owned(),
            store,
            prefix,
            #[cfg(feature = "cloud")]
            runtime,
        }))
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
        match self {
            Self::Folder(folder) => match std::fs::read(folder.root.join(name)) {
                Ok(bytes) => Ok(Some(bytes)),
                Err(e) if absent(e.kind()) => Ok(None),
                Err(e) => Err(folder.failed(name, &e)),
            },
            Self::Store(store) => {
                match store.wait(async { store.store.get(&store.at(name)).await?.bytes().await }) {
                    Ok(bytes) => Ok(Some(bytes.to_vec())),
                    Err(object_store::Error::NotFound { .. }) => Ok(None),
                    Err(e) => Err(store.failed(name, &e)),
                }
            }
        }
    }

    /// The size of file `name` in bytes; `None` if there is none.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be told.
    pub fn size(&self, name: &str) -> Result<Option<u64>, DestinationError> {
        match self {
            Self::Folder(folder) => match std::fs::metadata(folder.root.join(name)) {
                Ok(facts) => Ok(Some(facts.len())),
                Err(e) if absent(e.kind()) => Ok(None),
                Err(e) => Err(folder.failed(name, &e)),
            },
            Self::Store(store) => match store.wait(store.store.head(&store.at(name))) {
                Ok(facts) => Ok(Some(facts.size)),
                Err(object_store::Error::NotFound { .. }) => Ok(None),
                Err(e) => Err(store.failed(name, &e)),
            },
        }
    }

    /// Writes file `name`, replacing an older one.
    ///
    /// # Errors
    /// [`DestinationError`]; the older file is untouched.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.put(name, bytes).map_err(|e| folder.failed(name, &e)),
            Self::Store(store) => store
                .wait(store.store.put(&store.at(name), bytes.to_vec().into()))
                .map(drop)
                .map_err(|e| store.failed(name, &e)),
        }
    }

    /// Makes `name` the same file as `content`: a hard link, or a copy where the file system refuses one.
    ///
    /// # Errors
    /// [`DestinationError`] if neither is possible.
    pub fn link(&self, content: &str, name: &str) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => folder.link(content, name).map_err(|e| folder.failed(name, &e)),
            // Manifests name the content: a second object would be paid for twice.
            Self::Store(_) => Ok(()),
        }
    }

    /// A file on this machine, to be filled and then handed to [`Self::put_file`].
    ///
    /// # Errors
    /// [`DestinationError`] if none can be made.
    pub fn local_file(&self) -> Result<tempfile::NamedTempFile, DestinationError> {
        let made = match self {
            Self::Folder(folder) => std::fs::create_dir_all(&folder.partial)
                .and_then(|()| tempfile::Builder::new().permissions(readable()).tempfile_in(&folder.partial)),
            Self::Store(_) => tempfile::NamedTempFile::new(),
        };
        made.map_err(|e| self.failed("a temporary file", &e))
    }

    /// Moves a finished local file to `name`.
    ///
    /// # Errors
    /// [`DestinationError`]; an older file is untouched.
    pub fn put_file(&self, name: &str, file: tempfile::NamedTempFile) -> Result<(), DestinationError> {
        match self {
            Self::Folder(folder) => {
                let target = folder.root.join(name);
                let made = target.parent().map_or(Ok(()), std::fs::create_dir_all);
                made.and_then(|()| file.persist(&target).map(drop).map_err(|e| e.error))
                    .map_err(|e| folder.failed(name, &e))
            }
            Self::Store(_) => {
                let bytes = std::fs::read(file.path()).map_err(|e| self.failed(name, &e))?;
                self.put(name, &bytes)
            }
        }
    }

    /// Names of the folders directly under `folder`.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be told.
    pub fn folders(&self, folder: &str) -> Result<Vec<String>, DestinationError> {
        let mut names: Vec<String> = match self {
            Self::Folder(f) => match std::fs::read_dir(f.root.join(folder)) {
                Ok(entries) => entries
                    .filter_map(Result::ok)
                    .filter(|e| e.path().is_dir())
                    .map(|e| e.file_name().to_string_lossy().into_owned())
                    .collect(),
                Err(e) if absent(e.kind()) => Vec::new(),
                Err(e) => return Err(f.failed(folder, &e)),
            },
            Self::Store(store) => {
                let found = store
                    .wait(store.store.list_with_delimiter(Some(&store.at(folder))))
                    .map_err(|e| store.failed(folder, &e))?;
                found.common_prefixes.iter().filter_map(|p| p.filename().map(str::to_owned)).collect()
            }
        };
        names.sort();
        Ok(names)
    }

    /// Whether nothing is there yet.
    ///
    /// # Errors
    /// [`DestinationError`] if that cannot be told.
    pub fn is_empty(&self) -> Result<bool, DestinationError> {
        match self {
            Self::Folder(folder) => match std::fs::read_dir(&folder.root) {
                Ok(entries) => Ok(entries
                    .filter_map(Result::ok)
                    .all(|e| e.file_name().to_string_lossy().starts_with(PARTIAL))),
                Err(e) if e.kind() == ErrorKind::NotFound => Ok(true),
                Err(e) => Err(folder.failed("", &e)),
            },
            Self::Store(store) => store
                .wait(store.store.list_with_delimiter(Some(&store.prefix)))
                .map(|found| found.objects.is_empty() && found.common_prefixes.is_empty())
                .map_err(|e| store.failed("", &e)),
        }
    }

    /// Claims the destination for this process: nobody else writes the same shard at the same time, and what a killed
    /// run left half written is swept away. The claim ends with the process, however that ends.
    ///
    /// # Errors
    /// [`DestinationError`] if another process holds it, or nothing can be written there.
    pub fn claim(&self) -> Result<Claim, DestinationError> {
        let Self::Folder(folder) = self else { return Ok(Claim(None)) };
        let claimed = folder.claim().map_err(|e| folder.failed("", &e))?;
        claimed.map(|lock| Claim(Some((lock, folder.partial.clone())))).ok_or_else(|| DestinationError {
            place: folder.root.display().to_string(),
            problem: "another run is writing the same shard here; wait for it or end it".to_owned(),
            hopeless: true,
        })
    }

    /// Its name, as given.
    pub fn name(&self) -> String {
        match self {
            Self::Folder(folder) => folder.root.display().to_string(),
            Self::Store(store) => store.url.clone(),
        }
    }

    fn failed(&self, name: &str, error: &std::io::Error) -> DestinationError {
        match self {
            Self::Folder(folder) => folder.failed(name, error),
            Self::Store(store) => DestinationError {
                place: format!("{}/{name}", store.url),
                problem: error.to_string(),
                hopeless: true,
            },
        }
    }
}

/// Prefix of folders for files that are not yet whole.
pub(super) const PARTIAL: &str = ".partial-";

/// A destination held by this process; the folder for unfinished files goes when it is let go.
#[derive(Debug)]
pub struct Claim(Option<(std::fs::File, PathBuf)>);

impl Drop for Claim {
    fn drop(&mut self) {
        if let Some((_, partial)) = &self.0 {
            // What cannot be removed is swept away by the next run.
            let _ = std::fs::remove_dir_all(partial);
        }
    }
}

/// A missing file, or one whose folder is something else.
fn absent(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Temporary files are private; what takes a name is an ordinary file.
#[cfg(unix)]
fn readable() -> std::fs::Permissions {
    std::os::unix::fs::PermissionsExt::from_mode(0o644)
}

impl Folder {
    fn failed(&self, name: &str, error: &std::io::Error) -> DestinationError {
        use ErrorKind::{PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let hopeless =
            matches!(error.kind(), PermissionDenied | QuotaExceeded | ReadOnlyFilesystem | StorageFull);
        let place = if name.is_empty() { self.root.clone() } else { self.root.join(name) };
        DestinationError {
            place: place.display().to_string(),
            problem: format!("cannot use it: {error}"),
            hopeless,
        }
    }

    fn claim(&self) -> std::io::Result<Option<std::fs::File>> {
        std::fs::create_dir_all(&self.partial)?;
        let lock = std::fs::File::create(self.partial.join("lock"))?;
        if lock.try_lock().is_err() {
            return Ok(None);
        }
        for entry in std::fs::read_dir(&self.partial)?.filter_map(Result::ok) {
            if entry.file_name() != "lock" {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(Some(lock))
    }

    /// A name for a file that is not yet whole.
    fn scratch(&self) -> PathBuf {
        self.partial.join(self.counter.fetch_add(1, Ordering::Relaxed).to_string())
    }

    fn put(&self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        let scratch = self.scratch();
        let written = std::fs::File::create(&scratch).and_then(|mut file| file.write_all(bytes));
        let moved = written.and_then(|()| self.place(&scratch, &self.root.join(name)));
        if moved.is_err() {
            // The room on a full disk is given back at once.
            let _ = std::fs::remove_file(&scratch);
        }
        moved
    }

    /// Renames, and makes the folder only when it turns out to be missing.
    fn place(&self, scratch: &Path, target: &Path) -> std::io::Result<()> {
        match std::fs::rename(scratch, target) {
            Err(e) if e.kind() == ErrorKind::NotFound => {
                target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
                std::fs::rename(scratch, target)
            }
            done => done,
        }
    }

    fn link(&self, content: &str, name: &str) -> std::io::Result<()> {
        let (content, target) = (self.root.join(content), self.root.join(name));
        let linked = match std::fs::hard_link(&content, &target) {
            Err(e) if e.kind() == ErrorKind::NotFound => {
                target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
                std::fs::hard_link(&content, &target)
            }
            done => done,
        };
        match linked {
            Ok(()) => Ok(()),
            // An older file stands there, links end here, or the file system knows none.
            Err(e) if matches!(e.kind(), ErrorKind::StorageFull | ErrorKind::NotADirectory) => Err(e),
            Err(_) => {
                let scratch = self.scratch();
                if std::fs::hard_link(&content, &scratch).is_err() {
                    std::fs::copy(&content, &scratch)?;
                }
                self.place(&scratch, &target)?;
                // Renaming a link onto another link of the same file does nothing, and leaves both.
                let _ = std::fs::remove_file(&scratch);
                Ok(())
            }
        }
    }
}

impl Store {
    fn at(&self, name: &str) -> StorePath {
        name.split('/')
            .filter(|part| !part.is_empty())
            .fold(self.prefix.clone(), |path, part| path.join(part))
    }

    fn failed(&self, name: &str, error: &object_store::Error) -> DestinationError {
        DestinationError { place: format!("{}/{name}", self.url), problem: error.to_string(), hopeless: true }
    }

    /// Waits for an answer. Folders and memory need no runtime; clouds bring their own.
    #[cfg(not(feature = "cloud"))]
    fn wait<T>(&self, answer: impl Future<Output = T>) -> T {
        futures_executor::block_on(answer)
    }

    #[cfg(feature = "cloud")]
    fn wait<T>(&self, answer: impl Future<Output = T>) -> T {
        let _inside = self.runtime.enter();
        futures_executor::block_on(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use object_store::memory::InMemory;

    fn all(folder: &Path) -> Vec<Destination> {
        let local = folder.join("store");
        std::fs::create_dir(&local).unwrap();
        let memory = Arc::new(InMemory::new());
        vec![
            Destination::open(folder.join("plain").to_str().unwrap(), ".partial-1-of-1").unwrap(),
            Destination::open(&format!("file://{}", local.display()), "").unwrap(),
            Destination::in_store("memory:///", memory, StorePath::from("sweep")).unwrap(),
        ]
    }

    #[test]
    fn every_destination_keeps_and_gives_files() {
        let folder = tempfile::tempdir().unwrap();
        for place in all(folder.path()) {
            assert!(place.is_empty().unwrap());
            let claim = place.claim().unwrap();
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
        let open = || Destination::open(folder.path().to_str().unwrap(), ".partial-1-of-1").unwrap();
        let first = open();
        let claim = first.claim().unwrap();
        assert!(open().claim().unwrap_err().to_string().contains("another run is writing"));
        std::fs::write(folder.path().join(".partial-1-of-1/7"), "half").unwrap();
        // A killed process removes nothing.
        std::mem::forget(claim);
        drop(first);
        let other = Destination::open(folder.path().to_str().unwrap(), ".partial-2-of-2").unwrap();
        assert!(other.claim().is_ok());
    }

    #[test]
    fn unknown_stores_are_refused() {
        let error = Destination::open("gopher://x/y", "").unwrap_err().to_string();
        assert!(error.starts_with("gopher://x/y: "), "{error}");
    }
}
