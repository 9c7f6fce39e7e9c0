//! Texts of dimensions: numbers, angles, callouts of features, and general notes.

use std::f64::consts::PI;

use super::bore::{Bore, Flats, Stage};
use super::features::{ArcSlot, Boss, Features, Rounding, Segments, Slot};
use super::fit::{Fit, Fits};
use crate::contour::{same, same_point};
use pinswitch_solid::profile::Point2;

/// Angles in one line of a list.
const ANGLES_IN_LINE: usize = 5;

/// Formats a length in mm or an angle in degrees with at most three decimals.
#[must_use]
pub fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// Formats an angle in degrees.
pub(crate) fn degrees(angle_rad: f64) -> String {
    format!("{}\u{b0}", number(angle_rad.to_degrees()))
}

/// `3 x ` before a feature that occurs three times; empty for one.
fn times(n: usize) -> String {
    if n == 1 { String::new() } else { format!("{n} \u{d7} ") }
}

/// The angle of a point about the axis, from +y toward +x.
pub(crate) fn angle_rad(p: Point2) -> f64 {
    libm::atan2(p.x, p.y)
}

/// First angle and step of at least three evenly spaced angles.
pub(crate) fn even_step(angles_rad: &[f64]) -> Option<(f64, f64)> {
    let mut sorted = angles_rad.to_vec();
    sorted.sort_by(f64::total_cmp);
    let step = sorted.get(1)? - sorted[0];
    let is_even = sorted.len() > 2 && sorted.windows(2).all(|w| same(w[1] - w[0], step));
    is_even.then_some((sorted[0], step))
}

/// Radius and angles of points on one circle about the axis, such as `on R16.75 at ±34.46°`; nothing for others.
fn on_radius(points: &[Point2]) -> Vec<String> {
    let radius = points.first().map_or(0.0, |p| p.coords.norm());
    if same(radius, 0.0) || !points.iter().all(|p| same(p.coords.norm(), radius)) {
        return Vec::new();
    }
    let mut angles: Vec<f64> = points.iter().map(|p| angle_rad(*p)).collect();
    angles.sort_by(f64::total_cmp);
    let mut at: Vec<String> = match angles[..] {
        [a, b] if same(a, -b) => vec![format!("\u{b1}{}", degrees(b))],
        _ => match even_step(&angles) {
            Some((first, step)) => {
                vec![format!("{} + {} \u{d7} {}", degrees(first), angles.len() - 1, degrees(step))]
            }
            None => angles.iter().map(|a| degrees(*a)).collect(),
        },
    };
    let mut lines = vec![format!("on R{} at {}", number(radius), at.remove(0))];
    for (i, angle) in at.into_iter().enumerate() {
        // A long list of angles continues on the next line.
        match lines.last_mut() {
            Some(line) if i % ANGLES_IN_LINE != ANGLES_IN_LINE - 2 => *line += &format!(", {angle}"),
            Some(line) => {
                *line += ",";
                lines.push(angle);
            }
            None => {}
        }
    }
    lines
}

/// The radius of evenly spaced centres, whose angles have a dimension of their own; radius and angles of others.
fn centres_on_radius(prefix: &str, centres: &[Point2]) -> Vec<String> {
    let angles: Vec<f64> = centres.iter().map(|p| angle_rad(*p)).collect();
    if even_step(&angles).is_some() {
        return vec![format!("{prefix} on R{}", number(centres[0].coords.norm()))];
    }
    on_radius(centres)
        .into_iter()
        .map(|line| if line.starts_with("on R") { format!("{prefix} {line}") } else { line })
        .collect()
}

/// The callout of a boss. A round part has its height as a dimension.
pub(super) fn boss(fits: &Fits, boss: &Boss, noun: &str, is_body: bool, is_axial: bool) -> Vec<String> {
    let (Some(first), Some(last)) = (boss.levels.first(), boss.levels.last()) else { return Vec::new() };
    let n = times(boss.centres.len());
    let (foot, head) = (number(2.0 * first.1), number(2.0 * last.1));
    let height = number(last.0 - first.0);
    let is_straight = same(first.1, last.1);
    let fit = boss.centres.first().and_then(|centre| fits.of_boss(*centre, &boss.levels));
    let mut lines = match (fit, is_straight, is_body) {
        (Some(fit), true, true) => {
            vec![format!("{n}{}", joined(&[&format!("\u{d8}{foot}"), &fit.tolerance]))]
        }
        (Some(fit), ..) => {
            let deviation = &fit.tolerance;
            let high = joined(&[&height, &fit.depth_tolerance, "high"]);
            let mut lines = vec![format!("{n}{noun} \u{d8}{foot} {deviation}, {high},")];
            let ending =
                if is_straight { String::new() } else { format!("\u{d8}{head} {deviation} at its head, ") };
            lines.push(ending + &fit.purpose);
            lines
        }
        (None, true, true) => vec![format!("{n}\u{d8}{foot}")],
        (None, true, false) => vec![format!("{n}\u{d8}{foot} \u{d7} {height}")],
        (None, false, _) => {
            let mut levels = boss.levels[1..].to_vec();
            levels.dedup_by(|a, b| same(a.1, b.1));
            let at = |(z, r): &(f64, f64)| format!(", \u{d8}{} at {}", number(2.0 * r), number(z - first.0));
            vec![format!("{n}peg \u{d8}{foot}{}", levels.iter().map(at).collect::<String>())]
        }
    };
    let is_shaft = fit.is_some() && is_straight && is_body;
    if !is_shaft && (is_axial || fit.is_some()) {
        lines.extend(on_radius(&boss.centres));
    }
    lines
}

/// Words that are not empty, with spaces between them.
pub(super) fn joined(words: &[&str]) -> String {
    words.iter().filter(|w| !w.is_empty()).copied().collect::<Vec<_>>().join(" ")
}

/// The width of a slot with its tolerance.
pub(super) fn slot_width(fits: &Fits, slot: &Slot) -> String {
    joined(&[&number(slot.width_mm), &fits.slots.tolerance])
}

/// The callout of slots.
pub(super) fn slot(fits: &Fits, slot: &Slot) -> Vec<String> {
    let n = times(slot.places.len());
    let depth = if slot.is_blind { format!("{} deep", number(slot.depth_mm)) } else { "through".to_owned() };
    let mut lines = vec![format!("{n}slot, {depth}"), fits.slots.purpose.clone()];
    lines.retain(|line| !line.is_empty());
    let outer: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
    lines.extend(centres_on_radius("outer centres", &outer));
    lines
}

/// The callout of a slot along an arc.
pub(super) fn arc_slot(slot: &ArcSlot) -> Vec<String> {
    let (low, high) = (number(slot.widths_mm.0), number(slot.widths_mm.1));
    let width = if low == high { format!("{low} wide") } else { format!("{low} wide, {high} at the top") };
    vec![
        format!("slot along R{}, {width}", number(slot.radius_mm)),
        format!("centres of its ends at \u{b1}{}", degrees(slot.half_rad)),
    ]
}

/// The callout of grooves, ribs or rounded corners.
pub(super) fn rounding(fits: &Fits, rounding: &Rounding, f: &Features) -> Vec<String> {
    let noun = match (rounding.is_half_round, rounding.is_rib) {
        (true, true) => "rib ",
        (true, false) => "groove ",
        (false, _) => "",
    };
    let tolerance = if rounding.is_half_round { fits.half_rounds.tolerance.as_str() } else { "" };
    let radius = joined(&[&format!("R{}", number(rounding.radius_mm)), tolerance]);
    let mut lines = vec![format!("{}{noun}{radius}", times(rounding.arcs.len()))];
    let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
    if rounding.is_half_round {
        if f.is_axial() {
            lines.extend(centres_on_radius("centres", &centres));
        } else {
            lines.push("centres on the edge".to_owned());
        }
    } else if centres.iter().all(|p| f.bores.iter().any(|b| b.centres.iter().any(|c| same_point(*c, *p)))) {
        lines.push("about the hole's axis".to_owned());
    }
    lines
}

/// The callout of the segments of a ring, between slots at these angles.
pub(super) fn segments(segments: &Segments, slots_rad: &[f64]) -> Vec<String> {
    let height = number(segments.heights_mm.1 - segments.heights_mm.0);
    let mut lines = vec![
        format!("lip R{} to R{}", number(segments.inner_mm), number(segments.outer_mm)),
        format!("{height} high, in {} segments", segments.spans_rad.len()),
    ];
    let mut gaps: Vec<f64> = Vec::new();
    for (from, to) in &segments.spans_rad {
        for end in [from, to] {
            let gap = slots_rad.iter().map(|s| (s - end).abs()).fold(f64::INFINITY, f64::min);
            if gap < PI && !gaps.iter().any(|g| same(*g, gap)) {
                gaps.push(gap);
            }
        }
    }
    let outermost = segments.spans_rad.iter().map(|s| s.1).fold(f64::NEG_INFINITY, f64::max);
    gaps.sort_by(f64::total_cmp);
    if let Some(gap) = gaps.first() {
        lines.push(format!("edges {} from slot centres", degrees(*gap)));
    }
    lines.push(format!("outermost edges at \u{b1}{}", degrees(outermost)));
    lines
}

/// The callout of ends that are not in a plane through the axis.
pub(super) fn ends(shift_mm: f64, half_span_rad: f64) -> Vec<String> {
    vec![
        format!("end face {} beyond the radial plane", number(shift_mm)),
        format!("at \u{b1}{}, parallel to it", degrees(half_span_rad)),
    ]
}

/// The callout of a bore, with its radius and angles on a part with an axis.
pub(super) fn bore(fits: &Fits, bore: &Bore, is_axial: bool) -> Vec<String> {
    let n = times(bore.centres.len());
    let fit = |stage: &Stage| fits.of_stage(*bore.centres.first()?, stage);
    let mut lines = match &bore.stages[..] {
        [stage] => single(stage, bore.is_through(), fit(stage)),
        [low, between, high] if bore.is_through() && is_mirrored(low, high) => {
            let fit_of_low = fit(low);
            let wide = format!("{}, {} deep, both faces", sized(low, fit_of_low), number(low.depth_mm()));
            let purpose = fit_of_low.map_or_else(String::new, |f| f.purpose.clone());
            vec![wide, purpose, format!("{} between them", sized(between, fit(between)))]
        }
        stages => {
            let fits: Vec<Option<&Fit>> = stages.iter().map(fit).collect();
            stacked(bore, stages, &fits)
        }
    };
    if let Some(first) = lines.first_mut() {
        first.insert_str(0, &n);
    }
    lines.retain(|l| !l.is_empty());
    if is_axial {
        lines.extend(on_radius(&bore.centres));
    }
    lines
}

/// The width of a stage.
fn across(stage: &Stage) -> String {
    let (low, high) = stage.ends();
    match (stage.flats.is_some(), same(low.1, high.1)) {
        (true, _) => format!("hexagon AF {}", number(2.0 * low.1)),
        (false, true) => format!("\u{d8}{}", number(2.0 * low.1)),
        (false, false) => format!("\u{d8}{} to \u{d8}{}", number(2.0 * low.1), number(2.0 * high.1)),
    }
}

/// Whether two stages are equal, but for the face to which they open.
fn is_mirrored(low: &Stage, high: &Stage) -> bool {
    low.flats.is_none() && across(low) == across(high) && same(low.depth_mm(), high.depth_mm())
}

/// The width of a stage with its tolerance.
fn sized(stage: &Stage, fit: Option<&Fit>) -> String {
    joined(&[&across(stage), fit.map_or("", |f| &f.tolerance)])
}

/// The purpose after a comma, such as `, for dowel 2`.
fn purpose(fit: Option<&Fit>) -> String {
    fit.filter(|f| !f.purpose.is_empty()).map_or_else(String::new, |f| format!(", {}", f.purpose))
}

/// The callout of a single hole.
fn single(stage: &Stage, is_through: bool, fit: Option<&Fit>) -> Vec<String> {
    let (low, high) = stage.ends();
    let deep = joined(&[&number(stage.depth_mm()), fit.map_or("", |f| &f.depth_tolerance)]);
    let face = if stage.opens_down { ", far face" } else { "" };
    let mut lines = match (is_through, same(low.1, high.1)) {
        (true, true) => vec![format!("{} through{}", sized(stage, fit), purpose(fit))],
        (false, true) => vec![format!("{}, {deep} deep{face}{}", sized(stage, fit), purpose(fit))],
        (_, false) => {
            let wide = |radius: f64| {
                joined(&[&format!("\u{d8}{}", number(2.0 * radius)), fit.map_or("", |f| &f.tolerance)])
            };
            let mouth = format!("{}, {deep} deep{face}", wide(low.1));
            let end = format!("{} at its end{}", wide(high.1), purpose(fit));
            if fit.is_some() { vec![mouth + ",", end] } else { vec![format!("{mouth}, {end}")] }
        }
    };
    lines.extend(stage.flats.map(flats_text));
    lines
}

/// The direction of the flats of a hexagon.
fn flats_text(flats: Flats) -> String {
    match flats {
        Flats::SquareToRadius => "two flats square to the radius".to_owned(),
        Flats::AlongX => "two flats along X".to_owned(),
        Flats::AtAngle(degrees) => format!("two flats at {}\u{b0} from X", number(degrees)),
    }
}

/// The callout of stages of several widths, from the far face to the near one.
fn stacked(bore: &Bore, stages: &[Stage], fits: &[Option<&Fit>]) -> Vec<String> {
    let mut lines = Vec::new();
    let skins: Vec<f64> = bore.skins_mm().collect();
    for (i, (stage, fit)) in stages.iter().zip(fits).enumerate() {
        let is_narrowest = stages.iter().all(|s| s.reach_mm() >= stage.reach_mm());
        let depth =
            match (bore.is_through() && is_narrowest, stage.opens_down && i == 0, i + 1 == stages.len()) {
                (true, ..) => " through".to_owned(),
                (_, true, _) => format!(", {} deep, far face", number(stage.depth_mm())),
                (_, _, true) => format!(", {} deep, near face", number(stage.depth_mm())),
                _ => format!(", {} long", number(stage.depth_mm())),
            };
        let size = sized(stage, *fit);
        if let Some(flats) = stage.flats.map(flats_text) {
            lines.push(format!("{size}{depth}"));
            let purpose = fit.filter(|f| !f.purpose.is_empty()).map(|f| format!("{}, {flats}", f.purpose));
            lines.push(purpose.unwrap_or(flats));
        } else {
            lines.push(format!("{size}{depth}{}", purpose(*fit)));
        }
        if let Some(skin) = skins.get(i).filter(|s| !same(**s, 0.0)) {
            lines.push(format!("web {} above it", number(*skin)));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_solid::profile::polar;

    #[test]
    fn places_on_a_radius_are_short() {
        let at = |degrees: &[f64]| {
            on_radius(&degrees.iter().map(|d| polar(10.0, d.to_radians())).collect::<Vec<_>>()).join("|")
        };
        assert_eq!(at(&[-30.0, 30.0]), "on R10 at \u{b1}30\u{b0}");
        assert_eq!(at(&[-30.0, 0.0, 30.0]), "on R10 at -30\u{b0} + 2 \u{d7} 30\u{b0}");
        assert_eq!(at(&[-30.0, 5.0, 31.0]), "on R10 at -30\u{b0}, 5\u{b0}, 31\u{b0}");
        assert_eq!(at(&[0.0]), "on R10 at 0\u{b0}");
        let many: Vec<f64> = (0..15).map(|i| f64::from(i * i) * 0.5 - 40.0).collect();
        let text = at(&many);
        assert!(text.split('|').all(|l| l.len() < 60) && text.matches('\u{b0}').count() == 15, "{text}");
        assert_eq!(on_radius(&[Point2::origin()]), Vec::<String>::new());
    }
}
