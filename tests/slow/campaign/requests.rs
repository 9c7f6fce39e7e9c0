//! Damaged requests of the configurator, to its engine and over connections to its server.

use rand::RngExt;

use super::{campaign, damage};

/// Requests of the configurator's page, to damage.
const REQUESTS: [&str; 10] = [
    r#"{"command": "facts"}"#,
    r#"{"command": "design", "values": {"shell.width_mm": 14, "layout.pins": [5, 8, 11]}}"#,
    r#"{"command": "design", "values": {"segment.grooves": 40, "switch.name": "mine"}, "quality": "draft"}"#,
    r#"{"command": "open", "toml": "[shell]\nwidth_mm = 14\n", "file": "mine.toml"}"#,
    r#"{"command": "files", "values": {"mould.kind": "none"}}"#,
    r#"{"command": "file", "values": {}, "name": "shell.stl"}"#,
    r#"{"command": "model", "toml": "schema = \"x\"\n", "file": "model.toml"}"#,
    r#"{"command": "import", "data": "dDtGCjA7MQoxOzIK", "file": "a.csv", "set": ["decimal=comma"]}"#,
    r#"{"command": "calibrate", "csv": "series,substrate\n1,abs\n", "file": "t.csv"}"#,
    r#"{"command": "search", "values": {"segment.grooves": 2000}, "threshold_n": 24}"#,
];

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_requests_are_answered_or_refused() {
    campaign("requests of the configurator", 4000, |seed, random| {
        let whole = REQUESTS[random.random_range(0..REQUESTS.len())];
        let bytes = if seed % 50 == 0 { whole.as_bytes().to_vec() } else { damage(random, whole.as_bytes()) };
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let verdict = match pinswitch_app::Engine::default().answer(&text) {
            pinswitch_app::Answer::Bytes(_) => Ok("answered"),
            pinswitch_app::Answer::Json(answer) => match serde_json::from_str::<serde_json::Value>(&answer) {
                Ok(answer) if answer["error"].is_string() => Ok("refused with an error"),
                Ok(_) => Ok("answered"),
                Err(e) => Err(format!("the answer is not JSON: {e}")),
            },
        };
        (bytes, verdict)
    });
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn the_server_survives_damaged_connections() {
    use std::io::{Read, Write};
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "[shell]\nwidth_mm = 14\n").unwrap();
    let preview = crate::harness::preview::Preview::start(folder.path(), "mine.toml");
    let own = format!("{}Origin: http://{}\r\n", preview.host(), preview.address);
    let whole: Vec<String> = REQUESTS
        .iter()
        .map(|body| format!("POST /answer HTTP/1.1\r\n{own}Content-Length: {}\r\n\r\n{body}", body.len()))
        .chain(["/", "/start", "/start?after=x"].map(|path| format!("GET {path} HTTP/1.1\r\n{own}\r\n")))
        .chain([format!(
            "POST /save HTTP/1.1\r\n{own}Content-Length: 33\r\n\r\n{{\"values\": {{\"shell.width_mm\": 13}}}}"
        )])
        .collect();
    campaign("connections to the server", 3000, |seed, random| {
        let chosen = &whole[random.random_range(0..whole.len())];
        let bytes = damage(random, chosen.as_bytes());
        let mut stream = preview.connect();
        let _ = stream.set_read_timeout(Some(std::time::Duration::from_millis(20)));
        let _ = stream.write_all(&bytes);
        let mut begin = [0; 12];
        let read = stream.read(&mut begin).unwrap_or(0);
        let verdict = match &begin[..read] {
            [] => Ok("left without an answer"),
            begin if begin.starts_with(b"HTTP/1") => Ok("answered"),
            other => Err(format!("{:?}", String::from_utf8_lossy(other))),
        };
        drop(stream);
        let is_alive = seed % 100 != 0 || preview.get("/").contains("<html");
        (bytes, if is_alive { verdict } else { Err("the server does not answer any more".to_owned()) })
    });
    assert!(preview.get("/").contains("<html"));
    let text = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    assert!(text.contains("width_mm"), "{text}");
    if let Some(kilobytes) = preview.peak_memory_kb() {
        println!("largest memory of the server: {} MB", kilobytes / 1000);
        assert!(kilobytes < 600_000, "{kilobytes} kB");
    }
}
