//! Conditions on the tests of user-defined effects: an effect must not hide what a table shows
//! without it, be refuted for a slightly different place, or represent something unidentifiable.
//! Tables of an independent simulator (`tests/data/trials`): five conditions mounted twice each,
//! 840 rows; the forms were derived from an earlier session.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::undeclared_effect::unpack;
use crate::harness::{expect_code, repository};

fn form(name: &str) -> PathBuf {
    repository("tests/data/trials").join(format!("{name}.toml"))
}

/// Returns the report on a table of `tests/data/trials`, with or without a file of effects.
fn report_on(table: &str, effects: Option<&Path>, at: &Path) -> Value {
    let out = at.join(format!("out-{}", effects.is_some()));
    let table = unpack(&format!("trials/{table}"), at);
    let mut arguments =
        vec![OsStr::new("calibrate"), table.as_os_str(), OsStr::new("--out"), out.as_os_str()];
    if let Some(file) = effects {
        arguments.extend([OsStr::new("--effects"), file.as_os_str()]);
    }
    expect_code(0, Path::new("."), &arguments);
    serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap()
}

fn heldout_n(report: &Value) -> f64 {
    report["augmented"]["heldout_rmse_N"].as_f64().unwrap()
}

/// A worn spot that grows with time: its form, a constant spot, is confirmed, which once discarded
/// everything else. A step of 10 % of friction, which mounts that differ hide: with two waves of another
/// session, which are not confirmed here, the verdict once was `none`.
#[test]
fn an_effect_hides_no_other() {
    for (table, effects, outcome, verdict) in [
        ("growing-spot", "growing-spot", "confirmed", "unattributed"),
        ("step", "two-waves", "refuted", "inconclusive"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let file = form(effects);
        let without = report_on(table, None, folder.path());
        let with = report_on(table, Some(&file), folder.path());
        assert_eq!(without["verdict"], verdict, "{table}");
        assert_ne!(with["verdict"], "none", "{table}");
        assert_eq!(with["trials"][0]["outcome"], outcome, "{table}: {}", with["trials"]);
        assert!(heldout_n(&with) <= 1.25 * heldout_n(&without), "{table}: {}", heldout_n(&with));
    }
}

/// A table does not locate a step between two series: derived at 0.50 of the session, it is at 0.55
/// in both.
#[test]
fn nearby_effects_are_not_refuted() {
    let folder = tempfile::tempdir().unwrap();
    let report = report_on("silicone-step", Some(&form("silicone-step")), folder.path());
    let trial = &report["trials"][0];
    assert_eq!(trial["outcome"], "open", "{trial}");
    assert!(trial["note"].as_str().unwrap().contains("nearby"), "{trial}");
}

/// Friction that differs by a tenth between operators: derived as a level of one of them, and
/// confirmed by the next session.
#[test]
fn operator_levels_are_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    let first = report_on("operators", None, folder.path());
    let form = &first["effects"][0]["form"];
    assert_eq!((&first["verdict"], &form["shape"]), (&"unattributed".into(), &"groups".into()), "{first}");
    let derived = folder.path().join("derived.toml");
    std::fs::copy(folder.path().join("out-false/discovered.toml"), &derived).unwrap();
    let next = report_on("operators-next", Some(&derived), folder.path());
    assert_eq!(next["trials"][0]["outcome"], "confirmed", "{}", next["trials"]);
    let size = next["trials"][0]["size"]["value"].as_f64().unwrap();
    assert!((0.08..0.12).contains(&size.abs()), "{size}");
}
