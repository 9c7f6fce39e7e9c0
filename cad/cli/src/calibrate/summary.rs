//! The summary of a calibration for the terminal; report.html has the details.

use pinswitch_calibration::{
    ExpectedErrorReport, FormReport, Report, SessionReport, TrialOutcome, TrialReport, Verdict,
};
use pinswitch_diagnostic::neutral_line;
use pinswitch_report::{
    constants_words, effect_clause, friction_words, other_probabilities, parameters_words, reported_clause,
};

/// Most series, effects and columns that a line lists.
const MAX_LISTED: usize = 6;

/// Probability above which an effect that is not reported is named.
const NAMED_PROBABILITY: f64 = 0.05;

/// Formats the summary, the result first.
pub(super) fn summary(report: &Report) -> String {
    let mut text = sessions(report);
    text.push_str(&friction(report));
    text.push_str(&effects(report));
    text.push_str(&others(report));
    text.push_str(&not_excluded(report));
    text.push_str(&errors(report));
    text.push_str(&format!("verdict: {}\n", verdict(report)));
    if !report.adequate {
        text.push_str(
            "lack of fit: repeated readings are closer to each other than to the model, see report.html\n",
        );
    }
    text.push_str(&bad_series(report));
    text.push_str(&trials(report));
    report.changes.iter().for_each(|change| text.push_str(&format!("changed: {}\n", change.words())));
    text.push_str(&noise(report));
    text.push_str(&confounded(report));
    if !report.ignored_columns.is_empty() {
        text.push_str(&format!("ignored columns: {}\n", neutral_line(&listed(&report.ignored_columns))));
    }
    if !report.unknown_columns.is_empty() {
        let columns = report.unknown_columns.join(", ");
        text.push_str(&format!("absent or incomplete columns, whose covariates are not used: {columns}\n"));
    }
    if let Some(provenance) = report.provenance.as_ref().filter(|p| !p.external.is_empty()) {
        let names: Vec<&str> = provenance.external.iter().map(|input| input.file.as_str()).collect();
        text.push_str(&format!(
            "external inputs, which no provenance.json lists: {}\n",
            neutral_line(&listed(&names))
        ));
    }
    text.push_str(&extrapolation(report));
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
        Verdict::Attributed => "attributed: the data identify what the paper's model lacks".to_owned(),
        Verdict::Ambiguous => "ambiguous: the data cannot separate rival effects".to_owned(),
        Verdict::Unattributed => {
            "unattributed: the residuals have structure that no named effect explains".to_owned()
        }
    }
}

fn inconclusive(report: &Report) -> String {
    let is_confirmed = |t: &&TrialReport| t.outcome == TrialOutcome::Confirmed;
    let confirmed: Vec<&str> = report.trials.iter().filter(is_confirmed).map(|t| t.id.as_str()).collect();
    let changed = if report.changes.is_empty() { "" } else { "changed constants, but " };
    let mut text = format!("inconclusive: {changed}no effect is established");
    if !confirmed.is_empty() {
        text.push_str(&format!("; {} is confirmed on unseen readings", listed(&confirmed)));
    } else if report.limits.iter().any(|limit| !limit.excluded) {
        text.push_str(", and effects of consequence are not excluded");
        report.scatter_in_words().iter().for_each(|scatter| text.push_str(&format!("; {scatter}")));
    } else {
        report.reservations().iter().for_each(|reason| text.push_str(&format!("; {reason}")));
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

/// Formats the friction coefficient of a plain contact.
fn friction(report: &Report) -> String {
    friction_words(report).map_or_else(String::new, |words| format!("{words}\n"))
}

/// Formats a probability, never as 0 or 1: it depends on the priors.
fn probability(p: f64) -> String {
    match p {
        p if p > 0.9995 => ">0.999".to_owned(),
        p if p < 0.0005 => "<0.001".to_owned(),
        p => format!("{p:.3}"),
    }
}

/// Formats the reported effects with their probabilities and rivals.
fn effects(report: &Report) -> String {
    let mut text = String::new();
    for effect in &report.effects {
        let named = effect.side.is_some();
        let name = if named { &effect.id } else { &effect.formula };
        let constants = constants_words(effect);
        let constants = if constants.is_empty() { constants } else { format!(": {constants}") };
        text.push_str(&format!(
            "probability {} that {}{constants} ({name})\n",
            probability(effect.probability),
            reported_clause(effect)
        ));
        if let Some(form) = &effect.form {
            text.push_str(&fitted_form(form));
        }
        for rival in &effect.rivals {
            text.push_str(&format!(
                "  or {} that {} ({})\n",
                probability(rival.probability),
                effect_clause(&rival.id),
                rival.id
            ));
        }
        if let Some(rival) = effect.rivals.iter().find(|rival| !rival.experiment.is_empty()) {
            text.push_str(&format!("  to separate them: {}\n", rival.experiment));
        }
    }
    text
}

/// Formats the other effects and structures that are not improbable.
fn others(report: &Report) -> String {
    let others = other_probabilities(report, NAMED_PROBABILITY);
    let each: Vec<String> = others.iter().map(|(name, p)| format!("{name} {}", probability(*p))).collect();
    match (report.effects.is_empty(), each.is_empty()) {
        (true, true) => format!(
            "no effect is established; none that this table can show has a probability above {NAMED_PROBABILITY}\n"
        ),
        (true, false) => format!("no effect is established; probabilities: {}\n", listed(&each)),
        (false, true) => format!("nothing else that this table can show above {NAMED_PROBABILITY}\n"),
        (false, false) => format!("other probabilities above {NAMED_PROBABILITY}: {}\n", listed(&each)),
    }
}

/// Formats the effects of consequence that are not excluded.
fn not_excluded(report: &Report) -> String {
    let open: Vec<&str> = report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.as_str()).collect();
    if open.is_empty() { String::new() } else { format!("not excluded: {}\n", listed(&open)) }
}

/// Formats the held-out errors before and after, and the expected error of a new session.
fn errors(report: &Report) -> String {
    let newtons = |error: f64| if error.is_finite() { format!("{error:.4} N") } else { "unknown".to_owned() };
    let least_squares = report.least_squares_n.map_or_else(String::new, |error| {
        format!("{} by least squares with drag, offset and gain, ", newtons(error))
    });
    let mut text = format!(
        "held-out error: {} by the paper's model, {least_squares}{} by this model (noise {})\n",
        newtons(report.baseline.heldout_series_rmse_n),
        newtons(report.augmented.heldout_series_rmse_n),
        newtons(report.noise_floor_n)
    );
    text.push_str(&match report.expected_error_n {
        Some(ExpectedErrorReport { value, ci90: [low, high] }) => {
            // A table with one mount cannot show how mounts differ.
            let mount = if report.noise.mount_scale > 0.0 { "" } else { ", with the same mount" };
            format!("expected error of a new session: {value:.4} N [{low:.4}, {high:.4}]{mount}\n")
        }
        None => "expected error of a new session: unknown, too few series\n".to_owned(),
    });
    text
}

/// Formats the trial of each user-defined effect.
fn trials(report: &Report) -> String {
    let line = |trial: &TrialReport| {
        format!("trial of {}: {}: {}\n", trial.id, trial.outcome.as_str(), trial.words())
    };
    report.trials.iter().map(line).collect()
}

/// Formats the form that was fitted to unattributed structure.
fn fitted_form(form: &FormReport) -> String {
    let rivals: Vec<String> = form.rivals.iter().map(|r| format!("{} on {}", r.shape, r.acts_on)).collect();
    let rivals = if rivals.is_empty() { String::new() } else { format!("; or {}", listed(&rivals)) };
    format!(
        "  resembles {} on {}: {}; explains {:.0} %{rivals}; {}; see discovered.toml\n",
        form.words(),
        form.acts_on,
        parameters_words(&form.parameters),
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
            let name = part.part.replace('_', " ");
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
        let gross = bad.probability.map_or_else(String::new, |p| format!(", probability {}", probability(p)));
        text.push_str(&format!(
            "gross error: {}: off by {:+.3} N ({:+.1} standard deviations{gross})\n",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_never_certain() {
        assert_eq!([0.99996, 0.9981, 1e-9].map(probability), [">0.999", "0.998", "<0.001"]);
    }
}
