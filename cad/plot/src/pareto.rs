//! Threshold against friction ratio of every pattern that was tried, the front that nothing beats, and what was chosen.

use plotters::prelude::*;

use pinswitch_friction::layout_search::{LayoutCandidate, pareto_front};

use super::PlotError;
use super::scale::{drawn_size, fine, shown_at_size};

const OTHERS: RGBColor = RGBColor(150, 160, 175);
const FRONT: RGBColor = RGBColor(178, 74, 0);
const CHOSEN: RGBColor = RGBColor(0, 90, 156);
/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (760, 480);

/// Draws `all` as a self-contained SVG; `chosen` are numbered in their order.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn pareto_svg(all: &[LayoutCandidate], chosen: &[LayoutCandidate]) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, all, chosen).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, SIZE))
}

fn draw(
    svg: &mut String,
    all: &[LayoutCandidate],
    chosen: &[LayoutCandidate],
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, drawn_size(SIZE)).into_drawing_area();
    root.fill(&WHITE)?;
    let at = |c: &LayoutCandidate| Some((c.threshold_n?, c.friction_n));
    let points: Vec<(f64, f64)> = all.iter().filter_map(at).collect();
    let right = points.iter().map(|p| p.0).fold(1.0, f64::max) * 1.05;
    let top = points.iter().map(|p| p.1).fold(1.0, f64::max) * 1.05;
    let mut chart = ChartBuilder::on(&root)
        .margin(fine::<u32>(14))
        .caption("every pin pattern: when it switches, and how much", ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(52))
        .build_cartesian_2d(0.0..right, 1.0..top)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("threshold: load at which silicone makes half of the friction (N)")
        .y_desc("friction at the heaviest load over that of its pins alone")
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;
    chart
        .draw_series(points.iter().map(|p| Circle::new(*p, fine::<i32>(2), OTHERS.mix(0.6).filled())))?
        .label(format!("{} patterns", points.len()))
        .legend(|(x, y)| Circle::new((x + fine::<i32>(11), y), fine::<i32>(3), OTHERS.filled()));
    let front: Vec<(f64, f64)> = pareto_front(all).into_iter().filter_map(at).collect();
    chart
        .draw_series(LineSeries::new(front, FRONT.stroke_width(fine(2))))?
        .label("Pareto front: later and stronger is better")
        .legend(|(x, y)| PathElement::new([(x, y), (x + fine::<i32>(22), y)], FRONT.stroke_width(fine(2))));
    let numbered: Vec<(usize, (f64, f64))> =
        chosen.iter().enumerate().filter_map(|(i, c)| Some((i + 1, at(c)?))).collect();
    chart
        .draw_series(numbered.iter().map(|(_, p)| Circle::new(*p, fine::<i32>(5), CHOSEN.filled())))?
        .label("designs, best first")
        .legend(|(x, y)| Circle::new((x + fine::<i32>(11), y), fine::<i32>(5), CHOSEN.filled()));
    chart.draw_series(numbered.iter().map(|(number, p)| {
        EmptyElement::at(*p)
            + Text::new(
                number.to_string(),
                (fine::<i32>(7), -fine::<i32>(14)),
                ("sans-serif", fine::<i32>(14)).into_font().color(&CHOSEN),
            )
    }))?;
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .margin(fine::<i32>(10))
        .legend_area_size(fine::<u32>(26))
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3).stroke_width(fine(1)))
        .label_font(("sans-serif", fine::<i32>(14)))
        .draw()?;
    root.present()?;
    Ok(())
}
