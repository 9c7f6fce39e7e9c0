//! The figure of the tendon over its pins: gap to the silicone along the wrap, at several loads.
//! The legend is on the right and lists the forces of the pins, since the curves of all loads are a
//! few pixels apart at a pin.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use pinswitch_friction::physics::ContactProfile;

use super::PlotError;
use super::scale::{drawn_size, fine, shown_at_size};

/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (1000, 420);
/// Width of the legend in pixels.
const LEGEND: u32 = 260;
/// Forces of pins in one line of the legend.
const FORCES_PER_LINE: usize = 6;
const SILICONE: RGBColor = RGBColor(214, 226, 236);
/// Colours from the lightest to the heaviest load.
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
    let (figure, legend) = root.split_horizontally(fine::<u32>(1) * (SIZE.0 - LEGEND));
    let gaps = || profiles.iter().flat_map(|(_, p)| p.gap_mm.iter().copied());
    let (low, high) = (gaps().fold(-0.1, f64::min) * 1.1, gaps().fold(0.1, f64::max) * 1.1);
    let half =
        profiles.iter().flat_map(|(_, p)| p.angle_rad.last().copied()).fold(0.1, f64::max).to_degrees();
    let mut chart = ChartBuilder::on(&figure)
        .margin(fine::<u32>(14))
        .caption(title, ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(58))
        .build_cartesian_2d(-half..half, low..high)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("angle along the wrap (deg), loaded end on the left")
        .y_desc("gap to the undeformed silicone (mm)")
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;
    chart.draw_series(profiles.first().map(|(_, p)| {
        let (from, to) = (p.silicone_rad.0.to_degrees(), p.silicone_rad.1.to_degrees());
        Rectangle::new([(from, low), (to, 0.0)], SILICONE.filled())
    }))?;
    for ((_, profile), colour) in profiles.iter().zip(LOADS.iter().cycle()) {
        let line = profile.angle_rad.iter().map(|a| a.to_degrees()).zip(profile.gap_mm.iter().copied());
        chart.draw_series(LineSeries::new(line, colour.stroke_width(fine(2))))?;
        let pins = profile.pin_angle_rad.iter().map(|angle| {
            let nearest =
                profile.angle_rad.partition_point(|a| *a < angle - 1e-9).min(profile.gap_mm.len() - 1);
            Circle::new((angle.to_degrees(), profile.gap_mm[nearest]), fine::<i32>(4), colour.filled())
        });
        chart.draw_series(pins)?;
    }
    drop(chart);
    draw_legend(&legend, profiles)?;
    root.present()?;
    Ok(())
}

/// Draws the legend: each load with the silicone's share of the wrap and the force on every pin.
fn draw_legend(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    profiles: &[(f64, ContactProfile)],
) -> Result<(), Box<dyn std::error::Error>> {
    let unit = fine::<i32>(1);
    let style =
        TextStyle::from(("sans-serif", fine::<i32>(13)).into_font()).pos(Pos::new(HPos::Left, VPos::Center));
    let text = 32 * unit;
    let mut y = 60 * unit;
    area.draw(&Rectangle::new([(4 * unit, y - 6 * unit), (24 * unit, y + 6 * unit)], SILICONE.filled()))?;
    area.draw(&Text::new("silicone in reach of the tendon", (text, y), style.clone()))?;
    for ((load, profile), colour) in profiles.iter().zip(LOADS.iter().cycle()) {
        y += 28 * unit;
        area.draw(&PathElement::new([(4 * unit, y), (24 * unit, y)], colour.stroke_width(fine(2))))?;
        let on_silicone = profile.silicone_turn_rad
            / (profile.silicone_turn_rad + profile.pin_turn_rad.iter().sum::<f64>()).max(f64::MIN_POSITIVE);
        let words = format!("{load:.1} N: {:.0} % of the wrap on silicone", 100.0 * on_silicone);
        area.draw(&Text::new(words, (text, y), style.clone()))?;
        let forces: Vec<String> = profile.pin_n.iter().map(|force| format!("{force:.1}")).collect();
        for (i, row) in forces.chunks(FORCES_PER_LINE).enumerate() {
            y += 17 * unit;
            let row = row.join(", ");
            let words = if i == 0 { format!("pins: {row}") } else { row };
            let words = if (i + 1) * FORCES_PER_LINE >= forces.len() { format!("{words} N") } else { words };
            area.draw(&Text::new(words, (text, y), style.color(colour)))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::physics::contact_profile;
    use pinswitch_friction::{Contact, Direction, PinPattern, Substrate, published};

    #[test]
    fn the_legend_is_outside_of_the_plot() {
        let pins = PinPattern::even(3, 0.3);
        let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
        let profiles = [10.0, 40.0].map(|n| (n, contact_profile(&contact, n, Direction::Eccentric).unwrap()));
        let svg = contact_svg("three pins", &profiles).unwrap();
        let edge = f64::from(fine::<u32>(1) * (SIZE.0 - LEGEND));
        let x_of = |words: &str| -> f64 {
            let end = svg.find(words).unwrap();
            let tag = &svg[svg[..end].rfind("<text").unwrap()..end];
            tag.split("x=\"").nth(1).and_then(|x| x.split('"').next()).unwrap().parse().unwrap()
        };
        for words in ["silicone in reach", "40.0 N: ", "pins: "] {
            assert!(x_of(words) > edge, "{words} at {} of {edge}", x_of(words));
        }
    }
}
