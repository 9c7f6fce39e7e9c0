//! What the drawing library needs: it rounds to whole units, so figures are drawn in finer ones, and it never ends its
//! search for ticks on an axis without bounds or without width.

use std::ops::Range;

/// Largest bound of an axis.
const FARTHEST: f64 = 1e12;
/// Least width of an axis as a share of its bounds.
const NARROWEST: f64 = 1e-6;

/// Units to a pixel.
const FINE: u8 = 8;

/// Pixels in the drawing's finer units.
pub fn fine<T: From<u8> + std::ops::Mul<Output = T>>(pixels: u8) -> T {
    T::from(pixels) * T::from(FINE)
}

/// Size of the drawing in its finer units, for a figure of this size in pixels.
pub fn drawn_size((width, height): (u32, u32)) -> (u32, u32) {
    (width * u32::from(FINE), height * u32::from(FINE))
}

/// The drawing as an SVG that is shown at `size` in pixels.
pub fn shown_at_size(svg: String, size: (u32, u32)) -> String {
    let attributes = |(width, height): (u32, u32)| format!(r#"width="{width}" height="{height}""#);
    svg.replacen(&attributes(drawn_size(size)), &attributes(size), 1)
}

/// An axis from `low` to `high` on which ticks can be found: bounded, and wide enough for its place.
pub fn drawable(low: f64, high: f64) -> Range<f64> {
    let bounded = |v: f64| if v.is_nan() { 0.0 } else { v.clamp(-FARTHEST, FARTHEST) };
    let (low, high) = (bounded(low), bounded(high));
    let width = NARROWEST * low.abs().max(high.abs()).max(NARROWEST);
    if high - low >= width { low..high } else { low - width..low + width }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_is_bounded_and_has_a_width() {
        assert_eq!(drawable(-0.5, 3.0), -0.5..3.0);
        let bounds =
            [0.0, 1.0, -1.0, 1e9, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN_POSITIVE];
        for (low, high) in bounds.iter().flat_map(|l| bounds.map(|h| (*l, h))) {
            let found = drawable(low, high);
            assert!(found.start.is_finite() && found.end.is_finite(), "{low}..{high}: {found:?}");
            let far = found.start.abs().max(found.end.abs());
            assert!(found.end - found.start >= 0.5 * NARROWEST * far, "{low}..{high}: {found:?}");
            assert!(found.end > found.start, "{low}..{high}: {found:?}");
        }
    }
}
