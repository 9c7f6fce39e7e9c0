//! Rules for the ends of sectors, the mould, and the loads.

use super::Direction::{self, Lower, Raise, Restore, Set};
use super::shell::MIN_INNER_RADIUS_MM;
use super::{Assessment, Inspection, Rule, Severity, advise, least_wall_mm, require};
use crate::config::MouldKind;
use crate::design::{mould_keys as keys, mould_tray as tray};
use pinswitch_diagnostic::codes;
use pinswitch_friction::Substrate;

/// Largest shift of the ends of a sector as a share of its inner radius: beyond 1 they would miss the circle.
const LARGEST_SHIFT: f64 = 0.9;
/// Width of the base of a split mould beyond the parts on it, mm.
const MOULD_MARGIN_MM: f64 = 1.0;
/// Least gap between the ends of a sector behind the axis, mm.
const MIN_GAP_MM: f64 = 0.5;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::ENDS_BEYOND_SECTOR,
        field: "segment.end_margin_mm",
        severity: Severity::Error,
        assess: ends_in_sector,
    },
    Rule { code: codes::ENDS_MEET, field: "segment.span_deg", severity: Severity::Error, assess: ends_apart },
    Rule {
        code: codes::MOULD_INNER_RADIUS,
        field: "mould.wall_mm",
        severity: Severity::Error,
        assess: room_in_tray,
    },
    Rule {
        code: codes::ENDS_BEYOND_SECTOR,
        field: "mould.wall_mm",
        severity: Severity::Error,
        assess: mould_ends_in_sector,
    },
    Rule {
        code: codes::ENDS_MEET,
        field: "segment.span_deg",
        severity: Severity::Error,
        assess: mould_ends_apart,
    },
    Rule {
        code: codes::MOULD_KEYS_CROWDED,
        field: "mould.key_diameter_mm",
        severity: Severity::Error,
        assess: keys_apart,
    },
    Rule {
        code: codes::MOULD_KEY_TOO_HIGH,
        field: "mould.key_height_mm",
        severity: Severity::Error,
        assess: keys_in_ring,
    },
    Rule {
        code: codes::DRAFT_WITHOUT_BASIN,
        field: "mould.draft_deg",
        severity: Severity::Warning,
        assess: draft_without_basin,
    },
    Rule {
        code: codes::EMPTY_LOAD_RANGE,
        field: "friction.load_min_n",
        severity: Severity::Error,
        assess: load_range,
    },
];

/// The ends of a sector, shifted outwards from radial planes. They reach furthest around the axis at the inner radius,
/// where they must neither miss the circle nor meet behind the axis.
struct Ends {
    name: &'static str,
    inner_mm: f64,
    shift_mm: f64,
}

impl Ends {
    /// The ends of shell and supports.
    fn of_sector(i: &Inspection<'_>) -> Self {
        Self { name: "ends of the shell", inner_mm: i.inner_radius_mm(), shift_mm: i.shell_end_shift_mm() }
    }

    /// The ends of the mould, which has a wall beyond both ends of the sector; `None` without a mould.
    fn of_mould(i: &Inspection<'_>) -> Option<Self> {
        const MOULD: &str = "ends of the mould";
        let c = i.configuration();
        let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
        let margin = c.segment.end_margin_mm * scale;
        match c.mould.kind {
            MouldKind::None => None,
            MouldKind::OnePiece => {
                let around = tray::around_mm(&c.mould);
                let inner_mm = c.shell.outer_radius_mm * scale - around;
                Some(Self { name: MOULD, inner_mm, shift_mm: margin + around })
            }
            MouldKind::Split => {
                let inner = i.inner_radius_mm();
                Some(Self {
                    name: MOULD,
                    inner_mm: inner - MOULD_MARGIN_MM.min(inner / 2.0),
                    shift_mm: margin + c.mould.wall_mm + MOULD_MARGIN_MM,
                })
            }
        }
    }

    fn assess_shift(&self, directions: &'static [Direction]) -> Assessment {
        let most = LARGEST_SHIFT * self.inner_mm;
        require(self.shift_mm <= most, || {
            (
                format!(
                    "{} too far beyond the span at an inner radius of {:.3} mm ({:.3} mm, at most {:.3} mm)",
                    self.name,
                    self.inner_mm,
                    self.shift_mm,
                    most.max(0.0)
                ),
                directions,
            )
        })
    }

    fn assess_gap(&self, half_span_rad: f64, directions: &'static [Direction]) -> Assessment {
        let half_rad = half_span_rad + libm::asin(self.shift_mm / self.inner_mm);
        let most_rad = std::f64::consts::PI - libm::asin((MIN_GAP_MM / 2.0 / self.inner_mm).min(1.0));
        require(half_rad <= most_rad, || {
            let problem =
                format!("{} meet behind the axis (at least {MIN_GAP_MM} mm apart needed)", self.name);
            (problem, directions)
        })
    }
}

fn ends_in_sector(i: &Inspection<'_>) -> Assessment {
    Ends::of_sector(i).assess_shift(&[
        Lower("segment.end_margin_mm"),
        Lower("shell.wall_mm"),
        Raise("shell.outer_radius_mm"),
        Lower("shell.stop_mm"),
    ])
}

fn ends_apart(i: &Inspection<'_>) -> Assessment {
    Ends::of_sector(i).assess_gap(
        i.half_span_rad(),
        &[
            Lower("segment.span_deg"),
            Raise("shell.outer_radius_mm"),
            Lower("segment.end_margin_mm"),
            Lower("shell.wall_mm"),
            Lower("layout.wrap_angle_deg"),
            Lower("shell.stop_mm"),
        ],
    )
}

fn room_in_tray(i: &Inspection<'_>) -> Assessment {
    let Some(ends) = Ends::of_mould(i).filter(|_| i.configuration().mould.kind == MouldKind::OnePiece) else {
        return Assessment::NotApplicable;
    };
    require(ends.inner_mm >= MIN_INNER_RADIUS_MM, || {
        (
            format!(
                "inner radius of the mould too small ({:.3} mm, at least {MIN_INNER_RADIUS_MM} mm needed)",
                ends.inner_mm
            ),
            &[
                Lower("mould.wall_mm"),
                Raise("shell.outer_radius_mm"),
                Restore("mould.draft_deg"),
                Restore("mould.overfill_mm"),
                Set("mould.kind", "\"none\""),
            ],
        )
    })
}

fn mould_ends_in_sector(i: &Inspection<'_>) -> Assessment {
    Ends::of_mould(i).map_or(Assessment::NotApplicable, |ends| {
        ends.assess_shift(&[
            Lower("mould.wall_mm"),
            Lower("segment.end_margin_mm"),
            Lower("shell.wall_mm"),
            Raise("shell.outer_radius_mm"),
            Set("mould.kind", "\"none\""),
        ])
    })
}

fn mould_ends_apart(i: &Inspection<'_>) -> Assessment {
    Ends::of_mould(i).map_or(Assessment::NotApplicable, |ends| {
        ends.assess_gap(
            i.half_span_rad(),
            &[
                Lower("segment.span_deg"),
                Raise("shell.outer_radius_mm"),
                Lower("mould.wall_mm"),
                Lower("segment.end_margin_mm"),
                Lower("shell.wall_mm"),
                Set("mould.kind", "\"none\""),
            ],
        )
    })
}

/// Returns whether the set has a tray. A tray has a basin only if it is overfilled.
fn has_tray(i: &Inspection<'_>) -> bool {
    let c = i.configuration();
    c.mould.kind == MouldKind::OnePiece && c.layout.substrate == Substrate::Silicone
}

/// Only the walls of the basin may have a draft: all others shape the layer.
fn draft_without_basin(i: &Inspection<'_>) -> Assessment {
    let m = &i.configuration().mould;
    if !has_tray(i) {
        return Assessment::NotApplicable;
    }
    advise(m.draft_deg == 0.0 || m.overfill_mm > 0.0, || {
        (
            format!(
                "mould.draft_deg = {} has no effect: without a basin every wall of the tray shapes the layer",
                m.draft_deg
            ),
            "set it to 0, or raise mould.overfill_mm".to_owned(),
        )
    })
}

fn has_keys(i: &Inspection<'_>) -> bool {
    let c = i.configuration();
    c.mould.kind == MouldKind::Split && c.layout.substrate == Substrate::Silicone
}

/// Keys need a wall between them and at the ends of the ring.
fn keys_apart(i: &Inspection<'_>) -> Assessment {
    if !has_keys(i) {
        return Assessment::NotApplicable;
    }
    let diameter = i.configuration().mould.key_diameter_mm;
    require(keys_fit(i, diameter), || {
        (
            format!(
                "wall between the keys of the mould or at its ends too thin (at least {:.3} mm needed)",
                least_wall_mm(i.configuration(), 1.0)
            ),
            &[
                Lower("mould.key_diameter_mm"),
                Raise("segment.span_deg"),
                Set("mould.kind", "\"one-piece\""),
                Restore("mould.clearance_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn keys_fit(i: &Inspection<'_>, diameter_mm: f64) -> bool {
    let c = i.configuration();
    let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
    let radius = i.contact_radius_mm() * scale + keys::ring_wall_mm(&c.mould, diameter_mm) / 2.0;
    let wall = least_wall_mm(c, 1.0);
    let hole = diameter_mm / 2.0 + c.mould.clearance_mm;
    let chord = |share: f64| 2.0 * radius * libm::sin((share * i.half_span_rad() / 2.0).min(1.5));
    let between = keys::PLACES.windows(2).all(|two| chord(two[1] - two[0]) >= 2.0 * hole + wall);
    // The ends of the ring are outside the radial planes.
    let shift = c.segment.end_margin_mm * scale + c.mould.wall_mm;
    let at_end = |place: &f64| radius * libm::sin(((1.0 - place.abs()) * i.half_span_rad()).min(1.5)) + shift;
    between && keys::PLACES.iter().all(|place| at_end(place) >= hole + wall)
}

/// A key needs a head, and its hole must end inside the ring.
fn keys_in_ring(i: &Inspection<'_>) -> Assessment {
    if !has_keys(i) {
        return Assessment::NotApplicable;
    }
    let c = i.configuration();
    let ring = i.layer_width_mm() / (1.0 - c.mould.shrinkage_pct / 100.0);
    let most = (ring - keys::HOLE_END_MM).min(keys::highest_mm(c.mould.key_diameter_mm));
    require(c.mould.key_height_mm <= most, || {
        (
            format!(
                "keys too high ({} mm, at most {:.3} mm with {} mm in diameter in a ring of {ring:.3} mm)",
                c.mould.key_height_mm,
                most.max(0.0),
                c.mould.key_diameter_mm
            ),
            &[
                Lower("mould.key_height_mm"),
                Raise("shell.width_mm"),
                Raise("mould.key_diameter_mm"),
                Set("mould.kind", "\"one-piece\""),
                Restore("silicone.side_clearance_mm"),
            ],
        )
    })
}

fn load_range(i: &Inspection<'_>) -> Assessment {
    let f = &i.configuration().friction;
    require(f.load_min_n < f.load_max_n, || {
        (
            format!(
                "empty range of loads: friction.load_min_n = {} is not below friction.load_max_n = {}",
                f.load_min_n, f.load_max_n
            ),
            &[Lower("friction.load_min_n"), Raise("friction.load_max_n")],
        )
    })
}
