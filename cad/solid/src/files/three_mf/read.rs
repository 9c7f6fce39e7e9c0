//! Reads a package: its meshes in millimetres, its faults, and the configuration in it.

use std::collections::BTreeMap;

use super::archive::{Archive, related_model};
use super::build::{Build, PlacedMesh};
use super::core_spec::{CONTENT_TYPES, RELATIONSHIPS, USUAL_MODEL, fault};
use super::error::ThreeMfReadError;
use super::model::{Model, ModelReader, PackagedMesh};
use crate::validity::Fault;

/// The content of a package.
#[derive(Clone, Debug, Default)]
pub struct ThreeMf {
    /// Its meshes, in the order of the file.
    pub meshes: Vec<PackagedMesh>,
    /// Violations of the specification.
    pub faults: Vec<Fault>,
    /// Solids in their places on the plate.
    pub built: Vec<PlacedMesh>,
    /// The configuration that the package was made from, if pinswitch wrote it.
    pub configuration: Option<String>,
    /// The friction law of its curve, if that is not the default law.
    pub law: Option<String>,
}

/// Reads a 3MF. Nothing is repaired: a fault does not prevent the rest from being read.
///
/// # Errors
/// [`ThreeMfReadError`] if there is no model that can be examined.
pub fn read_three_mf(bytes: &[u8]) -> Result<ThreeMf, ThreeMfReadError> {
    let mut archive = Archive::open(bytes)?;
    let mut reader = ModelReader::default();
    if archive.text(CONTENT_TYPES)?.is_none() {
        reader.faults.push(fault("content types", &format!("{CONTENT_TYPES} is missing")));
    }
    let model_part = match archive.text(RELATIONSHIPS)? {
        Some(text) => related_model(&text)?,
        None => None,
    };
    if model_part.is_none() {
        reader.faults.push(fault("relationships", &format!("{RELATIONSHIPS} names no 3D model")));
    }
    let main_part = model_part.unwrap_or_else(|| USUAL_MODEL.to_owned());
    let text = archive.text(&main_part)?.ok_or(ThreeMfReadError::NoModel)?;
    let mut models = BTreeMap::from([(main_part.clone(), reader.model(&text, &main_part)?)]);
    while let Some(missing) = missing_part(&models) {
        let model = match archive.text(&missing)? {
            Some(text) => reader.model(&text, &missing)?,
            None => {
                reader.faults.push(fault("reference", &format!("{missing} is missing")));
                Model::default()
            }
        };
        models.insert(missing, model);
    }
    let ModelReader { mut faults, configuration, law } = reader;
    let Build { solids, scaled } = Build::of_package(&models, &main_part, &mut faults);
    let main = models.remove(&main_part).into_iter();
    let meshes = main.chain(models.into_values()).flat_map(Model::into_meshes).chain(scaled).collect();
    Ok(ThreeMf { meshes, faults, built: solids, configuration, law })
}

/// Returns a part that is referred to and not yet read.
fn missing_part(models: &BTreeMap<String, Model>) -> Option<String> {
    let referenced = models.values().flat_map(Model::referenced_parts);
    referenced.into_iter().find(|part| !models.contains_key(part))
}
