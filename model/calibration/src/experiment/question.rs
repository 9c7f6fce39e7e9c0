//! Questions that a calibration leaves open, and how probably given information answers them.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use pinswitch_friction::published;
use statrs::distribution::{ContinuousCDF, Normal};

use super::information::{Projected, Trace};
use crate::effects::{Covariate, Effect, Side};
use crate::inference::{Levels, Model, Term};
use crate::report::{Estimate, LimitReport, Report};

/// What an answer says no to.
pub(crate) const NONE: &str = "none";

/// How the question for loads beyond those recorded begins.
pub(crate) const FRICTION_ABOVE: &str = "friction_above_";

/// Gain, in squares of the noise, by which an effect is seen and told from none: four standard deviations, as for what
/// counts as visible at all.
const SEEN: f64 = 16.0;
/// Standard deviations by which the limits of an effect that is not there lie off zero, to either side: those of 95 %.
const EXCLUDED: f64 = 1.96;
/// Probability, before the data to come, that an effect is there that could not be excluded: most are not.
const THERE: f64 = 0.2;
/// How much less an effect counts that nobody suspects.
const UNSUSPECTED: f64 = 0.3;
/// How much more a form counts that was drawn: what it stands for is there, and has no name yet.
const DRAWN: f64 = 3.0;
/// Share of the loads of a curve up to which data must reach, so that it needs no carrying on.
pub(crate) const COVERED: f64 = 0.9;
/// Standard deviation of the change of a coefficient of friction from one session to the next, as a share of it.
const RENEWED: f64 = 0.05;
/// Largest size of a rival, in units of the size at which a fit of it starts: beyond it, no rig is that wrong.
const LARGEST_SHARE: f64 = 30.0;

/// Two explanations between which the data could not decide.
#[derive(Clone, Debug)]
pub(super) struct Question {
    /// Ids: the one believed or suspected, and the other or `none`.
    pub(super) between: [String; 2],
    /// Size of an effect that is asked about, in the unit of its first constant; none where there is no such size.
    pub(super) size: Option<f64>,
    /// Whether it cannot be negative.
    is_one_sided: bool,
    /// Each way to ask it: if one is true, by how much does the other fit worse.
    ways: Vec<Way>,
    /// Squares by which the wrong one must fit worse.
    pub(super) needed: f64,
    /// How much an answer is worth.
    pub(super) weight: f64,
}

/// One of the two is true, at a size; the other is fitted.
#[derive(Clone, Debug)]
struct Way {
    /// Column of what is true.
    truth: usize,
    /// Its size, in units of the column.
    size: f64,
    /// Columns that are fitted.
    nuisance: Vec<usize>,
}

impl Question {
    /// Squares by which the wrong explanation is expected to fit worse, whichever is wrong.
    pub(super) fn squares(&self, information: &DMatrix<f64>) -> f64 {
        self.squares_of(&mut Projections::of(information))
    }

    /// The same of information of which other questions were asked.
    pub(super) fn squares_of<'a>(&'a self, projections: &mut Projections<'a>) -> f64 {
        let of = |way: &'a Way| way.size * way.size * projections.without(&way.nuisance).squares(way.truth);
        self.ways.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    /// Probability that data with this information show what is true of the two, which is what runs are chosen by: the difference
    /// of squares of two models scatters about its expectation `d^2` with a standard deviation of `2 d`, and an estimate about its
    /// size by one where that size is `d` (`model/doc/next-experiment.md`).
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

    /// Probability that they answer it, which is also that there is no such effect: its limits lie within the size asked about,
    /// the upper one alone where it cannot be negative.
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

    /// The same question where these columns are not fitted.
    pub(super) fn beside_no(&self, columns: &[usize]) -> Self {
        let mut question = self.clone();
        for way in &mut question.ways {
            way.nuisance.retain(|column| !columns.contains(column));
        }
        question
    }

    /// What an answer loses without some of the information.
    pub(super) fn loss(&self, all: &DMatrix<f64>, without: &DMatrix<f64>) -> f64 {
        let of = |information| libm::log(1.0 + self.squares(information) / self.needed);
        of(all) - of(without)
    }

    /// Words for a run sheet.
    pub(super) fn words(&self) -> String {
        match self.between[1].as_str() {
            NONE => format!("{} or none", self.between[0]),
            other => format!("{} or {other}", self.between[0]),
        }
    }
}

/// Information without the columns that questions fit, each set of them taken out once: most questions fit the same.
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

/// The questions of a report, with the traces that they are about and the effects in them.
#[derive(Debug, Default)]
pub(super) struct Agenda {
    pub(super) questions: Vec<Question>,
    pub(super) traces: Vec<Trace>,
    pub(super) effects: Vec<&'static dyn Effect>,
    /// Columns of which only data to come may tell: what was drawn from the data so far is not confirmed by them.
    ahead: Vec<usize>,
    /// Columns of the constants of friction that the data to come may have otherwise.
    renewed: Vec<usize>,
    /// Ids of forms that stand for structure without a name.
    forms: Vec<String>,
    /// Whether one of the effects remembers the load before.
    remembers: bool,
}

impl Agenda {
    /// Column of an effect that the model does not have, with these constants.
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

    /// Everything that a report leaves open, of rows up to a load of `highest_n`. `known` gives the information of the data
    /// so far, once the columns stand.
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
            // What stays in the rig does not change the curve of a part.
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
            // The size of the rival that comes nearest to what was found.
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

    /// Friction on pins and silicone may be another one in the session to come: an effect that differs only from session to
    /// session cannot be told from that.
    fn may_change(&mut self, model: &Model) {
        let names = model.names();
        for constant in (0..names.len()).filter(|i| matches!(names[*i].0.as_str(), "mu_p" | "mu_s")) {
            self.renewed.push(names.len() + self.traces.len());
            self.traces.push(Trace::Renewed { constant });
        }
    }

    /// Whether the form of what has no name will be seen again.
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
            // The form in the model, or the shapes that it was drawn from, would take it over.
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

    /// Whether friction beyond the loads recorded is what the model predicts, where curves and designs go beyond them.
    fn ask_beyond(&mut self, highest_n: f64, first: usize, own: &[usize]) {
        let to_n = published::heaviest_load_n();
        if highest_n > COVERED * to_n {
            return;
        }
        let column = first + self.traces.len();
        self.traces.push(Trace::Beyond { from_n: highest_n, to_n });
        self.ask_whether(&format!("{FRICTION_ABOVE}{highest_n:.0}_N"), column, 1.0, own, 1.0);
    }

    /// What is known before any data to come.
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

    /// Tells the size of the effect that the last question is about.
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

    /// Whether an effect that is asked about lies along this covariate.
    pub(super) fn lies_along(&self, id: &str, covariate: Covariate) -> bool {
        self.effects.iter().any(|e| e.id() == id && e.description().covariate == covariate)
    }

    /// Constants of the model that stand for what has no name.
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

    /// Whether an effect that is asked about remembers the load before.
    pub(super) fn asks_of_the_load_before(&self) -> bool {
        self.remembers
    }

    /// Whether an answer may lie along this covariate.
    pub(super) fn asks_along(&self, covariate: Covariate) -> bool {
        self.effects.iter().any(|effect| effect.description().covariate == covariate)
    }
}

/// The variable of formulas that holds the load of the series before.
const LOAD_BEFORE: &str = "previous_load_n";

/// The constants at which a fit of an effect starts.
fn start(effect: &dyn Effect, model: &Model) -> Option<Vec<f64>> {
    effect.starts(&model.frame).into_iter().next()
}

/// The constants of an effect that a report could not exclude: the size that would matter, in the shape at which that size
/// was told. Reports of earlier versions tell no shape; its start stands in for it.
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

/// Share of an effect's estimated size that is there with a probability of five in six: a plan must not stand on a size
/// that was overestimated.
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

    /// An effect that is not there is excluded by less than what shows one that is.
    #[test]
    fn an_answer_is_also_that_there_is_none() {
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
        // Noise alone brings the upper limit of one that cannot be negative below the size, one time in six.
        let above = of(asked(Some(0.2), true), 1.0);
        assert!((above - 0.8 * 0.1685).abs() < 1e-3, "{above}");
    }

    #[test]
    fn it_is_the_size_that_must_be_sure_and_no_shape() {
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
