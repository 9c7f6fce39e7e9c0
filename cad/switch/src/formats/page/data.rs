//! The data of the page: meshes, positions, the tendon at several loads, curves and tables.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pinswitch_friction::physics::contact_profiles;
use pinswitch_friction::{Direction, FrictionCurve, PublishedPoint, Substrate, published_points};
use serde::Serialize;

use super::joint::JointStates;
use crate::built::{Built, MeshedBody};
use crate::design::Design;
use crate::design::rules::{Check, checklist};
use crate::documents::{Manifest, friction_csv, layout_text};
use crate::parts::{Role, Substance};
use crate::prediction::Prediction;
use pinswitch_solid::mesh::{Mesh, Vector3};
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::polar;

/// Number of loads of pins and tendon.
const STATES: usize = 25;

/// Most corners of a mesh whose indices have two bytes.
const SHORT_INDICES: usize = 1 << 16;
/// Steps per mm of the gaps of the tendon: 0.1 µm, far below what a picture shows.
const GAP_STEPS: f64 = 1e4;

/// Lightest load as a share of the heaviest. Without load, the shape of the tendon is undefined.
const MIN_SHARE: f64 = 1e-3;

/// The data of the page.
#[derive(Debug, Serialize)]
pub struct PageData {
    layout: String,
    meshes: Vec<MeshData>,
    bodies: Vec<Body>,
    contact: ContactStates,
    /// The joint at several flexions, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<JointStates>,
    curve: FrictionCurve,
    other_laws: Vec<FrictionCurve>,
    published: Vec<PublishedPoint>,
    friction_csv: String,
    checks: Vec<Check>,
    manifest: Manifest,
}

/// A mesh, little-endian and base64: corners in single precision, and indices of two bytes if these are enough, else of
/// four. `file` is the STL of a printed part.
#[derive(Debug, Serialize)]
struct MeshData {
    file: Option<String>,
    positions: String,
    triangles: String,
}

/// A body of the assembly.
#[derive(Debug, Serialize)]
struct Body {
    name: String,
    material: Substance,
    colour: [u8; 3],
    mesh: usize,
    /// From the mesh to the assembly, column by column.
    matrix: [f64; 16],
    explode_offset: [f64; 3],
    sink: Option<Sink>,
}

/// Direction in which a pin sinks, and its depth at each load.
#[derive(Debug, Serialize)]
struct Sink {
    towards: [f64; 2],
    depth_mm: Vec<f64>,
}

/// The tendon at several loads; empty without pins on silicone.
#[derive(Debug, Default, Serialize)]
struct ContactStates {
    load_n: Vec<f64>,
    angle_rad: Vec<f64>,
    gap_mm: Vec<Vec<f64>>,
    axis_radius_mm: f64,
    tendon_radius_mm: f64,
    half_wrap_rad: f64,
    /// Lengths beyond the wrap: on the side of the load, and on the other.
    lead_mm: [f64; 2],
    z_mm: f64,
    #[serde(skip)]
    pin_depth_mm: Vec<Vec<f64>>,
}

impl PageData {
    /// The data of a page.
    #[must_use]
    pub fn new(built: &Built, prediction: &Prediction, manifest: &Manifest) -> Self {
        let design = built.design();
        let contact = contact_states(design);
        let stl = |name: &str| Some(format!("{name}.stl"));
        // Those of the assembly only: a page does not show mould, proxy and coupon.
        let mut meshes: Vec<MeshData> = Vec::new();
        let mut bodies = Vec::new();
        for body in built.assembly() {
            let Some(pose) = body.part.pose else { continue };
            // The page draws the tendon from its shape at each load, if the physics has a solution.
            if body.part.role == Role::Tendon && !contact.load_n.is_empty() {
                continue;
            }
            let printed = built.printed().iter().find(|p| std::ptr::eq(&p.body, body));
            let (mesh, matrix) = match printed {
                Some(part) => (encoded(&part.print_mesh, stl(&part.part().name)), into_assembly(body, pose)),
                None => (encoded(&pose.apply(body.mesh.clone()), None), nalgebra::Matrix4::identity()),
            };
            meshes.push(mesh);
            bodies.push(Body {
                name: body.part.name.clone(),
                material: body.part.material(),
                colour: body.part.role.colour(),
                mesh: meshes.len() - 1,
                matrix: <[f64; 16]>::try_from(matrix.as_slice()).unwrap_or_default(),
                explode_offset: body.part.role.explode_offset_mm().into(),
                sink: sink(body.part.role, design, &contact),
            });
        }
        Self {
            layout: layout_text(design.configuration()),
            meshes,
            bodies,
            contact,
            joint: JointStates::new(design),
            curve: prediction.curve.clone(),
            other_laws: prediction.others.clone(),
            published: published_points(design.contact())
                .into_iter()
                .filter(|p| p.friction_n.is_some())
                .collect(),
            friction_csv: friction_csv(&prediction.curve),
            checks: checklist(design, manifest.widest_bridge_mm()),
            manifest: manifest.clone(),
        }
    }
}

/// The sinking of a pin; `None` for other bodies, and without a solution of the physics.
fn sink(role: Role, design: &Design, contact: &ContactStates) -> Option<Sink> {
    let Role::Pin { index } = role else { return None };
    let depth_mm: Vec<f64> =
        contact.pin_depth_mm.iter().filter_map(|pins| pins.get(index).copied()).collect();
    let outwards = polar(1.0, *design.pin_angles_rad().get(index)?);
    (!depth_mm.is_empty()).then_some(Sink { towards: [-outwards.x, -outwards.y], depth_mm })
}

/// Transformation from the print mesh, centred on the bed, to the assembly.
fn into_assembly(body: &MeshedBody, pose: Pose) -> nalgebra::Matrix4<f64> {
    let back = body.part.solid.bounds().map_or(Vector3::zeros(), |(low, high)| {
        let middle = nalgebra::center(&low, &high);
        Vector3::new(middle.x, middle.y, low.z)
    });
    let turn = if pose.flipped { Vector3::new(-1.0, 1.0, -1.0) } else { Vector3::new(1.0, 1.0, 1.0) };
    let lift = nalgebra::Matrix4::new_translation(&Vector3::new(0.0, 0.0, pose.z_mm));
    lift * nalgebra::Matrix4::new_nonuniform_scaling(&turn) * nalgebra::Matrix4::new_translation(&back)
}

fn rounded(gap_mm: f64) -> f64 {
    (gap_mm * GAP_STEPS).round() / GAP_STEPS
}

#[allow(clippy::cast_possible_truncation)]
fn encoded(mesh: &Mesh, file: Option<String>) -> MeshData {
    let positions: Vec<u8> =
        mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(|v| (v as f32).to_le_bytes()).collect();
    let indices = mesh.triangles.iter().flatten();
    let triangles: Vec<u8> = if mesh.positions.len() <= SHORT_INDICES {
        indices.flat_map(|i| (*i as u16).to_le_bytes()).collect()
    } else {
        indices.flat_map(|i| i.to_le_bytes()).collect()
    };
    MeshData { file, positions: STANDARD.encode(positions), triangles: STANDARD.encode(triangles) }
}

/// Shapes of the tendon by the physics; empty without a solution.
fn contact_states(design: &Design) -> ContactStates {
    let contact = design.contact();
    if contact.substrate() == Substrate::Abs || contact.pins().count() == 0 {
        return ContactStates::default();
    }
    let f = &design.configuration().friction;
    let (lightest, heaviest) = (f.load_min_n.max(MIN_SHARE * f.load_max_n), f.load_max_n);
    let load_n: Vec<f64> =
        (0..STATES).map(|i| lightest + (heaviest - lightest) * i as f64 / (STATES - 1) as f64).collect();
    let Ok(profiles) = contact_profiles(contact, &load_n, Direction::Eccentric) else {
        return ContactStates::default();
    };
    let bed = contact.bed();
    // Only pins that the tendon touches sink.
    let touched: Vec<f64> = contact.pins().angles_rad().to_vec();
    let pin_depth_mm = profiles
        .iter()
        .map(|p| {
            let gap_at = |angle: f64| {
                let i = p.angle_rad.partition_point(|a| *a < angle - 1e-9).min(p.gap_mm.len() - 1);
                p.gap_mm[i]
            };
            design
                .pin_angles_rad()
                .iter()
                .map(|angle| {
                    let touches = touched.iter().any(|t| (t - angle).abs() < 1e-9);
                    if touches { (bed.protrusion_mm() - gap_at(*angle)).max(0.0) } else { 0.0 }
                })
                .collect()
        })
        .collect();
    ContactStates {
        angle_rad: profiles.first().map(|p| p.angle_rad.clone()).unwrap_or_default(),
        gap_mm: profiles.into_iter().map(|p| p.gap_mm.into_iter().map(rounded).collect()).collect(),
        load_n,
        axis_radius_mm: bed.axis_radius_mm(),
        tendon_radius_mm: bed.tendon_radius_mm,
        half_wrap_rad: contact.wrap_rad() / 2.0,
        lead_mm: design.shown_ends_mm(),
        z_mm: design.configuration().shell.width_mm / 2.0,
        pin_depth_mm,
    }
}
