//! DXF: the profiles of flat printed parts.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_drafting::{lettering, same};
use pinswitch_solid::files::dxf;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::Solid;

pub(super) const FORMAT: Format = Format {
    name: "dxf",
    about: "Profiles of flat printed parts, for CAD and laser cutters",
    inclusion: Inclusion::Named,
    make,
};

fn make(built: &Built, _: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let chamfer_mm = built.design().configuration().print.elephant_foot_mm;
    let parts = built.printed().iter().map(|p| p.part());
    let flat = parts.filter(|part| is_flat(&part.solid, chamfer_mm));
    Ok(flat.map(|part| OutputFile::new(format!("{}.dxf", part.name), dxf(&part.solid))).collect())
}

/// Returns whether a solid has one section over its whole height, apart from engraved letters and bottom chamfers.
fn is_flat(solid: &Solid, chamfer_mm: f64) -> bool {
    let Some((low, high)) = solid.bounds() else { return false };
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let letters = lettering(solid);
    let foot = |z: f64| same(z, low.z);
    let is_full = |from: f64, to: f64| (foot(from) || same(from, low.z + chamfer_mm)) && same(to, high.z);
    let is_chamfer = |from: f64, to: f64| foot(from) && same(to, low.z + chamfer_mm);
    solid.walls().filter(|(lower, _)| !letters[*lower]).all(|(lower, upper)| {
        let ((below, from), (above, to)) = (rings[lower], rings[upper]);
        if below == above { is_full(from, to) } else { is_chamfer(from, to) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};
    use crate::design::Design;
    use crate::formats::named;
    use crate::set::Set;

    /// Names of the DXF files of a configuration.
    fn files(assignments: &[&str]) -> Vec<String> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let built = Built::new(Design::new(c).unwrap()).unwrap();
        let prediction = Prediction::of(built.design());
        let set = Set::new(&built, &prediction, &named(&["dxf"]).unwrap()).unwrap();
        set.files.into_iter().map(|file| file.name).filter(|name| name.ends_with(".dxf")).collect()
    }

    #[test]
    fn flat_parts_have_a_dxf() {
        let pins = "layout.pins=[5, 8, 11]";
        assert_eq!(files(&[pins]), ["shell.dxf", "proxy.dxf", "coupon.dxf"]);
        // A bottom chamfer and letters do not matter; inserts need wider ends of the holes.
        assert_eq!(files(&[pins, "print.elephant_foot_mm=0.2"]), ["shell.dxf", "proxy.dxf", "coupon.dxf"]);
        assert_eq!(files(&[pins, "fasteners.kind=insert"]), ["proxy.dxf", "coupon.dxf"]);
    }
}
