//! `pinswitch answer`: answers one request of the configurator in a process of its own. Ending the
//! process ends a long computation.

use std::io::Read;

use clap::Args;
use pinswitch_app::server::read_request;
use pinswitch_app::{Answer, Engine};

use super::{Failure, print};

/// Answer one request of the configurator from standard input; `view` starts this for long
/// requests.
///
/// The first line is the length of the request in bytes; the request follows. The process ends when
/// standard input is closed: no one waits for the answer then.
#[derive(Args, Debug)]
#[command(hide = true)]
pub(super) struct Arguments {}

pub(super) fn run(_: &Arguments) -> Result<(), Failure> {
    let request = read_request(&mut std::io::stdin().lock()).map_err(Failure::bad_input)?;
    std::thread::spawn(|| {
        let _ = std::io::stdin().lock().read_to_end(&mut Vec::new());
        std::process::exit(1);
    });
    match Engine::default().answer(&request) {
        Answer::Json(text) => print(text.as_bytes()),
        Answer::Bytes(bytes) => print(&bytes),
    }
}
