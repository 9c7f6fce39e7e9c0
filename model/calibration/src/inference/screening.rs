//! Scores: how much each effect or structure that is not in a model would gain, by its sensitivity after the
//! model's own constants have been refitted to first order.

use super::fit::{Fit, jacobian};
use super::form_tolerance::{BEND, bent_copies};
use super::forward::Term;
use super::observations::Observations;
use super::projection::{Projection, dot};
use super::structures::{Group, structures_to_try};
use super::weighed::Weighed;
use crate::effects::{Channel, Covariate, Effect, Shape, Structure};

/// What a wave's gain is reduced by, in whitened squares.
const WAVE_PENALTY: f64 = 15.0;

/// What a stretch of time's gain is reduced by: both its ends are free.
const WINDOW_PENALTY: f64 = 8.0;

/// Places where a stretch of time may begin or end.
const WINDOW_ENDS: usize = 80;

/// A fitted model with its whitened residual and the directions its constants can take.
pub(crate) struct Screen<'a> {
    fitted: &'a Fit,
    weighed: &'a Weighed<'a>,
    basis: Projection,
    residual: Vec<f64>,
    predicted: Vec<f64>,
    bent_gain: f64,
}

/// Score of a named effect.
#[derive(Clone, Debug)]
pub(crate) struct EffectScore {
    /// The effect.
    pub(crate) effect: &'static dyn Effect,
    /// Constants to start its fit from.
    pub(crate) start: Vec<f64>,
    /// The first constant at which the trace was taken.
    pub(crate) size: f64,
    /// Share of that size which the residual asks for.
    pub(crate) share: f64,
    /// Gain in whitened squares to first order.
    pub(crate) gain: f64,
    /// Share of the sensitivity's length that the model's own constants cannot take over.
    pub(crate) visible_share: f64,
    /// Length of the visible sensitivity at the start's size, in standard deviations.
    pub(crate) strength: f64,
    /// Contributions of the series to the score; their squared sum is the gain.
    pub(crate) by_series: Vec<f64>,
    /// The visible sensitivity itself.
    pub(crate) column: Vec<f64>,
    /// The sensitivity in newtons, before anything is taken out of it.
    pub(crate) trace_n: Vec<f64>,
}

/// Score of a structure.
#[derive(Clone, Debug)]
pub(crate) struct StructureScore {
    /// Shapes that go together (a wave is a sine and a cosine).
    pub(crate) group: Group,
    /// Sizes to first order.
    pub(crate) sizes: Vec<f64>,
    /// Gain in whitened squares to first order, less the penalty of a wave.
    pub(crate) gain: f64,
    /// Contributions of the series to the score of the group's best direction; their squared sum is the gain.
    pub(crate) by_series: Vec<f64>,
}

impl<'a> Screen<'a> {
    /// Scores on top of a fit.
    pub(crate) fn new(fitted: &'a Fit, weighed: &'a Weighed<'a>) -> Self {
        Self::with_nuisances(fitted, weighed, |_| Vec::new())
    }

    /// Scores on top of a fit whose named effects may bend their own forms.
    pub(crate) fn guarded(fitted: &'a Fit, weighed: &'a Weighed<'a>) -> Self {
        Self::with_nuisances(fitted, weighed, |predicted| bent_copies(&fitted.model, weighed.data, predicted))
    }

    fn with_nuisances(
        fitted: &'a Fit,
        weighed: &'a Weighed<'a>,
        nuisances: impl Fn(&[f64]) -> Vec<Vec<f64>>,
    ) -> Self {
        let (model, data) = (&fitted.model, weighed.data);
        let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
        let (rows, p) = (predicted.len(), model.coordinates.len());
        let bent = nuisances(&predicted);
        let mut basis = Projection::new(rows + p + bent.len());
        let own =
            jacobian(model, data, &predicted).into_iter().zip(model.priors().iter().map(|prior| prior.sd));
        for (j, (mut column, sd)) in own.chain(bent.into_iter().map(|b| (b, BEND))).enumerate() {
            weighed.whiten(&mut column);
            column.resize(basis.len(), 0.0);
            column[rows + j] = 1.0 / sd;
            basis.absorb(column);
        }
        let mut residual = fitted.residual_n.clone();
        weighed.whiten(&mut residual);
        residual.extend(
            model.coordinates.iter().zip(model.priors()).map(|(c, prior)| (prior.mean - c) / prior.sd),
        );
        residual.resize(basis.len(), 0.0);
        let before = dot(&residual, &residual);
        basis.remove(&mut residual);
        let bent_gain = before - dot(&residual, &residual);
        Self { fitted, weighed, basis, residual, predicted, bent_gain }
    }

    fn data(&self) -> &'a Observations {
        self.weighed.data
    }

    /// What the named effects would gain by bending their own forms, in whitened squares.
    pub(crate) fn bent_gain(&self) -> f64 {
        self.bent_gain
    }

    /// Whitens a column in newtons and removes what the model's constants can take over.
    /// Returns it with the share of its length that is left.
    fn visible(&self, mut column: Vec<f64>) -> (Vec<f64>, f64) {
        self.weighed.whiten(&mut column);
        let before = dot(&column, &column).sqrt();
        column.resize(self.residual.len(), 0.0);
        self.basis.remove(&mut column);
        let after = dot(&column, &column).sqrt();
        (column, if before > 0.0 { after / before } else { 0.0 })
    }

    /// Scores of all effects that the model does not have, one per effect at its best shape.
    pub(crate) fn effects(&self) -> Vec<EffectScore> {
        let model = &self.fitted.model;
        let absent = |effect: &&'static dyn Effect| {
            !model.terms.iter().any(|t| matches!(t, Term::Named(e) if e.id() == effect.id()))
        };
        model
            .vocabulary
            .acting_order()
            .iter()
            .copied()
            .filter(absent)
            .filter_map(|effect| self.effect(effect))
            .collect()
    }

    fn effect(&self, effect: &'static dyn Effect) -> Option<EffectScore> {
        let mut best: Option<EffectScore> = None;
        for start in effect.starts(&self.fitted.model.frame) {
            let changed =
                self.fitted.model.with_term(Term::Named(effect), &start).predict(&self.data().points);
            let trace_n: Vec<f64> = changed.iter().zip(&self.predicted).map(|(c, p)| c - p).collect();
            let (column, visible_share) = self.visible(trace_n.clone());
            let length2 = dot(&column, &column);
            let along = dot(&column, &self.residual);
            let scales = effect.description().scales;
            let gain = if length2 < 1e-9 {
                0.0
            } else if scales {
                along * along / length2
            } else {
                2.0 * along - length2
            };
            if best.as_ref().is_none_or(|b| gain > b.gain) {
                let mut by_series = vec![0.0; self.data().series];
                let scale = 1.0 / length2.sqrt().max(1e-9);
                for (row, series) in self.data().series_of.iter().enumerate() {
                    by_series[*series] += scale * column[row] * self.residual[row];
                }
                let (mut start, size) = (start.clone(), start.first().copied().unwrap_or(1.0));
                if scales && length2 > 1e-9 {
                    start[0] *= along / length2;
                }
                best = Some(EffectScore {
                    effect,
                    start,
                    size,
                    share: if length2 > 1e-9 { along / length2 } else { 0.0 },
                    gain,
                    visible_share,
                    strength: length2.sqrt(),
                    by_series,
                    column,
                    trace_n,
                });
            }
        }
        best
    }

    /// Scores of the whole catalogue of structures, best first.
    pub(crate) fn structures(&self) -> Vec<StructureScore> {
        let sensitivity = |channel: Channel| match channel {
            Channel::Reading => vec![1.0; self.predicted.len()],
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
        let channels = [Channel::Reading, Channel::Drag, Channel::Friction, Channel::Pins, Channel::Silicone]
            .map(|channel| (channel, sensitivity(channel)));
        // The same shape is tried on several channels in a row.
        let mut last: Vec<(Shape, Vec<f64>)> = Vec::new();
        let mut scores: Vec<StructureScore> =
            structures_to_try(&self.fitted.model.frame, &self.data().points)
                .into_iter()
                .filter_map(|group| {
                    let columns: Vec<Vec<f64>> = group
                        .iter()
                        .filter_map(|structure| {
                            let (_, along) = channels.iter().find(|(c, _)| *c == structure.channel)?;
                            let known = last.iter().position(|(form, _)| *form == structure.form);
                            let at = known.unwrap_or_else(|| {
                                if last.len() > 1 {
                                    last.remove(0);
                                }
                                let values = self.data().points.iter().map(|p| structure.value(p)).collect();
                                last.push((structure.form.clone(), values));
                                last.len() - 1
                            });
                            let column = last[at].1.iter().zip(along).map(|(v, s)| v * s).collect();
                            let (column, visible) = self.visible(column);
                            (visible > 0.02).then_some(column)
                        })
                        .collect();
                    self.group(group, &columns)
                })
                .collect();
        for (channel, along) in &channels[..3] {
            scores.extend(self.best_window(*channel, along));
        }
        scores.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        scores
    }

    /// The best stretch of whole series, at another level than the rest: every pair of ends is tried, by sums over
    /// the series, since whitening mixes the rows of a series only.
    fn best_window(&self, channel: Channel, along: &[f64]) -> Option<StructureScore> {
        let mut white = along.to_vec();
        self.weighed.whiten(&mut white);
        let mut begins = vec![f64::INFINITY; self.data().series];
        for (row, series) in self.data().series_of.iter().enumerate() {
            begins[*series] = begins[*series].min(self.data().points[row].time);
        }
        let mut order: Vec<usize> = (0..self.data().series).filter(|s| begins[*s].is_finite()).collect();
        order.sort_by(|a, b| begins[*a].total_cmp(&begins[*b]));
        // Ends at up to eighty places, so that thousands of series cost no more than some hundreds.
        let ends: Vec<usize> = if order.len() <= WINDOW_ENDS {
            (1..=order.len()).collect()
        } else {
            (1..=WINDOW_ENDS).map(|i| i * order.len() / WINDOW_ENDS).collect()
        };
        if self.weighed.noise.walk.is_any() {
            return self.best_window_beside_a_walk(channel, along, &begins, &order, &ends);
        }
        let basis = self.basis.basis();
        // Of each series: score, squared length, and the share of each direction of the basis.
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
            // To the end of the session it would be a step, which stands in the catalogue.
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

    /// The same where offsets wander, so that whitening carries a series into those after it: sums over steps that begin
    /// at each end.
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
            self.visible(white)
        };
        let ends: Vec<usize> = ends.iter().copied().filter(|end| *end < order.len()).collect();
        let steps: Vec<(Vec<f64>, f64)> = ends.iter().map(|end| step(*end)).collect();
        let score: Vec<f64> = steps.iter().map(|(column, _)| dot(column, &self.residual)).collect();
        let length2: Vec<f64> = steps.iter().map(|(column, _)| dot(column, column)).collect();
        let mut best: Option<(f64, f64, usize, usize)> = None;
        for (i, (a, share)) in steps.iter().enumerate() {
            for (j, (b, _)) in steps.iter().enumerate().skip(i + 1) {
                let visible = length2[i] - 2.0 * dot(a, b) + length2[j];
                if ends[j] - ends[i] < 2 || *share < 0.02 || visible < 1e-9 {
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

    /// Gain of free offsets of each series, one per direction, for the series that are not excluded.
    pub(crate) fn series_offsets(&self) -> Vec<(usize, f64)> {
        let mut columns = vec![Vec::new(); self.data().series];
        for cell in &self.data().cells {
            let Some(row) = cell.first().filter(|r| !self.data().is_excluded(**r)) else { continue };
            let mut column = vec![0.0; self.predicted.len()];
            cell.iter().for_each(|r| column[*r] = 1.0);
            columns[self.data().series_of[*row]].push(self.visible(column).0);
        }
        columns
            .iter()
            .enumerate()
            .filter_map(|(series, columns)| {
                least_squares(columns, &self.residual).map(|(gain, _)| (series, gain))
            })
            .collect()
    }

    /// Series whose signs are flipped: all, or none where there are so many that the noise is known without.
    fn flipped_series(&self) -> usize {
        const MOST: usize = 600;
        Some(self.data().series).filter(|series| *series <= MOST).unwrap_or(0)
    }

    /// Least squares of the residual on one or two visible columns.
    fn group(&self, group: Group, columns: &[Vec<f64>]) -> Option<StructureScore> {
        if columns.len() != group.len() || columns.is_empty() {
            return None;
        }
        let (gain, sizes) = least_squares(columns, &self.residual)?;
        // A wave has two sizes, and there are hundreds of them at free frequencies: its gain must pay for both.
        let gain = if group.len() > 1 { gain - WAVE_PENALTY } else { gain };
        let flipped = self.flipped_series();
        let mut by_series = vec![0.0; flipped];
        let mut length2 = 0.0;
        for (row, series) in self.data().series_of.iter().enumerate().filter(|_| flipped > 0) {
            let value: f64 = columns.iter().zip(&sizes).map(|(c, k)| k * c[row]).sum();
            by_series[*series] += value * self.residual[row];
            length2 += value * value;
        }
        let scale = length2.sqrt().max(1e-12).recip();
        by_series.iter_mut().for_each(|v| *v *= scale);
        Some(StructureScore { group, sizes, gain, by_series })
    }
}

/// A stretch of series, by the times at which its first one begins and the one after its last.
fn window(channel: Channel, from: f64, to: f64) -> Structure {
    let form = Shape::TimeWindow { from: from - 1e-9, to: to - 1e-9 };
    Structure { covariate: Covariate::Time, channel, form }
}

/// Gain and sizes of one or two columns; `None` for none, or for one without length.
fn least_squares(columns: &[Vec<f64>], residual: &[f64]) -> Option<(f64, Vec<f64>)> {
    let first = columns.first()?;
    let (a, u) = (dot(first, first), dot(first, residual));
    if a < 1e-9 {
        return None;
    }
    let Some(second) = columns.get(1) else { return Some((u * u / a, vec![u / a])) };
    let (b, c, v) = (dot(first, second), dot(second, second), dot(second, residual));
    let det = a * c - b * b;
    if det < 1e-6 * a * c {
        return Some((u * u / a, vec![u / a, 0.0]));
    }
    let (k, l) = ((c * u - b * v) / det, (a * v - b * u) / det);
    Some((k * u + l * v, vec![k, l]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effect_named;
    use crate::inference::{Model, Noise, fit};
    use crate::table::{Frame, PlateauRow};
    use crate::test_session::{session, session_with};

    const NOISE_N: f64 = 0.05;

    fn observed(rows: &[PlateauRow]) -> (Model, Observations) {
        let frame = Frame::new(rows);
        let data = Observations::new(&frame, rows).unwrap();
        (Model::baseline(frame), data)
    }

    fn score(scores: Vec<EffectScore>, id: &str) -> EffectScore {
        scores.into_iter().find(|s| s.effect.id() == id).unwrap()
    }

    #[test]
    fn the_effect_that_is_there_scores_highest_and_starts_near_its_size() {
        let offset = effect_named("load_cell_offset").unwrap();
        let (model, data) = observed(&session_with(1, &[(Term::Named(offset), &[0.5])]));
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
        let fitted = fit(&model, weighed);
        let scores = Screen::new(&fitted, weighed).effects();
        let best = scores.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap();
        assert_eq!(best.effect.id(), "load_cell_offset");
        assert!((best.start[0] - 0.5).abs() < 0.05, "{:?}", best.start);
        let squares: f64 = best.by_series.iter().sum();
        assert!((squares.powi(2) / best.gain - 1.0).abs() < 0.05, "the series carry the score together");
    }

    #[test]
    fn a_trace_without_variation_is_invisible_and_a_fixed_one_is_not_scaled() {
        let (model, data) = observed(&session(2));
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
        let fitted = fit(&model, weighed);
        let scores = Screen::new(&fitted, weighed).effects();
        let dwell = score(scores.clone(), "dwell_relaxation");
        assert!(dwell.strength < 1e-6 && dwell.gain == 0.0, "{dwell:?}");
        // A hook that nobody left out fits worse than none: its size is not free, so the gain is negative.
        let hook = score(scores, "hook_omitted");
        assert!(hook.gain < -100.0 && hook.start.is_empty(), "{}", hook.gain);
    }

    #[test]
    fn what_is_in_the_model_is_scored_no_more_and_may_bend_under_guard() {
        let offset = effect_named("load_cell_offset").unwrap();
        let rows = session_with(3, &[(Term::Named(offset), &[0.5])]);
        let (model, data) = observed(&rows);
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
        let base = fit(&model, weighed);
        let with = fit(&base.model.with_term(Term::Named(offset), &[0.5]), weighed);
        let open = Screen::new(&with, weighed);
        assert!(open.effects().iter().all(|s| s.effect.id() != "load_cell_offset"));
        let guarded = Screen::guarded(&with, weighed);
        assert!(guarded.bent_gain() >= open.bent_gain());
        let gain = |screen: &Screen<'_>| score(screen.effects(), "load_cell_gain").gain;
        assert!(gain(&guarded) <= gain(&open) + 1e-6, "a guard never adds to what is left to explain");
    }

    #[test]
    fn a_stretch_of_series_at_another_level_is_the_best_structure() {
        let mut rows = session(4);
        let (from, to) = (rows.len() / 3, rows.len() / 2);
        let (first, last) = (rows[from].time_s, rows[to].time_s);
        rows.iter_mut().filter(|r| (first..last).contains(&r.time_s)).for_each(|r| r.force_n += 0.4);
        let (model, data) = observed(&rows);
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
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
}
