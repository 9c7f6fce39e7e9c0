//! Score tests: gain of each effect or structure that is not in a model, from its sensitivity after
//! the model's constants have been refitted to first order.

use super::fit::{Fit, jacobian};
use super::form_tolerance::{BEND, bent_copies};
use super::lanes::{LANES, Lanes};
use super::model::Term;
use super::observations::Observations;
use super::projection::{Projection, dot};
use super::structure_scores::least_squares;
use super::weighed::Weighed;
use crate::effects::Effect;
use crate::parallel::map_each;

/// Share of its start size for the trace of a user-defined effect, since the curvature at a large
/// typical size may not be absorbed by the model's constants.
const TANGENT: f64 = 1e-3;
/// Smallest share of a trace's squared norm that must come from data and not from priors.
const SEEN_BY_DATA: f64 = 0.5;

/// A fitted model with its whitened residual and the directions of its constants.
pub(crate) struct Screen<'a> {
    pub(super) fitted: &'a Fit,
    pub(super) weighed: &'a Weighed<'a>,
    pub(super) basis: Projection,
    pub(super) residual: Vec<f64>,
    pub(super) predicted: Vec<f64>,
    bent_gain: f64,
}

/// Score of an effect.
#[derive(Clone, Debug)]
pub(crate) struct EffectScore {
    /// The effect.
    pub(crate) effect: &'static dyn Effect,
    /// Start values of its fit.
    pub(crate) start: Vec<f64>,
    /// First constant for which the trace was computed.
    pub(crate) size: f64,
    /// Estimated size as a share of it.
    pub(crate) share: f64,
    /// Reduction of the deviance, to first order.
    pub(crate) gain: f64,
    /// Share of the sensitivity's norm that the model's constants cannot absorb.
    pub(crate) visible_share: f64,
    /// Norm of the projected sensitivity at the start's size, in standard deviations.
    pub(crate) strength: f64,
    /// Contributions of the series to the score; the square of their sum is the gain.
    pub(crate) by_series: Vec<f64>,
    /// The projected sensitivity.
    pub(crate) column: Vec<f64>,
    /// The sensitivity in newtons, before projection.
    pub(crate) trace_n: Vec<f64>,
}

impl<'a> Screen<'a> {
    /// Prepares scores for extensions of a fit.
    pub(crate) fn new(fitted: &'a Fit, weighed: &'a Weighed<'a>) -> Self {
        Self::with_nuisances(fitted, weighed, |_| Vec::new())
    }

    /// Prepares scores for extensions of a fit whose effects may bend.
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
        let (mut columns, sds): (Vec<_>, Vec<_>) = own.chain(bent.into_iter().map(|b| (b, BEND))).unzip();
        weighed.whiten_all(&mut columns);
        for (j, (mut column, sd)) in columns.into_iter().zip(sds).enumerate() {
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

    pub(super) fn data(&self) -> &'a Observations {
        self.weighed.data
    }

    /// Returns the reduction of the deviance by bending the effects of the model.
    pub(crate) fn bent_gain(&self) -> f64 {
        self.bent_gain
    }

    /// Whitens columns in newtons and projects out the model's constants. Returns each with the
    /// remaining share of its norm.
    pub(super) fn all_visible(&self, columns: impl IntoIterator<Item = Vec<f64>>) -> Vec<(Vec<f64>, f64)> {
        let mut columns = columns.into_iter();
        let mut visible = Vec::new();
        let mut lanes = Lanes::default();
        loop {
            let several: Vec<Vec<f64>> = columns.by_ref().take(LANES).collect();
            if several.is_empty() {
                return visible;
            }
            lanes.take(&several);
            self.weighed.whiten_lanes(lanes.rows_mut());
            let before = lanes.squares();
            lanes.resize(self.residual.len());
            self.basis.remove_lanes(&mut lanes);
            let after = lanes.squares();
            for lane in 0..several.len() {
                let share = if before[lane] > 0.0 { (after[lane] / before[lane]).sqrt() } else { 0.0 };
                visible.push((lanes.column(lane), share));
            }
        }
    }

    /// Returns scores of all effects that are not in the model, each for its best shape.
    pub(crate) fn effects(&self) -> Vec<EffectScore> {
        let model = &self.fitted.model;
        let absent = |effect: &&'static dyn Effect| {
            !model.terms.iter().any(|t| matches!(t, Term::Named(e) if e.id() == effect.id()))
        };
        let absent: Vec<_> = model.vocabulary.acting_order().iter().copied().filter(absent).collect();
        map_each(absent, |effect| self.effect(effect)).into_iter().flatten().collect()
    }

    /// Returns the score of one effect for its best shape.
    pub(crate) fn effect(&self, effect: &'static dyn Effect) -> Option<EffectScore> {
        self.best_of(effect, effect.starts(&self.fitted.model.frame))
    }

    /// Returns the score of one effect for a given shape: a single test, in contrast to the best of
    /// several shapes.
    pub(crate) fn effect_at(&self, effect: &'static dyn Effect, start: Vec<f64>) -> Option<EffectScore> {
        self.best_of(effect, vec![start])
    }

    fn best_of(&self, effect: &'static dyn Effect, starts: Vec<Vec<f64>>) -> Option<EffectScore> {
        let mut best: Option<EffectScore> = None;
        let sizes = self.sizes_of_ones_own(effect);
        let traces: Vec<Vec<f64>> = starts
            .iter()
            .map(|start| {
                let mut small = start.clone();
                let step = sizes.map_or(1.0, |sizes| {
                    small.iter_mut().take(sizes).for_each(|size| *size *= TANGENT);
                    TANGENT
                });
                let changed =
                    self.fitted.model.with_term(Term::Named(effect), &small).predict(&self.data().points);
                changed.iter().zip(&self.predicted).map(|(c, p)| (c - p) / step).collect()
            })
            .collect();
        let visible = self.all_visible(traces.iter().cloned());
        for ((start, trace_n), (column, visible_share)) in starts.into_iter().zip(traces).zip(visible) {
            let length2 = dot(&column, &column);
            // A part that only the priors of the model's constants determine is not identifiable
            // from data.
            let by_data = dot(&column[..self.predicted.len()], &column[..self.predicted.len()]);
            let visible_share = match sizes {
                Some(_) if by_data < SEEN_BY_DATA * length2 => 0.0,
                _ => visible_share,
            };
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

    /// Returns the number of sizes of a user-defined effect; `None` for a built-in one.
    fn sizes_of_ones_own(&self, effect: &'static dyn Effect) -> Option<usize> {
        let mut own = self.fitted.model.vocabulary.own().map(|own| own.definition());
        let own = own.find(|own| own.id == effect.id())?;
        Some(own.parameters.iter().filter(|p| p.bounds.is_none()).count())
    }

    /// Returns the gain of free offsets of each series, one per direction, for series that are not
    /// excluded.
    pub(crate) fn series_offsets(&self) -> Vec<(usize, f64)> {
        let data = self.data();
        let mut cells = vec![Vec::new(); data.series];
        for rows in &data.cells {
            if let Some(row) = rows.first().filter(|row| !data.is_excluded(**row)) {
                cells[data.series_of[*row]].push(rows);
            }
        }
        let offset = |rows: &Vec<usize>| {
            let mut column = vec![0.0; self.predicted.len()];
            rows.iter().for_each(|r| column[*r] = 1.0);
            column
        };
        // A few series at a time to limit memory, since there may be thousands.
        let mut gains = Vec::new();
        let numbered: Vec<(usize, Vec<&Vec<usize>>)> = cells.into_iter().enumerate().collect();
        for several in numbered.chunks(LANES) {
            let mut columns = self
                .all_visible(several.iter().flat_map(|(_, cells)| cells).map(|rows| offset(rows)))
                .into_iter();
            for (series, cells) in several {
                let own: Vec<Vec<f64>> =
                    columns.by_ref().take(cells.len()).map(|(column, _)| column).collect();
                gains.extend(least_squares(&own, &self.residual).map(|(gain, _)| (*series, gain)));
            }
        }
        gains
    }
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
    fn the_true_effect_scores_highest() {
        let offset = effect_named("load_cell_offset").unwrap();
        let (model, data) = observed(&session_with(1, &[(Term::Named(offset), &[0.5])]));
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
        let fitted = fit(&model, weighed);
        let scores = Screen::new(&fitted, weighed).effects();
        let best = scores.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap();
        assert_eq!(best.effect.id(), "load_cell_offset");
        assert!((best.start[0] - 0.5).abs() < 0.05, "{:?}", best.start);
        let squares: f64 = best.by_series.iter().sum();
        assert!((squares.powi(2) / best.gain - 1.0).abs() < 0.05, "the series add up to the score");
    }

    #[test]
    fn constant_traces_are_not_identifiable() {
        let (model, data) = observed(&session(2));
        let weighed = &Weighed::new(&data, Noise::constant(NOISE_N, 0.01));
        let fitted = fit(&model, weighed);
        let scores = Screen::new(&fitted, weighed).effects();
        let dwell = score(scores.clone(), "dwell_relaxation");
        assert!(dwell.strength < 1e-6 && dwell.gain == 0.0, "{dwell:?}");
        // A hook that is not missing increases the deviance: its size is not free, so the gain is
        // negative.
        let hook = score(scores, "hook_omitted");
        assert!(hook.gain < -100.0 && hook.start.is_empty(), "{}", hook.gain);
    }

    #[test]
    fn effects_of_the_model_may_bend() {
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
        assert!(gain(&guarded) <= gain(&open) + 1e-6, "bending never adds to the residual");
    }
}
