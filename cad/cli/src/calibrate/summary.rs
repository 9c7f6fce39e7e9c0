//! What a calibration says on the terminal: a few lines, the rest stands in report.html.

use pinswitch_calibration::{FormReport, Report, SessionReport, TrialOutcome, TrialReport, Verdict};

/// Series to check, open effects and columns that the terminal lists.
const SHOWN: usize = 6;

/// The summary for the terminal.
pub(super) fn summary(report: &Report) -> String {
    let before = report.sessions.len().saturating_sub(1);
    let mut text: String = report
        .sessions
        .iter()
        .take(before)
        .enumerate()
        .map(|(i, s)| {
            let word = if i == 0 { "from" } else { "with" };
            format!("{}{word} {}: {}\n", asked(s), s.table, s.words())
        })
        .collect();
    text.extend(report.sessions.last().map(asked));
    text.push_str(&format!("verdict: {}\n", verdict(report)));
    report.changes.iter().for_each(|change| text.push_str(&format!("changed: {}\n", change.words())));
    report.unequal.iter().for_each(|effect| text.push_str(&format!("changed: {}\n", effect.words())));
    text.push_str(&errors(report));
    text.push_str(&effects(report));
    text.push_str(&trials(report));
    text.push_str(&noise(report));
    if !report.adequate {
        text.push_str("something is left: held-out series miss by more than the noise, see report.html\n");
    }
    text.push_str(&aliasing(report));
    if !report.ignored_columns.is_empty() {
        text.push_str(&format!("columns not read: {}\n", listed(&report.ignored_columns)));
    }
    text.push_str(&extrapolation(report));
    text.push_str(&bad_series(report));
    text
}

/// How much of what a session was made for it answers.
fn asked(session: &SessionReport) -> String {
    session.asked.as_ref().map_or_else(String::new, |plan| {
        format!(
            "{} answers {} of the {} questions it was made for\n",
            session.table,
            plan.answered_count(),
            plan.questions.len()
        )
    })
}

fn verdict(report: &Report) -> String {
    match report.verdict {
        Verdict::None => "none: the paper's model explains the data down to its noise".to_owned(),
        Verdict::Inconclusive => {
            let open: Vec<&str> =
                report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.as_str()).collect();
            let believed = if report.changes.is_empty() { "nothing" } else { "no effect" };
            let is_confirmed = |t: &&TrialReport| t.outcome == TrialOutcome::Confirmed;
            let confirmed: Vec<&str> =
                report.trials.iter().filter(is_confirmed).map(|t| t.id.as_str()).collect();
            let told = format!("inconclusive: {believed} is believed");
            match (open.is_empty(), confirmed.is_empty()) {
                (true, true) => format!("{told}, and nothing excluded: {}", report.reservations().join("; ")),
                (false, true) => format!("{told}, and not excluded are {}", listed(&open)),
                (true, false) => {
                    format!(
                        "{told} of all that was searched; asked for alone, there is {}",
                        listed(&confirmed)
                    )
                }
                (false, false) => format!(
                    "{told} of all that was searched, and not excluded are {}; asked for alone, there is {}",
                    listed(&open),
                    listed(&confirmed)
                ),
            }
        }
        Verdict::Attributed => "attributed".to_owned(),
        Verdict::Ambiguous => "ambiguous: this data cannot tell rivals apart".to_owned(),
        Verdict::Unattributed => "unattributed: structure is left that no named effect explains".to_owned(),
    }
}

/// The first words of a list, and how many more there are.
fn listed<T: AsRef<str>>(words: &[T]) -> String {
    let shown: Vec<&str> = words.iter().take(SHOWN).map(AsRef::as_ref).collect();
    match words.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        more => format!("{} and {more} more, see report.html", shown.join(", ")),
    }
}

/// Errors on data that no fit has seen.
fn errors(report: &Report) -> String {
    let held_out = [report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n];
    let mut text = match held_out {
        [before, after] if before.is_finite() && after.is_finite() => format!(
            "held-out error: {before:.4} N before, {after:.4} N after (noise {:.4} N)\n",
            report.noise_floor_n
        ),
        _ => "held-out error: none, there is too little to hold anything out\n".to_owned(),
    };
    if let (Some(before), Some(after)) = (report.promise_baseline_n, report.promise_n)
        && before.is_finite()
        && after.is_finite()
    {
        text.push_str(&format!("a new session: expect {before:.4} N before, {after:.4} N after\n"));
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
            text.push_str(&drawn(form));
        }
        for rival in &effect.rivals {
            text.push_str(&format!(
                "    or {}: {}; to settle it: {}\n",
                rival.id, rival.why, rival.experiment
            ));
        }
    }
    text
}

/// What the table says of each effect of one's own.
fn trials(report: &Report) -> String {
    let line = |trial: &TrialReport| {
        format!("  {} on trial: {}: {}\n", trial.id, trial.outcome.as_str(), trial.words())
    };
    report.trials.iter().map(line).collect()
}

/// What a structure without a name looks like.
fn drawn(form: &FormReport) -> String {
    let constants: Vec<String> = form
        .parameters
        .iter()
        .map(|(name, e)| format!("{name} = {:.4} [{:.4}, {:.4}] {}", e.value, e.ci95[0], e.ci95[1], e.unit))
        .collect();
    let rivals: Vec<String> = form.rivals.iter().map(|r| format!("{} on {}", r.shape, r.acts_on)).collect();
    let rivals = if rivals.is_empty() { String::new() } else { format!("; or {}", listed(&rivals)) };
    format!(
        "    looks like {} on {}: {}; {:.0} % of it{rivals}; {}; see discovered.toml\n",
        form.words(),
        form.acts_on,
        constants.join(", "),
        100.0 * form.explains,
        if form.in_model { "the model has it" } else { "the model keeps the smooth correction" }
    )
}

/// The parts of the noise in one line.
fn noise(report: &Report) -> String {
    let parts: Vec<String> = report
        .noise_parts
        .iter()
        .map(|part| {
            let name = match part.part.as_str() {
                "group" if part.what.contains("operator") => "from operator to operator".to_owned(),
                "group" => "from session to session".to_owned(),
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

/// Covariates that move together, in one line.
fn aliasing(report: &Report) -> String {
    let pairs: Vec<String> = report
        .aliasing
        .iter()
        .map(|pair| format!("{} ({:.2})", pair.covariates.join(" and "), pair.correlation))
        .collect();
    if pairs.is_empty() {
        return String::new();
    }
    format!("moving together, so that what lies in one may lie in the other: {}\n", listed(&pairs))
}

fn extrapolation(report: &Report) -> String {
    let Some(e) = &report.extrapolation else { return String::new() };
    format!(
        "above {:.1} N ({} rows, none fitted): {:.2} N before, {:.2} N after; medians {:.2} and {:.2} N; \
         {:.2} N after without {} bad reading(s)\n",
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
    for bad in report.bad_series.iter().take(SHOWN) {
        text.push_str(&format!(
            "  check {}: off by {:+.3} N ({:+.1} standard deviations)\n",
            bad.place(),
            bad.offset_n,
            bad.standard_deviations
        ));
    }
    if let Some(more) = report.bad_series.len().checked_sub(SHOWN).filter(|n| *n > 0) {
        text.push_str(&format!("  and {more} more, see report.html\n"));
    }
    text
}
