//! Compaction of long series: neighbouring repetitions are averaged, so that the cost of a fit
//! depends on the number of series and not on their length.

use pinswitch_friction::sort_by_number;

use super::observations::Observations;
use crate::table::Point;

/// Largest number of rows that are fitted without averaging.
pub(crate) const MOST_ROWS: usize = 12_000;
/// Fewest rows per series and direction, to preserve trends along the stroke.
const LEAST_PER_CELL: usize = 3;

impl Observations {
    /// Returns the table in about [`MOST_ROWS`] rows: means of neighbours in each series and
    /// direction, with the weights of outliers. A table within the limit is unchanged.
    pub(crate) fn compacted(&self) -> Self {
        if self.points.len() <= MOST_ROWS {
            return self.clone();
        }
        let per_cell = (MOST_ROWS / self.cells.len().max(1)).max(LEAST_PER_CELL);
        let mut bins: Vec<&[usize]> = Vec::new();
        for cell in &self.cells {
            bins.extend(cell.chunks(cell.len().div_ceil(per_cell).max(1)));
        }
        sort_by_number(&mut bins, |rows| rows[0] as f64);
        let first: std::collections::HashMap<usize, usize> =
            bins.iter().enumerate().map(|(bin, rows)| (rows[0], bin)).collect();
        let mut compact = self.subset(|row| first.contains_key(&row));
        for (bin, rows) in bins.iter().enumerate() {
            let total: f64 = rows.iter().map(|r| self.weights[*r]).sum();
            let mean = |of: &dyn Fn(usize) -> f64| {
                rows.iter().map(|r| self.weights[*r] * of(*r)).sum::<f64>() / total
            };
            let along = |of: fn(&Point) -> f64| mean(&|r| of(&self.points[r]));
            let point = &mut compact.points[bin];
            point.repetition = along(|p| p.repetition);
            point.position = along(|p| p.position);
            point.time = along(|p| p.time);
            point.travel = along(|p| p.travel);
            point.through = along(|p| p.through);
            point.position_mm = along(|p| p.position_mm);
            point.time_s = along(|p| p.time_s);
            let force_n = mean(&|r| self.force_n[r]);
            compact.force_n[bin] = force_n;
            compact.friction_n[bin] = mean(&|r| self.friction_n[r]);
            compact.within_n2[bin] = mean(&|r| (self.force_n[r] - force_n).powi(2));
            compact.counts[bin] = total;
            compact.weights[bin] = total;
            compact.roots[bin] = total.sqrt();
        }
        compact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Frame, PlateauRow};
    use crate::test_session::session;

    #[test]
    fn compaction_keeps_means_and_spread() {
        let short = session(1);
        assert!(
            Observations::new(&Frame::new(&short), &short).unwrap().compacted().points.len() == short.len()
        );
        // Every series is sixty times as long.
        let long: Vec<PlateauRow> = (0..60u32)
            .flat_map(|k| {
                short.iter().map(move |row| PlateauRow {
                    repetition: row.repetition + 9 * k,
                    time_s: row.time_s + 1e4 * f64::from(k),
                    force_n: row.force_n + if k % 2 == 0 { 0.3 } else { -0.3 },
                    ..row.clone()
                })
            })
            .collect();
        let data = Observations::new(&Frame::new(&long), &long).unwrap();
        let compact = data.compacted();
        assert!(compact.points.len() < MOST_ROWS * 3 / 2, "{} rows", compact.points.len());
        assert_eq!((compact.series, compact.cells.len()), (data.series, data.cells.len()));
        let total: f64 = compact.counts.iter().sum();
        assert!((total - long.len() as f64).abs() < 1e-6);
        let mean = |d: &Observations| -> f64 {
            d.force_n.iter().zip(&d.counts).map(|(y, c)| y * c).sum::<f64>() / d.counts.iter().sum::<f64>()
        };
        assert!((mean(&compact) - mean(&data)).abs() < 1e-9);
        let squares = |d: &Observations| -> f64 {
            d.force_n.iter().zip(&d.counts).zip(&d.within_n2).map(|((y, c), w)| c * (y * y + w)).sum()
        };
        assert!((squares(&compact) / squares(&data) - 1.0).abs() < 1e-9, "the spread is preserved");
    }
}
