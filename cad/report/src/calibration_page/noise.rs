//! The noise by its parts, and what each means to a person at a rig.

use std::fmt::Write;

use pinswitch_calibration::{NoisePart, Report};

use super::super::html::escape;
use super::number::with_unit;

/// An end of an interval further than this many times the size says nothing.
const KNOWN_WITHIN: f64 = 50.0;

/// The section.
pub(super) fn noise(report: &Report) -> String {
    let mut html = "<h2>2. The noise by its parts</h2><p>What makes readings differ though nothing that the table tells has changed: \
                    standard deviations, at a load of 20 N where they grow with it. What a whole group of readings shares does not \
                    become smaller with more repetitions in it, only with more groups.</p>\n<div class=\"wide\"><table>\
                    <tr><th>part</th><th>size</th><th>95 % interval</th><th>what it does</th><th>what makes it smaller</th></tr>\n"
        .to_owned();
    for part in &report.noise_parts {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            escape(&part.part.replace('_', " ")),
            if part.size > 0.0 { with_unit(part.size, &part.unit) } else { "not known".to_owned() },
            interval(part),
            escape(&part.what),
            remedy(&part.part)
        );
    }
    html.push_str("</table></div>\n");
    let rho = report.noise.correlation;
    if rho.is_finite() && rho != 0.0 {
        let _ = writeln!(
            html,
            "<p>A repetition resembles the one before it (correlation {rho:.2}): the rows say less than their number.</p>"
        );
    }
    html
}

/// The interval of a size, where the data know one.
fn interval(part: &NoisePart) -> String {
    match part.ci95 {
        Some([low, high]) if low.is_finite() && high < KNOWN_WITHIN * part.size => {
            format!("{} to {}", with_unit(low, &part.unit), with_unit(high, &part.unit))
        }
        _ => "not known".to_owned(),
    }
}

/// What a person at the rig can do about a part.
fn remedy(part: &str) -> &'static str {
    match part {
        "repetition" => "more repetitions; a longer rest before the reading",
        "series_and_direction" => "more series; the same start of the stroke in each direction",
        "series" => "zeroing the load cell before each series; weighing what hangs on it",
        "series_scale" => "seating the tendon the same way each time; more series at one load",
        "mount" => {
            "a stop that fixes the wrap; several mounts of each switch, and a column <code>mount</code>"
        }
        "stretch" => "warming up; series in random order; zeroing when the room or the rig has changed",
        "group" => "one way of zeroing for all operators and days",
        "specimen" => "measuring several: the curve of one holds for another only within this",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_that_says_nothing_is_not_shown() {
        let part = |ci95| NoisePart {
            part: "mount".to_owned(),
            what: String::new(),
            size: 0.04,
            ci95,
            unit: "1".to_owned(),
        };
        assert_eq!(interval(&part(Some([0.02, 0.08]))), "2.00 % to 8.00 %");
        for ci95 in [None, Some([0.0, f64::INFINITY]), Some([1e-9, 1e3]), Some([f64::NAN, f64::NAN])] {
            assert_eq!(interval(&part(ci95)), "not known");
        }
    }
}
