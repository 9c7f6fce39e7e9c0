//! Files of the wrong kind or with invalid content: each gives one short error with help, and exit
//! code 2.

use crate::harness::{done, ended, files, repository, with_sweep};
use crate::readers::{LONGEST, RIG};

#[test]
fn edited_models_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    done(
        folder.path(),
        &["-q", "simulate", "--randomised", "--effect", "load_cell_offset=0.8", "--out", "rig"],
    );
    done(folder.path(), &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibrated"]);
    let model = std::fs::read_to_string(folder.path().join("calibrated/model.toml")).unwrap();
    let predict = |text: &str| {
        std::fs::write(folder.path().join("edited.toml"), text).unwrap();
        ended(folder.path(), &["predict", "--model", "edited.toml", "--rows", "rig/plateaus.csv"])
    };
    assert_eq!(predict(&model).0, Some(0));
    // The model with another value of one key.
    let edited = |key: &str, value: &str| {
        let line = model.lines().find(|l| l.starts_with(&format!("{key} = "))).unwrap().to_owned();
        model.replacen(&line, &format!("{key} = {value}"), 1)
    };
    for (key, value) in [
        ("value", "inf"),
        ("value", "nan"),
        ("value", "-1.0"),
        ("value", "1e300"),
        ("name", "\"other\""),
        ("correlation", "7.0"),
        ("stroke_mm", "0.0"),
        ("stroke_mm", "-inf"),
        ("reference_speed_pct", "0.0"),
        ("wrap_rad", "1e9"),
        ("schema", "\"pinswitch.model/99\""),
        ("covariance", "[[1.0]]"),
    ] {
        let (code, output) = predict(&edited(key, value));
        assert_eq!(code, Some(2), "{key} = {value}: {output:.600}");
        assert!(output.contains("edited.toml:"), "{key} = {value}: {output}");
        assert!(output.chars().count() <= LONGEST + 20, "{key} = {value}: {output}");
    }
}

#[test]
fn binary_files_have_their_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.toml"), b"[shell]\nwidth_mm = \"\xff\"\n").unwrap();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("base.toml", "[sweep]\nbase = \"bad.toml\"\n[axes]\n\"shell.width_mm\" = [14]\n");
    write("rows.toml", "[rows]\nfile = \"bad.toml\"\n");
    write("run.toml", &RIG.replace("a.csv", "folder"));
    let model = repository("tests/corpus/model/accepted-baseline.toml");
    std::fs::copy(model, folder.path().join("model.toml")).unwrap();
    for arguments in [
        &["generate", "bad.toml"][..],
        &["predict", "--model", "bad.toml", "--rows", "bad.toml"],
        &["simulate", "bad.toml", "--out", "x"],
        &["design", "--request", "bad.toml"],
        &["batch", "bad.toml", "--dry-run"],
        &["batch", "base.toml", "--dry-run"],
        &["batch", "rows.toml", "--dry-run"],
        &["segment", "bad.toml", "--out", "t.csv"],
    ] {
        let (code, output) = ended(folder.path(), arguments);
        assert!(
            code == Some(2) && output.contains("bad.toml:2: byte 0xff") && output.contains("UTF-8"),
            "{arguments:?}: {output}"
        );
    }
    for arguments in [
        &["generate", "folder"][..],
        &["calibrate", "folder", "--out", "x"],
        &["predict", "--model", "model.toml", "--rows", "folder"],
        &["segment", "run.toml", "--out", "t.csv"],
    ] {
        let (code, output) = ended(folder.path(), arguments);
        assert!(
            code == Some(2) && output.contains("folder: is a folder [not-a-file]\n  help: give a file"),
            "{arguments:?}: {output}"
        );
    }
}

#[test]
fn long_values_give_short_errors() {
    let folder = tempfile::tempdir().unwrap();
    let list = format!("[layout]\npins = [{}]\n", "5, ".repeat(100_000));
    let text = format!("[label]\ntext = \"{}\"\n", "x".repeat(300_000));
    let name = format!("[switch]\nname = \"{}\"\n", "x".repeat(300_000));
    for content in [list, text, name] {
        std::fs::write(folder.path().join("my.toml"), &content).unwrap();
        let (code, output) = ended(folder.path(), &["generate", "my.toml"]);
        assert_eq!(code, Some(2), "{output:.600}");
        assert!(
            output.contains("my.toml:2") && output.chars().count() <= LONGEST,
            "{} {output:.600}",
            output.len()
        );
    }
}

#[test]
fn other_mesh_formats_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    std::fs::write(folder.path().join("a.stl"), b"\x1f\x8b\x08\0\0\0\0\0\0\0").unwrap();
    std::fs::write(folder.path().join("a.obj"), "# cube\nv 0 0 0\n".repeat(20)).unwrap();
    for (file, word) in [("a.stl", "gzip"), ("a.obj", "OBJ")] {
        let (code, output) = ended(folder.path(), &["check", file]);
        assert!(code == Some(2) && output.contains(word), "{file}: {output}");
    }
    for entry in std::fs::read_dir(folder.path().join("set")).unwrap() {
        let path = entry.unwrap().path();
        let kind = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let word = match kind.as_str() {
            "dxf" => "DXF",
            "pdf" => "PDF",
            _ => continue,
        };
        let (code, output) = ended(folder.path(), &["check", &path.to_string_lossy()]);
        assert!(code == Some(2) && output.contains(word), "{}: {output}", path.display());
    }
}

#[test]
fn files_of_other_commands_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let requests = repository("templates/requests");
    let mut given: Vec<_> = files(&requests)
        .into_keys()
        .map(|name| (requests.join(name).display().to_string(), "design --request"))
        .collect();
    for (kind, command) in [
        ("sweep", "batch"),
        ("plan", "simulate"),
        ("run", "segment"),
        ("rig", "experiment"),
        ("effects", "--effects"),
        ("import", "import"),
    ] {
        let file = format!("{kind}.toml");
        done(folder.path(), &["-q", "init", kind, "--out", &file]);
        given.push((file, command));
    }
    assert!(given.len() > 6);
    for (file, command) in given {
        let (code, output) = ended(folder.path(), &["generate", &file]);
        assert!(
            code == Some(2) && output.contains(command) && output.contains("not a configuration"),
            "{file}: {output}"
        );
    }
}

#[test]
fn sweeps_read_within_their_folder() {
    let sweep = "[sweep]\nbase = \"BASE\"\n[axes]\n\"shell.width_mm\" = [14, 15]\n";
    let folder = with_sweep("");
    let below = folder.path().join("below");
    std::fs::create_dir_all(below.join("deeper")).unwrap();
    std::fs::write(folder.path().join("outside.toml"), "[shell]\nwall_mm = 3\n").unwrap();
    std::fs::write(below.join("deeper/inside.toml"), "[shell]\nwall_mm = 3\n").unwrap();
    let absolute = folder.path().join("outside.toml").display().to_string();
    for (base, code) in
        [("../outside.toml", 2), (absolute.as_str(), 2), ("deeper/inside.toml", 0), ("three-double", 0)]
    {
        std::fs::write(below.join("sweep.toml"), sweep.replace("BASE", base)).unwrap();
        for from in [(&below, "sweep.toml"), (&folder.path().to_owned(), "below/sweep.toml")] {
            let (ended_with, output) = ended(from.0, &["batch", from.1, "--dry-run"]);
            assert_eq!(ended_with, Some(code), "{base}: {output}");
            assert!(code == 0 || output.contains("--read-outside"), "{base}: {output}");
            assert_eq!(ended(from.0, &["batch", from.1, "--dry-run", "--read-outside"]).0, Some(0), "{base}");
        }
    }
}
