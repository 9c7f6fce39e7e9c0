//! 3MF, STEP and GLB of a set: validity, exact volumes, and the set generated again from its 3MF.

use crate::harness::step_file::StepFile;
use crate::harness::{done, ended, repository};

/// Returns the bytes of the files of a folder, by name.
fn files(folder: &std::path::Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let entry = |e: std::io::Result<std::fs::DirEntry>| {
        let path = e.unwrap().path();
        (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap())
    };
    std::fs::read_dir(folder).unwrap().map(entry).collect()
}

#[test]
fn written_3mf_is_valid() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-single", "--format", "3mf", "--out", "set"]);
    let (code, output) = ended(folder.path(), &["check", "set/assembly.3mf", "--json"]);
    assert_eq!(code, Some(0), "{output}");
    let manifest = manifest(&folder.path().join("set"));
    let verdicts: serde_json::Value = serde_json::from_str(&output).unwrap();
    let checked = verdicts[0]["parts"].as_array().unwrap();
    let parts = manifest["parts"].as_array().unwrap();
    assert_eq!(checked.len(), parts.len());
    for part in parts {
        let verdict = checked.iter().find(|verdict| verdict["name"] == part["name"]).unwrap();
        let exact = part["volume_mm3"].as_f64().unwrap();
        let volume = verdict["facts"]["volume_mm3"].as_f64().unwrap();
        // Flattened arcs keep their area, so the error is little more than that of single
        // precision.
        assert!((volume / exact - 1.0).abs() < 1e-4, "{}: {volume} for {exact}", part["name"]);
    }
    std::fs::write(folder.path().join("archive.3mf"), "PK\u{3}\u{4} nothing").unwrap();
    let (code, output) = ended(folder.path(), &["check", "archive.3mf"]);
    assert!(code == Some(2) && output.contains("cannot read the ZIP archive"), "{output}");
}

fn manifest(set: &std::path::Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(set.join("manifest.json")).unwrap()).unwrap()
}

/// Every STEP file of a set has closed and oriented shells on exact surfaces and the exact volume
/// of its part, and the assembly contains all parts. The parser of these tests shares no code with
/// the writer.
#[test]
fn step_files_contain_the_exact_parts() {
    let corpus = |name: &str| repository(&format!("tests/corpus/{name}.toml")).display().to_string();
    let sources =
        ["three-single".to_owned(), corpus("hardware-all-at-once"), corpus("hardware-tray-drafted")];
    let mut splines = 0;
    for source in &sources {
        let folder = tempfile::tempdir().unwrap();
        done(folder.path(), &["-q", "generate", source, "--format", "step", "--out", "set"]);
        let set = files(&folder.path().join("set"));
        let read = |name: &str| StepFile::parse(std::str::from_utf8(&set[name]).unwrap()).unwrap();
        let manifest = manifest(&folder.path().join("set"));
        for part in manifest["parts"].as_array().unwrap() {
            let name = part["name"].as_str().unwrap();
            let [solid] = &read(&format!("{name}.step")).solids().unwrap()[..] else {
                panic!("{source}: {name} is not one solid")
            };
            let (exact, volume) = (part["volume_mm3"].as_f64().unwrap(), solid.volume_mm3);
            splines += usize::from(solid.has_splines);
            // Where a draft or a chamfer twists a wall, its spline joins the arcs at equal
            // parameters, not angles.
            let allowed = if solid.has_splines { 1e-5 } else { 1e-9 };
            assert!((volume / exact - 1.0).abs() < allowed, "{source}: {name}: {volume} for {exact}");
            assert_eq!(solid.name, name);
        }
        let assembly = read("assembly.step");
        let solids: Vec<_> = assembly.solids().unwrap().into_iter().map(|s| s.name).collect();
        let placed: Vec<_> = assembly.placements().unwrap().into_iter().map(|p| p.name).collect();
        assert_eq!(solids, placed, "{source}");
        for name in ["shell", "support-left", "support-right", "tendon"] {
            assert!(placed.iter().any(|p| p == name), "{source}: {name} is not among {placed:?}");
        }
    }
    assert!(splines > 0, "no part of these sets has a twisted wall");
}

#[test]
fn check_of_step_suggests_a_converter() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-single", "--format", "step", "--out", "set"]);
    std::fs::write(folder.path().join("text.step"), "ISO-10303-21;\nnothing\n").unwrap();
    for file in ["set/shell.step", "text.step"] {
        let (code, output) = ended(folder.path(), &["check", file]);
        assert_eq!(code, Some(2), "{output}");
        for words in [file, "check does not support STEP", "FreeCAD", "Open CASCADE"] {
            assert!(output.contains(words), "{file}: {words} is missing from {output}");
        }
    }
}

/// Items that overlap cannot be printed, even if each of them is valid.
#[test]
fn overlapping_items_are_not_valid() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/><vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>"#;
    for (name, x, code) in [("apart.3mf", 9, Some(0)), ("inside.3mf", 2, Some(1))] {
        let model = format!(
            r#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1">{mesh}</object></resources><build><item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 {x} 0 0"/></build></model>"#
        );
        let mut archive = zip::ZipWriter::new(std::fs::File::create(folder.path().join(name)).unwrap());
        let parts = [
            (
                "[Content_Types].xml",
                r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#,
            ),
            (
                "_rels/.rels",
                r#"<Relationships><Relationship Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model"/></Relationships>"#,
            ),
            ("3D/3dmodel.model", model.as_str()),
        ];
        for (part, text) in parts {
            archive.start_file(part, zip::write::SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut archive, text.as_bytes()).unwrap();
        }
        archive.finish().unwrap();
        let (exit_code, output) = ended(folder.path(), &["check", name]);
        assert_eq!(exit_code, code, "{name}: {output}");
        assert_eq!(output.contains("overlap on the plate"), code == Some(1), "{output}");
    }
}

/// A small bed needs several plates. Each is valid, and the set can be generated again from each.
#[test]
fn small_beds_need_several_plates() {
    let folder = tempfile::tempdir().unwrap();
    let generate = ["-q", "generate", "three-double", "--set", "print.bed_mm=62", "--out"];
    done(folder.path(), &[&generate[..], &["set"]].concat());
    let set = files(&folder.path().join("set"));
    let manifest: serde_json::Value = serde_json::from_slice(&set["manifest.json"]).unwrap();
    let plates = manifest["plates"].as_array().unwrap();
    assert!(plates.len() > 1 && !set.contains_key("assembly.3mf") && !set.contains_key("plate.png"));
    let guide = std::str::from_utf8(&set["PRINTING.md"]).unwrap();
    let mut printed = Vec::new();
    for (i, plate) in plates.iter().enumerate() {
        let (file, picture) = (format!("assembly-{}.3mf", i + 1), format!("plate-{}.png", i + 1));
        assert_eq!(plate["file"], file);
        assert!(
            set.contains_key(&picture) && guide.contains(&format!("]({picture})")) && guide.contains(&file)
        );
        let path = format!("set/{file}");
        let (code, output) = ended(folder.path(), &["check", &path, "--json"]);
        assert_eq!(code, Some(0), "{output}");
        let verdict: serde_json::Value = serde_json::from_str(&output).unwrap();
        let names = |list: &serde_json::Value| -> Vec<String> {
            list.as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap().to_owned()).collect()
        };
        let on_plate = names(&plate["parts"]);
        assert_eq!(names(&verdict[0]["parts"]), on_plate);
        printed.extend(on_plate);
        let again = format!("again-{i}");
        done(folder.path(), &["-q", "generate", &path, "--out", &again]);
        let again = files(&folder.path().join(again));
        assert!(again.iter().all(|(name, bytes)| name == "manifest.json" || set[name] == *bytes));
    }
    let mut parts: Vec<String> = manifest["parts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["name"].as_str().unwrap().to_owned())
        .collect();
    printed.sort();
    parts.sort();
    assert_eq!(printed, parts);
    // With a larger bed, the same folder contains one plate, and the old ones are removed.
    done(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    let one = files(&folder.path().join("set"));
    assert!(one.contains_key("assembly.3mf") && one.contains_key("plate.png"));
    assert!(!one.contains_key("assembly-1.3mf") && !one.contains_key("plate-1.png"));
}

#[test]
fn a_3mf_regenerates_its_set() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("mine.toml"),
        "[switch]\nname = \"a <b> & c\"\n[layout]\npins = [3, 8, 12]\n[shell]\nwidth_mm = 15\n"
            .replace(['<', '>', '&'], "+"),
    )
    .unwrap();
    let laws: [&[&str]; 3] = [&[], &[], &["--law", "paper"]];
    for ((config, name), law) in
        [("three-double", "first"), ("mine.toml", "second"), ("three-double", "third")].into_iter().zip(laws)
    {
        done(folder.path(), &[&["-q", "generate", config, "--out", name], law].concat());
        let package = format!("{name}/assembly.3mf");
        let again = format!("{name}-again");
        done(folder.path(), &["-q", "generate", &package, "--out", &again]);
        let (before, after) = (files(&folder.path().join(name)), files(&folder.path().join(&again)));
        assert!(before.keys().eq(after.keys()));
        for (file, bytes) in &before {
            assert!(after[file] == *bytes, "{name}/{file}");
        }
        // Outside of its set, the source of a 3MF is unknown: a template is recognised, any other
        // source becomes the 3MF.
        std::fs::copy(folder.path().join(&package), folder.path().join("sent.3mf")).unwrap();
        let by_itself = format!("{name}-by-itself");
        done(folder.path(), &["-q", "generate", "sent.3mf", "--out", &by_itself]);
        let after = files(&folder.path().join(by_itself));
        for (file, bytes) in &before {
            assert!(after[file] == *bytes || (file == "manifest.json" && name == "second"), "{name}/{file}");
        }
    }
    // A 3MF of another program contains no configuration.
    let foreign = folder.path().join("foreign.3mf");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&foreign).unwrap());
    archive.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(
        &mut archive,
        br#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources/><build/></model>"#,
    )
    .unwrap();
    archive.finish().unwrap();
    let (code, output) = ended(folder.path(), &["generate", "foreign.3mf"]);
    assert!(code == Some(2) && output.contains("foreign.3mf: the 3MF contains no configuration"), "{output}");
}

#[test]
fn the_glb_names_every_body() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-double", "--format", "glb", "--out", "set"]);
    let file = std::fs::read(folder.path().join("set/assembly.glb")).unwrap();
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let scene: serde_json::Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    let names: Vec<&str> =
        scene["nodes"].as_array().unwrap().iter().map(|n| n["name"].as_str().unwrap()).collect();
    for name in ["shell", "support-left", "support-right", "silicone-layer", "pin-1", "pin-3", "tendon"] {
        assert!(names.contains(&name), "{name} is not among {names:?}");
    }
    let materials: Vec<_> =
        scene["materials"].as_array().unwrap().iter().map(|m| m["name"].clone()).collect();
    for material in ["ABS", "silicone", "steel"] {
        assert!(materials.contains(&material.into()), "{material}");
    }
}
