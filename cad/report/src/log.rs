//! The figure of a raw log with its plateaus.

use std::error::Error;

use pinswitch_calibration::segmentation::{Log, Segmented};
use pinswitch_friction::Direction;
use plotters::prelude::*;

use super::PlotError;
use super::scale::drawable;

/// Width and height in pixels.
const SIZE: (u32, u32) = (1100, 360);
/// Most sections of the curve; each shows its lowest and its highest sample.
const MAX_SECTIONS: usize = 900;
/// Colours of the force, of the moves by direction, and of moves that are left out.
const FORCE: RGBColor = RGBColor(150, 150, 150);
const ECCENTRIC: RGBColor = RGBColor(190, 80, 20);
const CONCENTRIC: RGBColor = RGBColor(0, 90, 156);
const LEFT_OUT: RGBColor = RGBColor(200, 0, 60);
/// Opacity of the band of a move, so that the curve remains visible.
const BAND_OPACITY: f64 = 0.25;
/// Distance of the crosses from the upper end of the figure, as a share of its height.
const CROSS_SHARE: f64 = 0.06;
/// Places of the legend in pixels.
const LEGEND_X: [i32; 3] = [70, 160, 255];
const LEGEND_Y: i32 = 20;
/// Least width of the band of a move, as a share of the log.
const MIN_BAND: f64 = 0.003;

/// Draws a log as an SVG titled `name`: force over time, with a band at each move in the colour of
/// its direction, a mark at each plateau, and a cross at each move that is left out.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn log_svg(name: &str, log: &Log, segmented: &Segmented) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, name, log, segmented).map_err(|e| PlotError::new(&*e))?;
    Ok(svg)
}

/// Returns the colour of a direction.
fn colour(direction: Option<Direction>) -> RGBColor {
    match direction {
        Some(Direction::Eccentric) => ECCENTRIC,
        Some(Direction::Concentric) => CONCENTRIC,
        None => LEFT_OUT,
    }
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
    let (bottom, top) = (least - pad, most + pad);
    let end = log.time_s.last().copied().unwrap_or(1.0);
    let title = format!("{name}: {} by {}", segmented.motion.as_str(), segmented.source.as_str());
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(10)
        .caption(title, ("sans-serif", 16))
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(drawable(0.0, end), drawable(bottom, top))?;
    chart.configure_mesh().light_line_style(TRANSPARENT).x_desc("time (s)").y_desc("force (N)").draw()?;
    chart.draw_series(segmented.moves.iter().map(|m| {
        let to_s = m.to_s.max(m.from_s + MIN_BAND * end);
        Rectangle::new([(m.from_s, bottom), (to_s, top)], colour(m.direction).mix(BAND_OPACITY).filled())
    }))?;
    chart.draw_series(LineSeries::new(line, FORCE.stroke_width(1)))?;
    chart.draw_series(
        segmented
            .plateaus
            .iter()
            .map(|p| Circle::new((p.time_s, p.force_n), 3, colour(Some(p.direction)).filled())),
    )?;
    let left_out: Vec<f64> =
        segmented.moves.iter().filter(|m| m.direction.is_none()).map(|m| m.from_s).collect();
    chart.draw_series(left_out.iter().map(|from_s| {
        Cross::new((*from_s, top - CROSS_SHARE * (top - bottom)), 6, LEFT_OUT.stroke_width(2))
    }))?;
    let mut legend = vec![
        ("eccentric".to_owned(), Some(Direction::Eccentric)),
        ("concentric".to_owned(), Some(Direction::Concentric)),
    ];
    if !left_out.is_empty() {
        legend.push((format!("left out ({})", left_out.len()), None));
    }
    // Next to the title, where it hides no part of the curve.
    for ((text, direction), x) in legend.into_iter().zip(LEGEND_X) {
        root.draw(&Circle::new((x, LEGEND_Y), 4, colour(direction).filled()))?;
        root.draw(&Text::new(text, (x + 9, LEGEND_Y - 7), ("sans-serif", 13)))?;
    }
    root.present()?;
    Ok(())
}
