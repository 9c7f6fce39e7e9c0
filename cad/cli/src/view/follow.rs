//! Following the file of a preview: it is read again once it is whole and quiet.

use std::path::Path;
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::state::State;
use super::{Arguments, build};

/// How often the file is polled.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// How long a file stays the same before it counts as saved: an editor that truncates and writes is done by then.
const QUIET: Duration = Duration::from_millis(120);
/// How long an empty file may be one that is being saved.
const EMPTY_QUIET: Duration = Duration::from_secs(2);

/// The bytes of a file, and since when they are the same.
#[derive(Debug)]
struct Watched {
    shown: Option<Vec<u8>>,
    seen: Option<Vec<u8>>,
    since: Instant,
}

impl Watched {
    /// A file with these bytes, which are shown.
    fn new(shown: Option<Vec<u8>>, now: Instant) -> Self {
        Self { seen: shown.clone(), shown, since: now }
    }

    /// Takes what is read at `now`; whether it is whole, quiet and new.
    fn is_settled(&mut self, read: Option<Vec<u8>>, now: Instant) -> bool {
        // A file that is missing for a moment is one that an editor is saving.
        let Some(read) = read else { return false };
        if self.seen.as_ref() != Some(&read) {
            (self.seen, self.since) = (Some(read), now);
            return false;
        }
        let quiet = if read.trim_ascii().is_empty() { EMPTY_QUIET } else { QUIET };
        if self.shown == self.seen || now.duration_since(self.since) < quiet {
            return false;
        }
        self.shown.clone_from(&self.seen);
        true
    }
}

/// Rebuilds whenever the file has changed and settled; ends with the program.
pub(super) fn follow(states: &watch::Sender<State>, arguments: &Arguments, file: &Path) {
    let mut watched = Watched::new(std::fs::read(file).ok(), Instant::now());
    loop {
        std::thread::sleep(POLL_INTERVAL);
        if !watched.is_settled(std::fs::read(file).ok(), Instant::now()) {
            continue;
        }
        let next = states.borrow().version + 1;
        let built = match &watched.shown {
            // Valid as a configuration, since everything has a default; but nobody means that.
            Some(bytes) if bytes.trim_ascii().is_empty() => {
                Err(format!("{}: the file is empty; the last good state stays", file.display()))
            }
            _ => build(arguments, next).map_err(|failure| failure.message().to_owned()),
        };
        // Written to while it was read: what was built may be half of it.
        if std::fs::read(file).ok() != watched.shown {
            continue;
        }
        states.send_modify(|state| {
            state.version = next;
            match built {
                Ok((page, data)) => {
                    (state.page, state.data, state.trouble) = (page.into(), data.into(), None);
                    log::info!("rebuilt");
                }
                Err(message) => {
                    log::warn!("{message}");
                    state.trouble = Some(message);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_when_it_is_whole_and_quiet() {
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        let bytes = |text: &str| Some(text.as_bytes().to_vec());
        let mut watched = Watched::new(bytes("a = 1"), begun);
        // Truncated, missing, half written, and whole.
        for (ms, read) in
            [(10, bytes("")), (200, bytes("")), (300, None), (310, bytes("a")), (330, bytes("a = 2"))]
        {
            assert!(!watched.is_settled(read, at(ms)), "{ms}");
        }
        assert!(!watched.is_settled(bytes("a = 2"), at(440)));
        assert!(watched.is_settled(bytes("a = 2"), at(460)));
        assert!(!watched.is_settled(bytes("a = 2"), at(900)));
    }

    #[test]
    fn a_file_that_stays_empty_is_said_to_be() {
        let begun = Instant::now();
        let mut watched = Watched::new(Some(b"a = 1".to_vec()), begun);
        assert!(!watched.is_settled(Some(Vec::new()), begun));
        assert!(!watched.is_settled(Some(Vec::new()), begun + Duration::from_secs(1)));
        assert!(watched.is_settled(Some(Vec::new()), begun + Duration::from_secs(3)));
    }
}
