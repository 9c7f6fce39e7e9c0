//! Plateaus of one log: its moves, their directions, and the settled force after each
//! (`model/doc/logs.md`).

use std::ops::Range;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::Direction;

use super::cycles::{HalfCycle, half_cycles, unsettled};
use super::defects::{missing_repetitions, odd_speeds, sample_defects};
use super::direction::{ACCEPTED, Evidence, directions};
use super::finding::Finding;
use super::interval::{Move, Schedule, stop_s};
use super::log::Log;
use super::moves::{Moves, Source, moves};
use super::run_plan::Rig;
use super::segmented::{Motion, MoveMark, Plateau, Reading, Segmented};
use super::steady_moves::UnknownMoves;
use super::two_levels::noise_about_slope;
use crate::median::median;

/// Averaging time at the end of a plateau in seconds.
const READ_S: f64 = 1.0;
/// Guard time before the next move in seconds: by the force alone, its start is known to a block.
const GUARD_S: f64 = 0.012;
const FORCE_GUARD_S: f64 = 0.1;
/// Share of a rest in which the force settles.
const SETTLING: f64 = 0.25;
/// Length of the positions before and after a move in seconds.
const BEFORE_S: f64 = 0.3;
const AFTER_S: f64 = 0.5;
/// Least travel of a move in standard deviations of the noise of the position.
const TRAVEL_NOISE: f64 = 6.0;
/// Fewest samples of a reading, and the share of its nominal number.
const FEWEST_SAMPLES: f64 = 3.0;
const SAMPLE_SHARE: f64 = 0.1;
/// Gap in time that ends a rest, in seconds and sampling periods.
const GAP_S: f64 = 1.0;
const GAP_PERIODS: f64 = 20.0;
/// Relative spread up to which the rests of a log are regular.
const REGULAR: f64 = 0.1;
/// Time in seconds that a reading may extend beyond the usual rest.
const LATE_S: f64 = 0.05;
/// Force below this share of the load: the tendon is slack.
const UNLOADED_SHARE: f64 = 0.1;
/// Uncertain moves that a log may have: a number, and a share.
const MOST_UNCERTAIN: (usize, f64) = (2, 0.1);
/// Relative departures of a measured value from the declared one.
const DWELL_DEPARTURE: f64 = 0.05;
const ON_DEPARTURE: f64 = 0.2;

/// Finds the plateaus and the defects of a log. `load_n` is the declared load.
///
/// # Errors
/// If the directions of more than two moves and a tenth of the moves are uncertain, or if the log
/// contains several loads.
pub fn segment(log: &Log, rig: &Rig, load_n: Option<f64>) -> Result<Segmented, Diagnostic> {
    let mut out = Segmented::default();
    let mut spikes = 0;
    let readings = if let Some(halves) = half_cycles(log) {
        out.motion = Motion::Cycles;
        out.source = Source::Position;
        out.findings.extend(unsettled(log, &halves).map(|share| Finding::UnsettledCycles { share }));
        cycle_readings(log, &halves, &mut spikes, &mut out.findings)
    } else {
        let Moves { all, source, scheduled, unexplained_s, unknown } =
            moves(log, Schedule { on_s: rig.on_s, dwell_s: rig.dwell_s });
        out.source = source;
        refuse_unknown_moves(unknown)?;
        refuse_unexplained(&unexplained_s, all.len())?;
        out.findings
            .extend(unexplained_s.iter().map(|(_, time_s)| Finding::UnreadableRest { time_s: *time_s }));
        if scheduled > 0 {
            out.findings.push(Finding::ScheduledMoves { moves: scheduled });
        }
        let usual_s = usual_rest(log, &all, rig);
        refuse_hidden_moves(log, rig, &all, (source, scheduled), usual_s)?;
        declared_times(log, rig, &all, usual_s, source, &mut out.findings);
        let noise_mm = log.position_mm.as_ref().map_or(0.0, |x| noise_about_slope(x));
        let rest = Rests { log, moves: &all, usual_s, source, noise_mm };
        (0..all.len())
            .filter_map(|i| match rest.reading(i, &mut spikes) {
                Ok(reading) => Some(reading),
                Err(finding) => {
                    out.findings.push(finding);
                    None
                }
            })
            .collect()
    };
    let readings = loaded(readings, load_n, &mut out.findings)?;
    refuse_several_loads(&readings)?;
    add_plateaus(log, rig, load_n, &readings, &mut out)?;
    missing_repetitions(&readings, &mut out);
    odd_speeds(log, rig, &readings, &mut out);
    sample_defects(log, rig, spikes, &mut out.findings);
    if out.source == Source::Force && rig.on_s.is_none() && !out.plateaus.is_empty() {
        out.findings.push(Finding::DwellByForce);
    }
    Ok(out)
}

/// Adds the plateaus whose direction is certain.
fn add_plateaus(
    log: &Log,
    rig: &Rig,
    load_n: Option<f64>,
    readings: &[Reading],
    out: &mut Segmented,
) -> Result<(), Diagnostic> {
    let evidence: Vec<Evidence> = readings.iter().map(|r| r.evidence).collect();
    let mut measured: Vec<f64> = readings.iter().filter_map(|r| r.load_n).collect();
    let load_n = if measured.is_empty() { load_n } else { Some(median(&mut measured)) };
    let found = directions(&evidence, load_n, rig.protocol);
    if found.is_position_reversed {
        out.findings.push(Finding::ReversedPosition);
    }
    let mut counts = [0u32; 2];
    let (mut uncertain, mut reason) = (0, String::new());
    for (r, verdict) in readings.iter().zip(&found.verdicts) {
        let is_certain = verdict.probability >= ACCEPTED;
        let from_s = log.time_s[r.span.from];
        out.moves.push(MoveMark {
            from_s,
            to_s: log.time_s[r.span.to - 1],
            direction: is_certain.then_some(verdict.direction),
        });
        if !is_certain {
            uncertain += 1;
            reason.clone_from(&verdict.reason);
            let probability = verdict.probability;
            out.findings.push(Finding::UncertainDirection {
                time_s: from_s,
                probability,
                reason: verdict.reason.clone(),
            });
            continue;
        }
        let slot = usize::from(verdict.direction == Direction::Concentric);
        counts[slot] += 1;
        out.plateaus.push(Plateau {
            direction: verdict.direction,
            repetition: counts[slot],
            force_n: r.evidence.force_n,
            position_mm: r.position_mm,
            load_n: r.load_n,
            dwell_s: r.dwell_s,
            time_s: r.time_s,
            samples: r.samples,
        });
    }
    let most = MOST_UNCERTAIN.1 * readings.len() as f64;
    if uncertain > 0 && (out.plateaus.is_empty() || uncertain as f64 > most.max(MOST_UNCERTAIN.0 as f64)) {
        let count = readings.len();
        if let (Some((low_n, high_n)), Some(load_n)) = (found.contradicted_levels_n, load_n) {
            return Err(one_sided_levels((low_n, high_n), load_n, (uncertain, count)));
        }
        return Err(Diagnostic::new(
            codes::UNCERTAIN_DIRECTIONS,
            format!("the direction of {uncertain} of {count} moves is uncertain ({reason})"),
        )
        .with_help("declare rig.protocol, or add a column position_mm or direction to the log"));
    }
    Ok(())
}

/// Returns the error of a log whose two levels are on one side of its load.
fn one_sided_levels(
    (low_n, high_n): (f64, f64),
    load_n: f64,
    (uncertain, count): (usize, usize),
) -> Diagnostic {
    let side = if low_n > load_n { "above" } else { "below" };
    Diagnostic::new(codes::UNCERTAIN_DIRECTIONS, format!(
        "the direction of {uncertain} of {count} moves is uncertain: the levels of the force, {low_n:.2} N and \
         {high_n:.2} N, are both {side} the load of {load_n:.2} N"
    ))
    .with_help(
        "if the weight changes, add a column load_N or load_mass_g; otherwise check the load, the gain and the \
         zero of the cell, or add a column position_mm or direction",
    )
}

/// Returns the usual rest of a log in seconds, if its rests are regular; the declared one if the log
/// has too few.
fn usual_rest(log: &Log, moves: &[Move], rig: &Rig) -> Option<f64> {
    let mut rests: Vec<f64> = moves
        .windows(2)
        .filter(|pair| !log.breaks.iter().any(|b| (pair[0].to..=pair[1].from).contains(b)))
        .map(|pair| rest_before_s(log, pair[1].from) - stop_s(log, pair[0]))
        .collect();
    if rests.len() < 3 {
        return rig.dwell_s;
    }
    let usual_s = median(&mut rests);
    let mut departures: Vec<f64> = rests.iter().map(|r| (r - usual_s).abs()).collect();
    (median(&mut departures) <= REGULAR * usual_s).then_some(usual_s)
}

/// Returns the end in seconds of the rest before a sample: lost samples do not belong to it.
fn rest_before_s(log: &Log, from: usize) -> f64 {
    let last_s = log.time_s[from.saturating_sub(1)];
    log.time_s[from].min(last_s + 1.5 * log.period_s())
}

/// Share of the declared moves that the force must show if its moves are irregular.
const VISIBLE_MOVES: f64 = 0.7;
/// Largest share of the moves that only the schedule shows.
const MOST_PLACED: f64 = 0.67;

/// Refuses a log whose force does not show enough of the declared moves.
fn refuse_hidden_moves(
    log: &Log,
    rig: &Rig,
    moves: &[Move],
    (source, placed): (Source, usize),
    usual_s: Option<f64>,
) -> Result<(), Diagnostic> {
    let (Some(on_s), Some(dwell_s), Some(end_s)) = (rig.on_s, rig.dwell_s, log.time_s.last()) else {
        return Ok(());
    };
    let scheduled = ((end_s - log.time_s[0]) / (on_s + dwell_s)).floor();
    let is_regular = usual_s.is_some() && moves.len() > 3;
    let is_complete = is_regular || moves.len() as f64 >= VISIBLE_MOVES * scheduled;
    let is_visible = placed as f64 <= MOST_PLACED * moves.len() as f64;
    if source != Source::Force || (is_complete && is_visible) {
        return Ok(());
    }
    Err(Diagnostic::new(codes::MOVES_NOT_VISIBLE, format!(
        "the force shows {} moves, rig.on_s and rig.dwell_s declare about {scheduled}: the others leave it unchanged",
        moves.len() - placed
    ))
    .with_help("add a column position_mm or power_W to the log"))
}

/// Refuses a log whose force is steady in more than a few intervals that are not rests: its actuator
/// may run at a steady force, so that the rests are elsewhere.
fn refuse_unexplained(unexplained_s: &[(f64, f64)], moves: usize) -> Result<(), Diagnostic> {
    let count = unexplained_s.len();
    let most = MOST_UNCERTAIN.1 * moves as f64;
    let Some((from_s, to_s)) =
        unexplained_s.first().filter(|_| count as f64 > most.max(MOST_UNCERTAIN.0 as f64))
    else {
        return Ok(());
    };
    Err(Diagnostic::new(codes::RESTS_NOT_DISTINGUISHED, format!(
        "the force alone does not distinguish the rests from the moves: it is steady in {count} short intervals \
         before a move (the first from {from_s:.1} s to {to_s:.1} s)"
    ))
    .with_help("declare rig.on_s and rig.dwell_s, or add a column position_mm or power_W to the log"))
}

/// Refuses a log whose force alternates between two levels in one direction, since the actuator may
/// move at either of them.
fn refuse_unknown_moves(unknown: Option<UnknownMoves>) -> Result<(), Diagnostic> {
    let Some(UnknownMoves { low_n, high_n }) = unknown else { return Ok(()) };
    Err(Diagnostic::new(codes::RESTS_NOT_DISTINGUISHED, format!(
        "the force alone does not distinguish the rests from the moves: in one direction it alternates between \
         {low_n:.2} N and {high_n:.2} N"
    ))
    .with_help("declare rig.on_s and rig.dwell_s, the seconds of motion and of rest, or add a column position_mm or power_W to the log"))
}

/// Compares the declared times with the measured ones.
fn declared_times(
    log: &Log,
    rig: &Rig,
    moves: &[Move],
    usual_s: Option<f64>,
    source: Source,
    findings: &mut Vec<Finding>,
) {
    let period_s = log.period_s();
    let mut compare = |field, declared: Option<f64>, measured: f64, share: f64, slack_s: f64| {
        if let Some(declared) = declared
            && (measured - declared).abs() > (share * declared).max(slack_s)
        {
            findings.push(Finding::Departure { field, declared, measured });
        }
    };
    if let Some(usual_s) = usual_s {
        compare("rig.dwell_s", rig.dwell_s, usual_s, DWELL_DEPARTURE, 2.0 * period_s);
    }
    if source != Source::Force && !moves.is_empty() {
        let mut lengths: Vec<f64> = moves.iter().map(|m| stop_s(log, *m) - log.time_s[m.from]).collect();
        compare("rig.on_s", rig.on_s, median(&mut lengths), ON_DEPARTURE, 3.0 * period_s);
    }
}

/// Rests of a log after its moves.
struct Rests<'a> {
    log: &'a Log,
    moves: &'a [Move],
    usual_s: Option<f64>,
    source: Source,
    /// Noise of the position in millimetres.
    noise_mm: f64,
}

impl Rests<'_> {
    /// Reads the plateau after a move; a rest that cannot be read is a finding.
    fn reading(&self, at: usize, spikes: &mut usize) -> Result<Reading, Finding> {
        let (log, m) = (self.log, self.moves[at]);
        let stop_s = stop_s(log, m);
        let next = self.moves.get(at + 1);
        let end = self.rest_end(m, next.map_or(log.time_s.len(), |n| n.from));
        let until_s = match log.time_s.get(end) {
            Some(_) => rest_before_s(log, end),
            None => log.time_s[end - 1],
        };
        // The next file may begin much later.
        let until_s = until_s.min(log.time_s[end - 1] + 1.5 * log.period_s());
        let end_s = self.usual_s.map_or(until_s, |usual_s| until_s.min(stop_s + usual_s + LATE_S));
        let is_last_sample = end == log.time_s.len() && end_s == until_s;
        let guard_s = match self.source {
            _ if is_last_sample => GUARD_S,
            Source::Force => FORCE_GUARD_S,
            Source::Power | Source::Position => GUARD_S,
        };
        let from_s = (end_s - READ_S).max(stop_s + SETTLING * (end_s - stop_s));
        let window = within(range(log, from_s, end_s - guard_s), m.to, end);
        let unreadable = Finding::UnreadableRest { time_s: end_s };
        let least = fewest(log, end_s - guard_s - from_s);
        let (force_n, samples) = settled_force(&log.force_n[window.clone()], least).ok_or(unreadable)?;
        *spikes += window.len() - samples;
        let position = |r: Range<usize>| log.position_mm.as_ref().and_then(|x| level(&x[r]));
        Ok(Reading {
            span: m,
            evidence: Evidence {
                force_n,
                before_n: self.before_n(at),
                travel_mm: self.travel_mm(at, within(range(log, end_s - AFTER_S, end_s), m.to, end)),
                power_w: log.power_w.as_ref().map(|w| mean(&w[m.from..m.to])),
                declared: declared(log, m, &window),
            },
            position_mm: position(within(range(log, from_s, end_s), m.to, end)),
            load_n: log.load_n.as_ref().and_then(|l| level(&l[window])),
            dwell_s: rounded_dwell(self.usual_s, end_s - stop_s),
            time_s: end_s,
            samples,
        })
    }

    /// Returns the end of the rest after a move: the next move, the next file, or a long gap.
    fn rest_end(&self, m: Move, next: usize) -> usize {
        let log = self.log;
        let file_end = log.breaks.iter().copied().find(|b| *b >= m.to && *b < next).unwrap_or(next);
        let gap_s = GAP_S.max(GAP_PERIODS * log.period_s());
        let start_s = log.time_s[m.to - 1];
        (m.to..file_end)
            .find(|i| {
                let before_s = log.time_s[i - 1];
                log.time_s[*i] - before_s > gap_s
                    && before_s - start_s > 0.5 * self.usual_s.unwrap_or(2.0 * READ_S)
            })
            .unwrap_or(file_end)
            .max(m.to)
    }

    /// Returns the first sample that belongs to the rest before a move.
    fn rest_start(&self, at: usize) -> usize {
        let from = self.moves[at].from;
        let previous = if at == 0 { 0 } else { self.moves[at - 1].to };
        self.log.breaks.iter().copied().filter(|b| *b <= from).fold(previous, usize::max)
    }

    /// Returns the settled force before a move.
    fn before_n(&self, at: usize) -> Option<f64> {
        let (log, from) = (self.log, self.moves[at].from);
        let end_s = log.time_s[from];
        let window = within(range(log, end_s - READ_S, end_s - GUARD_S), self.rest_start(at), from);
        settled_force(&log.force_n[window], fewest(log, BEFORE_S)).map(|(force_n, _)| force_n)
    }

    /// Returns the travel of a move, if it exceeds the noise. A move without a rest before it
    /// starts at its first sample.
    fn travel_mm(&self, at: usize, after: Range<usize>) -> Option<f64> {
        let (log, m) = (self.log, self.moves[at]);
        let position_mm = log.position_mm.as_ref()?;
        let before = range(log, log.time_s[m.from] - BEFORE_S, log.time_s[m.from]);
        let before = within(before, self.rest_start(at), m.from);
        let start_mm = level(&position_mm[before]).unwrap_or(position_mm[m.from]);
        let end_mm = level(&position_mm[after]).unwrap_or(position_mm[m.to - 1]);
        let travel_mm = end_mm - start_mm;
        (travel_mm.abs() > TRAVEL_NOISE * self.noise_mm).then_some(travel_mm)
    }
}

/// Reads the middle part of each half-cycle.
fn cycle_readings(
    log: &Log,
    halves: &[HalfCycle],
    spikes: &mut usize,
    findings: &mut Vec<Finding>,
) -> Vec<Reading> {
    let mut readings: Vec<Reading> = Vec::new();
    for half in halves {
        let window = half.middle.clone();
        let (from_s, to_s) = (log.time_s[window.start], log.time_s[window.end - 1]);
        let Some((force_n, samples)) =
            settled_force(&log.force_n[window.clone()], fewest(log, to_s - from_s))
        else {
            findings.push(Finding::UnreadableRest { time_s: from_s });
            continue;
        };
        *spikes += window.len() - samples;
        readings.push(Reading {
            span: half.stroke,
            evidence: Evidence {
                force_n,
                before_n: readings.last().map(|r| r.evidence.force_n),
                travel_mm: Some(half.travel_mm),
                power_w: log.power_w.as_ref().map(|w| mean(&w[window.clone()])),
                declared: declared(log, half.stroke, &window),
            },
            position_mm: Some(half.centre_mm),
            load_n: log.load_n.as_ref().and_then(|l| level(&l[window])),
            dwell_s: 0.0,
            time_s: 0.5 * (from_s + to_s),
            samples,
        });
    }
    readings
}

/// Returns the direction that most samples of a move, or of its reading, declare.
fn declared(log: &Log, m: Move, window: &Range<usize>) -> Option<Direction> {
    let column = log.direction.as_ref()?;
    [m.from..m.to, window.clone()].into_iter().find_map(|samples| {
        let sum: f64 = column[samples].iter().flatten().map(|d| d.sign()).sum();
        match sum {
            s if s > 0.0 => Some(Direction::Concentric),
            s if s < 0.0 => Some(Direction::Eccentric),
            _ => None,
        }
    })
}

/// Removes the readings without load.
fn loaded(
    readings: Vec<Reading>,
    load_n: Option<f64>,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Reading>, Diagnostic> {
    let Some(load_n) = load_n.filter(|load_n| *load_n > 0.0) else { return Ok(readings) };
    let mut forces: Vec<f64> = readings.iter().map(|r| r.evidence.force_n).collect();
    let middle = median(&mut forces);
    if middle < -UNLOADED_SHARE * load_n {
        return Err(Diagnostic::new(
            codes::FORCE_AGAINST_LOAD,
            format!("the force is negative: {middle:.2} N for a load of {load_n:.2} N"),
        )
        .with_help("change the sign of force_N: a tension is positive"));
    }
    let count = readings.len();
    let (loaded, slack): (Vec<_>, Vec<_>) =
        readings.into_iter().partition(|r| r.evidence.force_n > UNLOADED_SHARE * load_n);
    if !slack.is_empty() {
        findings.push(Finding::Unloaded { plateaus: slack.len() });
    }
    if loaded.is_empty() && count > 0 {
        return Err(Diagnostic::new(
            codes::FORCE_AGAINST_LOAD,
            format!("the force is {middle:.2} N for a load of {load_n:.2} N"),
        )
        .with_help("check the unit of force_N and the load"));
    }
    Ok(loaded)
}

/// Share of the force, and number of standard deviations within a level, between separate levels.
const LEVEL_GAP: (f64, f64) = (0.08, 6.0);

/// Refuses plateaus at more than two separate levels: one load has one in each direction.
fn refuse_several_loads(readings: &[Reading]) -> Result<(), Diagnostic> {
    let mut forces: Vec<f64> = readings.iter().map(|r| r.evidence.force_n).collect();
    forces.sort_by(f64::total_cmp);
    let mut levels: Vec<Vec<f64>> = Vec::new();
    for force_n in forces {
        match levels.last_mut() {
            Some(level) if force_n - level[level.len() - 1] <= LEVEL_GAP.0 * force_n.abs() => {
                level.push(force_n)
            }
            _ => levels.push(vec![force_n]),
        }
    }
    // A single plateau is an outlier, not a load.
    levels.retain(|level| level.len() > 1);
    let spread = |level: &[f64]| {
        let centre = mean(level);
        (level.iter().map(|f| (f - centre) * (f - centre)).sum::<f64>() / level.len() as f64).sqrt()
    };
    let are_separate = levels
        .windows(2)
        .all(|pair| mean(&pair[1]) - mean(&pair[0]) > LEVEL_GAP.1 * spread(&pair[0]).max(spread(&pair[1])));
    if levels.len() < 3 || !are_separate {
        return Ok(());
    }
    let list: Vec<String> = levels.iter().take(8).map(|level| format!("{:.2}", mean(level))).collect();
    Err(Diagnostic::new(
        codes::SEVERAL_LOADS_IN_LOG,
        format!(
            "the plateaus are at {} levels ({} N): a log of one load has two",
            levels.len(),
            list.join(", ")
        ),
    )
    .with_help("add a column load_N or load_mass_g, or split the log by load"))
}

/// Returns the dwell of a row in seconds: the usual one if the rest is as long, in steps that are
/// coarser than the jitter of a clock.
fn rounded_dwell(usual_s: Option<f64>, rest_s: f64) -> f64 {
    let rest_s = usual_s.filter(|u| (rest_s - u).abs() <= LATE_S + DWELL_DEPARTURE * u).unwrap_or(rest_s);
    // A tenth of a second is written without rounding noise of a binary fraction.
    let steps = if rest_s < 10.0 { 20.0 } else { 2.0 };
    (rest_s.max(0.0) * steps).round() / steps
}

/// Returns the indices of the samples between two times.
fn range(log: &Log, from_s: f64, to_s: f64) -> Range<usize> {
    let from = log.time_s.partition_point(|t| *t < from_s);
    from..log.time_s.partition_point(|t| *t < to_s).max(from)
}

/// Limits indices to an interval.
fn within(samples: Range<usize>, from: usize, to: usize) -> Range<usize> {
    let start = samples.start.clamp(from.min(to), to);
    start..samples.end.clamp(start, to)
}

/// Returns the median of the values; `None` without values.
fn level(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    (!values.is_empty()).then(|| median(&mut values))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the fewest samples of a reading over a time: a tenth of the nominal number, and three.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive and limited")]
fn fewest(log: &Log, seconds: f64) -> usize {
    (SAMPLE_SHARE * seconds / log.period_s().max(1e-9)).clamp(FEWEST_SAMPLES, 1e6).round() as usize
}

/// Returns the mean of the samples within 4.5 robust standard deviations of the median, and their
/// number.
fn settled_force(force_n: &[f64], least: usize) -> Option<(f64, usize)> {
    if force_n.len() < least {
        return None;
    }
    let mut values = force_n.to_vec();
    let centre = median(&mut values);
    let mut sizes: Vec<f64> = force_n.iter().map(|f| (f - centre).abs()).collect();
    let bound = 4.5 * (1.4826 * median(&mut sizes)).max(1e-3);
    let (sum, count) = force_n
        .iter()
        .filter(|f| (**f - centre).abs() <= bound)
        .fold((0.0, 0usize), |(sum, count), f| (sum + f, count + 1));
    (count >= least).then(|| (sum / count as f64, count))
}
