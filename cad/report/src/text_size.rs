//! How large text is taken to be where a figure is laid out: the same on every platform.
//!
//! A figure of vectors is drawn with whatever font its reader has, so that any size is a guess. plotters guesses from the
//! number of bytes, but asks the document's canvas where it is compiled for a browser: there a worker has none, and the
//! figure would be another one. The guess below is that of plotters, for all platforms.

use plotters::prelude::*;
use plotters_backend::{BackendColor, BackendStyle, BackendTextStyle, DrawingErrorKind};

/// Sizes of fonts in plotters are larger than those that it writes.
const WRITTEN: f64 = 1.24;
/// Widths of letters, and how far they reach below their line, as shares of their height.
const WIDTH: f64 = 0.7;
const BELOW: f64 = 0.24;

/// Width and height of `text` in a font of this size, all in units of the drawing.
pub(crate) fn text_size(text: &str, size: f64) -> (i32, i32) {
    let em = size / WRITTEN / WRITTEN;
    // A drawing has some ten thousand units.
    #[allow(clippy::cast_possible_truncation)]
    let whole = |length: f64| length.round() as i32;
    (whole(em * WIDTH * text.len() as f64), whole(em) + whole(em * BELOW))
}

/// Draws an SVG, and knows how large text is.
pub(crate) struct Svg<'a>(SVGBackend<'a>);

impl<'a> Svg<'a> {
    /// A drawing of this size in its own units, written into `buffer`.
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
    fn text_is_as_large_as_plotters_takes_it_to_be() {
        for (text, size) in [("", 12.0), ("load F (N)", 14.0), ("Größe, Ø 3 mm", 112.0), ("x", 19.5)] {
            let (width, height) = ("sans-serif", size).into_font().box_size(text).unwrap();
            let (own_width, own_height) = text_size(text, size);
            assert_eq!((own_width.unsigned_abs(), own_height.unsigned_abs()), (width, height), "{text}");
        }
    }
}
