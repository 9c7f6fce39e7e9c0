//! `run.toml`: the rig and the series of a raw run.

use pinswitch_diagnostic::excerpt;
use pinswitch_friction::{Substrate, published};
use serde::Deserialize;
use toml::de::DeTable;

use crate::table::{MAX_N, MAX_PERCENT, MAX_WRAP_DEG, MIN_WRAP_DEG, Sweep};
use crate::toml_text::toml_error;

/// Why a run description cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RunPlanError {
    /// The text is no such TOML.
    #[error("{file}: {}; model/doc/file-formats.md shows the form", excerpt(problem, 300))]
    Malformed {
        /// File name as given, with the line.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A value is out of bounds.
    #[error(
        "{file}: {field} = {} is outside {bound}; give a value within, as model/doc/file-formats.md shows",
        excerpt(value, 120)
    )]
    Bound {
        /// File name as given, with the line.
        file: String,
        /// Field.
        field: String,
        /// Value found.
        value: String,
        /// What is allowed.
        bound: &'static str,
    },
}

/// The rig of a run.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Rig {
    /// Wrap angle in degrees.
    pub wrap_angle_deg: f64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Mass of the hook in grams; it counts as load.
    pub hook_mass_g: f64,
    /// Stroke in millimetres.
    pub stroke_mm: f64,
    /// Seconds that the actuator runs for one repetition.
    pub on_s: f64,
    /// Seconds that it rests afterwards.
    pub dwell_s: f64,
}

/// One log of a run.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct SeriesPlan {
    /// The log's file name, beside the run description.
    pub file: String,
    /// What the tendon lies on; `None` for `plain`.
    #[serde(with = "crate::table::substrate_word")]
    pub substrate: Option<Substrate>,
    /// Occupied grooves.
    pub pins: Vec<usize>,
    /// The weight in grams, without the hook.
    pub load_mass_g: f64,
    /// Actuator speed in percent.
    pub speed_pct: f64,
    /// Order of the loads.
    pub sweep: Sweep,
}

impl SeriesPlan {
    /// The load in newtons, hook included.
    pub fn load_n(&self, rig: &Rig) -> f64 {
        (self.load_mass_g + rig.hook_mass_g) * 1e-3 * published::GRAVITY_M_S2
    }
}

/// A raw run.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RunPlan {
    /// The rig.
    pub rig: Rig,
    /// Its logs, in the order in which they were recorded.
    pub series: Vec<SeriesPlan>,
}

impl RunPlan {
    /// Reads a run description. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`RunPlanError`] at the first value that cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, RunPlanError> {
        let plan: Self = toml::from_str(text).map_err(|e| {
            let (file, problem) = toml_error(file, text, &e);
            RunPlanError::Malformed { file, problem }
        })?;
        let refuse = |field: String, value: String, bound| {
            let line = line_of(text, &field).map_or_else(String::new, |line| format!(":{line}"));
            Err(RunPlanError::Bound { file: format!("{file}{line}"), field, value, bound })
        };
        let r = &plan.rig;
        for (field, value) in [
            ("rig.sample_rate_hz", r.sample_rate_hz),
            ("rig.stroke_mm", r.stroke_mm),
            ("rig.on_s", r.on_s),
            ("rig.dwell_s", r.dwell_s),
        ] {
            if !(value > 0.0 && value <= 1e5) {
                return refuse(field.to_owned(), value.to_string(), "0 < value <= 100000");
            }
        }
        if !(MIN_WRAP_DEG..=MAX_WRAP_DEG).contains(&r.wrap_angle_deg) {
            return refuse("rig.wrap_angle_deg".to_owned(), r.wrap_angle_deg.to_string(), "1..720 degrees");
        }
        if !(r.hook_mass_g >= 0.0 && r.hook_mass_g.is_finite()) {
            return refuse("rig.hook_mass_g".to_owned(), r.hook_mass_g.to_string(), "value >= 0");
        }
        if plan.series.is_empty() {
            return refuse("series".to_owned(), "[]".to_owned(), "at least one [[series]]");
        }
        for (i, s) in plan.series.iter().enumerate() {
            let field = |name: &str| format!("series {}: {name}", i + 1);
            if !(s.load_mass_g >= 0.0 && s.load_mass_g.is_finite()) {
                return refuse(field("load_mass_g"), s.load_mass_g.to_string(), "value >= 0");
            }
            if !(0.0..=MAX_PERCENT).contains(&s.speed_pct) {
                return refuse(field("speed_pct"), s.speed_pct.to_string(), "0..1000000");
            }
            if s.pins.iter().any(|p| !(1..=published::GROOVES).contains(p)) {
                return refuse(field("pins"), format!("{:?}", s.pins), "grooves 1..15");
            }
            if s.pins.iter().enumerate().any(|(i, pin)| s.pins[..i].contains(pin)) {
                return refuse(field("pins"), format!("{:?}", s.pins), "grooves named once each");
            }
            if s.load_n(r) > MAX_N {
                let grams = s.load_mass_g.to_string();
                return refuse(field("load_mass_g"), grams, "what weighs 100000 N with the hook");
            }
            if s.substrate == Some(Substrate::Abs) && s.pins.is_empty() {
                return refuse(field("pins"), "[]".to_owned(), "at least one groove on abs");
            }
        }
        Ok(plan)
    }
}

/// The line of a field as errors name it, `rig.on_s` or `series 2: pins`, from 1.
fn line_of(text: &str, field: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let document = document.get_ref();
    let value = match field.split_once(": ") {
        Some((series, key)) => {
            let number: usize = series.strip_prefix("series ")?.parse().ok()?;
            let all = document.get("series")?.get_ref().as_array()?;
            all.get(number.checked_sub(1)?)?.get_ref().as_table()?.get(key)?
        }
        None => match field.split_once('.') {
            Some((table, key)) => document.get(table)?.get_ref().as_table()?.get(key)?,
            None => document.get(field)?,
        },
    };
    Some(1 + text.get(..value.span().start)?.matches('\n').count())
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: &str = "[rig]\nwrap_angle_deg=63.89\nsample_rate_hz=200.0\nhook_mass_g=62.53\nstroke_mm=152.4\non_s=0.5\ndwell_s=3.0\n";
    const SERIES: &str = "[[series]]\nfile=\"a.csv\"\nsubstrate=\"silicone\"\npins=[]\nload_mass_g=251.2\nspeed_pct=47\nsweep=\"up\"\n";

    #[test]
    fn the_hook_counts_as_load() {
        let plan = RunPlan::parse(&format!("{RIG}{SERIES}"), "run.toml").unwrap();
        assert!((plan.series[0].load_n(&plan.rig) - 3.0766).abs() < 1e-4);
    }

    #[test]
    fn unusable_values_are_named() {
        for (from, to, expected) in [
            ("rate_hz=200.0", "rate_hz=nan", "run.toml:3: rig.sample_rate_hz = NaN is outside 0 < value"),
            ("on_s=0.5", "on_s=-1.0", "rig.on_s"),
            ("deg=63.89", "deg=0.0", "rig.wrap_angle_deg = 0 is outside 1..720"),
            ("load_mass_g=251.2", "load_mass_g=-2.0", "run.toml:12: series 1: load_mass_g"),
            ("\"silicone\"", "\"abs\"", "series 1: pins"),
            ("pins=[]", "pins=[99]", "grooves 1..15"),
            ("pins=[]", "pins=[5, 5]", "once each"),
            ("load_mass_g=251.2", "load_mass_g=1e9", "series 1: load_mass_g = 1000000000 is outside"),
            ("speed_pct=47", "speed_pct=1e9", "series 1: speed_pct"),
        ] {
            let text = format!("{RIG}{SERIES}").replacen(from, to, 1);
            assert!(RunPlan::parse(&text, "run.toml").unwrap_err().to_string().contains(expected));
        }
        assert!(RunPlan::parse(RIG, "run.toml").is_err());
    }
}
