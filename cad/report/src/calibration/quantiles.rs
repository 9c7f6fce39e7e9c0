//! Quantiles of the repetition noise against those of the distribution that the model assumes.

use std::error::Error;
use std::f64::consts::PI;

use plotters::prelude::*;

use super::super::scale::drawable;
use super::{AUGMENTED, RESIDUAL_PANEL};

/// Most points of the figure; a table has thousands of rows.
const MAX_POINTS: usize = 600;
/// Points at each end that are always drawn.
const ALWAYS: usize = 60;

/// Draws the quantiles of standardised noise over those of Student's t with 5 degrees of freedom.
pub(super) fn quantiles(svg: &mut String, standardised: &[f64]) -> Result<(), Box<dyn Error>> {
    let mut values: Vec<f64> = standardised.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let count = values.len();
    let expected = |i: usize| student_quantile((i as f64 + 0.5) / count as f64);
    let stride = count.div_ceil(MAX_POINTS).max(1);
    let is_drawn = |i: &usize| i.is_multiple_of(stride) || *i < ALWAYS || i + ALWAYS >= count;
    let points: Vec<(f64, f64)> = (0..count).filter(is_drawn).map(|i| (expected(i), values[i])).collect();
    let high = points.iter().flat_map(|(x, y)| [x.abs(), y.abs()]).fold(1.0, f64::max) * 1.05;
    let root = SVGBackend::with_string(svg, RESIDUAL_PANEL).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(8)
        .x_label_area_size(38)
        .y_label_area_size(50)
        .build_cartesian_2d(drawable(-high, high), drawable(-high, high))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("quantile of Student's t, 5 degrees of freedom")
        .y_desc("noise of a reading / scale")
        .draw()?;
    chart.draw_series(LineSeries::new([(-high, -high), (high, high)], BLACK.stroke_width(1)))?;
    chart.draw_series(points.into_iter().map(|at| Circle::new(at, 2, AUGMENTED.mix(0.6).filled())))?;
    root.present()?;
    Ok(())
}

/// Returns the quantile of Student's t with 5 degrees of freedom, by bisection of its distribution
/// function (Abramowitz and Stegun 1964, 26.7.3).
fn student_quantile(probability: f64) -> f64 {
    let below = |t: f64| {
        let angle = libm::atan(t / 5.0f64.sqrt());
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        0.5 + (angle + sin * cos * (1.0 + 2.0 / 3.0 * cos * cos)) / PI
    };
    let (mut low, mut high) = (-1e3, 1e3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) < probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of printed tables.
    #[test]
    fn quantiles_match_tables() {
        for (probability, quantile) in [(0.5, 0.0), (0.75, 0.7267), (0.975, 2.5706), (0.995, 4.0321)] {
            assert!((student_quantile(probability) - quantile).abs() < 1e-4, "{probability}");
            assert!((student_quantile(1.0 - probability) + quantile).abs() < 1e-4, "{probability}");
        }
    }
}
