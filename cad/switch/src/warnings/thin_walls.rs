//! Walls of printed parts that are thinner than two printed lines, and changes that make them thicker. Warnings name only
//! values that were tested.

use pinswitch_solid::solid::ThinPlace;

use crate::config::Configuration;
use crate::design::Design;
use crate::design::rules::Direction::{self, Lower, Raise, Restore};
use crate::feasibility::advice;
use crate::parts::{Part, Role, printed_part};

/// Thicknesses that differ by less are equal, mm.
const ALIKE_MM: f64 = 1e-3;
/// Most changes that a warning names together.
const TOGETHER: usize = 3;

impl Part {
    /// Thin places that no rule of the design reports.
    fn unreported_thin_places(&self, design: &Design) -> Vec<ThinPlace> {
        let mut places = self.thin_places(design);
        if self.role == Role::Shell {
            let reported = [design.land_mm(), design.end_wall_mm()];
            places.retain(|p| reported.iter().all(|t| (p.thickness_mm - t).abs() > ALIKE_MM));
        }
        places
    }

    /// Returns a warning of the thinnest place, with the parameter to change; `None` if every wall has two printed lines.
    pub fn thin_warning(&self, design: &Design) -> Option<String> {
        let places = self.unreported_thin_places(design);
        let thinnest = places.first()?;
        let (at, line_mm) = (thinnest.middle, design.configuration().print.line_mm);
        Some(format!(
            "{}: a wall of {:.2} mm, under two printed lines ({:.2} mm), at radius {:.1} mm and {:.1} deg, {:.1} to {:.1} mm \
             above the bed{}: {}",
            self.name,
            thinnest.thickness_mm,
            2.0 * line_mm,
            at.coords.norm(),
            libm::atan2(at.x, at.y).to_degrees(),
            thinnest.from_mm,
            thinnest.to_mm,
            match places.len() {
                1 => String::new(),
                2 => ", and one more place".to_owned(),
                n => format!(", and {} more places", n - 1),
            },
            self.remedy_for_thin_places(design, thinnest.thickness_mm)
        ))
    }

    /// Returns the changes that remove all thin places of the part: one value, or several together;
    /// finer lines if neither exists.
    fn remedy_for_thin_places(&self, design: &Design, thinnest_mm: f64) -> String {
        let places = |c: &Configuration| -> Option<Vec<ThinPlace>> {
            let design = Design::new(c.clone()).ok()?;
            Some(printed_part(&self.name, &design)?.ok()?.unreported_thin_places(&design))
        };
        let is_thick = |c: &Configuration| places(c).is_some_and(|places| places.is_empty());
        // The first change that works, since every test builds the part. A layer of three times the thickness would also thicken
        // the end walls of the proxy, but it would be another switch: it is the last resort.
        let c = design.configuration();
        if let Some(advice) = advice(c, self.thickening(), &is_thick) {
            return advice.instruction;
        }
        // The thinnest places first, then the remaining ones.
        let (mut c, mut left_mm, mut steps) = (c.clone(), thinnest_mm, Vec::new());
        while steps.len() < TOGETHER {
            let is_thicker = |c: &Configuration| {
                places(c).is_some_and(|p| p.first().is_none_or(|p| p.thickness_mm > left_mm + ALIKE_MM))
            };
            let found =
                self.thickening().iter().find_map(|d| advice(&c, std::slice::from_ref(d), &is_thicker));
            let Some(step) = found else { break };
            c = step.configuration;
            steps.push(step.instruction);
            match places(&c).as_deref() {
                Some([]) => return steps.join(", and "),
                Some([thinnest, ..]) => left_mm = thinnest.thickness_mm,
                None => break,
            }
        }
        let line_mm = (50.0 * thinnest_mm).floor() / 100.0;
        // A printer has no lines much narrower than its nozzle.
        if line_mm < design.configuration().print.nozzle_mm {
            return "accept the thin wall, or print with a finer nozzle".to_owned();
        }
        format!("print lines of at most {line_mm:.2} mm (print.line_mm), or accept the thin wall")
    }

    /// Directions that may thicken a thin wall of this part, the most natural first.
    fn thickening(&self) -> &'static [Direction] {
        const MARGIN: Direction = Raise("segment.end_margin_mm");
        match (self.role, self.name.as_str()) {
            (_, "mould-lid") => {
                &[Lower("mould.pour_width_mm"), Lower("mould.key_diameter_mm"), Raise("mould.wall_mm")]
            }
            (Role::Mould, _) => &[
                Raise("mould.wall_mm"),
                Lower("mould.key_diameter_mm"),
                MARGIN,
                Raise("segment.groove_radius_mm"),
                Lower("segment.grooves"),
            ],
            (Role::Proxy, _) => &[
                MARGIN,
                Raise("silicone.thickness_mm"),
                Lower("segment.groove_radius_mm"),
                Lower("segment.grooves"),
            ],
            (Role::Support { .. }, _) => &[
                MARGIN,
                Raise("shell.wall_mm"),
                Lower("support.slot_clearance_mm"),
                Raise("support.lip_height_mm"),
                Raise("support.lip_depth_mm"),
                Raise("fasteners.end_distance_mm"),
                Raise("support.plate_mm"),
                Lower("segment.grooves"),
                Restore("fasteners.hole_diameter_mm"),
            ],
            (Role::Mount | Role::Stand | Role::DistalLink, _) => {
                &[Raise("mount.rim_mm"), Raise("mount.plate_mm"), Restore("mount.hole_diameter_mm")]
            }
            (Role::Shell, _) => &[
                MARGIN,
                Raise("shell.wall_mm"),
                Raise("shell.stop_mm"),
                Raise("fasteners.end_distance_mm"),
                Restore("fasteners.hole_diameter_mm"),
                Restore("fasteners.dowel_diameter_mm"),
                Lower("segment.grooves"),
                Lower("segment.groove_radius_mm"),
            ],
            _ => &[Lower("print.line_mm")],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;
    use crate::parts::printed;

    /// The warnings of a configuration, by part.
    fn warned(assignments: &[&str]) -> Vec<(String, String)> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c).unwrap();
        let parts = printed(&design).unwrap();
        parts.iter().filter_map(|part| Some((part.name.clone(), part.thin_warning(&design)?))).collect()
    }

    /// `raise a.b to 2` as an assignment.
    fn assignment(words: &str) -> String {
        let mut words = words.split_whitespace();
        let (Some("raise" | "lower"), Some(field), Some("to"), Some(value)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            panic!("{words:?}")
        };
        format!("{field}={value}")
    }

    #[test]
    fn remedies_of_thin_walls_work() {
        let mut followed = 0;
        for set in [
            &["shell.stop_mm=0"][..],
            &["shell.stop_mm=0", "silicone.thickness_mm=1.2"],
            &["mould.kind=one-piece", "silicone.thickness_mm=1.2"],
            &["mould.kind=one-piece", "silicone.thickness_mm=1.5"],
            &["support.lip_height_mm=0.6"],
            &["print.line_mm=0.6"],
            &["print.line_mm=0.55", "shell.stop_mm=0.5"],
            &["mount.kind=rig", "mount.rim_mm=1", "print.line_mm=0.6"],
        ] {
            let warnings = warned(set);
            assert!(!warnings.is_empty(), "no thin wall with {set:?}");
            for (part, warning) in warnings {
                let remedy = warning.rsplit(": ").next().unwrap();
                if remedy.starts_with("print lines") {
                    continue;
                }
                let way: Vec<String> = remedy.split(", and ").map(assignment).collect();
                let mut changed = set.to_vec();
                changed.extend(way.iter().map(String::as_str));
                let left = warned(&changed);
                assert!(left.iter().all(|(p, _)| *p != part), "{set:?}, {way:?}: {left:?}");
                followed += 1;
            }
        }
        assert!(followed > 12, "{followed}");
    }
}
