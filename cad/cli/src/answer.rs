//! `pinswitch answer`: computes one answer for the configurator in a process of its own, so that ending the process
//! stops the computation.

use std::io::{BufRead, Read};

use clap::Args;
use pinswitch_app::{Answer, Engine};
use pinswitch_diagnostic::Diagnostic;

use super::{Failure, print_data};

/// Answer one request of the configurator from standard input; `view` runs this.
///
/// The first line is the length of the request in bytes; the request follows. The sender keeps standard input open
/// while it waits; the process ends when it is closed.
#[derive(Args, Debug)]
#[command(hide = true)]
pub(super) struct Arguments {}

pub(super) fn run(_: &Arguments) -> Result<(), Failure> {
    let request = request(&mut std::io::stdin().lock()).map_err(Failure::bad_input)?;
    std::thread::spawn(|| {
        // The sender has gone: no one reads the answer.
        let _ = std::io::stdin().lock().read_to_end(&mut Vec::new());
        std::process::exit(1);
    });
    match Engine::default().answer(&request) {
        Answer::Json(text) => print_data(text.as_bytes()),
        Answer::Bytes(bytes) => print_data(&bytes),
    }
}

/// Reads a request after its length.
fn request(from: &mut impl BufRead) -> Result<String, Diagnostic> {
    let mut length = String::new();
    from.by_ref().take(32).read_line(&mut length).map_err(Diagnostic::from_error)?;
    let bytes: usize = length.trim().parse().map_err(|e| {
        Diagnostic::new(format!("the request's length {length:?} is not a number")).with_source(e)
    })?;
    let mut request = Vec::new();
    from.take(bytes as u64).read_to_end(&mut request).map_err(Diagnostic::from_error)?;
    if request.len() < bytes {
        let read = request.len();
        return Err(Diagnostic::new(format!("the request ends after {read} of {bytes} bytes")));
    }
    String::from_utf8(request).map_err(Diagnostic::from_error)
}

#[cfg(test)]
mod tests {
    use super::request;

    #[test]
    fn a_request_has_its_length() {
        assert_eq!(request(&mut &b"3\n{}\nmore"[..]).unwrap(), "{}\n");
        for (given, problem) in
            [(&b"9\n{}"[..], "ends after 2 of 9"), (b"{}", "length"), (b"", "length"), (b"1\n\xff", "utf-8")]
        {
            let error = request(&mut &*given).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
        }
    }
}
