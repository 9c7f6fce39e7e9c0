//! Conversion of a posterior to its report.

mod bad_series;
mod changes;
mod effects;
mod errors;
mod limits;
mod mounts;
mod noise;

use pinswitch_inference::Member;

use crate::adequacy::{Residual, is_adequate};
use crate::aliasing::aliasing;
use crate::effects::Vocabulary;
use crate::evidence::{CONSEQUENCE, Evidence, Fitted};
use crate::report::{
    DataSummary, ExpectedErrorReport, ModelReport, MountReport, Report, StructureReport, TrialReport, Verdict,
};
use crate::table::{Optional, PlateauRow};

use bad_series::bad_series;
use changes::changes;
use effects::effects;
use errors::least_squares_n;
pub(crate) use errors::{HeldOut, held_out, model_report};
use limits::{NEVER_VISIBLE, candidates, invisible, limits, without_covariate};
use mounts::mounts;
use noise::{floor_n, noise_parts, series_scatter};

/// Name and version of the format.
pub(crate) const SCHEMA: &str = "pinswitch.calibration/2";
/// Smallest probability of a structure in the report.
const LEAST_PROBABILITY: f64 = 0.01;
/// Fewest series for an expected error of a new session.
const LEAST_SERIES: usize = 4;

/// A posterior with its models, from which a report follows.
pub(crate) struct Findings<'a> {
    pub(crate) rows: &'a [PlateauRow],
    /// Effects among which the evidence was searched.
    pub(crate) vocabulary: &'a Vocabulary,
    /// Columns that the table lacks.
    pub(crate) lacking: &'a [Optional],
    pub(crate) evidence: &'a Evidence,
    pub(crate) baseline: &'a Fitted,
    pub(crate) augmented: &'a Fitted,
    /// Report of the augmented model, if a formula takes the place of structure in it.
    pub(crate) form: Option<&'a ModelReport>,
    pub(crate) trials: Vec<TrialReport>,
}

/// Returns the report of findings.
pub(crate) fn report(findings: Findings<'_>) -> Option<Report> {
    let Findings { rows, evidence, baseline, augmented, vocabulary, lacking, .. } = &findings;
    let posterior = evidence.posterior();
    let is_plain = baseline.model.frame.is_plain();
    let best = posterior.window.first()?;
    let held = held_out(evidence, best)?;
    let held_baseline = held_out(evidence, &posterior.baseline)?;
    let augmented_report =
        findings.form.cloned().unwrap_or_else(|| model_report(evidence, best, augmented, held));
    let effects = effects(&findings, &augmented_report);
    let is_supported = evidence.series_count() >= LEAST_SERIES;
    let expected = posterior.expected_error.filter(|_| is_supported);
    let named = |member: &Member| match member {
        Member::Kernel(_) => Some(evidence.name(*member).to_owned()),
        Member::Effect(_) => None,
    };
    let structures = posterior
        .members()
        .iter()
        .filter(|(member, probability)| *probability >= LEAST_PROBABILITY && !evidence.is_noise(*member))
        // A reported change is listed on its own.
        .filter(|(member, _)| {
            !evidence.is_change(*member) || posterior.reported.iter().all(|r| r.member != *member)
        })
        .filter_map(|(member, probability)| {
            let covariate = evidence.covariate(*member).to_owned();
            Some(StructureReport { name: named(member)?, covariate, probability: *probability })
        })
        .collect();
    let (mounts, series_scatter) = (mounts(evidence), series_scatter(evidence, augmented, rows));
    Some(Report {
        schema: SCHEMA.to_owned(),
        data: DataSummary {
            rows: rows.len(),
            series: evidence.series_count(),
            conditions: augmented.model.frame.conditions.len(),
            outliers: evidence.outliers().iter().filter(|is_out| **is_out).count(),
        },
        verdict: verdict(evidence, series_scatter, &mounts).in_view_of(&findings.trials),
        adequate: adequate(&findings),
        promise_n: expected.map(|e| e.value),
        promise_baseline_n: posterior.baseline_error.filter(|_| is_supported),
        expected_error_n: expected.map(|e| ExpectedErrorReport { value: e.value, ci90: e.interval }),
        least_squares_n: least_squares_n(evidence, rows, &baseline.model),
        noise_floor_n: floor_n(augmented, rows),
        noise: augmented.noise,
        noise_parts: noise_parts(augmented.noise, evidence, rows),
        series_scatter,
        changes: changes(evidence),
        baseline: model_report(evidence, &posterior.baseline, baseline, held_baseline),
        augmented: augmented_report,
        candidates: candidates(evidence),
        structures,
        limits: limits(evidence),
        aliasing: aliasing(rows),
        ignored_columns: Vec::new(),
        unknown_columns: lacking.iter().map(|quantity| quantity.column().to_owned()).collect(),
        provenance: None,
        invisible: [invisible(evidence, baseline), without_covariate(vocabulary, lacking, is_plain)].concat(),
        never_visible: NEVER_VISIBLE.map(str::to_owned).to_vec(),
        bad_series: bad_series(evidence, rows),
        mounts,
        effects,
        trials: findings.trials,
        sessions: Vec::new(),
        extrapolation: None,
    })
}

/// Returns the verdict of a posterior. A change of friction between sessions or specimens is no effect
/// that the model lacks. Scatter between series, different mounts and possible structure are no effects, but prevent the
/// verdict `none`.
fn verdict(evidence: &Evidence, series_scatter: f64, mounts: &[MountReport]) -> Verdict {
    let posterior = evidence.posterior();
    let reported: Vec<_> = posterior.reported.iter().filter(|r| !evidence.is_change(r.member)).collect();
    let is_unnamed = |member: Member| matches!(member, Member::Kernel(_));
    if reported.iter().any(|r| is_unnamed(r.member)) {
        Verdict::Unattributed
    } else if reported.iter().any(|r| !r.rivals.is_empty()) {
        Verdict::Ambiguous
    } else if !reported.is_empty() {
        Verdict::Attributed
    } else {
        let is_unexplained =
            series_scatter >= CONSEQUENCE || !mounts.is_empty() || evidence.may_have_structure();
        let mut sizes = posterior.candidates.iter().map(|candidate| candidate.size);
        let is_known = !posterior.candidates.is_empty() && sizes.all(|size| size.is_excluded());
        if is_known && !is_unexplained { Verdict::None } else { Verdict::Inconclusive }
    }
}

fn adequate(findings: &Findings<'_>) -> bool {
    let Findings { evidence, augmented, .. } = findings;
    let residuals: Vec<Residual<'_>> = evidence
        .rows()
        .zip(evidence.residuals_n(augmented))
        .enumerate()
        .filter(|(place, _)| !evidence.posterior().outliers.contains(*place))
        .map(|(_, ((_, series, point), residual_n))| Residual { point, series, residual_n })
        .collect();
    is_adequate(&residuals)
}
