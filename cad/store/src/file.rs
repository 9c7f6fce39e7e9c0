//! Replaces one file. A reader finds the old file or the new one, never a part.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::TEMPORARY_PREFIX;
use crate::lock::{FolderLock, LockPolicy};
use crate::place::{
    read_own, require_ordinary, require_path, require_writable, temporary_file, without_waiting,
};
use crate::staging::Staging;

/// End of the names of temporary files.
pub(crate) const TEMPORARY_SUFFIX: &str = ".part";

/// Time for which a single file waits for others, which take milliseconds: commands that run at the same time and each
/// write one file into a folder succeed.
pub const SINGLE_FILE_TIME: Duration = Duration::from_secs(1);

/// Why a file is not rewritten; it is unchanged.
#[derive(Debug)]
pub enum RewriteError {
    /// Its content is not the expected one: another program has written it.
    Changed,
    /// The error of the file system.
    System(Error),
}

impl From<Error> for RewriteError {
    fn from(error: Error) -> Self {
        Self::System(error)
    }
}

/// Replaces the file at `path`, which may not exist, or the target of a symlink. A pipe or a terminal is written to.
///
/// # Errors
/// `WouldBlock` if another process writes into its folder for longer than `policy` and one second; `NotFound` if its
/// folder does not exist; `PermissionDenied` if it is write-protected; the error of the file system.
pub fn replace_file(path: &Path, bytes: &[u8], policy: LockPolicy) -> Result<()> {
    replace_file_with(path, policy, |file| file.write_all(bytes))
}

/// As [`replace_file`], with content that `write` produces: a file that is larger than the memory is written in steps.
///
/// # Errors
/// As [`replace_file`], and the error of `write`; the old file is unchanged.
pub fn replace_file_with(
    path: &Path,
    policy: LockPolicy,
    write: impl FnOnce(&mut File) -> Result<()>,
) -> Result<()> {
    require_path(path)?;
    let path = &target(path)?;
    match std::fs::metadata(path) {
        Ok(existing) if existing.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(existing) if !existing.is_file() => return write(&mut open_special(path)?),
        _ => {}
    }
    let (staging, temporary) = staged_next_to(path, write, policy)?;
    temporary.persist(path).map_err(|e| e.error)?;
    drop(staging);
    Ok(())
}

/// Replaces the file at `path`, whose content is expected to be `expected`, or which is expected to be missing. If
/// `path` is a symlink, replaces its target. A file with several hard links keeps them.
///
/// An editor that saves the file at the same time is noticed: where the system can exchange two files, the replaced
/// content is compared, and put back if it is not the expected one.
///
/// # Errors
/// [`RewriteError`]; its system errors are those of [`replace_file`], and `InvalidInput` for a pipe or a device.
pub fn rewrite_file(
    path: &Path,
    expected: Option<&[u8]>,
    bytes: &[u8],
    policy: LockPolicy,
) -> std::result::Result<(), RewriteError> {
    require_path(path)?;
    let path = &target(path)?;
    if let Ok(existing) = std::fs::metadata(path) {
        if existing.is_dir() {
            return Err(Error::from(ErrorKind::IsADirectory).into());
        }
        require_ordinary(&existing)?;
    }
    let (_lock, temporary) = staged_next_to(path, |file| file.write_all(bytes), policy)?;
    // A file of another length cannot be the expected one.
    let most = expected.map_or(0, <[u8]>::len) as u64;
    let is_expected = |path: &Path| match read_own(path, most) {
        Ok(found) => Ok(found.as_deref() == expected),
        Err(e) if e.kind() == ErrorKind::FileTooLarge => Ok(false),
        Err(e) => Err(e),
    };
    if !is_expected(path)? {
        return Err(RewriteError::Changed);
    }
    if expected.is_none() {
        return match temporary.persist_noclobber(path) {
            Ok(_) => Ok(()),
            Err(e) if e.error.kind() == ErrorKind::AlreadyExists => Err(RewriteError::Changed),
            Err(e) => Err(e.error.into()),
        };
    }
    if is_linked(&std::fs::metadata(path)?) {
        // Its room is needed here.
        drop(temporary);
        return rewrite_in_place(path, expected.unwrap_or_default(), bytes);
    }
    match exchange(temporary.path(), path) {
        Ok(()) if is_expected(temporary.path())? => Ok(()),
        Ok(()) => {
            exchange(temporary.path(), path)?;
            Err(RewriteError::Changed)
        }
        Err(e) if matches!(e.kind(), ErrorKind::Unsupported | ErrorKind::InvalidInput) => {
            temporary.persist(path).map_err(|e| e.error)?;
            Ok(())
        }
        Err(e) => Err(e.into()),
    }
}

/// Rewrites a file with several links in place. The room is reserved first; if writing fails all the same, the old
/// content is restored, which needs no more room.
fn rewrite_in_place(path: &Path, expected: &[u8], bytes: &[u8]) -> std::result::Result<(), RewriteError> {
    let mut file = without_waiting().read(true).write(true).open(path)?;
    reserve(&file, bytes.len() as u64)?;
    let mut now = Vec::new();
    (&mut file).take(expected.len() as u64 + 1).read_to_end(&mut now)?;
    if now != expected {
        return Err(RewriteError::Changed);
    }
    let mut write = |content: &[u8]| {
        file.rewind()?;
        file.write_all(content)?;
        file.set_len(content.len() as u64)
    };
    write(bytes).map_err(|e| {
        let _ = write(expected);
        RewriteError::System(e)
    })
}

/// Reserves room for a file of this length, where the system can, without changing its content or length.
#[cfg(target_os = "linux")]
fn reserve(file: &File, length: u64) -> Result<()> {
    use rustix::fs::{FallocateFlags, fallocate};
    match fallocate(file, FallocateFlags::KEEP_SIZE, 0, length.max(1)).map_err(Error::from) {
        Err(e) if matches!(e.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded) => Err(e),
        // Some file systems cannot.
        _ => Ok(()),
    }
}

#[cfg(not(target_os = "linux"))]
fn reserve(_: &File, _: u64) -> Result<()> {
    Ok(())
}

/// Returns the file that is replaced: the target of a symlink.
fn target(path: &Path) -> Result<PathBuf> {
    if path.is_symlink() { path.canonicalize() } else { Ok(path.to_owned()) }
}

/// Creates a temporary file in a locked folder, which [`remove_temporaries`](crate::remove_temporaries) recognises.
///
/// # Errors
/// The error of the file system.
pub fn temporary_in(folder: &Path) -> Result<tempfile::NamedTempFile> {
    temporary_file().prefix(TEMPORARY_PREFIX).suffix(TEMPORARY_SUFFIX).tempfile_in(folder)
}

/// Locks the folder of `path` and stages a file in it.
fn staged_next_to(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<()>,
    policy: LockPolicy,
) -> Result<(Staging, tempfile::NamedTempFile)> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    if !folder.is_dir() {
        return Err(ErrorKind::NotFound.into());
    }
    let existing = replaceable(path)?;
    let lock = Staging::new(FolderLock::take(folder, policy.at_least(SINGLE_FILE_TIME))?)?;
    let mut temporary = temporary_in(folder)?;
    write(temporary.as_file_mut())?;
    if let Some(existing) = existing {
        keep_attributes(temporary.as_file(), &existing)?;
    }
    Ok((lock, temporary))
}

/// Writes `bytes` to `from`, with the attributes of the file at `to`, which it will replace.
pub(crate) fn stage_at(from: &Path, to: &Path, bytes: &[u8]) -> Result<()> {
    let existing = replaceable(to)?;
    let mut file = File::create(from)?;
    file.write_all(bytes)?;
    match existing {
        Some(existing) => keep_attributes(&file, &existing),
        None => Ok(()),
    }
}

/// Returns the attributes of the file at `path`, which will be replaced; `None` if there is none.
fn replaceable(path: &Path) -> Result<Option<Metadata>> {
    match std::fs::symlink_metadata(path) {
        Ok(existing) if existing.is_file() => require_writable(&existing).map(|()| Some(existing)),
        _ => Ok(None),
    }
}

/// Gives `file` the permissions and the owner of `existing`.
#[cfg(unix)]
fn keep_attributes(file: &File, existing: &Metadata) -> Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let new = file.metadata()?;
    if (new.uid(), new.gid()) != (existing.uid(), existing.gid()) {
        // Only an administrator may; others own what they write.
        let _ = fchown(file, Some(existing.uid()), Some(existing.gid()));
    }
    file.set_permissions(existing.permissions())
}

/// Gives `file` the permissions of `existing`.
#[cfg(not(unix))]
fn keep_attributes(file: &File, existing: &Metadata) -> Result<()> {
    file.set_permissions(existing.permissions())
}

#[cfg(unix)]
fn is_linked(existing: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(existing) > 1
}

#[cfg(not(unix))]
fn is_linked(_: &Metadata) -> bool {
    false
}

/// Exchanges two files in one step.
#[cfg(target_os = "linux")]
fn exchange(one: &Path, other: &Path) -> Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE).map_err(Error::from)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> Result<()> {
    Err(ErrorKind::Unsupported.into())
}

/// Opens a pipe that is being read, or a device.
fn open_special(path: &Path) -> Result<File> {
    let file = without_waiting().write(true).open(path);
    #[cfg(unix)]
    let file = file.map_err(|e| {
        let is_unread = e.raw_os_error() == Some(rustix::io::Errno::NXIO.raw_os_error());
        if is_unread { Error::new(ErrorKind::BrokenPipe, "no program reads this pipe") } else { e }
    });
    let file = file?;
    // A reader that is slower than this command is waited for.
    #[cfg(unix)]
    rustix::fs::fcntl_setfl(&file, rustix::fs::OFlags::empty())?;
    Ok(file)
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::os::unix::fs::{MetadataExt, PermissionsExt};

    const WAIT: LockPolicy = LockPolicy::Refuse;

    fn mode(path: &Path) -> u32 {
        std::fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    fn names(folder: &Path) -> usize {
        std::fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn attributes_of_a_file_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "old").unwrap();
        for bits in [0o600, 0o640, 0o755] {
            std::fs::set_permissions(&path, PermissionsExt::from_mode(bits)).unwrap();
            replace_file(&path, b"new", WAIT).unwrap();
            assert_eq!(mode(&path), bits);
            rewrite_file(&path, Some(b"new"), b"newer", WAIT).unwrap();
            assert_eq!((mode(&path), std::fs::read(&path).unwrap()), (bits, b"newer".to_vec()));
        }
        std::fs::set_permissions(&path, PermissionsExt::from_mode(0o444)).unwrap();
        let error = replace_file(&path, b"x", WAIT).unwrap_err();
        assert_eq!(
            (error.kind(), &*error.to_string()),
            (ErrorKind::PermissionDenied, "the file is write-protected")
        );
        assert!(rewrite_file(&path, Some(b"newer"), b"x", WAIT).is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"newer");
        assert_eq!(names(folder.path()), 1);
    }

    #[test]
    fn links_of_a_file_are_kept() {
        let place = tempfile::tempdir().unwrap();
        let [file, hard, soft] = ["there/mine.toml", "hard.toml", "soft.toml"].map(|n| place.path().join(n));
        std::fs::create_dir(place.path().join("there")).unwrap();
        std::fs::write(&file, "a long old text").unwrap();
        std::fs::hard_link(&file, &hard).unwrap();
        std::os::unix::fs::symlink("there/mine.toml", &soft).unwrap();
        rewrite_file(&soft, Some(b"a long old text"), b"new", WAIT).unwrap();
        assert!(soft.is_symlink());
        for path in [&file, &hard] {
            assert_eq!(std::fs::read(path).unwrap(), b"new");
        }
        assert_eq!(std::fs::metadata(&file).unwrap().nlink(), 2);
    }

    #[test]
    fn a_changed_file_is_not_rewritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        for (content, expected) in
            [(Some("theirs"), None), (Some("theirs"), Some("old")), (None, Some("old"))]
        {
            let _ = std::fs::remove_file(&path);
            content.iter().for_each(|text| std::fs::write(&path, text).unwrap());
            let outcome = rewrite_file(&path, expected.map(str::as_bytes), b"ours", WAIT);
            assert!(matches!(outcome, Err(RewriteError::Changed)), "{content:?} {expected:?}");
            assert_eq!(std::fs::read_to_string(&path).ok().as_deref(), content);
        }
        assert_eq!(names(folder.path()), 1 - usize::from(!path.exists()));
        let _ = std::fs::remove_file(&path);
        rewrite_file(&path, None, b"ours", WAIT).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"ours");
    }

    /// Another program replaces the file again and again; no text of it disappears unread.
    #[test]
    fn an_editor_loses_no_text() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "start").unwrap();
        let mut last = b"start".to_vec();
        let mut saved = 0;
        for nth in 0..200 {
            let text = format!("theirs {nth}").into_bytes();
            std::thread::scope(|scope| {
                let editor = scope.spawn(|| {
                    let other = folder.path().join("editor");
                    std::fs::write(&other, &text).unwrap();
                    std::thread::sleep(Duration::from_micros(nth * 5));
                    std::fs::rename(&other, &path).unwrap();
                });
                // Either the rewrite found the editor's text and refused, or the editor came later.
                match rewrite_file(&path, Some(&last), b"ours", WAIT) {
                    Ok(()) => saved += 1,
                    Err(RewriteError::Changed) => {}
                    Err(RewriteError::System(e)) => panic!("{e}"),
                }
                editor.join().unwrap();
            });
            let now = std::fs::read(&path).unwrap();
            assert_eq!(now, text, "round {nth}: the editor's text is lost");
            last = now;
        }
        assert!(saved > 0);
    }

    #[test]
    fn a_pipe_without_a_reader_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        let (cwd, mode) = (rustix::fs::CWD, rustix::fs::Mode::from_raw_mode(0o600));
        rustix::fs::mknodat(cwd, &path, rustix::fs::FileType::Fifo, mode, 0).unwrap();
        assert_eq!(replace_file(&path, b"x", WAIT).unwrap_err().to_string(), "no program reads this pipe");
        assert!(rewrite_file(&path, None, b"x", WAIT).is_err());
        replace_file(Path::new("/dev/null"), b"x", WAIT).unwrap();
    }
}
