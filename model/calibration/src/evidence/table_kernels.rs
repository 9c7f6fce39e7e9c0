//! Kernels that a table can show over its covariates, none finer than the sampling.

use std::ops::RangeInclusive;
use std::rc::Rc;

use pinswitch_inference::kernel;

use super::covariates::{Covariates, RowLabels, distinct};
use super::forward::Channel;
use super::levels::{Levels, RowFactors};
use super::structure::{Record, Structure};
use super::variant::{BasisOfRows, Variant};
use crate::effects::{Abscissa, REFERENCE_LOAD_N};
use crate::table::Point;

/// Scale of the standard deviation of structure: a force in newtons, and relative.
const FORCE_SCALE_N: f64 = 0.3;
const RELATIVE_SCALE: f64 = 0.08;
/// The same for the scale of the load cell, which is more exact than friction.
const GAIN_SCALE: f64 = 0.02;
/// Largest rank of Brownian motion: what is finer has less than a hundredth of its variance.
pub(super) const BROWNIAN_RANK: usize = 24;
/// Most loads and most conditions that are levels of a factor.
const MOST_LOADS: usize = 14;
const MOST_LEVELS: usize = 20;
/// Prior probability that of the levels of a factor one differs from the others.
const ONE_LEVEL_PROBABILITY: f64 = 0.5;
/// Share of the range of positions by which the interval of smooth functions is longer at each end.
const WIDENING: f64 = 0.125;
/// Largest rank of Brownian motion along the stroke, whose edges are between two readings.
const POSITION_RANK: usize = 160;
/// Most positions of stops that are levels of a factor, and the prior probability that a pattern along the stroke has its own
/// value at each stop, or at one.
const MOST_STOPS: usize = 48;
const STOP_PROBABILITY: f64 = 0.5;
/// Repetitions after which the memory of the previous load has decayed to 1/e.
pub(super) const MEMORY_REPETITIONS: [f64; 2] = [20.0, 1e6];
/// Channels of structure that may be a force or friction.
const COMMON: &[Channel] = &[Channel::Reading, Channel::Drag, Channel::Friction, Channel::DirectionFriction];
/// The same for what may also change the scale of the load cell: who measures, how fast, and after which pause.
const MEASURING: &[Channel] =
    &[Channel::Reading, Channel::Drag, Channel::Friction, Channel::DirectionFriction, Channel::Gain];

/// Value of a covariate at each row.
type ValuesOfRows = fn(&Covariates) -> Vec<f64>;

/// Collects the kernels of a table.
pub(super) struct Collector<'a> {
    pub(super) rows: &'a Covariates,
    force_unit: f64,
    has_both_materials: bool,
    /// Layout of each device.
    devices: Vec<String>,
    structures: Vec<Structure>,
}

/// Returns the kernels that a table supports. Forces are `force_unit` times larger than on the
/// paper's rig.
pub(super) fn structures(
    rows: &Covariates,
    has_both_materials: bool,
    force_unit: f64,
    devices: Vec<String>,
) -> Vec<Structure> {
    let mut collector = Collector { rows, force_unit, has_both_materials, devices, structures: Vec::new() };
    // Without a clock the order of the series is not known.
    let has_clock = distinct(&rows.column(|p| p.time_s)) > 1;
    if has_clock {
        collector.time();
        collector.wandering();
        collector.previous_load();
    }
    collector.gross_errors();
    collector.along_a_series();
    collector.load();
    collector.protocol();
    collector.factors();
    collector.structures
}

impl Collector<'_> {
    /// Adds a kernel whose bases are scaled to unit variance.
    pub(super) fn add(
        &mut self,
        name: &str,
        covariate: &'static str,
        record: Record,
        channels: &[Channel],
        bases: Vec<BasisOfRows>,
    ) {
        let variants = self.variants(bases, 1.0);
        self.add_variants(name, covariate, record, channels, variants);
    }

    /// Returns the variants of bases that are scaled to unit variance, of this total probability.
    pub(super) fn variants(&self, bases: Vec<BasisOfRows>, probability: f64) -> Vec<Variant> {
        let probability = probability / bases.len().max(1) as f64;
        let variant = |basis| Variant::of_unit_variance(basis, self.rows, probability);
        bases.into_iter().filter_map(variant).collect()
    }

    /// Adds a kernel with these variants for each channel, and returns those added.
    pub(super) fn add_variants(
        &mut self,
        name: &str,
        covariate: &'static str,
        record: Record,
        channels: &[Channel],
        variants: Vec<Variant>,
    ) -> &mut [Structure] {
        let known = self.structures.len();
        // A new session draws again what a model file does not keep.
        let is_session_bound = matches!(record, Record::Time | Record::Nothing);
        if variants.is_empty() {
            return &mut [];
        }
        let bases = Rc::new(variants);
        for channel in channels {
            // Without two materials their friction is the friction, and nothing switches.
            let is_of_both = matches!(channel, Channel::Pins | Channel::Silicone | Channel::HalfLoad);
            if is_of_both && !self.has_both_materials {
                continue;
            }
            let scale = match channel {
                Channel::Gain => GAIN_SCALE,
                channel if channel.is_force() => FORCE_SCALE_N * self.force_unit,
                _ => RELATIVE_SCALE,
            };
            self.structures.push(Structure {
                covariate,
                name: format!("{} over {name}", self.words(*channel)),
                channel: *channel,
                record,
                is_session_bound,
                scale,
                bases: bases.clone(),
                session_levels: Vec::new(),
            });
        }
        &mut self.structures[known..]
    }

    fn words(&self, channel: Channel) -> String {
        match channel {
            Channel::HalfLoadOf(device) => format!("{} of {}", channel.as_str(), self.devices[device]),
            _ => channel.as_str().to_owned(),
        }
    }

    /// Returns the half load of all devices and, of several, of each: another cast of one part may be softer.
    pub(super) fn half_loads(&self) -> Vec<Channel> {
        let of_one = if self.devices.len() > 1 { 0..self.devices.len() } else { 0..0 };
        std::iter::once(Channel::HalfLoad).chain(of_one.map(Channel::HalfLoadOf)).collect()
    }

    fn along_a_series(&mut self) {
        let position = |rows: &Covariates| rows.column(|p| p.position);
        let at = position(self.rows);
        let stops = Levels::new(self.rows, Rc::new(stop));
        if distinct(&at) > 2 {
            let scale = Interval::of(&at);
            // Cosines are level at the ends of their interval. In a wider one, few of them have a slope at the ends of the
            // stroke (Solin and Särkkä 2020).
            let wide = scale.widened(WIDENING);
            let waves: BasisOfRows =
                Rc::new(move |rows| kernel::smooth(&wide.shares(&position(rows)), 10, 1.0));
            // A worn spot has edges, which many readings show exactly.
            let rank = distinct(&at).min(POSITION_RANK);
            let steps: BasisOfRows =
                Rc::new(move |rows| kernel::brownian(&scale.shares(&position(rows)), rank));
            // A pattern that repetitions show just as well, where each has a position of its own.
            let levels = if (3..=MOST_STOPS).contains(&stops.count()) {
                stops.variants(ONE_LEVEL_PROBABILITY)
            } else {
                Vec::new()
            };
            let of_stops = if levels.is_empty() { 0.0 } else { STOP_PROBABILITY };
            let mut variants = self.variants(vec![waves, steps], 1.0 - of_stops);
            variants.extend(levels.iter().map(|v| v.with_probability(of_stops * v.probability)));
            let record = Record::Table(Abscissa::Position, false);
            self.add_variants("position", "position", record, COMMON, variants);
        }
        let repetition = |rows: &Covariates| rows.column(|p| libm::log(p.repetition));
        let at = repetition(self.rows);
        if distinct(&at) > 2 {
            self.settling("repetition", Record::Table(Abscissa::LogRepetition, false), repetition);
            let sign = |p: &Point| if p.repetition % 2.0 > 0.5 { 1.0 } else { -1.0 };
            let alternation: BasisOfRows = Rc::new(move |rows| kernel::single(&rows.column(sign)));
            self.add(
                "alternate repetitions",
                "repetition",
                Record::Table(Abscissa::Alternation, true),
                COMMON,
                vec![alternation],
            );
            // The same mistake in every series: the first reading after a reversal, or any other. A pattern over all of them is
            // one along the stroke, if each stop belongs to one of them, and so is one of them, if it has one stop.
            let directed = |row: &RowFactors, _: &RowLabels| format!("{:+}", row.directed_repetition);
            let record = Record::Table(Abscissa::DirectedRepetition, true);
            let channels = &[Channel::Reading, Channel::Friction];
            let levels = Levels::new(self.rows, Rc::new(directed));
            let are_finer = stops.determine(&levels);
            let are_stops = stops.count() > 2 && are_finer && levels.determine(&stops);
            if self.has_levels(2..=MOST_LEVELS, levels.count()) && !are_stops {
                let of_one = if are_finer { 1.0 } else { ONE_LEVEL_PROBABILITY };
                let variants = levels.variants(of_one);
                self.add_variants("repetition of a direction", "repetition", record, channels, variants);
            }
            if distinct(&self.rows.series_time_s) > 1 {
                let record = Record::Table(Abscissa::SeriesReadings, false);
                self.settling("time in a series", record, |rows| rows.series_time_s.clone());
            }
        }
    }

    /// Adds functions that settle over a covariate in a series. They may end at zero as well as begin at zero, without a constant
    /// effect in addition. The friction coefficient fits the level of the friction.
    fn settling(&mut self, name: &str, record: Record, covariate: ValuesOfRows) {
        let scale = Interval::of(&covariate(self.rows));
        let from_any: BasisOfRows =
            Rc::new(move |rows| kernel::brownian_from_any(&scale.shares(&covariate(rows)), 5));
        let channels = [Channel::Reading, Channel::Drag, Channel::DirectionFriction];
        self.add(name, "repetition", record, &channels, vec![from_any]);
        let from_zero: BasisOfRows =
            Rc::new(move |rows| kernel::brownian(&scale.shares(&covariate(rows)), 5));
        self.add(name, "repetition", record, &[Channel::Friction], vec![from_zero]);
    }

    fn load(&mut self) {
        let load = |rows: &Covariates| rows.column(|p| p.load_n);
        let loads = load(self.rows);
        if distinct(&loads) > 2 {
            let most = loads.iter().copied().fold(1e-9, f64::max);
            let scale = Interval { low: 0.0, high: most };
            let channels = [
                Channel::Reading,
                Channel::Drag,
                Channel::Friction,
                Channel::Pins,
                Channel::Silicone,
                Channel::DirectionFriction,
            ];
            let curve: BasisOfRows = Rc::new(move |rows| kernel::brownian(&scale.shares(&load(rows)), 5));
            self.add("load", "load", Record::Table(Abscissa::Load, false), &channels, vec![curve]);
        }
        if (4..=MOST_LOADS).contains(&distinct(&loads)) {
            self.levels(
                "weight",
                "load",
                Record::Table(Abscissa::Load, true),
                &[Channel::Reading, Channel::Gain],
                load_level,
            );
        }
    }

    fn previous_load(&mut self) {
        let memories = MEMORY_REPETITIONS.map(|repetitions| -> BasisOfRows {
            let memory = move |p: &Point| {
                let decay = libm::exp(-p.through / repetitions);
                (p.previous_load_n - p.load_n) / REFERENCE_LOAD_N * decay
            };
            Rc::new(move |rows| kernel::single(&rows.column(memory)))
        });
        self.add(
            "previous load",
            "load",
            Record::Memory,
            &[Channel::Silicone, Channel::Friction, Channel::Reading],
            memories.into(),
        );
    }

    fn protocol(&mut self) {
        let speed = |rows: &Covariates| rows.column(|p| p.log_speed);
        let speeds = speed(self.rows);
        if distinct(&speeds) > 2 {
            let scale = Interval::of(&speeds);
            let curve: BasisOfRows = Rc::new(move |rows| kernel::smooth(&scale.shares(&speed(rows)), 6, 1.0));
            self.add("speed", "speed", Record::Table(Abscissa::LogSpeed, false), MEASURING, vec![curve]);
        } else if distinct(&speeds) == 2 {
            let sign: BasisOfRows =
                Rc::new(move |rows| kernel::single(&rows.column(|p| p.log_speed.signum())));
            self.add(
                "speed",
                "speed",
                Record::Table(Abscissa::LogSpeed, false),
                &[Channel::Drag],
                vec![sign],
            );
        }
        let dwell = |rows: &Covariates| rows.column(|p| p.log_dwell);
        let dwells = dwell(self.rows);
        if distinct(&dwells) > 1 {
            let scale = Interval::of(&dwells);
            let curve: BasisOfRows = Rc::new(move |rows| kernel::smooth(&scale.shares(&dwell(rows)), 4, 1.5));
            self.add(
                "dwell",
                "dwell",
                Record::Table(Abscissa::LogDwell, false),
                &[Channel::Reading, Channel::Friction, Channel::DirectionFriction, Channel::Gain],
                vec![curve],
            );
        }
        let descending = self.rows.column(|p| p.descending);
        if distinct(&descending) == 2 {
            let sweep: BasisOfRows = Rc::new(|rows| kernel::single(&rows.column(|p| p.descending)));
            self.add("sweep", "sweep", Record::Table(Abscissa::Descending, true), COMMON, vec![sweep]);
        }
    }

    fn factors(&mut self) {
        let of_parts = &[COMMON, &[Channel::Pins, Channel::Silicone]].concat();
        self.levels(
            "condition",
            "condition",
            Record::Table(Abscissa::Condition, true),
            COMMON,
            |_, label| label.condition.clone(),
        );
        if self.rows.level_names(|label| &label.layout).len()
            < self.rows.level_names(|label| &label.condition).len()
        {
            // Pins and cast layer of a layout, in each condition that has it.
            self.levels(
                "layout",
                "condition",
                Record::Table(Abscissa::Condition, true),
                of_parts,
                |_, label| label.layout.clone(),
            );
        }
        let wraps = distinct(&self.rows.wrap_deg);
        if wraps < self.rows.level_names(|label| &label.condition).len() {
            let wrap = |row: &RowFactors, _: &RowLabels| format!("{:.3}", row.wrap_deg);
            self.levels(
                "wrap angle",
                "condition",
                Record::Table(Abscissa::Condition, true),
                &[Channel::Reading, Channel::Friction, Channel::DirectionFriction],
                wrap,
            );
        }
        // The mount effect on friction is in every hypothesis.
        let of_mount = &[Channel::Reading, Channel::Drag, Channel::Gain, Channel::DirectionFriction];
        self.levels("mount", "mount", Record::Nothing, of_mount, |_, label| label.mount.clone());
        let of_specimen = &[of_parts.as_slice(), &self.half_loads()].concat();
        self.levels(
            "specimen",
            "specimen",
            Record::Table(Abscissa::Specimen, true),
            of_specimen,
            |_, label| label.specimen.clone(),
        );
        self.levels(
            "operator",
            "operator",
            Record::Table(Abscissa::Operator, true),
            MEASURING,
            |_, label| label.operator.clone(),
        );
        self.sessions();
    }

    /// Returns whether a factor may have a kernel: it has this many levels, and most of them several series.
    pub(super) fn has_levels(&self, counts: RangeInclusive<usize>, count: usize) -> bool {
        counts.contains(&count) && 5 * count <= 4 * self.rows.series_count()
    }

    /// Adds independent levels of a factor that has several.
    fn levels(
        &mut self,
        name: &str,
        covariate: &'static str,
        record: Record,
        channels: &[Channel],
        level: impl Fn(&RowFactors, &RowLabels) -> String + 'static,
    ) {
        let levels = Levels::new(self.rows, Rc::new(level));
        let least = if name == "condition" { 3 } else { 2 };
        if self.has_levels(least..=MOST_LEVELS, levels.count()) {
            let variants = levels.variants(ONE_LEVEL_PROBABILITY);
            self.add_variants(name, covariate, record, channels, variants);
        }
    }
}

/// Returns the position of a stop as a level, to a hundredth of the stroke.
fn stop(row: &RowFactors, _: &RowLabels) -> String {
    // Zero without a sign.
    format!("{}", (100.0 * row.position).round() + 0.0)
}

/// Returns the name of a load as a level, to a hundredth of a newton.
fn load_level(row: &RowFactors, _: &RowLabels) -> String {
    format!("{:.2}", row.load_n)
}

/// Range of a covariate on the fitted table.
#[derive(Clone, Copy)]
pub(super) struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    pub(super) fn of(values: &[f64]) -> Self {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { low, high }
    }

    /// Returns the interval that is longer at each end by a share of its width.
    fn widened(self, share: f64) -> Self {
        let more = share * (self.high - self.low);
        Self { low: self.low - more, high: self.high + more }
    }

    /// Returns the shares 0..1 of values in the range; those outside have the nearest end.
    pub(super) fn shares(self, values: &[f64]) -> Vec<f64> {
        let width = (self.high - self.low).max(1e-9);
        values.iter().map(|v| ((v - self.low) / width).clamp(0.0, 1.0)).collect()
    }
}
