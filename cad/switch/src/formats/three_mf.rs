//! assembly.3mf: all printed parts on one plate, with thumbnail, configuration and curve.

use super::{Format, Inclusion, png};
use crate::built::Built;
use crate::config::to_toml;
use crate::documents::{Manifest, friction_csv};
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::scene::plate;
use pinswitch_solid::files::{Object, Package, three_mf};
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format = Format {
    name: "3mf",
    about: "assembly.3mf: all printed parts on a plate, for slicers",
    inclusion: Inclusion::Default,
    make,
};

/// Pixels of the thumbnail, along each side.
const THUMBNAIL: u32 = 256;

fn make(built: &Built, prediction: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let c = built.design().configuration();
    let name = &c.switch.name;
    let objects: Vec<Object<'_>> = built
        .printed()
        .iter()
        .map(|p| Object {
            name: &p.part().name,
            part_number: format!("{name}/{}", p.part().name),
            mesh: &p.print_mesh,
        })
        .collect();
    let above = View { turn_deg: 20.0, rise_deg: 50.0 };
    let package = Package {
        metadata: vec![
            ("Title", format!("{name}: friction switch")),
            ("Designer", "pinswitch".to_owned()),
            (
                "Description",
                format!("Printed parts of a friction switch, pins in grooves {:?}", c.layout.pins),
            ),
            ("LicenseTerms", "The program is MIT licensed; what it makes is yours.".to_owned()),
            ("Application", concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned()),
        ],
        own_metadata: vec![("layout", built.design().label()), ("configuration", to_toml(c))],
        thumbnail: png(&plate(built), above, THUMBNAIL, THUMBNAIL)?,
        attachments: vec![("friction.csv".to_owned(), friction_csv(&prediction.curve).into_bytes())],
    };
    let bytes = three_mf(&objects, &package).map_err(SetError::encoding)?;
    Ok(vec![OutputFile::new("assembly.3mf", bytes)])
}
