//! General notes of a part.

use super::features::Features;
use super::text::number;

/// Names of features, where a drawing has no better ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Terms {
    /// The axis of the part, such as `the pulley's axis`.
    pub axis: String,
    /// A pocket of a pattern, in the singular; its plural ends in `s`.
    pub pocket: String,
    /// A round boss with a fit.
    pub boss: String,
}

impl Default for Terms {
    fn default() -> Self {
        Self { axis: "the axis".to_owned(), pocket: "pocket".to_owned(), boss: "peg".to_owned() }
    }
}

/// Notes about the faces and edges of the part.
pub(super) fn first_notes(f: &Features, chamfer_mm: f64) -> Vec<String> {
    let mut notes = Vec::new();
    if chamfer_mm > 0.0 {
        notes.push(format!("Bottom edges {} \u{d7} 45\u{b0}", number(chamfer_mm)));
    }
    if !f.is_axial() && !f.slots.is_empty() {
        notes.push("Slots through, with full radius ends".to_owned());
    }
    notes
}

/// Notes about how dimensions are to be read.
pub(super) fn reading_notes(f: &Features, terms: &Terms, has_positions: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if has_positions {
        notes.push("Framed angles, and radii of centres: theoretically exact".to_owned());
    }
    if f.bores.iter().any(|b| !b.is_plain()) {
        notes.push("Near face: the face in the front view".to_owned());
    }
    if let Some(pattern) = f.pattern {
        notes.push(format!(
            "{} equal {pocket}s: dimensions of one {pocket} apply to all",
            pattern.number,
            pocket = terms.pocket
        ));
    }
    if f.has_hole_table() {
        notes.push("Outline: lines tangent to the arcs".to_owned());
    }
    if f.is_axial() {
        let of_pocket = format!("the axis of the {}", terms.pocket);
        let axis = if f.pattern.is_some() { &of_pocket } else { &terms.axis };
        notes.push(format!("Radii without a centre mark are about {axis}"));
        notes.push("Angles from the middle plane, positive to the right".to_owned());
    }
    notes
}
