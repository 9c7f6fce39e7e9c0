//! Candidate runs of a rig: contact, load, speed, dwell, repetitions, and, if a question depends on
//! them, the order of the loads and the time in the session.

use pinswitch_friction::{Substrate, published};

use super::question::Agenda;
use super::rig::RigLimits;
use super::runs::{PlannedRun, append};
use super::settings::{dwells_s, speeds_pct};
use crate::effects::{Covariate, Stage};
use crate::model::{Model, Term};
use crate::table::{PlateauRow, Sweep};

/// Numbers of eccentric and concentric repetitions to choose from.
const REPETITIONS: [[u32; 2]; 2] = [[4, 4], [10, 10]];

/// Number of pairs of contact and load above which only some of the loads are candidates: five
/// times the paper's.
const MOST_PLACES: usize = 400;
/// Number of these loads.
const FEW_LOADS: usize = 6;

/// A candidate run, and whether it is in the second half of the session.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) run: PlannedRun,
    pub(super) late: bool,
    /// Previous weight in grams, if a question depends on it.
    pub(super) after_g: Option<f64>,
    /// For a run with descending loads, the next heavier weight in grams, which must precede it in
    /// its mount.
    pub(super) down_from_g: Option<f64>,
}

impl Candidate {
    /// Returns whether both are recorded in one mount.
    pub(super) fn shares_mount(&self, other: &Self) -> bool {
        self.late == other.late && self.run.is_mounted_as(&other.run)
    }

    /// Returns whether both are recorded in one mount, consecutively with the same weight.
    pub(super) fn shares_load(&self, other: &Self) -> bool {
        self.shares_mount(other)
            && self.run.sweep == other.run.sweep
            && self.run.load_mass_g == other.run.load_mass_g
    }

    /// Returns the shortest run with a heavier load to precede descending loads.
    pub(super) fn lift(&self) -> Option<PlannedRun> {
        Some(PlannedRun {
            sweep: Sweep::Up,
            load_mass_g: self.down_from_g?,
            repetitions: REPETITIONS[0],
            ..self.run.clone()
        })
    }

    /// Returns the duration in minutes in addition to `others`: recording, and the changes for this
    /// run alone.
    pub(super) fn minutes<'a>(
        &self,
        mut others: impl Iterator<Item = &'a Self> + Clone,
        rig: &RigLimits,
    ) -> f64 {
        let is_loaded = others.clone().any(|other| other.shares_load(self));
        let is_heavier = |other: &Self| other.run.load_mass_g > self.run.load_mass_g;
        let can_descend = others.clone().any(|other| other.shares_mount(self) && is_heavier(other));
        let is_mounted = is_loaded || others.any(|other| other.shares_mount(self));
        let lift = self.lift().filter(|_| !can_descend);
        self.run.recording_minutes(rig)
            + lift.map_or(0.0, |lift| lift.recording_minutes(rig) + rig.minutes_per_load_change)
            + if is_loaded { 0.0 } else { rig.minutes_per_load_change }
            + if is_mounted { 0.0 } else { rig.minutes_per_mount_change }
    }
}

/// Returns all candidates within the range of the load cell.
pub(super) fn candidates(model: &Model, rig: &RigLimits, agenda: &Agenda) -> Vec<Candidate> {
    let sweeps: &[Sweep] = if agenda.asks_along(Covariate::Sweep) || agenda.asks_of_previous_loads() {
        &[Sweep::Up, Sweep::Down]
    } else {
        &[Sweep::Up]
    };
    let times: &[bool] = if agenda.asks_along(Covariate::Time) { &[false, true] } else { &[false] };
    let loads_g = if rig.contacts().len() * rig.loads_g.len() > MOST_PLACES {
        spread(&rig.loads_g, FEW_LOADS)
    } else {
        rig.loads_g.clone()
    };
    let speeds = speeds_pct(model, rig, &agenda.contributions);
    let dwells = dwells_s(model, rig, &agenda.contributions);
    let mut all = Vec::new();
    for (substrate, pins) in rig.contacts() {
        for load_mass_g in &loads_g {
            for speed_pct in &speeds {
                for dwell_s in &dwells {
                    for repetitions in REPETITIONS {
                        for sweep in sweeps {
                            for late in times {
                                let run = PlannedRun {
                                    substrate,
                                    pins: pins.clone(),
                                    sweep: *sweep,
                                    load_mass_g: *load_mass_g,
                                    speed_pct: *speed_pct,
                                    dwell_s: *dwell_s,
                                    repetitions,
                                    mount: 1,
                                    minutes: 0.0,
                                    asks: String::new(),
                                    wrap_angle_deg: rig.other_wrap_deg(),
                                };
                                let after_g = agenda
                                    .asks_of_previous_loads()
                                    .then(|| neighbour_g(&loads_g, *load_mass_g, *sweep));
                                all.push(Candidate { run, late: *late, after_g, down_from_g: None });
                            }
                        }
                    }
                }
            }
        }
    }
    let rows: Vec<PlateauRow> = all.iter().filter_map(|c| alone(c, "1", rig, 0.0).pop()).collect();
    let fits: Vec<bool> = within_cell(model, &rows, rig);
    let all: Vec<Candidate> =
        all.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(candidate, _)| candidate).collect();
    descending_from_somewhere(all)
}

/// Returns whether each row is within the range of the load cell: the tension and the predicted
/// reading. The force is largest while the load is pulled; a margin of 10 % allows for errors of
/// the model.
pub(super) fn within_cell(model: &Model, rows: &[PlateauRow], rig: &RigLimits) -> Vec<bool> {
    let is_of_the_cell = |term: &Term| match term {
        Term::Named(effect) => {
            matches!(effect.description().stage, Stage::CellScale | Stage::CellZero | Stage::CellLimit)
        }
        Term::Structure(_) => false,
    };
    // A saturated load cell reads less than the tension.
    let pulled = model.without_terms(is_of_the_cell);
    let Some(points) = model.frame.points(rows) else { return Vec::new() };
    let bears = |force_n: f64| force_n * 1.1 <= rig.cell_limit_n;
    pulled
        .predict(&points)
        .into_iter()
        .zip(model.predict(&points))
        .map(|(a, b)| bears(a) && bears(b))
        .collect()
}

/// Removes candidates with descending loads that no heavier weight can precede.
fn descending_from_somewhere(all: Vec<Candidate>) -> Vec<Candidate> {
    let mut loads: Vec<(Substrate, Vec<usize>, Vec<f64>)> = Vec::new();
    for run in all.iter().map(|c| &c.run) {
        match loads.iter_mut().find(|(substrate, pins, _)| *substrate == run.substrate && *pins == run.pins) {
            Some((.., of_contact)) => of_contact.push(run.load_mass_g),
            None => loads.push((run.substrate, run.pins.clone(), vec![run.load_mass_g])),
        }
    }
    let heavier_g = |run: &PlannedRun| {
        let (.., of_contact) = loads.iter().find(|(s, pins, _)| *s == run.substrate && *pins == run.pins)?;
        of_contact.iter().copied().filter(|g| *g > run.load_mass_g).min_by(f64::total_cmp)
    };
    all.into_iter()
        .filter_map(|candidate| match candidate.run.sweep {
            Sweep::Up => Some(candidate),
            Sweep::Down => heavier_g(&candidate.run).map(|g| Candidate { down_from_g: Some(g), ..candidate }),
        })
        .collect()
}

/// Returns the previous weight in the order of the runs of a mount: the next lighter one for
/// ascending loads; for the lightest, the heaviest of the previous contact.
fn neighbour_g(loads_g: &[f64], load_g: f64, sweep: Sweep) -> f64 {
    let lighter = loads_g.iter().copied().filter(|g| *g < load_g).fold(f64::NEG_INFINITY, f64::max);
    let heavier = loads_g.iter().copied().filter(|g| *g > load_g).fold(f64::INFINITY, f64::min);
    let most = loads_g.iter().copied().fold(load_g, f64::max);
    let found = if sweep == Sweep::Down { heavier } else { lighter };
    if found.is_finite() { found } else { most }
}

/// Returns `most` of the values, evenly spaced by rank, including the extremes.
fn spread(values: &[f64], most: usize) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let last = sorted.len().saturating_sub(1);
    let steps = most.min(sorted.len()).saturating_sub(1).max(1);
    let mut kept: Vec<f64> = (0..=steps).filter_map(|i| sorted.get(i * last / steps).copied()).collect();
    kept.dedup();
    kept
}

/// Returns the rows of a candidate in its own session, which began `begins_s` seconds before; if
/// the previous load matters, after one reading at that load.
pub(super) fn alone(candidate: &Candidate, series: &str, rig: &RigLimits, begins_s: f64) -> Vec<PlateauRow> {
    let (mut rows, mut time_s) = (Vec::new(), begins_s);
    if let Some(load_mass_g) = candidate.after_g {
        let before = PlannedRun { load_mass_g, repetitions: [1, 0], ..candidate.run.clone() };
        append(&before, &format!("before {series}"), series, rig, &mut time_s, &mut rows);
    }
    append(&candidate.run, series, series, rig, &mut time_s, &mut rows);
    rows
}

/// Returns the paper's protocol, up to a duration in minutes: contact by contact, ascending loads,
/// speed following load, one dwell.
pub(super) fn paper_protocol(rig: &RigLimits, minutes: f64) -> Vec<PlannedRun> {
    let (mut runs, mut spent): (Vec<PlannedRun>, f64) = (Vec::new(), 0.0);
    let mut loads = rig.loads_g.clone();
    loads.sort_by(f64::total_cmp);
    for (mount, (substrate, pins)) in rig.contacts().into_iter().enumerate() {
        for (i, load_mass_g) in loads.iter().enumerate() {
            let mut run = PlannedRun {
                substrate,
                pins: pins.clone(),
                sweep: Sweep::Up,
                load_mass_g: *load_mass_g,
                // 47 to 57 %, as in the paper.
                speed_pct: (47.0 + 10.0 * i as f64 / loads.len().saturating_sub(1).max(1) as f64)
                    .clamp(rig.speeds_pct[0], rig.speeds_pct[1]),
                dwell_s: published::DWELL_S.clamp(rig.dwells_s[0], rig.dwells_s[1]),
                repetitions: [12, 29],
                mount: mount + 1,
                minutes: 0.0,
                asks: String::new(),
                wrap_angle_deg: rig.other_wrap_deg(),
            };
            let change = if i == 0 { rig.minutes_per_mount_change } else { 0.0 };
            let takes = run.recording_minutes(rig) + rig.minutes_per_load_change + change;
            run.minutes = (100.0 * takes).floor() / 100.0;
            spent += run.minutes;
            if spent > minutes {
                return runs;
            }
            runs.push(run);
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effect_named;
    use crate::table::Frame;
    use crate::test_session::session;

    /// A saturated load cell reads less than the tension.
    #[test]
    fn saturated_cells_are_not_overloaded() {
        let rig = RigLimits { cell_limit_n: 58.0, ..RigLimits::default() };
        let model = Model::baseline(Frame::new(&session(1)));
        let saturated = model.with_term(Term::Named(effect_named("load_cell_saturation").unwrap()), &[50.0]);
        let heaviest = |model: &Model| {
            let all = candidates(model, &rig, &Agenda::default());
            all.iter().map(|c| c.run.load_mass_g).fold(0.0, f64::max)
        };
        let rows: Vec<PlateauRow> = paper_protocol(&rig, f64::INFINITY)
            .iter()
            .filter(|run| run.pins.is_empty())
            .flat_map(|run| super::super::runs::rows_of(std::slice::from_ref(run), &rig, ""))
            .collect();
        let rows: Vec<PlateauRow> =
            rows.into_iter().filter(|row| model.frame.points(std::slice::from_ref(row)).is_some()).collect();
        assert_eq!(within_cell(&model, &rows, &rig), within_cell(&saturated, &rows, &rig));
        assert!(within_cell(&model, &rows, &rig).contains(&false));
        assert!(heaviest(&saturated) <= heaviest(&model));
    }

    #[test]
    fn few_loads_include_the_extremes() {
        let many: Vec<f64> = (0..40).rev().map(|i| 50.0 + 100.0 * f64::from(i)).collect();
        let few = spread(&many, FEW_LOADS);
        assert_eq!(few.len(), FEW_LOADS);
        assert_eq!((few[0], few[FEW_LOADS - 1]), (50.0, 3950.0));
        assert!(few.is_sorted());
        assert_eq!(spread(&[7.0, 7.0], FEW_LOADS), [7.0]);
    }
}
