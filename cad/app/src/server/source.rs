//! The interface between the server and a front end.

use std::fmt::Debug;
use std::path::Path;
use std::process::Command;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;

/// The configuration that a server shows: a file or a template, with everything that the user's
/// options change in it.
pub trait ConfigurationSource: Debug + Send + Sync {
    /// Returns the file that is followed; `None` if a template is shown.
    fn file(&self) -> Option<&Path>;

    /// Whether the user named what to show; otherwise the configurator continues with its last
    /// visit.
    fn is_explicit(&self) -> bool;

    /// Returns the options that override fields of the file.
    fn overrides(&self) -> Vec<FieldOverride>;

    /// Reads the followed file.
    ///
    /// # Errors
    /// If there is none, or it cannot be read.
    fn read(&self) -> Result<Vec<u8>, Diagnostic>;

    /// Reads the followed file as UTF-8 text.
    ///
    /// # Errors
    /// If there is none, or it cannot be read as text.
    fn read_text(&self) -> Result<String, Diagnostic>;

    /// Replaces the followed file, whose content is `expected`, or which is missing, by `text`,
    /// completely or not at all.
    ///
    /// # Errors
    /// [`SourceWriteError`]; the file is unchanged.
    fn write(&self, expected: Option<&str>, text: &str) -> Result<(), SourceWriteError>;

    /// Returns the configuration in `text`, the content of the followed file, with options applied;
    /// unlike a design it is not validated as a whole.
    ///
    /// # Errors
    /// If the text or an option is invalid.
    fn configuration(&self, text: &str) -> Result<Configuration, Diagnostic>;

    /// Returns the design in `content`, the content of the followed file, with options applied;
    /// without a file, the design of the template.
    ///
    /// # Errors
    /// If the content or an option is invalid, or the design cannot be built.
    fn design(&self, content: &[u8]) -> Result<Design, Diagnostic>;

    /// Returns the command of a process that answers one long request: it reads the request with
    /// [`read_request`](super::read_request) from standard input, writes the answer to standard
    /// output, and exits when standard input ends. `None` if the server answers long requests
    /// itself.
    fn worker(&self) -> Option<Command>;
}

/// Why the followed file is not written.
#[derive(Clone, Debug)]
pub enum SourceWriteError {
    /// Another program has changed it.
    Changed,
    /// There is none, or it cannot be written.
    Failed(Diagnostic),
}

impl From<Diagnostic> for SourceWriteError {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Failed(diagnostic)
    }
}

/// An option of the front end that overrides a field of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldOverride {
    /// Option, such as `--set`.
    pub option: String,
    /// Field as `table.key`.
    pub field: String,
}
