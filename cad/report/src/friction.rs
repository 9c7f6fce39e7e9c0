//! The figure of a friction curve: curve and band, limits of both materials, the threshold, and the
//! paper's measurements. The legend is below the axes, so that it covers no data.

use plotters::element::DashedPathElement;
use plotters::prelude::*;

use pinswitch_friction::{
    Contact, FrictionCurve, Law, PredictionStatus, Transition, capstan_friction_n, published,
    published_points,
};

use super::PlotError;
use super::legend::{Legend, Measures};
use super::scale::{drawn_size, fine, shown_at_size};
use super::text_size::Svg;

/// Sample of a dashed line in the legend.
type DashedSample = DashedPathElement<std::vec::IntoIter<(i32, i32)>, u32>;

/// Width and height of the figure in pixels.
const SIZE: (u32, u32) = (760, 584);
/// Height of the axes with their labels in pixels; the legend is below.
const AXES: u32 = 476;
const CURVE: RGBColor = RGBColor(0, 90, 156);
const PINS: RGBColor = RGBColor(90, 90, 90);
const SILICONE: RGBColor = RGBColor(178, 74, 0);
/// Colours of other laws in the order of [`Law::predictive`], repeated.
const OTHERS: [RGBColor; 3] = [RGBColor(0, 120, 90), RGBColor(140, 60, 150), RGBColor(190, 20, 60)];
/// Colour of the threshold, that of its curve.
const THRESHOLD: RGBColor = CURVE;
/// Pixels of dash and gap of a limit line, of the threshold, and of a published onset.
const LIMIT_DASHES: [u8; 2] = [6, 4];
const THRESHOLD_DASHES: [u8; 2] = [8, 3];
const ONSET_DASHES: [u8; 2] = [2, 3];
/// Points of a limit line.
const LIMIT_POINTS: u32 = 60;

/// Draws `curve` of `contact` with its band as a self-contained SVG titled `name`, and the curves
/// of other laws as thin lines.
///
/// # Errors
/// [`PlotError`] if the drawing library refuses a coordinate.
pub fn friction_svg(
    name: &str,
    contact: &Contact,
    curve: &FrictionCurve,
    others: &[FrictionCurve],
) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw(&mut svg, name, contact, curve, others).map_err(|e| PlotError::new(&*e))?;
    Ok(shown_at_size(svg, SIZE))
}

fn draw(
    svg: &mut String,
    name: &str,
    contact: &Contact,
    curve: &FrictionCurve,
    others: &[FrictionCurve],
) -> Result<(), Box<dyn std::error::Error>> {
    let root = Svg::with_string(svg, drawn_size(SIZE)).into_drawing_area();
    root.fill(&WHITE)?;
    let highest_load = curve.load_n.last().copied().unwrap_or(1.0) * 1.03;
    let limit = |mu: f64, load: f64| capstan_friction_n(load, mu * contact.wrap_rad());
    let points = published_points(contact);
    let measured = points.iter().filter_map(|p| p.friction_n).fold(0.0, f64::max);
    let top = curve.band_high_n.iter().copied().fold(limit(published::MU_SILICONE, highest_load), f64::max);
    let mut legend = Legend::default();
    let (axes, below) = root.split_vertically(fine::<u32>(1) * AXES);
    let mut chart = ChartBuilder::on(&axes)
        .margin(fine::<u32>(14))
        .caption(format!("{name}: friction over load"), ("sans-serif", fine::<i32>(19)))
        .x_label_area_size(fine::<u32>(44))
        .y_label_area_size(fine::<u32>(52))
        .build_cartesian_2d(0.0..highest_load, 0.0..(top.max(measured) * 1.04))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.10).stroke_width(fine(1)))
        .x_desc("load F (N)")
        .y_desc("friction D = (T_c - T_e)/2 (N)")
        .x_label_formatter(&|v| format!("{v:.0}"))
        .y_label_formatter(&|v| format!("{v:.0}"))
        .set_all_tick_mark_size(fine::<u32>(5))
        .axis_style(BLACK.stroke_width(fine(1)))
        .label_style(("sans-serif", fine::<i32>(14)))
        .axis_desc_style(("sans-serif", fine::<i32>(15)))
        .draw()?;

    let upper = curve.load_n.iter().copied().zip(curve.band_high_n.iter().copied());
    let lower = curve.load_n.iter().copied().zip(curve.band_low_n.iter().copied());
    let band: Vec<_> = upper.chain(lower.rev()).collect();
    chart.draw_series(std::iter::once(Polygon::new(band, CURVE.mix(0.18))))?;
    legend.line(format!("95 % band ({})", trust_label(curve.status)), |(x, y)| {
        Rectangle::new(
            [(x, y - fine::<i32>(5)), (x + fine::<i32>(22), y + fine::<i32>(5))],
            CURVE.mix(0.18).filled(),
        )
    });

    for (mu, colour, label) in [
        (published::MU_SILICONE, SILICONE, "silicone alone (capstan)"),
        (published::MU_PINS, PINS, "pins alone (capstan)"),
    ] {
        let line = (0..=LIMIT_POINTS).map(|i| {
            let load = highest_load * f64::from(i) / f64::from(LIMIT_POINTS);
            (load, limit(mu, load))
        });
        chart.draw_series(dashed(line.collect(), LIMIT_DASHES, colour))?;
        legend.line(label, move |at| dashed_sample(at, LIMIT_DASHES, colour));
    }

    for other in others {
        let place = Law::predictive().position(|law| law == other.law).unwrap_or_default();
        let colour = OTHERS[place % OTHERS.len()];
        let line = other.load_n.iter().copied().zip(other.friction_n.iter().copied());
        chart.draw_series(LineSeries::new(line, colour.stroke_width(fine(1))))?;
        legend.line(format!("{}, for comparison", other.law.title()), move |(x, y)| {
            PathElement::new([(x, y), (x + fine::<i32>(22), y)], colour.stroke_width(fine(1)))
        });
    }

    let line: Vec<_> = curve.load_n.iter().copied().zip(curve.friction_n.iter().copied()).collect();
    chart.draw_series(LineSeries::new(line, CURVE.stroke_width(fine(3))))?;
    legend.line(curve.law.title(), |(x, y)| {
        PathElement::new([(x, y), (x + fine::<i32>(22), y)], CURVE.stroke_width(fine(3)))
    });

    let maxima: Vec<_> = points.iter().filter_map(|p| Some((p.load_n, p.friction_n?))).collect();
    if !maxima.is_empty() {
        chart.draw_series(maxima.iter().map(|p| Circle::new(*p, fine::<i32>(5), BLACK.filled())))?;
        legend.line("published maximum (measured)", |(x, y)| {
            Circle::new((x + fine::<i32>(11), y), fine::<i32>(5), BLACK.filled())
        });
    }
    for onset in points.iter().filter(|p| p.friction_n.is_none()) {
        let load = onset.load_n;
        let line = vec![(load, 0.0), (load, top)];
        chart.draw_series(dashed(line, ONSET_DASHES, BLACK))?;
        legend.line(format!("published onset, {load:.2} N"), |at| dashed_sample(at, ONSET_DASHES, BLACK));
    }
    if let Some(transition) = Transition::of(curve) {
        let load = transition.threshold_n;
        chart.draw_series(dashed(vec![(load, 0.0), (load, top)], THRESHOLD_DASHES, THRESHOLD))?;
        legend.line(format!("switches at {load:.1} N"), |at| dashed_sample(at, THRESHOLD_DASHES, THRESHOLD));
    }
    let measures = Measures { margin: fine(52), samples: fine(28), font: fine(14), columns: 2 };
    legend.draw(&below, measures)?;
    root.present()?;
    Ok(())
}

fn dashed(
    line: Vec<(f64, f64)>,
    [dash, gap]: [u8; 2],
    colour: RGBColor,
) -> DashedLineSeries<std::vec::IntoIter<(f64, f64)>, u32> {
    DashedLineSeries::new(line, fine::<u32>(dash), fine::<u32>(gap), colour.stroke_width(fine(1)))
}

/// A dashed line of the legend.
fn dashed_sample((x, y): (i32, i32), [dash, gap]: [u8; 2], colour: RGBColor) -> DashedSample {
    let ends = vec![(x, y), (x + fine::<i32>(22), y)];
    DashedPathElement::new(ends, fine::<u32>(dash), fine::<u32>(gap), colour.stroke_width(fine(1)))
}

fn trust_label(trust: PredictionStatus) -> &'static str {
    match trust {
        PredictionStatus::Published => "published layout",
        PredictionStatus::Interpolated => "interpolated",
        PredictionStatus::Extrapolated => "extrapolated",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::physics::Bed;
    use pinswitch_friction::{PinPattern, Substrate, predict};

    fn drawn(contact: &Contact) -> String {
        let curve = predict(contact, &[5.0, 15.0, 30.0, 49.0]);
        friction_svg("mine", contact, &curve, &[]).unwrap()
    }

    /// The threshold is that of the curve, and a proxy, which does not switch, has none.
    #[test]
    fn figures_show_the_threshold() {
        let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
        let of = |substrate| Contact::new(substrate, pins.clone(), published::wrap_angle_rad()).unwrap();
        let loads_n: Vec<f64> = (6..=100).map(|i| 0.5 * f64::from(i)).collect();
        let curve = predict(&of(Substrate::Silicone), &loads_n);
        let threshold_n = Transition::of(&curve).unwrap().threshold_n;
        let svg = friction_svg("mine", &of(Substrate::Silicone), &curve, &[]).unwrap();
        assert!(svg.contains(&format!("switches at {threshold_n:.1} N")), "{svg}");
        assert!(!drawn(&of(Substrate::Abs)).contains("switches at"));
    }

    /// Every text of the legend is below the axes: no data is there.
    #[test]
    fn legends_cover_no_data() {
        let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
        let svg = drawn(&Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap());
        let mut labels = 0;
        for (before, after) in svg.match_indices("<text ").map(|(at, _)| svg[at..].split_once('>').unwrap()) {
            let content = after.split('<').next().unwrap_or_default().trim();
            let y = before.split(" y=\"").nth(1).unwrap().split('"').next().unwrap();
            let is_label =
                ["band", "capstan", "published", "switches at"].iter().any(|word| content.contains(word));
            labels += usize::from(is_label);
            assert_eq!(
                is_label || content == "physics",
                y.parse::<u32>().unwrap() >= fine::<u32>(1) * AXES,
                "{content}"
            );
        }
        assert!(labels >= 4, "{labels}");
    }

    /// Contacts that differ from the paper's in one property have no published measurements.
    #[test]
    fn only_measured_contacts_are_called_published() {
        let layout = &published::LAYOUTS[1];
        let even = |pitch| PinPattern::even(layout.pins, pitch);
        let of = |substrate, pins, wrap| Contact::new(substrate, pins, wrap).unwrap();
        let (pitch, wrap) = (layout.pitch_rad(), published::wrap_angle_rad());
        let measured = of(Substrate::Silicone, even(pitch), wrap);
        let svg = drawn(&measured);
        assert!(svg.contains("published onset, 15.31 N") && svg.contains("published maximum"), "{svg}");
        let bed = Bed::published();
        let others = [
            of(Substrate::Abs, even(0.95 * pitch), wrap),
            of(Substrate::Silicone, even(1.02 * pitch), wrap),
            of(Substrate::Silicone, even(pitch), 1.05 * wrap),
            measured.clone().with_bed(Bed { modulus_mpa: 0.9 * bed.modulus_mpa, ..bed }),
            measured.clone().with_bed(Bed { layer_mm: 1.1 * bed.layer_mm, ..bed }),
            measured.clone().with_bed(Bed { pin_diameter_mm: 0.95 * bed.pin_diameter_mm, ..bed }),
            measured.clone().with_bed(Bed { contact_radius_mm: 1.05 * bed.contact_radius_mm, ..bed }),
            measured.with_unmodelled(vec!["tendon.rope".to_owned()]),
        ];
        for (nth, contact) in others.iter().enumerate() {
            assert!(!drawn(contact).contains("published"), "contact {nth} of {}", others.len());
        }
        // Pins on ABS do not switch: they have a maximum and no onset.
        let abs = drawn(&of(Substrate::Abs, even(pitch), wrap));
        assert!(abs.contains("published maximum") && !abs.contains("published onset"), "{abs}");
    }
}
