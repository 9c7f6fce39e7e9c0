//! Bodies to draw: assembled, exploded, or side by side on a plate.

use crate::built::Built;
use crate::output::SetError;
use pinswitch_solid::files::lay_out;
use pinswitch_solid::mesh::Mesh;
use pinswitch_solid::render::{Body, View, render};

/// The assembly; `explosion` from 0, in place, to 1, pulled apart.
pub fn assembled(built: &Built, explosion: f64) -> Vec<Body> {
    built
        .assembly()
        .filter_map(|body| {
            let role = body.part.role;
            let placed = body.part.pose?.apply(body.mesh.clone());
            Some(Body {
                mesh: placed.translated(role.explode_offset_mm() * explosion),
                colour: role.colour(),
            })
        })
        .collect()
}

/// Printed parts side by side, as they are printed.
pub fn plate(built: &Built) -> Vec<Body> {
    let meshes: Vec<&Mesh> = built.printed().iter().map(|p| &p.body.mesh).collect();
    let shifts = lay_out(&meshes);
    built
        .printed()
        .iter()
        .zip(shifts)
        .map(|(p, shift)| Body {
            mesh: p.body.mesh.clone().translated(shift),
            colour: p.part().role.colour(),
        })
        .collect()
}

/// Pixels of the picture of the exploded assembly, across and up.
const EXPLODED_PIXELS: (u32, u32) = (900, 675);

/// The exploded assembly as PNG: drawn when a format first asks for it, and kept.
///
/// # Errors
/// [`SetError::Encoding`] if the picture cannot be encoded.
pub fn exploded_png(built: &Built) -> Result<&[u8], SetError> {
    if let Some(known) = built.kept_picture().get() {
        return Ok(known);
    }
    let view = View { turn_deg: 30.0, rise_deg: 40.0 };
    let (width, height) = EXPLODED_PIXELS;
    let png = render(&assembled(built, 1.0), view, width, height).png().map_err(SetError::encoding)?;
    Ok(built.kept_picture().get_or_init(|| png))
}
