//! Inference by one evidence: the probability of every effect and of unnamed structure on a table.
//!
//! [`Evidence::new`] turns a plateau table into a problem of `pinswitch-inference`: the friction model
//! as forward model, the effects of the vocabulary with typical sizes, and kernels over the
//! covariates that the table varies. The posterior names the effects, or the covariate of structure
//! without a name, and gives the expected error of a new session.

mod access;
mod covariates;
mod fitted;
mod formula_values;
mod forward;
mod groups;
mod levels;
mod priors;
mod session_kernels;
mod structure;
mod table_kernels;
#[cfg(test)]
mod tests;
mod time_kernels;
mod variant;

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

pub use fitted::Fitted;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::Substrate;
use pinswitch_inference::{
    Member, Posterior, Prediction, Problem, RandomEffect, Rows, SearchOptions, Space, infer,
};

use self::covariates::{Covariates, RowLabels};
use self::formula_values::FormulaValues;
pub(crate) use self::forward::Channel;
use self::forward::{Baseline, FrictionModel, is_of_friction};
use self::priors::EffectPrior;
use self::structure::Structure;
use self::table_kernels::structures;
use crate::effects::Vocabulary;
use crate::model::{DiscrepancyFactor, Largest, Model};
use crate::table::{Condition, Frame, PlateauRow, Point, Unknown};

/// Smallest relevant change of friction or reading, as a share.
pub const CONSEQUENCE: f64 = 0.05;

/// Prior probability of unnamed structure.
pub(crate) const STRUCTURE_PROBABILITY: f64 = 0.2;
/// Names of the random effects, in their order.
const MOUNT: &str = "mount";
const SPECIMEN: &str = "specimen";

/// Scales of the half-normal priors of mount and specimen effects, relative.
pub(crate) const MOUNT_SCALE: f64 = 0.0125;
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
    /// Index in the table of each row of the problem.
    source: Vec<usize>,
    points: Vec<Point>,
    /// Number of the series of each row of the problem.
    series: Vec<usize>,
    readings: Vec<f64>,
    /// Session and specimen of each row of the problem.
    groups: Vec<[String; 2]>,
}

impl fmt::Debug for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Evidence").field("reported", &self.posterior.reported).finish_non_exhaustive()
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
    vocabulary: Vocabulary,
    baseline: Baseline,
    priors: Arc<[EffectPrior]>,
    structures: Vec<Structure>,
    /// Whether a structure acts on half loads.
    moves_half_loads: bool,
    mean_time: (f64, f64),
    largest: Largest,
    mounts: Vec<String>,
    specimens: Vec<String>,
}

impl Evidence {
    /// Infers the effects of a table among those of a vocabulary. `seed` is that of the interval of
    /// the expected error.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the table cannot be fitted.
    pub fn new(rows: &[PlateauRow], vocabulary: &Vocabulary, seed: u64) -> Result<Self, Diagnostic> {
        Self::searched(rows, vocabulary, &BTreeSet::new(), SearchOptions::default(), seed)
    }

    /// Fits the baseline alone, without effects and unnamed structure.
    ///
    /// # Errors
    /// As [`Evidence::new`].
    pub fn baseline(rows: &[PlateauRow], seed: u64) -> Result<Self, Diagnostic> {
        Self::of_forms(rows, &Vocabulary::built_in(), &BTreeSet::new(), seed)
    }

    /// Fits the baseline alone, with the effects of a vocabulary for later hypotheses; some of them are
    /// `forms` of a library.
    pub(crate) fn of_forms(
        rows: &[PlateauRow],
        vocabulary: &Vocabulary,
        forms: &BTreeSet<&str>,
        seed: u64,
    ) -> Result<Self, Diagnostic> {
        Self::searched(rows, vocabulary, forms, SearchOptions::baseline(), seed)
    }

    fn searched(
        rows: &[PlateauRow],
        vocabulary: &Vocabulary,
        forms: &BTreeSet<&str>,
        options: SearchOptions,
        seed: u64,
    ) -> Result<Self, Diagnostic> {
        let frame = Frame::new(rows);
        let unknown = rows.first().map(|row| row.unknown).unwrap_or_default();
        let rows = Covariates::new(&frame, rows)?;
        let setup = Setup::new(frame, &rows, vocabulary, forms, unknown);
        let space = setup.space(&rows);
        let problem = Problem::new(space, setup.rows(&rows, Session::Fitted), rows.readings.clone())
            .map_err(|error| Diagnostic::new(codes::MODEL_NOT_FINITE, error.to_string()))?;
        let posterior = infer(&problem, options, seed).ok_or_else(|| {
            Diagnostic::new(codes::MODEL_NOT_FINITE, "the friction model is not finite on this table")
                .with_help("check loads and readings for values that a rig cannot have")
        })?;
        let groups = rows
            .labels
            .iter()
            .map(|l| (l.session.clone(), l.specimen.clone()))
            .map(|(session, specimen)| [session, specimen])
            .collect();
        let Covariates { source, points, series, readings, .. } = rows;
        Ok(Self { problem, posterior, setup, source, points, series, readings, groups })
    }

    /// Replaces the gross errors by those of another posterior of the same table.
    pub(crate) fn with_outliers_of(mut self, other: &Self) -> Self {
        self.posterior.outliers.clone_from(&other.posterior.outliers);
        self
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
        let covariates = Covariates::new(&frame, rows)?;
        let known = self.setup.frame.devices();
        let is_new = |c: &&Condition| c.device.is_some_and(|device| device >= known);
        if let Some(new) = frame.conditions.iter().find(is_new) {
            return Err(Diagnostic::new(
                codes::MODEL_BEYOND_RIG,
                format!("no series of {} in the fitted table", new.name()),
            )
            .with_help("measure the layout, or predict only layouts that were measured"));
        }
        let setup = Setup {
            conditions: frame.conditions.clone().into(),
            frame,
            vocabulary: self.setup.vocabulary.clone(),
            baseline: self.setup.baseline.clone(),
            priors: Arc::clone(&self.setup.priors),
            structures: Vec::new(),
            moves_half_loads: self.setup.moves_half_loads,
            mean_time: self.setup.mean_time,
            largest: self.setup.largest,
            mounts: if session == Session::New { Vec::new() } else { self.setup.mounts.clone() },
            specimens: self.setup.specimens.clone(),
        };
        let mut new_rows = setup.rows(&covariates, session);
        new_rows.bases = structure::bases(&self.setup.structures, &covariates, session);
        let predicted = self
            .posterior
            .predict(&self.problem, &new_rows)
            .map_err(|error| Diagnostic::new(codes::MODEL_NOT_FINITE, error.to_string()))?;
        let mut in_order = vec![Prediction { mean: 0.0, sd: 0.0 }; rows.len()];
        for (place, prediction) in covariates.source.iter().zip(predicted) {
            in_order[*place] = prediction;
        }
        Ok(in_order)
    }
}

impl Setup {
    fn new(
        frame: Frame,
        rows: &Covariates,
        vocabulary: &Vocabulary,
        forms: &BTreeSet<&str>,
        unknown: Unknown,
    ) -> Self {
        let conditions = frame.conditions.clone();
        let model = Model::baseline(frame.clone());
        let first = Model::device_constants(0)[0];
        let device_means: Vec<f64> =
            model.values().iter().skip(first).take(2 * frame.devices()).map(|x| libm::log(*x)).collect();
        let baseline = Baseline::new(&conditions, device_means);
        let force_unit = Self::force_unit(rows);
        let highest = rows.readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let priors = EffectPrior::of_vocabulary(vocabulary, &frame, highest, force_unit, forms, unknown);
        let has_silicone = conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone));
        let has_both = has_silicone && conditions.iter().any(Condition::has_pins);
        let devices = conditions.iter().filter(|c| c.device.is_some()).map(Condition::layout).collect();
        let structures = structures(rows, has_both, force_unit, devices);
        let mean = |value: fn(&Point) -> f64| rows.column(value).iter().sum::<f64>() / rows.len() as f64;
        let most = |value: fn(&Point) -> f64| rows.column(value).into_iter().fold(1e-9, f64::max);
        let factor = |names: Vec<String>| {
            let is_random = names.len() > 1 && 5 * names.len() < 4 * rows.series_count();
            if is_random { names } else { Vec::new() }
        };
        Self {
            mean_time: (mean(|p| p.time), mean(|p| p.travel)),
            largest: Largest {
                load_n: most(|p| p.load_n),
                log_speed: most(|p| p.log_speed.abs()),
                log_dwell: most(|p| p.log_dwell.abs()),
            },
            mounts: factor(rows.level_names(|label| &label.mount)),
            specimens: factor(rows.level_names(|label| &label.specimen)),
            frame,
            conditions: conditions.into(),
            vocabulary: vocabulary.clone(),
            baseline,
            priors: priors.into(),
            moves_half_loads: structures.iter().any(|s| s.channel == Channel::HalfLoad),
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
            is_redrawn: name == MOUNT,
        };
        let has_pins = self.conditions.iter().any(Condition::has_pins);
        let specimen_channel = if has_pins { Channel::Pins } else { Channel::Friction };
        Space {
            constants: self.baseline.constants(),
            effects: self.priors.iter().map(|prior| prior.space(force_unit)).collect(),
            kernels: structure::kernels(&self.structures),
            random_effects: vec![
                random(MOUNT, &self.mounts, Channel::Friction, MOUNT_SCALE),
                random(SPECIMEN, &self.specimens, specimen_channel, SPECIMEN_SCALE),
            ],
            usual_effects: (0..self.priors.len()).filter(usual).collect(),
            structure_probability: STRUCTURE_PROBABILITY,
            series_scale_channel: Channel::Friction.index(),
            curved_channels: Channel::curved(self.frame.devices()).into_iter().map(Channel::index).collect(),
            // Another tendon changes the friction on both materials.
            joint_channels: vec![[Channel::Pins.index(), Channel::Silicone.index()]],
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
            formula_values: FormulaValues::default(),
            moves_half_loads: self.moves_half_loads,
        };
        if session == Session::New {
            forward.points = forward.points_at_mean_time();
        }
        let discrepancies = self.priors.iter().map(|prior| self.discrepancies(prior, &forward.points));
        let relevant = self.priors.iter().map(|prior| relevant_changes(prior, rows));
        Rows {
            series: rows.series.clone(),
            direction: rows.points.iter().map(|p| p.sign > 0.0).collect(),
            sessions: rows.points.iter().map(|p| p.session_group.unwrap_or(0)).collect(),
            order: rows.order.clone(),
            load: rows.column(|p| p.load_n),
            levels: vec![
                levels(&self.mounts, |label| &label.mount),
                levels(&self.specimens, |label| &label.specimen),
            ],
            bases: structure::fitted_bases(&self.structures),
            discrepancies: discrepancies.collect(),
            relevant: relevant.collect(),
            is_new_session: session == Session::New,
            forward: Box::new(forward),
        }
    }

    /// Returns the factors of the size of an effect where its form may be wrong.
    fn discrepancy_factors(&self, prior: &EffectPrior) -> Vec<DiscrepancyFactor> {
        let devices = self.conditions.iter().filter(|c| c.device.is_some()).count();
        let covariates = prior.discrepant_covariates().into_iter();
        covariates.flat_map(|covariate| self.largest.factors(covariate, devices)).collect()
    }

    /// Returns the values of these factors at points.
    fn discrepancies(&self, prior: &EffectPrior, points: &[Point]) -> Vec<Vec<f64>> {
        let value = |factor: DiscrepancyFactor| -> Vec<f64> {
            points.iter().map(|p| factor.value(p, &self.conditions[p.condition])).collect()
        };
        self.discrepancy_factors(prior).into_iter().map(value).collect()
    }
}

/// Returns the smallest relevant change of a friction or reading in newtons.
pub(crate) fn change_of_consequence(point: &Point, of_n: f64) -> f64 {
    CONSEQUENCE * of_n.abs().max(LEAST_FRICTION * point.load_n).max(1e-9)
}

/// Returns the smallest relevant change of each reading by an effect: a share of the friction, or of
/// the reading for effects on the load cell or against the motion.
fn relevant_changes(prior: &EffectPrior, rows: &Covariates) -> Vec<f64> {
    let is_friction = is_of_friction(prior.effect.description().stage);
    let change = |(point, reading): (&Point, &f64)| {
        let of = if is_friction { reading - point.load_n } else { *reading };
        change_of_consequence(point, of)
    };
    rows.points.iter().zip(&rows.readings).map(change).collect()
}
