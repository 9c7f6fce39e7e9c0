//! Backwards from a wanted curve, and what the curve buys: the real binary, its designs fed back through `predict`.

use crate::harness::{json, pinswitch};
use serde_json::Value;

fn column(curve: &Value, key: &str) -> Vec<f64> {
    curve[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn designs_meet_what_was_asked_when_predicted_and_generated() {
    let folder = tempfile::tempdir().unwrap();
    let (threshold, friction) = (24.0, 8.5);
    let wanted = [
        "design",
        "--threshold",
        "24",
        "--max-friction",
        "8.5",
        "--pins",
        "3..4",
        "--out",
        "found",
        "--json",
    ];
    let report = json(folder.path(), &wanted);
    let proposals = report["proposals"].as_array().unwrap();
    assert_eq!(proposals.len(), 5);
    assert!(proposals[0]["within_band"].as_bool().unwrap());
    for (i, proposal) in proposals.iter().enumerate() {
        let file = format!("found/design-{}.toml", i + 1);
        let curve = json(folder.path(), &["predict", &file, "--json"]);
        assert_eq!(curve["law"], proposal["law"]);
        let (load, d) = (column(&curve, "load_n"), column(&curve, "friction_n"));
        let (low, high) = (column(&curve, "band_low_n"), column(&curve, "band_high_n"));
        assert!((d.last().unwrap() - proposal["friction_n"].as_f64().unwrap()).abs() < 1e-9);
        // Half of the friction is the silicone's at the threshold that was promised.
        let share = column(&curve, "silicone_share");
        let after = share.iter().position(|s| *s >= 0.5).unwrap();
        let promised = proposal["transition"]["threshold_n"].as_f64().unwrap();
        assert!(load[after - 1] <= promised && promised <= load[after], "{promised}");
        if proposal["within_band"].as_bool().unwrap() {
            assert!(*low.last().unwrap() <= friction && friction <= *high.last().unwrap());
            let transition = &proposal["transition"];
            let (from, to) = (transition["low_n"].as_f64().unwrap(), transition["high_n"].as_f64().unwrap());
            assert!(from <= threshold && threshold <= to);
        }
    }
    let made = pinswitch(folder.path(), &["generate", "found/design-1.toml", "--out", "parts"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(folder.path().join("found/pareto.svg").exists());
}

#[test]
fn a_tuned_pitch_comes_closer() {
    let folder = tempfile::tempdir().unwrap();
    let best = |extra: &[&str]| {
        let asked = ["design", "--threshold", "22", "--pins", "3", "--best", "1", "--json"];
        let proposal = json(folder.path(), &[&asked, extra].concat())["proposals"][0].clone();
        let number = |key: &str| proposal[key].as_f64().unwrap();
        (number("expected_miss"), number("span_deg"))
    };
    let (plain, tuned) = (best(&[]), best(&["--tune"]));
    // A pitch of its own, and closer for it: a tuning that did nothing would end where it began.
    assert!((tuned.1 - plain.1).abs() > 0.5 && tuned.0 < 0.97 * plain.0, "{plain:?} {tuned:?}");
}

#[test]
fn wishes_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, word) in [
        (&["design", "--threshold=-1"][..], "--threshold = -1"),
        (&["design", "--max-friction", "NaN"], "--max-friction = NaN"),
        (&["design", "--threshold", "20", "--pins", "6..3"], "runs backwards"),
        (&["design", "--threshold", "20", "--pins", "0..3"], "1 to 15 pins"),
        (&["design", "--threshold", "20", "--load-range", "50..3"], "runs backwards"),
        (&["design"], "--threshold"),
        (
            &["predict", "three-double", "--set", "layout.pins=[2,3,9]", "--law", "paper"],
            "six-single, three-double",
        ),
        (&["predict", "proxy-six-single", "--law", "layout"], "pins on silicone only"),
        (&["physics", "silicone-only", "--out", "x"], "pins on silicone"),
    ] {
        let output = pinswitch(folder.path(), arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_physics_shows_its_constants_and_its_misses() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &["physics", "--out", "shown", "--json"]);
    assert!(report["fit"]["rms"].as_f64().unwrap() <= 0.04);
    let surviving: Vec<_> = report["hypotheses"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|h| h["contradicts"].as_array().unwrap().is_empty())
        .map(|h| h["hypothesis"]["name"].as_str().unwrap())
        .collect();
    assert_eq!(surviving, ["free, pins soften as they sink"]);
    assert!(folder.path().join("shown/contact.svg").exists());
}
