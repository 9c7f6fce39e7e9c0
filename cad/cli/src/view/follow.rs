//! Following the file of a preview: it is read again once it is whole and quiet.

use std::path::Path;
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::state::State;
use super::{Arguments, build};

/// How often the file is polled.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// How long a file stays the same before it counts as saved: an editor that truncates and writes is done by then.
const QUIET: Duration = Duration::from_millis(300);
/// How long a file may be missing because an editor is saving it.
const MISSING_QUIET: Duration = Duration::from_secs(2);
/// How long a file that looks cut short may be one that is being saved.
const CUT_SHORT_QUIET: Duration = Duration::from_secs(2);

/// The bytes of a file, and since when they are the same.
#[derive(Debug)]
struct Watched {
    shown: Vec<u8>,
    seen: Vec<u8>,
    since: Instant,
    /// Whether it was there when it was last read.
    is_there: bool,
}

impl Watched {
    /// A file with these bytes, which are shown.
    fn new(shown: Vec<u8>, now: Instant) -> Self {
        Self { seen: shown.clone(), shown, since: now, is_there: true }
    }

    /// Takes what is read at `now`; whether it is whole, quiet and new.
    fn is_settled(&mut self, read: Option<Vec<u8>>, now: Instant) -> bool {
        // A file that is missing for a moment is one that an editor is saving.
        let Some(read) = read else {
            if self.is_there {
                (self.is_there, self.since) = (false, now);
            }
            return false;
        };
        if !self.is_there {
            (self.is_there, self.since) = (true, now);
        }
        if self.seen != read {
            (self.seen, self.since) = (read, now);
            return false;
        }
        let quiet = if looks_cut_short(&self.seen, &self.shown) { CUT_SHORT_QUIET } else { QUIET };
        if self.shown == self.seen || now.duration_since(self.since) < quiet {
            return false;
        }
        self.shown.clone_from(&self.seen);
        true
    }

    /// Whether the file is gone for longer than a save takes. What comes in its place is then shown, whatever it is.
    fn is_lost(&mut self, now: Instant) -> bool {
        let is_lost = !self.is_there && now.duration_since(self.since) >= MISSING_QUIET;
        if is_lost {
            self.shown.clear();
        }
        is_lost
    }
}

/// Whether `read` may be the first part of a file that is being written in the place of `shown`. A person may mean it
/// too, and then waits a little.
fn looks_cut_short(read: &[u8], shown: &[u8]) -> bool {
    let is_part = read.len() < shown.len() && shown.starts_with(read);
    let lacks_end = shown.ends_with(b"\n") && !read.ends_with(b"\n");
    read.trim_ascii().is_empty() || is_part || lacks_end || ends_within(read, shown)
}

/// Whether the last line of `read` has others after it in `shown`, or heads a table without a value.
fn ends_within(read: &[u8], shown: &[u8]) -> bool {
    let last = |text: &[u8]| text.trim_ascii().rsplit(|b| *b == b'\n').next().map(<[u8]>::to_vec);
    let line = last(read);
    let is_header = line.as_ref().is_some_and(|line| line.trim_ascii().starts_with(b"["));
    let is_inside = shown.split(|b| *b == b'\n').any(|other| line.as_deref() == Some(other));
    line != last(shown) && (is_header || is_inside)
}

/// Rebuilds whenever the file has changed and settled; ends with the program. `shown` is what its page was built from.
pub(super) fn follow(states: &watch::Sender<State>, arguments: &Arguments, file: &Path, shown: Vec<u8>) {
    let mut watched = Watched::new(shown, Instant::now());
    let mut is_lost = false;
    loop {
        std::thread::sleep(POLL_INTERVAL);
        if !watched.is_settled(std::fs::read(file).ok(), Instant::now()) {
            let is_told = is_lost;
            is_lost = watched.is_lost(Instant::now());
            if is_lost && !is_told {
                tell(states, format!("{}: the file is gone; the last good state stays", file.display()));
            }
            continue;
        }
        is_lost = false;
        let next = states.borrow().version + 1;
        let built = if watched.shown.trim_ascii().is_empty() {
            // Valid as a configuration, since everything has a default; but nobody means that.
            Err(format!("{}: the file is empty; the last good state stays", file.display()))
        } else {
            // From the bytes that are known to be whole: another save may be under way.
            let design = arguments.source.design_from(watched.shown.clone());
            design
                .and_then(|design| build(arguments, design, next, &watched.shown))
                .map_err(|failure| failure.to_string())
        };
        match built {
            Ok(built) => {
                states.send_replace(built);
                log::info!("rebuilt");
            }
            Err(message) => tell(states, message),
        }
    }
}

/// Tells what is wrong with the file, beside the last good state.
fn tell(states: &watch::Sender<State>, message: String) {
    log::warn!("{message}");
    states.send_modify(|state| {
        state.version += 1;
        state.trouble = Some(message);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a file is settled after each of these readings, at these milliseconds.
    fn settled(shown: &str, readings: &[(u64, Option<&str>)]) -> Vec<bool> {
        let begun = Instant::now();
        let mut watched = Watched::new(shown.as_bytes().to_vec(), begun);
        let read = |text: &Option<&str>| text.map(|text| text.as_bytes().to_vec());
        let at = |ms: u64| begun + Duration::from_millis(ms);
        readings.iter().map(|(ms, text)| watched.is_settled(read(text), at(*ms))).collect()
    }

    #[test]
    fn a_file_is_read_when_it_is_whole_and_quiet() {
        let new = Some("a = 2\n");
        // Truncated, missing, half written, and whole.
        let readings = [(10, Some("")), (900, Some("")), (950, None), (960, Some("a")), (980, new)];
        assert_eq!(settled("a = 1\n", &readings), [false; 5]);
        assert_eq!(
            settled("a = 1\n", &[(0, new), (280, new), (310, new), (900, new)]),
            [false, false, true, false]
        );
    }

    #[test]
    fn a_file_that_stays_cut_short_is_waited_for_and_then_shown() {
        let shown = "[shell]\nwidth_mm = 14\n[layout]\npins = [5]\n";
        for half in [
            "",
            // Up to a header, with what came before changed or not, with the end of the line or not.
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
    fn a_file_that_stays_away_is_lost_and_shown_again_once_it_is_back() {
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        let mut watched = Watched::new(b"a = 1\n".to_vec(), begun);
        assert!(!watched.is_settled(None, at(100)) && !watched.is_lost(at(100)));
        assert!(!watched.is_settled(None, at(1900)) && !watched.is_lost(at(1900)));
        assert!(!watched.is_settled(None, at(2200)) && watched.is_lost(at(2200)));
        let same = || Some(b"a = 1\n".to_vec());
        assert!(!watched.is_settled(same(), at(2300)) && !watched.is_lost(at(2300)));
        assert!(watched.is_settled(same(), at(2700)), "it is there again, as it was");
    }

    #[test]
    fn what_was_saved_after_the_page_was_built_is_shown() {
        let saved = Some("a = 2\n");
        // The first reading already has other bytes than the page.
        assert_eq!(settled("a = 1\n", &[(0, saved), (400, saved)]), [false, true]);
    }
}
