//! `pinswitch view`: origin checks, bounds, saving, and partial files.

use std::io::Write;
use std::time::Duration;

use crate::harness::preview::Preview;
use crate::harness::{binary, done};

#[test]
fn other_hosts_and_origins_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let preview = Preview::start(folder.path(), "three-double");
    let host = preview.host();
    let page = preview.request("GET /", &host);
    assert!(page.starts_with("HTTP/1.1 200"), "{page:.200}");
    // The same policy as in a saved page.
    let policy = page.lines().find_map(|l| l.strip_prefix("content-security-policy: ")).unwrap().to_owned();
    assert!(policy.contains("script-src 'sha256-") && !policy.contains("script-src 'unsafe"), "{policy}");
    assert!(page.contains(&format!("content=\"{policy}\"")));
    let port = preview.address.rsplit(':').next().unwrap();
    assert!(preview.request("GET /", &format!("Host: localhost:{port}\r\n")).starts_with("HTTP/1.1 200"));
    for headers in [
        format!("Host: evil.example:{port}\r\n"),
        String::new(),
        format!("{host}Origin: http://evil.example\r\n"),
        format!("{host}Origin: null\r\n"),
    ] {
        let answer = preview.request("GET /start?after=x", &headers);
        assert!(answer.starts_with("HTTP/1.1 403"), "{headers:?}: {answer:.200}");
        assert!(!answer.contains("layout.pins"));
    }
    for method in ["POST", "PUT", "DELETE", "TRACE", "OPTIONS"] {
        let answer = preview.request(&format!("{method} /"), &host);
        assert!(answer.starts_with("HTTP/1.1 405"), "{method}: {answer:.200}");
    }
    let head = preview.request("HEAD /", &host);
    assert!(head.starts_with("HTTP/1.1 200") && head.ends_with("\r\n\r\n"), "{head:.200}");
}

/// Returns a request of the configurator with the headers of its page.
fn with_headers(preview: &Preview, request: &str) -> String {
    format!(
        "{}Origin: http://{}\r\nContent-Length: {}\r\n\r\n{request}",
        preview.host(),
        preview.address,
        request.len()
    )
}

/// Returns the answer to a request of the configurator.
fn post(preview: &Preview, path: &str, request: &str) -> String {
    let answer = preview.request(&format!("POST {path}"), &with_headers(preview, request));
    answer.split_once("\r\n\r\n").map_or(answer.clone(), |(_, body)| body.to_owned())
}

#[test]
fn the_configurator_saves_the_followed_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# mine\n[layout]\npins = [5, 8, 11] # three\n\n[shell]\nwidth_mm = 14\n";
    std::fs::write(folder.path().join("mine.toml"), text).unwrap();
    let preview = Preview::start(folder.path(), "mine.toml");
    let page = preview.request("GET /", &preview.host());
    let policy = page.lines().find_map(|l| l.strip_prefix("content-security-policy: ")).unwrap();
    assert!(page.contains(&format!("content=\"{policy}\"")));
    let start = preview.request("GET /start", &preview.host());
    let start: serde_json::Value = serde_json::from_str(start.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(start["source"]["file"], "mine.toml");
    assert_eq!(start["values"]["layout.pins"], serde_json::json!([5, 8, 11]));

    let shown = post(&preview, "/answer", r#"{"command": "design", "values": {"segment.grooves": 40}}"#);
    let shown: serde_json::Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(shown["trouble"]["field"], "segment.grooves");
    let change = &shown["trouble"]["changes"][0];
    let fixed = serde_json::json!({"command": "design", "values": {change["path"].as_str().unwrap(): change["value"]}});
    let shown = post(&preview, "/answer", &fixed.to_string());
    assert!(shown.contains(r#""trouble":null"#), "{shown:.300}");

    let mut values = start["values"].clone();
    values["shell.width_mm"] = 12.5.into();
    values["layout.pins"] = serde_json::json!([5, 11]);
    let stamp = start["stamp"].clone();
    let save = |values: &serde_json::Value, stamp: &serde_json::Value| -> serde_json::Value {
        let request = serde_json::json!({ "values": values, "stamp": stamp });
        serde_json::from_str(&post(&preview, "/save", &request.to_string())).unwrap()
    };
    let saved = save(&values, &stamp);
    assert_eq!(saved["saved"], "mine.toml");
    let now = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    let wanted = text.replace("[5, 8, 11]", "[5, 11]").replace("width_mm = 14", "width_mm = 12.5");
    assert_eq!(now, wanted, "the name of the file is not written into it");
    // With the old stamp the file counts as changed: it is not written, and its values are
    // returned.
    values["switch.name"] = "other".into();
    let refused = save(&values, &stamp);
    assert_eq!(refused["changed"]["stamp"], saved["stamp"]);
    assert_eq!(refused["changed"]["values"]["layout.pins"], serde_json::json!([5, 11]));
    assert_eq!(refused["changed"]["values"]["switch.name"], "mine");
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.toml")).unwrap(), now);
    save(&values, &saved["stamp"]);
    let now = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    assert_eq!(now, format!("{wanted}\n[switch]\nname = \"other\"\n"));
    for bad in ["", "{}", r#"{"values": {"shell.width_mm": 1e9}}"#, r#"{"values": {"x": 1}}"#] {
        assert!(post(&preview, "/save", bad).contains("error"), "{bad}");
        assert!(post(&preview, "/answer", bad).contains("error"), "{bad}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.toml")).unwrap(), now);
    // Other origins cannot save.
    let foreign = format!("{}Origin: http://evil.example\r\nContent-Length: 2\r\n\r\n{{}}", preview.host());
    assert!(preview.request("POST /save", &foreign).starts_with("HTTP/1.1 403"));
}

/// A search of many seconds, among 40 grooves.
const LONG_SEARCH: &str = r#"{"command": "search", "values": {"segment.grooves": 40, "shell.outer_radius_mm": 45}, "threshold_n": 24}"#;

/// Waits until `condition` is true; returns whether it is within 30 s.
fn becomes_true(condition: impl Fn() -> bool) -> bool {
    (0..600).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        condition()
    })
}

#[test]
fn a_search_delays_no_design() {
    let folder = tempfile::tempdir().unwrap();
    let preview = Preview::start(folder.path(), "three-double");
    if preview.children().is_none() {
        eprintln!("SKIPPED: the system does not list the children of a process");
        return;
    }
    let has_children = |number: usize| becomes_true(|| preview.children() == Some(number));
    let mut stream = preview.connect();
    write!(stream, "POST /answer HTTP/1.1\r\n{}", with_headers(&preview, LONG_SEARCH)).unwrap();
    assert!(has_children(1), "a search is a process");
    let design = post(&preview, "/answer", r#"{"command": "design", "values": {}}"#);
    assert!(design.contains(r#""trouble":null"#), "{design:.300}");
    assert_eq!(preview.children(), Some(1), "a design is answered during the search");
    drop(stream);
    assert!(has_children(0), "the search ends when no one waits for it");
}

#[test]
fn a_worker_ends_with_its_input() {
    let answer = |request: &str, keeps_input_open: bool| {
        let piped = std::process::Stdio::piped;
        let mut child = binary().args(["-q", "answer"]).stdin(piped()).stdout(piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        write!(stdin, "{}\n{request}", request.len()).unwrap();
        let open = keeps_input_open.then_some(stdin);
        let output = child.wait_with_output().unwrap();
        drop(open);
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, text) = answer(r#"{"command": "search", "values": {}, "threshold_n": 24}"#, true);
    assert!(code == Some(0) && text.contains("layout.pins"), "{code:?} {text:.300}");
    assert_eq!(answer(LONG_SEARCH, false), (Some(1), String::new()), "its input is closed");
}

#[test]
fn headers_and_connections_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let preview = Preview::start(folder.path(), "three-double");
    let host = preview.host();
    let answer = preview.request("GET /", &format!("{host}X: {}\r\n", "x".repeat(1_000_000)));
    assert!(!answer.starts_with("HTTP/1.1 200"), "{answer:.200}");
    let many: String = (0..1000).map(|i| format!("X-{i}: x\r\n")).collect();
    let answer = preview.request("GET /", &format!("{host}{many}"));
    assert!(!answer.starts_with("HTTP/1.1 200"), "{answer:.200}");

    let known = preview.state("")["version"].as_str().unwrap().to_owned();
    let before = preview.threads();
    let waiting: Vec<_> = (0..50)
        .map(|_| {
            let mut stream = preview.connect();
            write!(stream, "GET /start?after={known} HTTP/1.1\r\n{host}\r\n").unwrap();
            stream
        })
        .collect();
    // The page is served meanwhile, and waiting requests need no threads.
    assert!(preview.request("GET /", &host).starts_with("HTTP/1.1 200"));
    assert!(preview.threads() <= before + 2, "{before} threads became {}", preview.threads());
    assert!(preview.request(&format!("GET /start?after={known}"), &host).starts_with("HTTP/1.1 503"));
    drop(waiting);
}

#[test]
fn a_partial_save_is_not_shown() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["init", "three-double", "--out", "mine.toml"]);
    let file = folder.path().join("mine.toml");
    let good = std::fs::read_to_string(&file).unwrap();
    let preview = Preview::start(folder.path(), "mine.toml");
    let first = preview.state("");
    assert_eq!(first["values"]["layout.pins"], serde_json::json!([5, 8, 11]));
    let changed = good.replace("[5, 8, 11]", "[6, 8, 10]");
    // An editor that truncates the file and writes it in pieces.
    let mut writer = std::fs::File::create(&file).unwrap();
    for piece in changed.as_bytes().chunks(changed.len() / 4 + 1) {
        std::thread::sleep(Duration::from_millis(60));
        writer.write_all(piece).unwrap();
    }
    drop(writer);
    let state = preview.state(first["version"].as_str().unwrap());
    assert!(state["version"].as_str().unwrap().starts_with("2-"), "{}", state["version"]);
    assert_eq!(state["values"]["layout.pins"], serde_json::json!([6, 8, 10]), "{}", state["trouble"]);
    // A save that is never completed.
    std::fs::write(&file, "").unwrap();
    let state = preview.state(state["version"].as_str().unwrap());
    assert!(state["trouble"].as_str().unwrap().contains("empty"), "{}", state["trouble"]);
    assert_eq!(state["values"]["layout.pins"], serde_json::json!([6, 8, 10]));
}

#[test]
fn an_invalid_save_keeps_the_last_version() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["init", "three-double", "--out", "mine.toml"]);
    let preview = Preview::start(folder.path(), "mine.toml");
    let file = folder.path().join("mine.toml");
    let good = std::fs::read_to_string(&file).unwrap();
    let after = |version: &serde_json::Value| preview.state(version.as_str().unwrap());
    let first = preview.state("");
    std::fs::write(&file, good.replace("[5, 8, 11]", "[5, 99]")).unwrap();
    let state = after(&first["version"]);
    assert!(state["trouble"].as_str().unwrap().contains("layout.pins"), "{}", state["trouble"]);
    assert_eq!(state["values"], first["values"]);
    std::fs::write(&file, &good).unwrap();
    let state = after(&state["version"]);
    assert!(state["trouble"].is_null(), "{}", state["trouble"]);
    assert_eq!(state["stamp"], first["stamp"]);
}

#[test]
fn a_port_in_use_is_refused() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = binary().args(["view", "three-double", "--port", &port]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("give another port"));
}
