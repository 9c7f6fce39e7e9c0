//! `pinswitch render CONFIG`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::Failure;
use super::source::Source;
use crate::design::Design;
use crate::mesh::{Mesh, Vector3};
use crate::output::write_file;
use crate::parts::{Material, Part, printed, reference_bodies};
use crate::render::{Body, View, render};

/// Space between parts on the plate, mm.
const PLATE_GAP_MM: f64 = 6.0;
/// Width after which the plate starts a new row, mm.
const PLATE_ROW_MM: f64 = 130.0;

/// Draw a picture of the parts as PNG: assembled, pulled apart, or laid out as printed.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch render three-double --out assembly.png
  pinswitch render three-double --scene plate --out plate.png --rise 55")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// File to write.
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// What to draw.
    #[arg(long, value_enum, default_value_t = Scene::Exploded)]
    scene: Scene,
    /// Turn about the vertical axis, in degrees.
    #[arg(long, value_name = "DEG", default_value_t = 30.0, allow_negative_numbers = true)]
    turn: f64,
    /// Height of the eye above the horizon, in degrees.
    #[arg(long, value_name = "DEG", default_value_t = 40.0, allow_negative_numbers = true)]
    rise: f64,
    /// Width of the picture in pixels; the height is three quarters of it.
    #[arg(long, value_name = "PIXELS", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(64..=8000))]
    width: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Scene {
    /// Everything in its place.
    Assembled,
    /// Supports and layer pulled away from the shell.
    Exploded,
    /// All printed parts side by side, in print orientation.
    Plate,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let design = arguments.source.design()?;
    let bodies = match arguments.scene {
        Scene::Assembled => assembly(&design, 0.0)?,
        Scene::Exploded => assembly(&design, 1.0)?,
        Scene::Plate => plate(&design)?,
    };
    let view = View { turn_deg: arguments.turn, rise_deg: arguments.rise };
    let picture = render(&bodies, view, arguments.width, arguments.width * 3 / 4);
    let bytes = picture.png().map_err(Failure::failed)?;
    write_file(&arguments.out, &bytes).map_err(Failure::failed)
}

fn mesh(part: &Part, design: &Design) -> Result<Mesh, Failure> {
    part.mesh(design).map_err(|e| Failure::failed(format!("{}: {e}", part.name)))
}

fn colour(part: &Part) -> [u8; 3] {
    match (part.material, part.name.as_str()) {
        (Material::Steel, _) => [205, 210, 218],
        (Material::Silicone, _) => [120, 190, 225],
        (_, name) if name.starts_with("support") => [236, 178, 74],
        (_, name) if name.starts_with("mould") => [150, 178, 126],
        (_, "shell") => [226, 226, 220],
        _ => [196, 170, 205],
    }
}

/// Bodies in place, lying on one side support so that the axis is upright; `apart` pulls them along their ways out.
fn assembly(design: &Design, apart: f64) -> Result<Vec<Body>, Failure> {
    let printed = printed(design).map_err(Failure::bad_input)?;
    let reference = reference_bodies(design).map_err(Failure::bad_input)?;
    let rigid = reference.iter().all(|b| b.material != Material::Silicone);
    let placed = printed.iter().filter(|p| rigid || p.name != "proxy").chain(&reference);
    placed
        .filter_map(|part| part.pose.map(|pose| (part, pose)))
        .map(|(part, pose)| {
            let way = match (part.name.as_str(), part.material) {
                ("support-left", _) => Vector3::new(0.0, 0.0, -12.0),
                ("support-right", _) => Vector3::new(0.0, 0.0, 12.0),
                ("proxy", _) | (_, Material::Silicone) => Vector3::new(0.0, 7.0, 0.0),
                (_, Material::Steel) => Vector3::new(0.0, 14.0, 0.0),
                _ => Vector3::zeros(),
            };
            let mesh = pose.apply(mesh(part, design)?).translated(way * apart);
            Ok(Body { mesh, colour: colour(part) })
        })
        .collect()
}

/// Printed parts in rows.
fn plate(design: &Design) -> Result<Vec<Body>, Failure> {
    let (mut x, mut y, mut depth) = (0.0, 0.0, 0.0f64);
    let mut bodies = Vec::new();
    for part in printed(design).map_err(Failure::bad_input)? {
        let mesh = mesh(&part, design)?;
        let Some((low, high)) = mesh.bounds() else { continue };
        let size = high - low;
        if x + size.x > PLATE_ROW_MM && x > 0.0 {
            (x, y, depth) = (0.0, y - depth - PLATE_GAP_MM, 0.0);
        }
        let mesh = mesh.translated(Vector3::new(x - low.x, y - high.y, -low.z));
        bodies.push(Body { mesh, colour: colour(&part) });
        x += size.x + PLATE_GAP_MM;
        depth = depth.max(size.y);
    }
    Ok(bodies)
}
