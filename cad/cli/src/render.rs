//! `pinswitch render CONFIG`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_solid::render::{View, render};
use pinswitch_switch::feasibility;
use pinswitch_switch::output::BuildError;
use pinswitch_switch::scene::{all_plates, assembled};

use super::Failure;
use super::source::Source;
use crate::write::write_file;

/// Draw the parts as PNG: assembled, exploded, or laid out as printed.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch render three-double --out assembly.png
  pinswitch render three-double --scene plate --out plate.png --rise 55")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// PNG file to write.
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Arrangement of the parts.
    #[arg(long, value_enum, default_value_t = Scene::Exploded)]
    scene: Scene,
    /// Rotation about the vertical axis, in degrees [default: 38 for an assembly, 30 for a plate].
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    turn: Option<f64>,
    /// Elevation of the camera in degrees.
    #[arg(long, value_name = "DEG", default_value_t = 40.0, allow_negative_numbers = true)]
    rise: f64,
    /// Width of the picture in pixels; the height is three quarters of the width.
    #[arg(long, value_name = "PIXELS", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(64..=8000))]
    width: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Scene {
    /// The assembled switch.
    Assembled,
    /// Supports and layer at a distance from the shell.
    Exploded,
    /// All printed parts in print orientation; if they need several plates, each on its bed.
    Plate,
}

impl Arguments {
    fn turn_deg(&self) -> f64 {
        self.turn.unwrap_or(match self.scene {
            Scene::Assembled | Scene::Exploded => 38.0,
            Scene::Plate => 30.0,
        })
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    for (flag, degrees) in [("--turn", arguments.turn_deg()), ("--rise", arguments.rise)] {
        if !degrees.is_finite() {
            return Err(Failure::bad_input(
                Diagnostic::new(codes::OUT_OF_RANGE, "the angle is not finite")
                    .with_location(Location::field(flag, degrees.to_string()))
                    .with_help("give an angle in degrees"),
            ));
        }
    }
    let design = arguments.source.design()?;
    let built = feasibility::build(design).map_err(|e| match e {
        BuildError::Configuration(e) => arguments.source.refusal(&e),
        other => Failure::failed(Diagnostic::from(other)),
    })?;
    let bodies = match arguments.scene {
        Scene::Assembled => assembled(&built, 0.0),
        Scene::Exploded => assembled(&built, 1.0),
        Scene::Plate => all_plates(&built),
    };
    let view = View { turn_deg: arguments.turn_deg(), rise_deg: arguments.rise };
    let picture = render(&bodies, view, arguments.width, arguments.width * 3 / 4);
    let bytes =
        picture.png().map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?;
    write_file(&arguments.out, &bytes).map_err(Failure::from)
}
