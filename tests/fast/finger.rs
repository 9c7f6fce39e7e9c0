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

const JOINT: &str = "[switch]\nname = \"jointed\"\n[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"joint\"\n";

/// The wrap over the joint is that of the parts, between the stops, on one side of the segment.
#[test]
fn a_joint_determines_the_wrap() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("joint.toml"), JOINT).unwrap();
    let report = json(folder.path(), &["finger", "joint.toml", "--json"]);
    assert_eq!(report.get("joint_path"), None, "nothing about the path is assumed");
    assert!(!report["assumptions"].to_string().contains("pins are centred"), "{report}");
    let layout = &report["layouts"][0];
    assert_eq!(layout["joint"]["flexion_deg"], serde_json::json!([0.0, 75.0]));
    let points = layout["over_joint"][1]["points"].as_array().unwrap();
    let of = |i: usize, key: &str| points[i].get(key).map_or(0.0, |v| v.as_f64().unwrap());
    assert_eq!((points.len(), of(0, "joint_deg"), of(75, "joint_deg")), (76, 0.0, 75.0));
    // Pins deflect the tendon by less than 3 degrees.
    assert!((0..76).all(|i| (of(i, "wrap_deg") - of(i, "joint_deg")).abs() < 3.0));
    assert!((0..76).all(|i| of(i, "joint_deg") > 60.0 || of(i, "wrap_middle_deg") > 0.0));
    // The pins at 17.9, 0 and -17.9 degrees enter one after the other, from 31.9 degrees.
    let pins: Vec<f64> = [10, 20, 40, 60].map(|i| of(i, "pins")).to_vec();
    assert_eq!(pins, [0.0, 1.0, 2.0, 3.0]);
    // At the flexion of the layout's wrap, the gains are those of the layout, within the error of the solver.
    let at = json(folder.path(), &["finger", "joint.toml", "--joint", "63.89", "--json"]);
    let straight = share(layout["points"].as_array().unwrap().last().unwrap(), "force_difference");
    let bent = share(&at["layouts"][0]["over_joint"][1]["points"][0], "force_difference");
    assert!(straight.iter().zip(bent).all(|(a, b)| (a - b).abs() < 1e-7), "{straight:?} {bent:?}");
    let printed = done(folder.path(), &["-q", "finger", "joint.toml", "three-double", "--out", "a"]);
    for words in
        ["joint of jointed: at 0 to 75 deg", "moment arm", "assumed: three-double: the tendon runs straight"]
    {
        assert!(printed.contains(words), "{words}: {printed}");
    }
    let svg = std::fs::read_to_string(folder.path().join("a/finger.svg")).unwrap();
    assert!(svg.contains("jointed (joint as built)"));
}

#[test]
fn assumptions_about_a_joint_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("joint.toml"), JOINT).unwrap();
    for (arguments, words) in [
        (&["--wrap-at-straight", "5"][..], "--wrap-at-straight = 5: joint.toml has a joint"),
        (&["--wrap-per-flexion", "0.5"], "--wrap-per-flexion = 0.5: joint.toml has a joint"),
        (&["--joint", "0..89"], "joint angle (deg) = 89: must be from 0 to 75"),
    ] {
        let all = [&["finger", "three-double", "joint.toml"], arguments, &["--out", "x"]].concat();
        let output = pinswitch(folder.path(), &all);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
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
