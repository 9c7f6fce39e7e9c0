//! 3MF, STEP and GLB of a set: judged by `check`, and the 3MF made into the set again.

use crate::harness::{done, ended};

/// Files of a folder with their bytes.
fn files(folder: &std::path::Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let entry = |e: std::io::Result<std::fs::DirEntry>| {
        let path = e.unwrap().path();
        (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap())
    };
    std::fs::read_dir(folder).unwrap().map(entry).collect()
}

#[test]
fn what_is_written_is_valid_and_what_is_broken_is_not() {
    let folder = tempfile::tempdir().unwrap();
    done(
        folder.path(),
        &["-q", "generate", "three-single", "--format", "3mf", "--format", "step", "--out", "set"],
    );
    let (code, said) =
        ended(folder.path(), &["check", "set/assembly.3mf", "set/assembly.step", "set/shell.step", "--json"]);
    assert_eq!(code, Some(0), "{said}");
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("set/manifest.json")).unwrap()).unwrap();
    let verdicts: serde_json::Value = serde_json::from_str(&said).unwrap();
    let volume = |part: &serde_json::Value| part["facts"]["volume_mm3"].as_f64().unwrap();
    let exact = |name: &str| {
        let parts = manifest["parts"].as_array().unwrap();
        parts.iter().find(|p| p["name"] == name).unwrap()["volume_mm3"].as_f64().unwrap()
    };
    // Each solid has the volume that the manifest says of it, within what a chord tolerance of 0.01 mm leaves.
    for (file, allowed) in [(0, 5e-3), (1, 5e-3), (2, 5e-3)] {
        let parts = verdicts[file]["parts"].as_array().unwrap();
        let shell = parts.iter().find(|p| p["name"].as_str().unwrap().contains("shell")).unwrap();
        assert!((volume(shell) / exact("shell") - 1.0).abs() < allowed, "{file}: {}", volume(shell));
    }
    // Broken by hand.
    let step = std::fs::read_to_string(folder.path().join("set/shell.step")).unwrap();
    let broken = [
        ("cut.step", step[..step.len() / 2].to_owned(), 2, "no whole STEP file"),
        ("face.step", step.replacen("ADVANCED_FACE", "ADVANCED_FAKE", 1), 2, "not read here"),
        ("unit.step", step.replace(".MILLI.,.METRE.", "$,.METRE."), 2, "export it in millimetres"),
        ("text.step", "ISO-10303-21;\nnothing\n".to_owned(), 2, "no whole STEP file"),
        ("archive.3mf", "PK\u{3}\u{4} nothing".to_owned(), 2, "ZIP archive cannot be read"),
    ];
    for (name, text, code, words) in broken {
        std::fs::write(folder.path().join(name), text).unwrap();
        let (found, said) = ended(folder.path(), &["check", name]);
        assert!(found == Some(code) && said.contains(words), "{name}: {found:?} {said}");
    }
}

/// A STEP library that gives up says so on the terminal, line by line; a user hears one sentence of ours.
#[test]
fn what_a_step_cannot_mean_is_said_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-single", "--format", "step", "--out", "set"]);
    let step = std::fs::read_to_string(folder.path().join("set/shell.step")).unwrap();
    let at = step.find("=CYLINDRICAL_SURFACE(").unwrap();
    let end = at + step[at..].find(");").unwrap();
    let radius = at + step[at..end].rfind(',').unwrap() + 1;
    let plane = step.find("=PLANE(").unwrap() + "=PLANE(".len();
    let end = plane + step[plane..].find(");").unwrap();
    let broken = [
        ("parameters.step", format!("{}''{}", &step[..plane], &step[end..]), 2, "not read here"),
        ("schema.step", step.replace("AUTOMOTIVE_DESIGN", "IFC4"), 2, "its schema is IFC4"),
        ("radius.step", format!("{}-{}", &step[..radius], &step[radius..]), 1, "has a radius of -"),
        ("open.step", step.replace("CLOSED_SHELL", "OPEN_SHELL"), 1, "is an OPEN_SHELL"),
    ];
    for (name, text, code, words) in broken {
        std::fs::write(folder.path().join(name), text).unwrap();
        let (found, said) = ended(folder.path(), &["check", name]);
        assert!(found == Some(code) && said.contains(words), "{name}: {found:?} {said}");
        let is_ours = |line: &str| ["error: ", name, "  "].iter().any(|begin| line.starts_with(begin));
        assert!(said.lines().all(is_ours), "{name}: {said}");
    }
}

/// A 3MF whose items stand in each other cannot be printed, however good each of them is.
#[test]
fn items_of_a_plate_that_share_space_are_not_valid() {
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
                r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>"#,
            ),
            (
                "_rels/.rels",
                r#"<Relationships><Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model"/></Relationships>"#,
            ),
            ("3D/3dmodel.model", model.as_str()),
        ];
        for (part, text) in parts {
            archive.start_file(part, zip::write::SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut archive, text.as_bytes()).unwrap();
        }
        archive.finish().unwrap();
        let (found, said) = ended(folder.path(), &["check", name]);
        assert_eq!(found, code, "{name}: {said}");
        assert_eq!(said.contains("share space on the plate"), code == Some(1), "{said}");
    }
}

/// A bed that takes few parts at once: several plates, of which each is judged, and each makes the set again.
#[test]
fn a_small_bed_takes_the_parts_on_several_plates() {
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
        let (code, said) = ended(folder.path(), &["check", &path, "--json"]);
        assert_eq!(code, Some(0), "{said}");
        let verdict: serde_json::Value = serde_json::from_str(&said).unwrap();
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
    // With a larger bed the same folder holds one plate, and none of those before.
    done(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    let one = files(&folder.path().join("set"));
    assert!(one.contains_key("assembly.3mf") && one.contains_key("plate.png"));
    assert!(!one.contains_key("assembly-1.3mf") && !one.contains_key("plate-1.png"));
}

#[test]
fn the_3mf_of_a_set_makes_the_set_again() {
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
        // Away from its set nothing tells what it was made from: a template is still the template, and else it is the 3MF.
        std::fs::copy(folder.path().join(&package), folder.path().join("sent.3mf")).unwrap();
        let by_itself = format!("{name}-by-itself");
        done(folder.path(), &["-q", "generate", "sent.3mf", "--out", &by_itself]);
        let after = files(&folder.path().join(by_itself));
        for (file, bytes) in &before {
            assert!(after[file] == *bytes || (file == "manifest.json" && name == "second"), "{name}/{file}");
        }
    }
    // A 3MF of another program holds no configuration.
    let foreign = folder.path().join("foreign.3mf");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&foreign).unwrap());
    archive.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(
        &mut archive,
        br#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources/><build/></model>"#,
    )
    .unwrap();
    archive.finish().unwrap();
    let (code, said) = ended(folder.path(), &["generate", "foreign.3mf"]);
    assert!(code == Some(2) && said.contains("foreign.3mf: holds no configuration"), "{said}");
}

#[test]
fn the_glb_names_every_body_of_the_assembly() {
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
