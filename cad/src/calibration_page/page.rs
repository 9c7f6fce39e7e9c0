//! `report.html`: one self-contained page, from data to conclusion.

use std::fmt::Write;

use pinswitch_model::calibration::{Calibration, Estimate, Report, Verdict};

use super::Plot;

/// Text that cannot be taken for markup.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The page.
pub fn page(title: &str, calibration: &Calibration, plots: &[Plot]) -> String {
    let report = &calibration.report;
    let mut html = String::from(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Calibration</title><style>\
         body{font:16px/1.5 sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color:#222}\
         table{border-collapse:collapse;margin:1em 0}td,th{border-bottom:1px solid #ccc;padding:.25em .8em;text-align:left}\
         .verdict{background:#eef3f8;padding:.8em 1em;border-left:5px solid #005a9c}figure{margin:1.5em 0}\
         figcaption{color:#555}svg{max-width:100%;height:auto}.b{color:#be5014}.a{color:#005a9c}</style></head><body>\n",
    );
    let sections = [
        format!("<h1>{}: what the paper's model misses</h1>\n", escape(title)),
        conclusion(report),
        data(report),
        figures(plots, "condition-", "Measured and predicted"),
        figures(plots, "residual-", "Residual over each covariate"),
        found(report),
        candidates(report),
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
    format!(
        "<p class=\"verdict\">{text}<br>Error on series and loads held out of the fit: \
         <b class=\"b\">{:.4} N</b> before, <b class=\"a\">{:.4} N</b> after; noise {:.4} N.</p>\n",
        report.baseline.heldout_rmse_n, report.augmented.heldout_rmse_n, report.noise_floor_n
    )
}

fn data(report: &Report) -> String {
    let d = &report.data;
    let mut html = format!(
        "<h2>The data</h2><p>{} rows in {} series on {} conditions; {} rows weighed down as outliers.</p>\n",
        d.rows, d.series, d.conditions, d.outliers
    );
    if !report.bad_series.is_empty() {
        html.push_str("<p>Series to look at (mislabelled weight, bad run):</p><ul>");
        for bad in &report.bad_series {
            let _ = write!(
                html,
                "<li>{} {}: off by {:+.3} N ({:+.1} standard deviations)</li>",
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

fn figures(plots: &[Plot], prefix: &str, heading: &str) -> String {
    let mut html = format!(
        "<h2>{heading}</h2><p><span class=\"b\">The paper's model, refitted</span>; <span class=\"a\">the better model</span>.</p>\n"
    );
    for plot in plots.iter().filter(|p| p.file.starts_with(prefix)) {
        let _ =
            writeln!(html, "<figure>{}<figcaption>{}</figcaption></figure>", plot.svg, escape(&plot.caption));
    }
    html
}

fn found(report: &Report) -> String {
    let mut html = "<h2>What was found</h2>\n".to_owned();
    if report.effects.is_empty() {
        html.push_str("<p>Nothing beyond the noise.</p>\n");
    }
    for effect in &report.effects {
        let _ = write!(
            html,
            "<h3>{}</h3><p>Lies in {}. {}<br>Chance of such a gain without it, over the whole vocabulary: {:.1e}. \
             Held-out error without it {:.4} N, with it {:.4} N.</p>{}",
            escape(&effect.id),
            effect.covariate,
            escape(&effect.formula),
            effect.p_value,
            effect.error_before_n,
            effect.error_after_n,
            table(effect.parameters.iter())
        );
        for rival in &effect.rivals {
            let _ = writeln!(
                html,
                "<p>It may as well be <b>{}</b>: {}. The experiment that would settle it: {}.</p>",
                escape(&rival.id),
                escape(&rival.why),
                escape(&rival.experiment)
            );
        }
    }
    html
}

fn candidates(report: &Report) -> String {
    let mut all: Vec<_> = report.candidates.iter().collect();
    all.sort_by(|a, b| b.1.total_cmp(a.1));
    let mut html =
        "<h2>The candidates</h2><p>What each effect alone would gain over the paper's model, to first \
                    order, in squares of the noise. Others fall away once the named ones are in.</p>\
                    <table><tr><th>effect</th><th>gain</th><th></th></tr>\n"
            .to_owned();
    for (id, gain) in all {
        let kept = if report.effects.iter().any(|e| e.id == *id) {
            "kept"
        } else if report.effects.iter().any(|e| e.rivals.iter().any(|r| r.id == *id)) {
            "rival"
        } else if *gain < 16.0 {
            "within chance"
        } else {
            "superfluous beside what was kept"
        };
        let _ = writeln!(html, "<tr><td>{id}</td><td>{gain:.1}</td><td>{kept}</td></tr>");
    }
    html.push_str("</table>\n");
    html
}

fn constants(report: &Report) -> String {
    format!(
        "<h2>Constants</h2><h3>The paper's model, refitted</h3>{}<h3>The better model</h3>{}",
        table(report.baseline.parameters.iter()),
        table(report.augmented.parameters.iter())
    )
}

fn table<'a>(rows: impl Iterator<Item = (&'a String, &'a Estimate)>) -> String {
    let mut html =
        "<table><tr><th>constant</th><th>value</th><th>95 % interval</th><th>unit</th></tr>\n".to_owned();
    for (name, e) in rows {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{:.5}</td><td>{:.5} .. {:.5}</td><td>{}</td></tr>",
            escape(name),
            e.value,
            e.ci95[0],
            e.ci95[1],
            e.unit
        );
    }
    html.push_str("</table>\n");
    html
}

fn blind(report: &Report) -> String {
    let mut html = "<h2>What this data cannot see</h2><ul>\n".to_owned();
    for i in &report.invisible {
        let _ = writeln!(
            html,
            "<li><b>{}</b>: {}. To see it: {}.</li>",
            i.id,
            escape(&i.why),
            escape(&i.experiment)
        );
    }
    for text in &report.never_visible {
        let _ = writeln!(html, "<li>{}.</li>", escape(text));
    }
    html.push_str("</ul>\n");
    html
}
