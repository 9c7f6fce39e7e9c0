//! The figure of a raw log with its plateaus.

use std::error::Error;

use pinswitch_calibration::segmentation::{Log, Segmented};
use plotters::prelude::*;

use super::PlotError;
use super::scale::drawable;

/// Width and height in pixels.
const SIZE: (u32, u32) = (1100, 360);
/// Most sections of the curve; each shows its lowest and its highest sample.
const MAX_SECTIONS: usize = 900;

/// Draws a log as an SVG titled `name`: force over time, with a mark at each plateau.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn log_svg(name: &str, log: &Log, segmented: &Segmented) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, name, log, segmented).map_err(|e| PlotError::new(&*e))?;
    Ok(svg)
}

fn draw(svg: &mut String, name: &str, log: &Log, segmented: &Segmented) -> Result<(), Box<dyn Error>> {
    let mut line = Vec::new();
    let section = log.time_s.len().div_ceil(MAX_SECTIONS).max(1);
    for (t, f) in log.time_s.chunks(section).zip(log.force_n.chunks(section)) {
        let low = f.iter().copied().fold(f64::INFINITY, f64::min);
        let high = f.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        line.extend([(t[0], low), (t[0], high)]);
    }
    let plateaus: Vec<f64> = segmented.plateaus.iter().map(|p| p.force_n).collect();
    let least = plateaus.iter().copied().fold(f64::INFINITY, f64::min).min(1e6);
    let most = plateaus.iter().copied().fold(f64::NEG_INFINITY, f64::max).max(-1e6);
    let pad = 0.25 * (most - least).abs().max(0.5);
    let end = log.time_s.last().copied().unwrap_or(1.0);
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(10)
        .caption(name, ("sans-serif", 16))
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(drawable(0.0, end), drawable(least - pad, most + pad))?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("time (s)").y_desc("force (N)").draw()?;
    chart.draw_series(LineSeries::new(line, RGBColor(150, 150, 150).stroke_width(1)))?;
    chart.draw_series(segmented.plateaus.iter().map(|p| {
        let colour = if p.direction.sign() > 0.0 { RGBColor(190, 80, 20) } else { RGBColor(0, 90, 156) };
        Circle::new((p.time_s, p.force_n), 3, colour.filled())
    }))?;
    root.present()?;
    Ok(())
}
