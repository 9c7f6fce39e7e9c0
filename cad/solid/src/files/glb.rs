//! GLB (glTF 2.0, binary): named bodies with materials, for viewers and web pages.

use pinswitch_diagnostic::{Diagnostic, codes};
use serde_json::{Value, json};

use crate::mesh::Mesh;

/// A body of a scene.
#[derive(Clone, Debug)]
pub struct GlbBody<'a> {
    /// Name of the node.
    pub name: &'a str,
    /// Mesh in its place, in millimetres.
    pub mesh: &'a Mesh,
    /// Material.
    pub material: GlbMaterial<'a>,
}

/// A material. Equal materials are written once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlbMaterial<'a> {
    /// Name.
    pub name: &'a str,
    /// Red, green, blue in sRGB.
    pub colour: [u8; 3],
    /// Opacity from 0 (transparent) to 1.
    pub opacity: f64,
    /// Whether the material is a metal.
    pub metal: bool,
}

/// A scene that is too large for the format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot write the GLB: the bodies take more than four gigabytes")]
pub struct GlbError;

impl From<GlbError> for Diagnostic {
    fn from(error: GlbError) -> Self {
        Self::new(codes::FILE_TOO_LARGE, error.to_string()).with_help("raise the chord tolerance")
    }
}

const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// Metres per millimetre: the unit of glTF is the metre.
const METRES: f64 = 1e-3;

/// Returns the scene `name` of `bodies`, with the y axis up. The same input gives the same bytes.
///
/// # Errors
/// [`GlbError`] if the file is longer than four gigabytes.
pub fn glb(name: &str, bodies: &[GlbBody<'_>]) -> Result<Vec<u8>, GlbError> {
    let mut data = Vec::new();
    let (mut views, mut accessors, mut meshes, mut nodes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut materials: Vec<GlbMaterial<'_>> = Vec::new();
    for body in bodies {
        let material = materials.iter().position(|m| *m == body.material).unwrap_or_else(|| {
            materials.push(body.material);
            materials.len() - 1
        });
        let first = accessors.len();
        accessors.push(positions(body.mesh, views.len(), body.mesh.positions.len()));
        accessors.push(json!({
            "bufferView": views.len() + 1, "componentType": UNSIGNED_INT, "type": "SCALAR",
            "count": 3 * body.mesh.triangles.len(),
        }));
        let vertices: Vec<u8> =
            body.mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(bytes).collect();
        views.push(view(&mut data, &vertices, VERTICES));
        let indices: Vec<u8> = body.mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        views.push(view(&mut data, &indices, INDICES));
        nodes.push(json!({ "name": body.name, "mesh": meshes.len() }));
        meshes.push(json!({
            "name": body.name,
            "primitives": [{ "attributes": { "POSITION": first }, "indices": first + 1, "material": material }],
        }));
    }
    let root = nodes.len();
    let children: Vec<usize> = (0..root).collect();
    nodes.push(json!({ "name": name, "scale": [METRES, METRES, METRES], "children": children }));
    let scene = json!({
        "asset": { "version": "2.0", "generator": concat!("pinswitch ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "name": name, "nodes": [root] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials.iter().map(material_json).collect::<Vec<_>>(),
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": data.len() }],
    });
    let mut text = scene.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |n: usize| u32::try_from(n).map_err(|_| GlbError);
    let mut out = Vec::with_capacity(28 + text.len() + data.len());
    let header = [MAGIC, 2, length(28 + text.len() + data.len())?, length(text.len())?, JSON_CHUNK];
    header.iter().for_each(|word| out.extend(word.to_le_bytes()));
    out.extend(&text);
    [length(data.len())?, BINARY_CHUNK].iter().for_each(|word| out.extend(word.to_le_bytes()));
    out.extend(&data);
    Ok(out)
}

/// A number in single precision, with -0 as +0.
#[allow(clippy::cast_possible_truncation)]
fn single(value: f64) -> f32 {
    value as f32 + 0.0
}

fn bytes(value: f64) -> [u8; 4] {
    single(value).to_le_bytes()
}

/// The accessor of the vertices of a mesh, with the bounds that the format requires.
fn positions(mesh: &Mesh, view: usize, count: usize) -> Value {
    let (low, high) = mesh.bounds().unwrap_or_default();
    let corner = |p: crate::mesh::Point3| [p.x, p.y, p.z].map(single);
    json!({
        "bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": count,
        "min": corner(low), "max": corner(high),
    })
}

/// Appends bytes, whose number is a multiple of four, and returns their buffer view.
fn view(data: &mut Vec<u8>, bytes: &[u8], target: u32) -> Value {
    let offset = data.len();
    data.extend(bytes);
    json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len(), "target": target })
}

/// A material in glTF, with linear colours.
fn material_json(material: &GlbMaterial<'_>) -> Value {
    let linear = |c: u8| {
        let share = f64::from(c) / 255.0;
        let value = if share <= 0.040_45 { share / 12.92 } else { libm::pow((share + 0.055) / 1.055, 2.4) };
        (value * 1e6).round() / 1e6
    };
    let [red, green, blue] = material.colour.map(linear);
    let mut value = json!({
        "name": material.name,
        "doubleSided": false,
        "pbrMetallicRoughness": {
            "baseColorFactor": [red, green, blue, material.opacity],
            "metallicFactor": if material.metal { 1.0 } else { 0.0 },
            "roughnessFactor": if material.metal { 0.35 } else { 0.75 },
        },
    });
    if material.opacity < 1.0 {
        value["alphaMode"] = json!("BLEND");
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Point3;

    #[test]
    fn a_scene_matches_its_header() {
        let positions = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
        let mesh = Mesh::new(
            positions.map(|[x, y, z]| Point3::new(x, y, z)).to_vec(),
            vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        );
        let material = GlbMaterial { name: "abs", colour: [255, 128, 0], opacity: 1.0, metal: false };
        let body = |name| GlbBody { name, mesh: &mesh, material };
        let file = glb("two", &[body("a"), body("b")]).unwrap();
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
        let scene: Value = serde_json::from_slice(&file[20..20 + word(12)]).unwrap();
        assert_eq!(scene["nodes"].as_array().unwrap().len(), 3);
        assert_eq!(scene["materials"].as_array().unwrap().len(), 1);
        assert_eq!(scene["accessors"][0]["max"], json!([9.0, 9.0, 9.0]));
        assert_eq!(scene["buffers"][0]["byteLength"], 2 * (4 * 12 + 4 * 12));
        assert_eq!(word(20 + word(12)), 2 * (4 * 12 + 4 * 12));
    }
}
