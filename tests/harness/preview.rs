//! A running `pinswitch view`, with the requests of a browser.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

use super::binary;

/// A running preview, which ends when it is dropped.
pub(crate) struct Preview {
    child: Child,
    /// Host and port.
    pub(crate) address: String,
}

impl Drop for Preview {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Preview {
    /// Starts the preview of a configuration in `folder`.
    pub(crate) fn start(folder: &Path, config: &str) -> Self {
        let mut command = binary();
        command.args(["view", config, "--port", "0"]).current_dir(folder);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = Vec::new();
        let stdout = child.stdout.as_mut().unwrap();
        let mut byte = [0];
        while stdout.read_exact(&mut byte).is_ok() && byte[0] != b'\n' {
            line.push(byte[0]);
        }
        let address = String::from_utf8(line).unwrap().replace("http://", "");
        Self { child, address }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        stream
    }

    /// Returns the answer to a request with this line and these headers.
    pub(crate) fn request(&self, line: &str, headers: &str) -> String {
        let mut stream = self.connect();
        // The server may refuse the request before it is complete.
        let _ = write!(stream, "{line} HTTP/1.1\r\n{headers}\r\n");
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    pub(crate) fn host(&self) -> String {
        format!("Host: {}\r\n", self.address)
    }

    /// Returns the body at a path.
    pub(crate) fn get(&self, path: &str) -> String {
        let mut stream = self.connect();
        // HTTP 1.0: the answer ends with the connection, and comes in one piece.
        write!(stream, "GET {path} HTTP/1.0\r\n{}\r\n", self.host()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer.split_once("\r\n\r\n").map(|(_, body)| body.to_owned()).unwrap()
    }

    /// Returns the state that follows a version; the present one after none.
    pub(crate) fn state(&self, after: &str) -> serde_json::Value {
        serde_json::from_str(&self.get(&format!("/start?after={after}"))).unwrap()
    }

    /// Returns the largest memory of the server so far in kilobytes; `None` on systems without `/proc`.
    pub(crate) fn peak_memory_kb(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.trim().trim_end_matches(" kB").parse().ok()
    }

    /// Returns the number of running child processes, or `None` on systems without `/proc`.
    pub(crate) fn children(&self) -> Option<usize> {
        let threads = std::fs::read_dir(format!("/proc/{}/task", self.child.id())).ok()?;
        let of_each = threads.flatten().map(|thread| std::fs::read_to_string(thread.path().join("children")));
        of_each.collect::<Result<String, _>>().ok().map(|all| all.split_whitespace().count())
    }

    /// Returns the number of threads of the process, or 0 on systems without `/proc`.
    pub(crate) fn threads(&self) -> usize {
        std::fs::read_dir(format!("/proc/{}/task", self.child.id())).map_or(0, Iterator::count)
    }
}
