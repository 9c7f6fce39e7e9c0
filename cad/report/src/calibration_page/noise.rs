//! The components of the noise, with advice for the rig.

use std::fmt::Write;

use pinswitch_calibration::{NoisePart, Report};

use super::super::html::escape;
use super::number::with_unit;

/// An interval with an upper end above this multiple of the size is not shown.
const MAX_RELATIVE_END: f64 = 50.0;

/// Returns the section.
pub(super) fn noise(report: &Report) -> String {
    let mut html = "<h2>2. Noise components</h2><p>Standard deviations of readings under conditions that are equal in the table; \
                    components that grow with the load are given at 20 N. More repetitions do not reduce a component that a group \
                    of readings shares; more groups do.</p>\n<div class=\"wide\"><table>\
                    <tr><th>component</th><th>size</th><th>95 % interval</th><th>description</th><th>how to reduce it</th></tr>\n"
        .to_owned();
    for part in &report.noise_parts {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            escape(&part.part.replace('_', " ")),
            if part.size > 0.0 { with_unit(part.size, &part.unit) } else { "unknown".to_owned() },
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
            "<p>Consecutive repetitions are correlated (r = {rho:.2}): the rows carry less information than independent ones.</p>"
        );
    }
    html
}

/// Formats the interval of a size, if the data bounds it.
fn interval(part: &NoisePart) -> String {
    match part.ci95 {
        Some([low, high]) if low.is_finite() && high < MAX_RELATIVE_END * part.size => {
            format!("{} to {}", with_unit(low, &part.unit), with_unit(high, &part.unit))
        }
        _ => "unknown".to_owned(),
    }
}

/// Returns how to reduce a component.
fn remedy(part: &str) -> &'static str {
    match part {
        "repetition" => "more repetitions; a longer rest before the reading",
        "series_and_direction" => "more series; the same start of the stroke in both directions",
        "series" => "zero the load cell before each series; weigh everything that hangs on it",
        "series_scale" => "seat the tendon the same way each time; more series at one load",
        "mount" => {
            "a stop that fixes the wrap angle; several mounts of each switch, with a column <code>mount</code>"
        }
        "stretch" => "warm up; series in random order; zero after a change of the room or the rig",
        "group" => "zero the same way for all operators and days",
        "specimen" => "measure several: the curve of one applies to another within this only",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unbounded_intervals_are_not_shown() {
        let part = |ci95| NoisePart {
            part: "mount".to_owned(),
            what: String::new(),
            size: 0.04,
            ci95,
            unit: "1".to_owned(),
        };
        assert_eq!(interval(&part(Some([0.02, 0.08]))), "2.00 % to 8.00 %");
        for ci95 in [None, Some([0.0, f64::INFINITY]), Some([1e-9, 1e3]), Some([f64::NAN, f64::NAN])] {
            assert_eq!(interval(&part(ci95)), "unknown");
        }
    }
}
