//! The tendon over its pins: gap to the silicone along the wrap, at several loads.

use plotters::prelude::*;

use pinswitch_friction::physics::ContactProfile;

use super::PlotError;
use super::scale::{drawn_size, fine, shown_at_size};

/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (760, 420);
const SILICONE: RGBColor = RGBColor(214, 226, 236);
/// From a light load to a heavy one.
const LOADS: [RGBColor; 4] =
    [RGBColor(120, 170, 210), RGBColor(0, 90, 156), RGBColor(178, 74, 0), RGBColor(120, 20, 40)];

/// Draws `profiles` with their loads in newtons as a self-contained SVG titled `title`.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn contact_svg(title: &str, profiles: &[(f64, ContactProfile)]) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, title, profiles).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, SIZE))
}

fn draw(
    svg: &mut String,
    title: &str,
    profiles: &[(f64, ContactProfile)],
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, drawn_size(SIZE)).into_drawing_area();
    root.fill(&WHITE)?;
    let gaps = || profiles.iter().flat_map(|(_, p)| p.gap_mm.iter().copied());
    let (low, high) = (gaps().fold(-0.1, f64::min) * 1.1, gaps().fold(0.1, f64::max) * 1.35);
    let half =
        profiles.iter().flat_map(|(_, p)| p.angle_rad.last().copied()).fold(0.1, f64::max).to_degrees();
    let mut chart = ChartBuilder::on(&root)
        .margin(fine::<u32>(14))
        .caption(title, ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(58))
        .build_cartesian_2d(-half..half, low..high)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("angle along the wrap (deg); the load hangs on the left")
        .y_desc("gap over the resting silicone (mm)")
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;
    chart
        .draw_series(profiles.first().map(|(_, p)| {
            let (from, to) = (p.silicone_rad.0.to_degrees(), p.silicone_rad.1.to_degrees());
            Rectangle::new([(from, low), (to, 0.0)], SILICONE.filled())
        }))?
        .label("silicone that the tendon can touch")
        .legend(|(x, y)| {
            Rectangle::new(
                [(x, y - fine::<i32>(5)), (x + fine::<i32>(22), y + fine::<i32>(5))],
                SILICONE.filled(),
            )
        });
    for ((load, profile), colour) in profiles.iter().zip(LOADS.iter().cycle()) {
        let line = profile.angle_rad.iter().map(|a| a.to_degrees()).zip(profile.gap_mm.iter().copied());
        let on_silicone = profile.silicone_turn_rad
            / (profile.silicone_turn_rad + profile.pin_turn_rad.iter().sum::<f64>()).max(f64::MIN_POSITIVE);
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(fine(2))))?
            .label(format!("{load:.1} N: {:.0} % of the turn on silicone", 100.0 * on_silicone))
            .legend(move |(x, y)| {
                PathElement::new([(x, y), (x + fine::<i32>(22), y)], colour.stroke_width(fine(2)))
            });
        let pins = profile.pin_n.iter().zip(&profile.pin_angle_rad).map(|(force, angle)| {
            let nearest =
                profile.angle_rad.partition_point(|a| *a < angle - 1e-9).min(profile.gap_mm.len() - 1);
            (angle.to_degrees(), profile.gap_mm[nearest], *force)
        });
        chart.draw_series(pins.map(|(angle, gap, force)| {
            EmptyElement::at((angle, gap))
                + Circle::new((0, 0), fine::<i32>(4), colour.filled())
                + Text::new(
                    format!("{force:.1} N"),
                    (fine::<i32>(6), -fine::<i32>(16)),
                    ("sans-serif", fine::<i32>(12)).into_font().color(colour),
                )
        }))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerMiddle)
        .margin(fine::<i32>(8))
        .legend_area_size(fine::<u32>(26))
        .background_style(WHITE.mix(0.9))
        .border_style(BLACK.mix(0.3).stroke_width(fine(1)))
        .label_font(("sans-serif", fine::<i32>(13)))
        .draw()?;
    root.present()?;
    Ok(())
}
