//! A dimension or callout that is still to be placed on a sheet.

use super::fit::Fit;
use crate::{Angular, Callout, DatumMark, Draft, Extent, Label, Leader, Linear, Point};

/// A dimension that is still to be placed.
#[derive(Clone, Debug)]
pub(super) struct Dimension {
    /// What it measures; unique on a sheet.
    pub(super) key: String,
    lines: Vec<String>,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A length, and its alternative on the other side of the view.
    Linear(Linear, Option<Linear>),
    Angular(Angular),
    Callout(Callout),
    Label(Label),
    Datum(DatumMark),
}

impl Dimension {
    pub(super) fn linear(linear: Linear) -> Self {
        Self { key: linear.key.clone(), lines: vec![linear.text.clone()], kind: Kind::Linear(linear, None) }
    }

    /// The same length, on the other side of the view if there is no space on the first.
    pub(super) fn or(mut self, other: Linear) -> Self {
        if let Kind::Linear(_, alternative) = &mut self.kind {
            *alternative = Some(other);
        }
        self
    }

    pub(super) fn angular(angular: Angular) -> Self {
        Self { key: angular.key.clone(), lines: vec![angular.text.clone()], kind: Kind::Angular(angular) }
    }

    pub(super) fn label(label: Label) -> Self {
        Self { key: label.key.clone(), lines: vec![label.text.clone()], kind: Kind::Label(label) }
    }

    pub(super) fn callout(key: impl Into<String>, lines: Vec<String>, leaders: Vec<Leader>) -> Self {
        Self::callout_around(key.into(), lines, leaders, None)
    }

    /// A callout with the geometrical tolerances and the datum of a fit.
    pub(super) fn fitted_callout(
        key: impl Into<String>,
        lines: Vec<String>,
        leaders: Vec<Leader>,
        fit: &Fit,
    ) -> Self {
        let mut dimension = Self::callout(key, lines, leaders);
        if let Kind::Callout(callout) = &mut dimension.kind {
            callout.indicators.clone_from(&fit.indicators);
            callout.datum = fit.datum;
        }
        dimension
    }

    pub(super) fn datum(mark: DatumMark) -> Self {
        Self { key: mark.key.clone(), lines: vec![mark.letter.to_string()], kind: Kind::Datum(mark) }
    }

    /// The letter of a detail at the circle around what the detail shows.
    pub(super) fn mark_of_detail(at: Point, radius_mm: f64, letter: &str) -> Self {
        let leaders = Leader::to_circle(at, radius_mm);
        let key = format!("mark of detail {letter}");
        Self::callout_around(key, vec![letter.to_owned()], leaders, Some((at, radius_mm)))
    }

    fn callout_around(
        key: String,
        lines: Vec<String>,
        leaders: Vec<Leader>,
        around: Option<(Point, f64)>,
    ) -> Self {
        let callout = Callout {
            key: key.clone(),
            lines: lines.clone(),
            leaders,
            is_balloon: false,
            avoid: Vec::new(),
            around,
            indicators: Vec::new(),
            datum: None,
        };
        Self { key, lines, kind: Kind::Callout(callout) }
    }

    /// Returns whether it is a length below a front view.
    pub(super) fn is_below(&self, front: Extent) -> bool {
        matches!(&self.kind, Kind::Linear(l, _) if !l.upright && l.outward < 0.0 && l.edge_mm == front.low.y)
    }

    /// Draws it; returns whether there was space.
    pub(super) fn place(&self, draft: &mut Draft) -> bool {
        match &self.kind {
            Kind::Linear(l, other) => {
                l.place(draft) || other.as_ref().is_some_and(|other| other.place(draft))
            }
            Kind::Angular(a) => a.place(draft),
            Kind::Callout(c) => c.place(draft),
            Kind::Label(l) => l.place(draft),
            Kind::Datum(d) => d.place(draft),
        }
    }

    /// The dimension as a note, for one that finds no space near its feature.
    pub(super) fn to_note(&self) -> String {
        let text = match &self.kind {
            Kind::Callout(callout) => callout.content().join(", "),
            _ => self.lines.join(", "),
        };
        // Some keys end in the text, so that they are unique.
        if self.key.ends_with(&text) { self.key.clone() } else { format!("{}: {text}", self.key) }
    }
}

/// `key` for the first of its kind, `key 2` for the second.
pub(super) fn numbered(key: &str, index: usize) -> String {
    if index == 0 { key.to_owned() } else { format!("{key} {}", index + 1) }
}
