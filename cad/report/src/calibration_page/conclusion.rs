//! The conclusion of a calibration: verdict, open questions, and expected errors.

use std::fmt::Write;

use pinswitch_calibration::{Answer, Asked, AskedQuestion, EffectReport, Report, TrialReport, Verdict};

use super::super::html::escape;
use super::limits::{open_limits, possible, typical};
use super::number::{newtons, short};

/// Most open effects in the conclusion; the section on limits lists all.
const MAX_NAMED: usize = 4;

/// Returns the box at the top of the page, and the verdicts of several tables.
pub(super) fn conclusion(report: &Report) -> String {
    let html = [changes(report), verdict(report), trials(report), errors(report), adequacy(report)].concat();
    format!("<div class=\"verdict\">{html}</div>\n{}", sessions(report))
}

/// Returns the differences of the switch between tables.
fn changes(report: &Report) -> String {
    let unequal: String =
        report.unequal.iter().map(|effect| format!("<p>{}.</p>", escape(&effect.words()))).collect();
    if report.changes.is_empty() {
        return unequal;
    }
    let each: String =
        report.changes.iter().map(|change| format!("<li>{}</li>", escape(&change.words()))).collect();
    unequal
        + &format!(
            "<p><b>The switch differs between the tables.</b> Curves and predictions are for the latest one:</p><ul>{each}</ul>"
        )
}

/// Returns the outcome of each confirmation test.
fn trials(report: &Report) -> String {
    if report.trials.is_empty() {
        return String::new();
    }
    let item = |trial: &TrialReport| {
        format!(
            "<li><b>{}</b>: {}; {}</li>",
            escape(&trial.id),
            trial.outcome.as_str(),
            escape(&trial.words())
        )
    };
    let each: String = report.trials.iter().map(item).collect();
    format!(
        "<p>Confirmation tests of user-defined effects, each alone with its shape from the file:</p><ul>{each}</ul>"
    )
}

/// Returns the verdict after each of several tables.
fn sessions(report: &Report) -> String {
    if report.sessions.is_empty() {
        return String::new();
    }
    let mut html = "<h2>Verdict after each table</h2><table><tr><th>table</th><th>rows so far</th><th>verdict</th><th>expected error of \
                    a new session</th></tr>"
        .to_owned();
    for session in &report.sessions {
        html.push_str(&session.asked.as_ref().map_or_else(String::new, plan_answers));
        let _ = write!(
            html,
            "<tr><td>{}</td><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{}</td></tr>",
            escape(&session.table),
            session.rows,
            escape(&session.words()),
            session.promise_n.map_or_else(|| "unknown".to_owned(), newtons)
        );
    }
    html.push_str("</table>\n");
    html
}

/// Formats a probability in percent, as `experiment` does: an estimate is never 0 or 100 %.
fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.99 => ">99".to_owned(),
        p if p < 0.01 => "<1".to_owned(),
        p => format!("{:.0}", 100.0 * p),
    }
}

/// Returns the questions of the plan for a session, with the predicted probability of an answer,
/// and the answers.
fn plan_answers(plan: &Asked) -> String {
    let item = |q: &AskedQuestion| {
        let percent = percent(q.resolved_probability);
        let size = q.size.map_or_else(String::new, |size| format!(" at a size of {}", short(size)));
        let repeated = q.by_repeating.map_or_else(String::new, |p| {
            format!("; with the paper's protocol repeated {} %", self::percent(p))
        });
        let question = format!("{} or {}{size} ({percent} %{repeated})", q.between[0], q.between[1]);
        // A smaller size may still be of consequence; it is then in the verdict.
        let at = if q.answer == Answer::Excluded && q.size.is_some() { " at this size" } else { "" };
        format!("<li>{}: <b>{}{at}</b></li>", escape(&question), q.answer.as_str())
    };
    let questions: String = plan.questions.iter().map(item).collect();
    let runs: String = plan.runs.iter().map(|run| format!("<li>{}</li>", escape(run))).collect();
    let runs = if runs.is_empty() { runs } else { format!("proposed runs:<ul>{runs}</ul>") };
    format!(
        "<tr><td colspan=\"4\">{runs}questions of the plan of {:.0} minutes, with the predicted probability of an answer, and \
         the answers:<ul>{questions}</ul></td></tr>",
        plan.minutes
    )
}

/// Returns the verdict, with experiments for what it leaves open.
fn verdict(report: &Report) -> String {
    let names: Vec<&str> =
        report.effects.iter().map(|e| e.id.as_str()).filter(|id| *id != "unattributed").collect();
    let besides = if names.is_empty() {
        String::new()
    } else {
        format!(" in addition to {}", escape(&names.join(", ")))
    };
    match report.verdict {
        Verdict::None => "<p>The paper's model explains this data within its noise. Each visible effect is smaller than \
                          its size of consequence, which changes friction or reading by 5 % somewhere in the table.</p>"
            .to_owned(),
        Verdict::Inconclusive => inconclusive(report),
        Verdict::Attributed => format!("<p>The paper's model lacks: {}.</p>", escape(&names.join(", "))),
        Verdict::Ambiguous => {
            let sets: Vec<String> = report.effects.iter().map(alternatives).collect();
            let mut html =
                format!("<p>The paper's model lacks {}; this data does not decide which.</p>", sets.join(", and "));
            for rival in report.effects.iter().filter_map(|e| e.rivals.first()) {
                let _ = write!(html, "<p>Experiment that would decide: {}.</p>", escape(&rival.experiment));
            }
            html
        }
        Verdict::Unattributed => {
            let of = |e: &&EffectReport| e.id == "unattributed";
            let covariates: Vec<&str> = report.effects.iter().filter(of).map(|e| e.covariate.as_str()).collect();
            format!(
                "<p>The residuals have a structure{besides} that no named effect explains, in {}.</p>",
                escape(&covariates.join(", "))
            )
        }
    }
}

/// Lists an effect with its rivals.
fn alternatives(effect: &EffectReport) -> String {
    let ids = std::iter::once(effect.id.as_str()).chain(effect.rivals.iter().map(|r| r.id.as_str()));
    escape(&ids.collect::<Vec<_>>().join(" or "))
}

fn inconclusive(report: &Report) -> String {
    let open = open_limits(report);
    let summary = if report.changes.is_empty() { "Inconclusive" } else { "Otherwise inconclusive" };
    let reason = match (open.is_empty(), report.reservations()) {
        (true, reservations) if !reservations.is_empty() => escape(&reservations.join("; ")),
        _ => "no effect detected, but effects of consequence cannot be ruled out".into(),
    };
    let mut html = format!("<p>{summary}: {reason}. Record more data.</p>");
    html.push_str(if open.is_empty() { "" } else { "<ul>" });
    for limit in open.iter().take(MAX_NAMED) {
        let _ = write!(
            html,
            "<li><b>{}</b>: {} is possible ({} changes friction or reading by 5 % somewhere). Experiment that would decide: \
             {}.</li>",
            escape(&limit.id),
            possible(limit),
            typical(limit),
            escape(&limit.experiment)
        );
    }
    html.push_str(if open.is_empty() { "" } else { "</ul>" });
    if let Some(group) = report.noise_parts.iter().find(|part| part.part == "group") {
        let _ = write!(
            html,
            "<p>Part of the noise: {}, {}. It is not in the curve of a part, but in the uncertainty of each predicted \
             reading.</p>",
            escape(&group.what),
            newtons(group.size)
        );
    }
    if let Some(more) = open.len().checked_sub(MAX_NAMED).filter(|n| *n > 0) {
        let _ = write!(html, "<p>{more} more effects are open, see section 8.</p>");
    }
    html
}

/// Returns the held-out and expected errors of both models, with the noise.
fn errors(report: &Report) -> String {
    let held = [report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n];
    let expected = [report.promise_baseline_n, report.promise_n];
    if held.iter().all(|e| !e.is_finite()) && expected.iter().all(Option::is_none) {
        return "<p>The data is too small for cross-validation: no error is known.</p>".to_owned();
    }
    let or_unknown = |value: Option<f64>| value.map_or("unknown".to_owned(), newtons);
    // Without effects both models are equal.
    let both = !report.effects.is_empty();
    let row = |name: &str, before: String, after: String| match both {
        true => {
            format!("<tr><td>{name}</td><td class=\"n b\">{before}</td><td class=\"n a\">{after}</td></tr>")
        }
        false => format!("<tr><td>{name}</td><td class=\"n\">{after}</td></tr>"),
    };
    let (columns, span) = match both {
        true => ("<th class=\"b\">baseline</th><th class=\"a\">augmented model</th>", 2),
        false => ("<th>baseline</th>", 1),
    };
    format!(
        "<div class=\"wide\"><table><tr><th>error</th>{columns}</tr>{}{}\
         <tr><td>noise of a reading</td><td class=\"n\" colspan=\"{span}\">{}</td></tr></table></div>",
        row("held-out error (series and loads)", newtons(held[0]), newtons(held[1])),
        row(
            "expected error of a new session of the same rig",
            or_unknown(expected[0]),
            or_unknown(expected[1])
        ),
        newtons(report.noise_floor_n)
    )
}

/// Returns whether the held-out error exceeds the noise.
fn adequacy(report: &Report) -> String {
    let (error, noise) = (report.augmented.heldout_series_rmse_n, report.noise_floor_n);
    if !error.is_finite() {
        return String::new();
    }
    if report.adequate {
        return "<p>The model is adequate: its held-out error on series is within the noise.</p>".to_owned();
    }
    format!(
        "<p><b>The model is not adequate.</b> Its held-out error on series is {}, the noise only {}. Check the right panels of \
         section 4, and the series listed in section 1.</p>",
        newtons(error),
        newtons(noise)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_never_certain() {
        assert_eq!([0.001, 0.014, 0.5, 0.99, 0.996].map(percent), ["<1", "1", "50", "99", ">99"]);
    }
}
