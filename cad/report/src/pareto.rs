//! Threshold against friction of every pattern that was tried, the front of what was asked, and what was proposed. The
//! legend stands beside the figure, and numbers move aside until none covers another.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use pinswitch_friction::layout_search::LayoutCandidate;

use super::PlotError;
use super::front::front;
use super::scale::{drawable, drawn_size, fine, shown_at_size};

const OTHERS: RGBColor = RGBColor(150, 160, 175);
const FRONT: RGBColor = RGBColor(178, 74, 0);
const CHOSEN: RGBColor = RGBColor(0, 90, 156);
const ASKED: RGBColor = RGBColor(0, 120, 90);
/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (980, 500);
/// Width of what stands beside it, in pixels.
const LEGEND: u32 = 250;
/// Half of the side of the square that a number takes, in pixels.
const NUMBER_HALF: i32 = 9;
/// Radius of a proposal's point, in pixels.
const POINT: i32 = 5;

/// What was asked of both axes: from and to, infinite where an end is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AskedRegion {
    /// Of the threshold, N.
    pub threshold_n: (f64, f64),
    /// Of the friction at the heaviest load, N.
    pub friction_n: (f64, f64),
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failure = Box<dyn std::error::Error>;

/// Draws `all` as a self-contained SVG; `chosen` are numbered in their order, and `asked` is shaded.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn pareto_svg(
    all: &[LayoutCandidate],
    chosen: &[LayoutCandidate],
    asked: Option<AskedRegion>,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, all, chosen, asked).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, SIZE))
}

fn at(c: &LayoutCandidate) -> Option<(f64, f64)> {
    Some((c.threshold_n?, c.friction_n))
}

fn draw(
    svg: &mut String,
    all: &[LayoutCandidate],
    chosen: &[LayoutCandidate],
    asked: Option<AskedRegion>,
) -> Result<(), Failure> {
    let root = SVGBackend::with_string(svg, drawn_size(SIZE)).into_drawing_area();
    root.fill(&WHITE)?;
    let (figure, legend) = root.split_horizontally(fine::<u32>(1) * (SIZE.0 - LEGEND));
    let points: Vec<(f64, f64)> = all.iter().filter_map(at).collect();
    let numbered: Vec<(usize, (f64, f64))> =
        chosen.iter().enumerate().filter_map(|(i, c)| Some((i + 1, at(c)?))).collect();
    let shown = || points.iter().chain(numbered.iter().map(|n| &n.1));
    // A part of the range in which nothing lies is not shown.
    let least = |of: fn(&(f64, f64)) -> f64| 0.85 * shown().map(of).fold(f64::MAX, f64::min).min(1e6);
    let (left, bottom) = (least(|p| p.0), least(|p| p.1));
    let right = shown().map(|p| p.0).fold(1.0, f64::max) * 1.05;
    let top = shown().map(|p| p.1).fold(1.0, f64::max) * 1.08;
    let mut chart = ChartBuilder::on(&figure)
        .margin(fine::<u32>(14))
        .caption("pin patterns: when they switch, and how much they rub", ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(52))
        .build_cartesian_2d(drawable(left.min(right), right), drawable(bottom.min(top), top))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("threshold: load at which silicone makes half of the friction (N)")
        .y_desc("friction at the heaviest load (N)")
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;
    if let Some(region) = asked {
        let within =
            |(from, to): (f64, f64), low: f64, high: f64| (from.max(low).min(high), to.max(low).min(high));
        let (x, y) = (within(region.threshold_n, left, right), within(region.friction_n, bottom, top));
        chart.draw_series(std::iter::once(Rectangle::new(
            [(x.0, y.0), (x.1, y.1)],
            ASKED.mix(0.12).filled(),
        )))?;
    }
    chart.draw_series(points.iter().map(|p| Circle::new(*p, fine::<i32>(2), OTHERS.mix(0.6).filled())))?;
    let front = asked.and_then(|asked| front(&points, asked));
    if let Some(front) = &front {
        chart.draw_series(LineSeries::new(front.points.iter().copied(), FRONT.stroke_width(fine(2))))?;
    }
    let places: Vec<(usize, (i32, i32))> =
        numbered.iter().map(|(number, p)| (*number, chart.backend_coord(p))).collect();
    let (across, down) = chart.plotting_area().get_pixel_range();
    drop(chart);
    draw_numbers(&root, &places, (across.start, across.end), (down.start, down.end))?;
    let front = front.as_ref().map(|f| f.words.as_str());
    draw_legend(&legend, points.len(), front, !numbered.is_empty(), asked.is_some())?;
    root.present()?;
    Ok(())
}

/// Points and numbers; a number that had to move far is tied to its point by a line.
fn draw_numbers(
    root: &Area<'_>,
    places: &[(usize, (i32, i32))],
    across: (i32, i32),
    down: (i32, i32),
) -> Result<(), Failure> {
    let points: Vec<(i32, i32)> = places.iter().map(|p| p.1).collect();
    let numbers = placed(&points, across, down);
    for (((_, point), number_at), far) in places.iter().zip(&numbers).map(|(p, n)| ((p, n.0), n.1)) {
        if far {
            root.draw(&PathElement::new([*point, number_at], CHOSEN.mix(0.5).stroke_width(fine(1))))?;
        }
    }
    for (number_at, _) in &numbers {
        // A little ground, so that a number can be read over other points.
        let (x, y, half) = (number_at.0, number_at.1, 8 * fine::<i32>(1));
        root.draw(&Rectangle::new([(x - half, y - half), (x + half, y + half)], WHITE.mix(0.8).filled()))?;
    }
    for point in &points {
        root.draw(&Circle::new(*point, fine::<i32>(1) * POINT, CHOSEN.filled()))?;
    }
    let style = TextStyle::from(("sans-serif", fine::<i32>(15)).into_font().style(FontStyle::Bold))
        .color(&CHOSEN)
        .pos(Pos::new(HPos::Center, VPos::Center));
    for ((number, _), (number_at, _)) in places.iter().zip(&numbers) {
        root.draw(&Text::new(number.to_string(), *number_at, style.clone()))?;
    }
    Ok(())
}

/// A place for the number of each point, and whether it lies far from it: none covers another number or a point.
fn placed(points: &[(i32, i32)], across: (i32, i32), down: (i32, i32)) -> Vec<((i32, i32), bool)> {
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
                && points.iter().all(|other| clear(*other, half + POINT * unit / 2))
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
        let found =
            around.map(|(ring, by)| ((point.0 + by.0, point.1 + by.1), ring > 1)).find(|(at, _)| free(*at));
        taken.push(found.unwrap_or((*point, false)));
    }
    taken
}

/// What the marks mean, line by line beside the figure.
fn draw_legend(
    area: &Area<'_>,
    patterns: usize,
    front: Option<&str>,
    has_designs: bool,
    has_ask: bool,
) -> Result<(), Failure> {
    let unit = fine::<i32>(1);
    let style =
        TextStyle::from(("sans-serif", fine::<i32>(14)).into_font()).pos(Pos::new(HPos::Left, VPos::Center));
    let (mark, text) = (14 * unit, 34 * unit);
    let mut line = 70 * unit;
    let mut next = || {
        line += 26 * unit;
        line
    };
    let y = next();
    area.draw(&Circle::new((mark, y), 3 * unit, OTHERS.filled()))?;
    area.draw(&Text::new(format!("{patterns} patterns that switch"), (text, y), style.clone()))?;
    if let Some(words) = front {
        let y = next();
        area.draw(&PathElement::new([(4 * unit, y), (24 * unit, y)], FRONT.stroke_width(fine(2))))?;
        area.draw(&Text::new(words.to_owned(), (text, y), style.clone()))?;
    }
    if has_designs {
        let y = next();
        area.draw(&Circle::new((mark, y), POINT * unit, CHOSEN.filled()))?;
        area.draw(&Text::new("designs, best first", (text, y), style.clone()))?;
    }
    if has_ask {
        let y = next();
        area.draw(&Rectangle::new(
            [(4 * unit, y - 7 * unit), (24 * unit, y + 7 * unit)],
            ASKED.mix(0.25).filled(),
        ))?;
        area.draw(&Text::new("asked of these two", (text, y), style))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_cover_neither_each_other_nor_a_point() {
        let unit = fine::<i32>(1);
        // Five points nearly on one another, in a corner.
        let points: Vec<(i32, i32)> = (0..5).map(|i| ((60 + i) * unit, (40 + i) * unit)).collect();
        let found = placed(&points, (50 * unit, 700 * unit), (20 * unit, 400 * unit));
        for (i, (a, _)) in found.iter().enumerate() {
            for (b, _) in &found[..i] {
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
    fn every_proposal_is_numbered() {
        let of = |threshold_n, friction_n| LayoutCandidate { pins: vec![5, 8, 11], threshold_n, friction_n };
        let all = [of(Some(10.0), 5.0), of(Some(20.0), 4.0), of(None, 3.0)];
        let asked = AskedRegion { threshold_n: (9.0, f64::INFINITY), friction_n: (0.0, 6.0) };
        let svg = pareto_svg(&all, &all, Some(asked)).unwrap();
        assert!(svg.contains("\n1\n") && svg.contains("\n2\n") && !svg.contains("\n3\n"), "{svg}");
        assert!(svg.contains("2 patterns that switch") && svg.contains("none later that rubs less"));
        let about = AskedRegion { threshold_n: (9.0, 11.0), friction_n: (0.0, 6.0) };
        assert!(!pareto_svg(&all, &all, Some(about)).unwrap().contains("that rubs"));
    }
}
