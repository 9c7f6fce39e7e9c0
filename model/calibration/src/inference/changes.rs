//! Search for constants of the switch that differ between the sessions or specimens of a table. A
//! change may resemble a mount effect, a drift or another effect, so it competes with them as an
//! explanation.

use pinswitch_friction::sort_by_number;

use super::explanation::Explanation;
use super::fit::fit;
use super::levels::Levels;
use super::model::{Model, Term};
use super::observations::Observations;
use super::projection::dot;
use super::scatter::Scatter;
use super::screening::Screen;
use super::search::VISIBLE_SHARE;
use super::selection::explained;
use super::significance::gain_at;
use super::weighed::Weighed;

/// Most changes of a table.
const MOST_CHANGES: usize = 4;
/// Most changes with which a search is run, in the order of their first estimate.
const SEARCHED: usize = 2;
/// Reduction of the deviance, without mount effects, below which a change is not worth a search.
const WORTH_A_SEARCH: f64 = 25.0;
/// Number of mounts that determine the friction coefficients themselves.
const LOST_TO_FRICTION: usize = 2;
/// Evidence that a change must gain in addition to the choice among all possible ones.
const MIN_EVIDENCE: f64 = 8.0;

/// Returns the explanation of a table, with the constants that differ between its sessions or
/// specimens.
pub(super) fn choose(start: &Model, data: &mut Observations, levels: Levels) -> Explanation {
    let untouched = data.clone();
    let mut start = start.clone();
    let mut best = explained(&start, data, levels);
    for _ in 0..MOST_CHANGES {
        let (promising, possible) = promising(&start, &best, data);
        let choice = MIN_EVIDENCE + 2.0 * libm::log(possible.max(1) as f64);
        // A change is determined by its mounts, however many readings each has.
        let degrees = data.mounts.len().saturating_sub(LOST_TO_FRICTION).max(1) as f64;
        let chance = gain_at(levels.first_p, possible.max(1), degrees);
        let mut better: Option<(f64, Explanation, Observations, Model)> = None;
        for with_change in promising {
            let mut other_data = untouched.clone();
            let other = explained(&with_change, &mut other_data, levels);
            // Outliers and friction depend on the explanation; both explanations are compared with
            // those of the richer one.
            let before = best.at(&other_data, best.noise).toll(&other_data);
            let gain = before - other.toll(&other_data) - choice;
            let gained = gain_of_last_change(&other, &other_data);
            if gained < chance || effect_of_one_session(&other, &other_data) > gained + MIN_EVIDENCE {
                continue;
            }
            if gain > better.as_ref().map_or(0.0, |b| b.0) {
                better = Some((gain, other, other_data, with_change));
            }
        }
        let Some((_, other, other_data, with_change)) = better else { break };
        (best, *data, start) = (other, other_data, with_change);
    }
    best
}

/// Returns the reduction of the deviance by the last change, with everything else fixed.
fn gain_of_last_change(found: &Explanation, data: &Observations) -> f64 {
    let weighed = Weighed::new(data, found.noise);
    fit(&found.augmented.model.without_last_change(), &weighed).cost - found.augmented.cost
}

/// Returns the reduction of the deviance, to first order, by the best effect that is present only
/// in the groups of the last change, or only in the others, in place of that change: a drag of one
/// session is not a change of friction.
fn effect_of_one_session(found: &Explanation, data: &Observations) -> f64 {
    let Some(change) = found.augmented.model.frame.changes.last() else { return 0.0 };
    let weighed = Weighed::new(data, found.noise);
    let without = fit(&found.augmented.model.without_last_change(), &weighed);
    let screen = Screen::new(&without, &weighed);
    let predicted: Vec<f64> = data.force_n.iter().zip(&without.residual_n).map(|(y, r)| y - r).collect();
    let holds: Vec<bool> = data.points.iter().map(|point| change.applies_to(point)).collect();
    let model = &without.model;
    let mut traces = Vec::new();
    for effect in model.vocabulary.acting_order().iter().filter(|e| e.description().scales) {
        for start in effect.starts(&model.frame) {
            let changed = model.with_term(Term::Named(*effect), &start).predict(&data.points);
            for side in [true, false] {
                let rows = changed.iter().zip(&predicted).zip(&holds);
                traces.push(rows.map(|((c, p), holds)| if *holds == side { c - p } else { 0.0 }).collect());
            }
        }
    }
    let gain = |column: &[f64], share: f64| {
        let length2 = dot(column, column);
        if share < VISIBLE_SHARE || length2 < 1e-9 {
            return 0.0;
        }
        dot(column, &screen.residual).powi(2) / length2
    };
    screen.all_visible(traces).iter().map(|(column, share)| gain(column, *share)).fold(0.0, f64::max)
}

/// Returns models with one more change that are worth a search, the most promising first, and the
/// number of possible changes.
fn promising(start: &Model, best: &Explanation, data: &Observations) -> (Vec<Model>, usize) {
    let possible = start.frame.possible_changes();
    if possible.is_empty() {
        return (Vec::new(), 0);
    }
    let scatter = [Scatter::Mounts, Scatter::Walk, Scatter::Specimens];
    let weighed = Weighed::new(data, scatter.iter().fold(best.noise, |noise, s| s.left_out(noise)));
    // The effects found may be the change in another form, or mask it.
    let fits = [&best.baseline, &best.augmented].map(|found| fit(&found.model, &weighed));
    let mut gains: Vec<(f64, Model)> = possible
        .iter()
        .map(|change| {
            let gain = |before: &super::fit::Fit| {
                before.cost - fit(&before.model.with_change(change.clone()), &weighed).cost
            };
            (fits.iter().map(gain).fold(0.0, f64::max), start.with_change(change.clone()))
        })
        .filter(|(gain, _)| *gain > WORTH_A_SEARCH)
        .collect();
    sort_by_number(&mut gains, |(gain, _)| -gain);
    (gains.into_iter().take(SEARCHED).map(|(_, model)| model).collect(), possible.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::effect_named;
    use crate::inference::{Model, Term};
    use crate::table::{Changing, Frame, PlateauRow};
    use crate::test_session::{session, session_with};

    /// Returns a session of that name whose silicone has `factor` times the friction.
    fn day(name: &str, seed: u64, factor: f64) -> Vec<PlateauRow> {
        let mut rows = session_with(seed, &[]);
        let frame = Frame::new(&rows);
        let model = Model::baseline(frame);
        let mut other = model.clone();
        let mut values = model.values();
        values[1] *= factor;
        other.set_values(&values);
        let points = model.frame.points(&rows).unwrap();
        let change: Vec<f64> =
            other.predict(&points).iter().zip(model.predict(&points)).map(|(o, m)| o - m).collect();
        for (row, change) in rows.iter_mut().zip(change) {
            row.force_n += change;
            row.labels.session = name.to_owned();
        }
        rows
    }

    fn chosen(rows: &[PlateauRow]) -> Explanation {
        let frame = Frame::new(rows);
        let mut data = Observations::new(&frame, rows).unwrap();
        choose(&Model::baseline(frame), &mut data, Levels::default())
    }

    #[test]
    fn changed_constants_are_not_effects() {
        let found = chosen(&[day("a", 3, 1.0), day("b", 4, 1.25)].concat());
        let [change] = found.baseline.model.frame.changes.as_slice() else {
            panic!("{:?}", found.baseline.model.frame.changes)
        };
        assert_eq!((change.constant, change.groups.as_slice()), (Changing::Silicone, [0].as_slice()));
        let factor = found.baseline.model.values()[found.baseline.model.first_change()];
        assert!((factor * 1.25 - 1.0).abs() < 0.02, "{factor}");
        assert!(
            found.augmented.model.terms.is_empty() && found.noise.mount_scale < 0.01,
            "{:?}",
            found.noise
        );
    }

    #[test]
    fn sessions_of_one_switch_share_constants() {
        let same = chosen(&[day("a", 3, 1.0), day("b", 4, 1.0)].concat());
        assert!(same.baseline.model.frame.changes.is_empty() && same.augmented.model.terms.is_empty());
        let term = Term::Named(effect_named("rate_dependence").unwrap());
        let mut rows = session_with(3, &[(term.clone(), &[0.2])]);
        rows.iter_mut().for_each(|r| r.labels.session = "a".to_owned());
        let mut later = session_with(4, &[(term, &[0.2])]);
        later.iter_mut().for_each(|r| r.labels.session = "b".to_owned());
        let found = chosen(&[rows, later].concat());
        assert!(found.baseline.model.frame.changes.is_empty());
        assert_eq!(found.augmented.model.named_effects()[0].id(), "rate_dependence");
        assert_eq!(session(3).len() * 2, found.augmented.residual_n.len());
    }
}
