//! What a table excludes: sizes of absent effects that remain possible, and what this design cannot tell apart.

use std::fmt::Write;

use pinswitch_calibration::effects::effect_named;
use pinswitch_calibration::{LimitReport, Report};

use pinswitch_friction::sort_by_number;

use super::super::html::escape;
use super::number::{number, short, with_unit};

/// Multiples of the size of consequence that the strips show to either side.
const REACH: f64 = 3.0;
/// Height of one strip in pixels.
const ROW: f64 = 24.0;
/// Where the strips begin and end, in pixels.
const STRIPS: (f64, f64) = (170.0, 525.0);

/// Limits that leave room for an effect of consequence, the widest first.
pub(super) fn open_limits(report: &Report) -> Vec<&LimitReport> {
    let mut open: Vec<&LimitReport> = report.limits.iter().filter(|l| !l.excluded).collect();
    sort_by_number(&mut open, |limit| -reach(limit));
    open
}

/// Largest possible size, in sizes of consequence.
fn reach(limit: &LimitReport) -> f64 {
    let [low, high] = ends(limit);
    (low.abs().max(high.abs()) / limit.typical.abs()).min(f64::MAX)
}

/// The interval, without the side on which the effect cannot be.
fn ends(limit: &LimitReport) -> [f64; 2] {
    let present = limit.parameter == "present";
    let low = if limit.one_sided || present { limit.low.max(0.0) } else { limit.low };
    [low, if present { limit.high.clamp(0.0, 1.0) } else { limit.high.max(low) }]
}

/// The sizes that remain possible, in words.
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

/// The size of consequence, in words.
pub(super) fn typical(limit: &LimitReport) -> String {
    match limit.parameter.as_str() {
        "present" if limit.typical >= 1.0 => "more than the whole effect".to_owned(),
        "present" => format!("{} of the effect", with_unit(limit.typical, "1")),
        name => format!("{} = {}", escape(name), sized(limit.typical, &limit.unit)),
    }
}

/// A size with its unit; a number without one stands alone, since it need not be a share.
fn sized(value: f64, unit: &str) -> String {
    if unit == "1" { short(value) } else { with_unit(value, unit) }
}

/// The section.
pub(super) fn limits(report: &Report) -> String {
    let mut html = "<h2>8. What this data excludes</h2>\n".to_owned();
    if report.limits.is_empty() {
        html.push_str("<p>Nothing: it can see no effect beside those found.</p>\n");
    } else {
        html.push_str(
            "<p>Each effect that this data can see and that was not found: the sizes that 95 % do not exclude, against the size that \
             would change friction or reading by 5 % somewhere in the table. An effect is excluded if only smaller sizes are left.</p>\n",
        );
        let all = sorted(report);
        // A limit of the cell is no interval about zero, and has no place on the strips.
        let about_zero = |l: &LimitReport| {
            effect_named(&l.id).is_none_or(|e| e.description().scales || e.parameters().is_empty())
        };
        html.push_str(&strips(&all.iter().copied().filter(|l| about_zero(l)).collect::<Vec<_>>()));
        html.push_str(&table(&all));
    }
    html.push_str(&together(report));
    html
}

/// Open limits first, the widest first.
fn sorted(report: &Report) -> Vec<&LimitReport> {
    let mut excluded: Vec<&LimitReport> = report.limits.iter().filter(|l| l.excluded).collect();
    sort_by_number(&mut excluded, |limit| -reach(limit));
    open_limits(report).into_iter().chain(excluded).collect()
}

fn table(all: &[&LimitReport]) -> String {
    let mut html = "<div class=\"wide\"><table><tr><th>effect</th><th>sizes left</th><th>size of consequence</th><th></th></tr>\n"
        .to_owned();
    for limit in all {
        let (class, word) = if limit.excluded { (" class=\"soft\"", "excluded") } else { ("", "open") };
        let typical = typical(limit);
        let _ = writeln!(
            html,
            "<tr{class}><td>{}</td><td>{}</td><td>{typical}</td><td>{word}</td></tr>",
            escape(&limit.id),
            possible(limit)
        );
    }
    html.push_str("</table></div>\n");
    html
}

/// Intervals over multiples of the size of consequence, one strip each.
fn strips(all: &[&LimitReport]) -> String {
    let (left, right) = STRIPS;
    let x = |multiple: f64| left + (right - left) * (multiple.clamp(-REACH, REACH) + REACH) / (2.0 * REACH);
    let foot = ROW * all.len() as f64 + 6.0;
    let mut svg = format!(
        "<figure class=\"wide\"><svg class=\"strip\" viewBox=\"0 0 535 {0:.0}\" role=\"img\" aria-label=\"Sizes that remain possible\">\
         <rect class=\"band\" x=\"{1:.1}\" y=\"0\" width=\"{2:.1}\" height=\"{foot:.0}\"/>\
         <line class=\"zero\" x1=\"{3:.1}\" x2=\"{3:.1}\" y1=\"0\" y2=\"{foot:.0}\"/>",
        foot + 22.0,
        x(-1.0),
        x(1.0) - x(-1.0),
        x(0.0)
    );
    for (i, limit) in all.iter().enumerate() {
        let y = ROW * (i as f64 + 0.5) + 3.0;
        let (stroke, text) = if limit.excluded { ("shut", " class=\"quiet\"") } else { ("open", "") };
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
        // What goes on beyond the figure ends in an arrow.
        for (_, end, sign) in
            [(low, -REACH, 1.0), (high, REACH, -1.0)].iter().filter(|(at, end, _)| at / end > 1.0)
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
    for (multiple, word) in [(-1.0, "-5 %"), (0.0, "0"), (1.0, "5 %")] {
        let _ = write!(
            svg,
            "<text class=\"quiet\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{word}</text>",
            x(multiple),
            foot + 16.0
        );
    }
    svg.push_str(
        "</svg><figcaption>Sizes that remain possible, in multiples of the size of consequence. Where a bar stays inside the \
         shaded band, nothing of consequence can hide; an arrow goes on.</figcaption></figure>\n",
    );
    svg
}

/// Effects and covariates that this design cannot tell apart.
fn together(report: &Report) -> String {
    if report.classes.is_empty() && report.aliasing.is_empty() {
        return String::new();
    }
    let mut html = "<h3>What this design cannot tell apart</h3><ul>\n".to_owned();
    for class in &report.classes {
        let _ = writeln!(
            html,
            "<li>{}: after the refit their traces are the same. Whichever of them is named, or left open, it may be another of them.</li>",
            escape(&class.join(", "))
        );
    }
    for pair in &report.aliasing {
        let [a, b] = &pair.covariates;
        let _ = writeln!(
            html,
            "<li>{} and {} move together (correlation {}): whatever lies in one may lie in the other.</li>",
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
    fn sizes_are_told_in_words_with_their_unit() {
        assert_eq!(possible(&limit("guide_drag", "c", -0.1, 0.31)), "c up to 0.310 N");
        assert_eq!(possible(&limit("load_cell_offset", "b", -0.1, 0.31)), "b from -0.100 N to 0.310 N");
        assert_eq!(possible(&limit("switch_local_tension", "present", -0.4, 1.7)), "the whole effect");
        assert_eq!(
            possible(&limit("switch_local_tension", "present", -0.4, 0.25)),
            "up to 25.0 % of the effect"
        );
    }

    #[test]
    fn what_is_no_number_is_not_drawn() {
        for (low, high) in [(f64::NAN, f64::NAN), (f64::NEG_INFINITY, f64::INFINITY), (-9.0, 9.0)] {
            let odd = limit("load_cell_offset", "b", low, high);
            let html = strips(&[&odd]) + &table(&[&odd]);
            assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
        }
    }
}
