//! Figures of a calibration: friction per condition, residuals of baseline and augmented model over
//! each covariate, quantiles of the noise, and the left-out error of each series.

mod influence;
mod quantiles;
mod readings;

use std::collections::BTreeMap;
use std::error::Error;

use pinswitch_calibration::Calibration;
use pinswitch_calibration::effects::Covariate;
use pinswitch_calibration::table::{Frame, Point};
use plotters::prelude::*;

use super::PlotError;
use super::scale::drawable;
use influence::influence;
use quantiles::quantiles;
use readings::Readings;

/// Width and height of a condition's figure in pixels.
const CONDITION: (u32, u32) = (440, 300);
/// Width and height of both residual panels in pixels.
const RESIDUAL: (u32, u32) = (900, 320);
/// Width and height of one panel of that size in pixels.
const RESIDUAL_PANEL: (u32, u32) = (450, 320);
/// Colour of the baseline.
pub(super) const BASELINE: RGBColor = RGBColor(190, 80, 20);
/// Colour of the augmented model.
pub(super) const AUGMENTED: RGBColor = RGBColor(0, 90, 156);
const DATA: RGBColor = RGBColor(60, 60, 60);
/// Most points of one residual panel; a table has thousands of rows.
const MAX_POINTS: usize = 900;
/// Bins of a covariate for mean residuals.
const BINS: usize = 24;

/// One figure.
#[derive(Clone, Debug)]
pub struct Plot {
    /// File name.
    pub file: String,
    /// Caption.
    pub caption: String,
    /// Figure as SVG.
    pub svg: String,
}

/// The axis of a covariate.
struct Axis {
    label: String,
    /// Value of a point.
    read: Box<dyn Fn(&Point) -> f64>,
    /// Names of the values 0, 1, ..., if they have names.
    names: Vec<String>,
    /// Whether the values are whole numbers.
    is_count: bool,
}

impl Axis {
    fn new(covariate: Covariate, frame: &Frame) -> Self {
        let (stroke, session, speed) = (frame.stroke_mm, frame.session_s, frame.reference_speed_pct);
        let plain = |label: &str, read: Box<dyn Fn(&Point) -> f64>| Self {
            label: label.to_owned(),
            read,
            names: Vec::new(),
            is_count: false,
        };
        let named = |label: &str, names: Vec<String>, read: Box<dyn Fn(&Point) -> f64>| Self {
            label: label.to_owned(),
            read,
            names,
            is_count: false,
        };
        match covariate {
            Covariate::Load => plain("load (N)", Box::new(|p| p.load_n)),
            Covariate::Repetition => {
                Self { is_count: true, ..plain("repetition", Box::new(|p| p.repetition)) }
            }
            Covariate::Position => plain("position (mm)", Box::new(move |p| p.position * stroke)),
            Covariate::Speed => plain("speed (%)", Box::new(move |p| speed * libm::exp(p.log_speed))),
            Covariate::Dwell => plain(
                "dwell (s)",
                Box::new(|p| pinswitch_friction::published::DWELL_S * libm::exp(p.log_dwell)),
            ),
            Covariate::Time => plain("time (h)", Box::new(move |p| p.time * session / 3600.0)),
            Covariate::Direction => named(
                "direction",
                ["eccentric", "concentric"].map(str::to_owned).to_vec(),
                Box::new(|p| f64::from(u8::from(p.sign > 0.0))),
            ),
            Covariate::Sweep => named(
                "sweep",
                ["loads up", "loads down"].map(str::to_owned).to_vec(),
                Box::new(|p| p.descending),
            ),
            Covariate::Condition => named(
                "condition (number as in its figure)",
                (1..=frame.conditions.len()).map(|n| n.to_string()).collect(),
                Box::new(|p| p.condition as f64),
            ),
        }
    }
}

/// Draws all figures: one per condition, one per covariate that varies, the quantiles of the noise, and
/// the left-out error of each series.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn plots(calibration: &Calibration) -> Result<Vec<Plot>, PlotError> {
    let mut all = Vec::new();
    let failure = |e: Box<dyn Error>| PlotError::new(&*e);
    let frame = &calibration.baseline.model.frame;
    let readings = Readings::new(calibration);
    for (index, condition) in frame.conditions.iter().enumerate() {
        let mut svg = String::new();
        let title = format!("{}: {}", index + 1, condition.name());
        curve(&mut svg, &readings, index, title).map_err(failure)?;
        all.push(Plot { file: format!("condition-{index}.svg"), caption: condition.name(), svg });
    }
    for covariate in Covariate::ALL {
        let axis = Axis::new(covariate, frame);
        let range = readings
            .points
            .iter()
            .map(|p| (axis.read)(p))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |a, x| (a.0.min(x), a.1.max(x)));
        if range.1 - range.0 < 1e-9 {
            continue;
        }
        let mut svg = String::new();
        residual(&mut svg, &readings, &axis, range).map_err(failure)?;
        all.push(Plot {
            file: format!("residual-{}.svg", covariate.as_str()),
            caption: format!(
                "residuals over {}: baseline (left), augmented model (right)",
                covariate.as_str()
            ),
            svg,
        });
    }
    let mut svg = String::new();
    quantiles(&mut svg, &calibration.evidence.standardised_noise()).map_err(failure)?;
    let caption = "quantiles of the noise against Student's t with 5 degrees of freedom".to_owned();
    all.push(Plot { file: "noise-quantiles.svg".to_owned(), caption, svg });
    let mut svg = String::new();
    if influence(&mut svg, calibration, &readings).map_err(failure)?.is_some() {
        let caption = "mean error of each series, predicted from the others".to_owned();
        all.push(Plot { file: "left-out-series.svg".to_owned(), caption, svg });
    }
    Ok(all)
}

/// Draws mean readings per load and direction of one condition, with both models.
fn curve(
    svg: &mut String,
    readings: &Readings<'_>,
    condition: usize,
    title: String,
) -> Result<(), Box<dyn Error>> {
    // Per direction and load: sums of readings, of the baseline and of the augmented model, and
    // their number.
    let mut means: BTreeMap<(bool, u64), [f64; 5]> = BTreeMap::new();
    for (i, p) in readings.points.iter().enumerate().filter(|(_, p)| p.condition == condition) {
        let y = readings.reading_n[i];
        let entry = means.entry((p.sign > 0.0, p.load_n.to_bits())).or_insert([0.0; 5]);
        let values = [p.load_n, y, y - readings.baseline_n[i], y - readings.augmented_n[i], 1.0];
        entry.iter_mut().zip(values).for_each(|(e, v)| *e += v);
    }
    let lines: Vec<(bool, [f64; 4])> = means
        .into_iter()
        .map(|((up, _), [load, y, b, a, n])| (up, [load / n, (y - load) / n, (b - load) / n, (a - load) / n]))
        .collect();
    let span = |i: usize| {
        let low = lines.iter().map(|l| l.1[i]).fold(0.0f64, f64::min);
        let high = lines.iter().map(|l| l.1[i]).fold(0.0f64, f64::max);
        (low, high)
    };
    let (low, high) = (1..4).map(span).fold((0.0f64, 0.0f64), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let root = SVGBackend::with_string(svg, CONDITION).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(8)
        .caption(title, ("sans-serif", 15))
        .x_label_area_size(38)
        .y_label_area_size(50)
        .build_cartesian_2d(drawable(0.0, 1.04 * span(0).1), drawable(1.1 * low - 0.05, 1.1 * high + 0.05))?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("load F (N)").y_desc("T - F (N)").draw()?;
    for up in [false, true] {
        let of = |i: usize| lines.iter().filter(move |l| l.0 == up).map(move |l| (l.1[0], l.1[i]));
        chart.draw_series(LineSeries::new(of(2), BASELINE.stroke_width(2)))?;
        chart.draw_series(LineSeries::new(of(3), AUGMENTED.stroke_width(2)))?;
        chart.draw_series(of(1).map(|at| Circle::new(at, 3, DATA.filled())))?;
    }
    root.present()?;
    Ok(())
}

/// Draws residuals of both models over one covariate, with means, on equal axes.
fn residual(
    svg: &mut String,
    readings: &Readings<'_>,
    axis: &Axis,
    (least, most): (f64, f64),
) -> Result<(), Box<dyn Error>> {
    let xs: Vec<f64> = readings.points.iter().map(|p| (axis.read)(p)).collect();
    let named = !axis.names.is_empty();
    let pad = if named { 0.5 } else { 0.03 * (most - least) };
    let mut sizes: Vec<f64> = readings.baseline_n.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let high = sizes.get(sizes.len() * 995 / 1000).copied().unwrap_or(1.0).max(1e-3) * 1.1;
    let root = SVGBackend::with_string(svg, RESIDUAL).into_drawing_area();
    root.fill(&WHITE)?;
    let stride = readings.len().div_ceil(MAX_POINTS);
    let panels = root.split_evenly((1, 2));
    let sides =
        [(&readings.baseline_n, BASELINE, "baseline"), (&readings.augmented_n, AUGMENTED, "augmented model")];
    for (panel, (residual, colour, title)) in panels.iter().zip(sides) {
        let mut chart = ChartBuilder::on(panel)
            .margin(8)
            .caption(title, ("sans-serif", 14))
            .x_label_area_size(38)
            .y_label_area_size(50)
            .build_cartesian_2d(drawable(least - pad, most + pad), drawable(-high, high))?;
        let format = |x: &f64| name_at(&axis.names, *x);
        let whole = |x: &f64| whole_at(*x);
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(TRANSPARENT).x_desc(&axis.label).y_desc("reading - model (N)");
        if named {
            mesh.x_labels(2 * axis.names.len() + 1).x_label_formatter(&format).disable_x_mesh();
        }
        if axis.is_count {
            mesh.x_labels(counts_between(least, most)).x_label_formatter(&whole);
        }
        mesh.draw()?;
        let shown = (0..xs.len()).step_by(stride).filter(|i| residual[*i].abs() < high);
        // Points of named values are spread horizontally, since they would cover each other.
        let spread = |i: usize| if named { 0.3 * ((i * 37 % 101) as f64 / 50.0 - 1.0) } else { 0.0 };
        chart.draw_series(
            shown.map(|i| Circle::new((xs[i] + spread(i), residual[i]), 2, colour.mix(0.3).filled())),
        )?;
        chart.draw_series(LineSeries::new([(least - pad, 0.0), (most + pad, 0.0)], BLACK.stroke_width(1)))?;
        let means = means(&xs, residual, &readings.weights, least, most);
        if !named {
            chart.draw_series(LineSeries::new(means.iter().copied(), colour.stroke_width(2)))?;
        }
        chart.draw_series(means.iter().map(|at| Circle::new(*at, 4, colour.filled())))?;
    }
    root.present()?;
    Ok(())
}

/// Returns the name of a value on the axis; empty between two values.
fn name_at(names: &[String], x: f64) -> String {
    let near = x.round();
    if (x - near).abs() > 0.05 || near < 0.0 {
        return String::new();
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small whole number >= 0")]
    names.get(near as usize).cloned().unwrap_or_default()
}

/// Formats a count on the axis; empty between two counts.
fn whole_at(x: f64) -> String {
    if (x - x.round()).abs() < 1e-6 { format!("{:.0}", x.round() + 0.0) } else { String::new() }
}

/// Returns the number of labels on an axis of counts: one per count, at most 12.
fn counts_between(least: f64, most: f64) -> usize {
    const MAX: f64 = 12.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 12")]
    let labels = (most.floor() - least.ceil() + 1.0).clamp(1.0, MAX) as usize;
    labels
}

/// Returns weighted means of the residuals in bins of a covariate.
fn means(xs: &[f64], residual: &[f64], weights: &[f64], least: f64, most: f64) -> Vec<(f64, f64)> {
    let mut sums = vec![[0.0; 3]; BINS];
    for ((x, r), w) in xs.iter().zip(residual).zip(weights) {
        let share = (x - least) / (most - least).max(1e-12) * BINS as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to the number of bins"
        )]
        let at = (share.max(0.0) as usize).min(BINS - 1);
        sums[at][0] += w;
        sums[at][1] += w * x;
        sums[at][2] += w * r;
    }
    sums.iter().filter(|s| s[0] > 0.5).map(|s| (s[1] / s[0], s[2] / s[0])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_numbers() {
        assert_eq!([1.0, 1.5, 12.0, -0.0].map(whole_at), ["1", "", "12", "0"]);
        assert_eq!(
            (counts_between(1.0, 5.0), counts_between(1.0, 400.0), counts_between(1.0, 1.5)),
            (5, 12, 1)
        );
    }

    #[test]
    fn each_count_has_a_tick() {
        for most in [2.0, 3.0, 5.0, 10.0, 60.0] {
            let mut svg = String::new();
            {
                let root = SVGBackend::with_string(&mut svg, RESIDUAL).into_drawing_area();
                let pad = 0.03 * (most - 1.0);
                let mut chart = ChartBuilder::on(&root)
                    .x_label_area_size(38)
                    .build_cartesian_2d(drawable(1.0 - pad, most + pad), drawable(0.0, 1.0))
                    .unwrap();
                let mut mesh = chart.configure_mesh();
                let whole = |x: &f64| whole_at(*x);
                mesh.x_labels(counts_between(1.0, most)).x_label_formatter(&whole).draw().unwrap();
                root.present().unwrap();
            }
            let texts: Vec<&str> = svg.lines().map(str::trim).filter(|l| l.parse::<f64>().is_ok()).collect();
            assert!(texts.len() >= 2 && texts.iter().all(|t| !t.contains('.')), "{most}: {texts:?}");
            if most <= 12.0 {
                assert!(texts.len() as f64 >= most / 2.0, "{most}: {texts:?}");
            }
        }
    }
}
