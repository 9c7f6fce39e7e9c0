//! Files of a set other than STL: their content, and equal bytes from every run.

use crate::harness::{done, files};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use serde_json::Value;

fn generate(folder: &Path, arguments: &[&str]) -> BTreeMap<String, Vec<u8>> {
    done(folder, &[&["generate"], arguments, &["--out", "set"]].concat());
    files(&folder.join("set"))
}

#[test]
fn all_formats_repeat_and_are_listed() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let first = generate(a.path(), &["three-single", "--format", "all"]);
    assert_eq!(first, generate(b.path(), &["three-single", "--format", "all"]));
    let manifest: Value = serde_json::from_slice(&first["manifest.json"]).unwrap();
    let listed = manifest["files"].as_array().unwrap().len();
    assert_eq!(listed + 1, first.len());
    for name in [
        "assembly.3mf",
        "assembly.step",
        "shell.step",
        "shell.dxf",
        "drawing.svg",
        "drawing.pdf",
        "drawing.dxf",
        "PRINTING.md",
        "MANUAL.html",
        "MANUAL.pdf",
        "report.html",
    ] {
        assert!(first.contains_key(name), "{name}");
    }
}

#[test]
fn a_chosen_format_is_written_alone() {
    let folder = tempfile::tempdir().unwrap();
    let files = generate(folder.path(), &["three-double", "--format", "3mf"]);
    let names: Vec<_> = files.keys().map(String::as_str).collect();
    assert_eq!(names, ["assembly.3mf", "friction.csv", "friction.svg", "manifest.json"]);
}

#[test]
fn unknown_formats_are_refused() {
    let output =
        crate::harness::binary().args(["generate", "three-double", "--format", "obj"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("possible values: stl, 3mf, step"));
}

#[test]
fn the_package_contains_parts_and_curve() {
    let folder = tempfile::tempdir().unwrap();
    let files = generate(folder.path(), &["three-double", "--format", "stl,3mf"]);
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(&files["assembly.3mf"])).unwrap();
    let mut read = |name: &str| {
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    };
    assert_eq!(read("Metadata/friction.csv"), files["friction.csv"]);
    assert!(read("Metadata/thumbnail.png").starts_with(b"\x89PNG"));
    let model = String::from_utf8(read("3D/3dmodel.model")).unwrap();
    let parts = files.keys().filter(|n| n.ends_with(".stl")).count();
    assert_eq!(model.matches("<object ").count(), parts);
    assert_eq!(model.matches("<item ").count(), parts);
    assert!(model.contains(r#"name="shell" partnumber="three-double/shell""#));
    assert!(model.contains("pins = [5, 8, 11]"), "the configuration is in the package");
}

/// Each step of the assembly has its own picture, whatever parts the switch has.
#[test]
fn every_guide_step_has_a_picture() {
    let rig = [
        "three-double",
        "--set",
        "mount.kind=rig",
        "--set",
        "fasteners.kind=insert",
        "--set",
        "fasteners.dowel_diameter_mm=2",
    ];
    for (source, least) in
        [(&["three-double"][..], 7), (&["silicone-only"], 5), (&["proxy-six-single"], 7), (&rig, 10)]
    {
        let folder = tempfile::tempdir().unwrap();
        let files = generate(folder.path(), &[source, &["--format", "guide"]].concat());
        let guide = std::str::from_utf8(&files["PRINTING.md"]).unwrap();
        let (_, assembly) = guide.split_once(". Assemble\n").unwrap();
        let (assembly, _) = assembly.split_once("\n## ").unwrap();
        let steps = assembly.lines().filter(|line| line.starts_with("### ")).count();
        assert!(steps >= least, "{source:?}: {steps} steps");
        assert_eq!(assembly.matches("](step-").count(), steps, "{source:?}");
        let mut seen = Vec::new();
        let pictures = guide.matches("](step-").count();
        for number in 1..=pictures {
            let name = format!("step-{number}.png");
            assert_eq!(guide.matches(&format!("]({name})")).count(), 1, "{source:?}: {name}");
            assert!(files[&name].starts_with(b"\x89PNG"), "{source:?}: {name}");
            assert!(!seen.contains(&&files[&name]), "{source:?}: {name} is the picture of another step");
            seen.push(&files[&name]);
        }
        assert!(!files.contains_key(&format!("step-{}.png", pictures + 1)), "{source:?}");
    }
}

#[test]
fn step_files_contain_planes_and_cylinders() {
    let folder = tempfile::tempdir().unwrap();
    let files = generate(folder.path(), &["three-double", "--format", "step"]);
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".step")) {
        let text = std::str::from_utf8(bytes).unwrap();
        assert!(text.contains("CYLINDRICAL_SURFACE") && text.contains("CIRCLE"), "{name}");
        assert!(!text.contains("B_SPLINE"), "{name}");
        assert!(text.contains("'1970-01-01T00:00:00'"), "{name}: another time stamp");
    }
}

#[test]
fn the_guide_contains_the_set_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let files =
        generate(folder.path(), &["three-double", "--set", "pins.diameter_mm=0.9", "--format", "guide"]);
    let guide = std::str::from_utf8(&files["PRINTING.md"]).unwrap();
    for words in
        ["pins of 0.9 mm", "grooves 5, 8 and 11", "Weigh 10.0 g of base", "assembly.png", "2 screws M3 x 25"]
    {
        assert!(guide.contains(words), "{words} is missing from\n{guide}");
    }
    assert!(files.contains_key("assembly.png") && files.contains_key("plate.png"));
}
