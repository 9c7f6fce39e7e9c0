//! Open questions of a calibration, and the probability that given information answers them.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use pinswitch_friction::published;
use statrs::distribution::{ContinuousCDF, Normal};

use super::information::{Projected, Trace};
use crate::effects::{Covariate, Effect, Side};
use crate::inference::{Levels, Model, Term};
use crate::report::{Estimate, LimitReport, Report};

/// Word for the absence of an effect.
pub(crate) const NONE: &str = "none";

/// Prefix of the question for loads above those recorded.
pub(crate) const FRICTION_ABOVE: &str = "friction_above_";

/// Reduction of the deviance at which an effect is detected: four standard deviations, as for
/// identifiable effects.
const SEEN: f64 = 16.0;
/// Half width of a 95 % interval in standard deviations.
const EXCLUDED: f64 = 1.96;
/// Prior probability that an effect that is not excluded is present: most are not.
const THERE: f64 = 0.2;
/// Weight of an effect without evidence.
const UNSUSPECTED: f64 = 0.3;
/// Weight of a derived form, for which there is evidence.
const DRAWN: f64 = 3.0;
/// Share of the loads of a curve that data must cover so that no extrapolation is needed.
pub(crate) const COVERED: f64 = 0.9;
/// Relative standard deviation of the change of a friction coefficient between sessions.
const RENEWED: f64 = 0.05;
/// Largest size of a rival, in units of its start value.
const LARGEST_SHARE: f64 = 30.0;

/// Two explanations that the data do not separate.
#[derive(Clone, Debug)]
pub(super) struct Question {
    /// Ids: the attributed or suspected effect, and the other one or `none`.
    pub(super) between: [String; 2],
    /// Size in question in the unit of the effect's first constant; `None` for other questions.
    pub(super) size: Option<f64>,
    /// Whether the size cannot be negative.
    is_one_sided: bool,
    /// Cases: either explanation is true, and the other is fitted.
    ways: Vec<Way>,
    /// Deviance by which the wrong explanation must be worse.
    pub(super) needed: f64,
    /// Weight of an answer.
    pub(super) weight: f64,
}

/// A case: one explanation is true at a size, and the other is fitted.
#[derive(Clone, Debug)]
struct Way {
    /// Column of the true explanation.
    truth: usize,
    /// Its size in units of the column.
    size: f64,
    /// Columns that are fitted.
    nuisance: Vec<usize>,
}

impl Question {
    /// Returns the expected increase of the deviance of the wrong explanation, in the less
    /// favourable case.
    pub(super) fn squares(&self, information: &DMatrix<f64>) -> f64 {
        self.squares_of(&mut Projections::of(information))
    }

    /// The same, with projections shared between questions.
    pub(super) fn squares_of<'a>(&'a self, projections: &mut Projections<'a>) -> f64 {
        let of = |way: &'a Way| way.size * way.size * projections.without(&way.nuisance).squares(way.truth);
        self.ways.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    /// Returns the probability that data with this information show which explanation is true; runs
    /// are chosen by it. The difference of deviance of two models scatters about its expectation
    /// `d^2` with a standard deviation of `2 d`, and an estimate about its size with 1 where that
    /// size is `d` (`model/doc/next-experiment.md`).
    pub(super) fn probability(&self, information: &DMatrix<f64>) -> f64 {
        let squares = self.squares(information);
        if !(squares > 1e-12 && squares.is_finite()) {
            return 0.0;
        }
        let normal = Normal::standard();
        if self.between[1] == NONE {
            normal.cdf(squares.sqrt() - self.needed.sqrt())
        } else {
            normal.cdf((squares - self.needed) / (2.0 * squares.sqrt()))
        }
    }

    /// Returns the probability of an answer, including that the effect is absent: its limits are
    /// then within the size in question (for a one-sided effect, the upper limit).
    pub(super) fn answer_probability(&self, information: &DMatrix<f64>) -> f64 {
        let seen = self.probability(information);
        let squares = self.squares(information);
        if self.size.is_none() || !squares.is_finite() {
            return seen;
        }
        let within = Normal::standard().cdf(squares.max(0.0).sqrt() - EXCLUDED);
        let excluded = if self.is_one_sided { within } else { (2.0 * within - 1.0).max(0.0) };
        THERE * seen + (1.0 - THERE) * excluded
    }

    /// Returns the question without fitting these columns.
    pub(super) fn beside_no(&self, columns: &[usize]) -> Self {
        let mut question = self.clone();
        for way in &mut question.ways {
            way.nuisance.retain(|column| !columns.contains(column));
        }
        question
    }

    /// Returns the loss of an answer without part of the information.
    pub(super) fn loss(&self, all: &DMatrix<f64>, without: &DMatrix<f64>) -> f64 {
        let of = |information| libm::log(1.0 + self.squares(information) / self.needed);
        of(all) - of(without)
    }

    /// Returns the question in words, for a run sheet.
    pub(super) fn words(&self) -> String {
        match self.between[1].as_str() {
            NONE => format!("{} or none", self.between[0]),
            other => format!("{} or {other}", self.between[0]),
        }
    }
}

/// Projections shared between questions, since most fit the same columns.
#[derive(Debug)]
pub(super) struct Projections<'a> {
    information: &'a DMatrix<f64>,
    made: Vec<Projected<'a>>,
}

impl<'a> Projections<'a> {
    pub(super) fn of(information: &'a DMatrix<f64>) -> Self {
        Self { information, made: Vec::new() }
    }

    fn without(&mut self, nuisance: &'a [usize]) -> &Projected<'a> {
        let at = self.made.iter().position(|p| p.is_without(nuisance)).unwrap_or_else(|| {
            self.made.push(Projected::new(self.information, nuisance));
            self.made.len() - 1
        });
        &self.made[at]
    }
}

/// Questions of a report, with their columns and effects.
#[derive(Debug, Default)]
pub(super) struct Agenda {
    pub(super) questions: Vec<Question>,
    pub(super) traces: Vec<Trace>,
    pub(super) effects: Vec<&'static dyn Effect>,
    /// Columns that only future data determine, since a derived form is not confirmed by the data
    /// it was derived from.
    ahead: Vec<usize>,
    /// Columns of friction constants that may differ in future data.
    renewed: Vec<usize>,
    /// Ids of forms of unattributed structure.
    forms: Vec<String>,
    /// Whether one of the effects depends on the previous load.
    remembers: bool,
}

impl Agenda {
    /// Adds the column of an effect that is not in the model, with these constants.
    fn absent(&mut self, effect: &'static dyn Effect, values: Vec<f64>, model: &Model) -> usize {
        let known = self.traces.iter().position(|trace| {
            matches!(trace, Trace::Absent { effect: e, values: v } if e.id() == effect.id() && *v == values)
        });
        let at = known.unwrap_or_else(|| {
            self.traces.push(Trace::Absent { effect, values });
            self.effects.push(effect);
            self.traces.len() - 1
        });
        model.values().len() + at
    }

    /// Returns all open questions of a report, whose rows have loads up to `highest_n` in newtons.
    /// `known` returns the information of the recorded data for the columns.
    pub(super) fn of(
        report: &Report,
        model: &Model,
        highest_n: f64,
        levels: Levels,
        known: impl Fn(&[Trace]) -> DMatrix<f64>,
    ) -> Self {
        let mut agenda = Self::default();
        agenda.may_change(model);
        let own: Vec<usize> = (0..model.values().len()).chain(agenda.renewed.iter().copied()).collect();
        let first = model.values().len();
        let mut pairs = Vec::new();
        for found in &report.effects {
            let Some(term) =
                model.terms.iter().position(|t| matches!(t, Term::Named(e) if e.id() == found.id))
            else {
                continue;
            };
            if found.rivals.is_empty() {
                continue;
            }
            agenda.traces.push(Trace::Found { term });
            let column = first + agenda.traces.len() - 1;
            if let Term::Named(effect) = &model.terms[term] {
                agenda.effects.push(*effect);
            }
            for rival in &found.rivals {
                if let Some(effect) = model.vocabulary.named(&rival.id)
                    && let Some(values) = start(effect, model)
                {
                    let other = agenda.absent(effect, values, model);
                    pairs.push((found, term, column, other));
                }
            }
        }
        for limit in report.limits.iter().filter(|limit| !limit.excluded) {
            let Some(effect) = model.vocabulary.named(&limit.id) else { continue };
            let Some(values) = of_consequence(effect, limit, model) else { continue };
            let column = agenda.absent(effect, values, model);
            agenda.ask_whether(effect.id(), column, 1.0, &own, 1.0);
            agenda.of_size(effect, limit.typical);
        }
        for invisible in &report.invisible {
            let Some(effect) = model.vocabulary.named(&invisible.id) else { continue };
            // Effects of the rig do not change the curve of a part.
            let asked = agenda.questions.iter().any(|q| q.between[0] == invisible.id);
            if effect.description().side == Side::Switch && !asked {
                let Some(values) = start(effect, model) else { continue };
                let size = values.first().copied().unwrap_or(1.0);
                let column = agenda.absent(effect, values, model);
                agenda.ask_whether(effect.id(), column, 1.0, &own, UNSUSPECTED);
                agenda.of_size(effect, size);
            }
        }
        agenda.ask_again(report, model);
        let remembers = |id: &str| {
            let mut own = model.vocabulary.own().map(|own| own.definition());
            own.any(|own| own.id == id && own.formula.contains(LOAD_BEFORE))
        };
        agenda.remembers = agenda.effects.iter().any(|effect| remembers(effect.id()));
        agenda.ask_beyond(highest_n, first, &own);
        if pairs.is_empty() {
            return agenda;
        }
        let information = agenda.before(known(&agenda.traces));
        for (found, term, column, other) in pairs {
            let at = model.term_offset(term);
            let constants: Vec<usize> = (at..at + model.terms[term].constants()).collect();
            let base: Vec<usize> = own.iter().copied().filter(|i| !constants.contains(i)).collect();
            // Size of the rival that is closest to the effect in the model.
            let left = Projected::new(&information, &base);
            let share = left.covariance(other, column) / left.covariance(other, other).max(1e-12);
            let with_other: Vec<usize> = base.iter().copied().chain([other]).collect();
            let sure = match &model.terms[term] {
                Term::Named(effect) => surely(*effect, &found.parameters),
                Term::Structure(_) => 1.0,
            };
            let ways = vec![
                Way { truth: column, size: sure, nuisance: with_other },
                Way {
                    truth: other,
                    size: sure * share.clamp(-LARGEST_SHARE, LARGEST_SHARE),
                    nuisance: own.clone(),
                },
            ];
            let Trace::Absent { effect, .. } = &agenda.traces[other - first] else { continue };
            agenda.questions.push(Question {
                between: [found.id.clone(), effect.id().to_owned()],
                size: None,
                is_one_sided: false,
                ways,
                needed: levels.rival,
                weight: 1.0,
            });
        }
        agenda
    }

    /// Adds a possible change of the friction on pins and silicone in the next session, with which
    /// an effect that only varies between sessions is confounded.
    fn may_change(&mut self, model: &Model) {
        let names = model.names();
        for constant in (0..names.len()).filter(|i| matches!(names[*i].0.as_str(), "mu_p" | "mu_s")) {
            self.renewed.push(names.len() + self.traces.len());
            self.traces.push(Trace::Renewed { constant });
        }
    }

    /// Adds the question whether the form of unattributed structure will be seen again.
    fn ask_again(&mut self, report: &Report, model: &Model) {
        for form in report.effects.iter().filter_map(|found| found.form.as_ref()) {
            let Some(effect) = model.vocabulary.named(&form.id) else { continue };
            let term = model.terms.iter().position(|t| matches!(t, Term::Named(e) if e.id() == effect.id()));
            let trace = match term {
                Some(term) => Trace::Found { term },
                None => {
                    let Some(values) = start(effect, model) else { continue };
                    Trace::Absent { effect, values }
                }
            };
            // The form in the model, or the shapes from which it was derived, would absorb it.
            let stands_for_it = |t: usize| Some(t) == term || matches!(model.terms[t], Term::Structure(_));
            let for_it: Vec<usize> = (0..model.terms.len())
                .filter(|t| stands_for_it(*t))
                .flat_map(|t| (0..model.terms[t].constants()).map(move |i| model.term_offset(t) + i))
                .collect();
            let own = (0..model.values().len()).filter(|i| !for_it.contains(i));
            let base: Vec<usize> = own.chain(self.renewed.iter().copied()).collect();
            let column = model.values().len() + self.traces.len();
            self.traces.push(trace);
            self.effects.push(effect);
            self.ahead.push(column);
            self.ask_whether(effect.id(), column, surely(effect, &form.parameters), &base, DRAWN);
            self.forms.push(effect.id().to_owned());
        }
    }

    /// Adds the question whether friction above the recorded loads is as predicted, since curves
    /// and designs extend beyond them.
    fn ask_beyond(&mut self, highest_n: f64, first: usize, own: &[usize]) {
        let to_n = published::heaviest_load_n();
        if highest_n > COVERED * to_n {
            return;
        }
        let column = first + self.traces.len();
        self.traces.push(Trace::Beyond { from_n: highest_n, to_n });
        self.ask_whether(&format!("{FRICTION_ABOVE}{highest_n:.0}_N"), column, 1.0, own, 1.0);
    }

    /// Returns the information before any future data.
    pub(super) fn before(&self, mut information: DMatrix<f64>) -> DMatrix<f64> {
        for column in self.ahead.iter().chain(&self.renewed) {
            information.row_mut(*column).fill(0.0);
            information.column_mut(*column).fill(0.0);
        }
        for column in &self.renewed {
            information[(*column, *column)] = RENEWED.powi(-2);
        }
        information
    }

    /// Sets the size of the effect of the last question.
    fn of_size(&mut self, effect: &dyn Effect, size: f64) {
        if let Some(question) = self.questions.last_mut() {
            question.size = Some(size.abs());
            question.is_one_sided = effect.description().one_sided;
        }
    }

    fn ask_whether(&mut self, id: &str, column: usize, size: f64, own: &[usize], weight: f64) {
        self.questions.push(Question {
            between: [id.to_owned(), NONE.to_owned()],
            size: None,
            is_one_sided: false,
            ways: vec![Way { truth: column, size, nuisance: own.to_vec() }],
            needed: SEEN,
            weight,
        });
    }

    /// Returns whether an effect in question is one of this covariate.
    pub(super) fn lies_along(&self, id: &str, covariate: Covariate) -> bool {
        self.effects.iter().any(|e| e.id() == id && e.description().covariate == covariate)
    }

    /// Returns the constants of the model that describe unattributed structure.
    pub(super) fn shapes_of(&self, model: &Model) -> Vec<usize> {
        let is_nameless = |term: &Term| match term {
            Term::Structure(_) => true,
            Term::Named(effect) => self.forms.iter().any(|id| id == effect.id()),
        };
        (0..model.terms.len())
            .filter(|t| is_nameless(&model.terms[*t]))
            .flat_map(|t| (0..model.terms[t].constants()).map(move |i| model.term_offset(t) + i))
            .collect()
    }

    /// Returns whether an effect in question depends on the previous load.
    pub(super) fn asks_of_the_load_before(&self) -> bool {
        self.remembers
    }

    /// Returns whether an effect in question is one of this covariate.
    pub(super) fn asks_along(&self, covariate: Covariate) -> bool {
        self.effects.iter().any(|effect| effect.description().covariate == covariate)
    }
}

/// Variable of formulas for the load of the previous series.
const LOAD_BEFORE: &str = "previous_load_n";

/// Returns the start values of an effect.
fn start(effect: &dyn Effect, model: &Model) -> Option<Vec<f64>> {
    effect.starts(&model.frame).into_iter().next()
}

/// Returns the constants of an effect that a report does not exclude: the typical size, with the
/// shape for which it was reported. Reports of earlier versions contain no shape; the start values
/// are used instead.
fn of_consequence(effect: &dyn Effect, limit: &LimitReport, model: &Model) -> Option<Vec<f64>> {
    let mut values = start(effect, model)?;
    for (value, parameter) in values.iter_mut().zip(effect.parameters()) {
        if let Some(told) = limit.shape.get(parameter.name) {
            *value = *told;
        }
    }
    if let Some(size) = values.first_mut() {
        *size = limit.typical;
    }
    Some(values)
}

/// Returns the share of an effect's estimated size that it exceeds with a probability of 5/6, so
/// that a plan does not rely on an overestimated size.
fn surely(effect: &dyn Effect, parameters: &BTreeMap<String, Estimate>) -> f64 {
    let size = effect.parameters().first().and_then(|size| parameters.get(size.name));
    size.filter(|p| p.value.abs() > 0.0).map_or(1.0, |p| {
        let sd = (p.ci95[1] - p.ci95[0]).abs() / (2.0 * 1.96);
        (1.0 - sd / p.value.abs()).clamp(0.5, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effect_named;

    /// Excluding an absent effect needs less information than detecting a present one.
    #[test]
    fn exclusion_counts_as_an_answer() {
        let asked = |size, is_one_sided| Question {
            between: ["adhesion".to_owned(), NONE.to_owned()],
            size,
            is_one_sided,
            ways: vec![Way { truth: 0, size: 1.0, nuisance: Vec::new() }],
            needed: SEEN,
            weight: 1.0,
        };
        let of =
            |question: Question, d: f64| question.answer_probability(&DMatrix::from_element(1, 1, d * d));
        let told = |size, d| of(asked(size, false), d);
        assert!((told(None, 4.0) - 0.5).abs() < 1e-6);
        assert!((told(Some(0.2), 4.0) - (0.1 + 0.8 * 0.9586)).abs() < 1e-3, "{}", told(Some(0.2), 4.0));
        assert!(told(Some(0.2), 1.9) < 0.02 && told(Some(0.2), 8.0) > 0.999);
        // By noise alone, the upper limit of a one-sided effect is below the size once in six
        // cases.
        let above = of(asked(Some(0.2), true), 1.0);
        assert!((above - 0.8 * 0.1685).abs() < 1e-3, "{above}");
    }

    #[test]
    fn only_the_size_must_be_certain() {
        let of = |value: f64, half: f64| Estimate {
            value,
            ci95: [value - half, value + half],
            unit: "1".to_owned(),
        };
        let saturation = effect_named("substrate_saturation").unwrap();
        let told = |k, h| surely(saturation, &BTreeMap::from([("k".to_owned(), k), ("h".to_owned(), h)]));
        assert!(told(of(0.15, 0.015), of(0.5, 5.0)) > 0.94);
        assert!(told(of(0.15, 0.3), of(0.5, 0.01)) <= 0.5);
    }
}
