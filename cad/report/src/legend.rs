//! The legend of a figure, laid out as plotters lays it out, with sizes of text that are the same on every platform (see
//! `text_size`).

use plotters::coord::Shift;
use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use crate::text_size::{Svg, text_size};

/// From a corner of the figure to the legend, in units of the drawing.
const CORNER: i32 = 5;
/// From line to line, in sizes of the font.
const LINE: f64 = 1.25;

type Sample<'a> = Box<dyn Fn((i32, i32)) -> DynElement<'a, Svg<'a>, (i32, i32)> + 'a>;

/// Lines of a legend: a sample of what is drawn, and what it is.
#[derive(Default)]
pub(crate) struct Legend<'a>(Vec<(String, Sample<'a>)>);

/// Sizes of a legend, in units of the drawing.
#[derive(Clone, Copy)]
pub(crate) struct Measures {
    /// Around all of it.
    pub(crate) margin: i32,
    /// Width of the samples.
    pub(crate) samples: i32,
    /// Size of the font.
    pub(crate) font: i32,
    /// Width of the border.
    pub(crate) border: u32,
}

impl<'a> Legend<'a> {
    /// Adds a line whose sample begins at the left end that it is given, in the middle of the line.
    pub(crate) fn line<E: IntoDynElement<'a, Svg<'a>, (i32, i32)>>(
        &mut self,
        label: impl Into<String>,
        sample: impl Fn((i32, i32)) -> E + 'a,
    ) {
        self.0.push((label.into(), Box::new(move |at| sample(at).into_dyn())));
    }

    /// Draws it into the upper left corner of `area`.
    ///
    /// # Errors
    /// What the drawing library says.
    pub(crate) fn draw(&self, area: &DrawingArea<Svg<'a>, Shift>, measures: Measures) -> Result<(), String> {
        let Measures { margin, samples, font, border } = measures;
        let size = f64::from(font);
        // A legend has a handful of lines.
        #[allow(clippy::cast_possible_truncation)]
        let top = |line: usize| (line as f64 * size * LINE).round() as i32;
        let sizes: Vec<_> = self.0.iter().map(|(label, _)| text_size(label, size)).collect();
        let width = sizes.iter().map(|(width, _)| *width).max().unwrap_or(0) + samples + 2 * margin;
        let height = sizes.iter().enumerate().map(|(i, (_, h))| top(i) + h).max().unwrap_or(0) + 2 * margin;
        let corners = [(CORNER, CORNER), (CORNER + width, CORNER + height)];
        area.draw(&Rectangle::new(corners, WHITE.mix(0.9).filled())).map_err(|e| e.to_string())?;
        area.draw(&Rectangle::new(corners, BLACK.mix(0.3).stroke_width(border)))
            .map_err(|e| e.to_string())?;
        let (left, first) = (CORNER + samples + margin, CORNER + margin);
        for (i, (label, _)) in self.0.iter().enumerate() {
            let text = Text::new(label.clone(), (left, first + top(i)), ("sans-serif", font));
            area.draw(&text).map_err(|e| e.to_string())?;
        }
        for (i, ((_, sample), (_, height))) in self.0.iter().zip(&sizes).enumerate() {
            let low = first + top(i);
            area.draw(&sample((CORNER + margin, (low + low + height) / 2))).map_err(|e| e.to_string())?;
        }
        Ok(())
    }
}
