//! The legend of a figure: the layout of plotters with text sizes that are the same on every
//! platform (see `text_size`).

use plotters::coord::Shift;
use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use crate::PlotError;
use crate::text_size::{Svg, text_size};

/// Distance from the corner of the figure, in units of the drawing.
const CORNER: i32 = 5;
/// Line spacing, in font sizes.
const LINE_SPACING: f64 = 1.25;

type Sample<'a> = Box<dyn Fn((i32, i32)) -> DynElement<'a, Svg<'a>, (i32, i32)> + 'a>;

/// Lines of a legend, each with a sample and a label.
#[derive(Default)]
pub(crate) struct Legend<'a>(Vec<(String, Sample<'a>)>);

/// Sizes of a legend, in units of the drawing.
#[derive(Clone, Copy)]
pub(crate) struct Measures {
    /// Margin around the legend.
    pub(crate) margin: i32,
    /// Width of the samples.
    pub(crate) samples: i32,
    /// Size of the font.
    pub(crate) font: i32,
    /// Width of the border.
    pub(crate) border: u32,
}

impl<'a> Legend<'a> {
    /// Adds a line; `sample` gets its left end, at half the height of the line.
    pub(crate) fn line<E: IntoDynElement<'a, Svg<'a>, (i32, i32)>>(
        &mut self,
        label: impl Into<String>,
        sample: impl Fn((i32, i32)) -> E + 'a,
    ) {
        self.0.push((label.into(), Box::new(move |at| sample(at).into_dyn())));
    }

    /// Draws the legend in the upper left corner of `area`.
    ///
    /// # Errors
    /// [`PlotError`] if the drawing library refuses a coordinate.
    pub(crate) fn draw(
        &self,
        area: &DrawingArea<Svg<'a>, Shift>,
        measures: Measures,
    ) -> Result<(), PlotError> {
        let Measures { margin, samples, font, border } = measures;
        let size = f64::from(font);
        // A legend has a handful of lines.
        #[allow(clippy::cast_possible_truncation)]
        let top = |line: usize| (line as f64 * size * LINE_SPACING).round() as i32;
        let sizes: Vec<_> = self.0.iter().map(|(label, _)| text_size(label, size)).collect();
        let width = sizes.iter().map(|(width, _)| *width).max().unwrap_or(0) + samples + 2 * margin;
        let height = sizes.iter().enumerate().map(|(i, (_, h))| top(i) + h).max().unwrap_or(0) + 2 * margin;
        let corners = [(CORNER, CORNER), (CORNER + width, CORNER + height)];
        area.draw(&Rectangle::new(corners, WHITE.mix(0.9).filled())).map_err(|e| PlotError::new(&e))?;
        area.draw(&Rectangle::new(corners, BLACK.mix(0.3).stroke_width(border)))
            .map_err(|e| PlotError::new(&e))?;
        let (left, first) = (CORNER + samples + margin, CORNER + margin);
        for (i, (label, _)) in self.0.iter().enumerate() {
            let text = Text::new(label.clone(), (left, first + top(i)), ("sans-serif", font));
            area.draw(&text).map_err(|e| PlotError::new(&e))?;
        }
        for (i, ((_, sample), (_, height))) in self.0.iter().zip(&sizes).enumerate() {
            let low = first + top(i);
            area.draw(&sample((CORNER + margin, (low + low + height) / 2)))
                .map_err(|e| PlotError::new(&e))?;
        }
        Ok(())
    }
}
