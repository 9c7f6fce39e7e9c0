//! The mean error of each series that is predicted from the others.

use std::collections::BTreeMap;
use std::error::Error;

use pinswitch_calibration::Calibration;
use plotters::prelude::*;

use super::super::scale::drawable;
use super::readings::Readings;
use super::{AUGMENTED, BASELINE, RESIDUAL};

/// Labels on the axis of series.
const LABELS: usize = 12;

/// Draws the mean left-out error of each series and direction, in the order of recording; `None` if the
/// series cannot be predicted from each other.
pub(super) fn influence(
    svg: &mut String,
    calibration: &Calibration,
    readings: &Readings<'_>,
) -> Result<Option<()>, Box<dyn Error>> {
    let Some(left_out_n) = calibration.evidence.left_out_residuals_n() else { return Ok(None) };
    let mut sums: BTreeMap<(usize, bool), (f64, f64)> = BTreeMap::new();
    for i in 0..readings.len() {
        let sum = sums.entry((readings.series[i], readings.points[i].sign > 0.0)).or_insert((0.0, 0.0));
        *sum = (sum.0 + left_out_n[readings.rows[i]], sum.1 + 1.0);
    }
    let means: Vec<(usize, bool, f64)> = sums
        .into_iter()
        .map(|((series, up), (sum, count))| (series, up, sum / count))
        .filter(|(.., mean)| mean.is_finite())
        .collect();
    let count = means.iter().map(|(series, ..)| series + 1).max().unwrap_or(1) as f64;
    let high = means.iter().map(|(.., mean)| mean.abs()).fold(1e-3, f64::max) * 1.1;
    let root = SVGBackend::with_string(svg, RESIDUAL).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(8)
        .x_label_area_size(38)
        .y_label_area_size(50)
        .build_cartesian_2d(drawable(0.0, count + 1.0), drawable(-high, 1.3 * high))?;
    let whole = |x: &f64| super::whole_at(*x);
    // Without a negative zero.
    let rounded = |y: &f64| format!("{}", (1e6 * y).round() / 1e6 + 0.0);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(LABELS)
        .x_label_formatter(&whole)
        .y_label_formatter(&rounded)
        .x_desc("series, in the order of the session")
        .y_desc("mean of reading - prediction (N)")
        .draw()?;
    chart.draw_series(LineSeries::new([(0.0, 0.0), (count + 1.0, 0.0)], BLACK.stroke_width(1)))?;
    for (direction, colour, label) in [(false, AUGMENTED, "eccentric"), (true, BASELINE, "concentric")] {
        let of = means.iter().filter(|(_, up, _)| *up == direction);
        let at = |series: usize| series as f64 + 1.0 + if direction { 0.15 } else { -0.15 };
        let stems = of.clone().map(|(series, _, mean)| {
            PathElement::new([(at(*series), 0.0), (at(*series), *mean)], colour.mix(0.5))
        });
        chart.draw_series(stems)?;
        chart
            .draw_series(of.map(|(series, _, mean)| Circle::new((at(*series), *mean), 3, colour.filled())))?
            .label(label)
            .legend(move |at| Circle::new(at, 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .draw()?;
    root.present()?;
    Ok(Some(()))
}
