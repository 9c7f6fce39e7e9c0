//! Bodies in their places: assembled, pulled apart, or side by side on a plate, for pictures and for the page.

use crate::config::ConfigError;
use crate::design::Design;
use crate::formats::lay_out;
use crate::mesh::{Mesh, Vector3};
use crate::parts::{Material, Part, printed, reference_bodies};
use crate::render::Body;
use crate::solid::CapError;

/// A body in its place in the assembly.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The part.
    pub part: Part,
    /// Its mesh, in place; the pulley's axis is the z axis.
    pub mesh: Mesh,
    /// The way along which it comes out, mm.
    pub way_out: Vector3,
    /// Its colour: red, green, blue.
    pub colour: [u8; 3],
}

/// A scene cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The configuration asks for something that cannot be built.
    #[error(transparent)]
    Configuration(#[from] ConfigError),
    /// A part's contours cross.
    #[error("{part}: {source}; please report the configuration")]
    Cap {
        /// The part.
        part: String,
        /// Where.
        source: CapError,
    },
}

/// Colour of a part: red, green, blue.
pub fn colour(part: &Part) -> [u8; 3] {
    match (part.material, part.name.as_str()) {
        (Material::Steel, _) => [205, 210, 218],
        (Material::Silicone, _) => [120, 190, 225],
        (_, name) if name.starts_with("support") => [236, 178, 74],
        (_, name) if name.starts_with("mould") => [150, 178, 126],
        (_, "shell") => [226, 226, 220],
        _ => [196, 170, 205],
    }
}

fn mesh(part: &Part, design: &Design) -> Result<Mesh, SceneError> {
    part.mesh(design).map_err(|source| SceneError::Cap { part: part.name.clone(), source })
}

/// Everything that belongs into the assembly, in its place. The proxy stands in for the silicone only where there is none.
///
/// # Errors
/// [`SceneError`] if a part cannot be built.
pub fn assembly(design: &Design) -> Result<Vec<Placed>, SceneError> {
    let reference = reference_bodies(design)?;
    let rigid = reference.iter().all(|b| b.material != Material::Silicone);
    let printed = printed(design)?.into_iter().filter(|p| rigid || p.name != "proxy");
    printed
        .chain(reference)
        .filter_map(|part| part.pose.map(|pose| (part, pose)))
        .map(|(part, pose)| {
            let way_out = match (part.name.as_str(), part.material) {
                ("support-left", _) => Vector3::new(0.0, 0.0, -12.0),
                ("support-right", _) => Vector3::new(0.0, 0.0, 12.0),
                ("proxy", _) | (_, Material::Silicone) => Vector3::new(0.0, 7.0, 0.0),
                (_, Material::Steel) => Vector3::new(0.0, 14.0, 0.0),
                _ => Vector3::zeros(),
            };
            Ok(Placed { mesh: pose.apply(mesh(&part, design)?), colour: colour(&part), way_out, part })
        })
        .collect()
}

/// The assembly as bodies to draw; `apart` from 0, in place, to 1, pulled apart.
///
/// # Errors
/// As [`assembly`].
pub fn assembled(design: &Design, apart: f64) -> Result<Vec<Body>, SceneError> {
    let placed = assembly(design)?;
    Ok(placed
        .into_iter()
        .map(|p| Body { mesh: p.mesh.translated(p.way_out * apart), colour: p.colour })
        .collect())
}

/// Printed parts side by side, as they are printed.
///
/// # Errors
/// As [`assembly`].
pub fn plate(design: &Design) -> Result<Vec<Body>, SceneError> {
    let parts = printed(design)?;
    let meshes = parts.iter().map(|p| mesh(p, design)).collect::<Result<Vec<_>, _>>()?;
    let places = lay_out(&meshes);
    let bodies = parts.iter().zip(meshes).zip(places);
    Ok(bodies.map(|((part, mesh), by)| Body { mesh: mesh.translated(by), colour: colour(part) }).collect())
}
