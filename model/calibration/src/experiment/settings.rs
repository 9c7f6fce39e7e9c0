//! Speeds and dwells to choose from: the usual ones of a rig, and those at which an effect in
//! question is most apparent, such as a dip at one speed.

use pinswitch_friction::published;

use super::candidates::Candidate;
use super::candidates::alone;
use super::information::Trace;
use super::question::Agenda;
use super::rig::RigLimits;
use super::runs::PlannedRun;
use crate::inference::{Model, Term};
use crate::table::{PlateauRow, Sweep};

/// Most additional settings.
const MORE: usize = 3;
/// Grid points for the additional settings, spaced evenly and by factors.
const GRID: usize = 60;
/// Smallest departure of a trace from linear interpolation between the settings, as a share of its
/// maximum.
const DEPARTS: f64 = 0.15;

/// Returns speeds in percent.
pub(super) fn speeds_pct(model: &Model, rig: &RigLimits, agenda: &Agenda) -> Vec<f64> {
    let set = |run: &mut PlannedRun, speed: f64| run.speed_pct = speed;
    with_more(rig.speeds(), rig.speeds_pct, set, model, rig, agenda)
}

/// Returns dwells in seconds.
pub(super) fn dwells_s(model: &Model, rig: &RigLimits, agenda: &Agenda) -> Vec<f64> {
    let set = |run: &mut PlannedRun, dwell: f64| run.dwell_s = dwell;
    // A longer dwell costs more time than its information is worth.
    let usual = rig.dwells();
    let longest = usual.iter().copied().fold(rig.dwells_s[0], f64::max);
    with_more(usual, [rig.dwells_s[0], longest], set, model, rig, agenda)
}

fn with_more(
    usual: Vec<f64>,
    [low, high]: [f64; 2],
    set: impl Fn(&mut PlannedRun, f64),
    model: &Model,
    rig: &RigLimits,
    agenda: &Agenda,
) -> Vec<f64> {
    if high <= low {
        return usual;
    }
    let mut grid: Vec<f64> = (0..=GRID)
        .map(|i| i as f64 / GRID as f64)
        .flat_map(|share| {
            [low + share * (high - low), low.max(1e-3) * libm::pow(high / low.max(1e-3), share)]
        })
        .chain(usual.iter().copied())
        .filter(|v| (low..=high).contains(v))
        .collect();
    grid.sort_by(f64::total_cmp);
    grid.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * b.abs());
    let rows: Vec<PlateauRow> = grid.iter().flat_map(|value| rows_at(*value, &set, rig)).collect();
    let Ok(points) = model.frame.points(&rows).ok_or(()) else { return usual };
    let each = rows.len() / grid.len().max(1);
    let mut chosen = usual;
    for trace in &agenda.traces {
        let (with, without) = match trace {
            Trace::Found { term } => (model.clone(), model.without_term(*term)),
            Trace::Absent { effect, values } => {
                (model.with_term(Term::Named(*effect), values), model.clone())
            }
            Trace::Beyond { .. } | Trace::Renewed { .. } => continue,
        };
        let course: Vec<f64> =
            with.predict(&points).iter().zip(without.predict(&points)).map(|(w, o)| w - o).collect();
        let at = |i: usize| &course[each * i..each * (i + 1)];
        let most = (0..grid.len()).map(|i| length(at(i).iter().copied())).fold(0.0, f64::max);
        while chosen.len() < MORE + 3 {
            let off = |i: usize| {
                let (below, above) = neighbours(&grid, &chosen, grid[i]);
                let share =
                    if above > below { (grid[i] - grid[below]) / (grid[above] - grid[below]) } else { 0.0 };
                let line = at(below).iter().zip(at(above)).map(|(b, a)| b + share * (a - b));
                length(at(i).iter().zip(line).map(|(v, l)| v - l))
            };
            let furthest = (0..grid.len()).max_by(|a, b| off(*a).total_cmp(&off(*b)));
            match furthest.filter(|i| most > 1e-9 && off(*i) > DEPARTS * most) {
                Some(i) => chosen.push((10.0 * grid[i]).round().max(1.0) / 10.0),
                None => break,
            }
        }
    }
    chosen.retain(|v| (low..=high).contains(v));
    chosen.sort_by(f64::total_cmp);
    chosen.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    chosen
}

/// Returns the grid indices of the nearest chosen values below and above a value.
fn neighbours(grid: &[f64], chosen: &[f64], value: f64) -> (usize, usize) {
    let place = |v: f64| {
        let near = |a: &usize, b: &usize| (grid[*a] - v).abs().total_cmp(&(grid[*b] - v).abs());
        (0..grid.len()).min_by(near).unwrap_or(0)
    };
    let below = chosen.iter().copied().filter(|c| *c <= value).fold(f64::NEG_INFINITY, f64::max);
    let above = chosen.iter().copied().filter(|c| *c >= value).fold(f64::INFINITY, f64::min);
    let ends = (grid.first().copied().unwrap_or(0.0), grid.last().copied().unwrap_or(0.0));
    (place(below.max(ends.0)), place(above.min(ends.1)))
}

fn length(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum::<f64>().sqrt()
}

/// Returns one row on each contact of the rig, at a load in the middle of its range.
fn rows_at(value: f64, set: &impl Fn(&mut PlannedRun, f64), rig: &RigLimits) -> Vec<PlateauRow> {
    let mut loads = rig.loads_g.clone();
    loads.sort_by(f64::total_cmp);
    let load_mass_g = loads.get(loads.len() / 2).copied().unwrap_or(1000.0);
    let contacts = rig.contacts().into_iter();
    contacts
        .filter_map(|(substrate, pins)| {
            let mut run = PlannedRun {
                substrate,
                pins,
                sweep: Sweep::Up,
                load_mass_g,
                speed_pct: rig.speeds_pct[0].midpoint(rig.speeds_pct[1]),
                dwell_s: published::DWELL_S.clamp(rig.dwells_s[0], rig.dwells_s[1]),
                repetitions: [0, 1],
                mount: 1,
                minutes: 0.0,
                asks: String::new(),
                wrap_angle_deg: rig.other_wrap_deg(),
            };
            set(&mut run, value);
            alone(&Candidate { run, late: false, after_g: None, down_from_g: None }, "1", rig, 0.0).pop()
        })
        .collect()
}
