//! Limits: sizes of undetected effects that are not excluded, and confounded covariates.

use std::fmt::Write;

use pinswitch_calibration::effects::effect_named;
use pinswitch_calibration::{LimitReport, Report};

use pinswitch_friction::sort_by_number;

use super::super::html::escape;
use super::number::{number, short, with_unit};

/// Range of the intervals in the figure, in sizes of consequence to each side.
const RANGE: f64 = 3.0;
/// Height of one row in pixels.
const ROW: f64 = 24.0;
/// Start and end of the intervals in pixels.
const INTERVALS: (f64, f64) = (170.0, 525.0);

/// Returns the limits that do not exclude an effect of consequence, the widest first.
pub(super) fn open_limits(report: &Report) -> Vec<&LimitReport> {
    let mut open: Vec<&LimitReport> = report.limits.iter().filter(|l| !l.excluded).collect();
    sort_by_number(&mut open, |limit| -largest_size(limit));
    open
}

/// Returns the largest possible size, in sizes of consequence.
fn largest_size(limit: &LimitReport) -> f64 {
    let [low, high] = ends(limit);
    (low.abs().max(high.abs()) / limit.typical.abs()).min(f64::MAX)
}

/// Returns the interval, cut to the sizes that the effect can have.
fn ends(limit: &LimitReport) -> [f64; 2] {
    let present = limit.parameter == "present";
    let low = if limit.one_sided || present { limit.low.max(0.0) } else { limit.low };
    [low, if present { limit.high.clamp(0.0, 1.0) } else { limit.high.max(low) }]
}

/// Describes the sizes that are not excluded.
pub(super) fn possible(limit: &LimitReport) -> String {
    let [low, high] = ends(limit);
    if limit.parameter == "present" {
        return match high >= 1.0 {
            true => "the whole effect".to_owned(),
            false => format!("up to {} of the effect", with_unit(high, "1")),
        };
    }
    let unit = limit.unit.as_str();
    let name = escape(&limit.parameter);
    match low {
        0.0 => format!("{name} up to {}", sized(high, unit)),
        _ => format!("{name} from {} to {}", sized(low, unit), sized(high, unit)),
    }
}

/// Describes the size of consequence.
pub(super) fn typical(limit: &LimitReport) -> String {
    match limit.parameter.as_str() {
        "present" if limit.typical >= 1.0 => "more than the whole effect".to_owned(),
        "present" => format!("{} of the effect", with_unit(limit.typical, "1")),
        name => format!("{} = {}", escape(name), sized(limit.typical, &limit.unit)),
    }
}

/// Formats a size with its unit. A number without a unit is not formatted as a percentage, since it
/// need not be a share.
fn sized(value: f64, unit: &str) -> String {
    if unit == "1" { short(value) } else { with_unit(value, unit) }
}

/// Returns the section.
pub(super) fn limits(report: &Report) -> String {
    let mut html = "<h3>Limits on effects that were not detected</h3>\n".to_owned();
    if report.limits.is_empty() {
        html.push_str("<p>None: no other effect is visible in this data.</p>\n");
    } else {
        html.push_str(
            "<p>Each visible effect that was not detected, with the sizes that are not excluded at 95 %. The size of consequence \
             changes friction or reading by 5 % somewhere in the table; an effect is excluded if all its possible sizes are smaller.</p>\n",
        );
        let all = sorted(report);
        // The limit of a load cell is not an interval about zero and is not in the figure.
        let about_zero = |l: &LimitReport| {
            effect_named(&l.id).is_none_or(|e| e.description().scales || e.parameters().is_empty())
        };
        html.push_str(&interval_figure(&all.iter().copied().filter(|l| about_zero(l)).collect::<Vec<_>>()));
        html.push_str(&table(&all));
    }
    html.push_str(&confounding(report));
    html
}

/// Sorts the limits: open ones first, the widest first.
fn sorted(report: &Report) -> Vec<&LimitReport> {
    let mut excluded: Vec<&LimitReport> = report.limits.iter().filter(|l| l.excluded).collect();
    sort_by_number(&mut excluded, |limit| -largest_size(limit));
    open_limits(report).into_iter().chain(excluded).collect()
}

fn table(all: &[&LimitReport]) -> String {
    let mut html = "<div class=\"wide\"><table><tr><th>effect</th><th>possible sizes</th><th>size of consequence</th><th></th></tr>\n"
        .to_owned();
    for limit in all {
        let (class, status) = if limit.excluded { (" class=\"soft\"", "excluded") } else { ("", "open") };
        let typical = typical(limit);
        let _ = writeln!(
            html,
            "<tr{class}><td>{}</td><td>{}</td><td>{typical}</td><td>{status}</td></tr>",
            escape(&limit.id),
            possible(limit)
        );
    }
    html.push_str("</table></div>\n");
    html
}

/// Draws one interval per effect, in sizes of consequence.
fn interval_figure(all: &[&LimitReport]) -> String {
    let (left, right) = INTERVALS;
    let x = |multiple: f64| left + (right - left) * (multiple.clamp(-RANGE, RANGE) + RANGE) / (2.0 * RANGE);
    let foot = ROW * all.len() as f64 + 6.0;
    let mut svg = format!(
        "<figure class=\"wide\"><svg class=\"strip\" viewBox=\"0 0 535 {0:.0}\" role=\"img\" aria-label=\"Possible sizes\">\
         <rect class=\"band\" x=\"{1:.1}\" y=\"0\" width=\"{2:.1}\" height=\"{foot:.0}\"/>\
         <line class=\"zero\" x1=\"{3:.1}\" x2=\"{3:.1}\" y1=\"0\" y2=\"{foot:.0}\"/>",
        foot + 22.0,
        x(-1.0),
        x(1.0) - x(-1.0),
        x(0.0)
    );
    for (i, limit) in all.iter().enumerate() {
        let y = ROW * (i as f64 + 0.5) + 3.0;
        let (stroke, text) = if limit.excluded { ("excluded", " class=\"quiet\"") } else { ("open", "") };
        let _ = write!(svg, "<text{text} x=\"0\" y=\"{:.1}\">{}</text>", y + 4.5, escape(&limit.id));
        let [low, high] = ends(limit).map(|end| end / limit.typical.abs());
        if !low.is_finite() || !high.is_finite() {
            continue;
        }
        let _ = write!(
            svg,
            "<line class=\"{stroke}\" stroke-width=\"5\" x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>",
            x(low) - 1.0,
            x(high) + 1.0
        );
        // An interval beyond the range ends in an arrow.
        for (_, end, sign) in
            [(low, -RANGE, 1.0), (high, RANGE, -1.0)].iter().filter(|(at, end, _)| at / end > 1.0)
        {
            let (tip, back) = (x(*end) - 9.0 * sign, x(*end));
            let _ = write!(
                svg,
                "<path class=\"{stroke}\" fill=\"none\" stroke-width=\"2\" d=\"M{back:.1} {:.1}L{tip:.1} {y:.1}L{back:.1} {:.1}\"/>",
                y - 6.0,
                y + 6.0
            );
        }
    }
    for (multiple, label) in [(-1.0, "-5 %"), (0.0, "0"), (1.0, "5 %")] {
        let _ = write!(
            svg,
            "<text class=\"quiet\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
            x(multiple),
            foot + 16.0
        );
    }
    svg.push_str(
        "</svg><figcaption>Possible sizes in multiples of the size of consequence. An effect of consequence is excluded if its bar \
         is within the shaded band; an arrow marks an interval beyond the figure.</figcaption></figure>\n",
    );
    svg
}

/// Lists confounded covariates.
fn confounding(report: &Report) -> String {
    if report.aliasing.is_empty() {
        return String::new();
    }
    let mut html = "<h3>Confounded covariates</h3><ul>\n".to_owned();
    for pair in &report.aliasing {
        let [a, b] = &pair.covariates;
        let _ = writeln!(
            html,
            "<li>{} and {} (r = {}). An effect of one may be an effect of the other.</li>",
            escape(a),
            escape(b),
            number(pair.correlation, 2)
        );
    }
    html.push_str("</ul>\n");
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(id: &str, parameter: &str, low: f64, high: f64) -> LimitReport {
        LimitReport {
            id: id.to_owned(),
            parameter: parameter.to_owned(),
            low,
            high,
            typical: 0.2,
            shape: std::collections::BTreeMap::new(),
            unit: "N".to_owned(),
            one_sided: id == "guide_drag",
            experiment: "vary it".to_owned(),
            excluded: false,
        }
    }

    #[test]
    fn possible_sizes_have_units() {
        assert_eq!(possible(&limit("guide_drag", "c", -0.1, 0.31)), "c up to 0.310 N");
        assert_eq!(possible(&limit("load_cell_offset", "b", -0.1, 0.31)), "b from -0.100 N to 0.310 N");
        assert_eq!(possible(&limit("switch_local_tension", "present", -0.4, 1.7)), "the whole effect");
        assert_eq!(
            possible(&limit("switch_local_tension", "present", -0.4, 0.25)),
            "up to 25.0 % of the effect"
        );
    }

    #[test]
    fn non_finite_limits_are_not_drawn() {
        for (low, high) in [(f64::NAN, f64::NAN), (f64::NEG_INFINITY, f64::INFINITY), (-9.0, 9.0)] {
            let invalid = limit("load_cell_offset", "b", low, high);
            let html = interval_figure(&[&invalid]) + &table(&[&invalid]);
            assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
        }
    }
}
