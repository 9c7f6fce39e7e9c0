//! The figure of searched layouts: threshold and friction of each, the Pareto front, and the
//! proposed designs. The legend is on the right; the numbers of designs are placed so that none
//! covers another.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use pinswitch_friction::layout_search::LayoutCandidate;

use super::PlotError;
use super::pareto_front::pareto_front;
use super::scale::{drawable, drawn_size, fine, shown_at_size};

const OTHERS: RGBColor = RGBColor(150, 160, 175);
const FRONT: RGBColor = RGBColor(178, 74, 0);
const PROPOSED: RGBColor = RGBColor(0, 90, 156);
const TARGET: RGBColor = RGBColor(0, 120, 90);
/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (980, 500);
/// Width of the legend in pixels.
const LEGEND: u32 = 250;
/// Half the side of the square around a number, in pixels.
const NUMBER_HALF: i32 = 9;
/// Distance of a second line of a legend entry, in pixels.
const SECOND_LINE: i32 = 18;
/// Radius of the point of a proposed design, in pixels.
const POINT_RADIUS: i32 = 5;

/// Target intervals of both axes; an open end is 0 or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetRegion {
    /// Threshold, N.
    pub threshold_n: (f64, f64),
    /// Friction at the heaviest load, N.
    pub friction_n: (f64, f64),
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failure = Box<dyn std::error::Error>;

/// Draws `all` layouts as a self-contained SVG; `proposed` are numbered in their order, and the
/// target `region` is shaded.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn pareto_svg(
    all: &[LayoutCandidate],
    proposed: &[LayoutCandidate],
    region: Option<TargetRegion>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, all, proposed, region).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, SIZE))
}

fn at(c: &LayoutCandidate) -> Option<(f64, f64)> {
    Some((c.threshold_n?, c.friction_n))
}

fn draw(
    svg: &mut String,
    all: &[LayoutCandidate],
    proposed: &[LayoutCandidate],
    region: Option<TargetRegion>,
) -> Result<(), Failure> {
    let root = SVGBackend::with_string(svg, drawn_size(SIZE)).into_drawing_area();
    root.fill(&WHITE)?;
    let (figure, legend) = root.split_horizontally(fine::<u32>(1) * (SIZE.0 - LEGEND));
    let points: Vec<(f64, f64)> = all.iter().filter_map(at).collect();
    let numbered: Vec<(usize, (f64, f64))> =
        proposed.iter().enumerate().filter_map(|(i, c)| Some((i + 1, at(c)?))).collect();
    let shown = || points.iter().chain(numbered.iter().map(|n| &n.1));
    // The axes start near the first point.
    let start = |of: fn(&(f64, f64)) -> f64| 0.85 * shown().map(of).fold(f64::MAX, f64::min).min(1e6);
    let (left, bottom) = (start(|p| p.0), start(|p| p.1));
    let right = shown().map(|p| p.0).fold(1.0, f64::max) * 1.05;
    let top = shown().map(|p| p.1).fold(1.0, f64::max) * 1.08;
    let mut chart = ChartBuilder::on(&figure)
        .margin(fine::<u32>(14))
        .caption("layouts: threshold and friction", ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(52))
        .build_cartesian_2d(drawable(left.min(right), right), drawable(bottom.min(top), top))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("threshold: load at which silicone carries half of the friction (N)")
        .y_desc("friction at the heaviest load (N)")
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;
    if let Some(region) = region {
        let within =
            |(from, to): (f64, f64), low: f64, high: f64| (from.max(low).min(high), to.max(low).min(high));
        let (x, y) = (within(region.threshold_n, left, right), within(region.friction_n, bottom, top));
        chart.draw_series(std::iter::once(Rectangle::new(
            [(x.0, y.0), (x.1, y.1)],
            TARGET.mix(0.12).filled(),
        )))?;
    }
    chart.draw_series(points.iter().map(|p| Circle::new(*p, fine::<i32>(2), OTHERS.mix(0.6).filled())))?;
    let front = region.and_then(|region| pareto_front(&points, region));
    if let Some(front) = &front {
        chart.draw_series(LineSeries::new(front.points.iter().copied(), FRONT.stroke_width(fine(2))))?;
    }
    let pixels: Vec<(usize, (i32, i32))> =
        numbered.iter().map(|(number, p)| (*number, chart.backend_coord(p))).collect();
    let (across, down) = chart.plotting_area().get_pixel_range();
    drop(chart);
    draw_numbers(&root, &pixels, (across.start, across.end), (down.start, down.end))?;
    let front = front.as_ref().map(|f| f.label.as_str());
    draw_legend(&legend, points.len(), front, !numbered.is_empty(), region.is_some())?;
    root.present()?;
    Ok(())
}

/// Draws points and numbers; a number far from its point is connected to it by a line.
fn draw_numbers(
    root: &Area<'_>,
    numbered: &[(usize, (i32, i32))],
    across: (i32, i32),
    down: (i32, i32),
) -> Result<(), Failure> {
    let points: Vec<(i32, i32)> = numbered.iter().map(|p| p.1).collect();
    let numbers = number_positions(&points, across, down);
    for (((_, point), number_at), far) in numbered.iter().zip(&numbers).map(|(p, n)| ((p, n.0), n.1)) {
        if far {
            root.draw(&PathElement::new([*point, number_at], PROPOSED.mix(0.5).stroke_width(fine(1))))?;
        }
    }
    for (number_at, _) in &numbers {
        // A light background, so that the number is readable over other points.
        let (x, y, half) = (number_at.0, number_at.1, 8 * fine::<i32>(1));
        root.draw(&Rectangle::new([(x - half, y - half), (x + half, y + half)], WHITE.mix(0.8).filled()))?;
    }
    for point in &points {
        root.draw(&Circle::new(*point, fine::<i32>(1) * POINT_RADIUS, PROPOSED.filled()))?;
    }
    let style = TextStyle::from(("sans-serif", fine::<i32>(15)).into_font().style(FontStyle::Bold))
        .color(&PROPOSED)
        .pos(Pos::new(HPos::Center, VPos::Center));
    for ((number, _), (number_at, _)) in numbered.iter().zip(&numbers) {
        root.draw(&Text::new(number.to_string(), *number_at, style.clone()))?;
    }
    Ok(())
}

/// Returns a position for the number of each point, and whether it is far from the point. No number
/// covers another number or a point.
fn number_positions(points: &[(i32, i32)], across: (i32, i32), down: (i32, i32)) -> Vec<((i32, i32), bool)> {
    let unit = fine::<i32>(1);
    let half = NUMBER_HALF * unit;
    let mut taken: Vec<((i32, i32), bool)> = Vec::new();
    for point in points {
        let free = |at: (i32, i32)| {
            let inside = at.0 - half > across.0
                && at.0 + half < across.1
                && at.1 - half > down.0
                && at.1 + half < down.1;
            let clear = |other: (i32, i32), reach: i32| {
                (at.0 - other.0).abs() >= reach || (at.1 - other.1).abs() >= reach
            };
            inside
                && taken.iter().all(|(other, _)| clear(*other, 2 * half))
                && points.iter().all(|other| clear(*other, half + POINT_RADIUS * unit / 2))
        };
        let around = (1..40).flat_map(|ring| {
            (0..12).map(move |step| {
                let angle = f64::from(step) * std::f64::consts::TAU / 12.0 - 0.8;
                let radius = f64::from(unit) * (7.0 + 8.0 * f64::from(ring));
                (
                    ring,
                    ((radius * libm::cos(angle)).round() as i32, (radius * libm::sin(angle)).round() as i32),
                )
            })
        });
        let position =
            around.map(|(ring, by)| ((point.0 + by.0, point.1 + by.1), ring > 1)).find(|(at, _)| free(*at));
        taken.push(position.unwrap_or((*point, false)));
    }
    taken
}

/// Draws the legend.
fn draw_legend(
    area: &Area<'_>,
    layouts: usize,
    front: Option<&str>,
    has_designs: bool,
    has_region: bool,
) -> Result<(), Failure> {
    let unit = fine::<i32>(1);
    let style =
        TextStyle::from(("sans-serif", fine::<i32>(14)).into_font()).pos(Pos::new(HPos::Left, VPos::Center));
    let (mark, text) = (14 * unit, 34 * unit);
    let mut line = 70 * unit;
    // `below` is the height of further text under the line, in pixels.
    let mut next = |below: i32| {
        let y = line + 26 * unit;
        line = y + below * unit;
        y
    };
    let y = next(0);
    area.draw(&Circle::new((mark, y), 3 * unit, OTHERS.filled()))?;
    area.draw(&Text::new(format!("{layouts} layouts that switch"), (text, y), style.clone()))?;
    if let Some(label) = front {
        let y = next(SECOND_LINE);
        area.draw(&PathElement::new([(4 * unit, y), (24 * unit, y)], FRONT.stroke_width(fine(2))))?;
        area.draw(&Text::new("Pareto front", (text, y), style.clone()))?;
        area.draw(&Text::new(label.to_owned(), (text, y + SECOND_LINE * unit), style.clone()))?;
    }
    if has_designs {
        let y = next(0);
        area.draw(&Circle::new((mark, y), POINT_RADIUS * unit, PROPOSED.filled()))?;
        area.draw(&Text::new("proposed designs, best first", (text, y), style.clone()))?;
    }
    if has_region {
        let y = next(0);
        area.draw(&Rectangle::new(
            [(4 * unit, y - 7 * unit), (24 * unit, y + 7 * unit)],
            TARGET.mix(0.25).filled(),
        ))?;
        area.draw(&Text::new("target region", (text, y), style))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_cover_nothing() {
        let unit = fine::<i32>(1);
        // Five almost equal points in a corner.
        let points: Vec<(i32, i32)> = (0..5).map(|i| ((60 + i) * unit, (40 + i) * unit)).collect();
        let positions = number_positions(&points, (50 * unit, 700 * unit), (20 * unit, 400 * unit));
        for (i, (a, _)) in positions.iter().enumerate() {
            for (b, _) in &positions[..i] {
                let side = 2 * NUMBER_HALF * unit;
                assert!((a.0 - b.0).abs() >= side || (a.1 - b.1).abs() >= side, "{a:?} {b:?}");
            }
            assert!(
                points
                    .iter()
                    .all(|p| (p.0 - a.0).abs() >= NUMBER_HALF * unit
                        || (p.1 - a.1).abs() >= NUMBER_HALF * unit)
            );
            assert!(a.0 > 50 * unit && a.1 > 20 * unit);
        }
    }

    #[test]
    fn every_switching_design_is_numbered() {
        let of = |threshold_n, friction_n| LayoutCandidate { pins: vec![5, 8, 11], threshold_n, friction_n };
        let all = [of(Some(10.0), 5.0), of(Some(20.0), 4.0), of(None, 3.0)];
        let region = TargetRegion { threshold_n: (9.0, f64::INFINITY), friction_n: (0.0, 6.0) };
        let svg = pareto_svg(&all, &all, Some(region)).unwrap();
        assert!(svg.contains("\n1\n") && svg.contains("\n2\n") && !svg.contains("\n3\n"), "{svg}");
        assert!(svg.contains("2 layouts that switch") && svg.contains("higher threshold, less friction"));
        let bounded = TargetRegion { threshold_n: (9.0, 11.0), friction_n: (0.0, 6.0) };
        assert!(!pareto_svg(&all, &all, Some(bounded)).unwrap().contains("Pareto front"));
    }
}
