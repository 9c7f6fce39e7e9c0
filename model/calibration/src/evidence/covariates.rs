//! Covariates of the rows of a table, in the order of their series.

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::sort_by_number;

use crate::table::{Frame, PlateauRow, Point};

/// Rows of a table with the covariates of kernels.
#[derive(Clone, Debug)]
pub(super) struct Covariates {
    /// Index of each row in the table.
    pub(super) source: Vec<usize>,
    pub(super) points: Vec<Point>,
    pub(super) readings: Vec<f64>,
    /// Number of the series of each row, in the order of their first rows.
    pub(super) series: Vec<usize>,
    /// Rank of the series of each row in the order of sessions and of time.
    pub(super) sequence: Vec<usize>,
    /// Rank in time within the series, from 0.
    pub(super) order: Vec<usize>,
    /// Seconds since the series began.
    pub(super) series_time_s: Vec<f64>,
    /// Time of the first row of the series in seconds.
    pub(super) series_start_s: Vec<f64>,
    /// Wrap angle in degrees.
    pub(super) wrap_deg: Vec<f64>,
    pub(super) labels: Vec<RowLabels>,
}

/// Names of the levels of factors at a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RowLabels {
    pub(super) condition: String,
    /// Numbers of the occupied grooves.
    pub(super) layout: String,
    pub(super) mount: String,
    pub(super) specimen: String,
    pub(super) operator: String,
    pub(super) session: String,
}

impl Covariates {
    /// Sorts the rows of a table by session and series, each in the order of their first rows.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the frame lacks the condition of a row.
    pub(super) fn new(frame: &Frame, rows: &[PlateauRow]) -> Result<Self, Diagnostic> {
        let (series_of, _) = crate::table::groups(rows, |r| (r.labels.session.clone(), r.series.clone()));
        let (session_of, _) = crate::table::groups(rows, |r| r.labels.session.clone());
        let mut source: Vec<usize> = (0..rows.len()).collect();
        source.sort_by_key(|i| (session_of[*i], series_of[*i]));
        let missing = || Diagnostic::new(codes::INTERNAL_ERROR, "a row has a condition that the table lacks");
        let all = frame.points(rows).ok_or_else(missing)?;
        let points: Vec<Point> = source.iter().map(|i| all[*i]).collect();
        let begins = |pair: &[usize]| usize::from(series_of[pair[0]] != series_of[pair[1]]);
        let series: Vec<usize> = std::iter::once(0)
            .chain(source.windows(2).map(begins))
            .scan(0, |number, begins| {
                *number += begins;
                Some(*number)
            })
            .take(rows.len())
            .collect();
        let has_mounts = rows.iter().any(|row| !row.labels.mount.is_empty());
        let labels = source.iter().zip(&points).map(|(i, point)| {
            let row = &rows[*i];
            let condition = &frame.conditions[point.condition];
            // The angle of a `plain` contact belongs to the rig: it does not make another mount.
            let kind = condition.substrate.map_or_else(|| "plain".to_owned(), |_| condition.name());
            let layout = format!("{:?}", condition.pins);
            let condition = condition.name();
            let mount = if has_mounts {
                format!("{}|{}", row.labels.session, row.labels.mount)
            } else {
                format!("{kind}|{}|{}", row.labels.session, row.labels.specimen)
            };
            RowLabels {
                condition,
                layout,
                mount,
                specimen: row.labels.specimen.clone(),
                operator: row.labels.operator.clone(),
                session: row.labels.session.clone(),
            }
        });
        let labels = labels.collect();
        let readings = source.iter().map(|i| rows[*i].force_n).collect();
        let wrap_deg = source.iter().map(|i| rows[*i].wrap_angle_deg).collect();
        let mut covariates = Self {
            source,
            order: vec![0; points.len()],
            series_time_s: vec![0.0; points.len()],
            series_start_s: vec![0.0; points.len()],
            points,
            readings,
            sequence: vec![0; series.len()],
            series,
            wrap_deg,
            labels,
        };
        covariates.order_series();
        covariates.rank_series();
        Ok(covariates)
    }

    /// Returns some of the rows.
    pub(super) fn select(&self, rows: &[usize]) -> Self {
        fn of<T: Clone>(all: &[T], rows: &[usize]) -> Vec<T> {
            rows.iter().map(|row| all[*row].clone()).collect()
        }
        Self {
            source: of(&self.source, rows),
            points: of(&self.points, rows),
            readings: of(&self.readings, rows),
            series: of(&self.series, rows),
            sequence: of(&self.sequence, rows),
            order: of(&self.order, rows),
            series_time_s: of(&self.series_time_s, rows),
            series_start_s: of(&self.series_start_s, rows),
            wrap_deg: of(&self.wrap_deg, rows),
            labels: of(&self.labels, rows),
        }
    }

    fn order_series(&mut self) {
        let mut first = 0;
        while first < self.len() {
            let end = (first..self.len()).find(|i| self.series[*i] != self.series[first]);
            let mut rows: Vec<usize> = (first..end.unwrap_or(self.len())).collect();
            sort_by_number(&mut rows, |i| self.points[*i].time_s);
            let start = rows.first().map_or(0.0, |i| self.points[*i].time_s);
            for (rank, row) in rows.iter().enumerate() {
                self.order[*row] = rank;
                self.series_time_s[*row] = self.points[*row].time_s - start;
                self.series_start_s[*row] = start;
            }
            first += rows.len();
        }
    }

    /// Ranks the series by session, in the order of their first rows, and by their start.
    fn rank_series(&mut self) {
        let mut sessions: Vec<&str> = Vec::new();
        let mut starts: Vec<(usize, f64, usize)> = Vec::new();
        for row in 0..self.len() {
            let session = self.labels[row].session.as_str();
            let place = sessions.iter().position(|known| *known == session).unwrap_or_else(|| {
                sessions.push(session);
                sessions.len() - 1
            });
            if starts.last().is_none_or(|(.., series)| *series != self.series[row]) {
                starts.push((place, self.series_start_s[row], self.series[row]));
            }
        }
        starts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut rank = vec![0; starts.len()];
        starts.iter().enumerate().for_each(|(at, (.., series))| rank[*series] = at);
        self.sequence = self.series.iter().map(|series| rank[*series]).collect();
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Returns the number of series.
    pub(super) fn series_count(&self) -> usize {
        self.series.last().map_or(0, |last| last + 1)
    }

    /// Returns a number of each row.
    pub(super) fn column(&self, value: impl Fn(&Point) -> f64) -> Vec<f64> {
        self.points.iter().map(value).collect()
    }

    /// Returns the sorted names of the levels of a factor.
    pub(super) fn level_names(&self, name: impl Fn(&RowLabels) -> &str) -> Vec<String> {
        let names: std::collections::BTreeSet<&str> = self.labels.iter().map(name).collect();
        names.into_iter().map(str::to_owned).collect()
    }
}

/// Returns the number of different values, to a thousandth.
pub(super) fn distinct(values: &[f64]) -> usize {
    let mut rounded: Vec<f64> = values.iter().map(|v| (v * 1e3).round()).collect();
    rounded.sort_by(f64::total_cmp);
    rounded.dedup();
    rounded.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    /// Two days whose rows alternate in the table: all rows of the first day come first, series by series.
    #[test]
    fn interleaved_sessions_are_consecutive() {
        let day = |name: &str, seed| {
            let mut rows = session(seed);
            rows.iter_mut().for_each(|row| name.clone_into(&mut row.labels.session));
            rows
        };
        let rows: Vec<PlateauRow> =
            day("b", 1).into_iter().zip(day("a", 2)).flat_map(|(b, a)| [b, a]).collect();
        let covariates = Covariates::new(&Frame::new(&rows), &rows).unwrap();
        assert!(covariates.points.is_sorted_by_key(|point| point.session_group));
        assert!(covariates.series.windows(2).all(|pair| pair[1] - pair[0] <= 1), "{:?}", covariates.series);
        let [first, last] = [&covariates.labels[0], &covariates.labels[rows.len() - 1]];
        assert_eq!((first.session.as_str(), last.session.as_str()), ("b", "a"));
        assert_eq!(covariates.series_count(), 2 * 60);
    }
}
