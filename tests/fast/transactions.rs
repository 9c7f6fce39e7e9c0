//! Locks, special files and full disks: no command waits without end, and none damages an earlier result.

#![cfg(unix)]

use std::io::{Read, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{binary, done, ended, hashes, preview::Preview};

/// Time in which a command that refuses something ends, on a busy machine.
const SOON: Duration = Duration::from_secs(20);

/// Runs the binary, and fails if it takes longer than [`SOON`].
fn ends_soon(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = binary();
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > SOON {
            child.kill().unwrap();
            panic!("{arguments:?} waits");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let mut output = String::new();
    child.stderr.take().unwrap().read_to_string(&mut output).unwrap();
    (child.wait().unwrap().code(), output)
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Makes a table with a plan, and a log.
fn with_measurements(folder: &Path) {
    std::fs::write(folder.join("plan.toml"), PLAN).unwrap();
    done(folder, &["-q", "simulate", "plan.toml", "--out", "bench"]);
    std::fs::write(folder.join("foreign.csv"), "t [s];F [N]\n0;1\n1;2\n2;3\n").unwrap();
}

const PLAN: &str = r#"
seed = 3
protocol = "randomised"
layouts = [[5, 8, 11]]
weights_g = [251.2, 1003.2, 2005.0, 3007.2, 4007.8, 5002.5]
speeds_pct = [40, 46, 52, 58, 64, 70]
dwells_s = [1, 3, 10]
repetitions = [6, 6]
[[disturbances]]
target = "friction"
size = 0.25
kind.step = { at = 0.5 }
"#;

/// A command of each kind that writes into a folder or a file in it.
const WRITERS: [&[&str]; 11] = [
    &["generate", "three-double", "--format", "stl", "--out", "out"],
    &["simulate", "plan.toml", "--out", "out"],
    &["calibrate", "bench/plateaus.csv", "--out", "out"],
    &["experiment", "first", "--minutes", "60", "--out", "out"],
    &["design", "three-double", "--threshold", "24", "--best", "1", "--out", "out"],
    &["finger", "--out", "out"],
    &["physics", "three-double", "--out", "out"],
    &["tolerances", "three-double", "--draws", "10", "--out", "out"],
    &["render", "three-double", "--out", "out/picture.png"],
    &["init", "three-double", "--out", "out/mine.toml"],
    &["man", "--out", "out"],
];

#[test]
fn a_busy_folder_is_refused_soon() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    with_measurements(path);
    done(path, &["-q", "calibrate", "bench/plateaus.csv", "--out", "first"]);
    let out = path.join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("mine.txt"), "dear").unwrap();
    // A process that was stopped while it wrote.
    let lock = std::fs::File::create(out.join(".pinswitch-lock")).unwrap();
    lock.lock().unwrap();
    writeln!(&lock, "4242 {}", std::time::UNIX_EPOCH.elapsed().unwrap().as_secs() - 75).unwrap();
    for command in WRITERS {
        let (code, output) = ends_soon(path, &[&["-q"], command].concat());
        let busy = output.contains("another run is writing into this folder: process 4242, for 7");
        assert!(code == Some(1) && busy && output.contains("--wait SECONDS"), "{command:?}: {output}");
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 2, "{command:?}");
    }
    // A wait that is long enough.
    let release = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(1500));
        drop(lock);
    });
    let start = Instant::now();
    done(path, &["-q", "--wait", "60", "man", "--out", "out"]);
    assert!(start.elapsed() >= Duration::from_millis(1000));
    release.join().unwrap();
    assert_eq!(std::fs::read(out.join("mine.txt")).unwrap(), b"dear");
    let (code, output) = ended(path, &["man", "--out", "out", "--wait", "x"]);
    assert!(code == Some(2) && output.contains("--wait"), "{output}");
}

/// Repositories of data take one name only, so that a descriptor may be a person's own.
#[test]
fn a_descriptor_of_ones_own_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    with_measurements(path);
    let descriptor = path.join("out/datapackage.json");
    let calibrate = ["-q", "calibrate", "bench/plateaus.csv", "--out", "out"];
    let published = ["-q", "calibrate", "--published", "--out", "out"];
    for command in [&calibrate, &calibrate, &published] {
        done(path, command);
        assert_eq!(descriptor.exists(), command == &calibrate);
    }
    for own in ["{\"name\": \"mine\"}".to_owned(), {
        done(path, &calibrate);
        std::fs::read_to_string(&descriptor).unwrap().replacen(
            '{',
            "{ \"licenses\": [{ \"name\": \"CC0-1.0\" }],",
            1,
        )
    }] {
        std::fs::write(&descriptor, &own).unwrap();
        let before = hashes(&path.join("out"));
        for command in [&calibrate, &published] {
            let (code, output) = ends_soon(path, command);
            assert!(code == Some(2) && output.contains("datapackage.json"), "{output}");
        }
        assert_eq!(hashes(&path.join("out")), before);
        std::fs::remove_file(&descriptor).unwrap();
    }
}

#[test]
fn commands_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let pictures: Vec<_> = (0..4)
        .map(|nth| {
            let mut command = binary();
            command.args(["-q", "init", "three-double", "--out", &format!("{nth}.toml")]);
            command.current_dir(folder.path()).spawn().unwrap()
        })
        .collect();
    assert!(pictures.into_iter().all(|mut child| child.wait().unwrap().success()));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
}

#[test]
fn special_files_are_not_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    with_measurements(path);
    done(path, &["-q", "calibrate", "bench/plateaus.csv", "--out", "first"]);
    std::fs::write(path.join("sweep.toml"), "[axes]\n\"shell.width_mm\" = [14]\n").unwrap();
    let batch = ["batch", "sweep.toml", "--out", "out"];
    for (nth, command) in WRITERS.into_iter().chain([&batch[..]]).enumerate() {
        let names: &[&str] = match command[0] {
            "batch" => &["batch.json", "variants.csv"],
            "generate" => &[".pinswitch-lock", ".pinswitch-journal", "manifest.json"],
            // A search takes long if it is not refused.
            "design" => &[".pinswitch-lock"],
            _ => &[".pinswitch-lock", "provenance.json"],
        };
        for name in names {
            for is_pipe in [true, false].into_iter().take(if nth < 3 { 2 } else { 1 }) {
                let _ = std::fs::remove_dir_all(path.join("out"));
                std::fs::create_dir(path.join("out")).unwrap();
                let special = path.join("out").join(name);
                if is_pipe {
                    pipe(&special);
                } else {
                    std::os::unix::fs::symlink("/dev/zero", &special).unwrap();
                }
                let (code, output) = ends_soon(path, &[&["-q"], command].concat());
                // A command that has no use for the name ignores it.
                let named = output.contains(name) || output.contains("is not empty");
                assert!(code == Some(0) || named, "{command:?} {name}: {output}");
                assert!(output.len() < 800, "{output}");
            }
        }
    }
}

/// Inputs, and files next to them, may be pipes that no one writes.
#[test]
fn pipes_in_place_of_inputs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    with_measurements(path);
    done(path, &["-q", "calibrate", "bench/plateaus.csv", "--out", "first"]);
    std::fs::write(path.join("rows.toml"), "rows.file = \"pipe\"\n").unwrap();
    for name in ["pipe", "one/provenance.json", "piped/report.json"] {
        std::fs::create_dir_all(path.join(name).parent().unwrap()).unwrap();
        pipe(&path.join(name));
    }
    done(path, &["init", "three-double", "--out", "mine.toml"]);
    std::fs::copy(path.join("mine.toml"), path.join("one/mine.toml")).unwrap();
    for (command, word) in [
        (&["predict", "pipe"][..], "pipe"),
        (&["predict", "one/mine.toml"], "provenance.json"),
        (&["generate", "one/mine.toml", "--out", "set"], "provenance.json"),
        (&["calibrate", "pipe", "--out", "out"], "pipe"),
        (&["experiment", "piped", "--out", "out"], "report.json"),
        (&["batch", "rows.toml", "--dry-run"], "pipe"),
        (&["import", "pipe", "--out", "t.csv"], "pipe"),
        (&["check", "pipe"], "pipe"),
    ] {
        let (code, output) = ends_soon(path, command);
        assert!(code == Some(2) && output.contains(word), "{command:?}: {output}");
    }
}

#[test]
fn a_log_from_elsewhere_is_not_executed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["init", "three-double", "--out", "mine.toml"]);
    std::fs::write(path.join("notes.txt"), "dear").unwrap();
    std::fs::write(path.join(".pinswitch-commit"), "pinswitch-commit/1\0remove\0notes.txt\0\0\0").unwrap();
    for command in [&["predict", "mine.toml"][..], &["init", "three-single", "--out", "other.toml"]] {
        let (code, output) = ends_soon(path, command);
        assert!(code != Some(0) && output.contains(".pinswitch-commit"), "{command:?}: {output}");
        assert_eq!(std::fs::read(path.join("notes.txt")).unwrap(), b"dear");
    }
}

#[test]
fn json_has_no_active_characters() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a\u{9b}31m\u{202e}.toml"), "[switch]\nname = \"x\"\n").unwrap();
    let run = crate::harness::pinswitch(
        folder.path(),
        &["generate", "a\u{9b}31m\u{202e}.toml", "--out", "o", "--json"],
    );
    let text = String::from_utf8(run.stdout).unwrap();
    let active = text.chars().find(|c| *c != '\n' && c.is_control() || *c == '\u{202e}');
    assert_eq!(active, None);
    let parsed: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(parsed["source"]["name"].as_str().unwrap().contains('\u{202e}'), "{text}");
}

#[test]
fn empty_paths_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sweep.toml"), "[axes]\n\"shell.width_mm\" = [14]\n").unwrap();
    for command in [
        &["batch", "sweep.toml", "--out", ""][..],
        &["merge", "a", "b", "--out", ""],
        &["generate", "three-double", "--out", ""],
        &["render", "three-double", "--out", ""],
        &["design", "three-double", "--threshold", "24", "--out", ""],
    ] {
        let (code, output) = ended(folder.path(), command);
        assert!(code == Some(2) && output.contains("--out"), "{command:?}: {output}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{command:?}");
    }
}

#[test]
fn an_empty_configuration_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("empty.toml"), " \n\n").unwrap();
    for command in [
        &["generate", "empty.toml", "--out", "set"][..],
        &["predict", "empty.toml"],
        &["render", "empty.toml", "--out", "a.png"],
        &["view", "empty.toml", "--port", "0"],
    ] {
        let (code, output) = ends_soon(folder.path(), command);
        assert!(code == Some(2) && output.contains("empty.toml: the file is empty"), "{command:?}: {output}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A limit of the system on the size of a file takes the place of a full disk.
#[test]
fn a_full_disk_keeps_the_earlier_result() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    with_measurements(path);
    done(path, &["-q", "calibrate", "bench/plateaus.csv", "--out", "result"]);
    assert!(path.join("result/discovered.toml").exists(), "the step is fitted by a form");
    // A table without structure, whose calibration removes the form.
    let plain = PLAN.split("[[disturbances]]").next().unwrap();
    std::fs::write(path.join("plain.toml"), plain).unwrap();
    done(path, &["-q", "simulate", "plain.toml", "--out", "plain"]);
    done(path, &["-q", "calibrate", "plain/plateaus.csv", "--out", "whole"]);
    let largest = std::fs::read_dir(path.join("whole")).unwrap();
    let largest = largest.map(|file| file.unwrap().metadata().unwrap().len()).max().unwrap();
    let before = hashes(&path.join("result"));
    for blocks in [0, 1, 4, 16, (largest / 512).saturating_sub(1)] {
        let script = format!("ulimit -f {blocks}; trap '' XFSZ; exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_pinswitch"), "-q", "calibrate"]);
        command.args(["plain/plateaus.csv", "--out", "result"]).current_dir(path);
        let output = command.output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && text.contains("cannot write"), "{blocks}: {text}");
        assert_eq!(hashes(&path.join("result")), before, "{blocks} blocks");
    }
    done(path, &["-q", "calibrate", "plain/plateaus.csv", "--out", "result"]);
    assert!(!path.join("result/discovered.toml").exists());
    assert_eq!(hashes(&path.join("result")), hashes(&path.join("whole")));
}

/// Posts values to `/save`, and returns the answer.
fn save(preview: &Preview, width_mm: f64) -> serde_json::Value {
    let body = serde_json::json!({ "values": { "shell.width_mm": width_mm } }).to_string();
    let headers = format!(
        "{}Origin: http://{}\r\nContent-Length: {}\r\n\r\n{body}",
        preview.host(),
        preview.address,
        body.len()
    );
    let answer = preview.request("POST /save", &headers);
    serde_json::from_str(answer.split_once("\r\n\r\n").unwrap().1).unwrap()
}

#[test]
fn saving_keeps_permissions_and_links() {
    let folder = tempfile::tempdir().unwrap();
    let [file, link] = ["mine.toml", "link.toml"].map(|name| folder.path().join(name));
    std::fs::write(&file, "[shell]\nwidth_mm = 14\n").unwrap();
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o600)).unwrap();
    let preview = Preview::start(folder.path(), "mine.toml");
    assert_eq!(save(&preview, 13.0)["saved"], "mine.toml");
    assert_eq!(std::fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    std::fs::hard_link(&file, &link).unwrap();
    assert_eq!(save(&preview, 13.5)["saved"], "mine.toml");
    assert_eq!(std::fs::read(&link).unwrap(), std::fs::read(&file).unwrap());
    assert_eq!(std::fs::metadata(&file).unwrap().nlink(), 2);
    std::fs::set_permissions(&file, PermissionsExt::from_mode(0o444)).unwrap();
    let before = std::fs::read(&file).unwrap();
    let refused = save(&preview, 14.5);
    assert!(refused["error"].as_str().unwrap().contains("write-protected"), "{refused}");
    assert_eq!(std::fs::read(&file).unwrap(), before);
}

#[test]
fn the_server_answers_while_a_folder_is_busy() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    std::fs::write(&file, "[shell]\nwidth_mm = 14\n").unwrap();
    let preview = Preview::start(folder.path(), "mine.toml");
    let lock = std::fs::File::create(folder.path().join(".pinswitch-lock")).unwrap();
    lock.lock().unwrap();
    std::thread::scope(|scope| {
        let saving = scope.spawn(|| save(&preview, 13.0));
        let start = Instant::now();
        for _ in 0..5 {
            assert!(preview.get("/").contains("<html"));
        }
        assert!(start.elapsed() < SOON);
        let refused = saving.join().unwrap();
        assert!(refused["error"].as_str().unwrap().contains("another run is writing"), "{refused}");
    });
    drop(lock);
    // The followed file becomes a pipe that no one writes, then endless.
    for is_pipe in [true, false] {
        std::fs::remove_file(&file).unwrap();
        if is_pipe {
            pipe(&file);
        } else {
            std::os::unix::fs::symlink("/dev/zero", &file).unwrap();
        }
        assert!(save(&preview, 13.0)["error"].is_string());
        std::thread::sleep(Duration::from_millis(2500));
        let state = preview.state("");
        assert!(state["trouble"].as_str().unwrap().contains("not an ordinary file"), "{state:.300}");
        assert!(preview.get("/").contains("<html"));
    }
    std::fs::remove_file(&file).unwrap();
    std::fs::write(&file, "[shell]\nwidth_mm = 12\n").unwrap();
    let is_shown = (0..100).any(|_| {
        std::thread::sleep(Duration::from_millis(100));
        preview.state("")["trouble"].is_null()
    });
    assert!(is_shown, "the restored file is not shown");
}

#[test]
fn stalled_requests_leave_room_for_pages() {
    let folder = tempfile::tempdir().unwrap();
    let preview = Preview::start(folder.path(), "three-double");
    let head = format!(
        "POST /save HTTP/1.1\r\n{}Origin: http://{}\r\nContent-Length: 100\r\n\r\n",
        preview.host(),
        preview.address
    );
    // As many as there are connections.
    let stalled: Vec<_> = (0..64)
        .map(|_| {
            let mut connection = preview.connect();
            connection.write_all(head.as_bytes()).unwrap();
            connection
        })
        .collect();
    let start = Instant::now();
    assert!(preview.get("/").contains("<html"));
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    drop(stalled);
}

#[test]
fn bodies_are_bounded_together() {
    let folder = tempfile::tempdir().unwrap();
    let preview = Preview::start(folder.path(), "three-double");
    let head = format!(
        "POST /answer HTTP/1.1\r\n{}Origin: http://{}\r\nContent-Length: 60000000\r\n\r\n",
        preview.host(),
        preview.address
    );
    let chunk = vec![b' '; 1 << 20];
    let mut connections: Vec<_> = (0..40).map(|_| preview.connect()).collect();
    for connection in &mut connections {
        connection.set_write_timeout(Some(Duration::from_secs(2))).unwrap();
        let _ = connection.write_all(head.as_bytes());
        // Refused connections do not accept more.
        let _ = (0..12).all(|_| connection.write_all(&chunk).is_ok());
    }
    // Short requests are answered all the same.
    let body = r#"{"command": "design", "values": {}}"#;
    let headers = format!(
        "{}Origin: http://{}\r\nContent-Length: {}\r\n\r\n{body}",
        preview.host(),
        preview.address,
        body.len()
    );
    assert!(preview.request("POST /answer", &headers).contains("\"trouble\":null"));
    if let Some(kilobytes) = preview.peak_memory_kb() {
        assert!(kilobytes < 400_000, "{kilobytes} kB");
    }
}
