//! The local server of `pinswitch view`: the page, which follows a file and writes it.
//!
//! The server knows HTTP, the page and engines. A front end knows the command line and the file
//! system, and implements [`ConfigurationSource`]. [`Server::bind`] builds the parts and opens the
//! port, so that errors of both come before any output; [`Server::run`] answers requests until the
//! process ends. It listens on 127.0.0.1 and answers its own pages only.

mod configurator;
mod file_watch;
mod http;
mod source;
mod state;
mod worker;

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;

use pinswitch_diagnostic::{Diagnostic, codes};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::watch;

use configurator::Configurator;
use state::State;

pub use source::{ConfigurationSource, FieldOverride, SourceWriteError};
pub use worker::read_request;

/// Why a server cannot start.
#[derive(Clone, Debug)]
pub enum ServerError {
    /// The configuration cannot be read or built.
    Configuration(Diagnostic),
    /// The port is in use, or not allowed.
    Port(Diagnostic),
    /// The runtime cannot be made.
    Internal(Diagnostic),
}

impl ServerError {
    fn internal(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Internal(Diagnostic::from_error(codes::INTERNAL_ERROR, error))
    }
}

impl From<ServerError> for Diagnostic {
    fn from(error: ServerError) -> Self {
        match error {
            ServerError::Configuration(diagnostic)
            | ServerError::Port(diagnostic)
            | ServerError::Internal(diagnostic) => diagnostic,
        }
    }
}

impl std::fmt::Display for ServerError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        Diagnostic::from(self.clone()).fmt(f)
    }
}

impl std::error::Error for ServerError {}

/// A server that listens and does not answer yet.
#[derive(Debug)]
pub struct Server {
    source: Arc<dyn ConfigurationSource>,
    runtime: Runtime,
    listener: TcpListener,
    address: SocketAddr,
    /// The content of the followed file from which the first state is built: a save during the build
    /// is noticed.
    content: Vec<u8>,
    sender: watch::Sender<State>,
}

impl Server {
    /// Builds the first state and listens on 127.0.0.1; port 0 takes any free port.
    ///
    /// # Errors
    /// [`ServerError`] if the configuration cannot be built or the port cannot be opened.
    pub fn bind(source: Arc<dyn ConfigurationSource>, port: u16) -> Result<Self, ServerError> {
        let content = match source.file() {
            Some(_) => source.read().map_err(ServerError::Configuration)?,
            None => Vec::new(),
        };
        let (sender, _) = watch::channel(State::build(&*source, &content, 1)?);
        // One thread answers all connections.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(ServerError::internal)?;
        let listener = runtime.block_on(TcpListener::bind((Ipv4Addr::LOCALHOST, port))).map_err(|e| {
            let diagnostic = Diagnostic::new(codes::CANNOT_START, format!("cannot listen on port {port}"));
            ServerError::Port(
                diagnostic.with_help("give another port, or 0 for any free port").with_source(e),
            )
        })?;
        let address = listener.local_addr().map_err(ServerError::internal)?;
        Ok(Self { source, runtime, listener, address, content, sender })
    }

    /// Address and port on which it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Follows the file, if there is one, and answers requests until the process ends.
    pub fn run(self) {
        let Self { source, runtime, listener, address, content, sender } = self;
        let states = sender.subscribe();
        // A 3MF contains its configuration packed: values cannot be written into it.
        let is_writable = source.file().is_some() && !content.starts_with(b"PK");
        let configurator = Configurator::new(Arc::clone(&source), is_writable);
        // Kept without a file, too: pages that wait for the next state stay connected.
        let sender = Arc::new(sender);
        if source.file().is_some() {
            let sender = Arc::clone(&sender);
            std::thread::spawn(move || file_watch::follow(&sender, &*source, content));
        }
        runtime.block_on(http::serve(listener, address, states, configurator));
    }
}
