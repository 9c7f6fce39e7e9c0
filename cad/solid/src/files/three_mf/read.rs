//! Reads a package: its meshes in millimetres, its faults, and the configuration in it.

use std::collections::{BTreeMap, HashSet};

use super::archive::Archive;
use super::build::{Build, PlacedMesh};
use super::core_spec::{CONTENT_TYPES, MODEL_TYPE, RELATIONSHIPS, THUMBNAIL_TYPE, USUAL_MODEL};
use super::error::ThreeMfReadError;
use super::findings::Findings;
use super::model::{Model, ModelReader, PackagedMesh};
use super::part_name::{derived, normalized, problem};
use super::relationships::{self, ContentTypes, Relationship, relationships};
use crate::validity::Fault;

/// The content of a package.
#[derive(Clone, Debug, Default)]
pub struct ThreeMf {
    /// Its meshes, in the order of the file.
    pub meshes: Vec<PackagedMesh>,
    /// Deviations from the specification, each kind a few times.
    pub faults: Vec<Fault>,
    /// Solids in their places on the plate.
    pub built: Vec<PlacedMesh>,
    /// The bound that was met before all solids were placed.
    pub bound: Option<String>,
    /// The bound that was met before meshes of all other sizes were returned.
    pub size_bound: Option<String>,
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
    for name in archive.repeated() {
        let detail = format!("two parts have equivalent names: {name}");
        reader.findings.error("part name", "OPC M1.12", &detail);
    }
    if archive.is_repeated() {
        reader.findings.error("part name", "OPC M1.12", "several entries of the archive have the same name");
    }
    check_archive(&mut archive, &mut reader.findings);
    let types = ContentTypes::read(&mut archive, &mut reader.findings)?;
    if types.is_none() {
        reader.findings.error("content types", "OPC M2.4", &format!("{CONTENT_TYPES} is missing"));
    }
    let related = relationships(&mut archive, "", &mut reader.findings)?.unwrap_or_default();
    relationships::check(&related, "", &mut archive, types.as_ref(), &mut reader.findings)?;
    let models = related.into_iter().filter(|one| one.kind == MODEL_TYPE);
    let targets: Vec<String> = models.map(|one| one.key).collect();
    if targets.is_empty() {
        let detail = format!("{RELATIONSHIPS} names no 3D model");
        reader.findings.error("relationships", "3MF core 2.1.1", &detail);
    }
    let present = targets.into_iter().find(|target| archive.contains(target));
    let main_part = present.unwrap_or_else(|| normalized(USUAL_MODEL));
    let text = archive.text(&main_part)?.ok_or(ThreeMfReadError::NoModel)?;
    if let Some(types) = &types {
        types.check_model(&archive.name(&main_part), &mut reader.findings);
        types.check_parts(&archive, &main_part, &mut reader.findings);
    }
    let mut models = BTreeMap::new();
    let mut pending = BTreeMap::from([(main_part.clone(), Some(text))]);
    while let Some((part, text)) = pending.pop_first() {
        let model = match text.map_or_else(|| archive.text(&part), |text| Ok(Some(text)))? {
            Some(text) => {
                let model = reader.model(&text, &part, &archive.name(&part))?;
                check_relationships(&mut archive, &part, types.as_ref(), &mut reader)?;
                model
            }
            None => {
                let detail = format!("{part} is missing");
                reader.findings.error("reference", "3MF core 2.1.1", &detail);
                Model::default()
            }
        };
        let referenced = model.referenced_parts().into_iter().map(str::to_owned).collect::<Vec<_>>();
        models.insert(part, model);
        pending.extend(
            referenced.into_iter().filter(|part| !models.contains_key(part)).map(|part| (part, None)),
        );
    }
    let ModelReader { mut findings, configuration, law, .. } = reader;
    let build = Build::of_package(&models, &main_part, &mut findings);
    let main = models.remove(&main_part).into_iter();
    let scaled = build.scaled;
    let meshes = main.chain(models.into_values()).flat_map(Model::into_meshes).chain(scaled).collect();
    let (built, bound, size_bound) = (build.solids, build.bound, build.size_bound);
    let faults = findings.finish();
    Ok(ThreeMf { meshes, faults, built, bound, size_bound, configuration, law })
}

/// Reports names of parts that are not valid, and methods of compression that are not allowed.
fn check_archive(archive: &mut Archive<'_>, findings: &mut Findings) {
    for name in archive.names() {
        if let Some((problem, paragraph)) = problem(name) {
            findings.error("part name", paragraph, &format!("the part name {name} {problem}"));
        }
    }
    for name in derived(archive.names()) {
        let detail = format!("the part name {name} is that of another part with more segments");
        findings.error("part name", "OPC M1.11", &detail);
    }
    for name in archive.unusual() {
        let detail = format!("{name} is compressed with another method than Deflate");
        findings.error("compression", "OPC ZIP", &detail);
    }
}

/// Checks the relationships of the model in `part`, which was read last.
fn check_relationships(
    archive: &mut Archive<'_>,
    part: &str,
    types: Option<&ContentTypes>,
    reader: &mut ModelReader,
) -> Result<(), ThreeMfReadError> {
    let all = relationships(archive, part, &mut reader.findings)?.unwrap_or_default();
    relationships::check(&all, part, archive, types, &mut reader.findings)?;
    let is_thumbnail = |one: &&Relationship| THUMBNAIL_TYPES.contains(&one.kind.as_str());
    let thumbnails: HashSet<&str> = all.iter().filter(is_thumbnail).map(|one| one.key.as_str()).collect();
    for (id, target) in std::mem::take(&mut reader.thumbnails) {
        if !thumbnails.contains(target.as_str()) {
            let detail = format!("the thumbnail of object {id} has no relationship of that type");
            reader.findings.warning("thumbnail", "3MF core 4", &detail);
        }
    }
    let textures: HashSet<&str> =
        all.iter().filter(|one| one.kind == TEXTURE_TYPE).map(|one| one.key.as_str()).collect();
    for target in std::mem::take(&mut reader.textures) {
        if !archive.contains(&target) {
            reader.findings.error("texture", "3MF materials 6", &format!("the texture {target} is missing"));
        } else if !textures.contains(target.as_str()) {
            let detail = format!("the texture {target} has no relationship of that type");
            reader.findings.error("texture", "3MF materials 6", &detail);
        }
    }
    Ok(())
}

/// Type of relationships to a texture.
const TEXTURE_TYPE: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture";
/// Types of relationships to the thumbnail of an object: the second is that of older files.
const THUMBNAIL_TYPES: [&str; 2] = [THUMBNAIL_TYPE, TEXTURE_TYPE];
