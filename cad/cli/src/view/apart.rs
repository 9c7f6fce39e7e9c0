//! A question that takes seconds, answered by a process of its own, which ends when nobody waits for the answer any more.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use hyper::body::Bytes;

/// A process that is ended with this.
#[derive(Debug)]
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The answer of `program` in JSON. Dropping the future ends the program, and so does the end of this process, with which the
/// program's standard input ends.
///
/// # Errors
/// If it cannot be started, or ends without an answer.
pub(super) async fn answered_apart(program: &Path, question: Bytes) -> std::io::Result<String> {
    let started = Command::new(program)
        .args(["--quiet", "answer"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let mut process = Ended(started);
    let ends = process.0.stdin.take().zip(process.0.stdout.take());
    let (mut asks, mut answers) = ends.ok_or_else(|| std::io::Error::other("its ends are closed"))?;
    let told = tokio::task::spawn_blocking(move || {
        asks.write_all(format!("{}\n", question.len()).as_bytes())?;
        asks.write_all(&question)?;
        asks.flush()?;
        let mut text = String::new();
        answers.read_to_string(&mut text)?;
        if text.is_empty() { Err(std::io::Error::other("it ended without an answer")) } else { Ok(text) }
    });
    told.await.map_err(std::io::Error::other)?
}
