//! The page of a set in Chromium: it renders, its controls work, and it logs no error.

use crate::harness::browser;
use crate::harness::preview::Preview;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// Moves every control and writes the failures into the title.
const EXERCISE: &str = r#"<script>
addEventListener('load', () => setTimeout(() => {
  const set = (id, value) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event('input')); };
  const seen = {};
  const first = document.getElementById('load-value').textContent;
  set('load', 0.2);
  seen.load = document.getElementById('load-value').textContent !== first;
  const pin = () => assembly.bodies.find((n) => n.userData.body.name === 'pin-2').matrix.elements.slice(12, 15).join();
  const light = pin();
  set('load', 1);
  seen.sinks = pin() !== light;
  const shell = () => assembly.bodies.find((n) => n.userData.body.name === 'support-right').matrix.elements[14];
  const home = shell();
  set('explode', 1);
  seen.apart = shell() !== home;
  // Exploded, every corner of every mesh is in the picture; the camera moves before the next frame.
  assembly.camera.updateMatrixWorld();
  seen.framed = assembly.group.children.every(({ children: [mesh] }) => {
    const { array } = mesh.geometry.getAttribute('position');
    for (let i = 0; i < array.length; i += 3) {
      const corner = new THREE.Vector3(array[i], array[i + 1], array[i + 2]).applyMatrix4(mesh.matrixWorld).project(assembly.camera);
      if (Math.abs(corner.x) > 1 || Math.abs(corner.y) > 1) return false;
    }
    return array.length > 0;
  });
  const eye = assembly.camera.position.x;
  set('turn', 120); set('tilt', -20);
  seen.turned = assembly.camera.position.x !== eye;
  const section = document.getElementById('section');
  section.checked = true; section.dispatchEvent(new Event('input'));
  seen.cut = assembly.bodies.every((n) => n.userData.materials.every((m) => m.clippingPlanes.length === 1));
  seen.capped = assembly.bodies.every((n) => n.userData.cover.visible && n.userData.counted.every((c) => c.visible));
  const box = document.querySelector('#bodies input');
  box.click();
  seen.hidden = !assembly.bodies[0].visible && !assembly.bodies[0].userData.cover.visible;
  const offered = [...document.querySelectorAll('#files a[download], #files button')].map((e) => e.textContent);
  seen.files = current.manifest.files.every((f) => f.file === 'report.html' || offered.some((text) => text.endsWith(f.file)));
  seen.canvas = document.querySelectorAll('canvas').length === 2;
  seen.rows = document.querySelectorAll('#table tbody tr').length === 101;
  seen.saves = document.querySelectorAll('#files button').length === 10;
  seen.labels = [...document.querySelectorAll('input')].every((i) => i.labels.length === 1);
  seen.errors = document.body.dataset.errors === '0';
  document.title = 'exercised ' + Object.entries(seen).filter(([, ok]) => !ok).map(([name]) => name).join(' ') + ' end';
}, 300));
</script>"#;

/// Opens a file in a headless browser and returns its standard output.
fn browse(name: &str, file: &Path, extra: &[&str]) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(name)
        .args([
            "--headless",
            "--no-sandbox",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
        ])
        .args(["--virtual-time-budget=8000", "--window-size=1200,1900"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(extra)
        .arg(format!("file://{}", file.display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn pinswitch(folder: &Path, arguments: &[&str]) {
    let output = crate::harness::binary().args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_controls_of_a_page_work() {
    let Some(name) = browser() else {
        crate::harness::report_skipped("no chromium here; Debian's package is called chromium");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    pinswitch(folder.path(), &["generate", "three-double", "--out", "set"]);
    let page = std::fs::read_to_string(folder.path().join("set/report.html")).unwrap();
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    // With its content security policy, the page's scripts fill the table, and an inserted script
    // does not run.
    let inserted = folder.path().join("inserted.html");
    std::fs::write(&inserted, page.replace("</body>", &format!("{EXERCISE}</body>"))).unwrap();
    let dom = browse(name, &inserted, &["--dump-dom"]);
    assert!(dom.matches("<tr").count() > 101, "the page's own scripts did not run");
    assert!(!dom.contains("<title>exercised"), "an inserted script ran");
    // Without the policy the inserted script runs.
    let exercised = folder.path().join("exercised.html");
    let policy = page.find("<meta http-equiv=\"Content-Security-Policy\"").unwrap();
    let end = policy + page[policy..].find('>').unwrap() + 1;
    let open = format!("{}{}", &page[..policy], &page[end..]);
    std::fs::write(&exercised, open.replace("</body>", &format!("{EXERCISE}</body>"))).unwrap();
    let dom = browse(name, &exercised, &["--dump-dom"]);
    let title = dom.split("<title>").nth(1).and_then(|t| t.split("</title>").next()).unwrap_or("no title");
    assert_eq!(title.split_whitespace().collect::<Vec<_>>(), ["exercised", "end"], "these controls failed");
    // Screenshots in both colour schemes, for a person to look at.
    let pictures = crate::harness::repository("out/page");
    std::fs::create_dir_all(&pictures).unwrap();
    for (mode, flag) in [
        ("light", "--blink-settings=preferredColorScheme=1"),
        ("dark", "--blink-settings=preferredColorScheme=0"),
    ] {
        let picture = pictures.join(format!("{mode}.png"));
        browse(
            name,
            &folder.path().join("set/report.html"),
            &[flag, &format!("--screenshot={}", picture.display())],
        );
        assert!(std::fs::metadata(&picture).unwrap().len() > 30_000, "{mode}: an empty picture");
    }
}

#[test]
fn the_page_follows_its_file() {
    let folder = tempfile::tempdir().unwrap();
    pinswitch(folder.path(), &["init", "three-double", "--out", "mine.toml"]);
    let preview = Preview::start(folder.path(), "mine.toml");
    assert!(preview.get("/").contains("<!doctype html>"));
    let file = folder.path().join("mine.toml");
    let good = std::fs::read_to_string(&file).unwrap();

    std::fs::write(&file, good.replace("[5, 8, 11]", "[6, 8, 10]")).unwrap();
    let start = Instant::now();
    let state = preview.state(1);
    println!("a changed parameter is shown after {:?}", start.elapsed());
    assert_eq!(state["version"], 2);
    assert!(state["data"]["layout"].as_str().unwrap().contains("3 of 15: 6 8 10"));

    std::fs::write(&file, good.replace("[5, 8, 11]", "[5, 99]")).unwrap();
    let state = preview.state(2);
    assert!(state["trouble"].as_str().unwrap().contains("layout.pins"), "{}", state["trouble"]);
    assert!(state["data"].is_null());
    // The page still shows the last valid version.
    assert!(preview.get("/").contains("3 of 15: 6 8 10"));

    std::fs::write(&file, &good).unwrap();
    let state = preview.state(3);
    assert!(
        state["trouble"].is_null() && state["data"]["layout"].as_str().unwrap().contains("3 of 15: 5 8 11")
    );
}

#[test]
fn a_port_in_use_is_refused() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = crate::harness::binary().args(["view", "three-double", "--port", &port]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("give another port"));
}
