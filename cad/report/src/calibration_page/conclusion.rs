//! The conclusion of a calibration in plain words: the verdict, what is open, and the errors that it promises.

use std::fmt::Write;

use pinswitch_calibration::{Answer, EffectReport, PlanQuestion, Report, SessionPlan, TrialReport, Verdict};

use super::super::html::escape;
use super::limits::{open_limits, possible, typical};
use super::number::{newtons, short};

/// Open effects that the conclusion names; the section on limits has them all.
const NAMED: usize = 4;

/// The box at the top of the page.
pub(super) fn conclusion(report: &Report) -> String {
    let told = [changes(report), verdict(report), trials(report), errors(report), adequacy(report)].concat();
    let told = format!("<div class=\"verdict\">{told}</div>\n");
    format!("{told}{}", story(report))
}

/// What is not the same switch any more.
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
            "<p><b>The switch is not the same in all tables.</b> Curves and predictions are those of the latest:</p><ul>{each}</ul>"
        )
}

/// What the data say of each effect of one's own, asked for alone.
fn trials(report: &Report) -> String {
    if report.trials.is_empty() {
        return String::new();
    }
    let told = |trial: &TrialReport| {
        format!(
            "<li><b>{}</b>: {}; {}</li>",
            escape(&trial.id),
            trial.outcome.as_str(),
            escape(&trial.words())
        )
    };
    let each: String = report.trials.iter().map(told).collect();
    format!(
        "<p>Effects of one's own, each asked for alone with its shape as it was written down:</p><ul>{each}</ul>"
    )
}

/// What changed its mind: the verdict after each of several tables.
fn story(report: &Report) -> String {
    if report.sessions.is_empty() {
        return String::new();
    }
    let mut html = "<h2>From table to table</h2><table><tr><th>table</th><th>rows so far</th><th>verdict</th><th>error expected \
                    on a new session</th></tr>"
        .to_owned();
    for session in &report.sessions {
        html.push_str(&session.asked.as_ref().map_or_else(String::new, asked));
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

/// A probability in percent, as `experiment` prints it: nothing is certain.
fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.99 => ">99".to_owned(),
        p if p < 0.01 => "<1".to_owned(),
        p => format!("{:.0}", 100.0 * p),
    }
}

/// What a session was made for, how probably it was to be answered, and what came of it.
fn asked(plan: &SessionPlan) -> String {
    let told = |q: &PlanQuestion| {
        let percent = percent(q.resolved_probability);
        let size = q.size.map_or_else(String::new, |size| format!(" at a size of {}", short(size)));
        let repeated = q.by_repeating.map_or_else(String::new, |p| {
            format!("; by the paper's protocol repeated {} %", self::percent(p))
        });
        let words = format!("{} or {}{size} ({percent} %{repeated})", q.between[0], q.between[1]);
        // What is smaller than what was asked about may still be of consequence, and then stands in the verdict.
        let at = if q.answer == Answer::Excluded && q.size.is_some() { " at this size" } else { "" };
        format!("<li>{}: <b>{}{at}</b></li>", escape(&words), q.answer.as_str())
    };
    let questions: String = plan.questions.iter().map(told).collect();
    let runs: String = plan.runs.iter().map(|run| format!("<li>{}</li>", escape(run))).collect();
    let runs = if runs.is_empty() { runs } else { format!("proposed runs:<ul>{runs}</ul>") };
    format!(
        "<tr><td colspan=\"4\">{runs}asked for in {:.0} minutes, with the probability of an answer that was expected, and what \
         came of it:<ul>{questions}</ul></td></tr>",
        plan.minutes
    )
}

/// The verdict, with what would settle what it leaves open.
fn verdict(report: &Report) -> String {
    let names: Vec<&str> =
        report.effects.iter().map(|e| e.id.as_str()).filter(|id| *id != "unattributed").collect();
    let beside =
        if names.is_empty() { String::new() } else { format!(" beside {}", escape(&names.join(", "))) };
    match report.verdict {
        Verdict::None => "<p>The paper's model explains this data down to its noise. Each effect that this data can see is \
                          smaller than what would change friction or reading by 5 % anywhere in the table.</p>"
            .to_owned(),
        Verdict::Inconclusive => inconclusive(report),
        Verdict::Attributed => format!("<p>The paper's model lacks: {}.</p>", escape(&names.join(", "))),
        Verdict::Ambiguous => {
            let sets: Vec<String> = report.effects.iter().map(alternatives).collect();
            let mut html =
                format!("<p>The paper's model lacks {}; this data cannot tell which.</p>", sets.join(", and "));
            for rival in report.effects.iter().filter_map(|e| e.rivals.first()) {
                let _ = write!(html, "<p>To settle it: {}.</p>", escape(&rival.experiment));
            }
            html
        }
        Verdict::Unattributed => {
            let of = |e: &&EffectReport| e.id == "unattributed";
            let places: Vec<&str> = report.effects.iter().filter(of).map(|e| e.covariate.as_str()).collect();
            format!(
                "<p>Something is left{beside} that no named effect explains; it lies in {}.</p>",
                escape(&places.join(", "))
            )
        }
    }
}

/// An effect with what it may be instead.
fn alternatives(effect: &EffectReport) -> String {
    let ids = std::iter::once(effect.id.as_str()).chain(effect.rivals.iter().map(|r| r.id.as_str()));
    escape(&ids.collect::<Vec<_>>().join(" or "))
}

fn inconclusive(report: &Report) -> String {
    let open = open_limits(report);
    let settles =
        if report.changes.is_empty() { "This data settles nothing" } else { "It settles nothing else" };
    let why = match (open.is_empty(), report.reservations()) {
        (true, told) if !told.is_empty() => escape(&told.join("; ")),
        _ => "no effect gains more than chance may, yet effects of consequence are not excluded".into(),
    };
    let mut html = format!("<p>{settles}: {why}. To know more, record more.</p>");
    html.push_str(if open.is_empty() { "" } else { "<ul>" });
    for limit in open.iter().take(NAMED) {
        let _ = write!(
            html,
            "<li><b>{}</b>: {} is possible ({} changes friction or reading by 5 % somewhere). To settle it: {}.</li>",
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
            "<p>What this data does show is told as a part of the noise: {}, by {}. No curve of a part holds it, and no reading of \
             another one is predicted without it.</p>",
            escape(&group.what),
            newtons(group.size)
        );
    }
    if let Some(more) = open.len().checked_sub(NAMED).filter(|n| *n > 0) {
        let _ = write!(html, "<p>{more} more are open: section 8.</p>");
    }
    html
}

/// Errors on data that no fit has seen, of both models, beside the noise.
fn errors(report: &Report) -> String {
    let held = [report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n];
    let promised = [report.promise_baseline_n, report.promise_n];
    if held.iter().all(|e| !e.is_finite()) && promised.iter().all(Option::is_none) {
        return "<p>There is too little to hold anything out of the fit: no error is known.</p>".to_owned();
    }
    let promise = |value: Option<f64>| value.map_or("not known".to_owned(), newtons);
    // Where nothing was found, both models are one.
    let both = !report.effects.is_empty();
    let row = |name: &str, before: String, after: String| match both {
        true => {
            format!("<tr><td>{name}</td><td class=\"n b\">{before}</td><td class=\"n a\">{after}</td></tr>")
        }
        false => format!("<tr><td>{name}</td><td class=\"n\">{after}</td></tr>"),
    };
    let (columns, span) = match both {
        true => ("<th class=\"b\">the paper's model</th><th class=\"a\">the better model</th>", 2),
        false => ("<th>the paper's model</th>", 1),
    };
    format!(
        "<div class=\"wide\"><table><tr><th>error</th>{columns}</tr>{}{}\
         <tr><td>noise of one reading</td><td class=\"n\" colspan=\"{span}\">{}</td></tr></table></div>",
        row("on series and loads held out of the fit", newtons(held[0]), newtons(held[1])),
        row("to expect in a new session of the same rig", promise(promised[0]), promise(promised[1])),
        newtons(report.noise_floor_n)
    )
}

/// Whether anything is left, plainly.
fn adequacy(report: &Report) -> String {
    let (error, noise) = (report.augmented.heldout_series_rmse_n, report.noise_floor_n);
    if !error.is_finite() {
        return String::new();
    }
    if report.adequate {
        return "<p>The model is adequate: on series held out it misses by no more than the noise.</p>"
            .to_owned();
    }
    format!(
        "<p><b>Something is left.</b> On series held out the model misses by {}, and the noise explains {} only: look at the right \
         panels of section 4, and at the series listed in section 1.</p>",
        newtons(error),
        newtons(noise)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_certain() {
        assert_eq!([0.001, 0.014, 0.5, 0.99, 0.996].map(percent), ["<1", "1", "50", "99", ">99"]);
    }
}
