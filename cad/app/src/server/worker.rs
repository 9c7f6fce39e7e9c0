//! A process per long request, which ends when no one waits for the answer any more.

use std::io::{BufRead, Read, Write};
use std::process::{Child, Command, Stdio};

use hyper::body::Bytes;
use pinswitch_diagnostic::{Diagnostic, codes};

/// Longest first line of a request in bytes, more than the digits of any length.
const MAX_LENGTH_LINE: u64 = 32;

/// Longest answer, in bytes: some times that of the longest table.
const MAX_ANSWER_BYTES: u64 = 256 << 20;

/// A process that answers one request. Dropping it ends the process.
#[derive(Debug)]
pub(super) struct Worker(Child);

impl Drop for Worker {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Worker {
    /// Starts the process, which waits for its request.
    ///
    /// # Errors
    /// If it cannot be started.
    pub(super) fn start(mut command: Command) -> std::io::Result<Self> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        command.spawn().map(Self)
    }

    /// Returns the JSON answer. Dropping the future ends the process; so does the end of the
    /// server, which closes the standard input of the process.
    ///
    /// # Errors
    /// If the process fails or ends early.
    pub(super) async fn answer(mut self, request: Bytes) -> std::io::Result<String> {
        let pipes = self.0.stdin.take().zip(self.0.stdout.take());
        let (mut stdin, mut stdout) = pipes.ok_or_else(|| std::io::Error::other("its pipes are closed"))?;
        let exchange = tokio::task::spawn_blocking(move || {
            stdin.write_all(format!("{}\n", request.len()).as_bytes())?;
            stdin.write_all(&request)?;
            stdin.flush()?;
            let mut text = String::new();
            stdout.by_ref().take(MAX_ANSWER_BYTES).read_to_string(&mut text)?;
            if text.len() as u64 == MAX_ANSWER_BYTES {
                return Err(std::io::Error::other("its answer is too long"));
            }
            std::io::Result::Ok((text, stdin))
        });
        // Standard input stays open until the process has ended: without it the process would end
        // itself.
        let (text, stdin) = exchange.await.map_err(std::io::Error::other)??;
        let status = self.0.wait()?;
        drop(stdin);
        if status.success() {
            Ok(text)
        } else {
            Err(std::io::Error::other(format!("it ended with {status}")))
        }
    }
}

/// Reads the request of a worker process: a line with its length in bytes, then the request.
///
/// # Errors
/// A [`Diagnostic`] if the length is missing, or if the request is shorter than that or not UTF-8.
pub fn read_request(input: &mut impl BufRead) -> Result<String, Diagnostic> {
    let mut line = String::new();
    input
        .by_ref()
        .take(MAX_LENGTH_LINE)
        .read_line(&mut line)
        .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
    let length: usize = line.trim().parse().map_err(|e| {
        Diagnostic::new(
            codes::INTERNAL_ERROR,
            format!("the length {:?} of the request is not a number", line.trim()),
        )
        .with_source(e)
    })?;
    let mut request = Vec::new();
    input
        .take(length as u64)
        .read_to_end(&mut request)
        .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
    if request.len() < length {
        let problem = format!("the request ends after {} of {length} bytes", request.len());
        return Err(Diagnostic::new(codes::INTERNAL_ERROR, problem));
    }
    String::from_utf8(request).map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))
}

#[cfg(test)]
mod tests {
    use super::read_request;

    #[test]
    fn a_request_has_the_announced_length() {
        assert_eq!(read_request(&mut &b"3\n{}\nmore"[..]).unwrap(), "{}\n");
        for (input, problem) in
            [(&b"9\n{}"[..], "ends after 2 of 9"), (b"{}", "length"), (b"", "length"), (b"1\n\xff", "utf-8")]
        {
            let error = read_request(&mut &*input).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
        }
    }
}
