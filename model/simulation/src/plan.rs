//! `PLAN.toml`: what a synthetic rig does and what is wrong with it.

use serde::{Deserialize, Serialize};

use super::disturbance::Disturbance;
use super::raw::RawPlan;
use super::twin::forms::forms_of;
use pinswitch_calibration::effects::{acting_order, effect_named};
use pinswitch_friction::published;

/// Why a plan cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The text is no plan.
    #[error("{file}: {problem}")]
    Malformed {
        /// File name as given.
        file: String,
        /// What is wrong, with the line.
        problem: String,
    },
    /// A value is out of bounds.
    #[error("{file}: {field} = {value} is outside {bound}; {remedy}")]
    Bound {
        /// File name as given.
        file: String,
        /// Field of the plan.
        field: &'static str,
        /// Value found.
        value: String,
        /// What is allowed.
        bound: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// An effect the library does not have, or with the wrong number of constants.
    #[error("{file}: effects: '{id}' with {found} value(s); {remedy}")]
    Effect {
        /// File name as given.
        file: String,
        /// The id found.
        id: String,
        /// How many values came with it.
        found: usize,
        /// What is right.
        remedy: String,
    },
}

/// Order and settings of the series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// Loads ascending once, speed follows load, one dwell, many repetitions.
    #[default]
    Paper,
    /// Loads up and down, several speeds and dwells in random order, layouts in random order.
    Randomised,
}

/// Noise of the synthetic rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoisePlan {
    /// Of one repetition at zero load, in newtons.
    #[serde(rename = "repetition_N")]
    pub repetition_n: f64,
    /// Its growth with load, dimensionless.
    pub repetition_per_load: f64,
    /// Of a series and direction at zero load, in newtons.
    #[serde(rename = "series_N")]
    pub series_n: f64,
    /// Its growth with load, dimensionless.
    pub series_per_load: f64,
    /// Share of rows with a gross error.
    pub outlier_share: f64,
    /// Size of gross errors in newtons.
    #[serde(rename = "outlier_N")]
    pub outlier_n: f64,
    /// Share of rows that are lost.
    pub lost_share: f64,
    /// Correlation of neighbouring repetitions, 0..1.
    pub autocorrelation: f64,
    /// Logarithmic standard deviation of the repetition noise from series to series.
    pub uneven: f64,
    /// Series whose weight is written down as that of a neighbour.
    pub mislabelled_series: u32,
    /// Heavy tails: Student's t with three degrees of freedom instead of a normal law, of the same quartiles.
    pub heavy_tails: bool,
}

impl Default for NoisePlan {
    fn default() -> Self {
        Self {
            repetition_n: 0.07,
            repetition_per_load: 0.002,
            series_n: 0.025,
            series_per_load: 0.004,
            outlier_share: 0.002,
            outlier_n: 1.0,
            lost_share: 0.0,
            autocorrelation: 0.0,
            uneven: 0.0,
            mislabelled_series: 0,
            heavy_tails: false,
        }
    }
}

/// One effect of the vocabulary with its constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectPlan {
    /// Its id.
    pub id: String,
    /// Its constants, in the order of its formula.
    #[serde(default)]
    pub values: Vec<f64>,
    /// In which of its forms: 0 is that of effects.md, others bend otherwise than the model that is fitted.
    #[serde(default)]
    pub form: u8,
}

/// Constants of the paper's model on this rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Constants {
    /// Friction coefficient on the pins.
    pub mu_p: f64,
    /// Friction coefficient on the silicone.
    pub mu_s: f64,
    /// Factors on the layout law's half load, one per layout; missing ones are 1.
    pub half_load_factor: Vec<f64>,
    /// Steepness of the switch, one per layout; missing ones are [`LayoutLaw::STEEPNESS`](pinswitch_friction::LayoutLaw::STEEPNESS).
    pub steepness: Vec<f64>,
}

impl Default for Constants {
    fn default() -> Self {
        Self {
            mu_p: published::MU_PINS,
            mu_s: published::MU_SILICONE,
            half_load_factor: Vec::new(),
            steepness: Vec::new(),
        }
    }
}

/// A synthetic rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    /// Seed of everything random.
    pub seed: u64,
    /// Order and settings of the series.
    pub protocol: Protocol,
    /// Wrap angle of the tendon in degrees; the paper's is not written.
    #[serde(skip_serializing_if = "is_published_wrap")]
    pub wrap_angle_deg: f64,
    /// Layouts as lists of occupied grooves.
    pub layouts: Vec<Vec<usize>>,
    /// Whether silicone without pins is measured.
    pub silicone: bool,
    /// Whether the layouts are measured on the rigid proxy.
    pub proxy: bool,
    /// Weights in grams, ascending.
    pub weights_g: Vec<f64>,
    /// Speeds in percent; the paper's protocol gives one to each weight.
    pub speeds_pct: Vec<f64>,
    /// Dwells in seconds; the paper's protocol uses the first.
    pub dwells_s: Vec<f64>,
    /// Repetitions per series, eccentric and concentric.
    pub repetitions: [u32; 2],
    /// How far the repetitions of the paper's protocol vary from series to series.
    pub repetitions_spread: u32,
    /// The paper's model on this rig.
    pub constants: Constants,
    /// What the paper's model lacks on it.
    pub effects: Vec<EffectPlan>,
    /// What nobody has named.
    pub disturbances: Vec<Disturbance>,
    /// Noise.
    pub noise: NoisePlan,
    /// Sampling and faults of raw logs.
    pub raw: RawPlan,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks for it")]
fn is_published_wrap(degrees: &f64) -> bool {
    *degrees == published::WRAP_ANGLE_DEG
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            seed: 1,
            protocol: Protocol::Paper,
            wrap_angle_deg: published::WRAP_ANGLE_DEG,
            layouts: published::LAYOUTS.iter().map(|l| l.grooves.to_vec()).collect(),
            silicone: true,
            proxy: true,
            weights_g: published::WEIGHTS_G.to_vec(),
            speeds_pct: (47..=57).map(f64::from).collect(),
            dwells_s: vec![published::DWELL_S],
            repetitions: [12, 29],
            repetitions_spread: 3,
            constants: Constants::default(),
            effects: Vec::new(),
            disturbances: Vec::new(),
            noise: NoisePlan::default(),
            raw: RawPlan::default(),
        }
    }
}

impl Plan {
    /// The randomised protocol: loads up and down, four speeds, three dwells, fewer repetitions.
    pub fn randomised() -> Self {
        Self {
            protocol: Protocol::Randomised,
            speeds_pct: vec![40.0, 50.0, 60.0, 70.0],
            dwells_s: vec![1.0, 3.0, 10.0],
            repetitions: [8, 10],
            repetitions_spread: 0,
            ..Self::default()
        }
    }

    /// Reads a plan. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, PlanError> {
        let plan: Self = toml::from_str(text).map_err(|e| PlanError::Malformed {
            file: file.to_owned(),
            problem: e.to_string().trim_end().to_owned(),
        })?;
        plan.check(file)?;
        Ok(plan)
    }

    /// The plan's text.
    ///
    /// # Errors
    /// [`PlanError::Malformed`] if a value cannot be written as TOML.
    pub fn to_text(&self) -> Result<String, PlanError> {
        toml::to_string(self)
            .map_err(|e| PlanError::Malformed { file: "plan.toml".to_owned(), problem: e.to_string() })
    }

    /// Checks every field. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`PlanError`] at the first field that cannot be used.
    pub fn check(&self, file: &str) -> Result<(), PlanError> {
        let bound = |field, value: String, bound, remedy| {
            Err(PlanError::Bound { file: file.to_owned(), field, value, bound, remedy })
        };
        let positive =
            |values: &[f64]| !values.is_empty() && values.iter().all(|v| *v > 0.0 && v.is_finite());
        for (field, values) in
            [("weights_g", &self.weights_g), ("speeds_pct", &self.speeds_pct), ("dwells_s", &self.dwells_s)]
        {
            if !positive(values) || values.len() > 1000 {
                return bound(
                    field,
                    format!("{values:?}"),
                    "1 to 1000 positive numbers",
                    "list the values to run",
                );
            }
        }
        if self.repetitions.iter().any(|r| !(1..=1000).contains(r)) {
            return bound("repetitions", format!("{:?}", self.repetitions), "1..1000", "give two counts");
        }
        let grooves = 1..=published::GROOVES;
        if self.layouts.iter().any(|l| l.is_empty() || l.iter().any(|g| !grooves.contains(g))) {
            return bound(
                "layouts",
                format!("{:?}", self.layouts),
                "lists of grooves 1..15",
                "name occupied grooves",
            );
        }
        if !self.silicone && self.layouts.is_empty() {
            return bound("layouts", "[]".to_owned(), "at least one", "measure silicone or a layout");
        }
        let n = &self.noise;
        let sizes = [n.repetition_n, n.repetition_per_load, n.series_n, n.series_per_load, n.outlier_n];
        if sizes.iter().any(|v| !v.is_finite() || *v < 0.0) {
            return bound("noise", format!("{sizes:?}"), ">= 0", "give standard deviations");
        }
        if !(0.0..=0.99).contains(&n.autocorrelation) || !(0.0..=2.0).contains(&n.uneven) {
            return bound(
                "noise",
                format!("autocorrelation {}, uneven {}", n.autocorrelation, n.uneven),
                "0..0.99 and 0..2",
                "0 is neither",
            );
        }
        if [n.outlier_share, n.lost_share].iter().any(|v| !(0.0..=0.9).contains(v)) {
            return bound(
                "noise shares",
                format!("{} and {}", n.outlier_share, n.lost_share),
                "0..0.9",
                "give shares of the rows",
            );
        }
        let r = &self.raw;
        if !(20.0..=10_000.0).contains(&r.sample_rate_hz) {
            return bound("raw.sample_rate_hz", r.sample_rate_hz.to_string(), "20..10000", "the rig has 200");
        }
        let shares = [r.spike_share, r.lost_share, r.odd_speed_share, r.missing_share];
        if shares.iter().any(|v| !(0.0..=0.9).contains(v)) {
            return bound("raw shares", format!("{shares:?}"), "0..0.9", "give shares of samples and logs");
        }
        if [r.sample_n, r.jitter_s].iter().any(|v| !(v.is_finite() && *v >= 0.0)) {
            return bound(
                "raw",
                format!("sample_N {}, jitter_s {}", r.sample_n, r.jitter_s),
                ">= 0",
                "give standard deviations",
            );
        }
        for e in &self.effects {
            let remedy = match effect_named(&e.id) {
                Some(effect) if effect.parameters().len() == e.values.len() => {
                    let forms = forms_of(&e.id);
                    if usize::from(e.form) < forms.len() {
                        continue;
                    }
                    format!(
                        "form {} is unknown, it has 0 to {}: {}",
                        e.form,
                        forms.len() - 1,
                        forms.join("; ")
                    )
                }
                Some(effect) => {
                    let names: Vec<&str> = effect.parameters().iter().map(|p| p.name).collect();
                    format!("it needs {} value(s): {}", names.len(), names.join(", "))
                }
                None => {
                    format!(
                        "known are {}",
                        acting_order().iter().map(|e| e.id()).collect::<Vec<_>>().join(", ")
                    )
                }
            };
            return Err(PlanError::Effect {
                file: file.to_owned(),
                id: e.id.clone(),
                found: e.values.len(),
                remedy,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_names_what_it_cannot_use() {
        let cases = [
            ("weights_g = []", "weights_g"),
            ("layouts = [[16]]", "layouts"),
            ("[noise]\noutlier_share = 2", "noise shares"),
            ("[[effects]]\nid = \"gravity\"", "known are"),
            ("[[effects]]\nid = \"run_in\"\nvalues = [1]", "3 value(s): k, r0, c"),
            ("colour = 1", "unknown field"),
        ];
        for (text, expected) in cases {
            let error = Plan::parse(text, "plan.toml").unwrap_err().to_string();
            assert!(error.contains(expected) && error.starts_with("plan.toml"), "{error}");
        }
        assert_eq!(Plan::parse("", "plan.toml").unwrap(), Plan::default());
    }
}
