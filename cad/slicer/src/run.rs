//! The slicer program: its path, its settings, and one run per file.

use std::error::Error;
use std::ffi::OsStr;
use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt, neutral};
use tempfile::TempDir;

use crate::bounded::{self, Run, RunError, RunLimits};
use crate::estimate::{GcodeError, PrintEstimate};
use crate::settings::{PrintSettings, program_version, without_time};

/// Names of the program on a search path.
const NAMES: [&str; 4] = ["prusa-slicer", "PrusaSlicer", "prusa-slicer-console.exe", "prusa-slicer.exe"];
/// Environment variable with the program; it takes precedence over the search path.
pub const PROGRAM_VARIABLE: &str = "PINSWITCH_SLICER";
/// Environment variable with the longest time in seconds in which a slicer slices one file.
pub const LIMIT_VARIABLE: &str = "PINSWITCH_SLICER_SECONDS";
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
    /// The program exceeded a limit, and was ended.
    Stopped {
        /// The program.
        program: String,
        /// The file that it was given.
        file: String,
        /// The limit.
        limit: String,
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
            Self::NoProgram(name) => Diagnostic::new(codes::SLICER_NOT_FOUND, "no such program")
                .with_location(Location::field(PROGRAM_VARIABLE, name.as_str()))
                .with_help("give the path of PrusaSlicer's program, or unset the variable"),
            Self::Io { program, source } => {
                Diagnostic::new(codes::SLICER_FAILED, format!("cannot run {program}: {source}"))
                    .with_help("install PrusaSlicer again, and make room for temporary files")
            }
            Self::Refused { program, file, output } => {
                Diagnostic::new(codes::SLICER_FAILED, format!("{program} did not slice {file}: {output}"))
            }
            Self::Stopped { program, file, limit } => Diagnostic::new(
                codes::SLICER_FAILED,
                format!("{program} did not slice {file}: {limit}, and was ended"),
            )
            .with_help(format!("repeat it, or give a longer time in {LIMIT_VARIABLE}")),
            Self::Gcode { program, file, source } => Diagnostic::new(
                codes::SLICER_FAILED,
                format!("{program} sliced {file} without an estimate: {source}"),
            )
            .with_help("use PrusaSlicer 2.5 or later"),
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
            Self::NoProgram(_) | Self::Refused { .. } | Self::Stopped { .. } => None,
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
    limits: RunLimits,
    /// Program with arguments that runs the slicer, and ends it when this process ends.
    supervisor: Vec<PathBuf>,
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
            Ok(Some(Slicer::new(program)))
        }
        None => Ok(NAMES.iter().find_map(|name| on_path(Path::new(name))).map(Slicer::new)),
    }
}

impl Slicer {
    fn new(program: PathBuf) -> Self {
        Self { program, limits: RunLimits::default(), supervisor: Vec::new() }
    }

    /// The slicer with other limits for each run.
    #[must_use]
    pub fn with_limits(self, limits: RunLimits) -> Self {
        Self { limits, ..self }
    }

    /// The slicer, run by a program with arguments that calls [`supervise`](crate::supervise): it ends
    /// when this process ends, however that happens.
    #[must_use]
    pub fn with_supervisor(self, supervisor: Vec<PathBuf>) -> Self {
        Self { supervisor, ..self }
    }

    /// Lets the slicer write a settings file from its options.
    ///
    /// # Errors
    /// A slicer that cannot be run, or that refuses the settings.
    pub fn prepared(self, settings: &PrintSettings) -> Result<PreparedSlicer, SlicerError> {
        let io = |source| self.io(source);
        let folder = tempfile::Builder::new().prefix("pinswitch-slicer").tempdir().map_err(io)?;
        let file = folder.path().join("settings.ini");
        let name = "its settings";
        let ended = self.run(
            folder.path(),
            settings.options().iter().map(OsStr::new).chain([OsStr::new("--save"), file.as_os_str()]),
            (name, &file),
        )?;
        let text = self.written(&file, &ended).ok_or_else(|| self.refused(name, &ended))?;
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
        (name, written): (&str, &Path),
    ) -> Result<Run, SlicerError> {
        // An empty data folder excludes the user's settings, so that results are reproducible.
        let mut command = Command::new(&self.program);
        command.arg("--datadir").arg(folder).args(options).current_dir(folder);
        bounded::run(&command, &self.supervisor, written, self.limits).map_err(|e| match e {
            RunError::Io(e) => self.io(e),
            RunError::Limit(limit) => SlicerError::Stopped {
                program: self.program.display().to_string(),
                file: name.to_owned(),
                limit,
            },
        })
    }

    /// Returns the text that a run has written; `None` if it failed: it may have written a part.
    fn written(&self, file: &Path, ended: &Run) -> Option<String> {
        if !ended.status.success() {
            return None;
        }
        // Opening a pipe would wait for its other end.
        if !std::fs::symlink_metadata(file).is_ok_and(|found| found.is_file()) {
            return None;
        }
        let mut bytes = Vec::new();
        let file = std::fs::File::open(file).ok().filter(|f| f.metadata().is_ok_and(|f| f.is_file()))?;
        file.take(self.limits.written_bytes).read_to_end(&mut bytes).ok()?;
        Some(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn io(&self, source: std::io::Error) -> SlicerError {
        SlicerError::Io { program: self.program.display().to_string(), source }
    }

    fn refused(&self, file: &str, ended: &Run) -> SlicerError {
        SlicerError::Refused {
            program: self.program.display().to_string(),
            file: file.to_owned(),
            output: outcome(ended),
        }
    }
}

/// Describes how a program ended: the last line of its message, and its exit status.
fn outcome(ended: &Run) -> String {
    let text = String::from_utf8_lossy(&ended.message);
    let line = text.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or("no output");
    format!("{} ({})", excerpt(&neutral(line), MAX_MESSAGE), ended.status)
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
        let ended = self.slicer.run(folder.path(), options.into_iter(), (name, &gcode))?;
        let text = self.slicer.written(&gcode, &ended).ok_or_else(|| self.slicer.refused(name, &ended))?;
        PrintEstimate::from_gcode(&text).map_err(|source| SlicerError::Gcode {
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
