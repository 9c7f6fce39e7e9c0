//! `report.html`: one self-contained page, from data to conclusion.

mod conclusion;
mod limits;
mod noise;
mod number;
mod style;

use std::fmt::Write;

use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::{Calibration, Estimate, Fate, FormReport, ModelReport, Report};

use super::Plot;
use super::html::escape;
use conclusion::conclusion;
use limits::limits;
use noise::noise;
use number::{newtons, number, probability};
pub(super) use style::head;

/// The page.
pub fn page(title: &str, calibration: &Calibration, plots: &[Plot]) -> String {
    let report = &calibration.report;
    let mut html = head("Calibration");
    let sections = [
        format!("<h1>{}: what the paper's model misses</h1>\n", escape(title)),
        conclusion(report),
        data(report),
        noise(report),
        conditions(plots),
        residuals(plots),
        candidates(report),
        found(report),
        errors(report),
        limits(report),
        constants(report),
        blind(report),
    ];
    sections.iter().for_each(|s| html.push_str(s));
    html.push_str("</body></html>\n");
    html
}

fn data(report: &Report) -> String {
    let d = &report.data;
    let mut html = format!(
        "<h2>1. The data</h2><p>{} rows in {} series on {} condition(s); {} rows weighed down as outliers.</p>\n",
        d.rows, d.series, d.conditions, d.outliers
    );
    if !report.ignored_columns.is_empty() {
        let _ = writeln!(
            html,
            "<p>Columns that no calibration reads, kept in residuals.csv: {}.</p>",
            escape(&report.ignored_columns.join(", "))
        );
    }
    if !report.bad_series.is_empty() {
        html.push_str(
            "<p>To look at (mislabelled weight, bad run, slipped reading); they decide nothing:</p><ul>",
        );
        for bad in &report.bad_series {
            let _ = write!(
                html,
                "<li>{}: off by {} ({} standard deviations)</li>",
                escape(&bad.place()),
                newtons(bad.offset_n),
                number(bad.standard_deviations, 1)
            );
        }
        html.push_str("</ul>\n");
    }
    html
}

fn conditions(plots: &[Plot]) -> String {
    let mut html = "<h2>3. Measured and predicted</h2><p>Mean readings (dots) above and below the load they hold, \
                    <span class=\"b\">the paper's model, refitted</span>, and <span class=\"a\">the better model</span>, \
                    on each condition: concentric above zero, eccentric below.</p>\n<div class=\"grid\">"
        .to_owned();
    for plot in plots.iter().filter(|p| p.file.starts_with("condition-")) {
        let _ = writeln!(
            html,
            "<figure class=\"plot\" aria-label=\"{}\">{}</figure>",
            escape(&plot.caption),
            plot.svg
        );
    }
    html.push_str("</div>\n");
    html
}

fn residuals(plots: &[Plot]) -> String {
    let mut html = "<h2>4. Where the paper's model misses</h2><p>What is left of each reading, over everything that varied; \
                    heavy dots are means. A course in the left panel is what the model lacks; the right panel should be flat.</p>\n"
        .to_owned();
    for plot in plots.iter().filter(|p| p.file.starts_with("residual-")) {
        let _ = writeln!(
            html,
            "<figure class=\"plot\" aria-label=\"{}\">{}</figure>",
            escape(&plot.caption),
            plot.svg
        );
    }
    let fixed: Vec<&str> = Covariate::ALL
        .iter()
        .map(|c| c.as_str())
        .filter(|word| !plots.iter().any(|p| p.file == format!("residual-{word}.svg")))
        .collect();
    if !fixed.is_empty() {
        let _ = writeln!(html, "<p>Never varied here, and so never seen: {}.</p>", fixed.join(", "));
    }
    html
}

fn candidates(report: &Report) -> String {
    let mut html = "<h2>5. The candidates</h2><p>What each effect alone would gain over the paper's model, in squares of the \
                    noise, how likely chance gains as much over the whole vocabulary, and what it would still gain beside \
                    those that were kept.</p><div class=\"wide\"><table><tr><th>effect</th><th>gain</th><th>by chance</th><th>gain left</th>\
                    <th>decision</th></tr>\n"
        .to_owned();
    for c in &report.candidates {
        let (class, decision) = match c.fate {
            Fate::Kept => ("kept", "kept"),
            Fate::Rival => ("rival", "a rival: explains the data as well as the one kept"),
            Fate::Invisible => ("", "dropped: this data cannot show it"),
            Fate::Chance => ("", "dropped: may be chance"),
            Fate::Superfluous => ("", "dropped: superfluous beside what was kept"),
            Fate::Unsettled => {
                ("", "not believed: scatter explains the data as well, or it did not help on data held out")
            }
        };
        let left = c.gain_left.map_or_else(String::new, |g| number(g, 1));
        let _ = writeln!(
            html,
            "<tr class=\"{class}\"><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{left}</td><td>{decision}</td></tr>",
            c.id,
            number(c.gain, 1),
            probability(c.p_value)
        );
    }
    html.push_str("</table></div>\n");
    html
}

fn found(report: &Report) -> String {
    let mut html = "<h2>6. What was found</h2>\n".to_owned();
    if report.effects.is_empty() {
        html.push_str("<p>Nothing beyond the noise.</p>\n");
    }
    for effect in &report.effects {
        let side = match effect.side.as_deref() {
            Some("switch") => "It belongs to the switch and stays in predicted curves.",
            Some(_) => "It belongs to the rig and stays out of the curves of a printed part.",
            None => "It has no name: a smooth correction stands in the model.",
        };
        let _ = write!(
            html,
            "<h3>{}</h3><p>{}<br>It lies in {}. {side} Chance of such a gain without it: {}. \
             Held-out error without it <b class=\"b\">{}</b>, with it <b class=\"a\">{}</b>.</p>{}",
            escape(&effect.id),
            escape(&effect.formula),
            effect.covariate,
            probability(effect.p_value),
            newtons(effect.error_before_n),
            newtons(effect.error_after_n),
            table(effect.parameters.iter())
        );
        if let Some(form) = &effect.form {
            html.push_str(&drawn(form));
        }
        for rival in &effect.rivals {
            let _ = writeln!(
                html,
                "<p>It may as well be <b>{}</b>: {}.<br><b>The experiment that would settle it:</b> {}.</p>",
                escape(&rival.id),
                escape(&rival.why),
                escape(&rival.experiment)
            );
        }
    }
    html
}

/// What a structure without a name looks like, and how that is confirmed or refuted.
fn drawn(form: &FormReport) -> String {
    let mut html = format!(
        "<p>It looks like <b>{}</b> on {}: <code>{}</code>. That explains {:.0} % of what the smooth correction does; held-out \
         error with it in place of the correction: {}.</p>{}",
        escape(&form.words()),
        escape(&form.acts_on),
        escape(&form.formula),
        100.0 * form.explains,
        newtons(form.heldout_rmse_n),
        table(form.parameters.iter())
    );
    if !form.rivals.is_empty() {
        let rivals: Vec<String> = form
            .rivals
            .iter()
            .map(|r| format!("{} on {} (worse by {} squares)", r.shape, r.acts_on, number(r.worse_by, 1)))
            .collect();
        let _ = write!(html, "<p>Forms that fit as well: {}.</p>", escape(&rivals.join(", ")));
    }
    let _ = writeln!(
        html,
        "<p>Drawn, not confirmed: <code>pinswitch calibrate next.csv --effects discovered.toml</code> lets other data decide on \
         {}.</p>",
        escape(&form.id)
    );
    html
}

fn errors(report: &Report) -> String {
    let mut html = "<h2>7. The error before and after</h2><p>Root mean square, in newtons. Whole layouts: friction and effects come from \
                    the other layouts, only the threshold and range are the layout's own.</p>\
                    <div class=\"wide\"><table><tr><th>judged on</th><th>before</th><th>after</th></tr>\n"
        .to_owned();
    let of = |m: &ModelReport| {
        [
            Some(m.rmse_n),
            Some(m.heldout_series_rmse_n),
            Some(m.heldout_loads_rmse_n),
            m.heldout_layouts_rmse_n,
        ]
    };
    let names =
        ["the rows fitted", "whole series held out", "whole loads held out", "whole layouts held out"];
    for ((name, before), after) in names.iter().zip(of(&report.baseline)).zip(of(&report.augmented)) {
        if let (Some(before), Some(after)) = (before, after) {
            let _ = writeln!(
                html,
                "<tr><td>{name}</td><td class=\"n b\">{}</td><td class=\"n a\">{}</td></tr>",
                number(before, 4),
                number(after, 4)
            );
        }
    }
    html.push_str("</table></div>\n");
    if let Some(e) = &report.extrapolation {
        let _ = writeln!(
            html,
            "<p>Fitted up to {:.1} N only and judged on the {} rows above: <span class=\"b\">{} N</span> before, \
             <span class=\"a\">{} N</span> after (medians {} and {} N); {} N without {} bad reading(s).</p>",
            e.fitted_below_n,
            e.rows,
            number(e.rmse_before_n, 2),
            number(e.rmse_after_n, 2),
            number(e.median_before_n, 2),
            number(e.median_after_n, 2),
            number(e.rmse_after_without_bad_n, 2),
            e.bad_rows
        );
    }
    html
}

fn constants(report: &Report) -> String {
    format!(
        "<h2>9. Constants</h2><h3 class=\"b\">The paper's model, refitted</h3>{}<h3 class=\"a\">The better model</h3>{}",
        table(report.baseline.parameters.iter()),
        table(report.augmented.parameters.iter())
    )
}

fn table<'a>(rows: impl Iterator<Item = (&'a String, &'a Estimate)>) -> String {
    let mut html =
        "<div class=\"wide\"><table><tr><th>constant</th><th>value</th><th>95 % interval</th><th>unit</th></tr>\n".to_owned();
    let mut any = false;
    for (name, e) in rows {
        any = true;
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{} to {}</td><td>{}</td></tr>",
            escape(name),
            number(e.value, 4),
            number(e.ci95[0], 4),
            number(e.ci95[1], 4),
            escape(&e.unit)
        );
    }
    html.push_str("</table></div>\n");
    if any { html } else { String::new() }
}

fn blind(report: &Report) -> String {
    let mut html = "<h2>10. What this data cannot see, and what would</h2>\n".to_owned();
    if !report.invisible.is_empty() {
        html.push_str("<div class=\"wide\"><table><tr><th>effect</th><th>why not</th><th>what would show it</th></tr>\n");
        for i in &report.invisible {
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
                escape(&i.id),
                escape(&i.why),
                escape(&i.experiment)
            );
        }
        html.push_str("</table></div>\n");
    }
    html.push_str("<p>No data of such a rig can see, once the model is refitted:</p><ul>\n");
    for text in &report.never_visible {
        let _ = writeln!(html, "<li>{}.</li>", escape(text));
    }
    html.push_str("</ul>\n");
    html
}
