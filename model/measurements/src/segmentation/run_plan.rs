//! Description of a raw run (`run.toml`): the rig and the series.

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::{Substrate, published};
use schemars::JsonSchema;
use serde::Deserialize;

use super::direction::Protocol;
use crate::table::{MAX_N, MAX_PERCENT, MAX_WRAP_DEG, MIN_WRAP_DEG, Sweep};
use crate::toml_text::{field_location, toml_error};

/// Advice for every invalid run description.
const HELP: &str = "see model/doc/file-formats.md, or start from `pinswitch init run`";

/// The rig of a run. Optional values are declarations, with which the logs are compared.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
pub struct Rig {
    /// Wrap angle in degrees.
    pub wrap_angle_deg: f64,
    /// Samples per second.
    pub sample_rate_hz: Option<f64>,
    /// Mass of the hook in grams; it counts as load.
    #[serde(default)]
    pub hook_mass_g: f64,
    /// Stroke in millimetres.
    pub stroke_mm: Option<f64>,
    /// Time in seconds for which the actuator runs in one repetition.
    pub on_s: Option<f64>,
    /// Time in seconds for which it rests afterwards.
    pub dwell_s: Option<f64>,
    /// Speed of the actuator at 100 %, in millimetres per second.
    pub full_speed_mm_s: Option<f64>,
    /// Order of the directions.
    pub protocol: Option<Protocol>,
}

/// The words for what the tendon touches.
#[derive(JsonSchema)]
#[serde(rename_all = "lowercase")]
#[expect(dead_code, reason = "describes the words of a file")]
enum SubstrateWord {
    /// One contact of any material.
    Plain,
    /// Pins in silicone, or silicone alone.
    Silicone,
    /// The rigid proxy.
    Abs,
}

/// One series of a run: a log, or several logs in the order of recording.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SeriesPlan {
    /// File name of the log, relative to the run description; empty with `files`.
    #[serde(default)]
    pub file: String,
    /// File names of the logs of the series, such as one for each move.
    #[serde(default)]
    pub files: Vec<String>,
    /// What the tendon touches; `None` for `plain`.
    #[serde(with = "crate::table::substrate_word")]
    #[schemars(with = "SubstrateWord")]
    pub substrate: Option<Substrate>,
    /// Occupied grooves.
    pub pins: Vec<usize>,
    /// Mass of the weight in grams, without the hook; `None` if the log has it.
    pub load_mass_g: Option<f64>,
    /// Actuator speed in percent.
    pub speed_pct: Option<f64>,
    /// Order of the loads.
    pub sweep: Option<Sweep>,
}

impl SeriesPlan {
    /// Returns the declared load in newtons, including the hook.
    pub fn load_n(&self, rig: &Rig) -> Option<f64> {
        self.load_mass_g.map(|mass_g| (mass_g + rig.hook_mass_g) * 1e-3 * published::GRAVITY_M_S2)
    }

    /// Returns the file names of the logs.
    pub fn file_names(&self) -> Vec<&str> {
        if self.files.is_empty() { vec![&self.file] } else { self.files.iter().map(String::as_str).collect() }
    }

    /// Whether another entry has the same condition, load, speed and sweep.
    pub fn has_same_condition(&self, other: &Self) -> bool {
        (self.substrate, &self.pins, self.load_mass_g) == (other.substrate, &other.pins, other.load_mass_g)
            && (self.speed_pct, self.sweep) == (other.speed_pct, other.sweep)
    }

    /// Returns the name of the series in reports: its first log.
    pub fn name(&self) -> &str {
        self.files.first().unwrap_or(&self.file)
    }
}

/// A raw run.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct RunPlan {
    /// The rig.
    pub rig: Rig,
    /// File name of the description of the columns of the logs, relative to the run description.
    pub map: Option<String>,
    /// The logs, in the order in which they were recorded.
    pub series: Vec<SeriesPlan>,
}

impl RunPlan {
    /// Parses a run description. `file` is its name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first invalid value.
    pub fn parse(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let plan: Self = toml::from_str(text).map_err(|e| toml_error(file, text, &e).with_help(HELP))?;
        let refuse = |field: String, value: String, bound: &str| {
            let location = field_location(file, text, &field).with_field(field, value);
            Err(Diagnostic::new(codes::OUT_OF_RANGE, bound).with_location(location).with_help(HELP))
        };
        let r = &plan.rig;
        for (field, value) in [
            ("rig.sample_rate_hz", r.sample_rate_hz),
            ("rig.stroke_mm", r.stroke_mm),
            ("rig.on_s", r.on_s),
            ("rig.dwell_s", r.dwell_s),
            ("rig.full_speed_mm_s", r.full_speed_mm_s),
        ] {
            let Some(value) = value else { continue };
            if !(value > 0.0 && value <= 1e5) {
                return refuse(field.to_owned(), value.to_string(), "not above 0 and up to 100000");
            }
        }
        if !(MIN_WRAP_DEG..=MAX_WRAP_DEG).contains(&r.wrap_angle_deg) {
            return refuse(
                "rig.wrap_angle_deg".to_owned(),
                r.wrap_angle_deg.to_string(),
                "outside 1 to 720 degrees",
            );
        }
        if !(r.hook_mass_g >= 0.0 && r.hook_mass_g.is_finite()) {
            return refuse(
                "rig.hook_mass_g".to_owned(),
                r.hook_mass_g.to_string(),
                "not a mass of at least 0",
            );
        }
        if plan.series.is_empty() {
            return refuse("series".to_owned(), "[]".to_owned(), "at least one [[series]] is needed");
        }
        for (i, s) in plan.series.iter().enumerate() {
            let field = |name: &str| format!("series[{i}].{name}");
            if s.file.is_empty() == s.files.is_empty() || s.files.iter().any(String::is_empty) {
                return refuse(
                    field("file"),
                    format!("{:?}", s.file),
                    "either file or files must name a log",
                );
            }
            if let Some(mass_g) = s.load_mass_g.filter(|mass_g| !(*mass_g >= 0.0 && mass_g.is_finite())) {
                return refuse(field("load_mass_g"), mass_g.to_string(), "not a mass of at least 0");
            }
            if let Some(speed_pct) = s.speed_pct.filter(|speed| !(0.0..=MAX_PERCENT).contains(speed)) {
                return refuse(field("speed_pct"), speed_pct.to_string(), "outside 0 to 1000000");
            }
            if s.pins.iter().any(|p| !(1..=published::GROOVES).contains(p)) {
                return refuse(field("pins"), format!("{:?}", s.pins), "a groove is outside 1..15");
            }
            if s.pins.iter().enumerate().any(|(i, pin)| s.pins[..i].contains(pin)) {
                return refuse(field("pins"), format!("{:?}", s.pins), "a groove is listed twice");
            }
            if s.load_n(r).is_some_and(|load_n| load_n > MAX_N) {
                let grams = s.load_mass_g.unwrap_or_default().to_string();
                return refuse(field("load_mass_g"), grams, "above 100000 N together with the hook");
            }
            if s.substrate == Some(Substrate::Abs) && s.pins.is_empty() {
                return refuse(field("pins"), "[]".to_owned(), "abs needs at least one groove");
            }
        }
        Ok(plan)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: &str = "[rig]\nwrap_angle_deg=63.89\nsample_rate_hz=200.0\nhook_mass_g=62.53\nstroke_mm=152.4\non_s=0.5\ndwell_s=3.0\n";
    const SERIES: &str = "[[series]]\nfile=\"a.csv\"\nsubstrate=\"silicone\"\npins=[]\nload_mass_g=251.2\nspeed_pct=47\nsweep=\"up\"\n";

    #[test]
    fn the_hook_counts_as_load() {
        let plan = RunPlan::parse(&format!("{RIG}{SERIES}"), "run.toml").unwrap();
        assert!((plan.series[0].load_n(&plan.rig).unwrap() - 3.0766).abs() < 1e-4);
    }

    #[test]
    fn declarations_are_optional() {
        let text = "map=\"m.toml\"\n[rig]\nwrap_angle_deg=90\nprotocol=\"alternating\"\n[[series]]\n\
                    files=[\"a.csv\", \"b.csv\"]\nsubstrate=\"plain\"\npins=[]\n";
        let plan = RunPlan::parse(text, "run.toml").unwrap();
        assert_eq!((plan.rig.hook_mass_g, plan.rig.dwell_s), (0.0, None));
        assert_eq!(plan.rig.protocol, Some(Protocol::Alternating));
        assert_eq!(plan.map.as_deref(), Some("m.toml"));
        assert_eq!((plan.series[0].load_n(&plan.rig), plan.series[0].file_names().len()), (None, 2));
        let both = text.replace("files=", "file=\"c.csv\"\nfiles=");
        assert!(RunPlan::parse(&both, "run.toml").unwrap_err().problem().contains("either file or files"));
    }

    #[test]
    fn errors_locate_invalid_values() {
        for (from, to, expected) in [
            ("rate_hz=200.0", "rate_hz=nan", "run.toml:3:16: rig.sample_rate_hz = NaN: not above 0"),
            ("on_s=0.5", "on_s=-1.0", "rig.on_s = -1: not above 0"),
            ("deg=63.89", "deg=0.0", "rig.wrap_angle_deg = 0: outside 1 to 720"),
            (
                "load_mass_g=251.2",
                "load_mass_g=-2.0",
                "run.toml:12:13: series[0].load_mass_g = -2: not a mass",
            ),
            ("\"silicone\"", "\"abs\"", "series[0].pins = []: abs needs"),
            ("pins=[]", "pins=[99]", "series[0].pins = [99]: a groove is outside 1..15"),
            ("pins=[]", "pins=[5, 5]", "series[0].pins = [5, 5]: a groove is listed twice"),
            ("load_mass_g=251.2", "load_mass_g=1e9", "series[0].load_mass_g = 1000000000: above 100000 N"),
            ("speed_pct=47", "speed_pct=1e9", "series[0].speed_pct = 1000000000: outside"),
        ] {
            let text = format!("{RIG}{SERIES}").replacen(from, to, 1);
            let error = RunPlan::parse(&text, "run.toml").unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert!(RunPlan::parse(RIG, "run.toml").is_err());
        // A load in newtons would be left out.
        let other = format!("{RIG}{SERIES}load_N=9.8\n");
        let error = RunPlan::parse(&other, "run.toml").unwrap_err().to_string();
        assert!(error.contains("unknown field `load_N`"), "{error}");
    }
}
