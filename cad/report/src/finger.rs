//! The figure of a finger with a switch: force difference over load and over the joint angle,
//! compared with the human finger.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use pinswitch_friction::finger::{FingerPoint, Gain, JointCurve, MeasuredGain};
use pinswitch_friction::published;
use pinswitch_friction::published::{HUMAN_FORCE_DIFFERENCE, HUMAN_PEAK_DIFFERENCE, HUMAN_PEAK_JOINT_DEG};

use super::PlotError;
use super::scale::{drawable, drawn_size, fine, shown_at_size};

/// Width and height of the panels in pixels.
const PANELS: (u32, u32) = (960, 400);
/// Height of a row of the legend in pixels.
const ROW: u8 = 21;
/// Columns of the legend.
const COLUMNS: usize = 3;
/// Most letters of a name in the legend.
const NAME_LETTERS: usize = 30;
/// Okabe and Ito's palette, distinct for colour-blind readers; repeated.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(90, 90, 90),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];
/// Dash and gap in pixels, so that lines also differ without colour; a line without a gap is solid.
const DASHES: [(u8, u8); 4] = [(1, 0), (9, 4), (4, 3), (12, 2)];
/// Note on a layout whose wrap over the joint is computed.
const JOINT_NOTE: &str = " (joint as built)";
const HUMAN: RGBColor = RGBColor(230, 159, 0);
/// Opacity of a band.
const BAND: f64 = 0.13;
/// Ticks of the second axis: extra holding in percent.
const EXTRA_TICKS: [f64; 8] = [0.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 50.0];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Failed = Box<dyn std::error::Error>;

/// One part in the figure.
#[derive(Clone, Copy, Debug)]
pub struct FingerLayout<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Wrap angle of the curve over load, degrees.
    pub wrap_deg: f64,
    /// Gains over load.
    pub over_load: &'a [FingerPoint],
    /// Measured gains.
    pub measured: &'a [MeasuredGain],
    /// Gains over the joint angle, by ascending load; only the last one is drawn with its band.
    pub over_joint: &'a [JointCurve],
    /// Flexion of the measured points, degrees.
    pub measured_joint_deg: Option<f64>,
    /// Whether the wrap over the joint is computed from the parts of a joint.
    pub has_joint: bool,
}

/// Draws the force differences of `layouts` as a self-contained SVG of two panels: over load and
/// over the joint angle.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn finger_svg(layouts: &[FingerLayout<'_>]) -> Result<String, PlotError> {
    let entries = legend_entries(layouts);
    let rows = u32::try_from(entries.len().div_ceil(COLUMNS)).unwrap_or(u32::MAX);
    let size = (PANELS.0, PANELS.1.saturating_add(rows.saturating_mul(u32::from(ROW)) + 14));
    let mut svg = String::new();
    draw(&mut svg, size, layouts, &entries).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, size))
}

fn draw(
    svg: &mut String,
    size: (u32, u32),
    layouts: &[FingerLayout<'_>],
    entries: &[Entry],
) -> Result<(), Failed> {
    let root = SVGBackend::with_string(svg, drawn_size(size)).into_drawing_area();
    root.fill(&WHITE)?;
    let (panels, legend) = root.split_vertically(PANELS.1 * fine::<u32>(1));
    let (left, right) = panels.split_horizontally(PANELS.0 * fine::<u32>(1) * 47 / 100);
    let heaviest_n = layouts.iter().filter_map(|l| l.over_load.last()).map(|p| p.load_n).fold(0.0, f64::max);
    let joints = || layouts.iter().flat_map(|l| l.over_joint).flat_map(|c| &c.points);
    let max_deg = joints().map(|p| p.joint_deg).fold(0.0, f64::max);
    let min_deg = joints().map(|p| p.joint_deg).fold(max_deg, f64::min);
    let top = top(layouts);
    let over_load = Panel {
        title: format!("(a)  over load{}", common("wrap", "deg", layouts.iter().map(|l| l.wrap_deg), 2)),
        x_title: "load F (N)",
        x: (0.0, heaviest_n * 1.03),
        top,
        second_axis: false,
    };
    over_load.draw(&left, |chart| {
        let points =
            |l: &FingerLayout<'_>| l.over_load.iter().map(|p| (p.load_n, p.force_difference)).collect();
        curves(chart, &layouts.iter().map(points).collect::<Vec<Points>>(), top)?;
        for (index, layout) in layouts.iter().enumerate() {
            for measured in layout.measured {
                marker(chart, index, (measured.load_n, 100.0 * measured.force_difference))?;
            }
        }
        Ok(())
    })?;
    let joint_loads = layouts.iter().filter_map(|l| l.over_joint.last()).map(|c| c.load_n);
    let over_joint = Panel {
        title: format!("(b)  over the joint angle{}", common("load", "N", joint_loads, 1)),
        x_title: "flexion of the joint (deg)",
        x: (min_deg, max_deg.max(min_deg + 1.0)),
        top,
        second_axis: true,
    };
    over_joint.draw(&right, |chart| {
        let points =
            |c: &JointCurve| c.points.iter().map(|p| (p.joint_deg, p.gains.force_difference)).collect();
        let heaviest = |l: &FingerLayout<'_>| l.over_joint.last().map(points).unwrap_or_default();
        curves(chart, &layouts.iter().map(heaviest).collect::<Vec<Points>>(), top)?;
        for (index, layout) in layouts.iter().enumerate() {
            for lighter in layout.over_joint.iter().rev().skip(1) {
                line(chart, index, &points(lighter), top, 1)?;
            }
        }
        for (index, layout) in layouts.iter().enumerate() {
            let heaviest_n = layout.over_joint.last().map_or(0.0, |c| c.load_n);
            let here = layout.measured.iter().filter(|m| (m.load_n - heaviest_n).abs() < 1.0);
            for (joint_deg, measured) in layout.measured_joint_deg.into_iter().zip(here) {
                marker(chart, index, (joint_deg, 100.0 * measured.force_difference))?;
            }
        }
        if (min_deg..=max_deg).contains(&HUMAN_PEAK_JOINT_DEG) {
            let at = (HUMAN_PEAK_JOINT_DEG, 100.0 * HUMAN_PEAK_DIFFERENCE);
            chart.draw_series([TriangleMarker::new(at, fine::<i32>(7), BLACK.filled())])?;
        }
        Ok(())
    })?;
    draw_legend(&legend, entries)?;
    root.present()?;
    Ok(())
}

/// Returns `, wrap 63.89 deg` if all layouts have the same value, or else nothing.
fn common(what: &str, unit: &str, values: impl Iterator<Item = f64>, digits: usize) -> String {
    let mut texts: Vec<String> = values.map(|v| format!(", {what} {v:.digits$} {unit}")).collect();
    texts.dedup();
    if texts.len() == 1 { texts.remove(0) } else { String::new() }
}

/// Top of both panels in percent: 15 % above the lines and the measured points. Wide bands are cut,
/// so that the lines remain distinct.
fn top(layouts: &[FingerLayout<'_>]) -> f64 {
    let over_load = layouts.iter().flat_map(|l| l.over_load).map(|p| p.force_difference.value);
    let over_joint = layouts
        .iter()
        .flat_map(|l| l.over_joint)
        .flat_map(|c| &c.points)
        .map(|p| p.gains.force_difference.value);
    let measured = layouts.iter().flat_map(|l| l.measured).map(|m| m.force_difference);
    let highest = over_load.chain(over_joint).chain(measured).fold(HUMAN_FORCE_DIFFERENCE.1, f64::max);
    drawable(0.0, 115.0 * highest).end
}

/// One panel with its axes and the range of the human finger.
struct Panel {
    title: String,
    x_title: &'static str,
    x: (f64, f64),
    top: f64,
    second_axis: bool,
}

impl Panel {
    fn draw<'b>(
        &self,
        area: &Area<'b>,
        inside: impl FnOnce(&mut Chart<'_, 'b>) -> Result<(), Failed>,
    ) -> Result<(), Failed> {
        let mut chart = ChartBuilder::on(area)
            .margin(fine::<u32>(8))
            .margin_right(if self.second_axis { fine::<u32>(62) } else { fine::<u32>(8) })
            .caption(&self.title, ("sans-serif", fine::<i32>(16)))
            .x_label_area_size(fine::<u32>(44))
            .y_label_area_size(fine::<u32>(54))
            .build_cartesian_2d(drawable(self.x.0, self.x.1), 0.0..self.top)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
            .x_desc(self.x_title)
            .y_desc("force difference (T_c - T_e)/F (%)")
            .x_labels(10)
            .y_labels(10)
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .set_all_tick_mark_size(fine::<u32>(5))
            .axis_style(BLACK.stroke_width(fine(1)))
            .label_style(("sans-serif", fine::<i32>(14)))
            .axis_desc_style(("sans-serif", fine::<i32>(15)))
            .draw()?;
        let human = [HUMAN_FORCE_DIFFERENCE.0, HUMAN_FORCE_DIFFERENCE.1].map(|d| 100.0 * d);
        let strip = Rectangle::new([(self.x.0, human[0]), (self.x.1, human[1])], HUMAN.mix(0.45).filled());
        chart.draw_series([strip])?;
        inside(&mut chart)?;
        if self.second_axis {
            second_axis(area, &chart, self.x.1, self.top)?;
        }
        Ok(())
    }
}

/// Draws the axis of extra holding `e` on the right; the force difference is `d = 2 sinh(ln(1 +
/// e))`.
fn second_axis(area: &Area<'_>, chart: &Chart<'_, '_>, right: f64, top: f64) -> Result<(), Failed> {
    let corner = area.get_base_pixel();
    let at = |difference_pct: f64| {
        let (x, y) = chart.backend_coord(&(right, difference_pct));
        (x - corner.0, y - corner.1)
    };
    let black = BLACK.stroke_width(fine(1));
    area.draw(&PathElement::new([at(0.0), at(top)], black))?;
    let label =
        TextStyle::from(("sans-serif", fine::<i32>(14)).into_font()).pos(Pos::new(HPos::Left, VPos::Center));
    for extra_pct in EXTRA_TICKS {
        let difference_pct = 200.0 * libm::sinh(libm::log1p(extra_pct / 100.0));
        if difference_pct < top {
            let (x, y) = at(difference_pct);
            area.draw(&PathElement::new([(x, y), (x + fine::<i32>(5), y)], black))?;
            area.draw(&Text::new(format!("{extra_pct:.0}"), (x + fine::<i32>(9), y), label.clone()))?;
        }
    }
    let (x, y) = at(top / 2.0);
    let turned =
        TextStyle::from(("sans-serif", fine::<i32>(15)).into_font().transform(FontTransform::Rotate90))
            .pos(Pos::new(HPos::Center, VPos::Bottom));
    area.draw(&Text::new("extra holding F/T_e - 1 (%)", (x + fine::<i32>(36), y), turned))?;
    Ok(())
}

/// Points of a line: coordinate, and gain with its band.
type Points = Vec<(f64, Gain)>;

fn percent(share: f64, top: f64) -> f64 {
    (100.0 * share).min(top)
}

/// Draws the bands of all layouts, then their lines: a band over a line would change its colour.
fn curves(chart: &mut Chart<'_, '_>, layouts: &[Points], top: f64) -> Result<(), Failed> {
    for (index, points) in layouts.iter().enumerate().filter(|(_, points)| points.len() > 1) {
        let upper = points.iter().map(|(x, gain)| (*x, percent(gain.high, top)));
        let lower = points.iter().rev().map(|(x, gain)| (*x, percent(gain.low, top)));
        let colour = COLOURS[index % COLOURS.len()].mix(BAND);
        chart.draw_series([Polygon::new(upper.chain(lower).collect::<Vec<_>>(), colour.filled())])?;
    }
    layouts.iter().enumerate().try_for_each(|(index, points)| line(chart, index, points, top, 2))
}

/// Draws one line, `width` pixels wide.
fn line(chart: &mut Chart<'_, '_>, index: usize, points: &Points, top: f64, width: u8) -> Result<(), Failed> {
    let line = points.iter().map(|(x, gain)| (*x, percent(gain.value, top)));
    let style = COLOURS[index % COLOURS.len()].stroke_width(fine(width));
    match DASHES[index % DASHES.len()] {
        (_, 0) => chart.draw_series(LineSeries::new(line, style)).map(drop)?,
        (dash, gap) => chart
            .draw_series(DashedLineSeries::new(line, fine::<u32>(dash), fine::<u32>(gap), style))
            .map(drop)?,
    }
    Ok(())
}

/// Draws a measured point in the colour of its line.
fn marker(chart: &mut Chart<'_, '_>, index: usize, at: (f64, f64)) -> Result<(), Failed> {
    chart.draw_series([Circle::new(at, fine::<i32>(5), COLOURS[index % COLOURS.len()].filled())])?;
    chart.draw_series([Circle::new(at, fine::<i32>(5), BLACK.stroke_width(fine(1)))])?;
    Ok(())
}

/// Sample of an entry of the legend.
enum Sample {
    /// The line of a layout.
    Line(usize),
    /// The thin line of a light load.
    Thin,
    Band,
    Measured,
    HumanStrip,
    HumanPeak,
}

struct Entry {
    sample: Sample,
    text: String,
}

fn legend_entries(layouts: &[FingerLayout<'_>]) -> Vec<Entry> {
    let entry = |sample, text: String| Entry { sample, text };
    let mut entries: Vec<Entry> = layouts
        .iter()
        .enumerate()
        .map(|(index, layout)| {
            let mut text: String = layout.name.chars().take(NAME_LETTERS).collect();
            if text.len() < layout.name.len() {
                text.push('…');
            }
            if layout.has_joint {
                text.push_str(JOINT_NOTE);
            }
            entry(Sample::Line(index), text)
        })
        .collect();
    entries.push(entry(Sample::Band, "95 % band of each line".to_owned()));
    let light = layouts.iter().filter(|l| l.over_joint.len() > 1).find_map(|l| l.over_joint.first());
    if let Some(light) = light {
        entries.push(entry(Sample::Thin, format!("thin lines in (b): at {:.1} N", light.load_n)));
    }
    if layouts.iter().any(|l| !l.measured.is_empty()) {
        entries.push(entry(
            Sample::Measured,
            format!("measured maximum, wrap {} deg", published::WRAP_ANGLE_DEG),
        ));
    }
    let percent = |share: f64| format!("{:.0}", 100.0 * share);
    let (low, high) = HUMAN_FORCE_DIFFERENCE;
    entries.push(entry(Sample::HumanStrip, format!("human finger, {} to {} %", percent(low), percent(high))));
    entries.push(entry(
        Sample::HumanPeak,
        format!("human maximum, {} % at {HUMAN_PEAK_JOINT_DEG:.0} deg", percent(HUMAN_PEAK_DIFFERENCE)),
    ));
    entries
}

fn draw_legend(area: &Area<'_>, entries: &[Entry]) -> Result<(), Failed> {
    let width = i32::try_from(area.dim_in_pixel().0).unwrap_or(i32::MAX);
    let first = fine::<i32>(62);
    let column = (width - first) / COLUMNS as i32;
    let text =
        TextStyle::from(("sans-serif", fine::<i32>(14)).into_font()).pos(Pos::new(HPos::Left, VPos::Center));
    let black = BLACK.stroke_width(fine(1));
    for (number, entry) in (0i32..).zip(entries) {
        let (x, y) = (
            first + (number % COLUMNS as i32) * column,
            (number / COLUMNS as i32) * fine::<i32>(ROW) + fine::<i32>(ROW) / 2,
        );
        let (end, half) = (x + fine::<i32>(34), fine::<i32>(5));
        let middle = (i32::midpoint(x, end), y);
        match entry.sample {
            Sample::Line(index) => {
                let style = COLOURS[index % COLOURS.len()].stroke_width(fine(2));
                let (dash, gap) = DASHES[index % DASHES.len()];
                let step = if gap == 0 { end - x } else { fine::<i32>(dash) + fine::<i32>(gap) };
                let long = if gap == 0 { end - x } else { fine::<i32>(dash) };
                let mut from = x;
                while from < end {
                    area.draw(&PathElement::new([(from, y), ((from + long).min(end), y)], style))?;
                    from += step;
                }
            }
            Sample::Thin => {
                area.draw(&PathElement::new([(x, y), (end, y)], BLACK.mix(0.7).stroke_width(fine(1))))?;
            }
            Sample::Band => {
                let colour = COLOURS[0].mix(2.0 * BAND);
                area.draw(&Rectangle::new([(x, y - half), (end, y + half)], colour.filled()))?;
            }
            Sample::Measured => {
                area.draw(&Circle::new(middle, half, WHITE.filled()))?;
                area.draw(&Circle::new(middle, half, black))?;
            }
            Sample::HumanStrip => {
                area.draw(&Rectangle::new([(x, y - half), (end, y + half)], HUMAN.mix(0.45).filled()))?;
            }
            Sample::HumanPeak => {
                area.draw(&TriangleMarker::new(middle, fine::<i32>(7), BLACK.filled()))?;
            }
        }
        area.draw(&Text::new(entry.text.clone(), (end + fine::<i32>(8), y), text.clone()))?;
    }
    Ok(())
}
