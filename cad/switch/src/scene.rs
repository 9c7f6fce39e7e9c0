//! Bodies to draw: assembled, exploded, or side by side on a plate.

use crate::built::Built;
use pinswitch_solid::files::lay_out;
use pinswitch_solid::mesh::Mesh;
use pinswitch_solid::render::Body;

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
