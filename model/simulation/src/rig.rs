//! `rig.toml`: what a rig can do, for the planning of experiments.

use pinswitch_calibration::toml_error;
use pinswitch_friction::published;
use serde::{Deserialize, Serialize};

use crate::plan::PlanError;

/// What a rig can do. The default is the paper's rig.
///
/// ```
/// use pinswitch_simulation::Rig;
///
/// let rig = Rig::parse("loads_g = [500, 1000]\ndwells_s = [1, 10]", "rig.toml")?;
/// assert_eq!(rig.stroke_mm, Rig::default().stroke_mm);
/// let error = Rig::parse("speeds_pct = [70, 40]", "rig.toml").unwrap_err();
/// assert!(error.to_string().starts_with("rig.toml: speeds_pct = [70.0, 40.0] is outside"));
/// # Ok::<(), pinswitch_simulation::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rig {
    /// Weights at hand in grams, without the hook.
    pub loads_g: Vec<f64>,
    /// Lowest and highest speed of the actuator in percent.
    pub speeds_pct: [f64; 2],
    /// Shortest and longest pause before a reading in seconds.
    pub dwells_s: [f64; 2],
    /// Layouts at hand as lists of occupied grooves.
    pub layouts: Vec<Vec<usize>>,
    /// Whether silicone without pins is at hand.
    pub silicone: bool,
    /// Whether each layout is at hand on the rigid proxy, too.
    pub proxy: bool,
    /// Length of the stroke in millimetres.
    pub stroke_mm: f64,
    /// Seconds that a repetition takes beside its dwell.
    pub seconds_per_repetition: f64,
    /// Minutes that a change of the load takes.
    pub minutes_per_load_change: f64,
    /// Minutes that a change of the switch takes.
    pub minutes_per_mount_change: f64,
    /// Force in newtons at which the load cell ends.
    pub cell_limit_n: f64,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            loads_g: published::WEIGHTS_G.to_vec(),
            speeds_pct: [40.0, 70.0],
            dwells_s: [0.3, 30.0],
            layouts: published::LAYOUTS.iter().map(|l| l.grooves.to_vec()).collect(),
            silicone: true,
            proxy: true,
            stroke_mm: published::STROKE_MM,
            // The times are assumed: the paper does not tell them.
            seconds_per_repetition: 1.5,
            minutes_per_load_change: 1.5,
            minutes_per_mount_change: 6.0,
            // Assumed: half as much again as the largest reading of the paper.
            cell_limit_n: 75.0,
        }
    }
}

/// Largest number of a rig: far above any.
const MAX_VALUE: f64 = 1e6;
/// Most weights and layouts.
const MAX_LIST: usize = 100;

impl Rig {
    /// Reads a rig. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, PlanError> {
        let rig: Self = toml::from_str(text).map_err(|e| {
            let (file, problem) = toml_error(file, text, &e);
            PlanError::Malformed { file, problem }
        })?;
        rig.check(file)?;
        Ok(rig)
    }

    fn check(&self, file: &str) -> Result<(), PlanError> {
        let refuse = |field, value: String, bound, remedy| {
            Err(PlanError::Bound { file: file.to_owned(), field, value, bound, remedy })
        };
        let usable = |v: &f64| *v > 0.0 && *v <= MAX_VALUE;
        if !(1..=MAX_LIST).contains(&self.loads_g.len()) || !self.loads_g.iter().all(usable) {
            let value = format!("{:?}", self.loads_g);
            return refuse(
                "loads_g",
                value,
                "1 to 100 numbers above 0, up to 1000000",
                "list the weights at hand",
            );
        }
        for (field, range) in [("speeds_pct", self.speeds_pct), ("dwells_s", self.dwells_s)] {
            if !range.iter().all(usable) || range[0] > range[1] {
                let value = format!("{range:?}");
                return refuse(
                    field,
                    value,
                    "two numbers above 0, up to 1000000",
                    "give the lower one first",
                );
            }
        }
        let groove = |pins: &Vec<usize>, i: usize| {
            (1..=published::GROOVES).contains(&pins[i]) && !pins[..i].contains(&pins[i])
        };
        let is_layout = |pins: &Vec<usize>| !pins.is_empty() && (0..pins.len()).all(|i| groove(pins, i));
        if self.layouts.len() > MAX_LIST || !self.layouts.iter().all(is_layout) {
            let value = format!("{:?}", self.layouts);
            return refuse(
                "layouts",
                value,
                "up to 100 lists of grooves 1..15",
                "name each groove of a layout once",
            );
        }
        if self.layouts.is_empty() && !self.silicone {
            return refuse("layouts", "[]".to_owned(), "at least one", "or set silicone = true");
        }
        for (field, value) in [
            ("stroke_mm", self.stroke_mm),
            ("seconds_per_repetition", self.seconds_per_repetition),
            ("cell_limit_n", self.cell_limit_n),
        ] {
            if !usable(&value) {
                return refuse(
                    field,
                    value.to_string(),
                    "0 < value <= 1000000",
                    "leave it out for the paper's",
                );
            }
        }
        for (field, value) in [
            ("minutes_per_load_change", self.minutes_per_load_change),
            ("minutes_per_mount_change", self.minutes_per_mount_change),
        ] {
            if !(0.0..=MAX_VALUE).contains(&value) {
                return refuse(field, value.to_string(), "0..1000000", "leave it out for the paper's");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rig_names_what_it_cannot_use() {
        for (text, part) in [
            ("loads_g = []", "loads_g = [] is outside"),
            ("loads_g = [nan]", "loads_g"),
            ("dwells_s = [0, 3]", "dwells_s"),
            ("layouts = [[5, 5]]", "layouts"),
            ("layouts = [[99]]", "layouts"),
            ("layouts = []\nsilicone = false", "at least one"),
            ("stroke_mm = -1", "stroke_mm = -1"),
            ("minutes_per_mount_change = inf", "minutes_per_mount_change"),
            ("strok_mm = 1", "rig.toml:1: unknown field"),
        ] {
            let error = Rig::parse(text, "rig.toml").unwrap_err().to_string();
            assert!(error.contains(part) && error.starts_with("rig.toml"), "{error}");
        }
        assert_eq!(Rig::parse("", "rig.toml"), Ok(Rig::default()));
    }

    #[test]
    fn the_template_is_the_default() {
        let text = include_str!("../../../templates/rig/rig.toml");
        assert_eq!(Rig::parse(text, "rig.toml"), Ok(Rig::default()));
    }
}
