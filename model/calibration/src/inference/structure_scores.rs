//! Scores of structures: every shape of the catalogue on every channel, with the model's constants
//! projected out.

use pinswitch_friction::sort_by_number;

use super::lanes::{LANES, Lanes};
use super::model::Term;
use super::projection::dot;
use super::screening::Screen;
use super::structures::{ALL, Group};
use crate::effects::{Channel, Covariate, Shape, Structure};
use crate::parallel::map_each;

/// Penalty on the gain of a wave.
const WAVE_PENALTY: f64 = 15.0;

/// Penalty on the gain of an interval of time, whose ends are free.
const WINDOW_PENALTY: f64 = 8.0;

/// Smallest share of a column's norm that must remain after projection.
const LEAST_VISIBLE: f64 = 0.02;

/// Number of times at which an interval may begin or end.
const WINDOW_ENDS: usize = 80;

/// Score of a structure.
#[derive(Clone, Debug)]
pub(crate) struct StructureScore {
    /// Shapes that belong together, as the sine and cosine of a wave.
    pub(crate) group: Group,
    /// Sizes, to first order.
    pub(crate) sizes: Vec<f64>,
    /// Reduction of the deviance to first order, less the penalty.
    pub(crate) gain: f64,
    /// Contributions of the series to the score in the group's best direction; the square of their
    /// sum is the gain.
    pub(crate) by_series: Vec<f64>,
}

impl StructureScore {
    /// Returns the penalty on its gain: for two sizes and a free frequency of a wave, for the ends
    /// of an interval of time.
    pub(super) fn penalty(&self) -> f64 {
        match self.group.as_slice() {
            [Structure { form: Shape::TimeWindow { .. }, .. }] => WINDOW_PENALTY,
            [_] => 0.0,
            _ => WAVE_PENALTY,
        }
    }
}

/// Inner products of one or two projected columns with each other and with the residual.
#[derive(Clone, Copy, Debug)]
struct Products {
    /// Squared norm of the first column, and its score.
    first: (f64, f64),
    /// Product of both columns, squared norm of the second, and its score.
    second: Option<(f64, f64, f64)>,
}

impl Products {
    fn of(columns: &[Vec<f64>], residual: &[f64]) -> Option<Self> {
        let first = columns.first()?;
        let second = columns.get(1).map(|c| (dot(first, c), dot(c, c), dot(c, residual)));
        Some(Self { first: (dot(first, first), dot(first, residual)), second })
    }

    /// Returns gain and sizes by least squares; `None` for a zero column.
    fn least_squares(self) -> Option<(f64, Vec<f64>)> {
        let (a, u) = self.first;
        if a < 1e-9 {
            return None;
        }
        let Some((b, c, v)) = self.second else { return Some((u * u / a, vec![u / a])) };
        let det = a * c - b * b;
        if det < 1e-6 * a * c {
            return Some((u * u / a, vec![u / a, 0.0]));
        }
        let (k, l) = ((c * u - b * v) / det, (a * v - b * u) / det);
        Some((k * u + l * v, vec![k, l]))
    }

    /// Returns the squared norm of the columns' sum with these sizes.
    fn length2(self, sizes: &[f64]) -> f64 {
        match (self.second, sizes) {
            (Some((b, c, _)), [k, l]) => k * k * self.first.0 + 2.0 * k * l * b + l * l * c,
            _ => sizes.iter().map(|k| k * k * self.first.0).sum(),
        }
    }
}

/// Returns gain and sizes of one or two columns; `None` for no column or a zero one.
pub(super) fn least_squares(columns: &[Vec<f64>], residual: &[f64]) -> Option<(f64, Vec<f64>)> {
    Products::of(columns, residual)?.least_squares()
}

/// Returns the score of a group from its products with the residual; `parts` are the contributions
/// of each series to each column's score.
fn score_of(group: Group, products: Products, parts: &[Vec<f64>]) -> Option<StructureScore> {
    let (gain, sizes) = products.least_squares()?;
    // A wave has two sizes, and there are hundreds of waves of different frequencies: the penalty
    // accounts for both.
    let gain = if group.len() > 1 { gain - WAVE_PENALTY } else { gain };
    let scale = products.length2(&sizes).sqrt().max(1e-12).recip();
    let mut by_series = vec![0.0; parts.first().map_or(0, Vec::len)];
    for (size, part) in sizes.iter().zip(parts) {
        by_series.iter_mut().zip(part).for_each(|(sum, v)| *sum += scale * size * v);
    }
    Some(StructureScore { group, sizes, gain, by_series })
}

/// Sensitivity of the readings to each channel, in newtons per unit, by row.
type Channels = Vec<(Channel, Vec<f64>)>;

/// Groups that are scored together, with the lane of each one's first column.
type Batch = Vec<(usize, usize)>;

/// Number of parallel parts of the catalogue.
const SHARES: usize = 8;

/// Distributes groups to batches of lanes. A pair uses neighbouring lanes, starting at an even one.
fn batches(groups: &[Group]) -> Vec<Batch> {
    let mut batches = Vec::new();
    let (mut batch, mut lane) = (Batch::new(), 0);
    for (index, group) in groups.iter().enumerate() {
        lane += lane % group.len().max(1);
        if lane + group.len() > LANES {
            batches.push(std::mem::take(&mut batch));
            lane = 0;
        }
        batch.push((index, lane));
        lane += group.len();
    }
    batches.push(batch);
    batches
}

impl Screen<'_> {
    /// Returns scores of the whole catalogue of structures, best first.
    pub(crate) fn structures(&self) -> Vec<StructureScore> {
        let channels = self.channels();
        let catalogue = self.data().catalogue(&self.fitted.model.frame);
        let shares_by_series = self.basis_by_series();
        let score = |several: &[Batch]| {
            let mut lanes = Lanes::zeros(self.data().points.len());
            let mut scores = Vec::new();
            for batch in several {
                lanes.clear();
                for (index, first) in batch {
                    for (place, structure) in catalogue.groups[*index].iter().enumerate() {
                        let Some((_, along)) = channels.iter().find(|(c, _)| *c == structure.channel) else {
                            continue;
                        };
                        let values = catalogue.values(*index, place, &self.data().points);
                        let lane = first + place;
                        let rows = lanes.rows_mut().iter_mut();
                        for ((row, value), along) in rows.zip(values.iter()).zip(along) {
                            row[lane] = value * along;
                        }
                    }
                }
                self.score_batch(&catalogue.groups, batch, &mut lanes, &shares_by_series, &mut scores);
            }
            scores
        };
        let batches = batches(&catalogue.groups);
        let dealt = batches.chunks(batches.len().div_ceil(SHARES).max(1)).collect();
        let mut scores: Vec<StructureScore> = map_each(dealt, score).into_iter().flatten().collect();
        for (channel, along) in channels.iter().filter(|(channel, _)| ALL.contains(channel)) {
            scores.extend(self.best_window(*channel, along));
        }
        sort_by_number(&mut scores, |s| -s.gain);
        scores
    }

    /// Scores the groups whose columns are in the lanes, in newtons. The projection is applied to
    /// the products, not to the columns.
    fn score_batch(
        &self,
        groups: &[Group],
        batch: &Batch,
        lanes: &mut Lanes,
        basis_by_series: &[Vec<f64>],
        scores: &mut Vec<StructureScore>,
    ) {
        self.weighed.whiten_lanes(lanes.rows_mut());
        let whole = lanes.squares();
        let shares = self.basis.shares(lanes);
        let (length2, score) = (left_of(whole, &shares), lanes.dots(&self.residual));
        let mut both = [0.0; LANES];
        for row in lanes.rows() {
            both.iter_mut().zip(row.windows(2)).for_each(|(sum, pair)| *sum += pair[0] * pair[1]);
        }
        for share in &shares {
            both.iter_mut().zip(share.windows(2)).for_each(|(sum, pair)| *sum -= pair[0] * pair[1]);
        }
        let parts = self.parts_by_series(lanes, &shares, basis_by_series);
        for (index, lane) in batch {
            let group = &groups[*index];
            let visible = |lane: usize| length2[lane] > LEAST_VISIBLE * LEAST_VISIBLE * whole[lane];
            if group.is_empty() || !(*lane..lane + group.len()).all(visible) {
                continue;
            }
            let second = (group.len() > 1).then(|| (both[*lane], length2[lane + 1], score[lane + 1]));
            let products = Products { first: (length2[*lane], score[*lane]), second };
            let parts: Vec<Vec<f64>> =
                (*lane..lane + group.len()).map(|l| parts.iter().map(|p| p[l]).collect()).collect();
            scores.extend(score_of(group.clone(), products, &parts));
        }
    }

    /// Returns the contribution of each series to the score of each lane; empty if there are too
    /// many series to flip.
    fn parts_by_series(
        &self,
        lanes: &Lanes,
        shares: &[[f64; LANES]],
        basis_by_series: &[Vec<f64>],
    ) -> Vec<[f64; LANES]> {
        let mut parts = vec![[0.0; LANES]; self.flipped_series()];
        if parts.is_empty() {
            return parts;
        }
        for ((row, series), rest) in lanes.rows().iter().zip(&self.data().series_of).zip(&self.residual) {
            parts[*series].iter_mut().zip(row).for_each(|(sum, v)| *sum += rest * v);
        }
        for (axis, share) in basis_by_series.iter().zip(shares) {
            for (part, along) in parts.iter_mut().zip(axis) {
                part.iter_mut().zip(share).for_each(|(sum, s)| *sum -= along * s);
            }
        }
        parts
    }

    /// Returns the product of each direction of the basis with the residual, by series.
    fn basis_by_series(&self) -> Vec<Vec<f64>> {
        let flipped = self.flipped_series();
        let of = |axis: &Vec<f64>| {
            let mut sums = vec![0.0; flipped];
            for ((a, rest), series) in axis.iter().zip(&self.residual).zip(&self.data().series_of) {
                sums[*series] += a * rest;
            }
            sums
        };
        if flipped == 0 { Vec::new() } else { self.basis.basis().iter().map(of).collect() }
    }

    /// Returns the sensitivities of the readings to the channels.
    fn channels(&self) -> Channels {
        let sensitivity = |channel: Channel| match channel {
            Channel::Reading => vec![1.0; self.predicted.len()],
            Channel::Gain => self.predicted.clone(),
            Channel::Drag => self.data().points.iter().map(|p| p.sign).collect(),
            _ => {
                let everywhere = Structure {
                    covariate: Covariate::Load,
                    channel,
                    form: Shape::LoadPower { power: 0, unit_n: 1.0 },
                };
                let size = 1e-3;
                let mut column = self
                    .fitted
                    .model
                    .with_term(Term::Structure(everywhere), &[size])
                    .predict(&self.data().points);
                column.iter_mut().zip(&self.predicted).for_each(|(c, p)| *c = (*c - p) / size);
                column
            }
        };
        use Channel::{Drag, Friction, Gain, Pins, Reading, Silicone};
        let all = [Reading, Gain, Drag, Friction, Pins, Silicone];
        all.map(|channel| (channel, sensitivity(channel))).to_vec()
    }

    /// Returns the best interval of whole series with a different level. Every pair of ends is
    /// tried with sums over the series, since whitening only mixes rows of one series.
    fn best_window(&self, channel: Channel, along: &[f64]) -> Option<StructureScore> {
        let mut white = along.to_vec();
        self.weighed.whiten(&mut white);
        let mut begins = vec![f64::INFINITY; self.data().series];
        for (row, series) in self.data().series_of.iter().enumerate() {
            begins[*series] = begins[*series].min(self.data().points[row].time);
        }
        let mut order: Vec<usize> = (0..self.data().series).filter(|s| begins[*s].is_finite()).collect();
        sort_by_number(&mut order, |series| begins[*series]);
        // At most eighty possible ends, so that the cost does not grow with thousands of series.
        let ends: Vec<usize> = if order.len() <= WINDOW_ENDS {
            (1..=order.len()).collect()
        } else {
            (1..=WINDOW_ENDS).map(|i| i * order.len() / WINDOW_ENDS).collect()
        };
        if self.weighed.noise.walk.is_any() {
            return self.best_window_beside_a_walk(channel, along, &begins, &order, &ends);
        }
        let basis = self.basis.basis();
        // For each series: score, squared norm, and the component along each direction of the
        // basis.
        let mut sums = vec![vec![0.0; 2 + basis.len()]; self.data().series];
        for (row, series) in self.data().series_of.iter().enumerate() {
            let sum = &mut sums[*series];
            sum[0] += white[row] * self.residual[row];
            sum[1] += white[row] * white[row];
            for (s, axis) in sum[2..].iter_mut().zip(basis) {
                *s += white[row] * axis[row];
            }
        }
        let mut best: Option<(f64, f64, usize, usize)> = None;
        for (i, from) in ends.iter().enumerate() {
            let (from, mut done) = (*from, *from);
            let mut total = vec![0.0; 2 + basis.len()];
            // An interval up to the end of the session is a step, which is in the catalogue.
            for to in ends[i + 1..].iter().copied().filter(|to| *to < order.len()) {
                for series in &order[done..to] {
                    total.iter_mut().zip(&sums[*series]).for_each(|(t, s)| *t += s);
                }
                done = to;
                let visible = total[1] - dot(&total[2..], &total[2..]);
                if to - from < 2 || visible < 4e-4 * total[1] || visible < 1e-9 {
                    continue;
                }
                let gain = total[0] * total[0] / visible - WINDOW_PENALTY;
                if best.is_none_or(|b| gain > b.0) {
                    best = Some((gain, total[0] / visible, from, to));
                }
            }
        }
        let (gain, size, from, to) = best?;
        let group = vec![window(channel, begins[order[from]], begins[order[to]])];
        let flipped = self.flipped_series();
        let mut by_series = vec![0.0; flipped];
        let (mut visible, mut scale) = (0.0, 1.0);
        for series in order[from..to].iter().filter(|_| flipped > 0) {
            by_series[*series] = sums[*series][0];
            visible += sums[*series][1];
        }
        if visible > 0.0 {
            scale = visible.sqrt().recip();
        }
        by_series.iter_mut().for_each(|v| *v *= scale);
        Some(StructureScore { group, sizes: vec![size], gain, by_series })
    }

    /// The same for drifting offsets, where whitening carries a series into the following ones:
    /// sums over steps that begin at each end.
    fn best_window_beside_a_walk(
        &self,
        channel: Channel,
        along: &[f64],
        begins: &[f64],
        order: &[usize],
        ends: &[usize],
    ) -> Option<StructureScore> {
        let data = self.data();
        let step = |from: usize| {
            let mut white = vec![0.0; along.len()];
            for row in order[from..].iter().flat_map(|series| &data.series_rows[*series]) {
                white[*row] = along[*row];
            }
            white
        };
        let ends: Vec<usize> = ends.iter().copied().filter(|end| *end < order.len()).collect();
        let steps: Vec<(Vec<f64>, f64)> = self.all_visible(ends.iter().map(|end| step(*end)));
        let score: Vec<f64> = steps.iter().map(|(column, _)| dot(column, &self.residual)).collect();
        let length2: Vec<f64> = steps.iter().map(|(column, _)| dot(column, column)).collect();
        let mut best: Option<(f64, f64, usize, usize)> = None;
        for (i, (a, share)) in steps.iter().enumerate() {
            for (j, (b, _)) in steps.iter().enumerate().skip(i + 1) {
                let visible = length2[i] - 2.0 * dot(a, b) + length2[j];
                if ends[j] - ends[i] < 2 || *share < LEAST_VISIBLE || visible < 1e-9 {
                    continue;
                }
                let along = score[i] - score[j];
                let gain = along * along / visible - WINDOW_PENALTY;
                if best.is_none_or(|b| gain > b.0) {
                    best = Some((gain, along / visible, i, j));
                }
            }
        }
        let (gain, size, i, j) = best?;
        let column: Vec<f64> = steps[i].0.iter().zip(&steps[j].0).map(|(a, b)| a - b).collect();
        let found = self.group(
            vec![window(channel, begins[order[ends[i]]], begins[order[ends[j]]])],
            std::slice::from_ref(&column),
        )?;
        Some(StructureScore { sizes: vec![size], gain, ..found })
    }

    /// Returns the number of series whose signs are flipped: all, or none if there are so many that
    /// the noise is known without.
    fn flipped_series(&self) -> usize {
        const MOST: usize = 600;
        Some(self.data().series).filter(|series| *series <= MOST).unwrap_or(0)
    }

    /// Fits the residual with one or two projected columns by least squares.
    fn group(&self, group: Group, columns: &[Vec<f64>]) -> Option<StructureScore> {
        let parts: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| {
                let mut part = vec![0.0; self.flipped_series()];
                if !part.is_empty() {
                    for ((v, rest), series) in column.iter().zip(&self.residual).zip(&self.data().series_of) {
                        part[*series] += v * rest;
                    }
                }
                part
            })
            .collect();
        score_of(group, Products::of(columns, &self.residual)?, &parts)
    }
}

/// Returns squared norms less the components along directions.
fn left_of(whole: [f64; LANES], shares: &[[f64; LANES]]) -> [f64; LANES] {
    let mut left = whole;
    for share in shares {
        left.iter_mut().zip(share).for_each(|(sum, s)| *sum -= s * s);
    }
    left
}

/// Returns an interval of series, from the time of its first one to that of the one after its last.
fn window(channel: Channel, from: f64, to: f64) -> Structure {
    let form = Shape::TimeWindow { from: from - 1e-9, to: to - 1e-9 };
    Structure { covariate: Covariate::Time, channel, form }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Model, Noise, Observations, Weighed, fit};
    use crate::table::Frame;
    use crate::test_session::session;

    #[test]
    fn the_best_structure_is_an_interval() {
        let mut rows = session(4);
        let (from, to) = (rows.len() / 3, rows.len() / 2);
        let (first, last) = (rows[from].time_s, rows[to].time_s);
        rows.iter_mut().filter(|r| (first..last).contains(&r.time_s)).for_each(|r| r.force_n += 0.4);
        let frame = Frame::new(&rows);
        let data = Observations::new(&frame, &rows).unwrap();
        let model = Model::baseline(frame);
        let weighed = &Weighed::new(&data, Noise::constant(0.05, 0.01));
        let fitted = fit(&model, weighed);
        let scores = Screen::new(&fitted, weighed).structures();
        assert!(scores.windows(2).all(|w| w[0].gain >= w[1].gain));
        let best = &scores[0].group[0];
        assert_eq!((best.covariate, best.channel), (Covariate::Time, Channel::Reading));
        assert!(matches!(best.form, Shape::TimeWindow { .. }), "{best:?}");
        assert!((scores[0].sizes[0] - 0.4).abs() < 0.1, "{:?}", scores[0].sizes);
    }

    #[test]
    fn two_columns_are_fitted_together() {
        let (a, b) = (vec![1.0, 0.0, 1.0], vec![0.0, 2.0, 1.0]);
        let residual: Vec<f64> = (0..3).map(|i| 3.0 * a[i] - 0.5 * b[i]).collect();
        let (gain, sizes) = least_squares(&[a, b], &residual).unwrap();
        assert!((sizes[0] - 3.0).abs() < 1e-12 && (sizes[1] + 0.5).abs() < 1e-12, "{sizes:?}");
        assert!((gain - dot(&residual, &residual)).abs() < 1e-12);
        assert_eq!(least_squares(&[], &residual), None);
        assert_eq!(least_squares(&[vec![0.0; 3]], &residual), None);
    }

    /// Scores computed from products equal those computed from the columns.
    #[test]
    fn scores_equal_those_of_projected_columns() {
        let rows = session(5);
        let frame = Frame::new(&rows);
        let data = Observations::new(&frame, &rows).unwrap();
        let model = Model::baseline(frame);
        let noise =
            Noise { correlation: 0.4, series_scale: 0.02, mount_scale: 0.01, ..Noise::constant(0.05, 0.05) };
        let weighed = &Weighed::new(&data, noise);
        let fitted = fit(&model, weighed);
        let screen = Screen::new(&fitted, weighed);
        let channels = screen.channels();
        let mut compared = 0;
        for score in
            screen.structures().iter().filter(|s| !matches!(s.group[0].form, Shape::TimeWindow { .. }))
        {
            let traces = score.group.iter().map(|structure| {
                let (_, along) = channels.iter().find(|(c, _)| *c == structure.channel).unwrap();
                data.points.iter().zip(along).map(|(p, a)| structure.value(p) * a).collect()
            });
            let columns: Vec<Vec<f64>> = screen.all_visible(traces).into_iter().map(|(c, _)| c).collect();
            let direct = screen.group(score.group.clone(), &columns).unwrap();
            assert!(
                (direct.gain - score.gain).abs() < 1e-6 * (1.0 + direct.gain.abs()),
                "{direct:?} {score:?}"
            );
            let apart: f64 = direct.by_series.iter().zip(&score.by_series).map(|(a, b)| (a - b).abs()).sum();
            let length: f64 = direct.by_series.iter().map(|v| v.abs()).sum();
            assert!(apart < 1e-3 * (1e-3 + length), "{apart} of {length}");
            compared += 1;
        }
        assert!(compared > 300, "{compared}");
    }
}
