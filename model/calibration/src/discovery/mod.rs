//! Formulas for unattributed structure.
//!
//! A formula is selected from a library by the evidence of the hypothesis that has it in place of the
//! structure. It is a user-defined effect. Written to `discovered.toml`, it is tested in the next
//! calibration with data from which it was not derived.

mod library;

use std::collections::BTreeMap;

use pinswitch_inference::{Fit, Member, best_additions};

use crate::effects::{Channel, Covariate, EffectDefinition, OwnEffect, Vocabulary};
use crate::evidence::{Evidence, Fitted};
use crate::report::{Estimate, FormReport, FormRival, ModelReport};
use crate::reporting::{held_out, model_report};
use crate::table::{PlateauRow, readings_by_session};
use library::{Candidate, actings, acts_on_word, library};

/// Most formulas that are fitted.
const FITTED: usize = 12;
/// Difference of the log evidence, in nats, up to which another formula is a rival: odds of one in
/// twenty.
const RIVAL: f64 = 3.0;

/// A formula with its effect.
#[derive(Clone, Debug)]
pub struct DrawnForm {
    /// Report of the formula.
    pub report: FormReport,
    /// Definition as a user-defined effect.
    pub definition: EffectDefinition,
    /// The best hypothesis with the formula in place of the structure.
    pub fitted: Fitted,
    /// Report of that hypothesis.
    pub(crate) model_report: ModelReport,
}

/// Derives the formula of the first unattributed structure of a posterior; `None` without such
/// structure, or if no formula of the library explains part of it.
pub(crate) fn draw_form(
    rows: &[PlateauRow],
    evidence: &Evidence,
    vocabulary: &Vocabulary,
    seed: u64,
) -> Option<DrawnForm> {
    let posterior = evidence.posterior();
    let is_unnamed = |member: Member| matches!(member, Member::Kernel(_)) && !evidence.is_change(member);
    let member = posterior.reported.iter().map(|r| r.member).find(|member| is_unnamed(*member))?;
    let kernel = evidence.kernel_at(member)?;
    let covariate = Covariate::ALL.into_iter().find(|c| c.as_str() == evidence.covariate(member));
    let covariate = covariate.unwrap_or(Covariate::Condition);
    let frame = &evidence.frame();
    let channel = evidence.channel(member)?;
    let candidates = numbered(&library(covariate, frame), covariate, channel);
    let (best, rivals, with_forms) = best_form(evidence, member, vocabulary, &candidates, rows, seed)?;
    let reduced = posterior.best_without(member)?.log_evidence;
    let by_structure = posterior.window.first()?.log_evidence - reduced;
    let explained = best.fit.log_evidence - reduced;
    if explained <= 0.0 {
        return None;
    }
    // The constants of the formula, under its final name.
    let mut fitted = with_forms.fitted(&best.fit)?;
    let shape = best.shape(&fitted);
    let mut definition = best.candidate.definition.clone();
    definition.id = free_id(vocabulary, covariate, &shape);
    let held = held_out(&with_forms, &best.fit)?;
    let mut model_report = model_report(&with_forms, &best.fit, &fitted, held);
    let old = format!("{}.", best.candidate.definition.id);
    let own: BTreeMap<String, Estimate> = model_report
        .parameters
        .iter()
        .filter_map(|(name, estimate)| Some((name.strip_prefix(&old)?.to_owned(), estimate.clone())))
        .collect();
    for parameter in &mut definition.parameters {
        let Some(estimate) = own.get(&parameter.name) else { continue };
        // Rounded to significant digits.
        parameter.start = format!("{:.6e}", estimate.value).parse().unwrap_or(estimate.value);
        if let Some((low, high)) = parameter.bounds {
            let margin = 1e-3 * (high - low);
            parameter.start = parameter.start.clamp(low + margin, high - margin);
        }
    }
    definition.drawn_from = Some(readings_by_session(rows).into_values().collect());
    let renamed = vocabulary.with(vec![OwnEffect::new(definition.clone()).ok()?]).ok()?;
    fitted.model = fitted.model.renamed(&best.candidate.definition.id, &renamed, &definition.id)?;
    model_report.parameters = std::mem::take(&mut model_report.parameters)
        .into_iter()
        .map(|(name, estimate)| match name.strip_prefix(&old) {
            Some(short) => (format!("{}.{short}", definition.id), estimate),
            None => (name, estimate),
        })
        .collect();
    // The prior odds of a structure are those of its formula.
    let in_model = best.fit.log_evidence >= posterior.window.first()?.log_evidence
        && !kernel.is_session_bound
        && needs_every_effect(&with_forms, &best);
    Some(DrawnForm {
        report: FormReport {
            shape,
            acts_on: acts_on_word(definition.acts_on).to_owned(),
            channel: definition.acts_on.as_str().to_owned(),
            id: definition.id.clone(),
            formula: definition.formula.clone(),
            parameters: own,
            explains: if by_structure > 0.0 { (explained / by_structure).min(1.0) } else { 1.0 },
            heldout_rmse_n: held.both_n(),
            in_model,
            rivals,
        },
        definition,
        fitted,
        model_report,
    })
}

/// A fitted formula.
struct BestForm {
    candidate: Candidate,
    fit: Fit,
}

impl BestForm {
    /// Returns the word for the shape; a bump with a negative size is a dip.
    fn shape(&self, fitted: &Fitted) -> String {
        let size = fitted.model.constant(&format!("{}.a", self.candidate.definition.id));
        let is_dip = self.candidate.form.shape == "bump" && size.is_some_and(|size| size < 0.0);
        (if is_dip { "dip" } else { self.candidate.form.shape }).to_owned()
    }
}

/// Returns whether a formula needs all effects beside it. One that made up for what the basis of the structure leaves has no
/// size beside the formula, and its report would contradict the model.
fn needs_every_effect(with_forms: &Evidence, best: &BestForm) -> bool {
    let is_needed = |member: Member| {
        let without = best.fit.without(with_forms.problem(), member);
        without.is_none_or(|without| without.score < best.fit.score)
    };
    let effects = best.fit.hypothesis.members().filter(|member| matches!(member, Member::Effect(_)));
    effects.into_iter().all(is_needed)
}

/// Fits the formulas in place of a structure. Returns the best one, its rivals, and the posterior of a
/// vocabulary that contains all formulas.
fn best_form(
    evidence: &Evidence,
    structure: Member,
    vocabulary: &Vocabulary,
    candidates: &[Candidate],
    rows: &[PlateauRow],
    seed: u64,
) -> Option<(BestForm, Vec<FormRival>, Evidence)> {
    let own = candidates.iter().filter_map(|c| OwnEffect::new(c.definition.clone()).ok()).collect();
    let extended = vocabulary.with(own).ok()?;
    let ids = candidates.iter().map(|c| c.definition.id.as_str()).collect();
    // Gross errors are those of the best hypothesis: the baseline alone takes structure for them.
    let with_forms = Evidence::of_forms(rows, &extended, &ids, seed).ok()?.with_outliers_of(evidence);
    let hypothesis = evidence.posterior().window.first()?.hypothesis.without(structure);
    let reduced = Fit::of_hypothesis(with_forms.problem(), &hypothesis, &evidence.posterior().excluded)?;
    let is_form = |name: &str| candidates.iter().any(|c| c.definition.id == name);
    let effects = &with_forms.problem().space().effects;
    let forms: Vec<usize> = (0..effects.len()).filter(|i| is_form(&effects[*i].name)).collect();
    let fits = best_additions(with_forms.problem(), &reduced, &forms, FITTED);
    let mut found = fits.into_iter().filter_map(|fit| {
        let added = fit.hypothesis.members().find(|member| !hypothesis.contains(*member))?;
        let candidate = candidates.iter().find(|c| c.definition.id == with_forms.name(added))?;
        Some(BestForm { candidate: candidate.clone(), fit })
    });
    let best = found.next()?;
    let rivals = found
        .filter(|other| !other.candidate.is_like(&best.candidate))
        .map(|other| FormRival {
            shape: other.candidate.form.shape.to_owned(),
            acts_on: acts_on_word(other.candidate.definition.acts_on).to_owned(),
            worse_by: best.fit.log_evidence - other.fit.log_evidence,
        })
        .filter(|rival| rival.worse_by < RIVAL)
        .collect();
    Some((best, rivals, with_forms))
}

/// Returns each form of the library on each quantity of a channel, under an id of its own.
fn numbered(forms: &[library::Form], covariate: Covariate, channel: Channel) -> Vec<Candidate> {
    let pairs = forms.iter().flat_map(|form| actings(channel).iter().map(move |acting| (form, *acting)));
    pairs.enumerate().map(|(i, (form, acting))| form.on(acting, covariate, i)).collect()
}

/// Returns an id that the vocabulary does not have.
fn free_id(vocabulary: &Vocabulary, covariate: Covariate, shape: &str) -> String {
    let base = format!("discovered_{}_{shape}", covariate.as_str());
    let numbered = (2..).map(|n| format!("{base}_{n}"));
    let free = std::iter::once(base.clone()).chain(numbered).find(|id| vocabulary.named(id).is_none());
    free.unwrap_or(base)
}
