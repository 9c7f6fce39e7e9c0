//! The study's chapter on what has no name: is its form drawn rightly, does the form predict a later session as the truth
//! would, and is it confirmed and refuted where it should be.

use pinswitch_calibration::effects::{OwnEffect, Vocabulary};
use pinswitch_calibration::inference::{Levels, Model, Observations, Term, Weighed, fit, select};
use pinswitch_calibration::table::{Frame, PlateauRow};
use pinswitch_calibration::{CONFIRMED_P, Calibration, TrialOutcome, TrialReport, calibrate, trials};

use super::case::{Case, Truth};
use super::cases::plan_of;
use super::figures::median_text;
use super::outcome::error_n;
use super::true_form::{true_forms, true_shapes};
use super::visibility::is_visible;
use crate::disturbance::Disturbance;
use crate::next_session::next_session;
use crate::plan::Plan;
use crate::simulate::simulate;

/// Offset of the seed of a rig without the disturbance.
const OTHER_RIG: u64 = 500_000_000;

/// What became of one rig outside the vocabulary.
#[derive(Clone, Debug, PartialEq)]
pub struct FormOutcome {
    /// Whether structure was found where it is.
    pub place_is_right: bool,
    /// Whether the session could show it beside mounts that differ as much as those of rigs of which nothing may be said.
    pub visible: bool,
    /// The shape that was drawn; `None` where no structure was found.
    pub shape: Option<String>,
    /// Whether it is the true one, or the true one is among its rivals; `None` where no shape can be asked for.
    pub shape_is_right: Option<bool>,
    /// Root mean square errors on the readings of a later session, in newtons: the refitted baseline, the calibration's
    /// model, and the same with the drawn form in place of shapes.
    pub next_n: [Option<f64>; 3],
    /// That of the true form, its sizes fitted by the same code; `None` where no formula can say it.
    pub truth_n: Option<f64>,
    /// What a later session of the same rig says of the drawn form.
    pub later_trial: Option<TrialReport>,
    /// What a session of another rig, without the disturbance, says of it.
    pub absent_trial: Option<TrialReport>,
}

impl FormOutcome {
    /// Error of the calibration's model on a later session over that of the true form.
    pub fn over_truth(&self) -> Option<f64> {
        Some(self.next_n[1]? / self.truth_n?.max(1e-9))
    }
}

/// Draws the form of one rig from its table, and lets two other tables decide on it. `None` if a table cannot be used, or
/// the case has no disturbance.
pub fn run_form_case(case: &Case, seed: u64, levels: Levels) -> Option<FormOutcome> {
    let Truth::Outside { covariates, .. } = case.truth else { return None };
    let plan = plan_of(case, seed);
    let disturbance = plan.disturbances.first()?;
    let simulated = simulate(&plan);
    let rows = simulated.rows;
    let Calibration { selection, data, form, .. } = calibrate(&rows, levels).ok()?;
    let frame = selection.baseline.model.frame.clone();
    let next = next_session(&plan).rows;
    let error = |model: &Model| error_n(model, &frame, &next);
    let place = selection.structure.map(|s| s.covariate);
    let trial = |rows: &[PlateauRow]| {
        let form = form.as_ref()?;
        let own = OwnEffect::new(form.definition.clone()).ok()?;
        let vocabulary = Vocabulary::built_in().with(vec![own]).ok()?;
        trial_on(rows, &vocabulary, levels)
    };
    let without = Plan { disturbances: Vec::new(), seed: seed + OTHER_RIG, ..plan.clone() };
    Some(FormOutcome {
        place_is_right: place.is_some_and(|place| covariates.contains(&place)),
        visible: is_visible(&plan, &simulated.traits, levels)?,
        shape: form.as_ref().map(|f| f.report.shape.clone()),
        shape_is_right: shape_is_right(disturbance, form.as_ref().map(|f| &f.report)),
        next_n: [
            error(&selection.baseline.model),
            error(&selection.augmented.model),
            form.as_ref().and_then(|f| error(&f.fitted.model)),
        ],
        truth_n: with_truth(disturbance, &frame, &data, &selection).and_then(|model| error(&model)),
        later_trial: trial(&next),
        absent_trial: trial(&simulate(&without).rows),
    })
}

fn shape_is_right(
    disturbance: &Disturbance,
    form: Option<&pinswitch_calibration::FormReport>,
) -> Option<bool> {
    let right = true_shapes(disturbance);
    if right.is_empty() {
        return None;
    }
    Some(form.is_some_and(|form| {
        let rivals = form.rivals.iter().map(|r| r.shape.as_str());
        std::iter::once(form.shape.as_str()).chain(rivals).any(|shape| right.contains(&shape))
    }))
}

/// The baseline with the true form, its sizes fitted.
fn with_truth(
    disturbance: &Disturbance,
    frame: &Frame,
    data: &Observations,
    selection: &pinswitch_calibration::inference::Selection,
) -> Option<Model> {
    let (vocabulary, ids) = true_forms(disturbance, frame)?;
    let mut model = selection.baseline.model.clone().among(&vocabulary);
    for id in &ids {
        let effect = vocabulary.named(id)?;
        let start = effect.starts(&model.frame).into_iter().next()?;
        model = model.with_term(Term::Named(effect), &start);
    }
    Some(fit(&model, &Weighed::new(data, selection.noise)).model)
}

/// The trial of the one effect of one's own on a table.
fn trial_on(rows: &[PlateauRow], vocabulary: &Vocabulary, levels: Levels) -> Option<TrialReport> {
    let frame = Frame::new(rows);
    let mut data = Observations::new(&frame, rows)?;
    let found = select(&Model::baseline(frame).among(vocabulary), &mut data, levels);
    trials(rows, &found, &data).pop()
}

/// The outcomes by kind of rig.
#[derive(Clone, Debug, Default)]
pub struct FormStudy {
    outcomes: Vec<(Case, Vec<FormOutcome>)>,
}

impl FormStudy {
    /// Adds the outcomes of a kind.
    pub fn add(&mut self, case: Case, outcomes: Vec<FormOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// A row for each kind, and one for all, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| protocol | rig | rigs | right place | of the visible | right shape | later session, model / true form | form / true form | confirmed by a later session | refuted where absent | p >= 0.01 where absent |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            let protocol = format!("{:?}", case.protocol).to_lowercase();
            text.push_str(&row(&protocol, &case.name, &outcomes.iter().collect::<Vec<_>>()));
        }
        let all: Vec<&FormOutcome> = self.outcomes.iter().flat_map(|(_, outcomes)| outcomes).collect();
        text.push_str(&row("both", "all", &all));
        text
    }
}

fn row(protocol: &str, name: &str, outcomes: &[&FormOutcome]) -> String {
    // Of two operators no shape is asked.
    let of = |values: Vec<bool>| match values.len() {
        0 => String::new(),
        all => format!("{} of {all}", values.iter().filter(|v| **v).count()),
    };
    let shapes = outcomes.iter().filter_map(|o| o.shape_is_right).collect();
    let drawn = |o: &&FormOutcome| Some(o.next_n[2]? / o.truth_n?.max(1e-9));
    let again = outcomes.iter().filter_map(|o| o.later_trial.as_ref());
    let absent = || outcomes.iter().filter_map(|o| o.absent_trial.as_ref());
    format!(
        "| {protocol} | {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        outcomes.len(),
        outcomes.iter().filter(|o| o.place_is_right).count(),
        of(outcomes.iter().filter(|o| o.visible).map(|o| o.place_is_right).collect()),
        of(shapes),
        median_text(outcomes.iter().filter_map(|o| o.over_truth()), 2),
        median_text(outcomes.iter().filter_map(drawn), 2),
        of(again.map(|t| t.outcome == TrialOutcome::Confirmed).collect()),
        of(absent().map(|t| t.outcome == TrialOutcome::Refuted).collect()),
        of(absent().map(|t| t.p_value.is_none_or(|p| p >= CONFIRMED_P)).collect()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Protocol;
    use crate::study::cases::study_cases;

    #[test]
    fn a_step_is_drawn_confirmed_and_refuted() {
        let case = study_cases()
            .into_iter()
            .find(|c| c.name == "step of the reading in mid-session" && c.protocol == Protocol::Randomised)
            .unwrap();
        let found = run_form_case(&case, 2, Levels::default()).unwrap();
        assert!(found.place_is_right && found.shape_is_right == Some(true), "{found:?}");
        assert!(found.over_truth().unwrap() < 1.3, "{found:?}");
        assert_eq!(found.later_trial.as_ref().unwrap().outcome, TrialOutcome::Confirmed);
        assert_eq!(found.absent_trial.as_ref().unwrap().outcome, TrialOutcome::Refuted);
        let mut study = FormStudy::default();
        study.add(case, vec![found]);
        assert!(study.table().contains("| 1 | 1 | 1 of 1 | 1 of 1 |"), "{}", study.table());
    }
}
