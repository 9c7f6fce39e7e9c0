//! Files are written whole or not at all: a temporary file beside the target, then a rename.

use std::io::Write;
use std::path::{Path, PathBuf};

use pinswitch_switch::output::OutputFile;

/// A file or folder cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot write: {source}", path.display())]
pub struct WriteError {
    path: PathBuf,
    source: std::io::Error,
}

impl WriteError {
    fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self { path: path.to_owned(), source }
    }
}

/// Writes `bytes` to `path`: a reader sees the old file or the new one, never a part of it.
///
/// # Errors
/// [`WriteError`] names the path; the old file is untouched.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    stage(path, bytes)?.persist(path).map_err(|e| WriteError::at(path)(e.error))?;
    Ok(())
}

/// Writes all files into `folder`, which is made if need be. Every file is complete on disk before the first takes
/// its name, and the last one, the manifest, takes its name last.
///
/// # Errors
/// [`WriteError`] names the path.
pub fn write_set(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    std::fs::create_dir_all(folder).map_err(WriteError::at(folder))?;
    let staged: Vec<_> = files
        .iter()
        .map(|file| {
            let path = folder.join(&file.name);
            stage(&path, &file.bytes).map(|temporary| (path, temporary))
        })
        .collect::<Result<_, _>>()?;
    for (path, temporary) in staged {
        temporary.persist(&path).map_err(|e| WriteError::at(&path)(e.error))?;
    }
    Ok(())
}

/// The bytes in a temporary file beside `path`; it vanishes unless it is renamed.
fn stage(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile, WriteError> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pinswitch-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private; what takes the target's name is an ordinary file.
        builder.permissions(std::fs::Permissions::from_mode(0o644));
    }
    let mut temporary = builder.tempfile_in(folder).map_err(WriteError::at(path))?;
    temporary.write_all(bytes).map_err(WriteError::at(path))?;
    Ok(temporary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_set_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| OutputFile { name: name.to_owned(), bytes: b"new".to_vec() };
        std::fs::write(folder.path().join("a"), "old").unwrap();
        let failed = write_set(folder.path(), &[file("a"), file("no/such/folder")]);
        assert!(failed.unwrap_err().to_string().contains("cannot write"));
        assert_eq!(std::fs::read_to_string(folder.path().join("a")).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write_set(folder.path(), &[file("a"), file("b")]).unwrap();
        assert_eq!(std::fs::read_to_string(folder.path().join("a")).unwrap(), "new");
    }
}
