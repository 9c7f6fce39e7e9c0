//! What meets a part: screws, nuts, dowels, inserts, the bearing, the axle and the keys of a mould, each with the hole or the
//! peg for it, and how exactly that is made. Where each tolerance comes from stands in cad/doc/drawing.md, "Tolerances on
//! drawings".

use super::bore::{Bore, Stage};
use super::features::{Round, same};
use super::words::number;
use crate::design::{
    BEARING_SEAT_MM, Design, Hole, Recess, STOP_SCREW, axle_recess, clearance, clearance_grade, stop_recess,
};
use crate::parts::{Part, Role, keys};
use pinswitch_solid::profile::{Point2, polar};

/// Never narrower: what is bought must go in, and not rattle.
const CLOSE: &str = "+0.1/0";
/// The same where play does no harm.
const WIDE: &str = "+0.2/0";
/// Never wider: it must go into a hole that is [`WIDE`].
const NARROW: &str = "0/-0.2";

/// The tolerance of grooves that pins lie in, and of ribs that form such grooves.
pub(super) const HALF_ROUND: &str = CLOSE;
/// The tolerance of slots for pins.
pub(super) const SLOT: &str = CLOSE;

/// How exactly a hole or a peg is made, and for what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fit {
    /// Of its width.
    pub(super) tolerance: String,
    /// Of its depth or height, where that matters, too.
    pub(super) depth_tolerance: &'static str,
    /// Such as `for dowel 2`.
    pub(super) purpose: String,
}

impl Fit {
    fn new(tolerance: impl Into<String>, purpose: impl Into<String>) -> Self {
        Self { tolerance: tolerance.into(), depth_tolerance: "", purpose: purpose.into() }
    }
}

/// Where something meets a part.
struct Meeting {
    /// `None` wherever the width is met.
    at: Option<Point2>,
    /// Radius, or half of the width across flats, mm.
    half_mm: f64,
    fit: Fit,
}

/// The fit of a stage of the hole at `centre`; `None` where nothing comes into it.
pub(super) fn of_stage(design: &Design, part: &Part, centre: Point2, stage: &Stage) -> Option<Fit> {
    found(&holes(design, part), centre, &stage.levels)
}

/// The fit of a peg or a rim.
pub(super) fn of_round(design: &Design, part: &Part, round: &Round) -> Option<Fit> {
    found(&pegs(design, part), *round.centres.first()?, &round.levels)
}

/// Holes in one list for each use: what has the same widths need not be for the same.
pub(super) fn parted(design: &Design, part: &Part, bores: Vec<Bore>) -> Vec<Bore> {
    let all = holes(design, part);
    let mut parted: Vec<(Vec<Option<Fit>>, Bore)> = Vec::new();
    for bore in bores {
        let first = parted.len();
        for centre in bore.centres {
            let fits: Vec<_> = bore.stages.iter().map(|s| found(&all, centre, &s.levels)).collect();
            match parted[first..].iter_mut().find(|(others, _)| *others == fits) {
                Some((_, other)) => other.centres.push(centre),
                None => parted.push((fits, Bore { centres: vec![centre], stages: bore.stages.clone() })),
            }
        }
    }
    parted.into_iter().map(|(_, bore)| bore).collect()
}

fn found(all: &[Meeting], centre: Point2, levels: &[(f64, f64)]) -> Option<Fit> {
    let is_there = |m: &&Meeting| {
        m.at.is_none_or(|at| (at - centre).norm() < 1e-6) && levels.iter().any(|l| same(l.1, m.half_mm))
    };
    all.iter().find(is_there).map(|m| m.fit.clone())
}

/// Everything that comes into a hole of a part, as its sheet shows the part.
fn holes(design: &Design, part: &Part) -> Vec<Meeting> {
    match (part.role, part.name.as_str()) {
        (Role::Shell | Role::Support { .. }, _) => fasteners(design, part),
        (_, "guide-pulley") => {
            vec![Meeting {
                at: None,
                half_mm: BEARING_SEAT_MM / 2.0,
                fit: Fit::new(CLOSE, "for bearing 608"),
            }]
        }
        // Both are drawn by themselves.
        (_, "pulley-spacer") => design
            .mounting()
            .and_then(|m| m.axle)
            .map(|axle| screw(&Hole { centre: Point2::origin(), ..axle }))
            .into_iter()
            .collect(),
        (_, "sheath-stop") => design
            .mounting()
            .and_then(|m| m.sheath)
            .map_or_else(Vec::new, |stop| stop.along_the_paper().screws.iter().map(screw).collect()),
        (Role::Mount, _) => plate(design, part),
        (Role::Mould, _) => key_holes(design),
        _ => Vec::new(),
    }
}

/// A clearance hole.
fn screw(hole: &Hole) -> Meeting {
    let clearance = clearance(2.0 * hole.radius_mm);
    let purpose = clearance.thread.map_or_else(|| "for a screw".to_owned(), |thread| format!("for {thread}"));
    Meeting { at: Some(hole.centre), half_mm: hole.radius_mm, fit: Fit::new(clearance.grade, purpose) }
}

/// A recess for a nut, or for a head.
fn recess(at: Point2, recess: &Recess, purpose: impl Into<String>) -> Meeting {
    Meeting { at: Some(at), half_mm: recess.radial_mm, fit: Fit::new(WIDE, purpose) }
}

/// Screws, nuts, heads, inserts and dowels in shell, supports and plate.
fn fasteners(design: &Design, part: &Part) -> Vec<Meeting> {
    let f = &design.configuration().fasteners;
    let fastening = design.fastening();
    let thread = fastening.thread.map(|t| t.name);
    let name = thread.unwrap_or("a screw");
    let on = |angle: &f64| polar(design.fastener_radius_mm(), *angle);
    let grade = clearance_grade(thread, f.hole_diameter_mm);
    let mut all = Vec::new();
    for at in design.fastener_angles_rad().iter().map(on) {
        let half_mm = f.hole_diameter_mm / 2.0;
        all.push(Meeting { at: Some(at), half_mm, fit: Fit::new(grade, format!("for {name}")) });
        match part.role {
            Role::Shell => all.extend(fastening.insert_mm.map(|[bore, _]| Meeting {
                at: Some(at),
                half_mm: bore / 2.0,
                fit: Fit::new(CLOSE, format!("for heat-set insert {name}")),
            })),
            Role::Support { .. } => {
                all.extend(fastening.nut_trap.map(|r| recess(at, &r, format!("for nut {name}"))));
                all.extend(fastening.counterbore.map(|r| recess(at, &r, "for the head")));
            }
            _ => all.extend(fastening.mount_counterbore.map(|r| recess(at, &r, "for the head"))),
        }
    }
    let purpose = format!("for dowel {}", number(f.dowel_diameter_mm));
    all.extend(design.dowel_hole_radius_mm().into_iter().flat_map(|half_mm| {
        let fit = Fit::new(CLOSE, purpose.clone());
        design.dowel_angles_rad().into_iter().map(move |angle| Meeting {
            at: Some(on(&angle)),
            half_mm,
            fit: fit.clone(),
        })
    }));
    all
}

/// The holes of a mounting plate.
fn plate(design: &Design, part: &Part) -> Vec<Meeting> {
    let Some(mounting) = design.mounting() else { return Vec::new() };
    let is_link = part.name == "finger-link";
    let own = |hole: &Hole| {
        if is_link {
            let fit = Fit::new(CLOSE, "for the joint's pin");
            Meeting { at: Some(hole.centre), half_mm: hole.radius_mm, fit }
        } else {
            screw(hole)
        }
    };
    let mut all: Vec<Meeting> = mounting.holes.iter().map(own).collect();
    if let Some(axle) = &mounting.axle {
        all.push(screw(axle));
        all.push(recess(axle.centre, &axle_recess(), "for the bolt's head"));
    }
    for hole in mounting.sheath.iter().flat_map(|s| s.screws) {
        let mut meeting = screw(&hole);
        meeting.fit.purpose = format!("for {}", STOP_SCREW.name);
        all.push(meeting);
        all.push(recess(hole.centre, &stop_recess(), "for the head"));
    }
    all.extend(fasteners(design, part));
    all
}

/// Holes of a mould for its keys: the largest key goes into the smallest hole, both across and along.
fn key_holes(design: &Design) -> Vec<Meeting> {
    let m = &design.configuration().mould;
    let purpose = format!("for key \u{d8}{}", number(m.key_diameter_mm));
    let fit = Fit { depth_tolerance: WIDE, ..Fit::new(WIDE, purpose) };
    let half_mm = m.key_diameter_mm / 2.0 + m.clearance_mm;
    keys::middles(design).map(|at| Meeting { at: Some(at), half_mm, fit: fit.clone() }).into()
}

/// The keys of a mould.
fn pegs(design: &Design, part: &Part) -> Vec<Meeting> {
    if part.role != Role::Mould {
        return Vec::new();
    }
    let m = &design.configuration().mould;
    let purpose = format!("for hole \u{d8}{}", number(m.key_diameter_mm + 2.0 * m.clearance_mm));
    let fit = Fit { depth_tolerance: NARROW, ..Fit::new(NARROW, purpose) };
    let half_mm = m.key_diameter_mm / 2.0;
    keys::middles(design).map(|at| Meeting { at: Some(at), half_mm, fit: fit.clone() }).into()
}
