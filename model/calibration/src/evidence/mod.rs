//! Inference by one evidence: the probability of every effect and of unnamed structure on a table.
//!
//! [`Evidence::new`] turns a plateau table into a problem of `pinswitch-inference`: the friction model
//! as forward model, the effects of the vocabulary with typical sizes, and kernels over the
//! covariates that the table varies. The posterior names the effects, or the covariate of structure
//! without a name, and gives the expected error of a new session.

mod covariates;
mod forward;
mod priors;
mod structure;
#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::Substrate;
use pinswitch_inference::{
    Member, Posterior, Prediction, Problem, RandomEffect, Rows, SearchOptions, Space, infer,
};

use self::covariates::{Covariates, RowLabels};
use self::forward::{Baseline, Channel, FrictionModel, is_of_friction};
use self::priors::EffectPrior;
use self::structure::{Structure, structures};
use crate::effects::{Covariate, Vocabulary};
use crate::inference::{CONSEQUENCE, Model};
use crate::table::{Condition, Frame, PlateauRow, PlateauTable, Point};

/// Prior probability of unnamed structure.
const STRUCTURE_PROBABILITY: f64 = 0.2;
/// Scales of the half-normal priors of mount and specimen effects, relative.
const MOUNT_SCALE: f64 = 0.015;
const SPECIMEN_SCALE: f64 = 0.06;
/// Median load in newtons of the paper's rig, to which typical forces refer.
const TYPICAL_LOAD_N: f64 = 25.0;
/// Friction in shares of the load below which a change is judged by the load.
const LEAST_FRICTION: f64 = 0.02;

/// Posterior of a table.
pub struct Evidence {
    problem: Problem,
    posterior: Posterior,
    setup: Setup,
}

impl fmt::Debug for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Evidence").field("verdict", &self.posterior.verdict).finish_non_exhaustive()
    }
}

/// Session of rows to predict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Session {
    /// A later session: mounts are new, and a drift has its mean over the fitted session, since
    /// another session may drift differently.
    New,
    /// The session of the fitted table, with its times and mounts.
    Fitted,
}

/// Definitions from the fitted table, with which other tables of the rig are read.
struct Setup {
    frame: Frame,
    conditions: Arc<[Condition]>,
    /// Whether `plain` contacts have a known wrap angle.
    has_angles: bool,
    baseline: Baseline,
    priors: Arc<[EffectPrior]>,
    structures: Vec<Structure>,
    mean_time: (f64, f64),
    /// Scales of the discrepancies: highest load, and largest logarithms of speed and dwell.
    largest: [f64; 3],
    mounts: Vec<String>,
    specimens: Vec<String>,
}

impl Evidence {
    /// Infers the effects of a table among those of a vocabulary. `seed` is that of the interval of
    /// the expected error.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the table cannot be fitted.
    pub fn new(table: &PlateauTable, vocabulary: &Vocabulary, seed: u64) -> Result<Self, Diagnostic> {
        Self::searched(table, vocabulary, SearchOptions::default(), seed)
    }

    /// Fits the baseline alone, without effects and unnamed structure.
    ///
    /// # Errors
    /// As [`Evidence::new`].
    pub fn baseline(table: &PlateauTable, seed: u64) -> Result<Self, Diagnostic> {
        Self::searched(table, &Vocabulary::built_in(), SearchOptions::baseline(), seed)
    }

    fn searched(
        table: &PlateauTable,
        vocabulary: &Vocabulary,
        options: SearchOptions,
        seed: u64,
    ) -> Result<Self, Diagnostic> {
        let frame = Frame::new(&table.rows);
        let has_angles = has_plain_angles(&table.rows);
        let contacts = Contacts::new(&frame, &[], &table.rows, has_angles)?;
        let rows = Covariates::new(&frame, &contacts, &table.rows)?;
        let setup = Setup::new(frame, contacts.conditions, has_angles, &rows, vocabulary);
        let space = setup.space(&rows);
        let problem = Problem::new(space, setup.rows(&rows, Session::Fitted), rows.readings.clone())
            .map_err(|error| Diagnostic::new(error.to_string()))?;
        let posterior = infer(&problem, options, seed).ok_or_else(|| {
            Diagnostic::new("the friction model is not finite on this table")
                .with_help("check loads and readings for values that a rig cannot have")
        })?;
        Ok(Self { problem, posterior, setup })
    }

    /// Returns the posterior over hypotheses.
    pub fn posterior(&self) -> &Posterior {
        &self.posterior
    }

    /// Returns the problem of the posterior.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Returns the name of a member in reports.
    pub fn name(&self, member: Member) -> &str {
        match member {
            Member::Effect(index) => &self.problem.space().effects[index].name,
            Member::Kernel(index) => &self.problem.space().kernels[index].name,
        }
    }

    /// Returns the covariate of a member.
    pub fn covariate(&self, member: Member) -> &str {
        match member {
            Member::Effect(index) => self.setup.priors[index].effect.description().covariate.as_str(),
            Member::Kernel(index) => &self.problem.space().kernels[index].covariate,
        }
    }

    /// Predicts the readings in newtons of new series on the same rig, in the order of the rows.
    ///
    /// # Errors
    /// A [`Diagnostic`] if a row has a device that the fitted table does not have.
    pub fn predict(&self, rows: &[PlateauRow], session: Session) -> Result<Vec<Prediction>, Diagnostic> {
        let mut frame = self.setup.frame.clone();
        rows.iter().for_each(|row| frame.extend(row));
        let contacts = Contacts::new(&frame, &self.setup.conditions, rows, self.setup.has_angles)?;
        let covariates = Covariates::new(&frame, &contacts, rows)?;
        let known = self.setup.frame.devices();
        let is_new = |c: &&Condition| c.device.is_some_and(|device| device >= known);
        if let Some(new) = contacts.conditions.iter().find(is_new) {
            return Err(Diagnostic::new(format!("no series of {} in the fitted table", new.name()))
                .with_help("measure the layout, or predict only layouts that were measured"));
        }
        let setup = Setup {
            frame,
            conditions: contacts.conditions.into(),
            has_angles: self.setup.has_angles,
            baseline: self.setup.baseline.clone(),
            priors: Arc::clone(&self.setup.priors),
            structures: Vec::new(),
            mean_time: self.setup.mean_time,
            largest: self.setup.largest,
            mounts: if session == Session::New { Vec::new() } else { self.setup.mounts.clone() },
            specimens: self.setup.specimens.clone(),
        };
        let mut new_rows = setup.rows(&covariates, session);
        let bases = |structure: &Structure| match session {
            Session::New => structure.bases_of_new_session(&covariates),
            Session::Fitted => structure.bases(&covariates),
        };
        new_rows.bases = self.setup.structures.iter().map(bases).collect();
        let predicted = self
            .posterior
            .predict(&self.problem, &new_rows)
            .map_err(|error| Diagnostic::new(error.to_string()))?;
        let mut in_order = vec![Prediction { mean: 0.0, sd: 0.0 }; rows.len()];
        for (place, prediction) in covariates.source.iter().zip(predicted) {
            in_order[*place] = prediction;
        }
        Ok(in_order)
    }
}

/// Conditions of rows, among which `plain` contacts differ in their wrap angle.
struct Contacts {
    conditions: Vec<Condition>,
    /// Condition of each row.
    of_row: Vec<usize>,
}

impl Contacts {
    /// Finds the conditions of rows among the known ones, and adds the others. Without
    /// `has_angles`, the exponent of a `plain` contact is free and its wrap angle is 1 rad.
    fn new(
        frame: &Frame,
        known: &[Condition],
        rows: &[PlateauRow],
        has_angles: bool,
    ) -> Result<Self, Diagnostic> {
        let mut contacts = Self { conditions: known.to_vec(), of_row: Vec::new() };
        for row in rows {
            let kind = frame.condition_of(row).and_then(|i| frame.conditions.get(i));
            let kind = kind.ok_or_else(|| Diagnostic::new("a row has a condition that the table lacks"))?;
            let is_free = row.substrate.is_none() && has_angles;
            let wrap_rad = if is_free { row.wrap_angle_deg.to_radians() } else { kind.wrap_rad };
            let condition = Condition { wrap_rad, ..kind.clone() };
            let index = contacts.conditions.iter().position(|c| *c == condition);
            contacts.of_row.push(index.unwrap_or(contacts.conditions.len()));
            if index.is_none() {
                contacts.conditions.push(condition);
            }
        }
        Ok(contacts)
    }
}

/// Returns whether the wrap angle of `plain` contacts is known and not the published one.
fn has_plain_angles(rows: &[PlateauRow]) -> bool {
    let published = pinswitch_friction::published::WRAP_ANGLE_DEG;
    rows.iter().any(|row| row.substrate.is_none() && row.wrap_angle_deg != published)
}

impl Setup {
    fn new(
        frame: Frame,
        conditions: Vec<Condition>,
        has_angles: bool,
        rows: &Covariates,
        vocabulary: &Vocabulary,
    ) -> Self {
        let model = Model::baseline(frame.clone());
        let first = Model::device_constants(0)[0];
        let device_means: Vec<f64> =
            model.values().iter().skip(first).take(2 * frame.devices()).map(|x| libm::log(*x)).collect();
        let baseline = Baseline::new(&conditions, device_means);
        let force_unit = Self::force_unit(rows);
        let highest = rows.readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let priors = EffectPrior::of_vocabulary(vocabulary, &frame, highest, force_unit);
        let has_silicone = conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone));
        let has_both = has_silicone && conditions.iter().any(Condition::has_pins);
        let structures = structures(rows, has_both, force_unit);
        let mean = |value: fn(&Point) -> f64| rows.column(value).iter().sum::<f64>() / rows.len() as f64;
        let most = |value: fn(&Point) -> f64| rows.column(value).into_iter().fold(1e-9, f64::max);
        let factor = |names: Vec<String>| {
            let is_random = names.len() > 1 && 5 * names.len() < 4 * rows.series_count();
            if is_random { names } else { Vec::new() }
        };
        Self {
            mean_time: (mean(|p| p.time), mean(|p| p.travel)),
            largest: [most(|p| p.load_n), most(|p| p.log_speed.abs()), most(|p| p.log_dwell.abs())],
            mounts: factor(rows.level_names(|label| &label.mount)),
            specimens: factor(rows.level_names(|label| &label.specimen)),
            frame,
            conditions: conditions.into(),
            has_angles,
            baseline,
            priors: priors.into(),
            structures,
        }
    }

    /// Returns the factor of typical forces, from the loads of the table.
    fn force_unit(rows: &Covariates) -> f64 {
        let mut loads = rows.column(|p| p.load_n);
        loads.sort_by(f64::total_cmp);
        let median = loads.get(loads.len() / 2).copied().unwrap_or(TYPICAL_LOAD_N);
        (median / TYPICAL_LOAD_N).max(1.0)
    }

    fn space(&self, rows: &Covariates) -> Space {
        let force_unit = Self::force_unit(rows);
        let usual = |i: &usize| self.priors[*i].is_usual();
        let random = |name: &str, names: &[String], channel: Channel, scale: f64| RandomEffect {
            name: name.to_owned(),
            channel: channel.index(),
            scale,
            levels: names.len(),
            is_redrawn: name == "mount",
        };
        let has_pins = self.conditions.iter().any(Condition::has_pins);
        let specimen_channel = if has_pins { Channel::Pins } else { Channel::Friction };
        Space {
            constants: self.baseline.constants(),
            effects: self.priors.iter().map(|prior| prior.space(force_unit)).collect(),
            kernels: self.structures.iter().map(Structure::space).collect(),
            random_effects: vec![
                random("mount", &self.mounts, Channel::Friction, MOUNT_SCALE),
                random("specimen", &self.specimens, specimen_channel, SPECIMEN_SCALE),
            ],
            usual_effects: (0..self.priors.len()).filter(usual).collect(),
            structure_probability: STRUCTURE_PROBABILITY,
            series_scale_channel: Channel::Friction.index(),
        }
    }

    /// Returns rows for the inference; those of a new session have no known mounts and the mean
    /// time of the fitted session.
    fn rows(&self, rows: &Covariates, session: Session) -> Rows {
        let levels = |names: &[String], name: fn(&RowLabels) -> &String| -> Vec<Option<usize>> {
            rows.labels.iter().map(|label| names.binary_search(name(label)).ok()).collect()
        };
        let mut forward = FrictionModel {
            points: rows.points.clone(),
            mean_time: self.mean_time,
            conditions: Arc::clone(&self.conditions),
            baseline: self.baseline.clone(),
            priors: Arc::clone(&self.priors),
        };
        if session == Session::New {
            forward.points = forward.points_at_mean_time();
        }
        let discrepancies = self.priors.iter().map(|prior| self.discrepancies(prior, &forward.points));
        let relevant = self.priors.iter().map(|prior| relevant_changes(prior, rows));
        Rows {
            series: rows.series.clone(),
            direction: rows.points.iter().map(|p| p.sign > 0.0).collect(),
            order: rows.order.clone(),
            load: rows.column(|p| p.load_n),
            levels: vec![
                levels(&self.mounts, |label| &label.mount),
                levels(&self.specimens, |label| &label.specimen),
            ],
            bases: self.structures.iter().map(|structure| structure.bases(rows)).collect(),
            discrepancies: discrepancies.collect(),
            relevant: relevant.collect(),
            is_new_session: session == Session::New,
            forward: Box::new(forward),
        }
    }

    /// Returns the factors of an effect's contribution where its form may be wrong.
    fn discrepancies(&self, prior: &EffectPrior, points: &[Point]) -> Vec<Vec<f64>> {
        let column = |value: &dyn Fn(&Point) -> f64| -> Vec<f64> { points.iter().map(value).collect() };
        // Legendre polynomials of degree one and two over a share 0..1.
        let curved = |share: &dyn Fn(&Point) -> f64| -> [Vec<f64>; 2] {
            let linear = column(&|p| 2.0 * share(p) - 1.0);
            let square = linear.iter().map(|u| 1.5 * u * u - 0.5).collect();
            [linear, square]
        };
        let [load, speed, dwell] = self.largest;
        let mut columns = Vec::new();
        for covariate in prior.discrepant_covariates() {
            match covariate {
                Covariate::Load => columns.extend(curved(&|p| p.load_n / load)),
                Covariate::Time => columns.extend(curved(&|p| p.time)),
                Covariate::Position => columns.extend(curved(&|p| p.position)),
                Covariate::Speed => columns.push(column(&|p| p.log_speed / speed)),
                Covariate::Dwell => columns.push(column(&|p| p.log_dwell / dwell)),
                Covariate::Repetition => {
                    columns.push(column(&|p| libm::exp(-(p.repetition - 1.0) / 2.0) - 0.5));
                    columns.push(column(&|p| p.sign));
                }
                Covariate::Condition => {
                    let devices: Vec<usize> = self.conditions.iter().filter_map(|c| c.device).collect();
                    let of = |p: &Point| self.conditions[p.condition].device;
                    if devices.len() > 1 {
                        columns.extend(
                            devices
                                .iter()
                                .map(|device| column(&|p| if of(p) == Some(*device) { 1.0 } else { 0.0 })),
                        );
                    }
                }
                Covariate::Direction | Covariate::Sweep => {}
            }
        }
        columns
    }
}

/// Returns the smallest relevant change of each reading by an effect: a share of the friction, or of
/// the reading for effects on the load cell or against the motion.
fn relevant_changes(prior: &EffectPrior, rows: &Covariates) -> Vec<f64> {
    let is_friction = is_of_friction(prior.effect.description().stage);
    let change = |(point, reading): (&Point, &f64)| {
        let of = if is_friction { reading - point.load_n } else { *reading };
        CONSEQUENCE * of.abs().max(LEAST_FRICTION * point.load_n).max(1e-9)
    };
    rows.points.iter().zip(&rows.readings).map(change).collect()
}
