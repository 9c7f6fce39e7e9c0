//! Limits of a rig and the time that its work takes (`rig.toml`).

use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt};
use pinswitch_friction::{Substrate, published};
use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use crate::table::{MAX_WRAP_DEG, MIN_WRAP_DEG, Optional, PlateauRow};
use pinswitch_measurements::{locate_field, toml_error};

/// Advice for every invalid file.
const HELP: &str = "see `pinswitch init rig` for each field";

/// Limits of a rig and durations of its work. A field that a file omits is that of the paper's rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RigLimits {
    /// Available weights in grams.
    pub loads_g: Vec<f64>,
    /// Lowest and highest speed of the actuator, in percent.
    #[serde(deserialize_with = "exactly_two")]
    pub speeds_pct: [f64; 2],
    /// Speed of the actuator at 100 %, in millimetres per second; `None` if it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_speed_mm_s: Option<f64>,
    /// Shortest and longest pause before a reading, in seconds.
    #[serde(deserialize_with = "exactly_two")]
    pub dwells_s: [f64; 2],
    /// Available layouts, as lists of occupied grooves.
    pub layouts: Vec<Vec<usize>>,
    /// Whether silicone without pins can be measured.
    pub silicone: bool,
    /// Whether the layouts can be measured on the rigid proxy.
    pub proxy: bool,
    /// Wrap angles of a `plain` contact in degrees; empty if the rig has none.
    pub plain_wraps_deg: Vec<f64>,
    /// Mass of the hook in grams, which is part of each load; `None` for the paper's on a switch, and
    /// for no hook on a `plain` contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hook_mass_g: Option<f64>,
    /// Wrap angle of a switch in degrees; `None` for that of the calibrated table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrap_angle_deg: Option<f64>,
    /// Length of the stroke, in millimetres.
    pub stroke_mm: f64,
    /// Time of one repetition without its dwell, in seconds.
    pub seconds_per_repetition: f64,
    /// Time to change the weight, in minutes.
    pub minutes_per_load_change: f64,
    /// Time to change the layout or the substrate, in minutes.
    pub minutes_per_mount_change: f64,
    /// Upper end of the load cell's range, in newtons.
    pub cell_limit_n: f64,
}

impl Default for RigLimits {
    /// Returns the paper's rig. The times are assumptions, and so is the range of the load cell:
    /// 1.5 times the paper's largest reading.
    fn default() -> Self {
        Self {
            loads_g: published::WEIGHTS_G.to_vec(),
            speeds_pct: [40.0, 70.0],
            full_speed_mm_s: None,
            dwells_s: [0.3, 30.0],
            layouts: published::LAYOUTS.iter().map(|l| l.grooves.to_vec()).collect(),
            silicone: true,
            proxy: true,
            plain_wraps_deg: Vec::new(),
            hook_mass_g: None,
            wrap_angle_deg: None,
            stroke_mm: published::STROKE_MM,
            seconds_per_repetition: 1.5,
            minutes_per_load_change: 1.5,
            minutes_per_mount_change: 6.0,
            cell_limit_n: 75.0,
        }
    }
}

/// Possible wrap angles of a table, in words.
pub(super) const WRAPS: &str = "outside 1 to 720 degrees";
/// Lowest and highest speed of a run, in percent of full speed.
pub(super) const MIN_SPEED_PCT: f64 = 0.1;
pub(super) const MAX_SPEED_PCT: f64 = 100.0;
/// Most weights, and most layouts, of a rig: the search grows with both.
const MOST: usize = 40;

/// Number of steps of the fine grid of speeds, and the fine grid of dwells in seconds.
const FINE_STEPS: usize = 6;
const FINE_DWELLS_S: [f64; 6] = [0.3, 1.0, 2.0, published::DWELL_S, 5.0, 10.0];

/// Range of the load cell over the largest reading, if the rig's file gives none.
const CELL_MARGIN: f64 = 1.5;

/// A contact that can be mounted.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Contact {
    /// What the tendon touches; `None` for `plain`.
    pub(super) substrate: Option<Substrate>,
    /// Occupied grooves, ascending.
    pub(super) pins: Vec<usize>,
    /// Wrap angle in degrees where it differs from the paper's.
    pub(super) wrap_angle_deg: Option<f64>,
}

/// An invalid field with its value and the problem.
type Invalid = (&'static str, String, &'static str);

impl RigLimits {
    /// Parses a rig. `file` is its name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first invalid field.
    pub fn parse(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let rig: Self = toml::from_str(text).map_err(|e| toml_error(file, text, &e).with_help(HELP))?;
        rig.invalid_field().map_or(Ok(rig), |(field, value, problem)| {
            let error = Diagnostic::new(codes::OUT_OF_RANGE, problem)
                .with_location(Location::field(field, value))
                .with_help(HELP);
            Err(locate_field(error, file, text))
        })
    }

    fn invalid_field(&self) -> Option<Invalid> {
        let inside = |x: f64, low: f64, high: f64| x >= low && x <= high;
        let pair = |[low, high]: [f64; 2], least: f64, most: f64| {
            inside(low, least, most) && inside(high, low, most)
        };
        let loads = &self.loads_g;
        if loads.is_empty() || loads.len() > MOST {
            return Some(("loads_g", format!("{} weights", loads.len()), "1 to 40 weights are possible"));
        }
        if let Some(weight) = loads.iter().find(|g| !inside(**g, 0.0, 1e6)) {
            return Some(("loads_g", weight.to_string(), "outside 0 to 1000000 g"));
        }
        if let Some(weight) = repeated(loads) {
            return Some(("loads_g", weight.to_string(), "the weight is listed twice"));
        }
        if !pair(self.speeds_pct, MIN_SPEED_PCT, MAX_SPEED_PCT) {
            return Some((
                "speeds_pct",
                format!("{:?}", self.speeds_pct),
                "expected [lowest, highest] within 0.1 to 100 % of full speed",
            ));
        }
        if !pair(self.dwells_s, 0.01, 3600.0) {
            return Some((
                "dwells_s",
                format!("{:?}", self.dwells_s),
                "expected [shortest, longest] within 0.01 to 3600 s",
            ));
        }
        let is_layout = |grooves: &Vec<usize>| {
            !grooves.is_empty()
                && grooves.is_sorted_by(|a, b| a < b)
                && grooves.iter().all(|g| (1..=published::GROOVES).contains(g))
        };
        if self.layouts.len() > MOST {
            return Some(("layouts", format!("{} layouts", self.layouts.len()), "at most 40 are possible"));
        }
        if let Some(layout) = self.layouts.iter().find(|layout| !is_layout(layout)) {
            let grooves = excerpt(&format!("{layout:?}"), 60);
            return Some(("layouts", grooves, "not an ascending list of grooves 1..15"));
        }
        if let Some(layout) = repeated(&self.layouts) {
            return Some(("layouts", format!("{layout:?}"), "the layout is listed twice"));
        }
        let wraps = &self.plain_wraps_deg;
        if wraps.len() > MOST {
            return Some(("plain_wraps_deg", format!("{} angles", wraps.len()), "at most 40 are possible"));
        }
        if let Some(degrees) = wraps.iter().find(|x| !inside(**x, MIN_WRAP_DEG, MAX_WRAP_DEG)) {
            return Some(("plain_wraps_deg", degrees.to_string(), WRAPS));
        }
        if let Some(degrees) = repeated(wraps) {
            return Some(("plain_wraps_deg", degrees.to_string(), "the angle is listed twice"));
        }
        if !self.silicone && self.layouts.is_empty() && wraps.is_empty() {
            return Some((
                "silicone",
                "false".to_owned(),
                "must be true without layouts and plain_wraps_deg, since there is nothing else to measure",
            ));
        }
        let usual = published::WRAP_ANGLE_DEG;
        let single = [
            ("wrap_angle_deg", self.wrap_angle_deg.unwrap_or(usual), MIN_WRAP_DEG, MAX_WRAP_DEG, WRAPS),
            ("hook_mass_g", self.hook_mass_g.unwrap_or(0.0), 0.0, 1e6, "outside 0 to 1000000 g"),
            ("full_speed_mm_s", self.full_speed_mm_s.unwrap_or(1.0), 0.01, 1e4, "outside 0.01 to 10000 mm/s"),
            ("stroke_mm", self.stroke_mm, 1.0, 1e4, "outside 1 to 10000 mm"),
            ("seconds_per_repetition", self.seconds_per_repetition, 0.01, 600.0, "outside 0.01 to 600 s"),
            ("minutes_per_load_change", self.minutes_per_load_change, 0.0, 600.0, "outside 0 to 600 min"),
            ("minutes_per_mount_change", self.minutes_per_mount_change, 0.0, 600.0, "outside 0 to 600 min"),
            ("cell_limit_n", self.cell_limit_n, 0.1, 1e6, "outside 0.1 to 1000000 N"),
        ];
        let wrong = single.into_iter().find(|(_, x, low, high, _)| !inside(*x, *low, *high));
        wrong.map(|(field, x, _, _, problem)| (field, x.to_string(), problem))
    }

    /// Returns the rig of a table without a switch: its loads, angles, speeds and dwells. `None` for a
    /// table with silicone or pins, which the paper's rig can measure.
    pub fn of_plain_table(rows: &[PlateauRow]) -> Option<Self> {
        if rows.is_empty() || rows.iter().any(|row| row.substrate.is_some()) {
            return None;
        }
        let values = |value: fn(&PlateauRow) -> f64| {
            let mut all: Vec<f64> = rows.iter().map(value).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let range = |quantity: Optional, value: fn(&PlateauRow) -> f64, neutral: f64| {
            let is_known = rows.iter().all(|row| !row.unknown.contains(quantity) && value(row) > 0.0);
            let all = values(value);
            match (is_known, all.first(), all.last()) {
                (true, Some(least), Some(most)) => [*least, *most],
                _ => [neutral, neutral],
            }
        };
        let has_masses = rows.iter().all(|r| !r.unknown.contains(Optional::LoadMass) && r.load_mass_g > 0.0);
        let tenths = |grams: f64| (10.0 * grams).round() / 10.0;
        let mut loads_g = if has_masses {
            values(|row| row.load_mass_g)
        } else {
            values(|row| row.load_n).into_iter().map(|n| tenths(1e3 * n / published::GRAVITY_M_S2)).collect()
        };
        loads_g.dedup();
        let mut wraps_deg = values(|row| row.wrap_angle_deg);
        for all in [&mut loads_g, &mut wraps_deg] {
            let step = all.len().div_ceil(MOST).max(1);
            *all = all.iter().copied().step_by(step).collect();
        }
        let highest_n = rows.iter().map(|row| row.force_n.abs()).fold(0.1, f64::max);
        let clamped =
            |[low, high]: [f64; 2], least: f64, most: f64| [low.clamp(least, most), high.clamp(least, most)];
        Some(Self {
            loads_g,
            speeds_pct: clamped(
                range(Optional::Speed, |row| row.speed_pct, 50.0),
                MIN_SPEED_PCT,
                MAX_SPEED_PCT,
            ),
            dwells_s: clamped(range(Optional::Dwell, |row| row.dwell_s, published::DWELL_S), 0.01, 3600.0),
            layouts: Vec::new(),
            silicone: false,
            proxy: false,
            plain_wraps_deg: wraps_deg,
            cell_limit_n: CELL_MARGIN * highest_n,
            ..Self::default()
        })
    }

    /// Returns the contacts that can be mounted: silicone without pins, each layout on the proxy and on
    /// silicone, and each angle of a `plain` contact.
    pub(super) fn contacts(&self) -> Vec<Contact> {
        let on = |substrate: Substrate, pins: &[usize]| Contact {
            substrate: Some(substrate),
            pins: pins.to_vec(),
            wrap_angle_deg: self.other_wrap_deg(),
        };
        let mut all = Vec::new();
        if self.silicone {
            all.push(on(Substrate::Silicone, &[]));
        }
        if self.proxy {
            all.extend(self.layouts.iter().map(|pins| on(Substrate::Abs, pins)));
        }
        all.extend(self.layouts.iter().map(|pins| on(Substrate::Silicone, pins)));
        let plain = |degrees: &f64| Contact {
            substrate: None,
            pins: Vec::new(),
            wrap_angle_deg: Some(*degrees).filter(|degrees| *degrees != published::WRAP_ANGLE_DEG),
        };
        all.extend(self.plain_wraps_deg.iter().map(plain));
        all
    }

    /// Returns the load in newtons of a weight on a contact.
    pub fn load_n(&self, substrate: Option<Substrate>, mass_g: f64) -> f64 {
        (mass_g + self.hook_g(substrate)) * 1e-3 * published::GRAVITY_M_S2
    }

    /// Returns the mass of the hook in grams on a contact: by default the paper's on a switch, and none
    /// on a `plain` contact.
    pub fn hook_g(&self, substrate: Option<Substrate>) -> f64 {
        let usual = if substrate.is_some() { published::HOOK_MASS_G } else { 0.0 };
        self.hook_mass_g.unwrap_or(usual)
    }

    /// Returns a speed in millimetres per second; `None` if the full speed is unknown.
    pub fn speed_mm_s(&self, speed_pct: f64) -> Option<f64> {
        self.full_speed_mm_s.map(|full| full * speed_pct / 100.0)
    }

    /// Returns the rig with a wrap angle in degrees, unless its file gives one.
    #[must_use]
    pub fn wrapped_by(mut self, degrees: f64) -> Self {
        self.wrap_angle_deg = self.wrap_angle_deg.or(Some(degrees));
        self
    }

    /// Returns the wrap angle of the runs in degrees if it differs from the paper's.
    pub(super) fn other_wrap_deg(&self) -> Option<f64> {
        self.wrap_angle_deg.filter(|degrees| *degrees != published::WRAP_ANGLE_DEG)
    }

    /// Returns the speeds to choose from: both ends and the middle, or a finer grid for effects of an
    /// unknown form.
    pub(super) fn speeds(&self, is_fine: bool) -> Vec<f64> {
        let [low, high] = self.speeds_pct;
        let steps = if is_fine { FINE_STEPS } else { 2 };
        let speed = |i: usize| low + (high - low) * i as f64 / steps as f64;
        distinct((0..=steps).map(|i| (10.0 * speed(i)).round() / 10.0).map(|s| s.clamp(low, high)))
    }

    /// Returns the dwells to choose from: the paper's, a shorter and a longer one, or a finer grid,
    /// clamped to the rig's range. A dwell above ten seconds costs more time than its information is
    /// worth.
    pub(super) fn dwells(&self, is_fine: bool) -> Vec<f64> {
        let [low, high] = self.dwells_s;
        let all: &[f64] = if is_fine { &FINE_DWELLS_S } else { &[1.0, published::DWELL_S, 10.0] };
        distinct(all.iter().map(|s| s.clamp(low, high)))
    }
}

/// Deserializes two numbers. Without it serde would ignore the rest of a longer list.
fn exactly_two<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let all = Vec::<f64>::deserialize(from)?;
    <[f64; 2]>::try_from(all).map_err(|all| D::Error::invalid_length(all.len(), &"an array of length 2"))
}

/// Returns the first repeated entry of a list.
fn repeated<T: PartialEq>(all: &[T]) -> Option<&T> {
    all.iter().enumerate().find(|(i, entry)| all[..*i].contains(entry)).map(|(_, entry)| entry)
}

fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_fields_are_located() {
        assert_eq!(RigLimits::parse("", "rig.toml").unwrap(), RigLimits::default());
        for (text, words) in [
            ("loads_g = []", "rig.toml:1:11: loads_g = 0 weights: 1 to 40 weights are possible"),
            ("loads_g = [100, -5, 200]", "rig.toml:1:11: loads_g = -5: outside 0 to 1000000 g"),
            ("loads_g = [100, 200, 100]", "loads_g = 100: the weight is listed twice"),
            ("layouts = [[5, 8], [3], [5, 8]]", "layouts = [5, 8]: the layout is listed twice"),
            ("silicone = true\nspeeds_pct = [70, 40]", "rig.toml:2:14: speeds_pct = [70.0, 40.0]: expected"),
            (
                "speeds_pct = [40, 400]",
                "speeds_pct = [40.0, 400.0]: expected [lowest, highest] within 0.1 to 100 %",
            ),
            ("dwells_s = [0.0, 3.0]", "dwells_s = [0.0, 3.0]: expected [shortest, longest]"),
            ("layouts = [[16]]", "layouts = [16]: not an ascending list of grooves 1..15"),
            ("layouts = [[8, 5]]", "layouts = [8, 5]: not an ascending list"),
            ("layouts = []\nsilicone = false", "rig.toml:2:12: silicone = false: must be true"),
            ("plain_wraps_deg = [90, 800]", "rig.toml:1:19: plain_wraps_deg = 800: outside 1 to 720 degrees"),
            ("wrap_angle_deg = 0", "rig.toml:1:18: wrap_angle_deg = 0: outside 1 to 720 degrees"),
            ("full_speed_mm_s = 0", "full_speed_mm_s = 0: outside 0.01 to 10000 mm/s"),
            ("stroke_mm = nan", "stroke_mm = NaN: outside"),
            ("cell_limit_n = 0", "cell_limit_n = 0: outside"),
            ("colour = 3", "rig.toml:1:1: unknown field `colour`"),
            ("loads_g = [\"a\"]", "rig.toml:1:12: loads_g[0] = \"a\": expected a number"),
            ("speeds_pct = [40]", "rig.toml:1:14: speeds_pct = [40]: expected two values in brackets"),
            (
                "dwells_s = [1, 3, 10]",
                "rig.toml:1:12: dwells_s = [1, 3, 10]: expected two values in brackets",
            ),
            ("silicone = 1", "rig.toml:1:12: silicone = 1: expected true or false"),
            ("layouts = [[1.5, 3]]", "rig.toml:1:13: layouts[0][0] = 1.5: expected a whole number"),
        ] {
            let error = RigLimits::parse(text, "rig.toml").unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
            assert!(error.help().is_some_and(|help| help.contains("init rig")), "{error}");
        }
    }

    /// Plans for a rig without silicone and pins do without them.
    #[test]
    fn rigs_of_plain_tables_have_their_angles_and_loads() {
        let mut rows = crate::test_session::session(1);
        assert_eq!(RigLimits::of_plain_table(&rows), None);
        for (i, row) in rows.iter_mut().enumerate() {
            row.substrate = None;
            row.pins.clear();
            row.wrap_angle_deg = if i % 2 == 0 { 90.0 } else { 180.0 };
            row.load_n = row.load_mass_g * 1e-3 * published::GRAVITY_M_S2;
        }
        let rig = RigLimits::of_plain_table(&rows).unwrap();
        assert_eq!(rig.invalid_field(), None);
        assert_eq!(rig.plain_wraps_deg, [90.0, 180.0]);
        assert_eq!(rig.loads_g, [251.2, 1003.2, 2005.0, 3007.2, 4007.8, 5002.5]);
        assert!(rig.contacts().iter().all(|contact| contact.substrate.is_none()));
        assert_eq!(rig.load_n(None, 1000.0), 9.80665);
        rows.iter_mut().for_each(|row| row.unknown = row.unknown.with(Optional::LoadMass));
        assert_eq!(RigLimits::of_plain_table(&rows).unwrap().loads_g, rig.loads_g);
    }

    #[test]
    fn the_papers_rig_has_seven_contacts() {
        let rig = RigLimits::default();
        assert_eq!(
            (rig.contacts().len(), rig.speeds(false), rig.dwells(false)),
            (7, vec![40.0, 55.0, 70.0], vec![1.0, 3.0, 10.0])
        );
        let fixed = RigLimits { speeds_pct: [50.0, 50.0], dwells_s: [3.0, 3.0], ..rig };
        assert_eq!((fixed.speeds(true), fixed.dwells(true)), (vec![50.0], vec![3.0]));
    }
}
