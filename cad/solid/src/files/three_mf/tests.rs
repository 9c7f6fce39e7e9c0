//! Faults of packages, one at a time.

use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::core_spec::{
    CONTENT_TYPES, CORE, CORE_PROPERTIES_TYPE, MODEL_TYPE, PRODUCTION, RELATIONSHIPS, THUMBNAIL_TYPE,
    USUAL_MODEL,
};
use super::error::ThreeMfReadError;
use super::read::{ThreeMf, read_three_mf};
use super::write::{BaseMaterial, Object, Package, three_mf};
use crate::files::plate::Placement;
use crate::mesh::{Mesh, Point3, Vector3};
use crate::validity::Level;

const TYPES: &str = r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="MODEL" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;

fn relationships() -> String {
    format!(
        r#"<Relationships><Relationship Id="rel0" Type="{MODEL_TYPE}" Target="/3D/3dmodel.model"/></Relationships>"#
    )
}

fn packed(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const TETRAHEDRON: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/><vertex x="0" y="9" z="0"/><vertex x="0" y="0" z="9"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>"#;

fn model_of(attributes: &str, metadata: &str, resources: &str, build: &str) -> String {
    format!(
        r#"<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" {attributes}>{metadata}<resources>{resources}</resources><build>{build}</build></model>"#
    )
}

fn read(model: &str) -> ThreeMf {
    let relationships = relationships();
    read_three_mf(&packed(&[(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &relationships), (USUAL_MODEL, model)]))
        .unwrap()
}

fn checks(found: &ThreeMf) -> Vec<&str> {
    found.faults.iter().map(|f| f.check).collect()
}

const BASE: &str = r##"<basematerials id="5"><base name="ABS" displaycolor="#0000FF"/></basematerials>"##;

fn object(id: u32) -> String {
    format!(r#"<object id="{id}">{TETRAHEDRON}</object>"#)
}

#[test]
fn a_written_package_is_read_back() {
    let corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
    let positions = corners.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
    let mesh = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let text = "[switch]\nname = \"<&>\" # \t'\"\n";
    let package = Package {
        metadata: vec![("Title", "a & b".to_owned())],
        own_metadata: vec![("configuration", text.to_owned())],
        materials: vec![BaseMaterial { name: "\"ABS\"".to_owned(), colour: [0, 128, 255] }],
        ..Package::default()
    };
    let place = Placement { plate: 0, is_turned: true, shift: Vector3::new(9.0, 0.0, 0.0) };
    let object =
        |name, material| Object { name, part_number: "x/1".to_owned(), mesh: &mesh, material, place };
    let objects = [object("a <part>", 0), object("of nothing", 1)];
    let found = read_three_mf(&three_mf(&objects, &package).unwrap()).unwrap();
    assert_eq!(checks(&found), [""; 0], "{:?}", found.faults);
    assert_eq!((found.meshes[0].name.as_str(), &found.meshes[0].mesh), ("a <part>", &mesh));
    assert_eq!(found.configuration.as_deref(), Some(text));
}

#[test]
fn each_fault_is_named() {
    let item = r#"<item objectid="1"/>"#;
    let good = model_of("", "", &object(1), item);
    assert_eq!(checks(&read(&good)), [""; 0]);
    // Centred on the origin, as many programs write it.
    let centred = r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 1 -4 -4 0"/>"#;
    assert_eq!(checks(&read(&model_of("", "", &object(1), centred))), [""; 0]);
    for (model, check) in [
        (model_of(r#"unit="parsec""#, "", &object(1), item), "unit"),
        (model_of(r#"colour="red""#, "", &object(1), item), "vocabulary"),
        (model_of("", "", &object(1), r#"<item objectid="1" printable="1"/>"#), "vocabulary"),
        (model_of("", "<plate/>", &object(1), item), "vocabulary"),
        (model_of("", r#"<metadata name="Foo">x</metadata>"#, &object(1), item), "metadata"),
        (model_of("", &r#"<metadata name="Title">x</metadata>"#.repeat(2), &object(1), item), "metadata"),
        (model_of(r#"requiredextensions="zz""#, "", &object(1), item), "extension"),
        (model_of(r#"xmlns:b="urn:b" recommendedextensions="b""#, "", &object(1), item), "extension"),
        (model_of("", "", &object(1), ""), "build"),
        (model_of("", "", &object(1), r#"<item objectid="7"/>"#), "reference"),
        (model_of("", "", &[object(1), object(1)].concat(), item), "reference"),
        (model_of("", "", &format!(r#"{0}{0}{1}"#, BASE, object(1)), item), "reference"),
        (model_of("", "", &object(1).replace("<object", r#"<object type="shape""#), item), "object"),
        (model_of("", "", &object(1).replace("<object", r#"<object type="other""#), item), "build"),
        (model_of("", "", &object(1).replace("<object", r#"<object pindex="0""#), item), "property"),
        (model_of(r#"xml:space="default""#, "", &object(1), item), "vocabulary"),
        (model_of("", "<metadata>x</metadata>", &object(1), item), "attribute"),
        (model_of("", r#"<metadata name="q:a">x</metadata>"#, &object(1), item), "metadata"),
        (model_of("", "", &(BASE.replace("#0000FF", "blue") + &object(1)), item), "material"),
        (good.replace("<build>", "<build/><build>"), "model"),
        (good.replace(r#"v3="1""#, r#"v3="2""#), "index"),
        (
            model_of("", "", &object(1), r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 0 0 0 0"/>"#),
            "transform",
        ),
        (
            model_of("", "", &object(1), r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 1 -50 0 0"/>"#),
            "outside",
        ),
        (model_of("", "", &object(1), r#"<item objectid="1" transform="1 0 0"/>"#), "transform"),
        (good.replace(r#"v3="1""#, r#"v3="4""#), "index"),
        (good.replace(r#"v3="1""#, ""), "index"),
        (
            model_of(
                "",
                "",
                r#"<object id="1"><components><component objectid="1"/></components></object>"#,
                item,
            ),
            "reference",
        ),
    ] {
        assert_eq!(checks(&read(&model)), [check], "{model}");
    }
    let of = |parts: &[(&str, &str)]| checks(&read_three_mf(&packed(parts)).unwrap()).join(" ");
    assert_eq!(of(&[(CONTENT_TYPES, TYPES), (USUAL_MODEL, &good)]), "relationships");
    assert_eq!(of(&[(RELATIONSHIPS, &relationships()), (USUAL_MODEL, &good)]), "content types");
}

/// Everything that the schema does not accept, with the paragraph that it breaks.
#[test]
fn violations_of_the_schema_are_named() {
    let item = r#"<item objectid="1"/>"#;
    let good = model_of("", "", &object(1), item);
    let triangle = |attributes: &str| {
        let first = format!("<triangle {attributes} v1=\"0\"");
        let two = BASE.replace("</base", r##"<base name="b" displaycolor="#00FF00"/></base"##);
        let object = object(1).replacen("<object", r#"<object pid="5" pindex="0""#, 1);
        model_of("", "", &(two + &object.replacen("<triangle v1=\"0\"", &first, 1)), item)
    };
    let moved = |transform: &str| {
        model_of("", "", &object(1), &format!(r#"<item objectid="1" transform="{transform}"/>"#))
    };
    let metadata = |attributes: &str| {
        model_of("", &format!(r#"<metadata name="Title" {attributes}>x</metadata>"#), &object(1), item)
    };
    let (start, end) = (TETRAHEDRON.find("<triangles").unwrap(), TETRAHEDRON.find("</mesh").unwrap());
    let reordered = format!("<mesh>{}{}</mesh>", &TETRAHEDRON[start..end], &TETRAHEDRON[6..start]);
    let foreign = r#"xmlns:a="urn:a""#;
    for (model, check, paragraph) in [
        (moved("1 0 0 foo 0 1 0 0 0 1 0 0 0"), "transform", "3MF core 3.3"),
        (moved("1 0 0 0 1 0 0 0 1 0 0 0 0"), "transform", "3MF core 3.3"),
        (moved("1 0 0 0 1 0 0 0 1 0 0 0."), "transform", "3MF core 3.3"),
        (good.replacen(r#"x="9""#, r#"x="9.""#, 1), "value", "3MF core B.1.1"),
        (good.replacen("<triangles>", "<vertices/><triangles>", 1), "triangles", "3MF core B.1.1"),
        (good.replace(TETRAHEDRON, &reordered), "triangles", "3MF core B.1.1"),
        (model_of("", "", &object(1), &(item.to_owned() + &object(3))), "vocabulary", "3MF core 2.3.2"),
        (model_of(foreign, "", &object(1), &(item.to_owned() + "<a:x/>")), "vocabulary", "3MF core 2.3.2"),
        (model_of("", "", &object(1), &(item.to_owned() + "hello")), "vocabulary", "3MF core 2.3.2"),
        (good.replacen(r#"v3="1"/>"#, r#"v3="1">x</triangle>"#, 1), "vocabulary", "3MF core 2.3.2"),
        (good.replacen(r#"v3="1"/>"#, r#"v3="1"><x/></triangle>"#, 1), "vocabulary", "3MF core 2.3.2"),
        (
            model_of("", "", &(r#"<basematerials id="5"/>"#.to_owned() + &object(1)), item),
            "material",
            "3MF core B.1.1",
        ),
        (model_of("", "", &(object(1) + BASE), item), "model", "3MF core B.1.1"),
        (
            model_of("", "", &(object(1) + r#"<object id="2"><components/></object>"#), item),
            "object",
            "3MF core B.1.1",
        ),
        (triangle(r#"p1="0" p2="1" p3="1""#), "property", "3MF core 4.1.4.1"),
        (triangle(r#"p1="0" p3="1""#), "property", "3MF core 4.1.4.1"),
        (triangle(r#"pid="5" p1="2""#), "property", "3MF core 4.1.4.1"),
        (triangle(r#"p1="x""#), "value", "3MF core B.1.1"),
        (good.replacen("<object", r#"<object xml:id="a""#, 1), "vocabulary", "3MF core 2.3.2"),
        (
            model_of(
                r#"xmlns:i="http://www.w3.org/2001/XMLSchema-instance" i:schemaLocation="a b""#,
                "",
                &object(1),
                item,
            ),
            "vocabulary",
            "3MF core 2.3.2",
        ),
        (model_of(r#"xml:lang="12 34""#, "", &object(1), item), "value", "3MF core 3.4"),
        (metadata("").replace(r#""Title""#, r#""p:b:c""#), "metadata", "3MF core 3.4.1"),
        (metadata(r#"preserve="maybe""#), "value", "3MF core 3.4.1"),
        (metadata(r#"type="xs:banana""#), "value", "3MF core 3.4.1"),
        (model_of(r#"requiredextensions="p""#, "", &object(1), ""), "identifier", "3MF production 4.2"),
    ] {
        let found = read(&model);
        let found: Vec<_> = found.faults.iter().filter(|fault| fault.check != "build").collect();
        assert_eq!(found.len(), 1, "{found:?}\n{model}");
        assert_eq!((found[0].check, found[0].paragraph), (check, Some(paragraph)), "{model}");
        assert_eq!(found[0].level, Level::Error, "{model}");
    }
    for model in [
        moved("\n1 0 0\n0 1 0 0 0 1\t10e0 +1 .5 "),
        metadata(r#"preserve="1" type="xs:string" xml:lang="de""#),
        model_of(r#"xml:lang="en-US""#, "", &object(1), item),
        triangle(r#"p1="1" p2="1""#),
        good.replacen(r#"v1="0""#, r#"v1=" 0 ""#, 1),
        model_of(foreign, "", &object(1).replace("</mesh>", "<a:x><a:y>t</a:y></a:x></mesh>"), item),
    ] {
        assert_eq!(checks(&read(&model)), [""; 0], "{model}");
    }
}

#[test]
fn violations_of_the_package_are_named() {
    let model = model_of("", "", &object(1), r#"<item objectid="1"/>"#);
    let picture = TYPES.replace("</Types>", r#"<Default Extension="png" ContentType="image/png"/></Types>"#);
    let rels = relationships();
    let related = |more: &str| rels.replace("</Relationships>", &format!("{more}</Relationships>"));
    let relation = |id: &str, kind: &str, target: &str| {
        related(&format!(r#"<Relationship {id} Type="{kind}" Target="{target}"/>"#))
    };
    let with_type = |entry: &str| TYPES.replace("</Types>", &format!("{entry}</Types>"));
    let repeated =
        TYPES.replace("</Types>", r#"<Default Extension="model" ContentType="a/b"/></Types>"#).replace(
            r#"Extension="model" ContentType="a/b""#,
            r#"Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml""#,
        );
    for (types, rels, part, paragraph) in [
        (&picture, rels.replace(r#"Id="rel0""#, ""), "a.png", "OPC M1.26"),
        (&picture, relation(r#"Id="rel0""#, THUMBNAIL_TYPE, "/a.png"), "a.png", "OPC M1.26"),
        (&picture, relation(r#"Id="1""#, THUMBNAIL_TYPE, "/a.png"), "a.png", "OPC M1.26"),
        (&picture, relation(r#"Id="a""#, "urn:a", "/a.png#x"), "a.png", "OPC O1.6"),
        (&picture, relation(r#"Id="a""#, THUMBNAIL_TYPE, "/b.png"), "b.png", "3MF core 2.1.3"),
        (&picture, rels.clone(), "3D/.png", "3MF core 2.2.3"),
        (&picture, rels.clone(), "3D/a./b.png", "OPC M1.9"),
        (&picture, rels.clone(), "3D/3dmodel.model/a.png", "OPC M1.11"),
        (&picture, rels.clone(), "a.config", "OPC M2.4"),
        (&picture, relation(r#"Id="a""#, "urn:a", "/a.config"), "a.config", "OPC M2.4"),
        (&repeated, rels.clone(), "a.rels", "OPC M2.5"),
        (
            &with_type(r#"<Default Extension="png" ContentType="picture"/>"#),
            rels.clone(),
            "a.png",
            "OPC M1.14",
        ),
        (&with_type(r#"<Default Extension="a/b" ContentType="a/b"/>"#), rels.clone(), "a.rels", "OPC M2.6"),
        (&with_type(r#"<Default ContentType="image/png"/>"#), rels.clone(), "a.rels", "OPC M2.6"),
        (
            &with_type(r#"<Override PartName="a.png" ContentType="image/png"/>"#),
            rels.clone(),
            "a.png",
            "OPC M1.4",
        ),
        (&with_type("<Other/>"), rels.clone(), "a.rels", "OPC M2.5"),
        (&picture, rels.clone(), "3D/%41.png", "OPC M1.8"),
        (&picture, rels.clone(), "3D/a%2fb.png", "OPC M1.7"),
        (
            &picture,
            related(
                &["a", "b"]
                    .map(|id| {
                        format!(
                            r#"<Relationship Id="{id}" Type="{CORE_PROPERTIES_TYPE}" Target="/{id}.png"/>"#
                        )
                    })
                    .concat(),
            ),
            "a.png",
            "OPC M4.1",
        ),
    ] {
        let content = if part == "b.png" { "no picture" } else { "\u{89}PNG\r\n\x1a\n" };
        // A PNG begins with a byte that no text has.
        let content: Vec<u8> = content.chars().map(|c| c as u8).collect();
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let texts = [(CONTENT_TYPES, types.as_bytes()), (RELATIONSHIPS, rels.as_bytes())];
        for (name, bytes) in texts.into_iter().chain([(USUAL_MODEL, model.as_bytes()), (part, &content)]) {
            archive.start_file(name, SimpleFileOptions::default()).unwrap();
            archive.write_all(bytes).unwrap();
        }
        let found = read_three_mf(&archive.finish().unwrap().into_inner()).unwrap();
        let paragraphs: std::collections::BTreeSet<_> =
            found.faults.iter().filter_map(|fault| fault.paragraph).collect();
        assert_eq!(
            paragraphs.into_iter().collect::<Vec<_>>(),
            [paragraph],
            "{part} {rels} {:?}",
            found.faults
        );
    }
}

#[test]
fn triangle_sets_refer_to_triangles() {
    let sets = |content: &str| {
        let sets = format!(
            "<t:trianglesets xmlns:t=\"{}\">{content}</t:trianglesets></mesh>",
            super::triangle_sets::NAMESPACE
        );
        let model = model_of("", "", &object(1).replace("</mesh>", &sets), r#"<item objectid="1"/>"#);
        read(&model).faults.into_iter().map(|fault| fault.detail).collect::<Vec<_>>()
    };
    let one =
        |content: &str| sets(&format!(r#"<t:triangleset name="a" identifier="a">{content}</t:triangleset>"#));
    assert_eq!(one(r#"<t:ref index="3"/><t:refrange startindex="0" endindex="3"/>"#), [""; 0]);
    assert_eq!(one(r#"<t:ref index="4"/>"#), ["object 1: a set refers to triangle 4 of 4"]);
    assert_eq!(
        one(r#"<t:refrange startindex="1" endindex="9"/>"#),
        ["object 1: a set refers to triangle 9 of 4"]
    );
    assert_eq!(
        one(r#"<t:refrange startindex="3" endindex="0"/>"#),
        ["object 1: a range of a triangle set is reversed"]
    );
    assert_eq!(one("<t:ref/>"), ["object 1: a reference of a triangle set is not an index"]);
    let twice = r#"<t:triangleset name="a" identifier="a"/>"#.repeat(2);
    assert_eq!(sets(&twice), ["object 1: two triangle sets have the same identifier"]);
    assert_eq!(sets(r#"<t:triangleset name="" identifier="a"/>"#), ["object 1: a triangle set has no name"]);
}

#[test]
fn textures_are_parts_with_a_relationship() {
    let kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture";
    let texture = format!(
        r#"<m:texture2d xmlns:m="{}" id="7" path="/3D/a.png" contenttype="image/png"/>"#,
        super::materials::NAMESPACE
    );
    let model = model_of("", "", &(texture + &object(1)), r#"<item objectid="1"/>"#);
    let types = TYPES.replace("</Types>", r#"<Default Extension="png" ContentType="image/png"/></Types>"#);
    let related =
        format!(r#"<Relationships><Relationship Id="a" Type="{kind}" Target="/3D/a.png"/></Relationships>"#);
    let rels = relationships();
    let all = [
        (CONTENT_TYPES, types.as_str()),
        (RELATIONSHIPS, &rels),
        (USUAL_MODEL, &model),
        ("3D/a.png", "x"),
        ("3D/_rels/3dmodel.model.rels", &related),
    ];
    let found = |parts: &[(&str, &str)]| checks(&read_three_mf(&packed(parts)).unwrap()).join(" ");
    assert_eq!(found(&all), "");
    assert_eq!(found(&all[..4]), "texture");
    assert_eq!(found(&all[..3]), "texture");
}

/// A mesh that repeats one triangle packs to nothing: its tags are bounded by the size of the file.
#[test]
fn repeated_triangles_meet_a_bound() {
    let triangle = r#"<triangle v1="0" v2="1" v3="2"/>"#;
    let vertices = r#"<vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/><vertex x="0" y="9" z="0"/>"#;
    let of = |count: usize| {
        let mesh =
            format!("<vertices>{vertices}</vertices><triangles>{}</triangles>", triangle.repeat(count));
        let object = format!(r#"<object id="1"><mesh>{mesh}</mesh></object>"#);
        let rels = relationships();
        let model = model_of("", "", &object, r#"<item objectid="1"/>"#);
        read_three_mf(&packed(&[(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &rels), (USUAL_MODEL, &model)]))
    };
    let bound = of(220_000).map(|_| ()).unwrap_err().to_string();
    assert!(bound.contains("XML tags"), "{bound}");
    assert!(of(50_000).is_ok());
}

/// Ids are numbers: 01 is 1.
#[test]
fn ids_are_compared_as_numbers() {
    let found =
        read(&model_of("", "", &object(1).replace(r#"id="1""#, r#"id="01""#), r#"<item objectid="1"/>"#));
    assert!(!checks(&found).contains(&"reference"), "{:?}", checks(&found));
    let twice = format!("{}{}", object(1), object(1).replace(r#"id="1""#, r#"id="01""#));
    assert!(checks(&read(&model_of("", "", &twice, r#"<item objectid="1"/>"#))).contains(&"reference"));
}

/// Texts of a megabyte in a small file are not kept once for each element.
#[test]
fn repeated_texts_take_no_memory() {
    let bound = |model: &str| {
        let rels = relationships();
        let parts = [(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &rels), (USUAL_MODEL, model)];
        matches!(read_three_mf(&packed(&parts)), Err(ThreeMfReadError::Bound(_)))
    };
    let item = r#"<item objectid="1"/>"#;
    let namespace = format!(r#"xmlns:a="{}""#, "u".repeat(100_000));
    assert!(bound(&model_of(&namespace, "", &object(1), item)));
    let named = format!(r#"<item objectid="1" partnumber="{}"/>"#, "x".repeat(100_000));
    assert!(bound(&model_of("", "", &object(1), &named.repeat(600))));
    // Attributes that are unknown are counted, and not kept.
    let unknown: String = (0..31).map(|i| format!(r#" a{i}="{}""#, "x".repeat(20))).collect();
    let found =
        read(&model_of("", "", &object(1), &format!(r#"<item objectid="1"{unknown}/>"#).repeat(3_000)));
    assert!(checks(&found).contains(&"vocabulary"));
    let rels = relationships().replace(
        "</Relationships>",
        &format!(r#"<Relationship Id="a" Type="urn:a" Target="/{}"/></Relationships>"#, "A".repeat(34_000)),
    );
    let model = model_of("", "", &object(1), item);
    let parts = [(CONTENT_TYPES, TYPES), (RELATIONSHIPS, rels.as_str()), (USUAL_MODEL, model.as_str())];
    assert!(matches!(read_three_mf(&packed(&parts)), Err(ThreeMfReadError::Bound(_))));
}

#[test]
fn scaled_items_are_returned_in_both_sizes() {
    let flat = r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 0.01 0 0 0"/>"#;
    let found = read(&model_of("", "", &object(1), flat));
    let volumes: Vec<f64> = found.meshes.iter().map(|m| m.mesh.volume_mm3()).collect();
    assert!((volumes[0] - 121.5).abs() < 1e-9 && (volumes[1] - 1.215).abs() < 1e-9, "{volumes:?}");
    let turned = r#"<item objectid="1" transform="0 1 0 -1 0 0 0 0 1 20 20 0"/>"#;
    assert_eq!(read(&model_of("", "", &object(1), turned)).meshes.len(), 1);
}

#[test]
fn solids_are_placed_by_their_items() {
    let two = r#"<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 3 0 0"/>"#;
    let found = read(&model_of("", "", &object(1), two));
    let places: Vec<(usize, f64)> =
        found.built.iter().map(|solid| (solid.item, solid.mesh.bounds().unwrap().0.x)).collect();
    assert_eq!(places, [(0, 0.0), (1, 3.0)]);
}

#[test]
fn an_invalid_number_is_quoted() {
    let item = r#"<item objectid="1"/>"#;
    let good = model_of("", "", &object(1), item);
    let comma = read(&good.replacen(r#"x="9""#, r#"x="9,5""#, 1));
    assert_eq!(checks(&comma)[0], "number");
    let words = &comma.faults[0].detail;
    assert!(words.contains(r#"x="9,5""#) && words.contains("a decimal point, not a comma"), "{words}");
    let missing = read(&good.replacen(r#"x="9" "#, "", 1));
    assert!(missing.faults[0].detail.contains("without x"), "{:?}", missing.faults);
}

#[test]
fn nested_components_are_bounded() {
    let twice = |id: u32| {
        let component = format!(r#"<component objectid="{}"/>"#, id - 1).repeat(9);
        format!(r#"<object id="{id}"><components>{component}</components></object>"#)
    };
    let resources = (2..14).fold(object(1), |all, id| all + &twice(id));
    let bomb = read(&model_of("", "", &resources, r#"<item objectid="13"/>"#));
    assert_eq!((checks(&bomb), bomb.built.len(), bomb.bound.is_some()), (vec![], 500, true));
    // A chain of a hundred is no bomb.
    let once = |id: u32| {
        format!(r#"<object id="{id}"><components><component objectid="{}"/></components></object>"#, id - 1)
    };
    let resources = (2..102).fold(object(1), |all, id| all + &once(id));
    let chain = read(&model_of("", "", &resources, r#"<item objectid="101"/>"#));
    assert_eq!((checks(&chain), chain.built.len(), &chain.bound), (vec![], 1, &None));
}

/// A transform that mirrors does not turn a solid inside out.
#[test]
fn mirrored_items_keep_their_volume() {
    let item = r#"<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 50 0 0"/>"#;
    let found = read(&model_of("", "", &object(1), item));
    assert_eq!(checks(&found), [""; 0]);
    assert!((found.built[0].mesh.volume_mm3() - 121.5).abs() < 1e-9);
}

#[test]
fn usual_deviations_are_no_errors() {
    let item = r#"<item objectid="1" printable="1" transform="1 0 0 0 1 0 0 0 1 0 0 -3"/>"#;
    let metadata = r#"<metadata name="Foo">x</metadata>"#;
    let found = read(&model_of("", metadata, &object(1), item));
    assert_eq!(checks(&found), ["vocabulary", "metadata", "outside"]);
    assert!(found.faults.iter().all(|fault| fault.level < Level::Error), "{:?}", found.faults);
    assert_eq!(found.faults[1].paragraph, Some("3MF core 3.4.1"));
    // Triangles that a person painted in a slicer.
    let painted = object(1).replacen("<triangle ", r#"<triangle paint_color="4" face_property="{}" "#, 1);
    let found = read(&model_of("", "", &painted, r#"<item objectid="1"/>"#));
    assert_eq!(checks(&found), ["vocabulary"; 2]);
    assert!(found.faults.iter().all(|fault| fault.level == Level::Note), "{:?}", found.faults);
    let other = painted.replace("paint_color", "colour");
    assert!(read(&model_of("", "", &other, item)).faults.iter().any(|fault| fault.level == Level::Error));
}

/// Each kind is reported a few times, and the rest is counted.
#[test]
fn findings_of_a_kind_are_counted() {
    let items: String = (2..20_002).map(|id| format!(r#"<item objectid="{id}"/>"#)).collect();
    let found = read(&model_of("", "", &object(1), &items));
    assert_eq!(checks(&found), ["reference"; 4]);
    assert_eq!(found.faults[3].count, 19_997);
}

#[test]
fn part_names_are_compared_as_required() {
    let model = model_of("", "", &object(1), r#"<item objectid="1"/>"#);
    let types = TYPES;
    for (target, name) in [
        ("/3d/3DMODEL.model", "3D/3dmodel.model"),
        ("/3D/%E6%A8%A1.model", "3D/\u{6a21}.model"),
        ("3D/../3D/3dmodel.model", "3D/3dmodel.model"),
    ] {
        let rels = relationships().replace("/3D/3dmodel.model", target);
        let parts = [(CONTENT_TYPES, types), ("_RELS/.rels", rels.as_str()), (name, model.as_str())];
        let found = read_three_mf(&packed(&parts)).unwrap();
        assert_eq!((checks(&found), found.meshes.len()), (vec![], 1), "{target}");
    }
    let rels = relationships();
    let twice =
        [(CONTENT_TYPES, types), (RELATIONSHIPS, &rels), (USUAL_MODEL, &model), ("3D/3DModel.model", &model)];
    assert_eq!(checks(&read_three_mf(&packed(&twice)).unwrap()), ["part name"]);
}

#[test]
fn faults_of_relationships_are_named() {
    let model = model_of("", "", &object(1), r#"<item objectid="1"/>"#);
    let with = |more: &str| {
        let rels = relationships().replace("</Relationships>", &format!("{more}</Relationships>"));
        let parts = [(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &rels), (USUAL_MODEL, &model)];
        read_three_mf(&packed(&parts)).unwrap()
    };
    let relation =
        |kind: &str, target: &str| format!(r#"<Relationship Id="rel1" Type="{kind}" Target="{target}"/>"#);
    assert_eq!(checks(&with(&relation(THUMBNAIL_TYPE, "/Metadata/missing.png"))), ["relationships"]);
    assert_eq!(checks(&with(&relation("urn:a", "http://a.example/b"))), ["relationships"]);
    assert_eq!(checks(&with(&relation("urn:a", "c:/b"))), ["relationships"]);
    let two = with(&relation(MODEL_TYPE, "/3D/other.model"));
    assert_eq!(checks(&two), ["relationships"; 2], "two models, of which one is missing");
    let encrypted = relationships()
        .replace(MODEL_TYPE, "http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/04/keystore");
    let parts = [(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &encrypted), (USUAL_MODEL, &model)];
    assert!(matches!(read_three_mf(&packed(&parts)), Err(ThreeMfReadError::Unsupported(_))));
}

#[test]
fn resources_of_the_materials_extension_are_checked() {
    let item = r#"<item objectid="1"/>"#;
    let with = |resources: &str| {
        let namespace = format!(r#"xmlns:m="{}""#, super::materials::NAMESPACE);
        read(&model_of(&namespace, "", &(resources.to_owned() + &object(1)), item))
    };
    let colors = r##"<m:colorgroup id="7"><m:color color="#FF0000"/></m:colorgroup>"##;
    assert_eq!(checks(&with(colors)), [""; 0]);
    let layers = r#"<m:multiproperties id="8" pids="5 7" blendmethods="multiply"><m:multi pindices="0 0"/></m:multiproperties>"#;
    assert_eq!(checks(&with(&format!("{BASE}{colors}{layers}"))), [""; 0]);
    for resources in [
        colors.replace(r##" color="#FF0000""##, ""),
        colors.replace("#FF0000", "red"),
        format!(r#"{BASE}{colors}<m:multiproperties id="8" pids="7 7"><m:multi pindices="0 0"/></m:multiproperties>"#),
        format!(r#"{BASE}<m:multiproperties id="8" pids="5 5"><m:multi pindices="0 0"/></m:multiproperties>"#),
        format!(r#"{BASE}{colors}<m:multiproperties id="8" pids="5 7" blendmethods="mix mix"><m:multi pindices="0 0"/></m:multiproperties>"#),
        format!(r#"{BASE}{colors}<m:multiproperties id="8" pids="5 7" blendmethods="add"><m:multi pindices="0 0"/></m:multiproperties>"#),
        r#"<m:texture2d id="9" path="/a.gif" contenttype="image/gif"/>"#.to_owned(),
        format!(r#"{colors}<m:texture2dgroup id="8" texid="7"><m:tex2coord u="0" v="0"/></m:texture2dgroup>"#),
        format!(r#"{colors}<m:compositematerials id="8" matid="7" matindices="0"><m:composite values="1"/></m:compositematerials>"#),
        r#"<m:colorgroup id="7"/>"#.to_owned(),
        r#"<m:texture2d id="9" path="/a.png" contenttype="image/png" tilestyleu="foo"/>"#.to_owned(),
        r#"<m:texture2d id="9" path="/a.png" contenttype="image/png"/><m:texture2dgroup id="8" texid="9"><m:tex2coord u="x" v="0"/></m:texture2dgroup>"#.to_owned(),
    ] {
        let found = with(&resources);
        // The package does not contain the textures.
        let found: Vec<_> = checks(&found).into_iter().filter(|check| *check != "texture").collect();
        assert_eq!(found, ["materials"], "{resources}");
    }
    assert_eq!(checks(&with(&colors.replace("7", "1"))), ["reference"], "the id of the object");
    // An index beyond the only color of the group, of a triangle or of the object.
    let namespace = format!(r#"xmlns:m="{}""#, super::materials::NAMESPACE);
    let colored = |id: &str, triangle: &str| {
        let object =
            object(1).replace(r#"id="1""#, id).replacen("<triangle ", &format!("<triangle {triangle} "), 1);
        checks(&read(&model_of(&namespace, "", &(colors.to_owned() + &object), item))).join(" ")
    };
    let object_color = r#"id="1" pid="7" pindex="0""#;
    assert_eq!(colored(object_color, r#"pid="7" p1="0""#), "");
    assert_eq!(colored(object_color, r#"pid="7" p1="1""#), "property");
    assert_eq!(colored(r#"id="1" pid="7" pindex="3""#, ""), "property");
}

/// Endless zeros and crowds of entries are refused before they are read.
#[test]
fn excessive_archives_meet_a_bound() {
    let model = model_of("", "", &object(1), r#"<item objectid="1"/>"#);
    let long = model.replace("<build>", &(" ".repeat(100 << 20) + "<build>"));
    let rels = relationships();
    let bound =
        |parts: &[(&str, &str)]| matches!(read_three_mf(&packed(parts)), Err(ThreeMfReadError::Bound(_)));
    assert!(bound(&[(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &rels), (USUAL_MODEL, &long)]));
    let names: Vec<String> = (0..10_001).map(|i| i.to_string()).collect();
    assert!(bound(&names.iter().map(|name| (name.as_str(), "")).collect::<Vec<_>>()));
    let items = r#"<item objectid="1"/>"#.repeat(100_001);
    let many = model_of("", "", &object(1), &items);
    assert!(bound(&[(CONTENT_TYPES, TYPES), (RELATIONSHIPS, &rels), (USUAL_MODEL, &many)]));
}

/// An identifier of the production extension.
const UUID: &str = r#"p:UUID="01cbb956-1d24-062d-fbe6-7362e5727594""#;

#[test]
fn separate_parts_and_other_units_are_read() {
    let main = model_of(
        r#"unit="inch" requiredextensions="p""#,
        "",
        &format!(
            r#"<object id="2" {UUID}><components><component objectid="1" {UUID} p:path="/3D/Objects/a.model"/></components></object>"#
        ),
        &format!(r#"<item objectid="2" {UUID}/>"#),
    )
    .replace("<build>", &format!("<build {UUID}>"));
    let other = model_of(r#"unit="centimeter""#, "", &object(1), "");
    let relationships = relationships();
    let parts = [
        (CONTENT_TYPES, TYPES),
        (RELATIONSHIPS, relationships.as_str()),
        (USUAL_MODEL, main.as_str()),
        ("3D/Objects/a.model", other.as_str()),
    ];
    let found = read_three_mf(&packed(&parts)).unwrap();
    assert_eq!(checks(&found), [""; 0], "{:?}", found.faults);
    assert!((found.meshes[0].mesh.volume_mm3() - 121_500.0).abs() < 1e-6);
    let missing = read_three_mf(&packed(&parts[..3])).unwrap();
    assert!(checks(&missing).contains(&"reference"));
}

/// The library reads the last of several entries with one name: another reader may read the first.
#[test]
fn entries_of_the_same_name_are_reported() {
    let (relationships, model) = (relationships(), model_of("", "", &object(1), r#"<item objectid="1"/>"#));
    let other = USUAL_MODEL.replace("3dmodel", "3dmodex");
    let parts = [
        (CONTENT_TYPES, TYPES),
        (RELATIONSHIPS, relationships.as_str()),
        (other.as_str(), model.as_str()),
        (USUAL_MODEL, model.as_str()),
    ];
    let mut bytes = packed(&parts);
    assert!(!checks(&read_three_mf(&bytes).unwrap()).contains(&"part name"));
    for at in 0..bytes.len() - other.len() {
        if bytes[at..].starts_with(other.as_bytes()) {
            bytes[at..at + other.len()].copy_from_slice(USUAL_MODEL.as_bytes());
        }
    }
    assert_eq!(checks(&read_three_mf(&bytes).unwrap()), ["part name"]);
    // Bytes before or after the archive hide nothing.
    let others = [[b"junk".as_slice(), &bytes].concat(), [&bytes, b"junk".as_slice()].concat()];
    let read: Vec<_> = others.iter().filter_map(|bytes| read_three_mf(bytes).ok()).collect();
    assert!(!read.is_empty() && read.iter().all(|found| checks(found).contains(&"part name")));
}

#[test]
fn identifiers_are_unique() {
    let other = UUID.replace("01cbb956", "01cbb957");
    let model = |second: &str| {
        let items = format!(r#"<item objectid="1" {UUID}/><item objectid="1" {second}/>"#);
        let object = object(1).replace("<object ", &format!("<object {UUID} "));
        model_of(r#"requiredextensions="p""#, "", &object, &items)
            .replace("<build>", &format!("<build {UUID}>"))
    };
    let identifiers = |second: &str| {
        let found = read(&model(second));
        found.faults.iter().filter(|fault| fault.check == "identifier").map(|f| f.level).collect::<Vec<_>>()
    };
    assert_eq!(identifiers(&other), []);
    assert_eq!(identifiers(UUID), [Level::Warning]);
}

#[test]
fn other_archives_are_refused() {
    let refused = |bytes: &[u8]| read_three_mf(bytes).unwrap_err().to_string();
    assert!(refused(b"PK\x03\x04 no archive").contains("cannot read the ZIP archive"));
    assert!(refused(&packed(&[("a.txt", "a")])).contains("contains no 3D model"));
    assert!(refused(&packed(&[(USUAL_MODEL, "<model")])).contains("3D/3dmodel.model: "));
    assert!(refused(&packed(&[(USUAL_MODEL, "<svg/>")])).contains("is not a model"));
    let entities = r#"<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>"#;
    assert!(refused(&packed(&[(USUAL_MODEL, entities)])).contains("3D/3dmodel.model"));
}
