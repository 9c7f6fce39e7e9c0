//! Follows the file of the page: it is read again once a save is complete.

use std::time::{Duration, Instant};

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use pinswitch_store::read_own;
use tokio::sync::watch;

use super::ConfigurationSource;
use super::state::State;

/// Interval of polls.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Time without a change after which a file counts as saved: an editor that truncates and writes
/// needs less.
const SETTLE_TIME: Duration = Duration::from_millis(300);
/// Time for which an editor may remove a file during a save.
const MISSING_SETTLE_TIME: Duration = Duration::from_secs(2);
/// As [`SETTLE_TIME`], for a file that looks truncated.
const TRUNCATED_SETTLE_TIME: Duration = Duration::from_secs(2);

/// Longest file that is followed, in bytes: some times the largest 3MF of a set.
const MAX_FOLLOWED_BYTES: u64 = 16 << 20;

/// The content of a file, and since when it is unchanged.
#[derive(Debug)]
struct FileWatch {
    /// The content that the page shows.
    shown: Vec<u8>,
    /// The content that was read last.
    latest: Vec<u8>,
    since: Instant,
    /// Whether the file existed at the last poll.
    exists: bool,
}

impl FileWatch {
    /// Starts with the content that the page shows.
    fn new(shown: Vec<u8>, now: Instant) -> Self {
        Self { latest: shown.clone(), shown, since: now, exists: true }
    }

    /// Takes the content at `now`, `None` for a missing file; returns whether a new content is
    /// complete.
    fn is_settled(&mut self, content: Option<Vec<u8>>, now: Instant) -> bool {
        // Some editors remove the file for a moment.
        let Some(content) = content else {
            if self.exists {
                (self.exists, self.since) = (false, now);
            }
            return false;
        };
        if !self.exists {
            (self.exists, self.since) = (true, now);
        }
        if self.latest != content {
            (self.latest, self.since) = (content, now);
            return false;
        }
        let settle_time =
            if looks_truncated(&self.latest, &self.shown) { TRUNCATED_SETTLE_TIME } else { SETTLE_TIME };
        if self.shown == self.latest || now.duration_since(self.since) < settle_time {
            return false;
        }
        self.shown.clone_from(&self.latest);
        true
    }

    /// Whether the file is missing for longer than a save takes. A file that then appears is shown
    /// even if its content is the old one.
    fn is_lost(&mut self, now: Instant) -> bool {
        let is_lost = !self.exists && now.duration_since(self.since) >= MISSING_SETTLE_TIME;
        if is_lost {
            self.shown.clear();
        }
        is_lost
    }
}

/// Whether `content` may be the first part of a file that replaces `shown` and is still being
/// written. If a person intended it, it is shown a little later.
fn looks_truncated(content: &[u8], shown: &[u8]) -> bool {
    let is_prefix = content.len() < shown.len() && shown.starts_with(content);
    let lacks_end = shown.ends_with(b"\n") && !content.ends_with(b"\n");
    content.trim_ascii().is_empty() || is_prefix || lacks_end || ends_within(content, shown)
}

/// Whether the last line of `content` is an inner line of `shown`, or a table header without a
/// value.
fn ends_within(content: &[u8], shown: &[u8]) -> bool {
    let last = |text: &[u8]| text.trim_ascii().rsplit(|b| *b == b'\n').next().map(<[u8]>::to_vec);
    let line = last(content);
    let is_header = line.as_ref().is_some_and(|line| line.trim_ascii().starts_with(b"["));
    let is_inside = shown.split(|b| *b == b'\n').any(|other| line.as_deref() == Some(other));
    line != last(shown) && (is_header || is_inside)
}

/// Builds a new state after each save, until the process ends; returns at once without a file.
/// `shown` is the content from which the present state was built.
pub(super) fn follow(states: &watch::Sender<State>, source: &dyn ConfigurationSource, shown: Vec<u8>) {
    let Some(file) = source.file() else { return };
    let problem = |code: Code, problem: &str, help: &str| {
        Diagnostic::new(code, problem)
            .with_location(Location::file(file.display().to_string()))
            .with_help(help)
    };
    let mut file_watch = FileWatch::new(shown, Instant::now());
    let mut is_lost = false;
    loop {
        std::thread::sleep(POLL_INTERVAL);
        // A file that cannot be read counts as missing.
        let (content, obstacle) = match read_own(file, MAX_FOLLOWED_BYTES) {
            Ok(content) => (content, None),
            Err(e) => (None, Some(e)),
        };
        if !file_watch.is_settled(content, Instant::now()) {
            let was_lost = is_lost;
            is_lost = file_watch.is_lost(Instant::now());
            if is_lost && !was_lost {
                let (code, text) = match obstacle {
                    Some(e) => (codes::CANNOT_READ, format!("the file cannot be read: {e}")),
                    None => (codes::FILE_NOT_FOUND, "the file is missing".to_owned()),
                };
                report(states, &problem(code, &text, "restore it; the last valid version is shown"));
            }
            continue;
        }
        is_lost = false;
        let version = states.borrow().version + 1;
        let state = if file_watch.shown.trim_ascii().is_empty() {
            // As on the command line.
            Err(problem(
                codes::DAMAGED_FILE,
                "the file is empty",
                "restore it; the last valid version is shown",
            ))
        } else {
            // From the settled content: another save may have begun.
            State::build(source, &file_watch.shown, version).map_err(Diagnostic::from)
        };
        match state {
            Ok(state) => {
                states.send_replace(state);
                log::info!("rebuilt");
            }
            Err(diagnostic) => report(states, &diagnostic),
        }
    }
}

/// Reports a problem next to the last valid state.
fn report(states: &watch::Sender<State>, diagnostic: &Diagnostic) {
    log::warn!("{diagnostic}");
    states.send_modify(|state| {
        state.version += 1;
        state.trouble = Some(diagnostic.to_string());
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a file is settled after each of these polls, at these milliseconds.
    fn settled(shown: &str, polls: &[(u64, Option<&str>)]) -> Vec<bool> {
        let start = Instant::now();
        let mut file_watch = FileWatch::new(shown.as_bytes().to_vec(), start);
        let content = |text: &Option<&str>| text.map(|text| text.as_bytes().to_vec());
        let at = |ms: u64| start + Duration::from_millis(ms);
        polls.iter().map(|(ms, text)| file_watch.is_settled(content(text), at(*ms))).collect()
    }

    #[test]
    fn a_save_settles() {
        let new = Some("a = 2\n");
        // Truncated, missing, half written, complete.
        let polls = [(10, Some("")), (900, Some("")), (950, None), (960, Some("a")), (980, new)];
        assert_eq!(settled("a = 1\n", &polls), [false; 5]);
        assert_eq!(
            settled("a = 1\n", &[(0, new), (280, new), (310, new), (900, new)]),
            [false, false, true, false]
        );
    }

    #[test]
    fn a_truncated_file_settles_later() {
        let shown = "[shell]\nwidth_mm = 14\n[layout]\npins = [5]\n";
        for half in [
            "",
            // Up to a header, with and without a change before it, with and without a line end.
            "[shell]\nwidth_mm = 14\n[layout]",
            "[shell]\nwidth_mm = 12\n[layout]",
            "[shell]\nwidth_mm = 12\n[layout]\n",
            "[shell]\nwidth_mm = 14\n",
            "[shell]\nwidth_mm = 12\n[pins]\n",
            "[shell]\nwidth_mm = 14\n[layout]\npins = [5, 8]",
        ] {
            let half = Some(half);
            assert_eq!(
                settled(shown, &[(0, half), (700, half), (1900, half), (2100, half)]),
                [false, false, false, true]
            );
        }
    }

    #[test]
    fn a_restored_file_is_shown_again() {
        let start = Instant::now();
        let at = |ms: u64| start + Duration::from_millis(ms);
        let mut file_watch = FileWatch::new(b"a = 1\n".to_vec(), start);
        assert!(!file_watch.is_settled(None, at(100)) && !file_watch.is_lost(at(100)));
        assert!(!file_watch.is_settled(None, at(1900)) && !file_watch.is_lost(at(1900)));
        assert!(!file_watch.is_settled(None, at(2200)) && file_watch.is_lost(at(2200)));
        let same = || Some(b"a = 1\n".to_vec());
        assert!(!file_watch.is_settled(same(), at(2300)) && !file_watch.is_lost(at(2300)));
        assert!(file_watch.is_settled(same(), at(2700)), "the same content appears again");
    }

    #[test]
    fn a_save_during_the_build_is_noticed() {
        let saved = Some("a = 2\n");
        // The first poll already differs from the page.
        assert_eq!(settled("a = 1\n", &[(0, saved), (400, saved)]), [false, true]);
    }
}
