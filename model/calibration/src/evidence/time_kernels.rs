//! Kernels over the time of a session, and over its series in the order of time.

use std::ops::Range;
use std::rc::Rc;

use nalgebra::DMatrix;
use pinswitch_inference::kernel;

use super::covariates::{Covariates, distinct};
use super::forward::Channel;
use super::groups::Groups;
use super::structure::{GROSS_ERROR, NOISE, Record};
use super::table_kernels::{BROWNIAN_RANK, Collector, Interval};
use super::variant::{BasisOfRows, Variant};
use crate::table::Point;

/// Series up to which time also varies within them.
const FEW_SERIES: usize = 4;
/// Probability that structure over time acts in one interval, rather than as Brownian motion.
const INTERVAL_PROBABILITY: f64 = 0.4;
/// Probability that the interval lasts from the start or until the end: one change rather than two.
const CHANGE_PROBABILITY: f64 = 0.5;
/// Probability that it is a wave.
const WAVE_PROBABILITY: f64 = 0.2;
/// Steps between the numbers of cycles of waves, and the largest number.
const WAVE_STEP: f64 = 0.5;
const MOST_CYCLES: f64 = 40.0;
/// Series of a cycle, below which a wave is finer than the sampling (Nyquist's limit); one of a series is
/// its schedule.
const SERIES_OF_CYCLE: f64 = 2.0;
/// Series up to which every interval is a variant.
const MOST_INTERVAL_SERIES: usize = 24;
/// Halvings of a longer table down to the shortest interval that does not last until its end.
const LENGTH_HALVINGS: u32 = 4;
/// Steps of the ends of intervals in the least length of each halving.
const GRID_SHARE: usize = 4;
/// Series up to which a gross error of each is a hypothesis. Errors of `k` among `n` series are at most `sqrt(n / k)` standard
/// deviations of the scatter that they make: a few among more are listed in any case.
const MOST_HIDING_SERIES: usize = 300;
/// Correlations of consecutive series, and the rank of their process: what is finer has little variance next to independent
/// offsets, but distinguishes it from a slow wave.
const WANDERING: [(f64, usize); 2] = [(0.6, 48), (0.85, 32)];
/// Fewest series for a memory of six series, which is then shorter than the table.
const LEAST_WANDERING_SERIES: usize = 24;

impl Collector<'_> {
    pub(super) fn time(&mut self) {
        let channels = [Channel::Reading, Channel::Drag, Channel::Friction, Channel::Silicone, Channel::Pins];
        let mut starts: Vec<f64> = self.rows.series_start_s.clone();
        starts.sort_by(f64::total_cmp);
        starts.dedup();
        let edges: Vec<f64> = starts.iter().copied().skip(1).collect();
        let time = |rows: &Covariates| rows.column(|p| p.time_s);
        let scale = Interval::of(&time(self.rows));
        let wandering: BasisOfRows = if edges.len() < FEW_SERIES {
            Rc::new(move |rows| kernel::brownian(&scale.shares(&time(rows)), 12))
        } else {
            // Between series time moves by steps, equal ones: pauses are not known.
            let rank = edges.len().min(BROWNIAN_RANK);
            let share =
                move |time: &f64| edges.partition_point(|edge| edge <= time) as f64 / edges.len() as f64;
            Rc::new(move |rows| kernel::brownian(&time(rows).iter().map(&share).collect::<Vec<f64>>(), rank))
        };
        let waves = waves(scale, starts.len());
        let by_series = Groups::new(self.rows, |row| self.rows.sequence[row]);
        let intervals = intervals_of(&by_series, self.rows.series_count());
        let share = |is_empty: bool, probability: f64| if is_empty { 0.0 } else { probability };
        let of_intervals = share(intervals.is_empty(), INTERVAL_PROBABILITY);
        let of_waves = share(waves.is_empty(), WAVE_PROBABILITY);
        let mut variants = self.variants(vec![wandering], 1.0 - of_intervals - of_waves);
        // The scale of the cell drifts, as its bridge warms up, or changes by a fault or a calibration.
        let mut of_gain: Vec<Variant> =
            variants.iter().map(|drift| drift.with_probability(1.0 - of_intervals)).collect();
        of_gain.extend(intervals.iter().cloned());
        let by_time = Groups::new(self.rows, |row| self.rows.points[row].time_s.to_bits());
        // Frequency is a scale: every octave is equally probable.
        let total: f64 = waves.iter().map(|(cycles, _)| 1.0 / cycles).sum();
        let waves = waves.into_iter();
        variants
            .extend(waves.filter_map(|(cycles, wave)| {
                Variant::of_groups(wave, &by_time, of_waves / (cycles * total))
            }));
        variants.extend(intervals);
        self.add_variants("time", "time", Record::Time, &channels, variants);
        self.add_variants("time", "time", Record::Time, &[Channel::Gain], of_gain);
    }

    /// Adds offsets that wander from series to series in the order of time: both directions alike or oppositely, or each
    /// direction by itself, as readings that were taken one direction after the other do; constant, or in proportion to the force.
    pub(super) fn wandering(&mut self) {
        let count = self.rows.series_count();
        if count < LEAST_WANDERING_SERIES {
            return;
        }
        let alike = WANDERING.map(|(correlation, rank)| -> BasisOfRows {
            Rc::new(move |rows| kernel::autoregressive(&rows.sequence, count, correlation, rank))
        });
        let [_, longest] = alike.clone();
        let own: BasisOfRows = Rc::new(move |rows| of_each_direction(&longest(rows), &rows.points));
        let mut of_force = alike.to_vec();
        of_force.extend(self.has_both_directions().then_some(own));
        let by_cell = self.by_cell();
        let of_channels =
            [(&[Channel::Drag][..], alike.to_vec()), (&[Channel::Reading, Channel::Gain], of_force)];
        for (channels, forms) in of_channels {
            let probability = 1.0 / forms.len() as f64;
            let variant = |form| Variant::of_groups(form, &by_cell, probability);
            let variants = forms.into_iter().filter_map(variant).collect();
            self.add_variants("wandering series", NOISE, Record::Nothing, channels, variants);
        }
    }

    /// Groups the rows by series and direction.
    fn by_cell(&self) -> Groups {
        Groups::new(self.rows, |row| (self.rows.sequence[row], is_second(&self.rows.points[row])))
    }

    fn has_both_directions(&self) -> bool {
        distinct(&self.rows.column(|point| f64::from(u8::from(is_second(point))))) == 2
    }

    /// Adds a gross error of each series, alike in both directions or of its own size in each: an offset of the cell, or a
    /// cable that is caught, a cell that shows one value.
    pub(super) fn gross_errors(&mut self) {
        let count = self.rows.series_count();
        if count > MOST_HIDING_SERIES {
            return;
        }
        let (has_both, by_cell) = (self.has_both_directions(), self.by_cell());
        for series in 0..count {
            let alike: BasisOfRows = Rc::new(move |rows| {
                let is_in = |of_row: &usize| f64::from(u8::from(*of_row == series));
                kernel::single(&rows.sequence.iter().map(is_in).collect::<Vec<f64>>())
            });
            let of_alike = alike.clone();
            let own: BasisOfRows = Rc::new(move |rows| of_each_direction(&of_alike(rows), &rows.points));
            let forms = if has_both { vec![alike, own] } else { vec![alike] };
            let probability = 1.0 / forms.len() as f64;
            let variant = |basis| Variant::as_is(basis, &by_cell, probability);
            let variants = forms.into_iter().map(variant).collect();
            self.add_variants("one series", GROSS_ERROR, Record::Nothing, &[Channel::Reading], variants);
        }
    }
}

fn is_second(point: &Point) -> bool {
    point.sign > 0.0
}

/// Returns a basis with coefficients of its own in each direction.
fn of_each_direction(basis: &DMatrix<f64>, points: &[Point]) -> DMatrix<f64> {
    let rank = basis.ncols();
    DMatrix::from_fn(basis.nrows(), 2 * rank, |row, column| {
        let is_of_direction = is_second(&points[row]) == (column >= rank);
        if is_of_direction { basis[(row, column % rank)] } else { 0.0 }
    })
}

/// Returns structure that acts in one interval of series: a change, or a fault that lasts for a while. Brownian motion prices
/// one large step as many small ones.
fn intervals_of(by_series: &Groups, count: usize) -> Vec<Variant> {
    let intervals = intervals(count);
    let is_change = |interval: &Range<usize>| interval.start == 0 || interval.end == count;
    let changes = intervals.iter().filter(|interval| is_change(interval)).count();
    let for_a_while = intervals.len() - changes;
    let of_changes = if for_a_while == 0 { 1.0 } else { CHANGE_PROBABILITY };
    let variant = |interval: Range<usize>| {
        let (share, among) =
            if is_change(&interval) { (of_changes, changes) } else { (1.0 - of_changes, for_a_while) };
        let probability = INTERVAL_PROBABILITY * share / among as f64;
        let basis: BasisOfRows = Rc::new(move |rows| {
            let is_in = |sequence: &usize| f64::from(u8::from(interval.contains(sequence)));
            kernel::single(&rows.sequence.iter().map(is_in).collect::<Vec<f64>>())
        });
        Variant::as_is(basis, by_series, probability)
    };
    intervals.into_iter().map(variant).collect()
}

/// Returns waves over a session of this many series, none finer than the sampling. A wave with few cycles
/// is a smooth course, which Brownian motion prices as many steps. Returns the number of cycles with each.
fn waves(session: Interval, series: usize) -> Vec<(f64, BasisOfRows)> {
    let most = MOST_CYCLES.min(series as f64 / SERIES_OF_CYCLE);
    let cycles = std::iter::successors(Some(1.0), |cycles| Some(cycles + WAVE_STEP));
    cycles
        .take_while(|cycles| *cycles <= most)
        .map(|cycles| -> (f64, BasisOfRows) {
            (cycles, Rc::new(move |rows| kernel::wave(&session.shares(&rows.column(|p| p.time_s)), cycles)))
        })
        .collect()
}

/// Returns intervals of a number of series, of two or more with two or more outside: one series that differs from all others
/// is a gross error of it. In a long table they are all that last until its end, and an approximating set of the others (Rivera
/// and Walther 2013): lengths from `m` to `2m` have their ends on a grid of `m / 4`, so that the ends of some interval of the
/// set are within a quarter of the length, or one series, of those of any that is not longer than half of the table.
fn intervals(count: usize) -> Vec<Range<usize>> {
    if count <= MOST_INTERVAL_SERIES {
        let of = |from: usize| (from + 1..=count).map(move |until| from..until);
        let is_apart = |interval: &Range<usize>| interval.len().min(count - interval.len()) > 1;
        return (0..count).flat_map(of).filter(is_apart).collect();
    }
    let mut intervals: Vec<Range<usize>> = (2..count - 1).map(|from| from..count).collect();
    for halvings in 1..=LENGTH_HALVINGS {
        let least = count >> halvings;
        let step = (least / GRID_SHARE).max(1);
        for from in (step..count).step_by(step) {
            let lengths = (least.max(2)..2 * least).step_by(step);
            intervals.extend(lengths.map(|length| from..from + length).filter(|i| i.end < count));
        }
    }
    intervals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_interval_of_a_long_table_is_near_one_of_the_set() {
        for count in [25, 61, 530] {
            let intervals = intervals(count);
            let distinct: std::collections::HashSet<&Range<usize>> = intervals.iter().collect();
            assert_eq!(distinct.len(), intervals.len());
            assert!(intervals.iter().all(|i| i.len() > 1 && count - i.len() > 1 && i.end <= count));
            let shortest = (count >> LENGTH_HALVINGS).max(2);
            for from in 1..count - shortest {
                for until in (from + shortest..count).filter(|until| until - from < count / 2) {
                    let length = until - from;
                    let off = |i: &Range<usize>| i.start.abs_diff(from).max(i.end.abs_diff(until));
                    let nearest = intervals.iter().map(off).min().unwrap();
                    assert!(nearest <= (length / 4).max(1), "{from}..{until} of {count}: {nearest}");
                }
            }
        }
    }
}
