//! A question that takes seconds, answered by a process of its own, which ends when nobody waits for the answer any more.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use hyper::body::Bytes;

/// A process that is ended with this.
#[derive(Debug)]
pub(super) struct Apart(Child);

impl Drop for Apart {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Apart {
    /// Starts `program`, which waits for its question.
    ///
    /// # Errors
    /// If it cannot be started.
    pub(super) fn start(program: &Path) -> std::io::Result<Self> {
        let mut command = Command::new(program);
        command
            .args(["--quiet", "answer"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        command.spawn().map(Self)
    }

    /// Its answer in JSON. Dropping the future ends the process, and so does the end of this one, with which the process's
    /// standard input ends.
    ///
    /// # Errors
    /// If it ends without an answer, or before its answer does.
    pub(super) async fn answer(mut self, question: Bytes) -> std::io::Result<String> {
        let ends = self.0.stdin.take().zip(self.0.stdout.take());
        let (mut asks, mut answers) = ends.ok_or_else(|| std::io::Error::other("its ends are closed"))?;
        let told = tokio::task::spawn_blocking(move || {
            asks.write_all(format!("{}\n", question.len()).as_bytes())?;
            asks.write_all(&question)?;
            asks.flush()?;
            let mut text = String::new();
            answers.read_to_string(&mut text)?;
            std::io::Result::Ok((text, asks))
        });
        // Held until it has ended: whose standard input ends has nobody to answer.
        let (text, asks) = told.await.map_err(std::io::Error::other)??;
        let ended = self.0.wait()?;
        drop(asks);
        if ended.success() { Ok(text) } else { Err(std::io::Error::other(format!("it ended with {ended}"))) }
    }
}
