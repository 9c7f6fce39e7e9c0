//! The legend of a figure in columns, in an area of its own: samples with labels, whose sizes are the
//! same on every platform (see `text_size`).

use plotters::coord::Shift;
use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use crate::PlotError;
use crate::text_size::{Svg, text_size};

/// Line spacing, in font sizes.
const LINE_SPACING: f64 = 1.25;

type Sample<'a> = Box<dyn Fn((i32, i32)) -> DynElement<'a, Svg<'a>, (i32, i32)> + 'a>;

/// Lines of a legend, each with a sample and a label.
#[derive(Default)]
pub(crate) struct Legend<'a>(Vec<(String, Sample<'a>)>);

/// Sizes of a legend, in units of the drawing.
#[derive(Clone, Copy)]
pub(crate) struct Measures {
    /// Margin left of the first column, and right of the last.
    pub(crate) margin: i32,
    /// Width of the samples.
    pub(crate) samples: i32,
    /// Size of the font.
    pub(crate) font: i32,
    /// Number of columns.
    pub(crate) columns: usize,
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

    /// Draws the legend from the top of `area`, column by column.
    ///
    /// # Errors
    /// [`PlotError`] if the drawing library refuses a coordinate.
    pub(crate) fn draw(
        &self,
        area: &DrawingArea<Svg<'a>, Shift>,
        measures: Measures,
    ) -> Result<(), PlotError> {
        let Measures { margin, samples, font, columns } = measures;
        let size = f64::from(font);
        let rows = self.0.len().div_ceil(columns.max(1)).max(1);
        // A drawing has some ten thousand units, and a legend a handful of lines.
        #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)]
        let column_width = (area.dim_in_pixel().0 as i32 - 2 * margin) / columns.max(1) as i32;
        for (i, (label, sample)) in self.0.iter().enumerate() {
            #[allow(clippy::cast_possible_truncation, clippy::cast_possible_wrap)]
            let (left, top) = (
                margin + column_width * (i / rows) as i32,
                ((i % rows) as f64 * size * LINE_SPACING).round() as i32,
            );
            let text = Text::new(label.clone(), (left + samples, top), ("sans-serif", font));
            area.draw(&text).map_err(|e| PlotError::new(&e))?;
            let (_, height) = text_size(label, size);
            area.draw(&sample((left, top + height / 2))).map_err(|e| PlotError::new(&e))?;
        }
        Ok(())
    }
}
