//! Walls of printed parts that are thinner than two printed lines, and what makes them thicker: every value that a warning
//! names was tried.

use pinswitch_solid::solid::ThinPlace;

use super::{Material, Part, Role, printed_part};
use crate::config::Configuration;
use crate::design::Design;
use crate::design::rules::Direction::{self, Lower, Raise, Restore};
use crate::feasibility::advice;

/// Walls of exactly two lines are not thin for the rounding of their distance.
const THIN_ROUNDING_MM: f64 = 1e-6;
/// How near the thickness of a place comes to one that a rule has told of, if it is that one; and of places that are alike.
const ALIKE_MM: f64 = 1e-3;
/// Changes that are named together where no single one will do.
const TOGETHER: usize = 3;

impl Part {
    /// Places with less than two printed lines of material, the thinnest first; of what is printed.
    pub fn thin_places(&self, design: &Design) -> Vec<ThinPlace> {
        if self.material() != Material::Abs {
            return Vec::new();
        }
        let limit_mm = 2.0 * design.configuration().print.line_mm - THIN_ROUNDING_MM;
        let (under_mm, found) = self.thin.get_or_init(|| (limit_mm, self.solid.thin_places(limit_mm)));
        if *under_mm == limit_mm { found.clone() } else { self.solid.thin_places(limit_mm) }
    }

    /// The same part with what is known of one whose solid is the same.
    #[must_use]
    pub(crate) fn known_by(mut self, twin: &Self) -> Self {
        self.thin = twin.thin.clone();
        self
    }

    /// Those of which no rule of its own tells.
    fn untold_thin_places(&self, design: &Design) -> Vec<ThinPlace> {
        let mut places = self.thin_places(design);
        if self.role == Role::Shell {
            let told = [design.land_mm(), design.end_wall_mm()];
            places.retain(|p| told.iter().all(|t| (p.thickness_mm - t).abs() > ALIKE_MM));
        }
        places
    }

    /// The thinnest place, as a warning with what to change; `None` where every wall has two printed lines.
    pub fn thin_warning(&self, design: &Design) -> Option<String> {
        let places = self.untold_thin_places(design);
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

    /// What leaves this part without a thin place: one value, or several together. Where none was found, finer lines.
    fn remedy_for_thin_places(&self, design: &Design, thinnest_mm: f64) -> String {
        let places = |c: &Configuration| -> Option<Vec<ThinPlace>> {
            let design = Design::new(c.clone()).ok()?;
            Some(printed_part(&self.name, &design)?.ok()?.untold_thin_places(&design))
        };
        let is_mended = |c: &Configuration| places(c).is_some_and(|places| places.is_empty());
        // The first that does: each part is made many times for it. A layer three times as thick would mend the end walls of
        // its copy, and be another switch: it is named where nothing else helps.
        let c = design.configuration();
        if let Some(advice) = advice(c, self.thickening(), &is_mended) {
            return advice.instruction;
        }
        // The thinnest places first, then those that are left.
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
        format!("print lines of at most {line_mm:.2} mm (print.line_mm), or leave it as it is")
    }

    /// What may make a thin wall of this part thicker, the most natural first.
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
            (Role::Mount, _) => {
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
    fn every_way_out_of_a_thin_wall_leads_out() {
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
            assert!(!warnings.is_empty(), "{set:?} has no thin wall");
            for (part, warning) in warnings {
                let remedy = warning.rsplit(": ").next().unwrap();
                if remedy.starts_with("print lines") {
                    continue;
                }
                let way: Vec<String> = remedy.split(", and ").map(assignment).collect();
                let mut mended = set.to_vec();
                mended.extend(way.iter().map(String::as_str));
                let left = warned(&mended);
                assert!(left.iter().all(|(p, _)| *p != part), "{set:?}, {way:?}: {left:?}");
                followed += 1;
            }
        }
        assert!(followed > 12, "{followed}");
    }
}
