//! `pinswitch view`: serves the page, which follows a configuration and changes it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use clap::Args;
use pinswitch_app::server::{ConfigurationSource, FieldOverride, Server, ServerError, SourceWriteError};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_store::{RewriteError, rewrite_file};
use pinswitch_switch::config::Configuration;
use pinswitch_switch::design::Design;

use super::input::{read_file, read_text_file};
use super::source::Source;
use super::write::{lock_policy, write_error};
use super::{Failure, print_text};

/// Show a configuration in the browser, and change it there.
///
/// Serves a page on 127.0.0.1, and answers no other sites' pages. The page follows the file: if another program changes it,
/// it shows the new version, or the error and the last valid version. It writes the file only on request. Without a
/// configuration, it continues with its last visit, or starts with three-double. End with Ctrl-C.
#[derive(Args, Clone, Debug)]
#[command(mut_arg("config", |a| a.required(false)))]
#[command(after_help = "Examples:
  pinswitch view
  pinswitch init three-double --out mine.toml && pinswitch view mine.toml")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Port to serve on; 0 takes any free port.
    #[arg(long, default_value_t = 8737)]
    port: u16,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let source = Arc::new(ViewSource::new(arguments));
    let server = Server::bind(source.clone(), arguments.port).map_err(|e| match e {
        ServerError::Internal(diagnostic) => Failure::failed(diagnostic),
        ServerError::Port(diagnostic) => Failure::bad_input(
            diagnostic.with_location(Location::field("--port", arguments.port.to_string())),
        ),
        ServerError::Configuration(diagnostic) => Failure::bad_input(diagnostic),
    })?;
    let address = server.address();
    print_text(&format!("http://{address}\n"))?;
    if let Some(file) = source.file() {
        log::info!("following {}; end with Ctrl-C", file.display());
    }
    server.run();
    Ok(())
}

/// The configuration that the command line names.
#[derive(Debug)]
struct ViewSource {
    source: Source,
    file: Option<PathBuf>,
    /// This program, which also answers long requests in a process of their own.
    program: Option<PathBuf>,
}

impl ViewSource {
    fn new(arguments: &Arguments) -> Self {
        let source = arguments.source.clone();
        Self { file: source.file(), program: std::env::current_exe().ok(), source }
    }

    /// Returns the followed file, if it is an ordinary one: a pipe cannot be read again, and a server must not wait for
    /// one.
    fn ordinary_file(&self) -> Result<&Path, Diagnostic> {
        let file = self.required_file()?;
        match std::fs::metadata(file) {
            Ok(facts) if !facts.is_file() && !facts.is_dir() => {
                Err(Diagnostic::new(codes::NOT_A_FILE, "is not an ordinary file")
                    .with_location(Location::file(file.display().to_string()))
                    .with_help("give a file that can be read again"))
            }
            _ => Ok(file),
        }
    }

    fn required_file(&self) -> Result<&Path, Diagnostic> {
        self.file
            .as_deref()
            .ok_or_else(|| Diagnostic::new(codes::NOT_SAVED, "the server follows a template, not a file"))
    }
}

impl ConfigurationSource for ViewSource {
    fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    fn is_explicit(&self) -> bool {
        self.source.has_arguments()
    }

    fn overrides(&self) -> Vec<FieldOverride> {
        let options = self.source.options();
        options
            .map(|(option, field)| FieldOverride { option: option.to_owned(), field: field.to_owned() })
            .collect()
    }

    fn read(&self) -> Result<Vec<u8>, Diagnostic> {
        read_file(self.ordinary_file()?).map_err(|failure| diagnostic(&failure))
    }

    fn read_text(&self) -> Result<String, Diagnostic> {
        read_text_file(self.ordinary_file()?).map_err(|failure| diagnostic(&failure))
    }

    fn write(&self, expected: Option<&str>, text: &str) -> Result<(), SourceWriteError> {
        let file = self.required_file()?;
        let expected = expected.map(str::as_bytes);
        rewrite_file(file, expected, text.as_bytes(), lock_policy()).map_err(|e| match e {
            RewriteError::Changed => SourceWriteError::Changed,
            RewriteError::System(e) => SourceWriteError::Failed(write_error(file, e).into()),
        })
    }

    fn configuration(&self, text: &str) -> Result<Configuration, Diagnostic> {
        self.source.configuration_from(text).map_err(|failure| diagnostic(&failure))
    }

    fn design(&self, content: &[u8]) -> Result<Design, Diagnostic> {
        let design = match self.file {
            Some(_) => self.source.design_from(content.to_vec()),
            None => self.source.design(),
        };
        design.map_err(|failure| diagnostic(&failure))
    }

    fn worker(&self) -> Option<Command> {
        let mut command = Command::new(self.program.as_ref()?);
        command.args(["--quiet", "answer"]);
        Some(command)
    }
}

/// Returns the diagnostic of a failure.
fn diagnostic(failure: &Failure) -> Diagnostic {
    failure
        .diagnostics()
        .first()
        .cloned()
        .unwrap_or_else(|| Diagnostic::new(codes::INTERNAL_ERROR, failure.to_string()))
}
