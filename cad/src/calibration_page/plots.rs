//! Plots of a calibration: friction per condition, and residuals over each covariate before and after.

use std::collections::BTreeMap;
use std::error::Error;

use pinswitch_model::calibration::Calibration;
use pinswitch_model::rig::Point;
use plotters::prelude::*;

/// Width and height of a figure in pixels.
const SIZE: (u32, u32) = (860, 420);
const BEFORE: RGBColor = RGBColor(190, 80, 20);
const AFTER: RGBColor = RGBColor(0, 90, 156);
const DATA: RGBColor = RGBColor(60, 60, 60);
/// Points of one residual panel at most; a table has thousands of rows.
const SHOWN: usize = 900;

/// A figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("a plot of the calibration cannot be drawn: {0}")]
pub struct PlotFailure(pub(super) String);

/// One figure.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Name of its file.
    pub file: String,
    /// What it shows.
    pub caption: String,
    /// The figure.
    pub svg: String,
}

/// How a covariate is read off a point.
type Reader = fn(&Point) -> f64;

/// All figures.
///
/// # Errors
/// [`PlotFailure`] if the drawing library refuses a coordinate.
pub fn plots(calibration: &Calibration) -> Result<Vec<Plot>, PlotFailure> {
    let mut all = Vec::new();
    let failure = |e: Box<dyn Error>| PlotFailure(e.to_string());
    for (index, condition) in calibration.selection.baseline.model.frame.conditions.iter().enumerate() {
        let mut svg = String::new();
        curve(&mut svg, calibration, index).map_err(failure)?;
        all.push(Plot {
            file: format!("condition-{index}.svg"),
            caption: format!(
                "Tension minus load on {}: readings, the paper's model, the better model",
                condition.name()
            ),
            svg,
        });
    }
    let covariates: [(&str, Reader); 6] = [
        ("load (N)", |p| p.load_n),
        ("repetition", |p| p.repetition),
        ("position (share of the stroke)", |p| p.position),
        ("ln(speed / mean speed)", |p| p.log_speed),
        ("ln(dwell / 3 s)", |p| p.log_dwell),
        ("time (share of the session)", |p| p.time),
    ];
    for (name, of) in covariates {
        let mut svg = String::new();
        residual(&mut svg, calibration, name, of).map_err(failure)?;
        let word = name.split([' ', '(']).next().unwrap_or(name);
        let word = word.trim_start_matches("ln");
        let word = if word.is_empty() {
            name.trim_start_matches("ln(").split(' ').next().unwrap_or(name)
        } else {
            word
        };
        all.push(Plot {
            file: format!("residual-{word}.svg"),
            caption: format!("Residuals over {name}, before (left) and after (right)"),
            svg,
        });
    }
    Ok(all)
}

/// Mean readings per load and direction of one condition with both models.
fn curve(svg: &mut String, calibration: &Calibration, condition: usize) -> Result<(), Box<dyn Error>> {
    let (data, selection) = (&calibration.data, &calibration.selection);
    // Per direction and load: sums of readings, of the baseline and of the augmented model, and their number.
    let mut means: BTreeMap<(bool, u64), [f64; 5]> = BTreeMap::new();
    for (i, p) in data.points.iter().enumerate().filter(|(_, p)| p.condition == condition) {
        let y = data.force_n[i];
        let entry = means.entry((p.sign > 0.0, p.load_n.to_bits())).or_insert([0.0; 5]);
        let values =
            [p.load_n, y, y - selection.baseline.residual_n[i], y - selection.augmented.residual_n[i], 1.0];
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
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..span(0).1.max(1e-6) * 1.04, low * 1.1 - 0.05..high * 1.1 + 0.05)?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("load F (N)").y_desc("T - F (N)").draw()?;
    for up in [false, true] {
        let of = |i: usize| lines.iter().filter(move |l| l.0 == up).map(move |l| (l.1[0], l.1[i]));
        chart.draw_series(LineSeries::new(of(2), BEFORE.stroke_width(2)))?;
        chart.draw_series(LineSeries::new(of(3), AFTER.stroke_width(2)))?;
        chart.draw_series(of(1).map(|at| Circle::new(at, 4, DATA.filled())))?;
    }
    root.present()?;
    Ok(())
}

/// Residuals over one covariate, before and after, on the same axes.
fn residual(
    svg: &mut String,
    calibration: &Calibration,
    name: &str,
    of: Reader,
) -> Result<(), Box<dyn Error>> {
    let (data, selection) = (&calibration.data, &calibration.selection);
    let xs: Vec<f64> = data.points.iter().map(of).collect();
    let (least, most) = xs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |a, x| (a.0.min(*x), a.1.max(*x)));
    let pad = 0.03 * (most - least).max(1e-3);
    let mut sizes: Vec<f64> = selection.baseline.residual_n.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let high = sizes.get(sizes.len() * 995 / 1000).copied().unwrap_or(1.0).max(1e-3) * 1.1;
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let stride = data.points.len().div_ceil(SHOWN);
    let panels = root.split_evenly((1, 2));
    let sides = [(&selection.baseline.residual_n, BEFORE), (&selection.augmented.residual_n, AFTER)];
    for (panel, (residual, colour)) in panels.iter().zip(sides) {
        let mut chart = ChartBuilder::on(panel)
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(56)
            .build_cartesian_2d(least - pad..most + pad, -high..high)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_desc(name)
            .y_desc("reading - model (N)")
            .draw()?;
        let shown = (0..xs.len()).step_by(stride).filter(|i| residual[*i].abs() < high);
        chart.draw_series(shown.map(|i| Circle::new((xs[i], residual[i]), 2, colour.mix(0.5).filled())))?;
        chart.draw_series(LineSeries::new([(least - pad, 0.0), (most + pad, 0.0)], BLACK.stroke_width(1)))?;
    }
    root.present()?;
    Ok(())
}
