//! The drawing library rounds to whole units: figures are drawn in finer ones, so that lines are smooth.

/// Units to a pixel.
const FINE: u8 = 8;

/// Pixels in the drawing's finer units.
pub(super) fn fine<T: From<u8> + std::ops::Mul<Output = T>>(pixels: u8) -> T {
    T::from(pixels) * T::from(FINE)
}

/// Size of the drawing in its finer units, for a figure of this size in pixels.
pub(super) fn drawn_size((width, height): (u32, u32)) -> (u32, u32) {
    (width * u32::from(FINE), height * u32::from(FINE))
}

/// The drawing as an SVG that is shown at `size` in pixels.
pub(super) fn shown_at_size(svg: String, size: (u32, u32)) -> String {
    let attributes = |(width, height): (u32, u32)| format!(r#"width="{width}" height="{height}""#);
    svg.replacen(&attributes(drawn_size(size)), &attributes(size), 1)
}
