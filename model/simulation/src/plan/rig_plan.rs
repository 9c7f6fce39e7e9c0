//! The plan of a synthetic rig: its fields and their defaults.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_friction::{LayoutLaw, published};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::columns::ColumnsPlan;
use super::noise::NoisePlan;
use super::raw::RawPlan;
use crate::disturbance::Disturbance;

/// Order and settings of the series of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// Ascending loads, speed proportional to load, one dwell, many repetitions.
    #[default]
    Paper,
    /// Ascending and descending loads; random speeds, dwells and order of layouts.
    Randomised,
}

/// Effect of the vocabulary with its constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EffectPlan {
    /// Id of the effect.
    pub id: String,
    /// Constants, in the order of the formula.
    #[serde(default)]
    pub values: Vec<f64>,
    /// Form: 0 is that of `model/doc/effect-catalogue.md`, which the calibrator fits; others are
    /// equally plausible.
    #[serde(default)]
    pub form: u8,
}

/// Constants of the paper's model on a rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RigConstants {
    /// Friction coefficient on the pins.
    pub mu_p: f64,
    /// Friction coefficient on the silicone.
    pub mu_s: f64,
    /// Factors on the half load of the layout law, one per layout; missing ones are 1.
    pub half_load_factor: Vec<f64>,
    /// Steepness of the switch, one per layout; missing ones are [`LayoutLaw::STEEPNESS`].
    pub steepness: Vec<f64>,
}

impl RigConstants {
    /// Returns the steepness of the switch of layout number `layout`.
    pub fn steepness_of(&self, layout: usize) -> f64 {
        self.steepness.get(layout).copied().unwrap_or(LayoutLaw::STEEPNESS)
    }
}

impl Default for RigConstants {
    fn default() -> Self {
        Self {
            mu_p: published::MU_PINS,
            mu_s: published::MU_SILICONE,
            half_load_factor: Vec::new(),
            steepness: Vec::new(),
        }
    }
}

/// Synthetic rig with its session.
///
/// ```
/// use pinswitch_simulation::Plan;
///
/// let text = "weights_g = [251.2, 2005.0, 5002.5]\nlayouts = [[5, 8, 11]]";
/// let plan = Plan::parse(text, "plan.toml")?;
/// assert_eq!(plan.repetitions, Plan::default().repetitions);
/// let error = Plan::parse("weights_g = [-1.0]", "plan.toml").unwrap_err();
/// assert_eq!(error.location().and_then(|at| at.line), Some(1));
/// assert!(error.to_string().starts_with("plan.toml:1:13: weights_g = [-1.0]: must be 1 to 1000"));
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Order and settings of the series.
    pub protocol: Protocol,
    /// Whether all series of the randomised protocol are in random order, instead of sweep by
    /// sweep.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub shuffled: bool,
    /// Wrap angle of the tendon in degrees.
    #[serde(skip_serializing_if = "is_published_wrap")]
    pub wrap_angle_deg: f64,
    /// Layouts, as lists of occupied grooves.
    pub layouts: Vec<Vec<usize>>,
    /// Whether the session includes silicone without pins.
    pub silicone: bool,
    /// Whether the session includes the layouts on the rigid proxy.
    pub proxy: bool,
    /// Weights in grams, ascending.
    pub weights_g: Vec<f64>,
    /// Speeds in percent; the paper's protocol has one of them for each weight.
    pub speeds_pct: Vec<f64>,
    /// Dwells in seconds; the paper's protocol uses the first.
    pub dwells_s: Vec<f64>,
    /// Repetitions per series, eccentric and concentric.
    pub repetitions: [u32; 2],
    /// Range of the number of repetitions between series.
    pub repetitions_spread: u32,
    /// Constants of the paper's model.
    pub constants: RigConstants,
    /// Effects in addition to the paper's model.
    pub effects: Vec<EffectPlan>,
    /// Disturbances outside the vocabulary of effects.
    pub disturbances: Vec<Disturbance>,
    /// Noise.
    pub noise: NoisePlan,
    /// Sampling and faults of raw logs.
    pub raw: RawPlan,
    /// Optional columns of the table.
    #[serde(skip_serializing_if = "ColumnsPlan::is_empty")]
    pub columns: ColumnsPlan,
    /// Vocabulary of the effects; not a part of the file.
    #[serde(skip)]
    pub vocabulary: Vocabulary,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_published_wrap(degrees: &f64) -> bool {
    *degrees == published::WRAP_ANGLE_DEG
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            seed: 1,
            protocol: Protocol::Paper,
            shuffled: false,
            wrap_angle_deg: published::WRAP_ANGLE_DEG,
            layouts: published::LAYOUTS.iter().map(|l| l.grooves.to_vec()).collect(),
            silicone: true,
            proxy: true,
            weights_g: published::WEIGHTS_G.to_vec(),
            speeds_pct: (47..=57).map(f64::from).collect(),
            dwells_s: vec![published::DWELL_S],
            repetitions: [12, 29],
            repetitions_spread: 3,
            constants: RigConstants::default(),
            effects: Vec::new(),
            disturbances: Vec::new(),
            noise: NoisePlan::default(),
            raw: RawPlan::default(),
            columns: ColumnsPlan::default(),
            vocabulary: Vocabulary::built_in(),
        }
    }
}

impl Plan {
    /// Returns a plan with the randomised protocol: ascending and descending loads, four speeds,
    /// three dwells, and fewer repetitions than the paper.
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

    /// Adds an effect. Missing constants of a user-defined effect have their start values.
    pub fn add_effect(&mut self, id: &str, mut values: Vec<f64>) {
        let own = self.vocabulary.own().find(|own| own.definition().id == id);
        let starts = own.map_or(&[][..], |own| &own.definition().parameters);
        values.extend(starts.iter().skip(values.len()).map(|p| p.start));
        self.effects.push(EffectPlan { id: id.to_owned(), values, form: 0 });
    }
}
