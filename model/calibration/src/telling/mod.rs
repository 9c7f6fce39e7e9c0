//! Conversion of a selection to its report.

mod absent;
mod bad_series;
mod changes;
mod effects;
mod model;
mod noise;
mod unequal;

use crate::aliasing::aliasing;
use crate::held_out::{HeldOut, held_out};
use crate::inference::{Levels, Observations, Selection, Weighed, averaged_intervals, interval_half_widths};
use crate::promise::Promise;
use crate::report::{DataSummary, Fate, Report, UnequalReport, Verdict};
use crate::table::PlateauRow;
use crate::trial::trials;

use absent::{NEVER_VISIBLE, candidates, invisible, limits};
use bad_series::bad_series;
use changes::changes;
use effects::effects;
use noise::{is_adequate, noise_parts};
use unequal::{hidden, unequal};

pub(crate) use bad_series::BAD_READING_SD;
pub(crate) use model::model_report;

/// Results that a report needs in addition to the selection.
pub(crate) struct ReportInputs {
    /// Levels of the selection.
    pub(crate) levels: Levels,
    /// Expected error of a new session.
    pub(crate) promised: Option<Promise>,
    /// Number of rows with reduced weight.
    pub(crate) outliers: usize,
    /// Held-out errors of the augmented model.
    pub(crate) held: HeldOut,
}

/// Returns the report of a selection.
pub(crate) fn report(
    rows: &[PlateauRow],
    selection: &Selection,
    data: &Observations,
    inputs: ReportInputs,
) -> Report {
    let ReportInputs { levels, promised, outliers, held } = inputs;
    let noise = selection.noise;
    let weighed = &Weighed::new(data, noise);
    let bare = if selection.augmented.model.terms.is_empty() {
        held
    } else {
        held_out(&selection.baseline.model, weighed)
    };
    // The intervals of the paper's model assume that it lacks nothing, since it is the reference
    // for the augmented model.
    let baseline = model_report(&selection.baseline, weighed, bare, |fitted, weighed| {
        interval_half_widths(fitted, weighed).into_iter().map(|half| [half, half]).collect()
    });
    let augmented = model_report(&selection.augmented, weighed, held, averaged_intervals);
    let after_n = held.both_n();
    let effects = effects(selection, weighed, after_n, &augmented);
    let promise_n = promised.map(|p| if effects.is_empty() { p.baseline_n } else { p.augmented_n });
    let hidden = hidden(selection, data, levels);
    let unequal: Vec<UnequalReport> =
        unequal(selection, data).into_iter().chain(hidden.iter().cloned()).collect();
    let trials =
        trials(rows, selection, data).into_iter().map(|trial| trial.beside(&unequal)).collect::<Vec<_>>();
    let adequate =
        is_adequate(augmented.heldout_series_rmse_n, noise.floor_n(data), data) && hidden.is_empty();
    let candidates = candidates(selection, data, levels);
    let is_unsettled = candidates.iter().any(|candidate| candidate.fate == Fate::Unsettled);
    let verdict = match Verdict::of(selection).beside(&trials) {
        // Residual structure, an unexplained gain, or scatter that could hide an effect rules out
        // the verdict `none`.
        Verdict::None if !adequate || is_unsettled || noise.mounts_hide() => Verdict::Inconclusive,
        verdict => verdict,
    };
    Report {
        schema: "pinswitch.calibration/1".to_owned(),
        data: DataSummary {
            rows: rows.len(),
            series: data.series,
            conditions: selection.baseline.model.frame.conditions.len(),
            outliers,
        },
        verdict,
        noise_floor_n: noise.floor_n(data),
        noise,
        noise_parts: noise_parts(selection, data),
        adequate,
        promise_n,
        promise_baseline_n: promised.map(|p| p.baseline_n),
        limits: limits(selection),
        classes: selection
            .classes
            .iter()
            .map(|class| class.iter().map(|id| (*id).to_owned()).collect())
            .collect(),
        aliasing: aliasing(rows),
        ignored_columns: Vec::new(),
        changes: changes(&selection.augmented, weighed),
        unequal,
        baseline,
        augmented,
        candidates,
        effects,
        family_probability: selection.family_probability,
        invisible: invisible(selection),
        never_visible: NEVER_VISIBLE.map(str::to_owned).to_vec(),
        bad_series: bad_series(rows, selection, weighed),
        trials,
        sessions: Vec::new(),
        extrapolation: None,
    }
}
