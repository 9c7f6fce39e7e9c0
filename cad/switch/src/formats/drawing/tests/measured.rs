//! The drawing is read back from its DXF, measured, and compared with the manifest.

use std::collections::BTreeMap;

use serde_json::Value;

use super::built;
use crate::formats::named;
use crate::prediction::Prediction;
use crate::set::Set;

/// An entity of a DXF: its kind and its groups.
#[derive(Debug)]
struct Entity {
    kind: String,
    groups: BTreeMap<u32, String>,
}

impl Entity {
    fn number(&self, code: u32) -> f64 {
        self.groups[&code].parse().unwrap()
    }

    fn is(&self, kind: &str, layer: &str) -> bool {
        self.kind == kind && self.groups[&8] == layer
    }

    fn centre(&self) -> (f64, f64) {
        (self.number(10), self.number(20))
    }

    /// Angle of an arc, degrees.
    fn sweep(&self) -> f64 {
        (self.number(51) - self.number(50)).rem_euclid(360.0)
    }
}

/// Blocks by name, and the entities of model space under the empty name.
fn read(text: &str) -> BTreeMap<String, Vec<Entity>> {
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len().is_multiple_of(2), "codes and values come in pairs");
    let mut entities: Vec<Entity> = Vec::new();
    for pair in lines.chunks_exact(2) {
        let code: u32 = pair[0].trim().parse().unwrap();
        if code == 0 {
            entities.push(Entity { kind: pair[1].to_owned(), groups: BTreeMap::new() });
        } else if let Some(last) = entities.last_mut() {
            last.groups.entry(code).or_insert_with(|| pair[1].to_owned());
        }
    }
    let mut blocks: BTreeMap<String, Vec<Entity>> = BTreeMap::new();
    let mut block: Option<String> = None;
    for entity in entities {
        match entity.kind.as_str() {
            "BLOCK" => block = Some(entity.groups[&2].clone()),
            "ENDBLK" => block = None,
            "SECTION" => block = (entity.groups[&2] == "ENTITIES").then(String::new),
            "ENDSEC" | "EOF" => block = None,
            _ => {
                if let Some(name) = &block {
                    blocks.entry(name.clone()).or_default().push(entity);
                }
            }
        }
    }
    blocks
}

/// A value of the manifest: a derived dimension or a setting.
fn listed(manifest: &Value, name: &str) -> f64 {
    let of = |list: &str, key: &str| {
        manifest[list]
            .as_array()
            .unwrap()
            .iter()
            .find(|e| e[key] == name)
            .map(|e| e["value"].as_f64().unwrap())
    };
    of("derived", "name").or_else(|| of("settings", "field")).unwrap()
}

fn near(measured: f64, expected: f64, what: &str) {
    assert!((measured - expected).abs() < 1e-6, "{what}: measured {measured}, the manifest has {expected}");
}

/// Angles of points about the axis, ascending, degrees from +y toward +x.
fn angles(points: &[(f64, f64)]) -> Vec<f64> {
    let mut all: Vec<f64> = points.iter().map(|(x, y)| libm::atan2(*x, *y).to_degrees()).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn mean_step(sorted: &[f64]) -> f64 {
    (sorted[sorted.len() - 1] - sorted[0]) / (sorted.len() - 1) as f64
}

/// The x of the vertical lines of a view.
fn levels(view: &[Entity]) -> Vec<f64> {
    let upright =
        view.iter().filter(|e| e.is("LINE", "VISIBLE") && (e.number(10) - e.number(11)).abs() < 1e-6);
    let mut all: Vec<f64> = upright.map(|e| e.number(10).abs()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    all
}

fn contains(levels: &[f64], expected: f64, what: &str) {
    assert!(levels.iter().any(|l| (l - expected).abs() < 1e-6), "{what}: {expected} is not in {levels:?}");
}

fn shell(blocks: &BTreeMap<String, Vec<Entity>>, manifest: &Value) {
    let front = &blocks["SHELL_FRONT"];
    let arcs: Vec<&Entity> = front.iter().filter(|e| e.is("ARC", "VISIBLE")).collect();
    let about_axis = |e: &&&Entity| libm::hypot(e.centre().0, e.centre().1) < 1e-6;
    let grooves: Vec<&&Entity> = arcs.iter().filter(|e| !about_axis(e) && e.sweep() > 120.0).collect();
    near(grooves.len() as f64, listed(manifest, "segment.grooves"), "number of grooves");
    let centres: Vec<(f64, f64)> = grooves.iter().map(|e| e.centre()).collect();
    near(mean_step(&angles(&centres)), listed(manifest, "groove_pitch"), "groove pitch");
    for groove in grooves {
        near(groove.number(40), listed(manifest, "segment.groove_radius_mm"), "groove radius");
        near(
            libm::hypot(groove.centre().0, groove.centre().1),
            listed(manifest, "shell.outer_radius_mm"),
            "groove centres",
        );
    }
    let radii: Vec<f64> = arcs.iter().filter(about_axis).map(|e| e.number(40)).collect();
    // The lands between grooves, and not the higher stops at both ends.
    let equal = |r: &f64| radii.iter().filter(|other| (*other - r).abs() < 1e-6).count();
    let lands = radii.iter().copied().max_by_key(equal).unwrap();
    assert!(equal(&lands) >= 10, "{radii:?}");
    near(lands, listed(manifest, "shell.outer_radius_mm"), "outer radius");
    near(
        radii.iter().copied().fold(f64::INFINITY, f64::min),
        listed(manifest, "inner_radius"),
        "inner radius",
    );
    let holes: Vec<&Entity> = front.iter().filter(|e| e.is("CIRCLE", "VISIBLE")).collect();
    near(holes.len() as f64, listed(manifest, "fasteners.count"), "number of holes");
    for hole in holes {
        near(2.0 * hole.number(40), listed(manifest, "fasteners.hole_diameter_mm"), "hole");
        near(
            libm::hypot(hole.centre().0, hole.centre().1),
            listed(manifest, "fastener_radius"),
            "radius of the holes",
        );
    }
    let section = levels(&blocks["SHELL_SECTION_A"]);
    near(section[section.len() - 1] - section[0], listed(manifest, "shell.width_mm"), "width");
}

fn support(blocks: &BTreeMap<String, Vec<Entity>>, manifest: &Value, name: &str) {
    let front = &blocks[&format!("{name}_FRONT")];
    let half = listed(manifest, "slot_width") / 2.0;
    // Round ends of slots are half circles.
    let ends: Vec<&Entity> =
        front.iter().filter(|e| e.is("ARC", "VISIBLE") && (e.sweep() - 180.0).abs() < 1e-6).collect();
    assert!(!ends.is_empty() && ends.len().is_multiple_of(2));
    let radius = |e: &&Entity| libm::hypot(e.centre().0, e.centre().1);
    let outermost = ends.iter().map(radius).fold(0.0, f64::max);
    let innermost = ends.iter().map(radius).fold(f64::INFINITY, f64::min);
    near(outermost, listed(manifest, "contact_radius"), "outer centres of the slots");
    near(outermost - innermost, listed(manifest, "slot_travel"), "travel");
    let outer: Vec<(f64, f64)> =
        ends.iter().filter(|e| (radius(e) - outermost).abs() < 1e-6).map(|e| e.centre()).collect();
    near(mean_step(&angles(&outer)), listed(manifest, "groove_pitch"), "angle between slots");
    ends.iter().for_each(|e| near(e.number(40), half, "half of the slot's width"));
    let outline = front.iter().filter(|e| e.is("ARC", "VISIBLE") && radius(e) < 1e-6);
    near(
        outline.map(|e| e.number(40)).fold(0.0, f64::max),
        listed(manifest, "support_radius"),
        "outer radius",
    );
    let section = levels(&blocks[&format!("{name}_SECTION_A")]);
    let plate = listed(manifest, "support.plate_mm");
    contains(&section, plate, "plate");
    contains(&section, plate - listed(manifest, "slot_depth"), "floor of the slot");
}

#[test]
fn the_drawing_has_the_dimensions_of_the_manifest() {
    for text in [
        "[layout]\npins = [5, 8, 11]\n",
        "[drawing]\nprojection = \"third\"\npaper = \"a3\"\n[shell]\nouter_radius_mm = 33.3\nwidth_mm = 21.0\n[segment]\n\
         grooves = 17\n[mould]\nkind = \"one-piece\"\n",
        "[shell]\nouter_radius_mm = 90.0\nwall_mm = 9.0\n[pins]\ndiameter_mm = 0.9\n[fasteners]\ncount = 4\n\
         hole_diameter_mm = 4.5\n[support]\nplate_mm = 4.0\n",
    ] {
        let built = built(text).unwrap();
        let prediction = Prediction::of(built.design());
        let set = Set::new(&built, &prediction, &named(&["drawing"]).unwrap()).unwrap();
        let file = |name: &str| set.files.iter().find(|f| f.name == name).unwrap().bytes.clone();
        let manifest: Value = serde_json::from_slice(&file("manifest.json")).unwrap();
        let blocks = read(std::str::from_utf8(&file("drawing.dxf")).unwrap());
        shell(&blocks, &manifest);
        support(&blocks, &manifest, "SUPPORT_LEFT");
        support(&blocks, &manifest, "SUPPORT_RIGHT");
        // In model space, main views are at 1:1.
        let inserts: Vec<&Entity> = blocks[""].iter().filter(|e| e.kind == "INSERT").collect();
        for insert in &inserts {
            assert!(blocks.contains_key(&insert.groups[&2]), "{insert:?}");
            let is_main = ["DETAIL", "ISOMETRIC", "EXPLODED"].iter().all(|w| !insert.groups[&2].contains(w));
            if is_main {
                near(insert.number(41), 1.0, "scale of a main view");
            }
        }
        assert!(inserts.iter().any(|i| i.groups[&2] == "SHELL_DETAIL_B" && i.number(41) > 1.5));
        assert!(file("drawing.pdf").starts_with(b"%PDF-"));
        assert!(file("drawing.svg").starts_with(b"<svg"));
    }
}
