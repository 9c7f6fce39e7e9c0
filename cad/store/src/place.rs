//! What is at a path: types, permissions and sizes that are checked before a file is opened.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Reads the file at `path`, a name that pinswitch gives; `None` if it does not exist.
///
/// # Errors
/// `InvalidInput` for a pipe, a device or a socket; `FileTooLarge` above `most` bytes; the error of the file
/// system.
pub fn read_own(path: &Path, most: u64) -> Result<Option<Vec<u8>>> {
    let file = match std::fs::metadata(path) {
        Ok(facts) if facts.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(facts) => require_ordinary(&facts).and_then(|()| open_to_read(path)),
        Err(e) => Err(e),
    };
    let file = match file {
        Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => return Ok(None),
        other => other?,
    };
    // It may have been replaced since.
    require_ordinary(&file.metadata()?)?;
    read_bounded(file, most).map(Some)
}

/// Reads at most `most` bytes of an input: an ordinary file, or a pipe or a device in `/dev` or `/proc`, such as the
/// `/dev/fd/63` of `<(...)`. A pipe elsewhere may have no writer, and would be waited for without end.
///
/// # Errors
/// `FileTooLarge` above `most` bytes; `InvalidInput` for a pipe; the error of the file system.
pub fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>> {
    if !["/dev", "/proc"].iter().any(|place| path.starts_with(place)) {
        let facts = std::fs::metadata(path)?;
        if !facts.is_dir() {
            require_ordinary(&facts)?;
        }
    }
    read_bounded(File::open(path)?, most)
}

fn read_bounded(file: File, most: u64) -> Result<Vec<u8>> {
    let too_large = || Error::new(ErrorKind::FileTooLarge, format!("the file has more than {most} bytes"));
    if file.metadata()?.len() > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    // A pipe has no length.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// Refuses what is not an ordinary file.
pub(crate) fn require_ordinary(facts: &Metadata) -> Result<()> {
    if facts.is_file() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::InvalidInput, "it is a pipe, a device or a socket, not an ordinary file"))
}

/// Refuses an empty path, which would be the current folder.
pub(crate) fn require_path(path: &Path) -> Result<()> {
    if path.as_os_str().is_empty() {
        return Err(Error::new(ErrorKind::InvalidInput, "the path is empty"));
    }
    Ok(())
}

/// Refuses a file whose owner has taken away the permission to write it. Renaming another file over it would
/// not be refused by the system, nor would anything for an administrator.
pub(crate) fn require_writable(facts: &Metadata) -> Result<()> {
    if facts.permissions().readonly() {
        return Err(Error::new(ErrorKind::PermissionDenied, "the file is write-protected"));
    }
    Ok(())
}

/// Options that do not wait for the other end of a pipe.
pub(crate) fn without_waiting() -> OpenOptions {
    #[cfg_attr(not(unix), allow(unused_mut))]
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        let flags = rustix::fs::OFlags::NONBLOCK.bits();
        options.custom_flags(i32::try_from(flags).unwrap_or(0));
    }
    options
}

fn open_to_read(path: &Path) -> Result<File> {
    without_waiting().read(true).open(path)
}

/// A builder of temporary files with the permissions of ordinary files: temporary files are private
/// by default.
#[cfg(unix)]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    builder
}

/// A builder of temporary files.
#[cfg(not(unix))]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    tempfile::Builder::new()
}

/// Returns whether `path` or a parent of it is a dangling or cyclic symlink; for these, the system
/// reports only that a file exists.
pub fn is_dangling_symlink(path: &Path) -> bool {
    let is_link = |path: &Path| std::fs::symlink_metadata(path).is_ok_and(|file| file.is_symlink());
    path.ancestors().any(|path| is_link(path) && std::fs::metadata(path).is_err())
}

/// Returns the remedy for a file or folder at `path` that cannot be written.
pub fn write_help(path: &Path, error: &Error) -> &'static str {
    if is_dangling_symlink(path) {
        return "remove it, or give another --out";
    }
    match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            "a file is in place of a folder: move it away, or give another --out"
        }
        ErrorKind::IsADirectory => "a folder is in place of a file: move it away, or give another --out",
        ErrorKind::WouldBlock => "wait for the other run (--wait SECONDS) or end it, or give another --out",
        ErrorKind::NotFound => "create its folder, or give another --out",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room, or give another --out",
        ErrorKind::InvalidFilename => "give a shorter --out without characters that the system refuses",
        ErrorKind::InvalidInput if path.as_os_str().is_empty() => "give a path",
        ErrorKind::InvalidInput => "move it away, or give another --out",
        _ => "give an --out that can be written",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_file_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        assert_eq!(read_own(&file, 9).unwrap(), None);
        std::fs::write(&file, "0123456789").unwrap();
        assert_eq!(read_own(&file, 10).unwrap().unwrap(), b"0123456789");
        assert_eq!(read_own(&file, 9).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(read_own(&file.join("b"), 9).unwrap(), None);
        assert_eq!(read_own(folder.path(), 9).unwrap_err().kind(), ErrorKind::IsADirectory);
    }

    #[cfg(unix)]
    #[test]
    fn special_files_are_refused_unopened() {
        let folder = tempfile::tempdir().unwrap();
        let (pipe, endless) = (folder.path().join("pipe"), folder.path().join("endless"));
        rustix::fs::mknodat(
            rustix::fs::CWD,
            &pipe,
            rustix::fs::FileType::Fifo,
            rustix::fs::Mode::from_raw_mode(0o600),
            0,
        )
        .unwrap();
        std::os::unix::fs::symlink("/dev/zero", &endless).unwrap();
        for path in [&pipe, &endless] {
            let error = read_own(path, 9).unwrap_err();
            assert!(error.to_string().contains("not an ordinary file"), "{error}");
        }
    }
}
