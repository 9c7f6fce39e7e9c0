//! The influence of each series, and series with gross errors.

use std::fmt::Write;

use pinswitch_calibration::{BadSeries, Report};

use super::super::Plot;
use super::super::html::escape;
use super::figure;
use super::number::{newtons, number, probability};

/// Returns the section.
pub(super) fn series(report: &Report, plots: &[Plot]) -> String {
    let mut html = "<h2>6. Series</h2>".to_owned();
    if let Some(plot) = plots.iter().find(|p| p.file == "left-out-series.svg") {
        html.push_str(
            "<p>Mean error of each series if it is predicted from the others. A series far from zero pulls the constants of the \
             model towards itself.</p>\n",
        );
        html.push_str(&figure(plot));
    }
    if report.bad_series.is_empty() {
        html.push_str("<p>No series and no reading has a gross error.</p>\n");
        return html;
    }
    html.push_str(
        "<p>Gross errors, such as a wrong weight or a failed run. They count in no error on this page; check them in the \
         laboratory book:</p><ul>",
    );
    report.bad_series.iter().for_each(|bad| html.push_str(&item(bad)));
    html.push_str("</ul>\n");
    html
}

fn item(bad: &BadSeries) -> String {
    let mut html = String::new();
    let _ = write!(
        html,
        "<li>{}: deviates by {} ({} standard deviations",
        escape(&bad.place()),
        newtons(bad.offset_n),
        number(bad.standard_deviations, 1)
    );
    if let Some(p) = bad.probability {
        let _ = write!(html, "; probability of a gross error {}", probability(p));
    }
    html.push_str(")</li>");
    html
}
