//! A table ready for inference: points, readings, and how the rows are grouped.

use crate::median::median;
use crate::table::{Frame, PlateauRow, Point};

/// Points and readings with their grouping.
#[derive(Clone, Debug)]
pub struct Observations {
    /// The rows as the model reads them.
    pub points: Vec<Point>,
    /// Readings in newtons.
    pub force_n: Vec<f64>,
    /// Series of each row.
    pub series_of: Vec<usize>,
    /// Number of series.
    pub series: usize,
    /// Rows of each series and direction: they share an offset.
    pub cells: Vec<Vec<usize>>,
    /// Load of each cell in newtons.
    pub cell_load_n: Vec<f64>,
    /// Weight of each row, 1 for a sound one.
    pub weights: Vec<f64>,
    /// Roots of the weights.
    pub(crate) roots: Vec<f64>,
    /// Series that are wrong as a whole and decide nothing.
    excluded: Vec<usize>,
}

/// Weight below which no row falls, so that its root stays a number; a reading a million times off has no say at it.
const MIN_WEIGHT: f64 = 1e-16;
/// Weight of the rows of an excluded series: they keep their place and have no say.
const EXCLUDED_WEIGHT: f64 = 1e-7;

impl Observations {
    /// Groups a table; `None` if the frame lacks a condition.
    pub fn new(frame: &Frame, rows: &[PlateauRow]) -> Option<Self> {
        let points = frame.points(rows)?;
        let (series_of, series) = crate::table::groups(rows, |r| r.series.clone());
        let (cell_of, count) = crate::table::groups(rows, |r| {
            (r.series.clone(), r.direction == pinswitch_friction::Direction::Concentric)
        });
        let mut cells = vec![Vec::new(); count];
        for (row, cell) in cell_of.iter().enumerate() {
            cells[*cell].push(row);
        }
        // Neighbours in time, whatever the order of the table.
        for cell in &mut cells {
            cell.sort_by(|a, b| points[*a].time.total_cmp(&points[*b].time));
        }
        let force_n = rows.iter().map(|r| r.force_n).collect();
        let cell_load_n = loads(&cells, &points);
        let ones = vec![1.0; rows.len()];
        Some(Self {
            points,
            force_n,
            series_of,
            series,
            cells,
            cell_load_n,
            weights: ones.clone(),
            roots: ones,
            excluded: Vec::new(),
        })
    }

    /// The rows for which `keep` holds.
    #[must_use]
    pub fn subset(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.points.len()).filter(|i| keep(*i)).collect();
        let mut new_index = vec![usize::MAX; self.points.len()];
        for (new, old) in kept.iter().enumerate() {
            new_index[*old] = new;
        }
        let points: Vec<Point> = kept.iter().map(|i| self.points[*i]).collect();
        let cells: Vec<Vec<usize>> = self
            .cells
            .iter()
            .map(|c| c.iter().map(|i| new_index[*i]).filter(|i| *i != usize::MAX).collect::<Vec<_>>())
            .filter(|c| !c.is_empty())
            .collect();
        Self {
            cell_load_n: loads(&cells, &points),
            points,
            force_n: kept.iter().map(|i| self.force_n[*i]).collect(),
            series_of: kept.iter().map(|i| self.series_of[*i]).collect(),
            series: self.series,
            cells,
            weights: kept.iter().map(|i| self.weights[*i]).collect(),
            roots: kept.iter().map(|i| self.roots[*i]).collect(),
            excluded: self.excluded.clone(),
        }
    }

    /// Excludes a series: its rows keep their place and have no say.
    pub(crate) fn exclude(&mut self, series: usize) {
        self.excluded.push(series);
        self.apply_exclusions();
    }

    /// Whether the series of a row is excluded.
    pub fn is_excluded(&self, row: usize) -> bool {
        self.excluded.contains(&self.series_of[row])
    }

    /// Number of series excluded.
    pub fn excluded_series(&self) -> usize {
        self.excluded.len()
    }

    fn apply_exclusions(&mut self) {
        for row in 0..self.points.len() {
            if self.is_excluded(row) {
                self.weights[row] = EXCLUDED_WEIGHT;
                self.roots[row] = EXCLUDED_WEIGHT.sqrt();
            }
        }
    }

    /// Weighs rows down whose residual stands out from its neighbours in the same series and direction.
    /// The neighbours' running median follows any smooth course, so that structure is not taken for outliers.
    pub fn weigh_outliers(&mut self, residual_n: &[f64]) -> f64 {
        let mut local = vec![0.0; residual_n.len()];
        for cell in &self.cells {
            for (i, row) in cell.iter().enumerate() {
                let (from, to) = (i.saturating_sub(3), (i + 4).min(cell.len()));
                let mut near: Vec<f64> = cell[from..to].iter().map(|r| residual_n[*r]).collect();
                local[*row] = residual_n[*row] - median(&mut near);
            }
        }
        // The spread may grow with load: medians over quarters of the loads, the own row's zeros left out.
        let spread = |keep: &dyn Fn(f64) -> bool| {
            let mut size: Vec<f64> = local
                .iter()
                .zip(&self.points)
                .filter(|(v, p)| **v != 0.0 && keep(p.load_n))
                .map(|(v, _)| v.abs())
                .collect();
            (size.len() > 20).then(|| 1.4826 * median(&mut size) / 1.08)
        };
        let sd = spread(&|_| true).unwrap_or(0.0).max(1e-9);
        let mut loads: Vec<f64> = self.points.iter().map(|p| p.load_n).collect();
        loads.sort_by(f64::total_cmp);
        let quarter = |i: usize| loads.get(i * loads.len() / 4).copied().unwrap_or(f64::INFINITY);
        let edges = [quarter(1), quarter(2), quarter(3)];
        let part = |load: f64| edges.iter().filter(|e| load >= **e).count();
        let parts: Vec<f64> =
            (0..4).map(|i| spread(&|load| part(load) == i).unwrap_or(sd).max(0.3 * sd)).collect();
        for ((weight, value), point) in self.weights.iter_mut().zip(&local).zip(&self.points) {
            let z = (value / parts[part(point.load_n)]).abs();
            *weight = if z <= 3.2 { 1.0 } else { (3.2 / z).powi(3).max(MIN_WEIGHT) };
        }
        self.roots = self.weights.iter().map(|w| w.sqrt()).collect();
        self.apply_exclusions();
        sd
    }
}

/// Mean load of each cell in newtons.
fn loads(cells: &[Vec<usize>], points: &[Point]) -> Vec<f64> {
    cells.iter().map(|c| c.iter().map(|r| points[*r].load_n).sum::<f64>() / c.len().max(1) as f64).collect()
}
