//! Properties of every sheet: nothing overlaps, every dimension is there once, views are where the projection puts them, and
//! the DXF has the dimensions of the manifest.

mod complete;
mod fits;

mod measured;

use std::collections::BTreeMap;
use std::path::Path;

use rand::{RngExt as _, SeedableRng as _};

use super::sheets;
use crate::built::Built;
use crate::config::{self, Configuration};
use crate::design::Design;
use crate::templates::TEMPLATES;
use pinswitch_drafting::{Entity, Layer, Shape, Sheet, collisions, number};

/// Builds a configuration; `None` if it is invalid.
fn built(text: &str) -> Option<Built> {
    let (configuration, _) = config::read(text, "test.toml").ok()?;
    Built::new(Design::new(configuration).ok()?).ok()
}

/// Configurations of this repository: templates, golden ones, and the corpus.
fn known() -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> =
        TEMPLATES.iter().map(|t| (t.name.to_owned(), t.text.to_owned())).collect();
    for folder in ["golden", "corpus"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests").join(folder);
        let mut paths: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths.into_iter().filter(|p| p.extension().is_some_and(|e| e == "toml")) {
            let text = std::fs::read_to_string(&path).unwrap();
            if !text.starts_with("# refused") {
                all.push((path.file_stem().unwrap().to_string_lossy().into_owned(), text));
            }
        }
    }
    all
}

/// A random configuration; many are invalid.
fn random(seed: u64) -> String {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    let (radius, wall, span) = (between(12.0, 70.0), between(3.0, 12.0), between(30.0, 170.0));
    let (grooves, groove, margin) = (between(1.0, 22.0).floor(), between(0.4, 1.2), between(0.0, 3.0));
    let (width, thickness, pin) = (between(8.0, 40.0), between(1.2, 4.0), between(0.5, 2.0));
    let holes = between(0.0, 5.0).floor();
    let mut word = |words: &[&'static str]| words[between(0.0, words.len() as f64) as usize];
    let (slots, kind) = (word(&["all", "occupied"]), word(&["blind", "through"]));
    let (mould, paper, projection) =
        (word(&["split", "one-piece"]), word(&["a4", "a3"]), word(&["first", "third"]));
    format!(
        "[shell]\nouter_radius_mm = {radius:?}\nwall_mm = {wall:?}\nwidth_mm = {width:?}\n\
         [segment]\nspan_deg = {span:?}\ngrooves = {grooves}\ngroove_radius_mm = {groove:?}\nend_margin_mm = {margin:?}\n\
         [layout]\npins = [1]\nwrap_angle_deg = 20.0\n[silicone]\nthickness_mm = {thickness:?}\n\
         [pins]\ndiameter_mm = {pin:?}\n[support]\nslots = {slots:?}\nslot_kind = {kind:?}\n[mould]\nkind = {mould:?}\n\
         [fasteners]\ncount = {holes}\n[parts]\nguide_pulley = true\n[drawing]\npaper = {paper:?}\nprojection = {projection:?}\n"
    )
}

/// Faults of the sheets of a set.
fn faults(name: &str, built: &Built) -> Vec<String> {
    let sheets = sheets(built);
    let mut faults = Vec::new();
    let mut fault = |sheet: &str, text: String| faults.push(format!("{name}, {sheet}: {text}"));
    let mut expected: Vec<String> = vec!["assembly".to_owned()];
    expected.extend(built.printed().iter().map(|p| p.part().name.clone()));
    for part in expected {
        if !sheets.iter().any(|s| s.name == part) {
            fault(&part, "no sheet".to_owned());
        }
    }
    for sheet in &sheets {
        for c in collisions(sheet) {
            fault(&sheet.name, format!("{} on {} at {:?}", c.what, c.with, c.at));
        }
        let mut keys: BTreeMap<&str, usize> = BTreeMap::new();
        for a in &sheet.annotations {
            *keys.entry(&a.key).or_default() += 1;
        }
        for (key, text) in required(built, &sheet.name) {
            match keys.get(key.as_str()) {
                Some(1) if text_of(sheet, &key).contains(&text) => {}
                Some(1) => fault(&sheet.name, format!("{key} is {:?}, not {text}", text_of(sheet, &key))),
                other => fault(&sheet.name, format!("{key} occurs {} times", other.unwrap_or(&0))),
            }
        }
        for (key, times) in keys {
            // Each row of a table has the key of its table.
            if times > 1 && !["bill of materials", "places of the holes"].contains(&key) {
                fault(&sheet.name, format!("{key} occurs {times} times"));
            }
        }
    }
    faults
}

fn text_of(sheet: &Sheet, key: &str) -> String {
    sheet.annotations.iter().find(|a| a.key == key).map_or_else(String::new, |a| a.text.clone())
}

/// Dimensions that a part needs, from its design and not from its solid: key and text.
fn required(built: &Built, part: &str) -> Vec<(String, String)> {
    let d = built.design();
    let c = d.configuration();
    let mut all: Vec<(String, String)> = Vec::new();
    let mut add = |key: String, text: String| all.push((key, text));
    let radius = |r: f64| (format!("radius {}", number(r)), format!("R{}", number(r)));
    let is_grooved = matches!(part, "shell" | "proxy" | "silicone-layer");
    let is_support = matches!(part, "support-left" | "support-right");
    if is_grooved || is_support {
        add("span".to_owned(), format!("{}\u{b0}", number(c.segment.span_deg)));
    }
    if c.fasteners.count > 0 && (part == "shell" || is_support) {
        add("hole 1".to_owned(), format!("on R{}", number(d.fastener_radius_mm())));
        for text in required_of_holes(d, part) {
            add("hole 1".to_owned(), text);
        }
    }
    if is_grooved {
        let (inner, outer) = if part == "shell" {
            (d.inner_radius_mm(), d.shell_radius_mm())
        } else {
            (d.shell_radius_mm(), d.contact_radius_mm())
        };
        let (key, text) = radius(inner);
        add(key, text);
        let (key, text) = radius(outer);
        add(key, text);
        let n = if c.segment.grooves == 1 { String::new() } else { format!("{} \u{d7} ", c.segment.grooves) };
        add("groove".to_owned(), format!("{n}groove R{}", number(c.segment.groove_radius_mm)));
        if c.segment.grooves > 2 {
            let steps = c.segment.grooves - 1;
            add("groove pitch".to_owned(), format!("{steps} \u{d7} {}\u{b0}", number(d.pitch_deg())));
        }
        let height = if part == "shell" { c.shell.width_mm } else { d.layer_width_mm() };
        add("overall height".to_owned(), number(height));
    }
    if is_support && !d.slot_angles_rad().is_empty() {
        add("slot width".to_owned(), format!("{} +0.1/0", number(d.slot().width_mm)));
        add("slot travel".to_owned(), number(d.slot().outer_mm - d.slot().inner_mm));
        add("slot".to_owned(), format!("outer centres on R{}", number(d.contact_radius_mm())));
        let (key, text) = radius(d.support_radius_mm());
        add(key, text);
    }
    if part == "pin" {
        add(
            "round 1".to_owned(),
            format!("\u{d8}{} \u{b1}{}", number(c.pins.diameter_mm), number(c.pins.tolerance_mm)),
        );
        add("overall height".to_owned(), number(d.pin_length_mm()));
    }
    if part == "mould-tray" {
        add("height ".to_owned() + &number(c.mould.floor_mm), number(c.mould.floor_mm));
    }
    all
}

/// Texts of the holes for screws in shell and supports.
fn required_of_holes(d: &Design, part: &str) -> Vec<String> {
    let c = d.configuration();
    let n = if c.fasteners.count == 1 { String::new() } else { format!("{} \u{d7} ", c.fasteners.count) };
    let thread = crate::documents::bill_of_materials(d).fasteners.unwrap().thread;
    let diameter = number(c.fasteners.hole_diameter_mm);
    let grade = crate::design::clearance_grade(Some(thread), c.fasteners.hole_diameter_mm);
    let fastening = d.fastening();
    let has_heads = part == "support-left" || fastening.insert_mm.is_some();
    let is_covered = part == "support-left" && c.mount.kind != config::MountKind::None;
    match (part, fastening.insert_mm, fastening.recess(has_heads)) {
        ("shell", Some([bore, length]), _) => vec![
            format!("{n}\u{d8}{} +0.1/0, {} deep, both faces", number(bore), number(length)),
            format!("for heat-set insert {thread}"),
            format!("\u{d8}{diameter} {grade} between them"),
        ],
        (_, _, Some(recess)) if part != "shell" && !is_covered => {
            let word = if recess.is_hexagon { "hexagon AF " } else { "\u{d8}" };
            let depth = number(recess.depth_mm);
            let rest = c.support.plate_mm - recess.depth_mm - d.membrane_mm();
            vec![
                format!("{n}{word}{} +0.2/0, {depth} deep, far face", number(2.0 * recess.radial_mm)),
                format!("web {} above it", number(d.membrane_mm())),
                format!("\u{d8}{diameter} {grade}, {} deep, near face, for {thread}", number(rest)),
            ]
        }
        _ => vec![format!("{n}\u{d8}{diameter} {grade} through, for {thread}")],
    }
}

#[test]
fn dimensions_are_unique_and_do_not_overlap() {
    let mut drawn = 0;
    let mut all = Vec::new();
    for (name, text) in known() {
        let Some(built) = built(&text) else { continue };
        all.extend(faults(&name, &built));
        drawn += 1;
    }
    assert!(drawn >= 35, "only {drawn} configurations were drawn");
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn random_sheets_do_not_overlap() {
    let mut drawn = 0;
    let mut all = Vec::new();
    for seed in 0..60 {
        let Some(built) = built(&random(seed)) else { continue };
        all.extend(faults(&format!("seed {seed}"), &built));
        drawn += 1;
        if drawn == 10 {
            break;
        }
    }
    assert!(drawn >= 8, "only {drawn} configurations were drawn");
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// The sheet of the assembly has an isometric and an exploded view, overall dimensions and the wrap.
#[test]
fn assemblies_have_pictures_and_sizes() {
    for mount in ["", "[mount]\nkind = \"flange\"\n", "[mount]\nkind = \"rig\"\n"] {
        let built = built(&format!("[layout]\npins = [5, 8, 11]\n{mount}")).unwrap();
        let assembly = &sheets(&built)[0];
        for (view, title) in [("ISOMETRIC", "isometric view"), ("EXPLODED", "exploded view")] {
            let lines = points(assembly, view);
            assert!(lines.len() > 100, "{mount}: {view} has {} points", lines.len());
            assert!(text_of(assembly, title).contains(':'), "{mount}: {title} has a scale");
        }
        let width = |view| ends(&points(assembly, view), 0).1 - ends(&points(assembly, view), 0).0;
        let scale = |view: &str| assembly.views.iter().find(|v| v.name == view).unwrap().scale;
        let exploded = width("EXPLODED") / scale("EXPLODED");
        assert!(exploded > 1.2 * width("ISOMETRIC") / scale("ISOMETRIC"), "{mount}: {exploded} mm");
        for (key, text) in [("wrap angle", "wrap 63.89\u{b0}"), ("contact radius", "contact R22")] {
            assert!(
                [text_of(assembly, key), text_of(assembly, "wrap")].iter().any(|t| t.contains(text)),
                "{mount}: {key}"
            );
        }
        for key in ["overall width", "overall length", "overall height"] {
            assert_ne!(text_of(assembly, key), "", "{mount}: {key}");
        }
    }
}

/// The longest side of a plate is along the paper, and its holes keep their fits.
#[test]
fn plates_are_square_to_the_sheet() {
    for (mount, part) in [("kind = \"rig\"\n", "rig-plate"), ("kind = \"joint\"\n", "link-proximal")] {
        let built = built(&format!("[layout]\npins = [5, 8, 11]\n[mount]\n{mount}")).unwrap();
        let all = sheets(&built);
        let sheet = all.iter().find(|s| s.name == part).unwrap();
        let front = sheet.views.iter().position(|v| v.name == "FRONT");
        let lines = sheet.entities.iter().filter(|e| e.view == front && e.layer == Layer::Visible);
        let longest = lines
            .filter_map(|e| if let Shape::Line { from, to } = e.shape { Some(to - from) } else { None })
            .max_by(|a, b| a.length().total_cmp(&b.length()))
            .unwrap();
        assert!(longest.y.abs() < 1e-6 && longest.x.abs() > 1.0, "{part}: {longest:?}");
        assert!(
            sheet.annotations.iter().any(|a| a.key.starts_with("hole") && a.text.contains("for ")),
            "{part}"
        );
    }
}

/// The tolerances of the chain from dimensions to threshold are those of the sheets.
#[test]
fn sheets_have_the_tolerances_of_the_chain() {
    use crate::tolerances::{ChainDimension, link};
    let built = built("[layout]\npins = [5, 8, 11]\n").unwrap();
    let all = sheets(&built);
    let of = |part: &str, key: &str| text_of(all.iter().find(|s| s.name == part).unwrap(), key);
    let drawing = |dimension| link(built.design(), dimension).drawing;
    let plus_minus = |tolerance: f64| format!("\u{b1}{}", number((100.0 * tolerance + 1e-9).floor() / 100.0));
    let thickness = drawing(ChainDimension::LayerThickness);
    assert_eq!(of("silicone-layer", "layer thickness"), format!("2 {}", plus_minus(thickness)));
    assert_eq!(of("silicone-layer", "radius 22"), "(R22)", "it follows from the thickness");
    for (part, key) in [("mould-core", "radius 20"), ("mould-ring", "radius 22")] {
        assert!(of(part, key).ends_with(&plus_minus(thickness / 2.0)), "{part}: {}", of(part, key));
    }
    let width = plus_minus(drawing(ChainDimension::LayerWidth));
    assert!(of("silicone-layer", "overall height").ends_with(&width));
    assert!(of("shell", "radius 20").ends_with(&plus_minus(drawing(ChainDimension::ShellRadius))));
    let position = |dimension| format!("position {} A", number(2.0 * drawing(dimension)));
    let groove = position(ChainDimension::GroovePosition);
    for part in ["silicone-layer", "mould-ring", "shell"] {
        assert!(of(part, "groove").contains(&groove), "{part}: {}", of(part, "groove"));
    }
    for part in ["support-left", "support-right"] {
        assert!(
            of(part, "slot").contains(&(position(ChainDimension::SlotPosition) + " B")),
            "{}",
            of(part, "slot")
        );
        assert!(of(part, "hole 1").ends_with("position \u{d8}0.2 A\ndatum B"), "{}", of(part, "hole 1"));
        assert_eq!(of(part, "datum A"), "A");
    }
    // Groove and slot together leave the pin free.
    let zones = drawing(ChainDimension::GroovePosition) + drawing(ChainDimension::SlotPosition);
    assert!(2.0 * zones <= built.design().configuration().support.slot_clearance_mm + 1e-9);
}

/// All points of a view's lines.
fn points(sheet: &Sheet, view: &str) -> Vec<[f64; 2]> {
    let number = sheet.views.iter().position(|v| v.name == view).unwrap();
    sheet
        .entities
        .iter()
        .filter(|e| e.view == Some(number))
        .flat_map(|e| match &e.shape {
            Shape::Line { from, to } => vec![[from.x, from.y], [to.x, to.y]],
            other => other.pieces().iter().map(|p| [p[0].x, p[0].y]).collect(),
        })
        .collect()
}

fn ends(points: &[[f64; 2]], axis: usize) -> (f64, f64) {
    points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[axis]), h.max(p[axis])))
}

/// In first angle, the view from the left is on the right, with its near side away from the front view. In third angle, it is the
/// other way round.
#[test]
fn the_projection_arranges_the_views() {
    for (word, is_first) in [("first", true), ("third", false)] {
        let text = format!("[layout]\npins = [5, 8, 11]\n[drawing]\nprojection = {word:?}\n");
        let all = sheets(&built(&text).unwrap());
        let sheet = all.iter().find(|s| s.name == "support-left").unwrap();
        let [front, above, section] = ["FRONT", "ABOVE", "SECTION_A"].map(|view| points(sheet, view));
        let (front_x, front_y) = (ends(&front, 0), ends(&front, 1));
        let (above_y, section_x) = (ends(&above, 1), ends(&section, 0));
        assert!(section_x.0 > front_x.1, "the side view is on the right");
        assert_eq!(above_y.1 < front_y.0, is_first, "the view from above is below in first angle only");
        // Round corners are chords here.
        assert!((ends(&above, 0).0 - front_x.0).abs() < 0.1, "the view from above is aligned");
        assert!((ends(&section, 1).0 - front_y.0).abs() < 1.0, "the side view is aligned");
        // The lip is on the face in the front view: there the section is wider than at its foot.
        let foot: Vec<[f64; 2]> = section.iter().copied().filter(|p| p[1] < front_y.0 + 4.0).collect();
        let (plate, whole) = (ends(&foot, 0), section_x);
        let reaches = (plate.0 - whole.0, whole.1 - plate.1);
        let lip_is_far = reaches.1 > reaches.0 + 1.0;
        assert_eq!(lip_is_far, is_first, "{reaches:?}");
        // In the view from above, the lip is shorter than the plate.
        let wide = |y: f64| {
            let at: Vec<[f64; 2]> = above.iter().copied().filter(|p| (p[1] - y).abs() < 0.01).collect();
            let (low, high) = ends(&at, 0);
            high - low
        };
        let (lower, upper) = (wide(above_y.0), wide(above_y.1));
        assert!(lower < upper - 2.0, "z grows downward in the view from above: {lower} {upper}");
    }
}

/// Crowded lines are thinned equally on both supports, at any scale.
#[test]
fn supports_are_symmetric_from_above() {
    let wide = "[segment]\nspan_deg = 160.0\n[layout]\npins = [8]\nwrap_angle_deg = 140.0\n[shell]\nouter_radius_mm = 30.0\n";
    for text in ["[layout]\npins = [8]\n", wide] {
        let all = sheets(&built(text).unwrap());
        let view = all[0].views.iter().position(|v| v.name == "ABOVE");
        let lines = all[0].entities.iter().filter(|e| e.view == view);
        let level = |e: &Entity| match &e.shape {
            Shape::Line { from, to } if (from.y - to.y).abs() < 1e-6 && (from.x - to.x).abs() > 20.0 => {
                Some(from.y)
            }
            _ => None,
        };
        let levels: Vec<f64> = lines.filter_map(level).collect();
        let ends = levels.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(*y), h.max(*y)));
        let has = |y: f64| levels.iter().any(|other| (other - y).abs() < 1e-3);
        assert!(levels.len() >= 6, "{text}: {levels:?}");
        // The tendon between them is not symmetric.
        let middle = f64::midpoint(ends.0, ends.1);
        let mut of_supports = levels.iter().filter(|y| (*y - middle).abs() > 2.0 * all[0].scale);
        assert!(of_supports.all(|y| has(2.0 * middle - y)), "{text}: {levels:?}");
    }
}

#[test]
fn a_date_is_optional() {
    let dated = |date: &str| {
        let text = format!("[drawing]\ndate = {date:?}\n");
        let all = sheets(&built(&text).unwrap());
        all.iter()
            .flat_map(|s| &s.entities)
            .filter_map(|e| if let Shape::Text(t) = &e.shape { Some(t.content.clone()) } else { None })
            .filter(|t| t == "2026-01-31")
            .count()
    };
    assert_eq!(dated(""), 0);
    // On every sheet.
    let sheets_of = sheets(&Built::new(Design::new(Configuration::default()).unwrap()).unwrap()).len();
    assert_eq!(dated("2026-01-31"), sheets_of);
}

#[test]
fn large_parts_have_larger_paper() {
    let paper = |text: &str, part: &str| {
        let all = sheets(&built(text).unwrap());
        all.iter().find(|s| s.name == part).map(|s| (s.paper.name(), s.scale)).unwrap()
    };
    assert_eq!(paper("", "shell"), ("A4", 2.0));
    assert_eq!(paper("[drawing]\npaper = \"a3\"\n", "shell").0, "A3");
    assert_eq!(paper("[shell]\nouter_radius_mm = 140.0\nwall_mm = 9.0\n", "shell").0, "A3");
}

#[test]
fn sheath_stops_have_no_dimensions_in_notes() {
    let built = built("[mount]\nkind = \"rig\"\n[tendon]\nsheath_diameter_mm = 4.0\n").unwrap();
    let sheets = sheets(&built);
    let words = |name: &str| {
        let sheet = sheets.iter().find(|s| s.name == name).unwrap();
        let texts = sheet.entities.iter().filter_map(|e| match &e.shape {
            Shape::Text(text) => Some(text.content.as_str()),
            _ => None,
        });
        texts.collect::<Vec<_>>().join("|")
    };
    assert!(!words("sheath-stop").contains("from the left side"), "{}", words("sheath-stop"));
    // Only outlines of lines and arcs have the note about them.
    let note = "Outline: lines tangent to the arcs";
    assert!(words("rig-plate").contains(note));
    assert!(!words("pulley-spacer").contains(note) && !words("guide-pulley").contains(note));
}

#[test]
fn rigs_are_drawn_at_half_scale() {
    for more in ["", "pulley_distance_mm = 100.0\n", "[tendon]\nsheath_diameter_mm = 4.0\n"] {
        for projection in ["first", "third"] {
            let text = format!(
                "[drawing]\nprojection = \"{projection}\"\n[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n{more}"
            );
            let built = built(&text).unwrap();
            let assembly = &sheets(&built)[0];
            assert!(assembly.scale >= 0.5, "{text}: {}", assembly.scale);
            // The parts list is complete, in one column or two.
            let listed = assembly.annotations.iter().filter(|a| a.key == "bill of materials");
            let rows = listed.filter(|a| !a.text.starts_with("Item")).count();
            assert_eq!(rows, super::parts_list::items(&built).len(), "{text}");
        }
    }
}

/// Length of a layer in the front view of the assembly, mm.
fn drawn_mm(text: &str, layer: Layer) -> f64 {
    let assembly = &sheets(&built(text).unwrap())[0];
    let front = assembly.views.iter().position(|v| v.name == "FRONT");
    let lines = assembly.entities.iter().filter(|e| e.view == front && e.layer == layer);
    let length = |e: &Entity| e.shape.pieces().iter().map(|[a, b]| (*a - *b).length()).sum::<f64>();
    lines.map(length).sum::<f64>() / assembly.scale
}

#[test]
fn a_flange_is_hidden_under_the_switch() {
    let (bare, flange) =
        ("[layout]\npins = [5, 8, 11]\n", "[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"flange\"\n");
    // The outline of the flange and its four holes.
    let visible = drawn_mm(flange, Layer::Visible) - drawn_mm(bare, Layer::Visible);
    assert!(visible > 4.0 * 4.5 * 3.0 + 100.0, "{visible} mm");
    let hidden = drawn_mm(flange, Layer::Hidden) - drawn_mm(bare, Layer::Hidden);
    assert!(hidden > 0.0 && hidden < visible, "{hidden} mm");
}
