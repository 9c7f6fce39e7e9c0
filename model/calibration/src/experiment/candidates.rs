//! Candidate runs of a rig: contact, load, speed, dwell, repetitions, and, if a question depends on
//! them, the order of the loads and the time in the session.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::question::Agenda;
use super::rig::RigLimits;
use super::runs::{PlannedRun, append};
use crate::effects::{Covariate, Stage};
use crate::model::{Model, Term};
use crate::table::{PlateauRow, Sweep};

/// Numbers of eccentric and concentric repetitions to choose from.
const REPETITIONS: [[u32; 2]; 2] = [[4, 4], [10, 10]];
/// Repetitions of the paper's protocol.
const PAPER_REPETITIONS: [u32; 2] = [12, 29];
/// Most candidates, of which there is a random sample: a rig may have many contacts and weights.
const MOST_CANDIDATES: usize = 6_000;
/// Most elements of the information of all candidates (80 MB).
const MOST_ELEMENTS: usize = 10_000_000;
/// Seed of the sample.
const SEED: u64 = 1;
/// Factor of a predicted force that allows for errors of the model.
const FORCE_MARGIN: f64 = 1.1;

/// A candidate run.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) run: PlannedRun,
    /// Whether it is late in the session.
    pub(super) late: bool,
    /// Weight in grams before it: the next lighter one for ascending loads, the next heavier one for
    /// descending loads, which must precede it in its mount.
    pub(super) after_g: f64,
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

    /// Returns the shortest run with a heavier load that must precede descending loads, if none of the
    /// others does.
    pub(super) fn lift<'a>(&self, mut others: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let is_heavier =
            |other: &Self| other.shares_mount(self) && other.run.load_mass_g > self.run.load_mass_g;
        let needs_one = self.run.sweep == Sweep::Down && !others.any(is_heavier);
        needs_one.then(|| {
            let mut lift = self.clone();
            (lift.run.sweep, lift.run.load_mass_g) = (Sweep::Up, self.after_g);
            lift.run.repetitions = REPETITIONS[0];
            lift
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
        let lift = self.lift(others.clone());
        let is_mounted = is_loaded || others.any(|other| other.shares_mount(self));
        self.run.recording_minutes(rig)
            + lift.map_or(0.0, |lift| lift.run.recording_minutes(rig) + rig.minutes_per_load_change)
            + if is_loaded { 0.0 } else { rig.minutes_per_load_change }
            + if is_mounted { 0.0 } else { rig.minutes_per_mount_change }
    }
}

/// Returns all candidates within the range of the load cell.
pub(super) fn candidates(model: &Model, rig: &RigLimits, agenda: &Agenda) -> Vec<Candidate> {
    let asks_of_order = agenda.asks_along(Covariate::Sweep) || agenda.asks_of_previous_loads();
    let sweeps: &[Sweep] = if asks_of_order { &[Sweep::Up, Sweep::Down] } else { &[Sweep::Up] };
    let times: &[bool] = if agenda.asks_along(Covariate::Time) { &[false, true] } else { &[false] };
    let speeds = rig.speeds(agenda.asks_of_formulas_along(Covariate::Speed));
    let dwells = rig.dwells(agenda.asks_of_formulas_along(Covariate::Dwell));
    let mut loads_g = rig.loads_g.clone();
    loads_g.sort_by(f64::total_cmp);
    let mut all = Vec::new();
    for contact in rig.contacts() {
        let runs = loads_g.iter().map(|load_g| PlannedRun::usual(&contact, *load_g, rig));
        let of_contact = runs.map(|run| Candidate { run, late: false, after_g: 0.0 }).collect();
        let mut of_contact = within_cell_only(of_contact, model, rig);
        let loads: Vec<f64> = of_contact.iter().map(|c| c.run.load_mass_g).collect();
        of_contact = with_each(of_contact, &speeds, |c, speed| c.run.speed_pct = *speed);
        of_contact = with_each(of_contact, &dwells, |c, dwell| c.run.dwell_s = *dwell);
        of_contact = with_each(of_contact, &REPETITIONS, |c, repetitions| c.run.repetitions = *repetitions);
        of_contact = with_each(of_contact, sweeps, |c, sweep| c.run.sweep = *sweep);
        of_contact = with_each(of_contact, times, |c, late| c.late = *late);
        for candidate in &mut of_contact {
            let load_g = candidate.run.load_mass_g;
            let neighbour = match candidate.run.sweep {
                Sweep::Up => loads.iter().rev().find(|g| **g < load_g).or(loads.last()),
                Sweep::Down => loads.iter().find(|g| **g > load_g),
            };
            candidate.after_g = neighbour.copied().unwrap_or(load_g);
        }
        // No heavier weight precedes the heaviest one.
        of_contact.retain(|c| c.run.sweep == Sweep::Up || c.after_g > c.run.load_mass_g);
        all.extend(of_contact);
    }
    let columns = model.values().len() + agenda.contributions.len();
    let most = (MOST_ELEMENTS / columns / columns).min(MOST_CANDIDATES).min(all.len());
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut order: Vec<usize> = (0..all.len()).collect();
    for place in 0..most {
        let other = random.random_range(place..all.len());
        order.swap(place, other);
    }
    order.truncate(most);
    order.sort_unstable();
    within_cell_only(order.into_iter().map(|i| all[i].clone()).collect(), model, rig)
}

/// Returns each candidate with each of some values.
fn with_each<T>(all: Vec<Candidate>, values: &[T], set: impl Fn(&mut Candidate, &T)) -> Vec<Candidate> {
    let of = |candidate: &Candidate, value: &T| {
        let mut candidate = candidate.clone();
        set(&mut candidate, value);
        candidate
    };
    all.iter()
        .flat_map(|candidate| values.iter().map(|value| of(candidate, value)).collect::<Vec<_>>())
        .collect()
}

fn within_cell_only(all: Vec<Candidate>, model: &Model, rig: &RigLimits) -> Vec<Candidate> {
    let rows: Vec<PlateauRow> = all.iter().filter_map(|c| alone(c, "1", rig, 0.0, false).pop()).collect();
    let fits = within_cell(model, &rows, rig);
    all.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(candidate, _)| candidate).collect()
}

/// Returns whether each row is within the range of the load cell: the tension and the predicted
/// reading. The force is largest while the load is pulled.
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
    let fits = |force_n: f64| force_n * FORCE_MARGIN <= rig.cell_limit_n;
    let readings_n = model.predict(&points);
    pulled.predict(&points).into_iter().zip(readings_n).map(|(a, b)| fits(a) && fits(b)).collect()
}

/// Returns the rows of a candidate in its own session, which began `begins_s` seconds before; with
/// memory, after one reading at the weight before it.
pub(super) fn alone(
    candidate: &Candidate,
    series: &str,
    rig: &RigLimits,
    begins_s: f64,
    has_memory: bool,
) -> Vec<PlateauRow> {
    let (mut rows, mut time_s) = (Vec::new(), begins_s);
    if has_memory {
        let load_mass_g = candidate.after_g;
        let before = PlannedRun { load_mass_g, repetitions: [1, 0], ..candidate.run.clone() };
        append(&before, &format!("before {series}"), series, rig, &mut time_s, &mut rows);
    }
    append(&candidate.run, series, series, rig, &mut time_s, &mut rows);
    rows
}

/// Returns the paper's protocol from its beginning, up to a duration in minutes: contact by contact, ascending loads,
/// speed following load, one dwell.
pub fn paper_runs(rig: &RigLimits, minutes: f64) -> Vec<PlannedRun> {
    let (mut runs, mut spent): (Vec<PlannedRun>, f64) = (Vec::new(), 0.0);
    let mut loads = rig.loads_g.clone();
    loads.sort_by(f64::total_cmp);
    for (mount, contact) in rig.contacts().iter().enumerate() {
        for (i, load_mass_g) in loads.iter().enumerate() {
            // 47 to 57 %, as in the paper.
            let speed_pct = 47.0 + 10.0 * i as f64 / loads.len().saturating_sub(1).max(1) as f64;
            let mut run = PlannedRun {
                speed_pct: speed_pct.clamp(rig.speeds_pct[0], rig.speeds_pct[1]),
                repetitions: PAPER_REPETITIONS,
                mount: mount + 1,
                ..PlannedRun::usual(contact, *load_mass_g, rig)
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
        let saturated = model.with_term(Term::named(effect_named("load_cell_saturation").unwrap()), &[50.0]);
        let heaviest = |model: &Model| {
            let all = candidates(model, &rig, &Agenda::default());
            all.iter().map(|c| c.run.load_mass_g).fold(0.0, f64::max)
        };
        let rows: Vec<PlateauRow> = paper_runs(&rig, f64::INFINITY)
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
}
