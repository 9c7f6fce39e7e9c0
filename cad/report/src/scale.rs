//! Sizes and axes for the drawing library: it rounds to whole units, so figures are drawn in finer
//! ones, and its search for ticks does not end on an axis without bounds or width.

use std::ops::Range;

/// Largest absolute value on an axis.
const MAX_BOUND: f64 = 1e12;
/// Least width of an axis, as a share of its bounds.
const MIN_RELATIVE_WIDTH: f64 = 1e-6;

/// Units per pixel.
const FINE: u8 = 8;

/// Converts pixels to units of the drawing.
pub fn fine<T: From<u8> + std::ops::Mul<Output = T>>(pixels: u8) -> T {
    T::from(pixels) * T::from(FINE)
}

/// Returns the size of the drawing in units, for a figure of this size in pixels.
pub fn drawn_size((width, height): (u32, u32)) -> (u32, u32) {
    (width * u32::from(FINE), height * u32::from(FINE))
}

/// Sets the displayed size of a drawn SVG, in pixels.
pub fn shown_at_size(svg: String, size: (u32, u32)) -> String {
    let attributes = |(width, height): (u32, u32)| format!(r#"width="{width}" height="{height}""#);
    svg.replacen(&attributes(drawn_size(size)), &attributes(size), 1)
}

/// Returns an axis from `low` to `high` that is bounded and wide enough for ticks.
pub fn drawable(low: f64, high: f64) -> Range<f64> {
    let bounded = |v: f64| if v.is_nan() { 0.0 } else { v.clamp(-MAX_BOUND, MAX_BOUND) };
    let (low, high) = (bounded(low), bounded(high));
    let width = MIN_RELATIVE_WIDTH * low.abs().max(high.abs()).max(MIN_RELATIVE_WIDTH);
    if high - low >= width { low..high } else { low - width..low + width }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_bounds_and_width() {
        assert_eq!(drawable(-0.5, 3.0), -0.5..3.0);
        let bounds =
            [0.0, 1.0, -1.0, 1e9, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN_POSITIVE];
        for (low, high) in bounds.iter().flat_map(|l| bounds.map(|h| (*l, h))) {
            let axis = drawable(low, high);
            assert!(axis.start.is_finite() && axis.end.is_finite(), "{low}..{high}: {axis:?}");
            let bound = axis.start.abs().max(axis.end.abs());
            assert!(axis.end - axis.start >= 0.5 * MIN_RELATIVE_WIDTH * bound, "{low}..{high}: {axis:?}");
            assert!(axis.end > axis.start, "{low}..{high}: {axis:?}");
        }
    }
}
