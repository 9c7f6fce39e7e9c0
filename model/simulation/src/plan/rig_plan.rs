//! The plan of a synthetic rig: its fields and their defaults.

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_friction::{LayoutLaw, published};
use serde::{Deserialize, Serialize};

use super::columns::ColumnsPlan;
use super::noise::NoisePlan;
use super::raw::RawPlan;
use crate::disturbance::Disturbance;

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

/// One effect of the vocabulary with its constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectPlan {
    /// Its id.
    pub id: String,
    /// Its constants, in the order of its formula.
    #[serde(default)]
    pub values: Vec<f64>,
    /// In which of its forms: 0 is that of `model/doc/effect-catalogue.md`, others bend otherwise than the model that
    /// is fitted.
    #[serde(default)]
    pub form: u8,
}

/// RigConstants of the paper's model on this rig.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RigConstants {
    /// Friction coefficient on the pins.
    pub mu_p: f64,
    /// Friction coefficient on the silicone.
    pub mu_s: f64,
    /// Factors on the layout law's half load, one per layout; missing ones are 1.
    pub half_load_factor: Vec<f64>,
    /// Steepness of the switch, one per layout; missing ones are [`LayoutLaw::STEEPNESS`].
    pub steepness: Vec<f64>,
}

impl RigConstants {
    /// Steepness of the switch of a layout, by its place among the layouts.
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

/// A synthetic rig.
///
/// ```
/// use pinswitch_simulation::Plan;
///
/// let plan = Plan::parse("weights_g = [251.2, 2005.0, 5002.5]\nlayouts = [[5, 8, 11]]", "plan.toml")?;
/// assert_eq!(plan.repetitions, Plan::default().repetitions);
/// let error = Plan::parse("weights_g = [-1.0]", "plan.toml").unwrap_err();
/// assert_eq!(error.location().and_then(|at| at.line), Some(1));
/// assert!(error.to_string().starts_with("plan.toml:1:13: weights_g = [-1.0]: must be 1 to 1000 numbers"));
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    /// Seed of everything random.
    pub seed: u64,
    /// Order and settings of the series.
    pub protocol: Protocol,
    /// All series of the randomised protocol in one random order, instead of sweep by sweep.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub shuffled: bool,
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
    /// Speeds in percent; the paper's protocol runs each weight at one of them.
    pub speeds_pct: Vec<f64>,
    /// Dwells in seconds; the paper's protocol uses the first.
    pub dwells_s: Vec<f64>,
    /// Repetitions per series, eccentric and concentric.
    pub repetitions: [u32; 2],
    /// How far the repetitions of the paper's protocol vary from series to series.
    pub repetitions_spread: u32,
    /// The paper's model on this rig.
    pub constants: RigConstants,
    /// What the paper's model lacks on it.
    pub effects: Vec<EffectPlan>,
    /// What nobody has named.
    pub disturbances: Vec<Disturbance>,
    /// Noise.
    pub noise: NoisePlan,
    /// Sampling and faults of raw logs.
    pub raw: RawPlan,
    /// Optional columns of the table.
    #[serde(skip_serializing_if = "ColumnsPlan::is_empty")]
    pub columns: ColumnsPlan,
    /// The effects that may be among those of the plan; a file of a plan does not hold it.
    #[serde(skip)]
    pub vocabulary: Vocabulary,
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

    /// Puts an effect into the rig. Of one of one's own, constants that are left out are at their start values.
    pub fn add_effect(&mut self, id: &str, mut values: Vec<f64>) {
        let own = self.vocabulary.own().find(|own| own.definition().id == id);
        let starts = own.map_or(&[][..], |own| &own.definition().parameters);
        values.extend(starts.iter().skip(values.len()).map(|p| p.start));
        self.effects.push(EffectPlan { id: id.to_owned(), values, form: 0 });
    }
}
