//! Drawings of lines in a document: the friction curve.

use pinswitch_friction::FrictionCurve;

/// The ink of a shape. Each writer has its colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// Axes and text.
    Axis,
    /// The band.
    Band,
    /// The curve.
    Curve,
    /// The threshold.
    Threshold,
}

/// Side of its position on which a text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    /// The text begins at its position.
    Start,
    /// The middle of the text is at its position.
    Middle,
    /// The text ends at its position.
    End,
}

/// A shape. Positions are mm from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A line through points.
    Line(Ink, Vec<[f64; 2]>),
    /// A filled polygon.
    Area(Ink, Vec<[f64; 2]>),
    /// A text on its baseline.
    Text(Ink, Align, [f64; 2], String),
}

/// A drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// Width and height, mm.
    pub size_mm: [f64; 2],
    /// Shapes, the lowest first.
    pub shapes: Vec<Shape>,
}

/// Height of text, mm.
pub(crate) const TEXT_MM: f64 = 3.2;
/// Size of the figure of the curve, and its margins: left, right, top, bottom, mm.
const SIZE_MM: [f64; 2] = [160.0, 78.0];
const MARGINS_MM: [f64; 4] = [14.0, 4.0, 6.0, 13.0];
/// Number of divisions that an axis has at least.
const DIVISIONS: f64 = 4.0;
/// Length of a tick, mm.
const TICK_MM: f64 = 1.5;

/// Distance of ticks: 1, 2 or 5 times a power of ten.
fn tick(most: f64) -> f64 {
    let rough = most / DIVISIONS;
    let power = libm::pow(10.0, libm::floor(libm::log10(rough)));
    [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|t| *t <= rough).unwrap_or(power)
}

/// Draws friction over load with its band and the threshold.
pub(crate) fn curve_figure(curve: &FrictionCurve, threshold_n: Option<f64>) -> Figure {
    let most = |column: &[f64]| column.iter().copied().fold(1e-9, f64::max);
    let (load, friction) = (most(&curve.load_n), most(&curve.band_high_n));
    let [left, right, top, bottom] = MARGINS_MM;
    let (low, high) = (SIZE_MM[1] - bottom, top);
    let x = |n: f64| left + n / load * (SIZE_MM[0] - left - right);
    let y = |n: f64| low - n / friction * (low - high);
    let points = |column: &[f64]| -> Vec<[f64; 2]> {
        curve.load_n.iter().zip(column).map(|(l, f)| [x(*l), y(*f)]).collect()
    };
    let mut band = points(&curve.band_high_n);
    band.extend(points(&curve.band_low_n).into_iter().rev());
    let mut shapes = vec![Shape::Area(Ink::Band, band)];
    let text = |align, at, text: String| Shape::Text(Ink::Axis, align, at, text);
    shapes.push(Shape::Line(Ink::Axis, vec![[left, high], [left, low], [x(load), low]]));
    for (step, most, is_load) in [(tick(load), load, true), (tick(friction), friction, false)] {
        let decimals = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
        for i in 0..=(most / step + 1e-9) as u32 {
            let n = step * f64::from(i);
            let words = format!("{n:.decimals$}");
            if is_load {
                shapes.push(Shape::Line(Ink::Axis, vec![[x(n), low], [x(n), low + TICK_MM]]));
                shapes.push(text(Align::Middle, [x(n), low + TICK_MM + TEXT_MM], words));
            } else {
                shapes.push(Shape::Line(Ink::Axis, vec![[left - TICK_MM, y(n)], [left, y(n)]]));
                shapes.push(text(Align::End, [left - TICK_MM - 0.8, y(n) + TEXT_MM * 0.36], words));
            }
        }
    }
    shapes.push(text(Align::Start, [1.0, TEXT_MM], "friction, N".to_owned()));
    shapes.push(text(Align::End, [x(load), SIZE_MM[1] - 1.5], "load, N".to_owned()));
    if let Some(n) = threshold_n {
        shapes.push(Shape::Line(Ink::Threshold, vec![[x(n), high], [x(n), low]]));
        let words = format!("switches at {n:.1} N");
        let (align, by) = if n > 0.5 * load { (Align::End, -1.5) } else { (Align::Start, 1.5) };
        shapes.push(Shape::Text(Ink::Threshold, align, [x(n) + by, high + TEXT_MM], words));
    }
    shapes.push(Shape::Line(Ink::Curve, points(&curve.friction_n)));
    Figure { size_mm: SIZE_MM, shapes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        for (most, expected) in [(49.67, 10.0), (10.6, 2.0), (0.9, 0.2), (4.0, 1.0), (300.0, 50.0)] {
            assert!((tick(most) - expected).abs() < 1e-12, "{most}: {}", tick(most));
        }
    }
}
