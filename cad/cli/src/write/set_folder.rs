//! A folder that holds one set: it appears whole, what the set before leaves goes, and what is not ours stays.
//!
//! A new set is staged in a folder inside. Then a journal of all that is ours takes its name, the old manifest goes, the
//! files take their names, files of the old set go, the new manifest takes its name, and the journal goes. Killed between
//! any two steps, the folder holds the whole old set, the whole new one, or no manifest, and the next run knows from the
//! journal what is ours.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::output::OutputFile;

use super::folder_lock::{FolderLock, JOURNAL, Waiting};
use super::record::{Record, is_plain, read_if_there};
use super::steps::Step;
use super::{WriteError, refuse_obstacle};

/// Name of the folder for files that do not have their names yet.
const STAGED: &str = ".pinswitch-staged";
/// Longest text of others that a message repeats.
const SHOWN: usize = 120;

/// Why a set is not written. Nothing has changed, but for [`Self::Write`] in the last steps: then the folder has no
/// manifest, and the same command mends it.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The folder holds the set of another configuration.
    #[error(
        "{folder} holds the set made from {there}, and this one is made from {here}; give --force to replace it, or another --out"
    )]
    OtherSource {
        /// The folder.
        folder: String,
        /// What its set was made from.
        there: String,
        /// What this one is made from.
        here: String,
    },
    /// A file of the set's names is there, and no manifest of ours lists it.
    #[error("{0} is not from a set of ours; give --force to overwrite it, or another --out")]
    Foreign(String),
    /// A file of the set before was changed, and would be lost.
    #[error("{0} was changed since it was made; give --force to overwrite it, or another --out")]
    Changed(String),
}

/// A locked folder; nobody else of us writes there meanwhile.
#[derive(Debug)]
pub struct SetFolder {
    folder: PathBuf,
    lock: FolderLock,
}

impl SetFolder {
    /// Locks `folder`, which is made if need be, and removes what a dead run has left half written there. A folder that
    /// was made and stays empty goes again.
    ///
    /// # Errors
    /// [`WriteError`] if another process writes there, or nothing can be written.
    pub fn lock(folder: &Path) -> Result<Self, WriteError> {
        Self::locked(folder, Waiting::Never)
    }

    /// As [`Self::lock`], once no other process writes there.
    pub(super) fn wait(folder: &Path) -> Result<Self, WriteError> {
        Self::locked(folder, Waiting::UntilFree)
    }

    fn locked(folder: &Path, waiting: Waiting) -> Result<Self, WriteError> {
        let lock = FolderLock::take(folder, waiting).map_err(WriteError::at(folder))?;
        lock.sweep().map_err(WriteError::at(folder))?;
        Ok(Self { folder: folder.to_owned(), lock })
    }

    /// Whether a set made from `source` may be written here.
    ///
    /// # Errors
    /// [`PublishError::OtherSource`] if the folder holds the set of another configuration.
    pub fn check_source(&self, source: &SourceEntry) -> Result<(), PublishError> {
        match self.record()?.source {
            Some(there) if there != *source => Err(PublishError::OtherSource {
                folder: shown(&self.folder.display().to_string()),
                there: shown(&there.name),
                here: shown(&source.name),
            }),
            _ => Ok(()),
        }
    }

    /// Replaces the set in this folder by `files`, the manifest last. Returns what files of the set before it were
    /// changed since, and stay for that. `force` overwrites also what is not ours.
    ///
    /// # Errors
    /// [`PublishError`].
    pub fn publish(
        &self,
        files: &[OutputFile],
        source: &SourceEntry,
        force: bool,
    ) -> Result<Vec<String>, PublishError> {
        let plan = self.plan(files, source, force)?;
        self.take(&plan.steps)?;
        Ok(plan.kept)
    }

    /// Replaces `files`, the last of which stands for all, without a look at what else is there.
    ///
    /// # Errors
    /// [`WriteError`].
    pub(super) fn replace(&self, files: &[OutputFile]) -> Result<(), WriteError> {
        self.refuse_obstacles(files)?;
        let steps = self.stage(files)?;
        let first = steps.last().map(|seal| Step::Remove(seal.target().clone()));
        self.take(&first.into_iter().chain(steps).collect::<Vec<_>>())
    }

    fn plan(&self, files: &[OutputFile], source: &SourceEntry, force: bool) -> Result<Plan, PublishError> {
        self.refuse_obstacles(files)?;
        let before = self.record()?;
        if !force {
            self.refuse_foreign(files, &before)?;
        }
        let (stale, kept) = self.stale(files, &before)?;
        let record = before.with(files, source);
        let journal = serde_json::to_vec(&record)
            .map_err(|e| WriteError::at(&self.folder.join(JOURNAL))(std::io::Error::other(e)))?;
        let journal = self.stage(&[OutputFile::new(JOURNAL, journal)])?;
        let mut named = self.stage(files)?;
        let seal = named.pop();
        let mut steps = journal;
        steps.extend(seal.as_ref().map(|seal| Step::Remove(seal.target().clone())));
        steps.extend(named);
        steps.extend(stale.into_iter().map(Step::Remove));
        steps.extend(seal);
        steps.push(Step::Remove(self.folder.join(JOURNAL)));
        Ok(Plan { steps, kept })
    }

    fn record(&self) -> Result<Record, WriteError> {
        Record::read(&self.folder)
    }

    /// Writes the files into the folder for files without names; returns the steps that give them their names.
    fn stage(&self, files: &[OutputFile]) -> Result<Vec<Step>, WriteError> {
        let staged = self.folder.join(STAGED);
        std::fs::create_dir_all(&staged).map_err(WriteError::at(&staged))?;
        files
            .iter()
            .map(|file| {
                let (from, to) = (staged.join(&file.name), self.folder.join(&file.name));
                std::fs::write(&from, &file.bytes).map_err(WriteError::at(&to))?;
                Ok(Step::Rename { from, to })
            })
            .collect()
    }

    fn take(&self, steps: &[Step]) -> Result<(), WriteError> {
        steps.iter().try_for_each(|step| step.take().map_err(WriteError::at(step.target())))
    }

    /// Before anything changes: nothing may stand where a file must be, and no name may be a path.
    fn refuse_obstacles(&self, files: &[OutputFile]) -> Result<(), WriteError> {
        for file in files {
            let path = self.folder.join(&file.name);
            if !is_plain(&file.name) {
                return Err(WriteError::at(&path)(ErrorKind::InvalidInput.into()));
            }
            refuse_obstacle(&path)?;
        }
        Ok(())
    }

    /// A file that would be overwritten must be as we wrote it, or be the very same already.
    fn refuse_foreign(&self, files: &[OutputFile], before: &Record) -> Result<(), PublishError> {
        for file in files {
            let path = self.folder.join(&file.name);
            let Some(there) = read_if_there(&path).map_err(WriteError::at(&path))? else { continue };
            if there == file.bytes || before.wrote(&file.name, &there) {
                continue;
            }
            let name = shown(&path.display().to_string());
            let is_listed = before.files.contains_key(&file.name);
            return Err(if is_listed { PublishError::Changed(name) } else { PublishError::Foreign(name) });
        }
        Ok(())
    }

    /// Files of the set before that the new one does not have: those that are as we left them, and the names of those
    /// that were changed since.
    fn stale(
        &self,
        files: &[OutputFile],
        before: &Record,
    ) -> Result<(Vec<PathBuf>, Vec<String>), WriteError> {
        let (mut stale, mut kept) = (Vec::new(), Vec::new());
        for name in before.files.keys().filter(|name| files.iter().all(|file| file.name != **name)) {
            let path = self.folder.join(name);
            match std::fs::symlink_metadata(&path) {
                Ok(there) if there.is_file() => {
                    let bytes = std::fs::read(&path).map_err(WriteError::at(&path))?;
                    if before.wrote(name, &bytes) { stale.push(path) } else { kept.push(name.clone()) }
                }
                Ok(_) => kept.push(name.clone()),
                Err(_) => {}
            }
        }
        Ok((stale, kept))
    }
}

impl Drop for SetFolder {
    fn drop(&mut self) {
        // What cannot be removed now is removed by the next run.
        let _ = self.lock.sweep();
    }
}

/// How a folder gets a new set.
struct Plan {
    steps: Vec<Step>,
    /// Files of the set before that were changed and stay.
    kept: Vec<String>,
}

/// The end of a text that may be of any length: of a path, that says most.
fn shown(text: &str) -> String {
    let length = text.chars().count();
    if length <= SHOWN {
        text.to_owned()
    } else {
        format!("...{}", text.chars().skip(length - SHOWN).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::set::MANIFEST;
    use sha2::{Digest, Sha256};
    use std::collections::BTreeMap;

    type Files = BTreeMap<String, Vec<u8>>;

    /// A set of files with these contents, and its manifest.
    fn set(source: &str, contents: &[(&str, &str)]) -> (Vec<OutputFile>, SourceEntry) {
        let source = SourceEntry::new(source);
        let entry = |(name, text): &(&str, &str)| {
            let sha256: String = Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect();
            serde_json::json!({ "file": name, "sha256": sha256 })
        };
        let entries: Vec<_> = contents.iter().map(entry).collect();
        let manifest = serde_json::json!({ "schema": "pinswitch.set/1", "source": source, "files": entries });
        let mut files: Vec<_> = contents.iter().map(|(name, text)| OutputFile::new(*name, *text)).collect();
        files.push(OutputFile::new(MANIFEST, manifest.to_string()));
        (files, source)
    }

    fn there(folder: &Path) -> Files {
        let files = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file());
        let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
        files.map(|p| (name(&p), std::fs::read(&p).unwrap())).filter(|(n, _)| !n.starts_with('.')).collect()
    }

    fn bytes(files: &[OutputFile]) -> Files {
        files.iter().map(|f| (f.name.clone(), f.bytes.clone())).collect()
    }

    /// As if the process were killed after `steps` steps: nothing is tidied.
    fn killed_after(steps: usize, folder: &Path, files: &[OutputFile], source: &SourceEntry) -> bool {
        let place = SetFolder::lock(folder).unwrap();
        let plan = place.plan(files, source, true).unwrap();
        let last = steps >= plan.steps.len();
        plan.steps.iter().take(steps).for_each(|step| step.take().unwrap());
        // The lock goes with the process; the staged files stay.
        let half = folder.join(".pinswitch-half");
        let _ = std::fs::rename(folder.join(STAGED), &half);
        drop(place);
        std::fs::create_dir_all(&half).unwrap();
        std::fs::write(half.join("x"), "half").unwrap();
        last
    }

    #[test]
    fn killed_between_any_two_steps_a_set_is_whole_or_has_no_manifest() {
        let (old, old_source) =
            set("a.toml", &[("a", "old"), ("b", "old"), ("gone", "old"), ("same", "same")]);
        let (new, new_source) =
            set("a.toml", &[("a", "new"), ("b", "new"), ("more", "new"), ("same", "same")]);
        let (third, third_source) = set("a.toml", &[("a", "third")]);
        for steps in 0.. {
            let place = tempfile::tempdir().unwrap();
            let folder = place.path().join("out");
            SetFolder::lock(&folder).unwrap().publish(&old, &old_source, false).unwrap();
            std::fs::write(folder.join("mine"), "dear").unwrap();
            let last = killed_after(steps, &folder, &new, &new_source);
            let mut left = there(&folder);
            assert_eq!(left.remove("mine").unwrap(), b"dear");
            assert!(
                !left.contains_key(MANIFEST) || left == bytes(&old) || left == bytes(&new),
                "after {steps} steps: {:?}",
                left.keys()
            );
            // Another set, of which neither knows: nothing of both stays, and no half file.
            SetFolder::lock(&folder).unwrap().publish(&third, &third_source, false).unwrap();
            let mut left = there(&folder);
            assert_eq!(left.remove("mine").unwrap(), b"dear");
            assert_eq!(left, bytes(&third), "after {steps} steps");
            let hidden = std::fs::read_dir(&folder).unwrap().count() - third.len() - 1;
            assert_eq!(hidden, 0, "after {steps} steps");
            if last {
                assert!(steps > 8);
                break;
            }
        }
    }

    #[test]
    fn a_folder_in_the_way_changes_nothing() {
        let place = tempfile::tempdir().unwrap();
        let (old, source) = set("a.toml", &[("a", "old")]);
        SetFolder::lock(place.path()).unwrap().publish(&old, &source, false).unwrap();
        std::fs::create_dir(place.path().join("b")).unwrap();
        let (new, source) = set("a.toml", &[("a", "new"), ("b", "new")]);
        let error =
            SetFolder::lock(place.path()).unwrap().publish(&new, &source, true).unwrap_err().to_string();
        assert!(error.contains("/b: cannot write") && error.contains("move it away"), "{error}");
        assert_eq!(there(place.path()), bytes(&old));
    }

    #[test]
    fn a_manifest_that_lies_removes_nothing_outside() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("out");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("dear"), "dear").unwrap();
        std::fs::create_dir(folder.join("sub")).unwrap();
        std::fs::write(folder.join("sub/dear"), "dear").unwrap();
        let (files, _) = set("a.toml", &[("../dear", "dear"), ("sub/dear", "dear"), ("sub", "dear")]);
        std::fs::write(folder.join(MANIFEST), &files.last().unwrap().bytes).unwrap();
        let (new, source) = set("a.toml", &[("a", "new")]);
        SetFolder::lock(&folder).unwrap().publish(&new, &source, false).unwrap();
        assert!(place.path().join("dear").exists() && folder.join("sub/dear").exists());
    }

    #[test]
    fn what_is_not_ours_or_was_changed_stays() {
        let place = tempfile::tempdir().unwrap();
        let (old, source) = set("a.toml", &[("a", "old"), ("b", "old")]);
        std::fs::write(place.path().join("a"), "mine").unwrap();
        let error = SetFolder::lock(place.path()).unwrap().publish(&old, &source, false).unwrap_err();
        assert!(matches!(error, PublishError::Foreign(_)), "{error}");
        assert_eq!(there(place.path()).len(), 1);
        SetFolder::lock(place.path()).unwrap().publish(&old, &source, true).unwrap();
        std::fs::write(place.path().join("b"), "mine").unwrap();
        let (both, source) = set("a.toml", &[("a", "old"), ("b", "new")]);
        let error = SetFolder::lock(place.path()).unwrap().publish(&both, &source, false).unwrap_err();
        assert!(matches!(error, PublishError::Changed(_)), "{error}");
        assert_eq!(there(place.path())["b"], b"mine");
        let (new, source) = set("a.toml", &[("a", "new")]);
        let kept = SetFolder::lock(place.path()).unwrap().publish(&new, &source, false).unwrap();
        assert_eq!(kept, ["b"]);
        assert_eq!(there(place.path())["b"], b"mine");
    }

    #[test]
    fn a_set_of_another_configuration_stays() {
        let place = tempfile::tempdir().unwrap();
        let (old, source) = set("a/x.toml", &[("a", "old")]);
        let folder = SetFolder::lock(place.path()).unwrap();
        folder.publish(&old, &source, false).unwrap();
        let text = |name: &str| folder.check_source(&SourceEntry::new(name)).map_err(|e| e.to_string());
        assert_eq!(text("a/x.toml"), Ok(()));
        for other in ["x.toml", "c/a/x.toml", "../a/x.toml", "b/x.toml", "y.toml", "ax.toml", "a", "a/x"] {
            let error = text(other).unwrap_err();
            assert!(["a/x.toml", other, "--force", "--out"].iter().all(|w| error.contains(w)), "{error}");
        }
    }
}
