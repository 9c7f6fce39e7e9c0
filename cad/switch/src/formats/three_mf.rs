//! assembly.3mf: all printed parts on a plate, with thumbnail, configuration and curve. Sets that need several plates have
//! assembly-1.3mf and so on.

use super::{Format, Inclusion, png};
use crate::built::Built;
use crate::config::to_toml;
use crate::documents::{Manifest, friction_csv, layout_text};
use crate::output::{OutputFile, SetError};
use crate::parts::Role;
use crate::plates::{Plate, plates};
use crate::prediction::Prediction;
use crate::scene::plate as scene_of;
use pinswitch_friction::Law;
use pinswitch_solid::files::{BaseMaterial, Object, Package, three_mf};
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format = Format {
    name: "3mf",
    about: "assembly.3mf: all printed parts on a plate, for slicers; one file for each plate",
    inclusion: Inclusion::Default,
    make,
};

/// Pixels of the thumbnail, along each side.
const THUMBNAIL: u32 = 256;

fn make(built: &Built, prediction: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    plates(built)
        .iter()
        .map(|plate| Ok(OutputFile::new(plate.package(), package_bytes(built, prediction, plate)?)))
        .collect()
}

/// The bytes of the package of one plate.
fn package_bytes(built: &Built, prediction: &Prediction, plate: &Plate<'_>) -> Result<Vec<u8>, SetError> {
    let c = built.design().configuration();
    let name = &c.switch.name;
    let plastic = c.process.material.data().name;
    let materials = materials(plate, plastic);
    let objects: Vec<Object<'_>> = plate
        .parts
        .iter()
        .map(|(p, place)| Object {
            name: &p.part().name,
            part_number: format!("{name}/{}", p.part().name),
            mesh: &p.print_mesh,
            material: materials
                .iter()
                .position(|m| *m == material(p.part().role, plastic))
                .unwrap_or(usize::MAX),
            place: *place,
        })
        .collect();
    let on_plate = match plate.of {
        1 => String::new(),
        of => format!(", plate {} of {of}", plate.number),
    };
    let above = View { turn_deg: 20.0, rise_deg: 50.0 };
    let law = prediction.curve.law;
    let chosen = (law != Law::DEFAULT).then(|| ("law", law.as_str().to_owned()));
    let own = [("layout", layout_text(c)), ("configuration", to_toml(c))];
    let package = Package {
        metadata: vec![
            ("Title", format!("{name}: friction switch{on_plate}")),
            ("Designer", "pinswitch".to_owned()),
            ("Description", format!("Printed parts of a friction switch, layout {}", layout_text(c))),
            ("LicenseTerms", "The program is MIT licensed; what it makes is yours.".to_owned()),
            ("Application", concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned()),
        ],
        own_metadata: own.into_iter().chain(chosen).collect(),
        materials,
        thumbnail: png(&scene_of(plate), above, THUMBNAIL, THUMBNAIL)?,
        attachments: vec![("friction.csv".to_owned(), friction_csv(&prediction.curve).into_bytes())],
    };
    three_mf(&objects, &package).map_err(SetError::encoding)
}

/// Returns the materials of a plate, each once, in the order of its parts.
fn materials(plate: &Plate<'_>, plastic: &str) -> Vec<BaseMaterial> {
    plate.parts.iter().fold(Vec::new(), |mut known, (p, _)| {
        let own = material(p.part().role, plastic);
        if !known.contains(&own) {
            known.push(own);
        }
        known
    })
}

/// Returns the material of a role, of this plastic, in the colour of its pictures.
fn material(role: Role, plastic: &str) -> BaseMaterial {
    let what = match role {
        Role::Shell => "shell",
        Role::Mould => "mould",
        Role::Support { .. } => "support",
        Role::Proxy => "proxy",
        Role::Mount | Role::Stand | Role::DistalLink => "mount",
        Role::Accessory => "accessory",
        // Cast or bought, and not on a plate.
        Role::Layer | Role::Pin { .. } | Role::Tendon => "part",
    };
    BaseMaterial { name: format!("{plastic} ({what})"), colour: role.colour() }
}
