//! `pinswitch generate CONFIG`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::law::LawChoice;
use super::predict_rows::calibrated_curve;
use super::source::Source;
use super::{Failure, print};
use crate::output::{Format, SetError, make_set_in, write_set};

/// Make the printable parts of a configuration, with their predicted friction curve.
///
/// Writes one folder: the parts as binary STL (millimetres, print orientation) and on one plate as 3MF, friction.csv and
/// friction.svg (the predicted curve with its band), drawing.svg, PRINTING.md with pictures, report.html (open it in a
/// browser), and manifest.json (every parameter, derived dimension, volume, hash, and the bill of materials). Nothing is
/// written if anything is wrong.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch generate three-double
  pinswitch generate my-switch.toml --out parts --preset printer-fff-0.4
  pinswitch generate three-double --format stl,step
  pinswitch generate three-double --set layout.pins=[4,8,12] --set support.slots=occupied")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Folder to write into [default: out/NAME].
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A model.toml written by `calibrate`: the curve comes from it, without the effects of the rig.
    #[arg(long, value_name = "TOML", conflicts_with = "law")]
    model: Option<PathBuf>,
    /// Kinds of files to write, beside curve and manifest.
    #[arg(long, value_enum, value_name = "FORMAT", value_delimiter = ',', default_values_t = DEFAULT)]
    format: Vec<Kind>,
    #[command(flatten)]
    law: LawChoice,
    /// Print the manifest as JSON.
    #[arg(long)]
    json: bool,
}

/// Kinds of files, as they are named on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// One binary STL per part.
    Stl,
    /// assembly.3mf: all printed parts on a plate, for slicers.
    #[value(name = "3mf")]
    ThreeMf,
    /// Exact solids for CAD: one per part, and the assembly.
    Step,
    /// drawing.svg: dimensioned sheet.
    Drawing,
    /// Profiles of the printed parts, for CAD and laser cutters.
    Dxf,
    /// PRINTING.md with pictures.
    Guide,
    /// report.html: the assembly in 3D, the curve, tables, downloads.
    Page,
    /// Everything.
    All,
}

const DEFAULT: [Kind; 5] = [Kind::Stl, Kind::ThreeMf, Kind::Drawing, Kind::Guide, Kind::Page];

fn formats(kinds: &[Kind]) -> Vec<Format> {
    let all = [
        Format::Stl,
        Format::ThreeMf,
        Format::Step,
        Format::Drawing,
        Format::Dxf,
        Format::Guide,
        Format::Page,
    ];
    let named = kinds.iter().filter_map(|kind| {
        Some(match kind {
            Kind::Stl => Format::Stl,
            Kind::ThreeMf => Format::ThreeMf,
            Kind::Step => Format::Step,
            Kind::Drawing => Format::Drawing,
            Kind::Dxf => Format::Dxf,
            Kind::Guide => Format::Guide,
            Kind::Page => Format::Page,
            Kind::All => return None,
        })
    });
    if kinds.contains(&Kind::All) { all.to_vec() } else { named.collect() }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let design = arguments.source.design()?;
    let curve = match &arguments.model {
        Some(model) => calibrated_curve(&design, model)?,
        None => arguments.law.curve(&design)?,
    };
    let set = make_set_in(&design, &curve, &formats(&arguments.format)).map_err(|e| match e {
        SetError::Configuration(e) => Failure::bad_input(e),
        other => Failure::failed(other),
    })?;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(&design.configuration().switch.name));
    write_set(&folder, &set.files).map_err(Failure::failed)?;
    for warning in &set.manifest.warnings {
        log::warn!("{warning}");
    }
    for part in &set.manifest.parts {
        log::debug!("{}: {:.3} mm3, {} triangles", part.file, part.volume_mm3, part.mesh.triangles);
        for note in &part.notes {
            log::warn!("{}: {note}", part.file);
        }
    }
    let friction = &set.manifest.friction;
    log::info!(
        "{}: {} parts; {:.2} N of friction at {:.2} N of load ({:.2} to {:.2} N, {})",
        folder.display(),
        set.manifest.parts.len(),
        friction.friction_n,
        friction.load_n,
        friction.band_n[0],
        friction.band_n[1],
        serde_json::to_value(friction.trust)
            .ok()
            .and_then(|t| t.as_str().map(str::to_owned))
            .unwrap_or_default(),
    );
    if let Some(model) = &arguments.model {
        log::info!("the curve comes from {}", model.display());
        curve.reasons.iter().for_each(|reason| log::info!("{reason}"));
    }
    if arguments.json {
        let manifest = set.files.last().map(|f| f.bytes.clone()).unwrap_or_default();
        print(&manifest)?;
    }
    Ok(())
}
