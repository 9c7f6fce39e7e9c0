//! Print plates of a set: the parts of each plate with their positions, and its files.

use crate::built::{Built, BuiltPart};
use pinswitch_solid::files::{Placement, lay_out};

/// A plate with its parts, in the order of the set.
#[derive(Clone, Debug)]
pub struct Plate<'a> {
    /// Number, from 1.
    pub number: usize,
    /// Number of plates of the set.
    pub of: usize,
    /// Parts with their positions.
    pub parts: Vec<(&'a BuiltPart, Placement)>,
}

impl Plate<'_> {
    /// Returns the name of a file of the plate: `STEM.EXTENSION` for a single plate, else `STEM-NUMBER.EXTENSION`.
    pub fn file(&self, stem: &str, extension: &str) -> String {
        match self.of {
            1 => format!("{stem}.{extension}"),
            _ => format!("{stem}-{}.{extension}", self.number),
        }
    }

    /// Returns the name of its 3MF file.
    pub fn package(&self) -> String {
        self.file("assembly", "3mf")
    }

    /// Returns the name of its picture.
    pub fn picture(&self) -> String {
        self.file("plate", "png")
    }
}

/// Returns the plates of a set. Every printed part is on exactly one plate, within `print.bed_mm`.
pub fn plates(built: &Built) -> Vec<Plate<'_>> {
    let boxes: Vec<_> = built.printed().iter().map(|p| p.print_mesh.bounds().unwrap_or_default()).collect();
    let places = lay_out(&boxes, built.design().configuration().print.bed_mm);
    let of = places.iter().map(|p| p.plate + 1).max().unwrap_or(0);
    let parts_of = |plate: usize| {
        let all = built.printed().iter().zip(&places);
        all.filter(move |(_, place)| place.plate == plate).map(|(part, place)| (part, *place)).collect()
    };
    (0..of).map(|plate| Plate { number: plate + 1, of, parts: parts_of(plate) }).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::config::read;
    use crate::design::Design;
    use pinswitch_solid::files::{BED_EDGE_MM, PART_GAP_MM};
    use pinswitch_solid::mesh::Point3;

    /// Name, lower and upper corner of a part on its plate.
    type PlacedPart = (String, Point3, Point3);

    /// Every part on its plate.
    fn placed(text: &str) -> (Built, BTreeMap<usize, Vec<PlacedPart>>) {
        let built = Built::new(Design::new(read(text, "x.toml").unwrap().0).unwrap()).unwrap();
        let of = |plate: &Plate<'_>| {
            let corners = plate.parts.iter().map(|(part, place)| {
                let (low, high) = place.apply(part.print_mesh.clone()).bounds().unwrap();
                (part.part().name.clone(), low, high)
            });
            (plate.number, corners.collect())
        };
        let all = plates(&built).iter().map(of).collect();
        (built, all)
    }

    #[test]
    fn every_part_is_on_one_plate() {
        let rig = "[mount]\nkind = \"rig\"\n[tendon]\nsheath_diameter_mm = 3.0\n";
        for (text, bed_mm, least) in
            [("", 250.0, 1), ("", 120.0, 1), ("", 62.0, 3), (rig, 250.0, 1), (rig, 165.0, 2)]
        {
            let text = format!("{text}[print]\nbed_mm = {bed_mm:?}\n");
            let (built, plates) = placed(&text);
            assert!(plates.len() >= least && plates.len() <= least + 4, "{text}: {} plates", plates.len());
            let mut names: Vec<&str> = plates.values().flatten().map(|(name, ..)| name.as_str()).collect();
            let mut expected: Vec<&str> = built.printed().iter().map(|p| p.part().name.as_str()).collect();
            names.sort_unstable();
            expected.sort_unstable();
            assert_eq!(names, expected, "{text}");
            for parts in plates.values() {
                for (i, (name, low, high)) in parts.iter().enumerate() {
                    let edge = BED_EDGE_MM - 2e-3;
                    assert!(low.x >= edge && low.y >= edge, "{text}{name}: {low}");
                    assert!(high.x <= bed_mm - edge && high.y <= bed_mm - edge, "{text}{name}: {high}");
                    assert!(low.z.abs() < 1e-9, "{text}{name}");
                    for (other, other_low, other_high) in &parts[..i] {
                        let gap = PART_GAP_MM - 2e-3;
                        let apart = low.x - other_high.x >= gap
                            || other_low.x - high.x >= gap
                            || low.y - other_high.y >= gap
                            || other_low.y - high.y >= gap;
                        assert!(apart, "{text}{name} and {other}");
                    }
                }
            }
        }
    }
}
