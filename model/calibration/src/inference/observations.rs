//! Observations for the inference: points, readings, and the grouping of rows.

use std::sync::{Arc, OnceLock};

use pinswitch_friction::sort_by_number;

use super::noise::Noise;
use super::structures::Catalogue;
use super::weighed::Weighed;
use crate::median::median;
use crate::table::{Frame, Labels, PlateauRow, Point};

/// Points and readings with their grouping.
#[derive(Clone, Debug)]
pub struct Observations {
    /// Covariates of the rows.
    pub points: Vec<Point>,
    /// Readings in newtons.
    pub force_n: Vec<f64>,
    /// Series of each row.
    pub series_of: Vec<usize>,
    /// Number of series.
    pub series: usize,
    /// Rows of each series and direction, which share an offset.
    pub cells: Vec<Vec<usize>>,
    /// Load of each cell in newtons.
    pub cell_load_n: Vec<f64>,
    /// Weight of each row; 1 unless it is an outlier.
    pub weights: Vec<f64>,
    /// Number of readings averaged in each row: 1 unless a long table was compacted.
    pub counts: Vec<f64>,
    /// Mean square of those readings about their mean, in newtons squared.
    pub within_n2: Vec<f64>,
    /// Row of the table from which each row comes; the first one of a mean.
    pub source: Vec<usize>,
    /// Square roots of the weights.
    pub(crate) roots: Vec<f64>,
    /// Change of each reading in newtons per relative change of the friction exponent; zero until a
    /// model is fitted.
    pub friction_n: Vec<f64>,
    /// Rows of each series.
    pub series_rows: Vec<Vec<usize>>,
    /// Rows of each mount; of each condition in a table without mounts.
    pub mounts: Vec<Vec<usize>>,
    /// Series in the order of time, since their offsets may drift.
    pub turns: Vec<Turn>,
    /// Rows of each operator; empty with fewer than two.
    pub operators: Vec<Vec<usize>>,
    /// Rows of each session; empty with fewer than two.
    pub sessions: Vec<Vec<usize>>,
    /// Rows of each specimen; empty with fewer than two.
    pub specimens: Vec<Vec<usize>>,
    /// Series with gross errors, which are ignored.
    excluded: Vec<usize>,
    /// Structures that the points could show, computed on demand.
    catalogue: OnceLock<Arc<Catalogue>>,
}

/// A series in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Its cells, in the order in which they begin.
    pub cells: Vec<usize>,
    /// Distance to the previous series: more than 1 if some were left out.
    pub since: i32,
}

/// Means of the series and directions of a table, as a table of their own.
#[derive(Clone, Debug)]
pub(crate) struct CellMeans {
    /// One row per series and direction.
    pub(crate) observations: Observations,
    /// Cell of each row.
    cells: Vec<usize>,
    axis: Vec<f64>,
    repetition: Noise,
}

impl CellMeans {
    /// Returns the means of a column of the whole table, weighted by the repetition noise.
    pub(crate) fn mean_of(&self, data: &Observations, column: &[f64]) -> Vec<f64> {
        let mut white = column.to_vec();
        Weighed::new(data, self.repetition).whiten(&mut white);
        self.mean_of_white(data, &white)
    }

    /// Returns the means of several columns.
    pub(crate) fn means_of(&self, data: &Observations, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut white = columns.to_vec();
        Weighed::new(data, self.repetition).whiten_all(&mut white);
        white.iter().map(|white| self.mean_of_white(data, white)).collect()
    }

    fn mean_of_white(&self, data: &Observations, white: &[f64]) -> Vec<f64> {
        self.cells
            .iter()
            .map(|cell| {
                let (mut sum, mut weight) = (0.0, 0.0);
                for row in &data.cells[*cell] {
                    sum += self.axis[*row] * white[*row];
                    weight += self.axis[*row] * self.axis[*row];
                }
                if weight > 0.0 { sum / weight } else { 0.0 }
            })
            .collect()
    }
}

/// Weight below which rows are outliers, which do not count in errors.
const SOUND_WEIGHT: f64 = 0.5;
/// Smallest weight, so that its root is finite; it removes the influence of a reading that is a
/// million times off.
pub(super) const MIN_WEIGHT: f64 = 1e-16;
/// Weight of the rows of an excluded series, which stay in the table without influence.
const EXCLUDED_WEIGHT: f64 = 1e-7;

impl Observations {
    /// Groups a table; `None` if the frame lacks a condition.
    pub fn new(frame: &Frame, rows: &[PlateauRow]) -> Option<Self> {
        let points = frame.points(rows)?;
        let (series_of, series) =
            crate::table::groups(rows, |r| (r.labels.session.clone(), r.series.clone()));
        let (cell_of, count) = crate::table::groups(rows, |r| {
            let concentric = r.direction == pinswitch_friction::Direction::Concentric;
            (r.labels.session.clone(), r.series.clone(), concentric)
        });
        let mut cells = vec![Vec::new(); count];
        for (row, cell) in cell_of.iter().enumerate() {
            cells[*cell].push(row);
        }
        // Sorts neighbours by time, whatever the order of the table.
        for cell in &mut cells {
            sort_by_number(cell, |row| points[*row].time);
        }
        let by = |key: &dyn Fn(usize) -> String| {
            let (of, count) = crate::table::groups_of(rows.len(), key);
            collected(&of, count)
        };
        let several = |label: fn(&Labels) -> &str| {
            let groups = by(&|i| label(&rows[i].labels).to_owned());
            if groups.len() > 1 { groups } else { Vec::new() }
        };
        let labels = |i: usize| &rows[i].labels;
        // A condition that is mounted in two sessions, or with two specimens, has two mounts.
        let mounts = by(&|i| {
            let l = labels(i);
            format!("{} {} {} {}", points[i].condition, l.session, l.specimen, l.mount)
        });
        let force_n = rows.iter().map(|r| r.force_n).collect();
        let cell_load_n = loads(&cells, &points);
        let ones = vec![1.0; rows.len()];
        let turns = turns(&cells, &points, &series_of);
        Some(Self {
            points,
            force_n,
            series,
            cells,
            cell_load_n,
            weights: ones.clone(),
            counts: ones.clone(),
            within_n2: vec![0.0; rows.len()],
            source: (0..rows.len()).collect(),
            roots: ones,
            friction_n: vec![0.0; rows.len()],
            series_rows: collected(&series_of, series),
            series_of,
            turns,
            mounts,
            operators: several(|l| &l.operator),
            sessions: several(|l| &l.session),
            specimens: several(|l| &l.specimen),
            excluded: Vec::new(),
            catalogue: OnceLock::new(),
        })
    }

    /// Keeps the rows for which `keep` returns true.
    #[must_use]
    pub fn subset(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.points.len()).filter(|i| keep(*i)).collect();
        let mut new_index = vec![usize::MAX; self.points.len()];
        for (new, old) in kept.iter().enumerate() {
            new_index[*old] = new;
        }
        let points: Vec<Point> = kept.iter().map(|i| self.points[*i]).collect();
        let (mut new_series, mut series) = (vec![usize::MAX; self.series], 0);
        for row in &kept {
            let new = &mut new_series[self.series_of[*row]];
            if *new == usize::MAX {
                *new = series;
                series += 1;
            }
        }
        let among = |groups: &[Vec<usize>]| -> Vec<Vec<usize>> {
            groups
                .iter()
                .map(|c| c.iter().map(|i| new_index[*i]).filter(|i| *i != usize::MAX).collect::<Vec<_>>())
                .filter(|c| !c.is_empty())
                .collect()
        };
        let cells = among(&self.cells);
        let series_of: Vec<usize> = kept.iter().map(|i| new_series[self.series_of[*i]]).collect();
        let turns = turns(&cells, &points, &series_of);
        Self {
            cell_load_n: loads(&cells, &points),
            points,
            force_n: kept.iter().map(|i| self.force_n[*i]).collect(),
            series_of,
            series,
            cells,
            weights: kept.iter().map(|i| self.weights[*i]).collect(),
            counts: kept.iter().map(|i| self.counts[*i]).collect(),
            within_n2: kept.iter().map(|i| self.within_n2[*i]).collect(),
            source: kept.iter().map(|i| self.source[*i]).collect(),
            roots: kept.iter().map(|i| self.roots[*i]).collect(),
            friction_n: kept.iter().map(|i| self.friction_n[*i]).collect(),
            series_rows: among(&self.series_rows),
            mounts: among(&self.mounts),
            turns,
            operators: among(&self.operators),
            sessions: among(&self.sessions),
            specimens: among(&self.specimens),
            excluded: self.excluded.iter().map(|s| new_series[*s]).filter(|s| *s != usize::MAX).collect(),
            catalogue: OnceLock::new(),
        }
    }

    /// Returns the fold of each row for cross-validation: whole series, distributed in the order of
    /// recording, whatever the order of the table.
    pub(crate) fn parts_of_series(&self, parts: usize) -> Vec<usize> {
        let begin = |series: &usize| {
            let rows = &self.series_rows[*series];
            let session = rows.first().and_then(|r| self.points[*r].session_group);
            (session, rows.iter().map(|r| self.points[*r].time).fold(f64::INFINITY, f64::min))
        };
        let mut order: Vec<usize> = (0..self.series).collect();
        sort_by_number(&mut order, |series| begin(series).1);
        sort_by_number(&mut order, |series| begin(series).0.map_or(-1.0, |session| session as f64));
        let mut part = vec![0; self.series];
        // Neighbours in time are in different folds, and so are series that are a period of the
        // protocol apart.
        order.iter().enumerate().for_each(|(rank, series)| part[*series] = (rank * 7 / 3) % parts.max(1));
        self.series_of.iter().map(|series| part[*series]).collect()
    }

    /// Returns the structures that its points could show.
    pub(crate) fn catalogue(&self, frame: &Frame) -> Arc<Catalogue> {
        let known = self.catalogue.get_or_init(|| Arc::new(Catalogue::new(frame, &self.points)));
        if known.frame == *frame { Arc::clone(known) } else { Arc::new(Catalogue::new(frame, &self.points)) }
    }

    /// Returns whether the weight of a row was not reduced by more than half.
    pub(crate) fn is_sound(&self, row: usize) -> bool {
        self.weights[row] > SOUND_WEIGHT * self.counts[row]
    }

    /// Returns the root mean square of residuals in newtons over the single readings of the rows;
    /// NaN without rows.
    pub(crate) fn root_mean_square_n(&self, rows: impl Iterator<Item = (usize, f64)>) -> f64 {
        let (sum, count) = rows.fold((0.0, 0.0), |(sum, count), (row, residual)| {
            let n = self.counts[row];
            (sum + n * (residual * residual + self.within_n2[row]), count + n)
        });
        (sum / count).sqrt()
    }

    /// Returns the mean load in newtons.
    pub(crate) fn mean_load_n(&self) -> f64 {
        self.points.iter().map(|p| p.load_n).sum::<f64>() / self.points.len().max(1) as f64
    }

    /// Returns one row per series and direction: means weighted by the repetition noise, which may
    /// be autocorrelated.
    pub(crate) fn cell_means(&self, noise: Noise) -> CellMeans {
        let repetition = Noise {
            repetition: noise.repetition,
            correlation: noise.correlation,
            ..Noise::constant(0.0, 0.0)
        };
        let mut axis = vec![1.0; self.points.len()];
        Weighed::new(self, repetition).whiten(&mut axis);
        let mut kept = Vec::new();
        let mut weights = Vec::new();
        for (cell, load) in self.cells.iter().zip(&self.cell_load_n) {
            let Some(first) = cell.first() else { continue };
            kept.push(*first);
            let precision: f64 = cell.iter().map(|r| axis[*r] * axis[*r]).sum();
            weights.push((precision * noise.repetition.at(*load).powi(2)).max(MIN_WEIGHT));
        }
        let place: std::collections::HashMap<usize, usize> =
            kept.iter().enumerate().map(|(new, old)| (*old, new)).collect();
        let mut observations = self.subset(|i| place.contains_key(&i));
        // `subset` keeps the order of the rows, which may differ from that of the cells.
        let mut order: Vec<usize> = (0..kept.len()).collect();
        sort_by_number(&mut order, |i| kept[*i] as f64);
        let cells: Vec<usize> = order.clone();
        observations.weights = order.iter().map(|i| weights[*i]).collect();
        observations.roots = observations.weights.iter().map(|w| w.sqrt()).collect();
        for (row, cell) in cells.iter().enumerate() {
            observations.points[row].load_n = self.cell_load_n[*cell];
        }
        let mut means = CellMeans { observations, cells, axis, repetition };
        means.observations.friction_n = means.mean_of(self, &self.friction_n);
        means
    }

    /// Excludes a series: its rows stay in the table without influence.
    pub(crate) fn exclude(&mut self, series: usize) {
        self.excluded.push(series);
        self.apply_exclusions();
    }

    /// Returns whether the series of a row is excluded.
    pub fn is_excluded(&self, row: usize) -> bool {
        self.excluded.contains(&self.series_of[row])
    }

    /// Returns the number of excluded series.
    pub fn excluded_series(&self) -> usize {
        self.excluded.len()
    }

    pub(super) fn apply_exclusions(&mut self) {
        for row in 0..self.points.len() {
            if self.is_excluded(row) {
                self.weights[row] = EXCLUDED_WEIGHT;
                self.roots[row] = EXCLUDED_WEIGHT.sqrt();
            }
        }
    }
}

/// Number of series after which a correlation is negligible.
const FORGOTTEN: f64 = 30.0;

/// Returns the series in the order in which they begin. Times show how many are missing between two
/// consecutive ones.
fn turns(cells: &[Vec<usize>], points: &[Point], series_of: &[usize]) -> Vec<Turn> {
    let begin = |cell: &usize| cells[*cell].iter().map(|r| points[*r].time).fold(f64::INFINITY, f64::min);
    let mut of_series: std::collections::BTreeMap<usize, Vec<usize>> = std::collections::BTreeMap::new();
    for (index, cell) in cells.iter().enumerate() {
        if let Some(row) = cell.first() {
            of_series.entry(series_of[*row]).or_default().push(index);
        }
    }
    let mut turns: Vec<(f64, Turn)> = of_series
        .into_values()
        .map(|mut cells| {
            sort_by_number(&mut cells, begin);
            (cells.first().map_or(0.0, begin), Turn { cells, since: 1 })
        })
        .collect();
    sort_by_number(&mut turns, |(begin, _)| *begin);
    let mut gaps: Vec<f64> = turns.windows(2).map(|w| w[1].0 - w[0].0).collect();
    let usual = median(&mut gaps);
    for i in 1..turns.len() {
        let gap = (turns[i].0 - turns[i - 1].0) / usual;
        if usual > 0.0 && gap.is_finite() {
            turns[i].1.since = gap.round().clamp(1.0, FORGOTTEN) as i32;
        }
    }
    turns.into_iter().map(|(_, turn)| turn).collect()
}

/// Returns the rows of each group.
fn collected(of: &[usize], count: usize) -> Vec<Vec<usize>> {
    let mut groups = vec![Vec::new(); count];
    of.iter().enumerate().for_each(|(row, group)| groups[*group].push(row));
    groups
}

/// Returns the mean load of each cell in newtons.
fn loads(cells: &[Vec<usize>], points: &[Point]) -> Vec<f64> {
    cells.iter().map(|c| c.iter().map(|r| points[*r].load_n).sum::<f64>() / c.len().max(1) as f64).collect()
}
