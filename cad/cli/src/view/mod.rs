//! `pinswitch view CONFIG`: the page of a set, following its configuration.

mod apart;
mod configure;
mod follow;
mod server;
mod state;

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;

use clap::Args;
use sha2::{Digest, Sha256};
use tokio::net::TcpListener;
use tokio::sync::watch;

use super::failure::unconverted;
use super::law::LawChoice;
use super::source::Source;
use super::{Failure, print_text};
use configure::{Configurator, Followed};
use pinswitch_app::values;
use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_switch::built::Built;
use pinswitch_switch::design::Design;
use pinswitch_switch::formats::named;
use pinswitch_switch::formats::page::{PageData, page_html};
use pinswitch_switch::set::Set;
use state::State;

/// Show the page of a configuration on this machine, rebuilt whenever the file changes, and a configurator that changes it.
///
/// Serves on 127.0.0.1 only, and only to its own pages: the page of the set at /, the configurator at /configure, which
/// begins with that configuration and writes its file only when asked. Without a configuration the page shows three-double,
/// and the configurator goes on with what was last looked at in it. A configuration that breaks shows its error, and the
/// last good state stays. --law chooses the curve of the page at /; the configurator draws the physics law, and the others
/// beside it. Ends with Ctrl-C.
#[derive(Args, Clone, Debug)]
#[command(mut_arg("config", |a| a.required(false)))]
#[command(after_help = "Examples:
  pinswitch view
  pinswitch init three-double --out mine.toml && pinswitch view mine.toml")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    law: LawChoice,
    /// Port to serve on; 0 takes any that is free.
    #[arg(long, default_value_t = 8737)]
    port: u16,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    // What is followed is what the page was built from: a save between two readings would never be shown.
    let followed = match arguments.source.file() {
        Some(file) => Some((crate::input::read_file(&file)?, file)),
        None => None,
    };
    let design = match &followed {
        Some((bytes, _)) => arguments.source.design_from(bytes.clone()),
        None => arguments.source.design(),
    };
    let (sender, states) =
        watch::channel(build(arguments, design?, 1, followed.as_ref().map_or(&[], |(bytes, _)| bytes))?);
    let file = followed.as_ref().map(|(bytes, path)| {
        // An assembly.3mf holds its configuration packed.
        Followed { path: path.clone(), is_text: !bytes.starts_with(b"PK") }
    });
    let configurator = Configurator::new(arguments.source.clone(), file);
    // Kept to the end, also where there is no file to follow: pages that wait are not sent away.
    let sender = Arc::new(sender);
    // One thread answers all, however many wait.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|e| Failure::failed(Diagnostic::from_error(e)))?;
    runtime.block_on(async {
        let busy = |e: std::io::Error| {
            Failure::bad_input(
                Diagnostic::new("cannot listen on this port")
                    .with_location(Location::field("--port", arguments.port.to_string()))
                    .with_help("give another port, or 0 for any free port")
                    .with_source(e),
            )
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, arguments.port)).await.map_err(busy)?;
        let address: SocketAddr =
            listener.local_addr().map_err(|e| Failure::failed(Diagnostic::from_error(e)))?;
        print_text(&format!("http://{address}\nhttp://{address}/configure\n"))?;
        if let Some((bytes, file)) = followed {
            log::info!("following {}; end with Ctrl-C", file.display());
            let (sender, arguments) = (Arc::clone(&sender), arguments.clone());
            std::thread::spawn(move || follow::follow(&sender, &arguments, &file, bytes));
        }
        server::serve(listener, address, states, configurator).await;
        Ok(())
    })
}

/// What is shown of a design that was read from these bytes.
fn build(arguments: &Arguments, design: Design, version: u64, bytes: &[u8]) -> Result<State, Failure> {
    let prediction = arguments.law.prediction(&design)?;
    let built = Built::new(design).map_err(|e| Failure::bad_input(unconverted(e)))?;
    let formats = named(&["stl"]).map_err(Failure::failed)?;
    let set = Set::new(&built, &prediction, &formats).map_err(|e| Failure::bad_input(unconverted(e)))?;
    let data = PageData::new(&built, &prediction, &set.manifest, Some(version));
    // A live page is rebuilt while somebody waits, in a browser that has shown it already: no picture.
    let page = page_html(&data, "").map_err(|e| Failure::failed(unconverted(e)))?;
    let values = values(built.design().configuration());
    let values = serde_json::to_string(&values).map_err(|e| Failure::failed(Diagnostic::from_error(e)))?;
    let data = data.json().map_err(|e| Failure::failed(unconverted(e)))?;
    let stamp = stamp(bytes).into();
    Ok(State { version, stamp, data: data.into(), page: page.into(), values: values.into(), trouble: None })
}

/// What tells the content of a file from any other.
fn stamp(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
