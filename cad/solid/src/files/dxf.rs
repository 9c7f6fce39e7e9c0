//! DXF (R12) of profiles: exact lines and arcs, one layer per height.
//!
//! Every laser cutter and CAD program reads R12. Libraries that write whole drawings add time
//! stamps and random handles, so that the same input would not give the same bytes.

use std::fmt::Write as _;

use crate::profile::{Contour, Edge};
use crate::solid::Solid;

/// Returns the contours of `solid` at every height, in mm, seen from above.
pub fn dxf(solid: &Solid) -> String {
    let mut text = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
        .to_owned();
    for (contour, z_mm) in solid.rings() {
        entities(&mut text, contour, &format!("Z{z_mm:.3}").replace(['.', '-'], "_"));
    }
    text.push_str("0\nENDSEC\n0\nEOF\n");
    text
}

fn entities(text: &mut String, contour: &Contour, layer: &str) {
    for (i, edge) in contour.edges().iter().enumerate() {
        let (from, to) = contour.ends(i);
        let _ = match edge {
            Edge::Line => write!(
                text,
                "0\nLINE\n8\n{layer}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n",
                from.x, from.y, to.x, to.y
            ),
            Edge::Arc(arc) => {
                // DXF arcs run counter-clockwise from their first angle to their second.
                let (a, b) = (arc.start_rad, arc.start_rad + arc.sweep_rad);
                let (first, second) = if arc.sweep_rad > 0.0 { (a, b) } else { (b, a) };
                let degrees = |angle: f64| angle.to_degrees().rem_euclid(360.0);
                write!(
                    text,
                    "0\nARC\n8\n{layer}\n10\n{}\n20\n{}\n40\n{}\n50\n{}\n51\n{}\n",
                    arc.centre.x,
                    arc.centre.y,
                    arc.radius_mm,
                    degrees(first),
                    degrees(second)
                )
            }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Point2;

    #[test]
    fn a_disc_is_two_arcs_at_two_heights() {
        let disc = Contour::circle(Point2::new(1.0, 2.0), 3.0);
        let text = dxf(&Solid::prism(&disc, &[], 0.0, 2.5, 0.0).unwrap());
        assert_eq!(text.matches("\nARC\n").count(), 4);
        assert!(text.contains("8\nZ2_500\n10\n1\n20\n2\n40\n3\n50\n0\n51\n180\n"), "{text}");
        assert!(text.starts_with("0\nSECTION") && text.ends_with("0\nEOF\n"));
    }
}
