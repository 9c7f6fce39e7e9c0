//! `rig.toml`: what a rig can do, and what its time costs.

use pinswitch_diagnostic::excerpt;
use pinswitch_friction::{Substrate, published};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use crate::table::{MAX_WRAP_DEG, MIN_WRAP_DEG};
use crate::toml_text::{place_of, toml_error};

/// The limits of a rig and the minutes of its work. Every field that a file leaves out is that of the paper's rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RigLimits {
    /// Weights at hand, in grams.
    pub loads_g: Vec<f64>,
    /// Lowest and highest speed of the actuator, in percent.
    #[serde(deserialize_with = "exactly_two")]
    pub speeds_pct: [f64; 2],
    /// Shortest and longest pause before a reading, in seconds.
    #[serde(deserialize_with = "exactly_two")]
    pub dwells_s: [f64; 2],
    /// Layouts at hand, as lists of occupied grooves.
    pub layouts: Vec<Vec<usize>>,
    /// Whether silicone without pins can be measured.
    pub silicone: bool,
    /// Whether the layouts can be measured on the rigid proxy.
    pub proxy: bool,
    /// Wrap of the tendon in degrees; left out, it is that of the table that was calibrated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrap_angle_deg: Option<f64>,
    /// Length of the stroke, in millimetres.
    pub stroke_mm: f64,
    /// Time of one repetition beside its dwell, in seconds.
    pub seconds_per_repetition: f64,
    /// Time for another weight, in minutes.
    pub minutes_per_load_change: f64,
    /// Time for another layout or substrate, in minutes.
    pub minutes_per_mount_change: f64,
    /// Largest force that the load cell may read, in newtons.
    pub cell_limit_n: f64,
}

impl Default for RigLimits {
    /// The paper's rig. The minutes are assumed, and the limit of the cell: half as much again as the paper's largest
    /// reading.
    fn default() -> Self {
        Self {
            loads_g: published::WEIGHTS_G.to_vec(),
            speeds_pct: [40.0, 70.0],
            dwells_s: [0.3, 30.0],
            layouts: published::LAYOUTS.iter().map(|l| l.grooves.to_vec()).collect(),
            silicone: true,
            proxy: true,
            wrap_angle_deg: None,
            stroke_mm: published::STROKE_MM,
            seconds_per_repetition: 1.5,
            minutes_per_load_change: 1.5,
            minutes_per_mount_change: 6.0,
            cell_limit_n: 75.0,
        }
    }
}

/// Why a file describes no rig.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// The text is no such TOML.
    #[error("{file}: {problem}; `pinswitch init rig` writes one to start from")]
    Malformed {
        /// File name as given, with the line.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A value that no rig has.
    #[error("{file}: {field} = {value} is outside {bound}; `pinswitch init rig` shows each field")]
    Bound {
        /// File name as given, with the line.
        file: String,
        /// The field.
        field: &'static str,
        /// Its value.
        value: String,
        /// What may stand there.
        bound: &'static str,
    },
}

/// The wraps that a table may have, in words.
pub(super) const WRAPS: &str = "1 to 720 deg";
/// Lowest and highest speed of a run, in percent of full speed.
pub(super) const MIN_SPEED_PCT: f64 = 0.1;
pub(super) const MAX_SPEED_PCT: f64 = 100.0;
/// Most weights, and most layouts, of a rig: the search grows with both.
const MOST: usize = 40;

impl RigLimits {
    /// Reads a rig. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`RigError`] at the first field that cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, RigError> {
        let rig: Self = toml::from_str(text).map_err(|e| {
            let (file, problem) = toml_error(file, text, &e);
            RigError::Malformed { file, problem }
        })?;
        rig.flaw().map_or(Ok(rig), |(field, value, bound)| {
            Err(RigError::Bound { file: place_of(file, text, field), field, value, bound })
        })
    }

    /// The first value that no rig has.
    fn flaw(&self) -> Option<(&'static str, String, &'static str)> {
        let inside = |x: f64, low: f64, high: f64| x >= low && x <= high;
        let pair = |[low, high]: [f64; 2], least: f64, most: f64| {
            inside(low, least, most) && inside(high, low, most)
        };
        let loads = &self.loads_g;
        if loads.is_empty() || loads.len() > MOST {
            return Some(("loads_g", format!("{} weights", loads.len()), "1 to 40 of them"));
        }
        if let Some(weight) = loads.iter().find(|g| !inside(**g, 0.0, 1e6)) {
            return Some(("loads_g", weight.to_string(), "0 to 1000000 g"));
        }
        if let Some(weight) = repeated(loads) {
            return Some(("loads_g", format!("{weight}, given twice,"), "one entry a weight"));
        }
        if !pair(self.speeds_pct, MIN_SPEED_PCT, MAX_SPEED_PCT) {
            return Some((
                "speeds_pct",
                format!("{:?}", self.speeds_pct),
                "[lowest, highest] within 0.1 to 100 %, of full speed",
            ));
        }
        if !pair(self.dwells_s, 0.01, 3600.0) {
            return Some((
                "dwells_s",
                format!("{:?}", self.dwells_s),
                "[shortest, longest] within 0.01 to 3600 s",
            ));
        }
        let is_layout = |grooves: &Vec<usize>| {
            !grooves.is_empty()
                && grooves.is_sorted_by(|a, b| a < b)
                && grooves.iter().all(|g| (1..=published::GROOVES).contains(g))
        };
        if self.layouts.len() > MOST {
            return Some(("layouts", format!("{} layouts", self.layouts.len()), "up to 40 of them"));
        }
        if let Some(layout) = self.layouts.iter().find(|layout| !is_layout(layout)) {
            let told = excerpt(&format!("{layout:?}"), 60);
            return Some(("layouts", told, "lists of grooves 1..15, ascending"));
        }
        if let Some(layout) = repeated(&self.layouts) {
            return Some(("layouts", format!("{layout:?}, given twice,"), "one entry a layout"));
        }
        if !self.silicone && self.layouts.is_empty() {
            return Some((
                "silicone",
                "false".to_owned(),
                "true, or at least one layout: something must be measured",
            ));
        }
        let usual = published::WRAP_ANGLE_DEG;
        let single = [
            ("wrap_angle_deg", self.wrap_angle_deg.unwrap_or(usual), MIN_WRAP_DEG, MAX_WRAP_DEG, WRAPS),
            ("stroke_mm", self.stroke_mm, 1.0, 1e4, "1 to 10000 mm"),
            ("seconds_per_repetition", self.seconds_per_repetition, 0.01, 600.0, "0.01 to 600 s"),
            ("minutes_per_load_change", self.minutes_per_load_change, 0.0, 600.0, "0 to 600 min"),
            ("minutes_per_mount_change", self.minutes_per_mount_change, 0.0, 600.0, "0 to 600 min"),
            ("cell_limit_n", self.cell_limit_n, 0.1, 1e6, "0.1 to 1000000 N"),
        ];
        let wrong = single.into_iter().find(|(_, x, low, high, _)| !inside(*x, *low, *high));
        wrong.map(|(field, x, _, _, bound)| (field, x.to_string(), bound))
    }

    /// What can be mounted: silicone alone, each layout on the proxy, each layout on silicone.
    pub(super) fn contacts(&self) -> Vec<(Substrate, Vec<usize>)> {
        let mut all = Vec::new();
        if self.silicone {
            all.push((Substrate::Silicone, Vec::new()));
        }
        if self.proxy {
            all.extend(self.layouts.iter().map(|pins| (Substrate::Abs, pins.clone())));
        }
        all.extend(self.layouts.iter().map(|pins| (Substrate::Silicone, pins.clone())));
        all
    }

    /// The same with a wrap for every run, where the file gives none.
    #[must_use]
    pub fn wrapped_by(mut self, degrees: f64) -> Self {
        self.wrap_angle_deg = self.wrap_angle_deg.or(Some(degrees));
        self
    }

    /// The wrap of its runs, where it is not the paper's.
    pub(super) fn own_wrap_deg(&self) -> Option<f64> {
        self.wrap_angle_deg.filter(|degrees| *degrees != published::WRAP_ANGLE_DEG)
    }

    /// Speeds to choose from: both ends, and the middle.
    pub(super) fn speeds(&self) -> Vec<f64> {
        distinct([self.speeds_pct[0], self.speeds_pct[0].midpoint(self.speeds_pct[1]), self.speeds_pct[1]])
    }

    /// Pauses to choose from: the paper's where the rig has it, and up to ten seconds of what it can do otherwise. A
    /// longer pause costs more than it tells.
    pub(super) fn dwells(&self) -> Vec<f64> {
        let [low, high] = self.dwells_s;
        distinct([1.0, published::DWELL_S, 10.0].map(|s: f64| s.clamp(low, high)))
    }
}

/// Two numbers: of a longer list serde would read the first two, and pass over the rest.
fn exactly_two<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let all = Vec::<f64>::deserialize(from)?;
    <[f64; 2]>::try_from(all).map_err(|all| D::Error::invalid_length(all.len(), &"an array of length 2"))
}

/// The first entry that stands in a list before.
fn repeated<T: PartialEq>(all: &[T]) -> Option<&T> {
    all.iter().enumerate().find(|(i, entry)| all[..*i].contains(entry)).map(|(_, entry)| entry)
}

fn distinct(values: [f64; 3]) -> Vec<f64> {
    let mut all = values.to_vec();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rig_says_what_it_cannot_be() {
        assert_eq!(RigLimits::parse("", "rig.toml").unwrap(), RigLimits::default());
        for (text, words) in [
            ("loads_g = []", "rig.toml:1: loads_g = 0 weights is outside 1 to 40 of them"),
            ("loads_g = [100, -5, 200]", "rig.toml:1: loads_g = -5 is outside 0 to 1000000 g"),
            ("loads_g = [100, 200, 100]", "loads_g = 100, given twice,"),
            ("layouts = [[5, 8], [3], [5, 8]]", "layouts = [5, 8], given twice,"),
            ("silicone = true\nspeeds_pct = [70, 40]", "rig.toml:2: speeds_pct"),
            (
                "speeds_pct = [40, 400]",
                "speeds_pct = [40.0, 400.0] is outside [lowest, highest] within 0.1 to 100 %",
            ),
            ("dwells_s = [0.0, 3.0]", "dwells_s"),
            ("layouts = [[16]]", "grooves 1..15"),
            ("layouts = [[8, 5]]", "ascending"),
            ("layouts = []\nsilicone = false", "rig.toml:2: silicone"),
            ("wrap_angle_deg = 0", "rig.toml:1: wrap_angle_deg = 0 is outside 1 to 720 deg"),
            ("stroke_mm = nan", "stroke_mm = NaN"),
            ("cell_limit_n = 0", "cell_limit_n"),
            ("colour = 3", "rig.toml:1: unknown field `colour`"),
            ("loads_g = [\"a\"]", "rig.toml:1: loads_g[0] = \"a\" must be a number"),
            ("speeds_pct = [40]", "rig.toml:1: speeds_pct = [40] must be two values in brackets"),
            ("dwells_s = [1, 3, 10]", "rig.toml:1: dwells_s = [1, 3, 10] must be two values in brackets"),
            ("silicone = 1", "rig.toml:1: silicone = 1 must be true or false"),
            ("layouts = [[1.5, 3]]", "rig.toml:1: layouts[0][0] = 1.5 must be a whole number"),
        ] {
            let error = RigLimits::parse(text, "rig.toml").unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("init rig"), "{error}");
        }
    }

    #[test]
    fn the_paper_s_rig_has_seven_contacts_and_three_speeds() {
        let rig = RigLimits::default();
        assert_eq!(
            (rig.contacts().len(), rig.speeds(), rig.dwells()),
            (7, vec![40.0, 55.0, 70.0], vec![1.0, 3.0, 10.0])
        );
        let fixed = RigLimits { speeds_pct: [50.0, 50.0], dwells_s: [3.0, 3.0], ..rig };
        assert_eq!((fixed.speeds(), fixed.dwells()), (vec![50.0], vec![3.0]));
    }
}
