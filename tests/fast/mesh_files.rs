//! `check` on files of others: verdicts, levels, bounds on the work, and files judged independently.

use std::path::Path;

use serde_json::Value;

use crate::harness::{ended, shared_file};

/// A binary STL of triangles.
fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for triangle in triangles {
        let numbers = [0.0; 3].iter().chain(triangle.as_flattened());
        bytes.extend(numbers.flat_map(|x: &f32| x.to_le_bytes()).chain([0, 0]));
    }
    bytes
}

/// A box from the origin with these sides.
fn cuboid([x, y, z]: [f32; 3]) -> Vec<[[f32; 3]; 3]> {
    let at = |i: usize| [[0.0, x][i & 1], [0.0, y][i >> 1 & 1], [0.0, z][i >> 2]];
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    quads.iter().flat_map(|[a, b, c, d]| [[at(*a), at(*b), at(*c)], [at(*a), at(*c), at(*d)]]).collect()
}

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// A 3MF with this model.
fn package(model: &str) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let types = r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
    let rels = r#"<Relationships><Relationship Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/3dmodel.model"/></Relationships>"#;
    for (part, text) in [("[Content_Types].xml", types), ("_rels/.rels", rels), ("3D/3dmodel.model", model)] {
        archive.start_file(part, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut archive, text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const TETRAHEDRON: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/><vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>"#;

/// A model with these attributes, children of the object and items.
fn model(attributes: &str, content: &str, items: &str) -> String {
    format!(
        r#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" {attributes}><resources><object id="1">{TETRAHEDRON}{content}</object></resources><build>{items}</build></model>"#
    )
}

/// The levels of the findings of a file and its parts, by the names of their checks.
fn levels(folder: &Path, arguments: &[&str]) -> (Option<i32>, Vec<(String, String)>) {
    let (code, output) = ended(folder, &[&["check", "--json"], arguments].concat());
    let document = serde_json::Deserializer::from_str(&output).into_iter::<Value>().next().unwrap().unwrap();
    let parts = document[0]["parts"].as_array().into_iter().flatten();
    let faults = parts.chain([&document[0]]).flat_map(|part| part["faults"].as_array().unwrap());
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    (code, faults.map(|fault| (text(&fault["check"]), text(&fault["level"]))).collect())
}

/// A thin wall is a risk, and only an error if warnings count or nothing else is asked for.
#[test]
fn warnings_count_only_when_strict() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "sheet.stl", stl(&cuboid([20.0, 20.0, 0.2])));
    let thin = vec![("thin wall".to_owned(), "warning".to_owned())];
    assert_eq!(levels(folder.path(), &["sheet.stl"]), (Some(0), thin.clone()));
    assert_eq!(levels(folder.path(), &["sheet.stl", "--strict"]), (Some(1), thin));
    let note = vec![("thin wall".to_owned(), "note".to_owned())];
    assert_eq!(levels(folder.path(), &["sheet.stl", "--strict", "--for", "spec"]), (Some(0), note));
}

#[test]
fn the_purpose_chooses_what_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let text = model("colour='red'", "", r#"<item objectid="1" printable="1"/>"#);
    write(folder.path(), "a.3mf", package(&text));
    let (code, of_both) = levels(folder.path(), &["a.3mf"]);
    assert_eq!((code, of_both.len()), (Some(1), 2), "{of_both:?}");
    assert!(of_both.iter().any(|(check, level)| check == "vocabulary" && level == "error"));
    let (code, of_print) = levels(folder.path(), &["a.3mf", "--for", "print"]);
    assert!(code == Some(0) && of_print.iter().all(|(_, level)| level != "error"), "{of_print:?}");
    assert_eq!(levels(folder.path(), &["a.3mf", "--for", "spec"]).0, Some(1));
}

/// A file that cannot be read hides no verdict, and the worst outcome is the exit code.
#[test]
fn files_are_judged_independently() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "good.stl", stl(&cuboid([20.0; 3])));
    write(folder.path(), "open.stl", stl(&cuboid([20.0; 3])[1..]));
    write(folder.path(), "none.stl", "");
    let all = ["check", "none.stl", "good.stl", "missing.stl", "open.stl"];
    let (code, output) = ended(folder.path(), &all);
    assert_eq!(code, Some(2), "{output}");
    for words in ["good.stl: valid;", "open.stl: NOT VALID;", "none.stl: the file is empty", "missing.stl: "]
    {
        assert!(output.contains(words), "{words} is missing from {output}");
    }
    assert_eq!(ended(folder.path(), &["check", "good.stl", "open.stl"]).0, Some(1));
}

/// Opening a pipe without a writer would wait for ever.
#[cfg(unix)]
#[test]
fn special_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "good.stl", stl(&cuboid([20.0; 3])));
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe.stl")).status();
    assert!(made.unwrap().success());
    let (code, output) = ended(folder.path(), &["check", "pipe.stl", "/dev/zero", "good.stl"]);
    assert!(code == Some(2) && output.contains("good.stl: valid;"), "{output}");
    assert_eq!(output.matches("not a regular file").count(), 2, "{output}");
}

/// Files that would take seconds to hours or gigabytes meet a bound, which the message names.
#[test]
fn excessive_packages_cannot_be_judged() {
    let folder = tempfile::tempdir().unwrap();
    let item = r#"<item objectid="1"/>"#;
    let nested = (0..2000).map(|i| format!("<n{i}:a xmlns:n{i}='u{i}'>")).collect::<String>()
        + &(0..2000).rev().map(|i| format!("</n{i}:a>")).collect::<String>();
    let attributes: String = (0..20_000).map(|i| format!("a{i}='' ")).collect();
    let twice = (2..102).map(|id| {
        format!(
            "<object id='{id}'><components>{0}{0}</components></object>",
            format!("<component objectid='{}'/>", id - 1)
        )
    });
    let bomb = model("", "", "<item objectid='101'/>")
        .replace("</resources>", &(twice.collect::<String>() + "</resources>"));
    for (text, words) in [
        (model("", &nested, item), "nested XML elements"),
        (model(&attributes, "", item), "attributes of an XML element"),
        (model("", &" ".repeat(100 << 20), item), "unpacks to more than"),
        (bomb, "solids"),
        (model("xmlns:s='urn:s' requiredextensions='s'", "", item), "required extension urn:s"),
    ] {
        write(folder.path(), "a.3mf", package(&text));
        let (code, output) = ended(folder.path(), &["check", "a.3mf"]);
        assert!(code == Some(2) && output.contains("cannot be judged: "), "{output}");
        assert!(output.contains(words), "{words} is missing from {output}");
    }
}

/// A search that is too long ends: a file without a known fault cannot be judged.
#[test]
fn excessive_meshes_cannot_be_judged() {
    let folder = tempfile::tempdir().unwrap();
    let needle = |i: u16| {
        let shift = f32::from(i) * 0.2;
        let [a, b] = [[shift, -shift, 0.0], [shift + 0.05, -shift - 0.05, 0.0]];
        let [c, d] = [[100.0 + shift, 100.0 - shift, 100.0], [100.0 + shift, 100.0 - shift, 100.05]];
        [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]
    };
    write(folder.path(), "a.stl", stl(&(0..3000).flat_map(needle).collect::<Vec<_>>()));
    let (code, output) = ended(folder.path(), &["check", "a.stl"]);
    let words =
        ["a.stl: cannot be judged;", "not completed: self-intersection: more than", "error: a.stl: cannot"];
    assert!(code == Some(2) && words.iter().all(|words| output.contains(words)), "{output}");
    let (_, output) = ended(folder.path(), &["check", "a.stl", "--json"]);
    let document = serde_json::Deserializer::from_str(&output).into_iter::<Value>().next().unwrap().unwrap();
    assert_eq!((&document[0]["valid"], &document[0]["judged"]), (&false.into(), &false.into()));
    assert_eq!(document[0]["incomplete"][0]["level"], "error");
}

/// Files of others with known answers, where they are present.
#[test]
fn cases_have_the_right_answers() {
    let folder = tempfile::tempdir().unwrap();
    for (case, code, words) in [
        ("meshes/r03-uppercase.stl", 0, ": valid;"),
        ("meshes/r04-cr.stl", 0, ": valid;"),
        ("meshes/r05-cracks.stl", 1, "error: crack: "),
        ("meshes/g04-tjunction-closed-by-zero-area-facet.stl", 0, "warning: degenerate facet: 1 facets"),
        ("meshes/g14-crack-1e-06.stl", 1, "error: crack: "),
        ("meshes/g22-meshmixer-normals.stl", 0, "note: oblique normals: "),
        ("meshes/s12-nan-normals.stl", 0, "note: invalid normals: "),
        ("meshes/s18-count-zero.stl", 0, "note: format: "),
        ("meshes/m04-mirror-item.3mf", 0, ": valid;"),
        ("meshes/m09-nonascii-part.3mf", 0, ": valid;"),
        ("meshes/m14-prusa-printable.3mf", 0, "note: vocabulary: "),
        ("meshes/m16-centred.3mf", 0, "warning: outside: "),
        ("meshes/m20-dup-basematerials.3mf", 1, "[3MF core 3.4.2]"),
        ("meshes/m21-two-models-rel.3mf", 1, "[3MF core 2.1]"),
        ("meshes/m22-thumb-missing.3mf", 1, "[3MF core 2.1.1]"),
        ("meshes/m30-slice-required.3mf", 2, "cannot be judged: "),
        ("meshes/m40-mustpass-metadata.3mf", 0, ": valid;"),
        ("attack/3mf_attributes.3mf", 2, "cannot be judged: "),
        ("attack/3mf_nested_namespaces.3mf", 2, "cannot be judged: "),
    ] {
        let Some(file) = shared_file(&format!("data/cases/{case}")) else { return };
        let (ended_with, output) = ended(folder.path(), &["check", &file.display().to_string()]);
        assert!(ended_with == Some(code) && output.contains(words), "{case}: {output}");
    }
}

/// A support alone conforms: it is a warning that nothing is printed as a solid.
#[test]
fn a_support_alone_is_valid() {
    let folder = tempfile::tempdir().unwrap();
    let item = r#"<item objectid="1"/>"#;
    let support = model("", "", item).replace("<object", r#"<object type="support""#);
    write(folder.path(), "support.3mf", package(&support));
    let warning = vec![("empty".to_owned(), "warning".to_owned())];
    assert_eq!(levels(folder.path(), &["support.3mf"]), (Some(0), warning));
    let nothing =
        model("", "", item).replace(TETRAHEDRON, "<components><component objectid='1'/></components>");
    write(folder.path(), "nothing.3mf", package(&nothing));
    assert_eq!(levels(folder.path(), &["nothing.3mf"]).0, Some(1));
}

/// A namespace of a megabyte, repeated by each element, bounds only its own file.
#[test]
fn a_repeated_namespace_hides_no_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let item = r#"<item objectid="1"/>"#;
    let namespace = format!("xmlns:a='{}'", "u".repeat(1_000_000));
    write(folder.path(), "long.3mf", package(&model(&namespace, "", &item.repeat(10_000))));
    write(folder.path(), "good.3mf", package(&model("", "", item)));
    let (code, output) = ended(folder.path(), &["check", "long.3mf", "good.3mf"]);
    assert_eq!(code, Some(2), "{output}");
    assert!(output.contains("long.3mf: cannot be judged") && output.contains("good.3mf: valid"), "{output}");
}

/// A transform with a word among its numbers is an error for every purpose; a number that all slicers
/// read is one of the specification only.
#[test]
fn values_are_those_of_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let garbage = r#"<item objectid="1" transform="1 0 0 foo 0 1 0 0 0 1 0 0 0"/>"#;
    write(folder.path(), "garbage.3mf", package(&model("", "", garbage)));
    let point = model("", "", r#"<item objectid="1"/>"#).replacen(r#"x="9""#, r#"x="9.""#, 1);
    write(folder.path(), "point.3mf", package(&point));
    for (file, of_print, of_spec) in [("garbage.3mf", 1, 1), ("point.3mf", 0, 1)] {
        assert_eq!(levels(folder.path(), &[file, "--for", "print"]).0, Some(of_print), "{file}");
        assert_eq!(levels(folder.path(), &[file, "--for", "spec"]).0, Some(of_spec), "{file}");
    }
}
