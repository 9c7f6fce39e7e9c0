//! `finger`: the shares compared with their curve, over the joint angle, and the files.

use crate::harness::{done, json, pinswitch};
use serde_json::Value;

fn column(curve: &Value, key: &str) -> Vec<f64> {
    curve[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Returns the value, the lower and the upper bound of a share.
fn share(point: &Value, key: &str) -> [f64; 3] {
    ["value", "low", "high"].map(|part| point[key][part].as_f64().unwrap())
}

const SHARES: [&str; 4] = ["force_difference", "extra_holding", "motor_mass_saved", "concentric_penalty"];

#[test]
fn finger_gain_matches_curve() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &["finger", "three-double", "--json"]);
    let curve = json(folder.path(), &["predict", "three-double", "--json"]);
    let points = report["layouts"][0]["points"].as_array().unwrap();
    let [load, e, c, low, high] =
        ["load_n", "eccentric_n", "concentric_n", "band_low_n", "band_high_n"].map(|key| column(&curve, key));
    assert_eq!(points.len(), load.len());
    for (i, point) in points.iter().enumerate() {
        let difference = share(point, "force_difference");
        for (found, expected) in difference.into_iter().zip([(c[i] - e[i]) / 2.0, low[i], high[i]]) {
            assert!((found - 2.0 * expected / load[i]).abs() < 1e-12);
        }
        assert!((share(point, "extra_holding")[0] - (load[i] / e[i] - 1.0)).abs() < 1e-12);
        assert!((share(point, "concentric_penalty")[0] - (c[i] / load[i] - 1.0)).abs() < 1e-12);
        for key in SHARES {
            let [value, low, high] = share(point, key);
            assert!(low <= value + 1e-12 && value <= high + 1e-12, "{key} at {} N", load[i]);
        }
    }
    // The published maximum: 9.667 N at 49.671 N.
    let measured = report["layouts"][0]["measured"][0]["force_difference"].as_f64().unwrap();
    assert!((measured - 2.0 * 9.667 / 49.671).abs() < 1e-4);
    let motor = &report["layouts"][0]["motor"];
    assert_eq!(motor["tension_n"].as_f64().unwrap(), *e.last().unwrap());
    assert!(motor["pulls_n"].as_f64().unwrap() < motor["tension_n"].as_f64().unwrap());
}

#[test]
fn the_wrap_follows_the_joint() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["finger", "silicone-only", "six-single", "--joint", "0..80", "--wrap-at-straight", "5"];
    let report = json(folder.path(), &[&arguments[..], &["--wrap-per-flexion", "0.5", "--json"]].concat());
    for layout in report["layouts"].as_array().unwrap() {
        let curves = layout["over_joint"].as_array().unwrap();
        assert_eq!(curves.len(), 2, "a light and a heavy load");
        for curve in curves {
            assert_eq!(curve["trust"], "extrapolated");
            let points = curve["points"].as_array().unwrap();
            assert_eq!(points.len(), 81);
            for point in points {
                let (joint, wrap) =
                    (point["joint_deg"].as_f64().unwrap(), point["wrap_deg"].as_f64().unwrap());
                assert!((wrap - (5.0 + 0.5 * joint)).abs() < 1e-9);
            }
        }
    }
    // Bare silicone follows the capstan equation: its exponent is proportional to the wrap angle.
    let points = report["layouts"][0]["over_joint"][1]["points"].as_array().unwrap();
    let mu = |point: &Value| {
        (share(point, "force_difference")[0] / 2.0).asinh() / point["wrap_deg"].as_f64().unwrap().to_radians()
    };
    assert!((mu(&points[80]) / mu(&points[1]) - 1.0).abs() < 1e-6);
}

#[test]
fn finger_writes_figure_table_report() {
    let folder = tempfile::tempdir().unwrap();
    let printed = done(folder.path(), &["-q", "finger", "three-double", "silicone-only", "--out", "a"]);
    for word in ["force difference", "extra holding", "measured", "mass saved", "human finger", "assumed:"] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
    done(folder.path(), &["-q", "finger", "three-double", "silicone-only", "--out", "b"]);
    for name in ["finger.svg", "finger.csv", "finger.json"] {
        let read = |run: &str| std::fs::read(folder.path().join(run).join(name)).unwrap();
        assert_eq!(read("a"), read("b"), "{name}");
    }
    let svg = std::fs::read_to_string(folder.path().join("a/finger.svg")).unwrap();
    for word in ["force difference", "extra holding", "flexion of the joint", "human finger", "three-double"]
    {
        assert!(svg.contains(word), "{word}");
    }
    let csv = std::fs::read_to_string(folder.path().join("a/finger.csv")).unwrap();
    let mut lines = csv.lines();
    let cells = lines.next().unwrap().split(',').count();
    assert!(lines.all(|line| line.split(',').count() == cells));
    let report: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a/finger.json")).unwrap()).unwrap();
    assert_eq!(report, json(folder.path(), &["finger", "three-double", "silicone-only", "--json"]));
}

#[test]
fn invalid_fingers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["no-such-template"][..], "no such file or template"),
        (&["--joint", "0..200"], "joint angle (deg) = 200: must be from 0 to 180"),
        (&["--joint=-5..20"], "= -5: must be"),
        (&["--wrap-per-flexion", "3"], "wrap per flexion = 3: must be from 0 to 2"),
        (&["--wrap-at-straight", "NaN"], "wrap at the straight finger (deg) = NaN"),
        (&["--load", "0"], "--load = 0.0: the load is outside"),
    ] {
        let output = pinswitch(folder.path(), &[&["finger"], arguments, &["--out", "x"]].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
