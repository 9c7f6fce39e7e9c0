//! Files and folders that commands write: locked, staged, and replaced as a whole.
//!
//! | type or function | purpose |
//! | --- | --- |
//! | [`FolderLock`] | one process writes into a folder at a time; [`LockPolicy`] decides whether others wait |
//! | [`Staging`] | stages the files of a folder, then replaces and removes files in one step |
//! | [`recover`] | completes that step, if a run was killed in it |
//! | [`replace_file`], [`replace_file_with`] | replaces one file, from bytes or in steps |
//! | [`rewrite_file`] | replaces a file that a person may be editing at the same time |
//! | [`read_own`] | reads a file under a name that pinswitch gives, if it is an ordinary file |
//! | [`read_at_most`] | reads an input, which may be a pipe |
//!
//! A replaced file keeps its permissions and its owner. A write-protected file is not replaced. Pipes,
//! devices and sockets are recognised by their type before they are opened, so that none of them can delay
//! a command.
//!
//! ```
//! use pinswitch_store::{FolderLock, LockPolicy, Staging, Step};
//!
//! # let place = tempfile::tempdir()?;
//! let folder = place.path().join("set");
//! let staging = Staging::new(FolderLock::take(&folder, LockPolicy::Refuse)?)?;
//! let steps = [staging.stage("a.txt", b"one")?, Step::Remove("old.txt".to_owned())];
//! staging.commit(&steps)?;
//! drop(staging);
//! assert_eq!(std::fs::read(folder.join("a.txt"))?, b"one");
//! # Ok::<(), std::io::Error>(())
//! ```

mod file;
mod lock;
mod place;
mod staging;

pub use file::{RewriteError, SINGLE_FILE_TIME, replace_file, replace_file_with, rewrite_file, temporary_in};
pub use lock::{Busy, FolderLock, LockPolicy};
pub use place::{is_dangling_symlink, read_at_most, read_own, temporary_file, write_help};
pub use staging::{CommitError, Staging, Step, is_plain, recover, remove_temporaries};

/// Begin of the names of temporary files.
pub(crate) const TEMPORARY_PREFIX: &str = ".pinswitch-";
