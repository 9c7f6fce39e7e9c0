//! The silicone in the filled mould: the layer, with what is cut off.

use super::{Cavity, lid, one_piece};
use crate::config::MouldKind;
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

/// Name of the layer in the mould.
pub(crate) const CAST_LAYER: &str = "cast-layer";
/// Name of the silicone in the funnel of the lid.
pub(crate) const CAST_SPRUE: &str = "cast-sprue";
/// Begin of the names of the silicone in the vents of the lid.
pub(crate) const CAST_VENT: &str = "cast-vent";
/// Name of the silicone in the basin of the tray.
pub(crate) const CAST_OVERFILL: &str = "cast-overfill";

/// Returns the bodies of silicone in the filled mould, with their names, in the frame of the mould: its axis is z, and its base is
/// at z = 0. There is none without a mould.
pub(crate) fn cast(design: &Design) -> Vec<(String, Solid)> {
    let m = &design.configuration().mould;
    if m.kind == MouldKind::None {
        return Vec::new();
    }
    let cavity = Cavity::of(design);
    let top = m.floor_mm + cavity.depth_mm;
    let mut bodies = Vec::new();
    let mut add = |name: &str, solid: Option<Solid>| bodies.extend(solid.map(|s| (name.to_owned(), s)));
    add(CAST_LAYER, Solid::prism(&cavity.section(), &[], m.floor_mm, top, 0.0).ok());
    match m.kind {
        MouldKind::None => {}
        MouldKind::OnePiece if m.overfill_mm > 0.0 => {
            let [ledge, brim] = one_piece::basin(design);
            add(CAST_OVERFILL, Some(frustum(ledge, top, brim, top + m.overfill_mm)));
        }
        MouldKind::OnePiece => {}
        MouldKind::Split => {
            let Some((spout, mouth, vents)) = lid::silicone_outlines(design) else { return bodies };
            add(CAST_SPRUE, Some(frustum(spout, top, mouth, top + m.floor_mm)));
            for (number, vent) in (1..).zip(vents) {
                let vent = Solid::prism(&vent, &[], top, top + m.floor_mm, 0.0).ok();
                add(&format!("{CAST_VENT}-{number}"), vent);
            }
        }
    }
    bodies
}

/// A body between two counter-clockwise outlines of as many edges.
fn frustum(lower: Contour, from_mm: f64, upper: Contour, to_mm: f64) -> Solid {
    let mut solid = Solid::new();
    let (bottom, top) = (solid.ring(lower, from_mm), solid.ring(upper, to_mm));
    solid.wall(bottom, top);
    solid.cap(Facing::Down, bottom, &[]);
    solid.cap(Facing::Up, top, &[]);
    solid
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};
    use crate::parts::cavity_mm3;

    /// The bodies have the volume to pour.
    #[test]
    fn the_silicone_has_the_volume_to_pour() {
        for (assignments, number) in [
            (&["mould.kind=split"][..], 4),
            (&["mould.kind=one-piece", "mould.draft_deg=3"], 2),
            (&["mould.kind=one-piece", "mould.overfill_mm=0"], 1),
            (&["mould.kind=none"], 0),
        ] {
            let mut c = Configuration::default();
            assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
            let design = Design::new(c).unwrap();
            let bodies = cast(&design);
            assert_eq!(bodies.len(), number, "{assignments:?}");
            let volume: f64 = bodies.iter().map(|(_, solid)| solid.volume_mm3()).sum();
            let (layer, above) = cavity_mm3(&design);
            assert!(
                number == 0 || (volume / (layer + above) - 1.0).abs() < 1e-9,
                "{assignments:?}: {volume}"
            );
        }
    }
}
