//! What an effect of one's own may not do: hide what a table shows without it, be refuted for lying a little elsewhere, or stand
//! for what nobody could see. Tables by a simulator of another hand (`tests/data/trials`): five conditions mounted twice each, 840
//! rows; the forms were drawn from a session before.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::undeclared_effect::unpack;
use crate::harness::{expect_code, repository};

fn form(name: &str) -> PathBuf {
    repository("tests/data/trials").join(format!("{name}.toml"))
}

/// The report on a table of `tests/data/trials`, with or without a file of effects.
fn told(table: &str, effects: Option<&Path>, at: &Path) -> Value {
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

/// A worn spot that grows with time: its form, a spot that does not, is confirmed, and all was thrown away with it. A step of 10 %
/// of friction: beside two waves that another session had, and that are refuted here, the verdict was `none`.
#[test]
fn what_a_table_shows_without_an_effect_it_shows_beside_it() {
    for (table, effects, outcome) in
        [("growing-spot", "growing-spot", "confirmed"), ("step", "two-waves", "refuted")]
    {
        let folder = tempfile::tempdir().unwrap();
        let file = form(effects);
        let without = told(table, None, folder.path());
        let with = told(table, Some(&file), folder.path());
        assert_eq!(without["verdict"], "unattributed", "{table}");
        assert_ne!(with["verdict"], "none", "{table}");
        assert_ne!(with["verdict"], "inconclusive", "{table}");
        assert_eq!(with["trials"][0]["outcome"], outcome, "{table}: {}", with["trials"]);
        assert!(heldout_n(&with) <= 1.25 * heldout_n(&without), "{table}: {}", heldout_n(&with));
    }
}

/// Where a step lies between two series no table tells: drawn at 0.50 of the session, it is at 0.55 in both.
#[test]
fn what_lies_close_by_is_not_refuted() {
    let folder = tempfile::tempdir().unwrap();
    let report = told("silicone-step", Some(&form("silicone-step")), folder.path());
    let trial = &report["trials"][0];
    assert_eq!(trial["outcome"], "open", "{trial}");
    assert!(trial["note"].as_str().unwrap().contains("close by"), "{trial}");
}

/// Friction that differs by a tenth from one operator to the other: drawn as a level of one of them, and confirmed by the next
/// session.
#[test]
fn an_operator_is_found_and_found_again() {
    let folder = tempfile::tempdir().unwrap();
    let first = told("operators", None, folder.path());
    let form = &first["effects"][0]["form"];
    assert_eq!((&first["verdict"], &form["shape"]), (&"unattributed".into(), &"groups".into()), "{first}");
    let drawn = folder.path().join("drawn.toml");
    std::fs::copy(folder.path().join("out-false/discovered.toml"), &drawn).unwrap();
    let next = told("operators-next", Some(&drawn), folder.path());
    assert_eq!(next["trials"][0]["outcome"], "confirmed", "{}", next["trials"]);
    let size = next["trials"][0]["size"]["value"].as_f64().unwrap();
    assert!((0.08..0.12).contains(&size.abs()), "{size}");
}
