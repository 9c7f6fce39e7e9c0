//! The slicer program: its path, its settings, and one run per file.

use std::error::Error;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use pinswitch_diagnostic::{Diagnostic, Location, excerpt, neutral};
use tempfile::TempDir;

use crate::estimate::{GcodeError, PrintEstimate};
use crate::settings::{PrintSettings, program_version, without_time};

/// Names of the program on a search path.
const NAMES: [&str; 4] = ["prusa-slicer", "PrusaSlicer", "prusa-slicer-console.exe", "prusa-slicer.exe"];
/// Environment variable with the program; it takes precedence over the search path.
pub const PROGRAM_VARIABLE: &str = "PINSWITCH_SLICER";
/// Most characters of a slicer's message.
const MAX_MESSAGE: usize = 300;

/// Why a file cannot be sliced.
#[derive(Debug)]
#[non_exhaustive]
pub enum SlicerError {
    /// [`PROGRAM_VARIABLE`] does not name a program.
    NoProgram(String),
    /// The program cannot be started, or its files cannot be written.
    Io {
        /// The program.
        program: String,
        /// Why.
        source: std::io::Error,
    },
    /// The program failed, or ended without a result.
    Refused {
        /// The program.
        program: String,
        /// The file that it was given.
        file: String,
        /// The last line of its output, and its exit status.
        output: String,
    },
    /// The G-code lacks an estimate.
    Gcode {
        /// The program.
        program: String,
        /// The file that was sliced.
        file: String,
        /// The comment that is missing or invalid.
        source: GcodeError,
    },
}

impl SlicerError {
    /// Returns whether the cause is the user's environment, rather than the slicer.
    pub const fn is_bad_input(&self) -> bool {
        matches!(self, Self::NoProgram(_))
    }

    fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::NoProgram(name) => Diagnostic::new("no such program")
                .with_location(Location::field(PROGRAM_VARIABLE, name.as_str()))
                .with_help("give the path of PrusaSlicer's program, or unset the variable"),
            Self::Io { program, source } => Diagnostic::new(format!("cannot run {program}: {source}"))
                .with_help("install PrusaSlicer again, and make room for temporary files"),
            Self::Refused { program, file, output } => {
                Diagnostic::new(format!("{program} did not slice {file}: {output}"))
            }
            Self::Gcode { program, file, source } => {
                Diagnostic::new(format!("{program} sliced {file} without an estimate: {source}"))
                    .with_help("use PrusaSlicer 2.5 or later")
            }
        }
    }
}

impl fmt::Display for SlicerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.diagnostic(), f)
    }
}

impl Error for SlicerError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Gcode { source, .. } => Some(source),
            Self::NoProgram(_) | Self::Refused { .. } => None,
        }
    }
}

impl From<SlicerError> for Diagnostic {
    fn from(error: SlicerError) -> Self {
        error.diagnostic()
    }
}

/// An installed slicer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slicer {
    program: PathBuf,
}

/// Finds the slicer that `variable` (the value of [`PROGRAM_VARIABLE`]) names, or else the first
/// one on the search path; `None` if none is installed.
///
/// # Errors
/// [`SlicerError::NoProgram`] if the variable does not name a program.
pub fn find(variable: Option<&OsStr>, search_path: Option<&OsStr>) -> Result<Option<Slicer>, SlicerError> {
    let folders: Vec<PathBuf> = search_path.map(|p| std::env::split_paths(p).collect()).unwrap_or_default();
    let on_path = |name: &Path| folders.iter().map(|folder| folder.join(name)).find(|file| file.is_file());
    match variable.filter(|v| !v.is_empty()).map(Path::new) {
        Some(named) => {
            let program = if named.is_file() { Some(named.to_owned()) } else { on_path(named) };
            let program = program.ok_or_else(|| SlicerError::NoProgram(named.display().to_string()))?;
            Ok(Some(Slicer { program }))
        }
        None => Ok(NAMES.iter().find_map(|name| on_path(Path::new(name))).map(|program| Slicer { program })),
    }
}

impl Slicer {
    /// Lets the slicer write a settings file from its options.
    ///
    /// # Errors
    /// A slicer that cannot be run, or that refuses the settings.
    pub fn prepared(self, settings: &PrintSettings) -> Result<PreparedSlicer, SlicerError> {
        let io = |source| self.io(source);
        let folder = tempfile::Builder::new().prefix("pinswitch-slicer").tempdir().map_err(io)?;
        let file = folder.path().join("settings.ini");
        let output = self.run(
            folder.path(),
            settings.options().iter().map(OsStr::new).chain([OsStr::new("--save"), file.as_os_str()]),
        )?;
        let text = std::fs::read_to_string(&file)
            .ok()
            .filter(|_| output.status.success())
            .ok_or_else(|| self.refused("its settings", &output))?;
        let version = program_version(&text).unwrap_or("an unknown slicer").to_owned();
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
        // An empty data folder excludes the user's settings, so that results are reproducible.
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
            output: outcome(output),
        }
    }
}

/// Describes how a program ended: the last line of its output, of standard error if it is not
/// empty, and its exit status.
fn outcome(output: &Output) -> String {
    let last = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
    };
    let line = last(&output.stderr).or_else(|| last(&output.stdout));
    let line = line.unwrap_or_else(|| "no output".to_owned());
    format!("{} ({})", excerpt(&neutral(&line), MAX_MESSAGE), output.status)
}

/// A slicer with its settings in a temporary folder.
#[derive(Debug)]
pub struct PreparedSlicer {
    slicer: Slicer,
    folder: TempDir,
    settings: PathBuf,
    settings_text: String,
    version: String,
}

impl PreparedSlicer {
    /// Returns the slicer's name and version.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Returns the slicer's settings file without its time stamp.
    pub fn settings_text(&self) -> &str {
        &self.settings_text
    }

    /// Slices an STL or 3MF file, by its extension. A 3MF keeps its arrangement; an STL is sliced
    /// in the middle of the bed.
    ///
    /// # Errors
    /// [`SlicerError`] with the slicer's message.
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
        // A slicer that fails may have written a part of its file.
        let text = std::fs::read(&gcode)
            .ok()
            .filter(|_| output.status.success())
            .ok_or_else(|| self.slicer.refused(name, &output))?;
        PrintEstimate::from_gcode(&String::from_utf8_lossy(&text)).map_err(|source| SlicerError::Gcode {
            program: self.slicer.program.display().to_string(),
            file: name.to_owned(),
            source,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_precedes_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let search = Some(path.as_os_str());
        assert_eq!(find(None, search).unwrap(), None);
        assert_eq!(find(None, None).unwrap(), None);
        for name in ["prusa-slicer", "mine"] {
            std::fs::write(path.join(name), "").unwrap();
        }
        let program = |variable: Option<&OsStr>| find(variable, search).unwrap().unwrap().program;
        assert_eq!(program(None), path.join("prusa-slicer"));
        assert_eq!(program(Some(OsStr::new(""))), path.join("prusa-slicer"));
        assert_eq!(program(Some(OsStr::new("mine"))), path.join("mine"));
        assert_eq!(program(Some(path.join("mine").as_os_str())), path.join("mine"));
        let error = find(Some(OsStr::new("absent")), search).unwrap_err();
        assert!(
            error.is_bad_input()
                && error.to_string().starts_with("PINSWITCH_SLICER = absent: no such program; "),
            "{error}"
        );
    }
}
