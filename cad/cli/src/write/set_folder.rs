//! A folder with one set of files, which is replaced as a whole.
//!
//! A new set is staged and committed. If a run is killed before the commit, the folder has the old set. If it is killed
//! during the commit, the folder has no manifest, and the next run completes the commit. Other files are left alone.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt};
use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::output::OutputFile;

use pinswitch_store::{FolderLock, LockPolicy, SINGLE_FILE_TIME, Staging, Step, is_plain};

use super::record::{Record, read_existing};
use super::{WriteError, check_file, lock_policy};
use crate::input::sources_from;
use crate::provenance::{PROVENANCE, Provenance};

/// Most characters of a source in an error.
const MAX_SOURCE: usize = 120;

/// A set that is not written. Nothing has changed, except by [`Self::Write`] in the last steps: then the folder has no
/// manifest, and running the command again completes the set.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The folder has the set of another configuration.
    #[error("{}: contains the set of another source, {existing}, while this set is made from {new}", folder.display())]
    OtherSource {
        /// The folder.
        folder: PathBuf,
        /// Source of its set.
        existing: String,
        /// Source of the new set.
        new: String,
    },
    /// A file with a name of the set exists, and no manifest of pinswitch lists it.
    #[error("{}: pinswitch did not write this file", .0.display())]
    Foreign(PathBuf),
    /// A file of the previous set was changed.
    #[error("{}: was changed since it was written", .0.display())]
    Changed(PathBuf),
}

impl From<PublishError> for Diagnostic {
    fn from(error: PublishError) -> Self {
        let (code, problem, path, help) = match error {
            PublishError::Write(error) => return error.into(),
            PublishError::OtherSource { folder, existing, new } => {
                let problem = format!(
                    "contains the set of another source, {}, while this set is made from {}",
                    excerpt(&existing, MAX_SOURCE),
                    excerpt(&new, MAX_SOURCE)
                );
                (codes::OTHER_SOURCE, problem, folder, "give --force to replace it, or another --out")
            }
            PublishError::Foreign(path) => (
                codes::FILE_IN_THE_WAY,
                "pinswitch did not write this file".to_owned(),
                path,
                "give --force to overwrite it, or another --out",
            ),
            PublishError::Changed(path) => (
                codes::CHANGED_FILE,
                "was changed since it was written".to_owned(),
                path,
                "give --force to overwrite it, or another --out",
            ),
        };
        Self::new(code, problem).with_location(Location::file(path.display().to_string())).with_help(help)
    }
}

/// A locked folder, into which no other process of pinswitch writes.
#[derive(Debug)]
pub struct SetFolder {
    folder: PathBuf,
    staging: Staging,
}

impl SetFolder {
    /// Locks `folder`, which is created if necessary, and removes the unfinished files of killed runs. A created folder
    /// that stays empty is removed at the end.
    ///
    /// # Errors
    /// [`WriteError`] if another process writes there for longer than `--wait`, or the folder cannot be written.
    pub fn lock(folder: &Path) -> Result<Self, WriteError> {
        Self::locked(folder, lock_policy())
    }

    /// As [`Self::lock`], for a few files next to others: waits for a second at least, so that commands that write into
    /// the same folder at the same time succeed.
    ///
    /// # Errors
    /// As [`Self::lock`].
    pub(crate) fn shared(folder: &Path) -> Result<Self, WriteError> {
        Self::locked(folder, lock_policy().at_least(SINGLE_FILE_TIME))
    }

    /// Returns the folder.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    fn locked(folder: &Path, policy: LockPolicy) -> Result<Self, WriteError> {
        let lock = FolderLock::take(folder, policy);
        let staging = lock.and_then(Staging::new).map_err(WriteError::at(folder))?;
        Ok(Self { folder: folder.to_owned(), staging })
    }

    /// Whether a set made from `source` may be written here.
    ///
    /// # Errors
    /// [`PublishError::OtherSource`] if the folder has the set of another configuration.
    pub fn check_source(&self, source: &SourceEntry) -> Result<(), PublishError> {
        match self.record()?.source {
            Some(existing) if existing != *source => Err(PublishError::OtherSource {
                folder: self.folder.clone(),
                existing: existing.name,
                new: source.name.clone(),
            }),
            _ => Ok(()),
        }
    }

    /// Replaces the set in this folder by `files`, the manifest last. Returns the stale files that stay because they were
    /// changed. `force` also overwrites files that pinswitch did not write or that were changed.
    ///
    /// # Errors
    /// [`PublishError`].
    pub fn publish(&self, files: &[OutputFile], force: bool) -> Result<Vec<String>, PublishError> {
        let plan = self.plan(files, force)?;
        self.commit(&plan.steps)?;
        Ok(plan.changed)
    }

    /// Replaces `files` without regard to other files. The last one marks the set as complete: it is removed first and
    /// written last.
    ///
    /// # Errors
    /// [`WriteError`].
    pub(crate) fn replace(&self, files: &[OutputFile]) -> Result<(), WriteError> {
        self.commit(&self.replacement(files, &[])?)
    }

    /// Stages `files`; returns the steps that replace them and remove the `stale` ones.
    fn replacement(&self, files: &[OutputFile], stale: &[&str]) -> Result<Vec<Step>, WriteError> {
        self.refuse_obstacles(files)?;
        let mut steps = self.stage(files)?;
        let seal = steps.pop();
        let removed = stale.iter().map(|name| Step::Remove((*name).to_owned()));
        let first = seal.as_ref().map(|seal| Step::Remove(seal.name().to_owned()));
        Ok(first.into_iter().chain(steps).chain(removed).chain(seal).collect())
    }

    /// As [`Self::replace`], and removes the `stale` files, and lists the files in the manifest of the folder, with every
    /// file that this process has read as their source.
    ///
    /// # Errors
    /// [`WriteError`]; of a damaged or foreign manifest before anything changes.
    pub(crate) fn replace_listed(
        &self,
        files: &[OutputFile],
        command: &str,
        stale: &[&str],
    ) -> Result<(), WriteError> {
        self.commit(&self.replacement(&self.listed(files, command, stale)?, stale)?)
    }

    /// Reads the file `name` in this folder; `None` if it does not exist.
    ///
    /// # Errors
    /// [`WriteError`] for a pipe, a device, or a file that cannot be read.
    pub(crate) fn existing(&self, name: &str) -> Result<Option<Vec<u8>>, WriteError> {
        let path = self.folder.join(name);
        read_existing(&path).map_err(WriteError::at(&path))
    }

    /// Returns the names of the unchanged files that earlier runs of `command` wrote here.
    ///
    /// # Errors
    /// [`WriteError`] of a damaged or foreign manifest, or a file that cannot be read.
    pub(crate) fn written_by(&self, command: &str) -> Result<Vec<String>, WriteError> {
        let provenance = self.provenance()?;
        let mut unchanged = Vec::new();
        for (name, sha256) in provenance.files_of(command) {
            if is_plain(name)
                && self.existing(name)?.is_some_and(|bytes| crate::provenance::sha256(&bytes) == sha256)
            {
                unchanged.push(name.to_owned());
            }
        }
        Ok(unchanged)
    }

    /// Returns `files` with the manifest that lists them, before the last file.
    fn listed(
        &self,
        files: &[OutputFile],
        command: &str,
        stale: &[&str],
    ) -> Result<Vec<OutputFile>, WriteError> {
        let Some((seal, others)) = files.split_last() else { return Ok(Vec::new()) };
        let manifest = self
            .provenance()?
            .retaining(|name| !stale.contains(&name) && self.folder.join(name).symlink_metadata().is_ok());
        let manifest = manifest.with_files(command, sources_from(&self.folder), files);
        let path = self.folder.join(PROVENANCE);
        let bytes = manifest.to_bytes().map_err(|e| WriteError::at(&path)(std::io::Error::other(e)))?;
        // Until it is renamed, after the other files, the earlier manifest reveals a mixture of both runs.
        Ok(others.iter().cloned().chain([OutputFile::new(PROVENANCE, bytes), seal.clone()]).collect())
    }

    /// Reads the manifest of provenance; an empty one if there is none.
    fn provenance(&self) -> Result<Provenance, WriteError> {
        let path = self.folder.join(PROVENANCE);
        match read_existing(&path).map_err(WriteError::at(&path))? {
            Some(bytes) => {
                Provenance::parse(&bytes).map_err(|problem| WriteError::Manifest { path, problem })
            }
            None => Ok(Provenance::default()),
        }
    }

    fn plan(&self, files: &[OutputFile], force: bool) -> Result<Plan, PublishError> {
        self.refuse_obstacles(files)?;
        let before = self.record()?;
        if !force {
            self.refuse_foreign(files, &before)?;
        }
        let (stale, changed) = self.stale(files, &before)?;
        let mut named = self.stage(files)?;
        let seal = named.pop();
        let mut steps: Vec<Step> = seal.iter().map(|seal| Step::Remove(seal.name().to_owned())).collect();
        steps.extend(named);
        steps.extend(stale.into_iter().map(Step::Remove));
        steps.extend(seal);
        Ok(Plan { steps, changed })
    }

    fn record(&self) -> Result<Record, WriteError> {
        Record::read(&self.folder)
    }

    /// Stages the files; returns the steps that rename them.
    fn stage(&self, files: &[OutputFile]) -> Result<Vec<Step>, WriteError> {
        let staged = |file: &OutputFile| {
            let step = self.staging.stage(&file.name, &file.bytes);
            step.map_err(WriteError::at(&self.folder.join(&file.name)))
        };
        files.iter().map(staged).collect()
    }

    fn commit(&self, steps: &[Step]) -> Result<(), WriteError> {
        self.staging.commit(steps).map_err(|e| WriteError::at(&self.folder.join(&e.name))(e.source))
    }

    /// Refuses names that are paths and places that are occupied by folders or inputs, before anything changes.
    fn refuse_obstacles(&self, files: &[OutputFile]) -> Result<(), WriteError> {
        for file in files {
            let path = self.folder.join(&file.name);
            if !is_plain(&file.name) {
                return Err(WriteError::at(&path)(ErrorKind::InvalidInput.into()));
            }
            check_file(&path)?;
        }
        Ok(())
    }

    /// Refuses to overwrite files that pinswitch did not write or that were changed; equal content is accepted.
    fn refuse_foreign(&self, files: &[OutputFile], before: &Record) -> Result<(), PublishError> {
        for file in files {
            let path = self.folder.join(&file.name);
            let Some(existing) = read_existing(&path).map_err(WriteError::at(&path))? else { continue };
            if existing == file.bytes || before.wrote(&file.name, &existing) {
                continue;
            }
            let is_listed = before.files.contains_key(&file.name);
            return Err(if is_listed { PublishError::Changed(path) } else { PublishError::Foreign(path) });
        }
        Ok(())
    }

    /// Returns the files of the previous set that the new one lacks: the unchanged ones, and the names of the changed
    /// ones.
    fn stale(&self, files: &[OutputFile], before: &Record) -> Result<(Vec<String>, Vec<String>), WriteError> {
        let (mut stale, mut changed) = (Vec::new(), Vec::new());
        for name in before.files.keys().filter(|name| files.iter().all(|file| file.name != **name)) {
            let path = self.folder.join(name);
            match std::fs::symlink_metadata(&path) {
                Ok(existing) if existing.is_file() => {
                    let bytes = read_existing(&path).map_err(WriteError::at(&path))?.unwrap_or_default();
                    if before.wrote(name, &bytes) {
                        stale.push(name.clone())
                    } else {
                        changed.push(name.clone())
                    }
                }
                Ok(_) => changed.push(name.clone()),
                Err(_) => {}
            }
        }
        Ok((stale, changed))
    }
}

/// The steps that replace a set.
struct Plan {
    steps: Vec<Step>,
    /// Files of the previous set that were changed, and stay.
    changed: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::set::MANIFEST;
    use sha2::{Digest, Sha256};
    use std::collections::BTreeMap;

    type Files = BTreeMap<String, Vec<u8>>;

    /// Returns files with these contents, and their manifest.
    fn set(source: &str, contents: &[(&str, &str)]) -> Vec<OutputFile> {
        let source = SourceEntry::new(source);
        let entry = |(name, text): &(&str, &str)| {
            let sha256: String = Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect();
            serde_json::json!({ "file": name, "sha256": sha256 })
        };
        let entries: Vec<_> = contents.iter().map(entry).collect();
        let manifest = serde_json::json!({ "schema": "pinswitch.set/1", "source": source, "files": entries });
        let mut files: Vec<_> = contents.iter().map(|(name, text)| OutputFile::new(*name, *text)).collect();
        files.push(OutputFile::new(MANIFEST, manifest.to_string()));
        files
    }

    fn there(folder: &Path) -> Files {
        let files = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file());
        let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
        files.map(|p| (name(&p), std::fs::read(&p).unwrap())).filter(|(n, _)| !n.starts_with('.')).collect()
    }

    fn bytes(files: &[OutputFile]) -> Files {
        files.iter().map(|f| (f.name.clone(), f.bytes.clone())).collect()
    }

    #[test]
    fn an_obstacle_changes_nothing() {
        let place = tempfile::tempdir().unwrap();
        let old = set("a.toml", &[("a", "old")]);
        SetFolder::lock(place.path()).unwrap().publish(&old, false).unwrap();
        std::fs::create_dir(place.path().join("b")).unwrap();
        let new = set("a.toml", &[("a", "new"), ("b", "new")]);
        let error = SetFolder::lock(place.path()).unwrap().publish(&new, true).unwrap_err();
        let error = Diagnostic::from(error).to_string();
        assert!(error.contains("/b: cannot write") && error.contains("move it away"), "{error}");
        assert_eq!(there(place.path()), bytes(&old));
    }

    #[test]
    fn a_false_manifest_removes_nothing_outside() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("out");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("dear"), "dear").unwrap();
        std::fs::create_dir(folder.join("sub")).unwrap();
        std::fs::write(folder.join("sub/dear"), "dear").unwrap();
        let files = set("a.toml", &[("../dear", "dear"), ("sub/dear", "dear"), ("sub", "dear")]);
        std::fs::write(folder.join(MANIFEST), &files.last().unwrap().bytes).unwrap();
        let new = set("a.toml", &[("a", "new")]);
        SetFolder::lock(&folder).unwrap().publish(&new, false).unwrap();
        assert!(place.path().join("dear").exists() && folder.join("sub/dear").exists());
    }

    #[test]
    fn foreign_and_changed_files_stay() {
        let place = tempfile::tempdir().unwrap();
        let old = set("a.toml", &[("a", "old"), ("b", "old")]);
        std::fs::write(place.path().join("a"), "mine").unwrap();
        let error = SetFolder::lock(place.path()).unwrap().publish(&old, false).unwrap_err();
        assert!(matches!(error, PublishError::Foreign(_)), "{error}");
        assert_eq!(there(place.path()).len(), 1);
        SetFolder::lock(place.path()).unwrap().publish(&old, true).unwrap();
        std::fs::write(place.path().join("b"), "mine").unwrap();
        let both = set("a.toml", &[("a", "old"), ("b", "new")]);
        let error = SetFolder::lock(place.path()).unwrap().publish(&both, false).unwrap_err();
        assert!(matches!(error, PublishError::Changed(_)), "{error}");
        assert_eq!(there(place.path())["b"], b"mine");
        let new = set("a.toml", &[("a", "new")]);
        let changed = SetFolder::lock(place.path()).unwrap().publish(&new, false).unwrap();
        assert_eq!(changed, ["b"]);
        assert_eq!(there(place.path())["b"], b"mine");
    }

    #[test]
    fn the_set_of_another_source_stays() {
        let place = tempfile::tempdir().unwrap();
        let old = set("a/x.toml", &[("a", "old")]);
        let folder = SetFolder::lock(place.path()).unwrap();
        folder.publish(&old, false).unwrap();
        let check = |name: &str| folder.check_source(&SourceEntry::new(name));
        let text = |name: &str| check(name).map_err(|e| Diagnostic::from(e).to_string());
        assert_eq!(text("a/x.toml"), Ok(()));
        for other in ["x.toml", "c/a/x.toml", "../a/x.toml", "b/x.toml", "y.toml", "ax.toml", "a", "a/x"] {
            let error = text(other).unwrap_err();
            assert!(["a/x.toml", other, "--force", "--out"].iter().all(|w| error.contains(w)), "{error}");
        }
    }
}
