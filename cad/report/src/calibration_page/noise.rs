//! The components of the noise, with advice for the rig.

use std::fmt::Write;

use pinswitch_calibration::Report;

use super::super::html::escape;
use super::number::with_unit;

/// Returns the section.
pub(super) fn noise(report: &Report) -> String {
    let mut html = "<h2>8. Noise components</h2><p>Standard deviations of readings under conditions that are equal in the table; \
                    components that grow with the load are given at 20 N. More repetitions do not reduce a component that a group \
                    of readings shares; more groups do.</p>\n<div class=\"wide\"><table>\
                    <tr><th>component</th><th>size</th><th>description</th><th>how to reduce it</th></tr>\n"
        .to_owned();
    for part in &report.noise_parts {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            escape(&part.part.replace('_', " ")),
            if part.size > 0.0 { with_unit(part.size, &part.unit) } else { "unknown".to_owned() },
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
        "specimen" => "measure several: the curve of one applies to another within this only",
        _ => "",
    }
}
