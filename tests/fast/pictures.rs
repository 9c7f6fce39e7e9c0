//! The pictures of README and the documents match the output of the program.
//!
//! `PINSWITCH_ACCEPT=1 cargo test --test fast pictures` makes all of them again; the three
//! photographs of pages need chromium. Without it the test compares drawings byte for byte, and
//! photographs by the hash of the page they show.

use std::path::Path;
use std::process::Command;

use crate::harness::preview::Preview;
use crate::harness::{browser, done, repository, sha256};

/// Pictures in `cad/doc`, and the files of a run that they are copies of.
const DRAWN: [(&str, &str); 10] = [
    ("exploded.png", "out/three-double/assembly.png"),
    ("plate.png", "out/three-double/plate.png"),
    ("step-layer.png", "out/three-double/step-9.png"),
    ("step-pins.png", "out/three-double/step-12.png"),
    ("step-tendon.png", "out/three-double/step-15.png"),
    ("friction.svg", "out/three-double/friction.svg"),
    ("contact.svg", "physics/contact.svg"),
    ("pareto.svg", "designs/pareto.svg"),
    ("finger.svg", "finger/finger.svg"),
    ("sweep.svg", "batch/curves.svg"),
];
/// Photographs in `cad/doc`, the pages that they show, and the sizes of the windows.
const PHOTOGRAPHED: [(&str, &str, &str); 2] = [
    ("page.png", "out/three-double/report.html", "1200,1225"),
    ("calibration.png", "calibrated/report.html", "985,1167"),
];
/// The photograph of the configurator, and the size of its window.
const CONFIGURATOR: (&str, &str) = ("configurator.png", "1200,620");
/// Hashes of the pages that were photographed.
const PAGES: &str = "photographed-pages.sha256";

fn photograph(address: &str, picture: &Path, size: &str) {
    let chromium = browser().expect("photographs need chromium; Debian's package is called chromium");
    let profile = tempfile::tempdir().unwrap();
    let done = Command::new(chromium)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            "--no-first-run",
            // On a first visit the switch moves.
            "--force-prefers-reduced-motion",
        ])
        .args([
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--hide-scrollbars",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(["--virtual-time-budget=6000", &format!("--window-size={size}")])
        .arg(format!("--screenshot={}", picture.display()))
        .arg(address)
        .output()
        .unwrap();
    assert!(done.status.success() && picture.exists(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn pictures_match_the_output() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str| done(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    run("-q generate three-double");
    run("-q physics three-double --out physics");
    run("-q design --threshold 26 --max-friction 8.5 --pins 3..6 --best 3 --out designs");
    run("-q finger --out finger");
    run("init sweep --out sweep.toml");
    run("-q batch sweep.toml --out batch");
    run("-q simulate --randomised --effect coating_ploughing=0.024 --effect load_cell_offset=0.8 --out rig");
    run("-q calibrate rig/plateaus.csv --out calibrated");
    let documents = repository("cad/doc");
    let accept = std::env::var_os("PINSWITCH_ACCEPT").is_some();
    for (picture, made) in DRAWN {
        let bytes = std::fs::read(folder.path().join(made)).unwrap();
        if accept {
            std::fs::write(documents.join(picture), bytes).unwrap();
        } else {
            assert!(
                std::fs::read(documents.join(picture)).unwrap() == bytes,
                "cad/doc/{picture} is stale: run PINSWITCH_ACCEPT=1 cargo test --test fast pictures"
            );
        }
    }
    let mut pages: String = PHOTOGRAPHED
        .iter()
        .map(|(picture, page, size)| {
            let page = folder.path().join(page);
            if accept {
                photograph(&format!("file://{}", page.display()), &documents.join(picture), size);
            }
            format!("{}  {picture}\n", sha256(&std::fs::read(page).unwrap()))
        })
        .collect();
    let served = Preview::start(folder.path(), "three-double");
    let (picture, size) = CONFIGURATOR;
    if accept {
        photograph(&format!("http://{}/", served.address), &documents.join(picture), size);
    }
    pages.push_str(&format!("{}  {picture}\n", sha256(served.get("/").as_bytes())));
    if accept {
        std::fs::write(documents.join(PAGES), pages).unwrap();
    } else {
        let known = std::fs::read_to_string(documents.join(PAGES)).unwrap();
        assert_eq!(
            known, pages,
            "photographs are stale: run PINSWITCH_ACCEPT=1 cargo test --test fast pictures"
        );
    }
}
