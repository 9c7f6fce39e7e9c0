//! Runs a program within limits: of time, of what it prints, and of what it writes. It ends with this process.

use std::io::{Error, Read, Result};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

/// Limits of one run of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunLimits {
    /// Longest run.
    pub time: Duration,
    /// Most bytes that it prints.
    pub printed_bytes: u64,
    /// Most bytes of the file that it writes.
    pub written_bytes: u64,
}

impl Default for RunLimits {
    /// Ten minutes (slicing a part takes seconds), 16 MB of messages, and a G-code of 1 GB.
    fn default() -> Self {
        Self { time: Duration::from_secs(600), printed_bytes: 16 << 20, written_bytes: 1 << 30 }
    }
}

/// The end of a run.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) status: ExitStatus,
    /// The end of its standard error, or else of its standard output.
    pub(crate) message: Vec<u8>,
}

/// Why a run was ended.
#[derive(Debug)]
pub(crate) enum RunError {
    /// The program cannot be started.
    Io(Error),
    /// It exceeded a limit, described as in "it took longer than 600 s".
    Limit(String),
}

/// Interval at which a program is observed: a short one is not delayed by more.
const FIRST_INTERVAL: Duration = Duration::from_millis(1);
const LAST_INTERVAL: Duration = Duration::from_millis(50);
/// Time after the end of a program in which its pipes end, unless something that it has started keeps them open.
const MESSAGE_TIME: Duration = Duration::from_secs(1);
/// Bytes of the end of a message that are kept.
const KEPT_BYTES: usize = 8 << 10;

/// Runs `command`, which may write `written`.
///
/// With a `supervisor` (the arguments of a program that runs another one and ends it when its standard input ends, see
/// [`supervise`]), the command ends even if this process is killed.
pub(crate) fn run(
    command: &Command,
    supervisor: &[PathBuf],
    written: &Path,
    limits: RunLimits,
) -> std::result::Result<Run, RunError> {
    let mut command = supervised(command, supervisor);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = Group(command.spawn().map_err(RunError::Io)?);
    // Open until the end: the supervisor ends the program when it is closed.
    let open = child.0.stdin.take();
    let pipes = (child.0.stdout.take(), child.0.stderr.take());
    let printed = Arc::new(AtomicU64::new(0));
    let keep = |pipe: Option<Box<dyn Read + Send>>| {
        let (sender, kept) = channel();
        let printed = Arc::clone(&printed);
        std::thread::spawn(move || sender.send(last_bytes(pipe, &printed)));
        kept
    };
    let output = keep(pipes.0.map(|pipe| Box::new(pipe) as _));
    let errors = keep(pipes.1.map(|pipe| Box::new(pipe) as _));
    let ended = wait(&mut child.0, &printed, written, limits);
    // Also what the program has started: it would keep the pipes open. The supervisor ends what has left the process group;
    // without one, that is not waited for.
    drop(open);
    if !supervisor.is_empty() {
        child.end_within(MESSAGE_TIME);
    }
    drop(child);
    let [output, errors] = [output, errors].map(|kept| kept.recv_timeout(MESSAGE_TIME).unwrap_or_default());
    let message = if errors.trim_ascii().is_empty() { output } else { errors };
    Ok(Run { status: ended?, message })
}

/// Returns the command that runs `command` under a supervisor, or the command itself, in a process group of its own.
fn supervised(command: &Command, supervisor: &[PathBuf]) -> Command {
    let mut all = supervisor.iter().map(|part| part.as_os_str()).chain([command.get_program()]);
    let mut outer = Command::new(all.next().unwrap_or_default());
    outer.args(all).args(command.get_args());
    if let Some(folder) = command.get_current_dir() {
        outer.current_dir(folder);
    }
    outer.stdin(if supervisor.is_empty() { Stdio::null() } else { Stdio::piped() });
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut outer, 0);
    outer
}

/// A running program; dropping it ends it and everything that it has started in its group.
struct Group(Child);

impl Group {
    /// Waits until the program has ended, but not longer.
    fn end_within(&mut self, time: Duration) {
        let start = Instant::now();
        while start.elapsed() < time && matches!(self.0.try_wait(), Ok(None)) {
            std::thread::sleep(FIRST_INTERVAL);
        }
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Some(group) = i32::try_from(self.0.id()).ok().and_then(rustix::process::Pid::from_raw) {
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits for the end of the program, or for the first limit that it exceeds.
fn wait(
    child: &mut Child,
    printed: &AtomicU64,
    written: &Path,
    limits: RunLimits,
) -> std::result::Result<ExitStatus, RunError> {
    let (start, mut interval) = (Instant::now(), FIRST_INTERVAL);
    loop {
        if let Some(status) = child.try_wait().map_err(RunError::Io)? {
            return Ok(status);
        }
        let limit = if start.elapsed() > limits.time {
            Some(format!("it took longer than {} s", limits.time.as_secs_f64()))
        } else if printed.load(Ordering::Relaxed) > limits.printed_bytes {
            Some(format!("it printed more than {} bytes", limits.printed_bytes))
        } else if std::fs::metadata(written).is_ok_and(|file| file.len() > limits.written_bytes) {
            Some(format!("its file has more than {} bytes", limits.written_bytes))
        } else {
            None
        };
        if let Some(limit) = limit {
            return Err(RunError::Limit(limit));
        }
        std::thread::sleep(interval);
        interval = (2 * interval).min(LAST_INTERVAL);
    }
}

/// Reads a pipe to its end, and returns its last bytes.
fn last_bytes(pipe: Option<Box<dyn Read + Send>>, printed: &AtomicU64) -> Vec<u8> {
    let (mut kept, mut chunk) = (Vec::new(), [0; 4096]);
    let Some(mut pipe) = pipe else { return kept };
    while let Ok(count @ 1..) = pipe.read(&mut chunk) {
        printed.fetch_add(count as u64, Ordering::Relaxed);
        kept.extend_from_slice(&chunk[..count]);
        kept.drain(..kept.len().saturating_sub(KEPT_BYTES));
    }
    kept
}

/// Runs a program and returns its exit code. Ends this process group, with the program and everything that it has
/// started, when standard input ends: the process that wanted the result has ended then.
///
/// # Errors
/// If the program cannot be started.
pub fn supervise(program: &Path, arguments: &[std::ffi::OsString]) -> Result<i32> {
    // What the program starts and leaves becomes a child of this process, also in a session of its own.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::set_child_subreaper(Some(rustix::process::getpid()));
    let mut child = Command::new(program).args(arguments).stdin(Stdio::null()).spawn()?;
    std::thread::spawn(|| {
        let _ = std::io::copy(&mut std::io::stdin().lock(), &mut std::io::sink());
        #[cfg(target_os = "linux")]
        end_children();
        #[cfg(unix)]
        let _ = rustix::process::kill_current_process_group(rustix::process::Signal::KILL);
        std::process::exit(1);
    });
    // A signal ends a program without a code.
    let ended = child.wait();
    #[cfg(target_os = "linux")]
    end_children();
    Ok(ended?.code().unwrap_or(1))
}

/// Most generations of processes that are ended: each end gives this process the children of the ended one.
#[cfg(target_os = "linux")]
const MAX_GENERATIONS: usize = 100;

/// Ends all children of this process, and those that they leave to it.
#[cfg(target_os = "linux")]
fn end_children() {
    use rustix::process::{Pid, Signal, WaitOptions, kill_process, waitpid};
    for _ in 0..MAX_GENERATIONS {
        let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
        let children: Vec<Pid> = threads
            .filter_map(|thread| std::fs::read_to_string(thread.path().join("children")).ok())
            .flat_map(|list| list.split_whitespace().filter_map(|id| id.parse().ok()).collect::<Vec<i32>>())
            .filter_map(Pid::from_raw)
            .collect();
        if children.is_empty() {
            return;
        }
        for child in children {
            let _ = kill_process(child, Signal::KILL);
            let _ = waitpid(Some(child), WaitOptions::empty());
        }
    }
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, folder: &Path, limits: RunLimits) -> std::result::Result<Run, RunError> {
        let mut command = Command::new("sh");
        command.args(["-c", script]).current_dir(folder);
        run(&command, &[], &folder.join("written"), limits)
    }

    fn limits(time_ms: u64) -> RunLimits {
        RunLimits { time: Duration::from_millis(time_ms), printed_bytes: 1 << 20, written_bytes: 1 << 20 }
    }

    #[test]
    fn a_message_is_its_end() {
        let folder = tempfile::tempdir().unwrap();
        let script = "yes out | head -c 20000; echo last >&2; exit 3";
        let run = shell(script, folder.path(), limits(20_000)).unwrap();
        assert_eq!((run.status.code(), &*run.message), (Some(3), &b"last\n"[..]));
        let run = shell("yes out | head -c 20000", folder.path(), limits(20_000)).unwrap();
        assert_eq!(run.message.len(), KEPT_BYTES);
    }

    #[test]
    fn limits_end_a_program() {
        let folder = tempfile::tempdir().unwrap();
        for (script, reason) in [
            ("sleep 60", "longer than 0.5 s"),
            // Its child keeps the pipes open.
            ("sleep 60 & sleep 60", "longer than 0.5 s"),
            // The same in another process group.
            ("setsid sleep 20 & sleep 60", "longer than 0.5 s"),
            ("yes", "printed more than 1048576"),
            ("yes > written", "more than 1048576 bytes"),
        ] {
            let start = Instant::now();
            let time = if script.contains("sleep") { 500 } else { 20_000 };
            match shell(script, folder.path(), limits(time)) {
                Err(RunError::Limit(text)) => assert!(text.contains(reason), "{script}: {text}"),
                other => panic!("{script}: {other:?}"),
            }
            assert!(start.elapsed() < Duration::from_secs(15), "{script}");
        }
    }

    #[test]
    fn nothing_that_it_started_remains() {
        let folder = tempfile::tempdir().unwrap();
        let run = shell("(sleep 1; touch late) > /dev/null 2>&1 &", folder.path(), limits(20_000)).unwrap();
        assert!(run.status.success());
        std::thread::sleep(Duration::from_millis(1500));
        assert!(!folder.path().join("late").exists());
    }
}
