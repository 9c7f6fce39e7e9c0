//! The summary of a calibration for the terminal; report.html has the details.

use pinswitch_calibration::{FormReport, Report, SessionReport, TrialOutcome, TrialReport, Verdict};
use pinswitch_diagnostic::neutral_line;

/// Most series, effects and columns that a line lists.
const MAX_LISTED: usize = 6;

/// Formats the summary.
pub(super) fn summary(report: &Report) -> String {
    let mut text = sessions(report);
    text.push_str(&format!("verdict: {}\n", verdict(report)));
    report.changes.iter().for_each(|change| text.push_str(&format!("changed: {}\n", change.words())));
    report.unequal.iter().for_each(|effect| text.push_str(&format!("changed: {}\n", effect.words())));
    text.push_str(&errors(report));
    text.push_str(&effects(report));
    text.push_str(&trials(report));
    text.push_str(&noise(report));
    if !report.adequate {
        text.push_str("lack of fit: the held-out error exceeds the noise, see report.html\n");
    }
    text.push_str(&confounded(report));
    if !report.ignored_columns.is_empty() {
        text.push_str(&format!("ignored columns: {}\n", neutral_line(&listed(&report.ignored_columns))));
    }
    text.push_str(&extrapolation(report));
    text.push_str(&bad_series(report));
    text
}

/// Formats the result after each table but the last, and the answers of each planned session.
fn sessions(report: &Report) -> String {
    let Some((last, earlier)) = report.sessions.split_last() else { return String::new() };
    let mut text = String::new();
    for (i, session) in earlier.iter().enumerate() {
        let word = if i == 0 { "from" } else { "with" };
        text.push_str(&format!("{}{word} {}: {}\n", answers(session), session.table, session.words()));
    }
    text.push_str(&answers(last));
    text
}

/// Formats how many questions of its plan a session answers.
fn answers(session: &SessionReport) -> String {
    session.asked.as_ref().map_or_else(String::new, |plan| {
        format!(
            "{} answers {} of the {} questions of its plan\n",
            session.table,
            plan.answered_count(),
            plan.questions.len()
        )
    })
}

fn verdict(report: &Report) -> String {
    match report.verdict {
        Verdict::None => "none: the paper's model explains the data down to the noise".to_owned(),
        Verdict::Inconclusive => inconclusive(report),
        Verdict::Attributed => "attributed".to_owned(),
        Verdict::Ambiguous => "ambiguous: the data cannot separate rival effects".to_owned(),
        Verdict::Unattributed => {
            "unattributed: the residuals have structure that no named effect explains".to_owned()
        }
    }
}

fn inconclusive(report: &Report) -> String {
    let open: Vec<&str> = report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.as_str()).collect();
    let is_confirmed = |t: &&TrialReport| t.outcome == TrialOutcome::Confirmed;
    let confirmed: Vec<&str> = report.trials.iter().filter(is_confirmed).map(|t| t.id.as_str()).collect();
    let changed = if report.changes.is_empty() { "" } else { "changed constants, but " };
    let mut text = format!("inconclusive: {changed}no effect detected");
    if !confirmed.is_empty() {
        text.push_str(&format!(" in the search; tested alone, {} is confirmed", listed(&confirmed)));
    }
    if !open.is_empty() {
        text.push_str(&format!("; cannot rule out {}", listed(&open)));
    } else if confirmed.is_empty() {
        text.push_str(&format!("; {}", report.reservations().join("; ")));
    }
    text
}

/// Joins the first words of a list, and counts the others.
fn listed<T: AsRef<str>>(words: &[T]) -> String {
    let shown: Vec<&str> = words.iter().take(MAX_LISTED).map(AsRef::as_ref).collect();
    match words.len().saturating_sub(MAX_LISTED) {
        0 => shown.join(", "),
        more => format!("{} and {more} more, see report.html", shown.join(", ")),
    }
}

/// Formats the held-out error and the expected error of a new session, of the baseline and of the model.
fn errors(report: &Report) -> String {
    let held_out = [report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n];
    let mut text = match held_out {
        [baseline, model] if baseline.is_finite() && model.is_finite() => format!(
            "held-out error: baseline {baseline:.4} N, model {model:.4} N (noise {:.4} N)\n",
            report.noise_floor_n
        ),
        _ => "held-out error: unknown, too few series to hold any out\n".to_owned(),
    };
    if let (Some(baseline), Some(model)) = (report.promise_baseline_n, report.promise_n)
        && baseline.is_finite()
        && model.is_finite()
    {
        text.push_str(&format!(
            "expected error of a new session: baseline {baseline:.4} N, model {model:.4} N\n"
        ));
    }
    text
}

fn effects(report: &Report) -> String {
    let mut text = String::new();
    for effect in &report.effects {
        let constants: Vec<String> = effect
            .parameters
            .iter()
            .map(|(name, e)| {
                format!("{name} = {:.4} [{:.4}, {:.4}] {}", e.value, e.ci95[0], e.ci95[1], e.unit)
            })
            .collect();
        text.push_str(&format!("  {} ({}): {}\n", effect.id, effect.covariate, constants.join(", ")));
        if effect.id == "unattributed" {
            text.push_str(&format!("    {}\n", effect.formula));
        }
        if let Some(form) = &effect.form {
            text.push_str(&fitted_form(form));
        }
        for rival in &effect.rivals {
            text.push_str(&format!(
                "    or {}: {}; to separate them: {}\n",
                rival.id, rival.why, rival.experiment
            ));
        }
    }
    text
}

/// Formats the test of each user-defined effect.
fn trials(report: &Report) -> String {
    let line = |trial: &TrialReport| {
        format!("  test of {}: {}: {}\n", trial.id, trial.outcome.as_str(), trial.words())
    };
    report.trials.iter().map(line).collect()
}

/// Formats the form that was fitted to unattributed structure.
fn fitted_form(form: &FormReport) -> String {
    let constants: Vec<String> = form
        .parameters
        .iter()
        .map(|(name, e)| format!("{name} = {:.4} [{:.4}, {:.4}] {}", e.value, e.ci95[0], e.ci95[1], e.unit))
        .collect();
    let rivals: Vec<String> = form.rivals.iter().map(|r| format!("{} on {}", r.shape, r.acts_on)).collect();
    let rivals = if rivals.is_empty() { String::new() } else { format!("; or {}", listed(&rivals)) };
    format!(
        "    resembles {} on {}: {}; explains {:.0} %{rivals}; {}; see discovered.toml\n",
        form.words(),
        form.acts_on,
        constants.join(", "),
        100.0 * form.explains,
        if form.in_model { "included in the model" } else { "the model keeps the shapes" }
    )
}

/// Formats the components of the noise in one line.
fn noise(report: &Report) -> String {
    let parts: Vec<String> = report
        .noise_parts
        .iter()
        .map(|part| {
            let name = match part.part.as_str() {
                "group" if part.what.contains("operator") => "between operators".to_owned(),
                "group" => "between sessions".to_owned(),
                name => name.replace('_', " "),
            };
            if part.size == 0.0 {
                return format!("{name} unknown");
            }
            match part.unit.as_str() {
                "1" => format!("{name} {:.1} %", 100.0 * part.size),
                unit => format!("{name} {:.3} {unit}", part.size),
            }
        })
        .collect();
    if parts.is_empty() { String::new() } else { format!("noise: {}\n", parts.join(", ")) }
}

/// Formats the confounded covariates in one line.
fn confounded(report: &Report) -> String {
    let pairs: Vec<String> = report
        .aliasing
        .iter()
        .map(|pair| format!("{} (r = {:.2})", pair.covariates.join(" and "), pair.correlation))
        .collect();
    if pairs.is_empty() {
        return String::new();
    }
    format!("confounded covariates: {}\n", listed(&pairs))
}

fn extrapolation(report: &Report) -> String {
    let Some(e) = &report.extrapolation else { return String::new() };
    format!(
        "RMSE above {:.1} N ({} rows, not fitted): baseline {:.2} N, model {:.2} N; median error {:.2} N and {:.2} N; \
         model {:.2} N without {} bad reading(s)\n",
        e.fitted_below_n,
        e.rows,
        e.rmse_before_n,
        e.rmse_after_n,
        e.median_before_n,
        e.median_after_n,
        e.rmse_after_without_bad_n,
        e.bad_rows
    )
}

fn bad_series(report: &Report) -> String {
    let mut text = String::new();
    for bad in report.bad_series.iter().take(MAX_LISTED) {
        text.push_str(&format!(
            "  check {}: off by {:+.3} N ({:+.1} standard deviations)\n",
            bad.place(),
            bad.offset_n,
            bad.standard_deviations
        ));
    }
    if let Some(more) = report.bad_series.len().checked_sub(MAX_LISTED).filter(|n| *n > 0) {
        text.push_str(&format!("  and {more} more, see report.html\n"));
    }
    text
}
