//! The program: where it is, its settings, and one run for each file.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use crate::estimate::PrintEstimate;
use crate::settings::{PrintSettings, maker, without_time};

/// Names that the program has on a search path.
const NAMES: [&str; 4] = ["prusa-slicer", "PrusaSlicer", "prusa-slicer-console.exe", "prusa-slicer.exe"];
/// Environment variable that names the program; it goes before the search path.
pub const PROGRAM_VARIABLE: &str = "PINSWITCH_SLICER";
/// Most characters of what a slicer says that are passed on.
const LONGEST: usize = 300;

/// Why a slicer cannot be asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SlicerError {
    /// The variable names no program.
    #[error(
        "{PROGRAM_VARIABLE} = {0}: there is no such program; give the path of PrusaSlicer's program, or unset it"
    )]
    NoProgram(String),
    /// The program cannot be started, or its files not be written or read.
    #[error("{program}: {source}")]
    Io {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// It ended without a result.
    #[error("{program} did not slice {file}: {said}")]
    Refused {
        /// The program.
        program: String,
        /// What it was given.
        file: String,
        /// What it said.
        said: String,
    },
}

impl SlicerError {
    /// Whether the caller's environment is at fault, rather than the slicer.
    pub const fn is_bad_input(&self) -> bool {
        matches!(self, Self::NoProgram(_))
    }
}

/// An installed slicer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slicer {
    program: PathBuf,
}

/// The slicer that `variable` (of [`PROGRAM_VARIABLE`]) names, or else the first on the search path; `None` if there is none.
///
/// # Errors
/// [`SlicerError::NoProgram`] if the variable names no file.
pub fn find(variable: Option<&OsStr>, search_path: Option<&OsStr>) -> Result<Option<Slicer>, SlicerError> {
    let folders: Vec<PathBuf> = search_path.map(|p| std::env::split_paths(p).collect()).unwrap_or_default();
    let on_path = |name: &Path| folders.iter().map(|folder| folder.join(name)).find(|file| file.is_file());
    match variable.filter(|v| !v.is_empty()).map(Path::new) {
        Some(named) => {
            let found = if named.is_file() { Some(named.to_owned()) } else { on_path(named) };
            let program = found.ok_or_else(|| SlicerError::NoProgram(named.display().to_string()))?;
            Ok(Some(Slicer { program }))
        }
        None => Ok(NAMES.iter().find_map(|name| on_path(Path::new(name))).map(|program| Slicer { program })),
    }
}

impl Slicer {
    /// The slicer with settings that it writes itself.
    ///
    /// # Errors
    /// [`SlicerError`] if it refuses the settings.
    pub fn prepared(self, settings: &PrintSettings) -> Result<PreparedSlicer, SlicerError> {
        let io = |source| self.io(source);
        let folder = tempfile::Builder::new().prefix("pinswitch-slicer").tempdir().map_err(io)?;
        let file = folder.path().join("settings.ini");
        let output = self.run(
            folder.path(),
            settings.options().iter().map(OsStr::new).chain([OsStr::new("--save"), file.as_os_str()]),
        )?;
        let Ok(text) = std::fs::read_to_string(&file) else {
            return Err(self.refused("its settings", &output));
        };
        let version = maker(&text).unwrap_or("an unknown slicer").to_owned();
        Ok(PreparedSlicer {
            settings_text: without_time(&text),
            version,
            slicer: self,
            folder,
            settings: file,
        })
    }

    fn run<'a>(
        &self,
        folder: &Path,
        options: impl Iterator<Item = &'a OsStr>,
    ) -> Result<Output, SlicerError> {
        // Settings of whoever runs it stay out: the same call gives the same answer.
        let mut command = Command::new(&self.program);
        command.arg("--datadir").arg(folder).args(options).current_dir(folder).stdin(Stdio::null());
        command.output().map_err(|e| self.io(e))
    }

    fn io(&self, source: std::io::Error) -> SlicerError {
        SlicerError::Io { program: self.program.display().to_string(), source }
    }

    fn refused(&self, file: &str, output: &Output) -> SlicerError {
        SlicerError::Refused {
            program: self.program.display().to_string(),
            file: file.to_owned(),
            said: last_words(output),
        }
    }
}

/// The last line that a program said, of its errors if there are any.
fn last_words(output: &Output) -> String {
    let lines = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        text.lines().rev().map(str::trim).find(|l| !l.is_empty()).map(str::to_owned)
    };
    let said = lines(&output.stderr).or_else(|| lines(&output.stdout));
    let said = said.unwrap_or_else(|| format!("it said nothing, and ended with {}", output.status));
    said.chars().filter(|c| !c.is_control()).take(LONGEST).collect()
}

/// A slicer with its settings in a folder of its own, which goes away with it.
#[derive(Debug)]
pub struct PreparedSlicer {
    slicer: Slicer,
    folder: TempDir,
    settings: PathBuf,
    settings_text: String,
    version: String,
}

impl PreparedSlicer {
    /// Its name and version.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The settings file that it wrote, without the time at which it did.
    pub fn settings_text(&self) -> &str {
        &self.settings_text
    }

    /// Slices a file (STL or 3MF, as its name ends) as its parts lie; an STL, which says nothing of a bed, in the middle of it.
    ///
    /// # Errors
    /// [`SlicerError`] with what the slicer said.
    pub fn slice(&self, name: &str, bytes: &[u8]) -> Result<PrintEstimate, SlicerError> {
        let io = |e| self.slicer.io(e);
        let folder = tempfile::Builder::new().tempdir_in(self.folder.path()).map_err(io)?;
        let is_package = name.to_ascii_lowercase().ends_with(".3mf");
        let file = folder.path().join(if is_package { "object.3mf" } else { "object.stl" });
        let gcode = folder.path().join("object.gcode");
        std::fs::write(&file, bytes).map_err(io)?;
        let mut options: Vec<&OsStr> = vec![OsStr::new("--load"), self.settings.as_os_str()];
        if is_package {
            options.push(OsStr::new("--dont-arrange"));
        }
        options.extend([
            OsStr::new("--export-gcode"),
            OsStr::new("--output"),
            gcode.as_os_str(),
            file.as_os_str(),
        ]);
        let output = self.slicer.run(folder.path(), options.into_iter())?;
        let Ok(text) = std::fs::read(&gcode) else { return Err(self.slicer.refused(name, &output)) };
        PrintEstimate::of_gcode(&String::from_utf8_lossy(&text)).map_err(|problem| SlicerError::Refused {
            program: self.slicer.program.display().to_string(),
            file: name.to_owned(),
            said: format!("its G-code cannot be read: {problem}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_goes_before_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let search = Some(path.as_os_str());
        assert_eq!(find(None, search).unwrap(), None);
        assert_eq!(find(None, None).unwrap(), None);
        for name in ["prusa-slicer", "mine"] {
            std::fs::write(path.join(name), "").unwrap();
        }
        let found = |variable: Option<&OsStr>| find(variable, search).unwrap().unwrap().program;
        assert_eq!(found(None), path.join("prusa-slicer"));
        assert_eq!(found(Some(OsStr::new(""))), path.join("prusa-slicer"));
        assert_eq!(found(Some(OsStr::new("mine"))), path.join("mine"));
        assert_eq!(found(Some(path.join("mine").as_os_str())), path.join("mine"));
        let error = find(Some(OsStr::new("absent")), search).unwrap_err();
        assert!(error.is_bad_input() && error.to_string().contains("PINSWITCH_SLICER = absent"), "{error}");
    }
}
