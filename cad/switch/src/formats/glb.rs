//! assembly.glb: the assembly with named bodies and materials, for viewers and web pages.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::hardware::hardware;
use crate::output::{OutputFile, SetError};
use crate::parts::Substance;
use crate::prediction::Prediction;
use pinswitch_solid::files::{GlbBody, GlbMaterial, glb};
use pinswitch_solid::mesh::Mesh;

pub(super) const FORMAT: Format = Format {
    name: "glb",
    about: "assembly.glb: the assembly with materials, for viewers and web pages",
    inclusion: Inclusion::Named,
    make,
};

/// Opacity of silicone.
const SILICONE_OPACITY: f64 = 0.78;

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let bought = hardware(built.design());
    let mut placed: Vec<(&str, Mesh, GlbMaterial<'_>)> = built
        .assembly()
        .filter_map(|body| {
            let mesh = body.part.pose?.apply(body.mesh.clone());
            let (name, opacity) = match body.part.material() {
                Substance::Plastic => (built.design().configuration().process.material.data().name, 1.0),
                Substance::Silicone => ("silicone", SILICONE_OPACITY),
                Substance::Steel => ("steel", 1.0),
            };
            let metal = body.part.material() == Substance::Steel;
            let material = GlbMaterial { name, colour: body.part.role.colour(), opacity, metal };
            Some((body.part.name.as_str(), mesh, material))
        })
        .collect();
    for body in &bought {
        let mesh = body.solid.mesh(built.design().tolerance());
        let mesh = mesh.map_err(SetError::encoding)?;
        let material = GlbMaterial { name: "steel", colour: body.kind.colour(), opacity: 1.0, metal: true };
        placed.push((&body.name, mesh, material));
    }
    let bodies: Vec<GlbBody<'_>> =
        placed.iter().map(|(name, mesh, material)| GlbBody { name, mesh, material: *material }).collect();
    let bytes = glb(manifest.name.as_ref(), &bodies).map_err(SetError::encoding)?;
    Ok(vec![OutputFile::new("assembly.glb", bytes)])
}
