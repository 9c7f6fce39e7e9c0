//! `report.html`: one self-contained page, from data to conclusion.

use std::fmt::Write;

use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::{Calibration, Estimate, Fate, ModelReport, Report, Verdict};

use super::Plot;
use super::html::{escape, policy};

/// Everything before the first heading of a page.
pub(super) fn head(title: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{}\"><title>{}</title><style>\
         body{{font:16px/1.5 sans-serif;max-width:940px;margin:2em auto;padding:0 1em;color:#222}}\
         h2{{margin-top:2em;border-bottom:2px solid #dde5ec;padding-bottom:.2em}}\
         table{{border-collapse:collapse;margin:1em 0}}td,th{{border-bottom:1px solid #ccc;padding:.25em .8em;text-align:left}}\
         td.n{{text-align:right;font-variant-numeric:tabular-nums}}\
         .verdict{{background:#eef3f8;padding:.8em 1em;border-left:5px solid #005a9c}}figure{{margin:.6em 0}}\
         .grid{{display:grid;grid-template-columns:1fr 1fr;gap:.4em}}.grid figure{{margin:0}}\
         figcaption{{color:#555}}svg{{max-width:100%;height:auto}}.b{{color:#be5014}}.a{{color:#005a9c}}\
         tr.kept td{{background:#e6f0f8}}tr.rival td{{background:#fbf1e8}}</style></head><body>\n",
        policy(&[]),
        escape(title)
    )
}

/// The page.
pub fn page(title: &str, calibration: &Calibration, plots: &[Plot]) -> String {
    let report = &calibration.report;
    let mut html = head("Calibration");
    let sections = [
        format!("<h1>{}: what the paper's model misses</h1>\n", escape(title)),
        conclusion(report),
        data(report),
        conditions(plots),
        residuals(plots),
        candidates(report),
        found(report),
        errors(report),
        constants(report),
        blind(report),
    ];
    sections.iter().for_each(|s| html.push_str(s));
    html.push_str("</body></html>\n");
    html
}

fn conclusion(report: &Report) -> String {
    let names: Vec<&str> = report.effects.iter().map(|e| e.id.as_str()).collect();
    let text = match report.verdict {
        Verdict::None => "The paper's model explains this data down to its noise.".to_owned(),
        Verdict::Inconclusive => {
            let open: Vec<&str> =
                report.limits.iter().filter(|l| !l.excluded).map(|l| l.id.as_str()).collect();
            format!("Nothing is believed, and this data does not exclude: {}.", open.join(", "))
        }
        Verdict::Attributed => format!("The paper's model lacks: {}.", names.join(", ")),
        Verdict::Ambiguous => {
            let sets: Vec<String> = report
                .effects
                .iter()
                .map(|e| {
                    std::iter::once(e.id.as_str())
                        .chain(e.rivals.iter().map(|r| r.id.as_str()))
                        .collect::<Vec<_>>()
                        .join(" or ")
                })
                .collect();
            format!("The paper's model lacks {}; this data cannot tell which.", sets.join(", and "))
        }
        Verdict::Unattributed => {
            let places: Vec<&str> = report
                .effects
                .iter()
                .filter(|e| e.id == "unattributed")
                .map(|e| e.covariate.as_str())
                .collect();
            format!("No named effect explains what is left; it lies in {}.", places.join(", "))
        }
    };
    let (before, after) = (report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n);
    if before.is_nan() || after.is_nan() {
        return format!(
            "<p class=\"verdict\">{text}<br>There is too little to hold anything out of the fit: no error is known.</p>\n"
        );
    }
    format!(
        "<p class=\"verdict\">{text}<br>Error on series and loads held out of the fit: \
         <b class=\"b\">{before:.4} N</b> before, <b class=\"a\">{after:.4} N</b> after; noise {:.4} N.</p>\n",
        report.noise_floor_n
    )
}

fn data(report: &Report) -> String {
    let d = &report.data;
    let n = &report.noise;
    let mut html = format!(
        "<h2>1. The data</h2><p>{} rows in {} series on {} conditions; {} rows weighed down as outliers. \
         Noise, estimated: one repetition {:.3} N and {:.2} % of the load, a whole series and direction {:.3} N and {:.2} %.{}</p>\n",
        d.rows,
        d.series,
        d.conditions,
        d.outliers,
        n.repetition.constant_n,
        100.0 * n.repetition.per_load,
        n.series.constant_n,
        100.0 * n.series.per_load,
        match n.correlation {
            0.0 => String::new(),
            rho => format!(
                " A repetition resembles the one before it (correlation {rho:.2}): the rows say less than their number."
            ),
        }
    );
    if !report.bad_series.is_empty() {
        html.push_str("<p>Series to look at (mislabelled weight, bad run); they decide nothing:</p><ul>");
        for bad in &report.bad_series {
            let _ = write!(
                html,
                "<li>series {} {}: off by {:+.3} N ({:+.1} standard deviations)</li>",
                escape(&bad.series),
                bad.direction,
                bad.offset_n,
                bad.standard_deviations
            );
        }
        html.push_str("</ul>\n");
    }
    html
}

fn conditions(plots: &[Plot]) -> String {
    let mut html = "<h2>2. Measured and predicted</h2><p>Mean readings (dots) above and below the load they hold, \
                    <span class=\"b\">the paper's model, refitted</span>, and <span class=\"a\">the better model</span>, \
                    on each condition: concentric above zero, eccentric below.</p>\n<div class=\"grid\">"
        .to_owned();
    for plot in plots.iter().filter(|p| p.file.starts_with("condition-")) {
        let _ = writeln!(html, "<figure aria-label=\"{}\">{}</figure>", escape(&plot.caption), plot.svg);
    }
    html.push_str("</div>\n");
    html
}

fn residuals(plots: &[Plot]) -> String {
    let mut html = "<h2>3. Where the paper's model misses</h2><p>What is left of each reading, over everything that varied; \
                    heavy dots are means. A course in the left panel is what the model lacks; the right panel should be flat.</p>\n"
        .to_owned();
    for plot in plots.iter().filter(|p| p.file.starts_with("residual-")) {
        let _ = writeln!(html, "<figure aria-label=\"{}\">{}</figure>", escape(&plot.caption), plot.svg);
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
    let mut html = "<h2>4. The candidates</h2><p>What each effect alone would gain over the paper's model, in squares of the \
                    noise, how likely chance gains as much over the whole vocabulary, and what it would still gain beside \
                    those that were kept.</p><table><tr><th>effect</th><th>gain</th><th>by chance</th><th>gain left</th>\
                    <th>decision</th></tr>\n"
        .to_owned();
    for c in &report.candidates {
        let (class, decision) = match c.fate {
            Fate::Kept => ("kept", "kept"),
            Fate::Rival => ("rival", "a rival: explains the data as well as the one kept"),
            Fate::Invisible => ("", "dropped: this data cannot show it"),
            Fate::Chance => ("", "dropped: may be chance"),
            Fate::Superfluous => ("", "dropped: superfluous beside what was kept"),
        };
        let left = c.gain_left.map_or_else(String::new, |g| format!("{g:.1}"));
        let _ = writeln!(
            html,
            "<tr class=\"{class}\"><td>{}</td><td class=\"n\">{:.1}</td><td class=\"n\">{}</td><td class=\"n\">{left}</td><td>{decision}</td></tr>",
            c.id,
            c.gain,
            probability(c.p_value)
        );
    }
    html.push_str("</table>\n");
    html
}

/// A probability as people write it.
fn probability(p: f64) -> String {
    if p < 1e-12 {
        "&lt; 1e-12".to_owned()
    } else if p < 0.001 {
        format!("{p:.0e}")
    } else {
        format!("{p:.3}")
    }
}

fn found(report: &Report) -> String {
    let mut html = "<h2>5. What was found</h2>\n".to_owned();
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
             Held-out error without it <b class=\"b\">{:.4} N</b>, with it <b class=\"a\">{:.4} N</b>.</p>{}",
            escape(&effect.id),
            escape(&effect.formula),
            effect.covariate,
            probability(effect.p_value),
            effect.error_before_n,
            effect.error_after_n,
            table(effect.parameters.iter())
        );
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

fn errors(report: &Report) -> String {
    let mut html = "<h2>6. The error before and after</h2><p>Root mean square, in newtons. Whole layouts: friction and effects come from \
                    the other layouts, only the threshold and range are the layout's own.</p>\
                    <table><tr><th>judged on</th><th>before</th><th>after</th></tr>\n"
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
                "<tr><td>{name}</td><td class=\"n b\">{before:.4}</td><td class=\"n a\">{after:.4}</td></tr>"
            );
        }
    }
    html.push_str("</table>\n");
    if let Some(e) = &report.extrapolation {
        let _ = writeln!(
            html,
            "<p>Fitted up to {:.1} N only and judged on the {} rows above: <span class=\"b\">{:.2} N</span> before, \
             <span class=\"a\">{:.2} N</span> after (medians {:.2} and {:.2} N); {:.2} N without {} bad reading(s).</p>",
            e.fitted_below_n,
            e.rows,
            e.rmse_before_n,
            e.rmse_after_n,
            e.median_before_n,
            e.median_after_n,
            e.rmse_after_without_bad_n,
            e.bad_rows
        );
    }
    html
}

fn constants(report: &Report) -> String {
    format!(
        "<h2>7. Constants</h2><h3 class=\"b\">The paper's model, refitted</h3>{}<h3 class=\"a\">The better model</h3>{}",
        table(report.baseline.parameters.iter()),
        table(report.augmented.parameters.iter())
    )
}

fn table<'a>(rows: impl Iterator<Item = (&'a String, &'a Estimate)>) -> String {
    let mut html =
        "<table><tr><th>constant</th><th>value</th><th>95 % interval</th><th>unit</th></tr>\n".to_owned();
    let mut any = false;
    for (name, e) in rows {
        any = true;
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"n\">{:.4}</td><td class=\"n\">{:.4} .. {:.4}</td><td>{}</td></tr>",
            escape(name),
            e.value,
            e.ci95[0],
            e.ci95[1],
            e.unit
        );
    }
    html.push_str("</table>\n");
    if any { html } else { String::new() }
}

fn blind(report: &Report) -> String {
    let mut html = "<h2>8. What this data cannot see, and what would</h2>\n".to_owned();
    if !report.invisible.is_empty() {
        html.push_str("<table><tr><th>effect</th><th>why not</th><th>what would show it</th></tr>\n");
        for i in &report.invisible {
            let _ = writeln!(
                html,
                "<tr><td>{}</td><td>{}</td><td>{}</td></tr>",
                escape(&i.id),
                escape(&i.why),
                escape(&i.experiment)
            );
        }
        html.push_str("</table>\n");
    }
    html.push_str("<p>No data of such a rig can see, once the model is refitted:</p><ul>\n");
    for text in &report.never_visible {
        let _ = writeln!(html, "<li>{}.</li>", escape(text));
    }
    html.push_str("</ul>\n");
    html
}
