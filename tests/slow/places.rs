//! Every command that writes, at full, read-only and odd places: it succeeds or ends with one clear error, soon, and
//! changes nothing else.

#![cfg(unix)]

use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{done, hashes};

/// Longest run: a command may compute before it writes.
const LONGEST: Duration = Duration::from_secs(60);
/// Longest error in bytes, without the name of the place.
const LONGEST_ERROR: usize = 700;

/// Commands that write; the last argument is followed by the place.
const WRITERS: [&[&str]; 13] = [
    &["generate", "three-double", "--format", "stl", "--out"],
    &["batch", "sweep.toml", "--out"],
    &["merge", "one", "--out"],
    &["simulate", "one.toml", "--out"],
    &["calibrate", "one/plateaus.csv", "--out"],
    &["experiment", "c", "--minutes", "30", "--out"],
    &["import", "one/plateaus.csv", "--yes", "--out"],
    &["finger", "three-double", "--out"],
    &["physics", "three-double", "--out"],
    &["export", "three-double", "--set", "friction.points=5", "--to", "mujoco", "--draws", "2", "--out"],
    &["init", "three-double", "--out"],
    &["render", "three-double", "--out"],
    &["man", "--out"],
];

/// Odd places, and the most blocks of 512 bytes that a file may have there, as on a full disk.
const PLACES: [(&str, Option<u32>); 20] = [
    ("full", Some(0)),
    ("nearly-full", Some(1)),
    ("half-full", Some(20)),
    ("file", None),
    ("file/below", None),
    ("dangling", None),
    ("loop", None),
    ("loop/below", None),
    ("pipe", None),
    ("pipe/below", None),
    ("/proc", None),
    ("/proc/1/below", None),
    ("/sys/below", None),
    ("/dev/full", None),
    ("/dev/null/below", None),
    ("../in/./new", None),
    ("a\u{1b}[31mred\nline", None),
    ("no/such/folder/yet", None),
    ("LONG", None),
    ("dear", None),
];

#[test]
fn odd_places_give_one_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in");
    std::fs::create_dir(&path).unwrap();
    let plan = "layouts = [[5, 8, 11]]\nweights_g = [503.6, 2005.0, 5002.5]\nspeeds_pct = [40, 52, 70]\n\
                repetitions = [3, 3]\n";
    std::fs::write(path.join("one.toml"), plan).unwrap();
    done(&path, &["-q", "simulate", "one.toml", "--out", "one"]);
    done(&path, &["-q", "calibrate", "one/plateaus.csv", "--out", "c"]);
    std::fs::write(path.join("sweep.toml"), "parts = [\"coupon\"]\n[axes]\n\"shell.width_mm\" = [14]\n")
        .unwrap();
    std::fs::write(path.join("file"), "dear").unwrap();
    std::fs::create_dir(path.join("dear")).unwrap();
    std::fs::write(path.join("dear/dear.txt"), "dear").unwrap();
    for (link, target) in [("dangling", "nowhere"), ("loop", "loop")] {
        std::os::unix::fs::symlink(target, path.join(link)).unwrap();
    }
    assert!(Command::new("mkfifo").arg(path.join("pipe")).status().unwrap().success());
    let inputs = hashes(&path.join("one"));
    let (mut runs, mut refused) = (0, 0);
    for writer in WRITERS {
        for (place, blocks) in PLACES {
            let place = if place == "LONG" { "x".repeat(300) } else { place.to_owned() };
            let text = ends_clearly(&path, writer, &place, blocks);
            runs += 1;
            refused += usize::from(text.is_some());
            let is_kept = |name: &str| std::fs::read(path.join(name)).unwrap() == b"dear";
            // These two were given the file itself.
            let is_target = matches!(writer[0], "import" | "render") && place == "file";
            assert!(is_target || is_kept("file"), "{writer:?} {place}");
            assert!(is_kept("dear/dear.txt"), "{writer:?} {place}");
            std::fs::write(path.join("file"), "dear").unwrap();
            assert_eq!(hashes(&path.join("one")), inputs, "{writer:?} {place}");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{writer:?} {place}");
            clear(&path);
        }
    }
    println!("{runs} runs; {refused} were refused");
    assert!(runs >= 200 && refused > runs / 3);
}

/// Runs a command; returns its error if it is refused.
fn ends_clearly(folder: &Path, writer: &[&str], place: &str, blocks: Option<u32>) -> Option<String> {
    let limit = blocks.map_or(String::new(), |blocks| format!("ulimit -f {blocks}; trap '' XFSZ; "));
    let mut command = Command::new("sh");
    command.args(["-c", &format!("{limit}exec \"$0\" -q \"$@\""), env!("CARGO_BIN_EXE_pinswitch")]);
    command.args(writer).arg(place).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut pipe = child.stderr.take().unwrap();
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        pipe.read_to_string(&mut text).map(|_| text)
    });
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > LONGEST {
            let _ = child.kill();
            panic!("{writer:?} {place:?} waits");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let (code, text) = (child.wait().unwrap().code(), reader.join().unwrap().unwrap());
    let is_clear = match code {
        Some(0) => !text.contains("error: "),
        Some(1 | 2) => text.starts_with("error: ") && text.matches("error: ").count() == 1,
        _ => false,
    };
    assert!(is_clear && !text.contains("panicked"), "{writer:?} {place:?} {code:?}: {text}");
    assert!(text.len() < LONGEST_ERROR + 3 * place.len(), "{writer:?} {place:?}: {text}");
    assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{writer:?} {place:?}: {text:?}");
    (code != Some(0)).then_some(text)
}

/// Removes everything that a command has written.
fn clear(folder: &Path) {
    const KEPT: [&str; 9] =
        ["one", "one.toml", "c", "sweep.toml", "file", "dear", "dangling", "loop", "pipe"];
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap()) {
        if KEPT.iter().any(|kept| entry.file_name() == *kept) {
            continue;
        }
        if entry.file_type().unwrap().is_dir() {
            std::fs::remove_dir_all(entry.path()).unwrap();
        } else {
            std::fs::remove_file(entry.path()).unwrap();
        }
    }
    for entry in std::fs::read_dir(folder.join("dear")).unwrap().map(|entry| entry.unwrap()) {
        if entry.file_name() != "dear.txt" {
            let _ = std::fs::remove_dir_all(entry.path());
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
