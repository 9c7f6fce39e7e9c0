//! Features that do not fit on a part: the set is made without them, and a warning names a value with which they fit.

use crate::config::Configuration;
use crate::design::Design;
use crate::design::rules::Direction::{self, Lower, Raise, Restore, Set};
use crate::feasibility::advice;
use crate::parts::{LeftOut, Part, left_out_features};

/// Text of a note without a value that makes room.
const NO_ADVICE: &str = "no single value makes room";
/// Directions that make room in the wall between fasteners and faces.
const ROOM_FOR_RECESSES: &[Direction] = &[
    Raise("support.plate_mm"),
    Raise("shell.wall_mm"),
    Raise("fasteners.end_distance_mm"),
    Lower("fasteners.count"),
    Restore("fasteners.hole_diameter_mm"),
    Lower("fasteners.nut_recess_mm"),
    Lower("fasteners.head_recess_mm"),
    Set("fasteners.kind", "\"screw\""),
];
/// Directions that make room for letters.
const ROOM_FOR_LETTERS: &[Direction] = &[
    Raise("shell.wall_mm"),
    Lower("fasteners.count"),
    Restore("label.depth_mm"),
    Raise("support.plate_mm"),
    Restore("label.stroke_mm"),
    Restore("fasteners.head_recess_mm"),
    Restore("fasteners.nut_recess_mm"),
    Restore("fasteners.hole_diameter_mm"),
    Set("label.text", "\"\""),
];

impl LeftOut {
    fn description(self, design: &Design, part: &str) -> String {
        match self {
            Self::Label => format!("the label {:?} does not fit and is left out", design.label()),
            Self::Side => {
                let side = if part.ends_with("left") { "L" } else { "R" };
                format!("the mark {side:?} does not fit and is left out")
            }
            Self::Arrow => "the arrow to groove 1 does not fit and is left out".to_owned(),
            Self::Lip => "the lip does not fit under the edge of the plate and is left out".to_owned(),
            Self::Stops => "the stops do not fit and are left out".to_owned(),
            Self::NutTraps => "nut traps do not fit and are left out".to_owned(),
            Self::Counterbores | Self::PlateCounterbores => {
                "counterbores for the heads do not fit and are left out".to_owned()
            }
        }
    }

    const fn room(self) -> &'static [Direction] {
        match self {
            Self::Label | Self::Side | Self::Arrow => ROOM_FOR_LETTERS,
            Self::Lip => &[
                Raise("support.rise_mm"),
                Restore("support.lip_height_mm"),
                Restore("support.corner_radius_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("support.lip_clearance_mm"),
            ],
            Self::Stops => &[
                Raise("shell.stop_mm"),
                Raise("silicone.thickness_mm"),
                Raise("shell.stop_height_mm"),
                Restore("print.elephant_foot_mm"),
            ],
            Self::NutTraps | Self::Counterbores => ROOM_FOR_RECESSES,
            Self::PlateCounterbores => {
                &[Raise("mount.plate_mm"), Lower("fasteners.count"), Lower("fasteners.head_recess_mm")]
            }
        }
    }
}

impl Part {
    /// Returns a note for each feature that is left out, with a value with which it fits.
    pub fn notes(&self, design: &Design) -> Vec<String> {
        let note = |feature: &LeftOut| {
            let remedy = remedy(&self.name, *feature, design);
            let remedy = remedy.unwrap_or_else(|| NO_ADVICE.to_owned());
            format!("{}: {remedy}", feature.description(design, &self.name))
        };
        self.left_out.iter().map(note).collect()
    }

    /// Returns a note for each feature that is left out, without remedy: for the drawing.
    pub fn left_out_notes(&self, design: &Design) -> Vec<String> {
        self.left_out.iter().map(|feature| feature.description(design, &self.name)).collect()
    }
}

/// Returns a change that makes room for `feature` on a part, and does not displace another feature.
fn remedy(part: &str, feature: LeftOut, design: &Design) -> Option<String> {
    let before = left_out_features(design);
    let is_other = |(on, lost): &(&str, LeftOut)| *lost != feature || (*on != part && *on != "plate");
    let fits = |c: &Configuration| {
        Design::new(c.clone()).is_ok_and(|changed| {
            let after = left_out_features(&changed);
            after.iter().all(|lost| before.contains(lost) && is_other(lost))
        })
    };
    let c = design.configuration();
    // A label is not worth half of the screws.
    let is_of_letters = matches!(feature, LeftOut::Label | LeftOut::Side | LeftOut::Arrow);
    let advice = advice(c, feature.room(), &fits).filter(|advice| advice.is_small || !is_of_letters);
    advice.map(|advice| advice.instruction).or_else(|| {
        let letters = if feature == LeftOut::Label { design.label().chars().count() } else { 0 };
        let fitting = (1..letters).rev().find(|letters| {
            let mut shorter = c.clone();
            shorter.label.text = "M".repeat(*letters);
            fits(&shorter)
        })?;
        Some(format!("set label.text to a text of {}", at_most_letters(fitting)))
    })
}

/// `one letter`, `at most 3 letters`.
fn at_most_letters(letters: usize) -> String {
    if letters == 1 { "one letter".to_owned() } else { format!("at most {letters} letters") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;
    use crate::parts::printed;

    fn design(assignments: &[String]) -> Design {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        Design::new(c).unwrap()
    }

    fn notes(design: &Design) -> Vec<String> {
        printed(design).unwrap().iter().flat_map(|part| part.notes(design)).collect()
    }

    const CASES: [&[&str]; 17] = [
        &[
            "fasteners.hole_diameter_mm=2.9",
            "fasteners.nut_recess_mm=2.4",
            "shell.wall_mm=6",
            "fasteners.dowel_diameter_mm=2",
        ],
        &["layout.pins=[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]"],
        &["layout.pins=[5, 8, 11]", "print.line_mm=0.5", "print.least_wall_mm=0.5", "label.stroke_mm=0.5"],
        &["shell.stop_mm=0.2"],
        &["shell.wall_mm=5.5"],
        &["fasteners.nut_recess_mm=2.4"],
        &["fasteners.head_recess_mm=3"],
        &["fasteners.head_recess_mm=1.7"],
        &["fasteners.kind=insert", "fasteners.head_recess_mm=2"],
        &["mount.kind=joint", "fasteners.head_recess_mm=6.5"],
        &["fasteners.count=5"],
        &["support.rise_mm=0.6"],
        &["fasteners.hole_diameter_mm=4.5", "shell.wall_mm=9"],
        &["label.depth_mm=2", "support.plate_mm=2.2"],
        &["label.text=ABCDEFGHIJKL", "label.height_mm=5"],
        &["shell.wall_mm=3.5", "fasteners.hole_diameter_mm=1.8", "shell.width_mm=7.5", "label.stroke_mm=0.9"],
        &[
            "fasteners.count=6",
            "fasteners.hole_diameter_mm=1.8",
            "shell.width_mm=7.5",
            "layout.pins=[1, 2, 4]",
        ],
    ];

    /// With the value that a note names, the feature is back, and no other note appears.
    #[test]
    fn the_remedy_of_a_note_restores_the_feature() {
        let mut followed = 0;
        for case in CASES {
            let mut set: Vec<String> = case.iter().map(|a| (*a).to_owned()).collect();
            let mut before = notes(&design(&set));
            while let Some(note) = before.first().cloned() {
                let remedy = note.split("left out: ").nth(1).unwrap();
                let words: Vec<&str> = remedy.split(' ').collect();
                let of_text = remedy
                    .strip_prefix("set label.text to a text of ")
                    .map(|letters| letters.replace("one", "most 1"));
                if let Some(letters) =
                    of_text.and_then(|text| text.split("most ").nth(1)?.split(' ').next()?.parse().ok())
                {
                    set.push(format!("label.text={}", "Q".repeat(letters)));
                } else {
                    match words[..] {
                        ["raise" | "lower", field, "to", value] | ["set", field, "=", value] => {
                            set.push(format!("{field}={value}"))
                        }
                        _ if remedy == NO_ADVICE => break,
                        _ => panic!("{case:?}: {note}"),
                    }
                }
                let after = notes(&design(&set));
                // The subjects of the notes, whatever the text of the label.
                let about = |notes: &[String]| -> Vec<String> {
                    let words = |n: &String| {
                        n.split(" left out").next()?.split('"').step_by(2).last().map(str::to_owned)
                    };
                    notes.iter().filter_map(words).collect()
                };
                let is_known = |what: &String| about(&before).contains(what);
                assert!(
                    after.len() < before.len() && about(&after).iter().all(is_known),
                    "{set:?}: {before:?} -> {after:?}"
                );
                before = after;
                followed += 1;
            }
        }
        assert!(followed >= 12, "{followed}");
        // A recess that fits exactly is not lost to rounding.
        assert_eq!(notes(&design(&["fasteners.head_recess_mm=1.6".to_owned()])), Vec::<String>::new());
    }

    /// The features that are left out are known without building the parts.
    #[test]
    fn the_set_and_its_parts_lack_the_same() {
        let mut lost = 0;
        for case in CASES
            .into_iter()
            .chain([&[][..], &["mould.kind=split", "label.text=ABCDEFGHIJKL", "label.height_mm=5"]])
        {
            let design = design(&case.iter().map(|a| (*a).to_owned()).collect::<Vec<_>>());
            let parts = printed(&design).unwrap();
            let of_parts: Vec<LeftOut> = parts.iter().flat_map(|part| part.left_out.clone()).collect();
            assert_eq!(
                left_out_features(&design).into_iter().map(|(_, feature)| feature).collect::<Vec<_>>(),
                of_parts,
                "{case:?}"
            );
            lost += of_parts.len();
        }
        assert!(lost > CASES.len(), "{lost}");
    }
}
