//! A sheet has every dimension of its part, and none twice. The required dimensions are read from the contours of the exact
//! solid, independently of the features of `pinswitch_drafting`.

use std::collections::{BTreeMap, BTreeSet};

use super::super::part_sheet::drawn_solid;
use super::{built, known};
use crate::built::Built;
use crate::parts::Part;
use pinswitch_drafting::{Shape, Sheet, hexagon, lettering, number, same};
use pinswitch_solid::profile::{Contour, Edge, Point2};
use std::f64::consts::PI;

/// All texts on a sheet without its title block.
pub(super) fn texts(sheet: &Sheet) -> Vec<String> {
    let content = sheet.entities.iter().filter(|e| e.group >= sheet.first_group);
    content
        .filter_map(|e| if let Shape::Text(t) = &e.shape { Some(t.content.clone()) } else { None })
        .collect()
}

/// All numbers on a sheet, without signs, as written.
fn numbers(sheet: &Sheet) -> BTreeSet<String> {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    texts(sheet)
        .iter()
        .flat_map(|t| t.split(|c: char| !is_part(c)).map(str::to_owned).collect::<Vec<_>>())
        .filter(|t| !t.is_empty())
        .collect()
}

/// Looks for the dimensions of contours on a sheet.
struct Reader<'a> {
    numbers: BTreeSet<String>,
    table: Vec<Vec<String>>,
    bounds: (Point2, Point2),
    levels: Vec<f64>,
    is_axial: bool,
    is_round: bool,
    missing: Vec<String>,
    sheet: &'a Sheet,
}

impl Reader<'_> {
    fn has(&self, value: f64) -> bool {
        // A value between two roundings may be written as either.
        let shown = |by: f64| self.numbers.contains(&number(value.abs() + by));
        same(value, 0.0) || [0.0, 1e-9, -1e-9].into_iter().any(shown)
    }

    fn require(&mut self, what: &str, ways: &[f64]) {
        if !ways.iter().any(|w| self.has(*w)) {
            let ways: Vec<String> = ways.iter().map(|w| number(*w)).collect();
            self.missing.push(format!("{}: {what} {}", self.sheet.name, ways.join(" or ")));
        }
    }

    /// Requires the position of a hole: in the hole table, from the first hole, on a plate.
    fn place(&mut self, at: Point2, origin: Option<Point2>) {
        if self.is_round {
            return;
        }
        if self.is_axial {
            self.require("radius of a place", &[at.coords.norm()]);
            let angle = libm::atan2(at.x, at.y).to_degrees();
            let is_stepped = texts(self.sheet).iter().any(|t| t.contains(" \u{d7} ") && t.contains('\u{b0}'));
            if !is_stepped {
                self.require("angle of a place", &[angle]);
            }
        } else if let Some(origin) = origin {
            let row = [number(at.x - origin.x), number(at.y - origin.y)];
            if !self.table.iter().any(|r| r[1..] == row) {
                self.missing.push(format!("{}: a hole at {row:?} is not in the table", self.sheet.name));
            }
        } else {
            let (low, high) = self.bounds;
            let middle = nalgebra::center(&low, &high);
            self.require("place along", &[at.x - low.x, 2.0 * (at.x - middle.x)]);
            self.require("place across", &[at.y - low.y, 2.0 * (at.y - middle.y)]);
        }
    }

    fn height(&mut self, z: f64) {
        let ways: Vec<f64> = self.levels.iter().map(|other| z - other).filter(|d| !same(*d, 0.0)).collect();
        self.require("height", &ways);
    }

    fn outline(&mut self, contour: &Contour) {
        let arcs: Vec<_> = contour
            .edges()
            .iter()
            .filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None })
            .collect();
        match (contour.edges().len(), &arcs[..]) {
            // A slot with round ends.
            (4, [a, b]) if (a.sweep_rad.abs() - PI).abs() < 1e-6 && (b.sweep_rad.abs() - PI).abs() < 1e-6 => {
                self.require("width", &[2.0 * a.radius_mm]);
                self.require("travel", &[(a.centre - b.centre).norm()]);
            }
            // A slot along an arc.
            (4, [_, _, _, _]) => {
                let mut radii: Vec<f64> = arcs.iter().map(|a| a.radius_mm).collect();
                radii.sort_by(f64::total_cmp);
                self.require("width", &[radii[3] - radii[2]]);
                self.require("radius", &[f64::midpoint(radii[3], radii[2])]);
            }
            _ => self.edges(contour),
        }
    }

    fn edges(&mut self, contour: &Contour) {
        for (i, edge) in contour.edges().iter().enumerate() {
            let (from, to) = contour.ends(i);
            match edge {
                Edge::Arc(arc) => {
                    self.require("radius", &[arc.radius_mm, 2.0 * arc.radius_mm]);
                }
                Edge::Line if !self.is_axial && !self.is_round => {
                    let (low, high) = self.bounds;
                    let middle = nalgebra::center(&low, &high);
                    if same(from.x, to.x) {
                        self.require("x", &[from.x - low.x, high.x - from.x, 2.0 * (from.x - middle.x)]);
                    }
                    if same(from.y, to.y) {
                        self.require("y", &[from.y - low.y, high.y - from.y, 2.0 * (from.y - middle.y)]);
                    }
                }
                Edge::Line => {}
            }
        }
    }
}

fn is_circle(c: &Contour) -> Option<(Point2, f64)> {
    let arcs: Vec<_> =
        c.edges().iter().filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None }).collect();
    match arcs[..] {
        [a, b] if c.edges().len() == 2 && (a.centre - b.centre).norm() < 1e-6 => {
            Some((a.centre, a.radius_mm))
        }
        _ => None,
    }
}

fn is_moved(a: &Contour, b: &Contour) -> bool {
    let (a, b) = (a.corners(), b.corners());
    a.len() == b.len() && a.iter().zip(b).all(|(p, q)| (p - q - (a[0] - b[0])).norm() < 1e-6)
}

/// Returns the dimensions that the sheet of a part does not have.
fn missing_dimensions(part: &Part, sheet: &Sheet, chamfer_mm: f64) -> Vec<String> {
    let solid = &drawn_solid(part).0;
    let (low, high) = solid.bounds().unwrap();
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let letters = lettering(solid);
    let feet: Vec<usize> = solid
        .walls()
        .filter(|(a, b)| rings[*a].0 != rings[*b].0 && same(rings[*b].1 - rings[*a].1, chamfer_mm))
        .map(|(a, _)| a)
        .collect();
    let shown: Vec<(&Contour, f64)> =
        (0..rings.len()).filter(|i| !letters[*i] && !feet.contains(i)).map(|i| rings[i]).collect();
    let outer = shown.iter().max_by(|a, b| a.0.area_mm2().total_cmp(&b.0.area_mm2())).unwrap();
    let about_axis =
        |c: &Contour| c.edges().iter().any(|e| matches!(e, Edge::Arc(a) if a.centre.coords.norm() < 1e-6));
    let is_round = is_circle(outer.0).is_some();
    let rows = sheet.annotations.iter().filter(|a| a.key == "places of the holes");
    let table: Vec<Vec<String>> =
        rows.map(|a| a.text.split('\t').map(str::to_owned).collect()).skip(1).collect();
    let mut reader = Reader {
        numbers: numbers(sheet),
        bounds: (Point2::new(low.x, low.y), Point2::new(high.x, high.y)),
        levels: rings.iter().map(|r| r.1).collect(),
        is_axial: !is_round && shown.iter().any(|r| about_axis(r.0)),
        is_round,
        missing: Vec::new(),
        table,
        sheet,
    };
    // The hole from which the others are measured.
    let centres: Vec<Point2> = shown.iter().filter_map(|r| is_circle(r.0)).map(|c| c.0).collect();
    let origin = centres.iter().copied().find(|o| {
        let rows: Vec<[String; 2]> = centres.iter().map(|p| [number(p.x - o.x), number(p.y - o.y)]).collect();
        !reader.table.is_empty() && rows.iter().all(|r| reader.table.iter().any(|t| t[1..] == *r))
    });
    if !reader.table.is_empty() && origin.is_none() {
        reader.missing.push(format!("{}: the table does not have all holes", sheet.name));
    }
    let mut seen: Vec<&Contour> = Vec::new();
    for (contour, z) in shown {
        if !same(z, low.z) && !same(z, low.z + chamfer_mm) {
            reader.height(z);
        }
        if seen.contains(&contour) || seen.iter().any(|s| s.edges().len() > 6 && is_moved(s, contour)) {
            continue;
        }
        seen.push(contour);
        if let Some((centre, radius)) = is_circle(contour) {
            reader.require("diameter", &[2.0 * radius]);
            reader.place(centre, origin);
        } else if let Some((centre, half)) = hexagon(contour) {
            reader.require("width across flats", &[2.0 * half]);
            reader.place(centre, origin);
        } else {
            reader.outline(contour);
        }
    }
    reader.missing.sort();
    reader.missing.dedup();
    reader.missing
}

/// Dimensions that occur twice on a sheet.
fn repeated(sheet: &Sheet) -> Vec<String> {
    let mut times: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let is_name =
        |key: &str| ["mark of", "title of", "section title", "places of"].iter().any(|w| key.starts_with(w));
    for a in sheet.annotations.iter().filter(|a| !is_name(&a.key)) {
        times.entry(&a.text).or_default().push(&a.key);
    }
    times.retain(|_, keys| keys.len() > 1);
    times.into_iter().map(|(text, keys)| format!("{}: {text:?} has the keys {keys:?}", sheet.name)).collect()
}

fn faults(name: &str, built: &Built) -> Vec<String> {
    let chamfer_mm = built.design().configuration().print.elephant_foot_mm;
    let sheets = super::sheets(built);
    let mut all = Vec::new();
    for part in built.printed().iter().map(|p| p.part()) {
        let Some(sheet) = sheets.iter().find(|s| s.name == part.name) else { continue };
        all.extend(missing_dimensions(part, sheet, chamfer_mm));
        all.extend(repeated(sheet));
    }
    all.into_iter().map(|f| format!("{name}, {f}")).collect()
}

#[test]
fn every_contour_is_dimensioned_once() {
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

/// A hole is `through` if it is open from face to face.
#[test]
fn through_holes_are_open() {
    let text_of_hole = |text: &str, part: &str| {
        let built = built(text).unwrap();
        let all = super::sheets(&built);
        let sheet = all.iter().find(|s| s.name == part).unwrap();
        super::text_of(sheet, "hole 1")
    };
    let trap = text_of_hole("[layout]\npins = [5, 8, 11]\n", "support-right");
    for words in ["hexagon AF 5.7", "far face", "web 0.4", "near face, for M3"] {
        assert!(trap.contains(words), "{words} is not in {trap:?}");
    }
    assert!(!trap.contains("through"), "{trap}");
    let screw = text_of_hole("[layout]\npins = [5, 8, 11]\n[fasteners]\nkind = \"screw\"\n", "support-right");
    assert!(screw.contains("H13 through, for M3"), "{screw}");
    let insert = text_of_hole("[layout]\npins = [5, 8, 11]\n[fasteners]\nkind = \"insert\"\n", "shell");
    assert!(
        insert.contains("2 \u{d7} \u{d8}4 +0.1/0, 5.7 deep, both faces\nfor heat-set insert M3"),
        "{insert}"
    );
    assert_eq!(insert.matches("33.635").count(), 1, "{insert}");
}

/// A label that is left out is not in the note about engravings.
#[test]
fn omitted_labels_are_not_engraved() {
    let mut left_out = 0;
    for (name, text) in known() {
        let Some(built) = built(&text) else { continue };
        for sheet in super::sheets(&built) {
            let all = texts(&sheet).join(" ");
            for label in all.split("the label \"").skip(1).filter_map(|t| t.split('"').next()) {
                let engraved = all.split("Engraved").nth(1).unwrap_or("");
                let engraved = engraved.split(" deep").next().unwrap_or("");
                assert!(!engraved.contains(label), "{name}, {}: {all}", sheet.name);
                left_out += 1;
            }
        }
    }
    assert!(left_out > 0, "no label was left out");
}

/// A workshop does not know the parameters of the program.
#[test]
fn sheets_do_not_mention_parameters() {
    let mut noted = 0;
    for (name, text) in known() {
        let Some(built) = built(&text) else { continue };
        for sheet in super::sheets(&built) {
            let all = texts(&sheet).join(" ");
            noted += usize::from(all.contains("is left out") || all.contains("are left out"));
            for word in all.split_whitespace() {
                let (table, field) = word.split_once('.').unwrap_or(("", ""));
                let is_word = |w: &str| w.chars().next().is_some_and(|c| c.is_ascii_lowercase());
                let is_parameter = is_word(table) && is_word(field);
                assert!(!is_parameter, "{name}, {}: {word:?} in {all}", sheet.name);
            }
        }
    }
    assert!(noted > 0, "nothing was left out");
}

/// The lengths of a coupon are dimensions, and not notes.
#[test]
fn coupons_are_dimensioned_in_their_views() {
    let built = built("").unwrap();
    let all = super::sheets(&built);
    let coupon = all.iter().find(|s| s.name == "coupon").unwrap();
    for (key, text) in [("length", "54.5"), ("width", "13.25"), ("overall height", "3")] {
        assert_eq!(super::text_of(coupon, key), text);
    }
    for row in ["slots", "grooves"] {
        for key in [format!("first of the {row}"), format!("pitch of the {row}")] {
            assert_ne!(super::text_of(coupon, &key), "", "{key}");
        }
    }
    let slots = super::text_of(coupon, "slots");
    assert!(slots.starts_with("7 \u{d7} slot, widths from the left\n1.04, 1.09, 1.14"), "{slots}");
}

/// Sheets of the assembly, and of parts with a label, have the grooves with pins.
#[test]
fn sheets_list_grooves_with_pins() {
    let built = built("[layout]\npins = [4, 5, 11]\n").unwrap();
    let all = super::sheets(&built);
    for name in ["assembly", "shell", "support-right"] {
        let words = texts(all.iter().find(|s| s.name == name).unwrap()).join("|");
        assert!(words.contains("Layout 3 of 15: 4 5 11"), "{name}: {words}");
    }
}
