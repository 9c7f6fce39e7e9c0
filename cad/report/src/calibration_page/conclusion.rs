//! The conclusion of a calibration: effects with their probabilities, errors, and verdict.

use std::fmt::Write;

use pinswitch_calibration::{Answer, EffectReport, PlanQuestion, Report, SessionPlan, TrialReport, Verdict};

use super::super::effect_words::{
    constants_words, effect_clause, friction_words, other_probabilities, reported_clause,
};
use super::super::html::escape;
use super::limits::{open_limits, possible, typical};
use super::number::{newtons, number, probability, short};

/// Most open effects in the conclusion; the section on limits lists all.
const MAX_NAMED: usize = 4;
/// Probability above which an effect that is not reported is named.
const NAMED_PROBABILITY: f64 = 0.05;

/// Returns the box at the top of the page, and the verdicts of several tables.
pub(super) fn conclusion(report: &Report) -> String {
    let html = [
        friction(report),
        effects(report),
        others(report),
        open(report),
        errors(report),
        verdict(report),
        adequacy(report),
        gross_errors(report),
        trials(report),
        changes(report),
    ]
    .concat();
    format!("<div class=\"verdict\">{html}</div>\n{}", sessions(report))
}

/// Returns the friction coefficient of a plain contact.
fn friction(report: &Report) -> String {
    friction_words(report).map_or_else(String::new, |words| format!("<p><b>{}</b></p>", escape(&words)))
}

/// Returns the reported effects with their probabilities and rivals.
fn effects(report: &Report) -> String {
    if report.effects.is_empty() {
        return "<p>No effect is established.</p>".to_owned();
    }
    report.effects.iter().map(effect).collect()
}

fn effect(effect: &EffectReport) -> String {
    let name = if effect.side.is_some() { &effect.id } else { &effect.formula };
    let constants = constants_words(effect);
    let constants = if constants.is_empty() { constants } else { format!(": {}", escape(&constants)) };
    let mut html = format!(
        "<p>Probability <b>{}</b> that {}{constants} ({})",
        probability(effect.probability),
        escape(&reported_clause(effect)),
        escape(name)
    );
    for rival in &effect.rivals {
        let _ = write!(
            html,
            "<br>or <b>{}</b> that {} ({})",
            probability(rival.probability),
            escape(&effect_clause(&rival.id)),
            escape(&rival.id)
        );
    }
    if let Some(rival) = effect.rivals.iter().find(|rival| !rival.experiment.is_empty()) {
        let _ = write!(html, "<br>Experiment that would decide: {}.", escape(&rival.experiment));
    }
    html.push_str("</p>");
    html
}

/// Names the other effects and structures that are not improbable.
fn others(report: &Report) -> String {
    let named = other_probabilities(report, NAMED_PROBABILITY);
    if named.is_empty() {
        return format!(
            "<p>Nothing else that this table can show has a probability above {NAMED_PROBABILITY}.</p>"
        );
    }
    let each: Vec<String> =
        named.iter().map(|(name, p)| format!("{} {}", escape(name), probability(*p))).collect();
    format!("<p>Other probabilities above {NAMED_PROBABILITY}: {}.</p>", each.join(", "))
}

/// Lists the effects of consequence that the data do not exclude.
fn open(report: &Report) -> String {
    let open = open_limits(report);
    if open.is_empty() {
        return String::new();
    }
    let names: Vec<String> = open.iter().map(|limit| escape(&limit.id)).collect();
    format!("<p>Not excluded: {}.</p>", names.join(", "))
}

/// Names the series with gross errors.
fn gross_errors(report: &Report) -> String {
    if report.bad_series.is_empty() {
        return String::new();
    }
    let each: Vec<String> =
        report.bad_series.iter().take(MAX_NAMED).map(|bad| escape(&bad.place())).collect();
    let more = report.bad_series.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("<p>Gross errors, see section 6: {}{more}.</p>", each.join(", "))
}

/// Returns the differences of the switch between tables.
fn changes(report: &Report) -> String {
    if report.changes.is_empty() {
        return String::new();
    }
    let each: String =
        report.changes.iter().map(|change| format!("<li>{}</li>", escape(&change.words()))).collect();
    format!(
        "<p><b>The switch differs between the tables.</b> Curves and predictions are for the latest one:</p><ul>{each}</ul>"
    )
}

/// Returns the outcome of the trial of each user-defined effect.
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
        "<p>Trials of user-defined effects, with readings that they were not derived from:</p><ul>{each}</ul>"
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
fn plan_answers(plan: &SessionPlan) -> String {
    let item = |q: &PlanQuestion| {
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

/// Returns the verdict in words.
fn verdict(report: &Report) -> String {
    let named = report.effects.iter().filter(|e| e.side.is_some()).count();
    let words = match report.verdict {
        Verdict::None => {
            "the paper's model explains this data within its noise. Each visible effect is smaller than its size of consequence, \
             which changes friction or reading by 5 % somewhere in the table."
        }
        Verdict::Inconclusive => return inconclusive(report),
        Verdict::Attributed if named == 1 => "the paper's model lacks one effect, which the data identify.",
        Verdict::Attributed => "the paper's model lacks these effects, which the data identify.",
        Verdict::Ambiguous => {
            "the paper's model lacks an effect, and the data cannot separate it from its rivals."
        }
        Verdict::Unattributed => "the residuals have structure that no named effect explains.",
    };
    format!("<p>Verdict: <b>{}</b>: {words}</p>", report.verdict.as_str())
}

fn inconclusive(report: &Report) -> String {
    let open = open_limits(report);
    let reason = match (open.is_empty(), report.reservations()) {
        (true, reservations) if !reservations.is_empty() => escape(&reservations.join("; ")),
        _ => {
            let scatter =
                report.scatter_in_words().map_or_else(String::new, |words| format!("; {}", escape(&words)));
            format!("no effect is established, but effects of consequence are not excluded{scatter}")
        }
    };
    let mut html = format!("<p>Verdict: <b>inconclusive</b>: {reason}. Record more data.</p>");
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
    if let Some(more) = open.len().checked_sub(MAX_NAMED).filter(|n| *n > 0) {
        let _ = write!(html, "<p>Section 3 lists {more} more.</p>");
    }
    html
}

/// Returns the held-out and expected errors of the paper's model, of least squares and of the model, with
/// the noise.
fn errors(report: &Report) -> String {
    let row = |name: &str, class: &str, held_out: Option<f64>, expected: String| {
        let held_out = held_out.map_or_else(|| "unknown".to_owned(), newtons);
        format!(
            "<tr><td>{name}</td><td class=\"n {class}\">{held_out}</td><td class=\"n {class}\">{expected}</td></tr>"
        )
    };
    let expected = report.expected_error_n.map_or_else(
        || "too few series".to_owned(),
        |e| format!("{}<br>[{}, {}]", newtons(e.value), number(e.ci90[0], 4), number(e.ci90[1], 4)),
    );
    let before = report.promise_baseline_n.map_or_else(String::new, newtons);
    let rows = [
        row("paper's model", "b", Some(report.baseline.heldout_series_rmse_n), before),
        row(
            "the same with drag, offset and gain, by least squares",
            "",
            report.least_squares_n,
            String::new(),
        ),
        row("this model", "a", Some(report.augmented.heldout_series_rmse_n), expected),
    ];
    format!(
        "<div class=\"wide\"><table><tr><th>error (RMS)</th><th>held-out series</th><th>new session, expected</th></tr>{}</table></div>\
         <p>Noise of a reading: {}.</p>",
        rows.concat(),
        newtons(report.noise_floor_n)
    )
}

/// Returns whether repeated readings are as close to the model as to each other.
fn adequacy(report: &Report) -> String {
    if report.adequate {
        return "<p>The model is adequate: repeated readings are as close to it as to each other.</p>"
            .to_owned();
    }
    "<p><b>The model is not adequate.</b> Repeated readings are closer to each other than to the model. Check the right panels of \
     section 5, and the series in section 6.</p>"
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_never_certain() {
        assert_eq!([0.001, 0.014, 0.5, 0.99, 0.996].map(percent), ["<1", "1", "50", "99", ">99"]);
    }
}
