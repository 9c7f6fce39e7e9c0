//! `report.html`: the self-contained page of a calibration.

mod conclusion;
mod limits;
mod noise;
mod number;
mod probabilities;
mod series;
mod style;

use std::fmt::Write;

use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::{Calibration, Estimate, FormReport, ModelReport, Report};

use super::Plot;
use super::html::escape;
use conclusion::conclusion;
use limits::limits;
use noise::noise;
use number::{newtons, number, probability, short};
use probabilities::probabilities;
use series::series;
pub(super) use style::head;

/// Returns the page, with figures from [`plots`](super::plots).
pub fn page(title: &str, calibration: &Calibration, plots: &[Plot]) -> String {
    let report = &calibration.report;
    let mut html = head("Calibration");
    let sections = [
        format!("<h1>Calibration with {}</h1>\n", escape(title)),
        conclusion(report),
        probabilities(report),
        detected(report),
        unseen(report),
        conditions(plots),
        residuals(plots),
        series(report, plots),
        errors(report),
        noise(report),
        constants(report),
        data(report),
    ];
    sections.iter().for_each(|s| html.push_str(s));
    html.push_str("</body></html>\n");
    html
}

fn data(report: &Report) -> String {
    let d = &report.data;
    let mut html = format!(
        "<h2>10. Data</h2><p>{} rows in {} series of {} condition(s); {} readings with gross errors, which count in no error \
         on this page.</p>\n",
        d.rows, d.series, d.conditions, d.outliers
    );
    if !report.ignored_columns.is_empty() {
        let _ = writeln!(
            html,
            "<p>Unused columns, copied to residuals.csv: {}.</p>",
            escape(&report.ignored_columns.join(", "))
        );
    }
    if !report.unknown_columns.is_empty() {
        let columns = escape(&report.unknown_columns.join(", "));
        let _ =
            writeln!(html, "<p>Absent or incomplete columns, whose covariates are not used: {columns}.</p>");
    }
    if let Some(provenance) = report.provenance.as_ref().filter(|p| !p.external.is_empty()) {
        let _ = writeln!(
            html,
            "<p>External inputs, which no provenance.json lists: {}.</p>",
            escape(&provenance.external_names())
        );
    }
    html
}

/// Returns a figure with its caption as its accessible name; a broad one scrolls on a narrow screen.
fn figure(plot: &Plot) -> String {
    let is_broad = plot.file.starts_with("residual-") || plot.file == "left-out-series.svg";
    let class = if is_broad { "plot broad" } else { "plot" };
    format!("<figure class=\"{class}\" aria-label=\"{}\">{}</figure>\n", escape(&plot.caption), plot.svg)
}

fn conditions(plots: &[Plot]) -> String {
    let mut html = "<h2>4. Readings and models</h2><p>Mean difference between reading and load for each condition: readings (dots), \
                    <span class=\"b\">baseline</span> (the paper's model, refitted) and <span class=\"a\">augmented model</span>; \
                    concentric above zero, eccentric below.</p>\n<div class=\"grid\">"
        .to_owned();
    plots.iter().filter(|p| p.file.starts_with("condition-")).for_each(|plot| html.push_str(&figure(plot)));
    html.push_str("</div>\n");
    html
}

fn residuals(plots: &[Plot]) -> String {
    let mut html = "<h2>5. Residuals</h2><p>Residuals over each covariate that varies; large dots are means. A trend on the left \
                    (baseline) shows what the model lacks; the right panel (augmented model) should have none.</p>\n"
        .to_owned();
    plots.iter().filter(|p| p.file.starts_with("residual-")).for_each(|plot| html.push_str(&figure(plot)));
    let constant: Vec<&str> = Covariate::ALL
        .iter()
        .map(|c| c.as_str())
        .filter(|name| !plots.iter().any(|p| p.file == format!("residual-{name}.svg")))
        .collect();
    if !constant.is_empty() {
        let _ = writeln!(
            html,
            "<p>Constant in this data, effects of them are invisible: {}.</p>",
            constant.join(", ")
        );
    }
    if let Some(plot) = plots.iter().find(|p| p.file == "noise-quantiles.svg") {
        html.push_str(
            "<h3>Distribution of the noise</h3><p>Each dot is a reading: its repetition noise, in units of the scale of the noise, \
             over the quantile that the assumed distribution has there. Dots near the line are as expected; dots \
             beyond it at the ends are more large errors than expected, and dots short of it fewer.</p>\n",
        );
        html.push_str(&figure(plot));
    }
    html
}

fn detected(report: &Report) -> String {
    let mut html = "<h2>2. Detected effects</h2>\n".to_owned();
    if report.effects.is_empty() {
        html.push_str("<p>None: no effect is probable.</p>\n");
    }
    for effect in &report.effects {
        let side = match effect.side.as_deref() {
            Some("switch") => "It is an effect of the switch and part of predicted curves.",
            Some(_) => "It is an effect of the rig and not part of the curves of a printed part.",
            None => "No named effect explains it: the model has a shape in its place.",
        };
        let _ = write!(
            html,
            "<h3>{}</h3><p>{}<br>Covariate: {}. {side} Posterior probability {}; posterior odds against the model without it {}. \
             Held-out error without it <b class=\"b\">{}</b>, with it <b class=\"a\">{}</b>.</p>{}",
            escape(&effect.id),
            escape(&effect.formula),
            effect.covariate,
            probability(effect.probability),
            odds(effect.odds),
            effect.error_before_n.map_or_else(|| "-".to_owned(), newtons),
            newtons(effect.error_after_n),
            table(effect.parameters.iter())
        );
        if let Some(form) = &effect.form {
            html.push_str(&discovered(form));
        }
        for rival in &effect.rivals {
            let _ = writeln!(
                html,
                "<p>Rival: <b>{}</b>: {}.<br><b>Experiment that would decide:</b> {}.</p>",
                escape(&rival.id),
                escape(&rival.why),
                escape(&rival.experiment)
            );
        }
    }
    html
}

/// Formats posterior odds.
fn odds(odds: f64) -> String {
    match odds {
        odds if !odds.is_finite() => number(odds, 0),
        odds if odds >= 1e6 => "above 1e6".to_owned(),
        odds => short(odds),
    }
}

/// Describes the discovered effect of a structure, and how to test it.
fn discovered(form: &FormReport) -> String {
    let mut html = format!(
        "<p>Discovered effect: <b>{}</b> on {}: <code>{}</code>. It explains {:.0} % of the shapes; held-out error with \
         it instead of the correction: {}.</p>{}",
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
            .map(|r| {
                format!("{} on {} (log evidence smaller by {})", r.shape, r.acts_on, number(r.worse_by, 1))
            })
            .collect();
        let _ = write!(html, "<p>Equally good shapes: {}.</p>", escape(&rivals.join(", ")));
    }
    let _ = writeln!(
        html,
        "<p>Not confirmed. Test {} with other data: <code>pinswitch calibrate next.csv --effects discovered.toml</code>.</p>",
        escape(&form.id)
    );
    html
}

fn errors(report: &Report) -> String {
    let mut html = "<h2>7. Errors</h2><p>Root mean square, in newtons. For leave-one-layout-out, friction and effects come from the \
                    other layouts; only threshold and range come from the layout itself.</p>\
                    <div class=\"wide\"><table><tr><th>data</th><th class=\"b\">baseline</th><th class=\"a\">augmented model</th></tr>\n"
        .to_owned();
    let of = |m: &ModelReport| {
        [
            Some(m.rmse_n),
            Some(m.heldout_series_rmse_n),
            Some(m.heldout_loads_rmse_n),
            m.heldout_layouts_rmse_n,
        ]
    };
    let names = ["in-sample", "leave-series-out", "leave-loads-out", "leave-one-layout-out"];
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
    if let Some(error) = report.least_squares_n {
        let _ = writeln!(
            html,
            "<p>Robust least squares of the paper's model with drag, offset and gain, leave-series-out: {}.</p>",
            newtons(error)
        );
    }
    if let Some(e) = &report.extrapolation {
        let _ = writeln!(
            html,
            "<p>Extrapolation: fitted up to {:.1} N, the error on the {} rows above is <span class=\"b\">{} N</span> (baseline) and \
             <span class=\"a\">{} N</span> (augmented model), medians {} and {} N; {} N without {} wrong reading(s).</p>",
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
        "<h2>9. Constants</h2><h3 class=\"b\">Baseline</h3>{}<h3 class=\"a\">Augmented model</h3>{}",
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

/// Returns the section on effects that the data neither show nor exclude.
fn unseen(report: &Report) -> String {
    format!("<h2>3. What the data cannot show</h2>\n{}{}", limits(report), invisible(report))
}

fn invisible(report: &Report) -> String {
    let mut html = "<h3>Effects that are not identifiable</h3>\n".to_owned();
    if !report.invisible.is_empty() {
        html.push_str("<div class=\"wide\"><table><tr><th>effect</th><th>reason</th><th>experiment that would show it</th></tr>\n");
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
    html.push_str("<p>Invisible on any such rig, since the refit absorbs them:</p><ul>\n");
    for text in &report.never_visible {
        let _ = writeln!(html, "<li>{}.</li>", escape(text));
    }
    html.push_str("</ul>\n");
    html
}
