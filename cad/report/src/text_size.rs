//! Estimated sizes of text, the same on every platform.
//!
//! An SVG is drawn with the font of its reader, so that each size is an estimate. plotters
//! estimates it from the number of bytes, but compiled for a browser it measures text on the
//! document's canvas: a worker has none, and the figure would differ. The estimate here is that of
//! plotters, for all platforms.

use plotters::prelude::*;
use plotters_backend::{BackendColor, BackendStyle, BackendTextStyle, DrawingErrorKind};

/// Ratio of a font size in plotters to the size that it writes.
const SIZE_RATIO: f64 = 1.24;
/// Width of a letter and depth below the line, relative to the height.
const WIDTH: f64 = 0.7;
const BELOW: f64 = 0.24;

/// Estimates width and height of `text` in a font of this size, all in units of the drawing.
pub(crate) fn text_size(text: &str, size: f64) -> (i32, i32) {
    let em = size / SIZE_RATIO / SIZE_RATIO;
    // A drawing has some ten thousand units.
    #[allow(clippy::cast_possible_truncation)]
    let whole = |length: f64| length.round() as i32;
    (whole(em * WIDTH * text.len() as f64), whole(em) + whole(em * BELOW))
}

/// An SVG backend with [`text_size`].
pub(crate) struct Svg<'a>(SVGBackend<'a>);

impl<'a> Svg<'a> {
    /// Creates a drawing of this size in units, written into `buffer`.
    pub(crate) fn with_string(buffer: &'a mut String, size: (u32, u32)) -> Self {
        Self(SVGBackend::with_string(buffer, size))
    }
}

type Drawn<E> = Result<(), DrawingErrorKind<E>>;

impl<'a> DrawingBackend for Svg<'a> {
    type ErrorType = <SVGBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Drawn<Self::ErrorType> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Drawn<Self::ErrorType> {
        self.0.present()
    }

    fn draw_pixel(&mut self, point: (i32, i32), color: BackendColor) -> Drawn<Self::ErrorType> {
        self.0.draw_pixel(point, color)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: (i32, i32),
        to: (i32, i32),
        style: &S,
    ) -> Drawn<Self::ErrorType> {
        self.0.draw_line(from, to, style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: (i32, i32),
        bottom_right: (i32, i32),
        style: &S,
        fill: bool,
    ) -> Drawn<Self::ErrorType> {
        self.0.draw_rect(upper_left, bottom_right, style, fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = (i32, i32)>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn<Self::ErrorType> {
        self.0.draw_path(path, style)
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: (i32, i32),
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn<Self::ErrorType> {
        self.0.draw_circle(center, radius, style, fill)
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = (i32, i32)>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Drawn<Self::ErrorType> {
        self.0.fill_polygon(vert, style)
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        pos: (i32, i32),
    ) -> Drawn<Self::ErrorType> {
        self.0.draw_text(text, style, pos)
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Self::ErrorType>> {
        let (width, height) = text_size(text, style.size());
        Ok((width.unsigned_abs(), height.unsigned_abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_equal_those_of_plotters() {
        for (text, size) in [("", 12.0), ("load F (N)", 14.0), ("Größe, Ø 3 mm", 112.0), ("x", 19.5)] {
            let (width, height) = ("sans-serif", size).into_font().box_size(text).unwrap();
            let (own_width, own_height) = text_size(text, size);
            assert_eq!((own_width.unsigned_abs(), own_height.unsigned_abs()), (width, height), "{text}");
        }
    }
}
