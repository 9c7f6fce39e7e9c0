//! One basin of a gang mould is dimensioned, and no line of a dimension crosses another basin.

use std::collections::BTreeSet;

use super::built;
use super::complete::is_moved;
use crate::config::MouldKind;
use pinswitch_drafting::{Layer, Point, Shape, Sheet, same};
use pinswitch_solid::profile::{Contour, Vector2};
use pinswitch_solid::solid::Solid;

/// Number of the pockets of a mould, and the step from each to the next.
fn pockets(solid: &Solid) -> (usize, Vector2) {
    let pockets = solid.rings().map(|(contour, _)| contour);
    let pockets: Vec<&Contour> = pockets.filter(|c| c.area_mm2() < 0.0 && c.edges().len() > 6).collect();
    let equal = pockets.iter().filter(|p| is_moved(p, pockets[0]));
    let mut steps: Vec<Vector2> = equal.map(|p| p.corners()[0] - pockets[0].corners()[0]).collect();
    steps.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    steps.dedup_by(|a, b| same((*a - *b).norm(), 0.0));
    (steps.len(), steps[1])
}

/// Returns whether two lines cross.
fn cross([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |p: Point, q: Point, r: Point| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    side(a, b, c) * side(a, b, d) < -1e-6 && side(c, d, a) * side(c, d, b) < -1e-6
}

/// The edges of each basin on paper.
fn basins(sheet: &Sheet, step: Point, number: usize) -> Vec<Vec<[Point; 2]>> {
    let front = sheet.views.iter().position(|v| v.name == "FRONT").unwrap();
    let curves = sheet.entities.iter().filter(|e| e.view == Some(front) && e.layer == Layer::Visible);
    let curves: Vec<&Shape> = curves.map(|e| &e.shape).collect();
    let is_moved = |a: &Shape, b: &Shape, by: Point| {
        let near = |p: Point, q: Point| (p + by - q).length() < 1e-6;
        let (p, q) = (a.pieces(), b.pieces());
        p.len() == q.len() && p.iter().zip(&q).all(|(p, q)| near(p[0], q[0]) && near(p[1], q[1]))
    };
    // An edge that occurs once for each basin, a step apart, is an edge of a basin.
    let mut all = vec![Vec::new(); number];
    for first in &curves {
        let copies: Vec<&&Shape> =
            (0..number).filter_map(|i| curves.iter().find(|c| is_moved(first, c, step * i as f64))).collect();
        if copies.len() == number {
            for (i, copy) in copies.into_iter().enumerate() {
                all[i].extend(copy.pieces());
            }
        }
    }
    all
}

/// Dimensions whose lines cross the edges of two basins.
fn crossing(sheet: &Sheet, basins: &[Vec<[Point; 2]>]) -> Vec<String> {
    let mut all = Vec::new();
    for a in &sheet.annotations {
        let lines = sheet.entities.iter().filter(|e| e.group == a.group && e.layer == Layer::Dimension);
        let pieces: Vec<[Point; 2]> = lines.flat_map(|e| e.shape.pieces()).collect();
        let meets = |edges: &Vec<[Point; 2]>| edges.iter().any(|e| pieces.iter().any(|p| cross(*e, *p)));
        let crossed: BTreeSet<usize> =
            (0..basins.len()).filter(|i| basins.get(*i).is_some_and(meets)).collect();
        if crossed.len() > 1 || crossed.iter().any(|i| *i > 0 && *i + 1 < basins.len()) {
            all.push(format!("{} ({:?}) crosses {crossed:?}", a.key, a.text));
        }
    }
    all
}

#[test]
fn dimensions_cross_a_single_basin() {
    let mut drawn = 0;
    let mut all = Vec::new();
    for layers in [2, 3, 6, 12] {
        for shape in [
            "",
            "[segment]\nspan_deg = 160.0\n",
            "[segment]\nspan_deg = 40.0\ngrooves = 7\n",
            "[shell]\nouter_radius_mm = 40.0\nwall_mm = 9.0\n",
        ] {
            for more in ["", "overfill_mm = 0.0\n", "draft_deg = 3.0\n"] {
                let text = format!(
                    "[layout]\npins = [3]\nwrap_angle_deg = 30.0\n[print]\nbed_mm = 900.0\n{shape}[mould]\nkind = \"one-piece\"\nlayers = {layers}\n{more}"
                );
                let Some(built) = built(&text) else { continue };
                let d = built.design();
                assert_eq!(d.configuration().mould.kind, MouldKind::OnePiece);
                let sheets = super::sheets(&built);
                let sheet = sheets.iter().find(|s| s.name == "mould-tray").unwrap();
                let tray = built.printed().iter().find(|p| p.part().name == "mould-tray").unwrap();
                let (number, step) = pockets(&tray.part().solid);
                assert_eq!(number, layers, "{text}");
                let step = Point::new(step.x, step.y) * sheet.scale;
                let basins = basins(sheet, step, layers);
                assert!(basins.iter().all(|b| b.len() > 8), "{text}");
                all.extend(crossing(sheet, &basins).into_iter().map(|c| format!("{text:?}: {c}")));
                drawn += 1;
            }
        }
    }
    assert!(drawn >= 30, "only {drawn} trays were drawn");
    assert!(all.is_empty(), "{}", all.join("\n"));
}
