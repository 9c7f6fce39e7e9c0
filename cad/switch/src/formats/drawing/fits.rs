//! Fits of the parts of a switch: the screw, nut, dowel, insert, bearing, axle, pin or key that meets each hole, boss, slot
//! and groove, with its tolerance. `cad/doc/drawing.md`, "Tolerances on drawings", has the reason of each tolerance.

use crate::design::{
    BEARING_SEAT_MM, Design, Hole, Joint, Recess, STOP_SCREW, axle_recess, clearance, clearance_grade,
    stop_recess,
};
use crate::parts::{Part, Role, keys, stand_holes};
use crate::tolerances::{ChainDimension, link};
use pinswitch_drafting::{FaceDatum, Fit, Fits, Indicator, RadialSize, RadiusFit, RoundFit, number};
use pinswitch_solid::profile::{Point2, polar};

/// For bought parts, which must go in without play.
const CLOSE: &str = "+0.1/0";
/// For parts that may have play.
const WIDE: &str = "+0.2/0";
/// For parts that go into a [`WIDE`] hole.
const NARROW: &str = "0/-0.2";
/// Name of the part that measures the machine: its slots and grooves have no tolerance.
const COUPON: &str = "coupon";

/// Returns the fits of a part, as its sheet shows it.
pub(super) fn fits(design: &Design, part: &Part) -> Fits {
    if is_coupon(part) {
        return Fits::default();
    }
    let purpose = if matches!(part.role, Role::Support { .. }) {
        format!("for pin {}", pin(design))
    } else {
        String::new()
    };
    let is_support = matches!(part.role, Role::Support { .. });
    let slots = Fit::new(CLOSE, purpose);
    Fits {
        holes: holes(design, part),
        bosses: bosses(design, part),
        slots: if is_support {
            slots.with_indicator(position(design, ChainDimension::SlotPosition, &datums(design)))
        } else {
            slots
        },
        half_rounds: half_rounds(design, part),
        radii: radii(design, part),
        sizes: thickness(design, part).into_iter().collect(),
        height_tolerance: match part.role {
            Role::Layer => plus_minus(link(design, ChainDimension::LayerWidth).drawing),
            _ => String::new(),
        },
        face: face(design, part),
    }
}

/// Formats a symmetric tolerance with two decimal places at most, rounded down, so that it is not wider than computed.
fn plus_minus(tolerance_mm: f64) -> String {
    format!("\u{b1}{}", number(hundredths(tolerance_mm)))
}

/// Rounds down to hundredths, and keeps what is smaller.
fn hundredths(mm: f64) -> f64 {
    let steps = (mm * 100.0 + 1e-9).floor();
    if steps >= 1.0 { steps / 100.0 } else { mm }
}

/// Returns the position tolerance of a dimension of the chain: the zone is twice its tolerance.
fn position(design: &Design, dimension: ChainDimension, datums: &[char]) -> Indicator {
    Indicator::position(number(hundredths(2.0 * link(design, dimension).drawing)), datums)
}

/// Letters of the datums of shell and supports: the face between them, and the holes that locate them, if any.
fn datums(design: &Design) -> Vec<char> {
    let is_located = design.configuration().fasteners.count > 0 || design.dowel_hole_radius_mm().is_some();
    if is_located { vec!['A', 'B'] } else { vec!['A'] }
}

/// Fit of grooves and ribs. Pins go into grooves, and ribs form the grooves of the silicone, whose depth is in the chain
/// from dimensions to threshold.
fn half_rounds(design: &Design, part: &Part) -> Fit {
    let position = |datums: &[char]| position(design, ChainDimension::GroovePosition, datums);
    match part.role {
        Role::Layer | Role::Mould => {
            let [all, each] = [ChainDimension::GrooveDepth, ChainDimension::PinHeight];
            let tolerance = libm::hypot(link(design, all).drawing, link(design, each).drawing);
            Fit::new(plus_minus(tolerance), "").with_indicator(position(&['A']))
        }
        Role::Shell => Fit::new(CLOSE, "").with_indicator(position(&datums(design))),
        _ => Fit::new(CLOSE, ""),
    }
}

/// Fits of the radii that determine the thickness of the layer and the radius of the contact.
fn radii(design: &Design, part: &Part) -> Vec<RadiusFit> {
    let of = |radius_mm, fit| RadiusFit { radius_mm, fit };
    match part.role {
        Role::Shell => {
            let tolerance = plus_minus(link(design, ChainDimension::ShellRadius).drawing);
            vec![of(design.shell_radius_mm(), Fit::new(tolerance, ""))]
        }
        Role::Layer => vec![of(design.shell_radius_mm(), Fit::default().with_datum('A'))],
        Role::Mould => {
            // Two faces of the mould share the tolerance of the layer between them.
            let tolerance = plus_minus(link(design, ChainDimension::LayerThickness).drawing / 2.0);
            let scale = 1.0 / (1.0 - design.configuration().mould.shrinkage_pct / 100.0);
            [design.shell_radius_mm(), design.contact_radius_mm()]
                .map(|radius_mm| of(scale * radius_mm, Fit::new(tolerance.clone(), "")))
                .to_vec()
        }
        _ => Vec::new(),
    }
}

/// The thickness of the layer.
fn thickness(design: &Design, part: &Part) -> Option<RadialSize> {
    (part.role == Role::Layer).then(|| RadialSize {
        key: "layer thickness".to_owned(),
        inner_mm: design.shell_radius_mm(),
        outer_mm: design.contact_radius_mm(),
        tolerance: plus_minus(link(design, ChainDimension::LayerThickness).drawing),
    })
}

/// The datum A of shell and supports is the face between them; that of a mould, its face on the bed.
fn face(design: &Design, part: &Part) -> Option<FaceDatum> {
    let (z_mm, is_upper) = match (part.role, part.name.as_str()) {
        (Role::Shell, _) | (Role::Mould, "mould-ring" | "mould-tray") => (0.0, false),
        (Role::Support { .. }, _) => (design.configuration().support.plate_mm, true),
        _ => return None,
    };
    Some(FaceDatum { letter: 'A', z_mm, is_upper })
}

/// Returns whether a part measures the machine that makes it.
pub(super) fn is_coupon(part: &Part) -> bool {
    part.name == COUPON
}

/// Diameter and tolerance of the pins.
fn pin(design: &Design) -> String {
    let p = &design.configuration().pins;
    format!("\u{d8}{} {}", number(p.diameter_mm), pin_tolerance(design))
}

fn pin_tolerance(design: &Design) -> String {
    format!("\u{b1}{}", number(design.configuration().pins.tolerance_mm))
}

fn at(centre: Point2, half_mm: f64, fit: Fit) -> RoundFit {
    RoundFit { centre: Some(centre), half_mm, fit }
}

fn holes(design: &Design, part: &Part) -> Vec<RoundFit> {
    match (part.role, part.name.as_str()) {
        (Role::Shell | Role::Support { .. }, _) => fasteners(design, part),
        (_, "guide-pulley" | "guide-pulley-2") => {
            let fit = Fit::new(CLOSE, "for bearing 608");
            vec![RoundFit { centre: None, half_mm: BEARING_SEAT_MM / 2.0, fit }]
        }
        // Spacer and stop are drawn about their own axes.
        (_, "pulley-spacer" | "pulley-spacer-2") => design
            .mounting()
            .and_then(|m| m.axle)
            .map(|axle| screw(&Hole { centre: Point2::origin(), ..axle }))
            .into_iter()
            .collect(),
        (_, "sheath-stop") => design
            .mounting()
            .and_then(|m| m.sheath)
            .map_or_else(Vec::new, |stop| stop.along_the_paper().screws.iter().map(screw).collect()),
        (Role::Stand, name) => stand_holes(design, name).iter().map(screw).collect(),
        (Role::DistalLink, _) => design.joint().as_ref().map_or_else(Vec::new, distal_link),
        (Role::Mount, _) => mounting_plate(design, part),
        (Role::Mould, _) => key_holes(design),
        _ => Vec::new(),
    }
}

fn bosses(design: &Design, part: &Part) -> Vec<RoundFit> {
    match part.role {
        Role::Pin { .. } => {
            let half_mm = design.configuration().pins.diameter_mm / 2.0;
            vec![RoundFit { centre: None, half_mm, fit: Fit::new(pin_tolerance(design), "") }]
        }
        Role::Mould => keys(design),
        _ => Vec::new(),
    }
}

/// A clearance hole.
fn screw(hole: &Hole) -> RoundFit {
    let clearance = clearance(2.0 * hole.radius_mm);
    let purpose = clearance.thread.map_or_else(|| "for a screw".to_owned(), |thread| format!("for {thread}"));
    at(hole.centre, hole.radius_mm, Fit::new(clearance.grade, purpose))
}

/// A recess for a nut or a head.
fn recess(centre: Point2, recess: &Recess, purpose: impl Into<String>) -> RoundFit {
    at(centre, recess.radial_mm, Fit::new(WIDE, purpose))
}

/// Screws, nuts, heads, inserts and dowels in shell, supports and mounting plate.
fn fasteners(design: &Design, part: &Part) -> Vec<RoundFit> {
    let f = &design.configuration().fasteners;
    let fastening = design.fastening();
    let thread = fastening.thread.map(|t| t.name);
    let name = thread.unwrap_or("a screw");
    let on = |angle: &f64| polar(design.fastener_radius_mm(), *angle);
    let grade = clearance_grade(thread, f.hole_diameter_mm);
    let mut all = Vec::new();
    let is_switch = matches!(part.role, Role::Shell | Role::Support { .. });
    // Dowels locate the parts better than screws.
    let has_dowels = design.dowel_hole_radius_mm().is_some();
    let located = |fit: Fit, zone_mm: Option<f64>, is_datum: bool| match zone_mm.filter(|_| is_switch) {
        None => fit,
        Some(zone_mm) => {
            let zone = format!("\u{d8}{}", number(hundredths(zone_mm)));
            let datums: &[char] = if is_datum { &['A'] } else { &['A', 'B'] };
            let fit = fit.with_indicator(Indicator::position(zone, datums));
            if is_datum { fit.with_datum('B') } else { fit }
        }
    };
    // Half of the play of a screw in its hole is for each of two parts.
    let shank_mm = thread.and_then(|name| name.strip_prefix('M')?.parse::<f64>().ok());
    let play_mm = shank_mm.map(|shank| (f.hole_diameter_mm - shank) / 2.0).filter(|play| *play > 0.0);
    for centre in design.fastener_angles_rad().iter().map(on) {
        let fit = located(Fit::new(grade, format!("for {name}")), play_mm, !has_dowels);
        all.push(at(centre, f.hole_diameter_mm / 2.0, fit));
        match part.role {
            Role::Shell => all.extend(fastening.insert_mm.map(|[bore, _]| {
                at(centre, bore / 2.0, Fit::new(CLOSE, format!("for heat-set insert {name}")))
            })),
            Role::Support { .. } => {
                all.extend(fastening.nut_trap.map(|r| recess(centre, &r, format!("for nut {name}"))));
                all.extend(fastening.counterbore.map(|r| recess(centre, &r, "for the head")));
            }
            _ => all.extend(fastening.mount_counterbore.map(|r| recess(centre, &r, "for the head"))),
        }
    }
    let purpose = format!("for dowel {}", number(f.dowel_diameter_mm));
    all.extend(design.dowel_hole_radius_mm().into_iter().flat_map(|half_mm| {
        let zone_mm = 2.0 * half_mm - f.dowel_diameter_mm;
        let fit = located(Fit::new(CLOSE, purpose.clone()), Some(zone_mm).filter(|zone| *zone > 0.0), true);
        design.dowel_angles_rad().into_iter().map(move |angle| at(on(&angle), half_mm, fit.clone()))
    }));
    all
}

fn mounting_plate(design: &Design, part: &Part) -> Vec<RoundFit> {
    let Some(mounting) = design.mounting() else { return Vec::new() };
    let joint = design.joint();
    let Some((low, high)) = part.solid.bounds() else { return Vec::new() };
    let is_ours = |hole: &Hole| hole.centre.x > low.x && hole.centre.x < high.x;
    let mut all: Vec<RoundFit> = mounting.holes.iter().filter(|h| is_ours(h)).map(screw).collect();
    if part.name == "rig-splice" {
        return all;
    }
    if let Some(joint) = &joint {
        all.push(axle_bore(joint));
        all.push(recess(Point2::origin(), &joint.head_recess(), "for the axle's head"));
    }
    for axle in mounting.axles().filter(is_ours) {
        all.push(screw(&axle));
        all.push(recess(axle.centre, &axle_recess(), "for the bolt's head"));
    }
    if part.name == "rig-plate-2" {
        return all;
    }
    for hole in mounting.sheath.iter().flat_map(|s| s.screws) {
        let mut round = screw(&hole);
        round.fit.purpose = format!("for {}", STOP_SCREW.name);
        all.push(round);
        all.push(recess(hole.centre, &stop_recess(), "for the head"));
    }
    all.extend(fasteners(design, part));
    all
}

/// The bore of a link for the axle of a joint.
fn axle_bore(joint: &Joint) -> RoundFit {
    at(Point2::origin(), joint.hub.bore_mm, Fit::new(CLOSE, format!("for axle {}", joint.axle.name)))
}

/// Holes of the distal link, whose plan is mirrored.
fn distal_link(joint: &Joint) -> Vec<RoundFit> {
    let mirrored = |hole: &Hole| Hole { centre: Point2::new(-hole.centre.x, hole.centre.y), ..*hole };
    let ends = joint.distal.holes.iter().map(|hole| screw(&mirrored(hole)));
    ends.chain([axle_bore(joint)]).collect()
}

/// Holes of a mould for its keys: the largest key goes into the smallest hole, in width and depth.
fn key_holes(design: &Design) -> Vec<RoundFit> {
    let m = &design.configuration().mould;
    let purpose = format!("for key \u{d8}{}", number(m.key_diameter_mm));
    let fit = Fit::new(WIDE, purpose).with_depth_tolerance(WIDE);
    let half_mm = m.key_diameter_mm / 2.0 + m.clearance_mm;
    keys::middles(design).map(|centre| at(centre, half_mm, fit.clone())).into()
}

/// The keys of a mould.
fn keys(design: &Design) -> Vec<RoundFit> {
    let m = &design.configuration().mould;
    let purpose = format!("for hole \u{d8}{}", number(m.key_diameter_mm + 2.0 * m.clearance_mm));
    let fit = Fit::new(NARROW, purpose).with_depth_tolerance(NARROW);
    let half_mm = m.key_diameter_mm / 2.0;
    keys::middles(design).map(|centre| at(centre, half_mm, fit.clone())).into()
}
