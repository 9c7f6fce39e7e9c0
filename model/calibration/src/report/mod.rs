//! `report.json`: what a calibration says, field by field (`model/doc/file-formats.md`).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::aliasing::Aliasing;
use crate::forms::FormReport;
use crate::inference::Noise;
use crate::trial::TrialReport;

mod sessions;
mod verdict;

pub use sessions::{ChangeReport, SessionReport, SizeInSession, UnequalReport};
pub use verdict::Verdict;

/// A constant with its interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Its value.
    pub value: f64,
    /// 95 % confidence interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// Counts of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DataSummary {
    /// Rows.
    pub rows: usize,
    /// Series.
    pub series: usize,
    /// Conditions.
    pub conditions: usize,
    /// Rows weighed down as outliers.
    pub outliers: usize,
}

/// One fitted model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelReport {
    /// Root mean square residual on the rows fitted, in newtons, outliers left out.
    #[serde(rename = "rmse_N")]
    pub rmse_n: f64,
    /// The same on whole series and whole loads held out.
    #[serde(rename = "heldout_rmse_N")]
    pub heldout_rmse_n: f64,
    /// On whole series held out.
    #[serde(rename = "heldout_series_rmse_N")]
    pub heldout_series_rmse_n: f64,
    /// On whole loads held out.
    #[serde(rename = "heldout_loads_rmse_N")]
    pub heldout_loads_rmse_n: f64,
    /// On whole layouts held out, with friction and effects from the others; absent with fewer than two layouts.
    #[serde(rename = "heldout_layouts_rmse_N", default, skip_serializing_if = "Option::is_none")]
    pub heldout_layouts_rmse_n: Option<f64>,
    /// Constants by name.
    pub parameters: BTreeMap<String, Estimate>,
}

/// An effect that explains the data as well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RivalReport {
    /// Its id.
    pub id: String,
    /// Why the data cannot tell.
    pub why: String,
    /// The experiment that would.
    pub experiment: String,
}

/// One effect found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectReport {
    /// Its id, or `unattributed`.
    pub id: String,
    /// Where it lies.
    pub covariate: String,
    /// `switch` or `rig`; absent for what has no name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<String>,
    /// Formula with source, or the shape of a structure in words.
    pub formula: String,
    /// Probability of such a gain by chance, over all that was tried: Student's t with the number of series,
    /// Sidak's correction. Held against simulated rigs without effect in `model/doc/calibration.md`.
    pub p_value: f64,
    /// Its constants.
    pub parameters: BTreeMap<String, Estimate>,
    /// Held-out error of the same model without it, in newtons.
    #[serde(rename = "error_before_N")]
    pub error_before_n: f64,
    /// Held-out error of the model with it, in newtons.
    #[serde(rename = "error_after_N")]
    pub error_after_n: f64,
    /// What else it could be.
    pub rivals: Vec<RivalReport>,
    /// Of what has no name: what it looks like.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<FormReport>,
}

/// What became of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It is in the model.
    Kept,
    /// It explains the data as well as one that was kept.
    Rival,
    /// This data could not show it.
    Invisible,
    /// Its gain may be chance.
    Chance,
    /// What it would explain is explained by what was kept.
    Superfluous,
    /// Its gain is no chance, and nothing was kept: scatter explains the table as well, or it did not help on data held out.
    Unsettled,
}

/// One effect of the vocabulary before the decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateReport {
    /// Its id.
    pub id: String,
    /// What it alone would gain over the baseline to first order, in squares of the noise.
    pub gain: f64,
    /// Probability of such a gain by chance over the vocabulary.
    pub p_value: f64,
    /// What it would still gain on top of the model found; absent for what is in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_left: Option<f64>,
    /// What became of it.
    pub fate: Fate,
}

/// An effect that this data cannot show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Invisible {
    /// Its id.
    pub id: String,
    /// Why.
    pub why: String,
    /// The experiment that would show it.
    pub experiment: String,
    /// Sizes that the data do not exclude, where they tell any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub possible: Option<[f64; 2]>,
}

/// A series that stands out from the model by more than its noise allows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BadSeries {
    /// Its name in the table.
    pub series: String,
    /// `eccentric` or `concentric`.
    pub direction: String,
    /// Mean residual in newtons, or the worst reading's where single readings are wrong and the others are not.
    #[serde(rename = "offset_N")]
    pub offset_n: f64,
    /// In standard deviations.
    pub standard_deviations: f64,
    /// The repetition of the worst reading; absent where the series is off as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repetition: Option<u32>,
    /// How many readings are off in that way; absent where the series is off as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub readings: Option<usize>,
}

impl BadSeries {
    /// Where to look, in words: the series and direction, or the reading in it.
    pub fn place(&self) -> String {
        let series = format!("series {} {}", self.series, self.direction);
        match (self.repetition, self.readings.unwrap_or(1)) {
            (Some(repetition), 1) => format!("repetition {repetition} of {series}"),
            (Some(repetition), n) => {
                format!("{n} readings of {series}, the worst at repetition {repetition}")
            }
            (None, _) => series,
        }
    }
}

/// One part of the noise with its size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoisePart {
    /// `repetition`, `series_and_direction`, `series`, `series_scale`, `mount`, `walk`, `group` or `specimen`.
    pub part: String,
    /// What it does to a reading, in words.
    pub what: String,
    /// Standard deviation at a load of 20 N, or relative.
    pub size: f64,
    /// 95 % interval of the size; absent for what is set and not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ci95: Option<[f64; 2]>,
    /// `N`, or `1` for a share of the friction.
    pub unit: String,
}

/// Sizes of an effect that the data do not exclude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitReport {
    /// Its id.
    pub id: String,
    /// Its size constant; `present` for an effect without one, of which 1 is the whole.
    pub parameter: String,
    /// Lower end of what 95 % do not exclude.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Size that changes friction, or the reading, by 5 % somewhere in the table.
    pub typical: f64,
    /// Constants of its shape at which these sizes are told, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub shape: BTreeMap<String, f64>,
    /// Unit of the size.
    #[serde(default)]
    pub unit: String,
    /// Whether the size cannot be negative.
    #[serde(default)]
    pub one_sided: bool,
    /// The experiment that would settle it.
    #[serde(default)]
    pub experiment: String,
    /// Whether every size left is smaller than the typical one.
    pub excluded: bool,
}

/// `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Name and version of the format.
    pub schema: String,
    /// Counts.
    pub data: DataSummary,
    /// The verdict.
    pub verdict: Verdict,
    /// Whether the error on held-out series reaches the noise within its scatter: if not, something is left.
    pub adequate: bool,
    /// Error to expect on a new session of the same rig, in newtons: the whole procedure repeated without each fourth of
    /// the series and judged on it. Absent if too few series are left to do so.
    #[serde(rename = "promise_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_n: Option<f64>,
    /// The same of the paper's model refitted.
    #[serde(rename = "promise_baseline_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_baseline_n: Option<f64>,
    /// Standard deviation of a reading about the best model, in newtons.
    #[serde(rename = "noise_floor_N")]
    pub noise_floor_n: f64,
    /// The noise as the model file holds it.
    pub noise: Noise,
    /// The noise by its parts, with intervals.
    pub noise_parts: Vec<NoisePart>,
    /// Constants of the switch that differ between sessions or specimens; empty where all share them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<ChangeReport>,
    /// Named effects whose sizes differ between sessions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unequal: Vec<UnequalReport>,
    /// The paper's model, refitted.
    pub baseline: ModelReport,
    /// With what was found.
    pub augmented: ModelReport,
    /// What was found.
    pub effects: Vec<EffectReport>,
    /// Every effect of the vocabulary as a candidate, the strongest first.
    pub candidates: Vec<CandidateReport>,
    /// Probability of the largest candidate without any effect, by flipped signs of whole series.
    pub family_probability: f64,
    /// Sizes that the data do not exclude, of visible effects that were not found.
    pub limits: Vec<LimitReport>,
    /// Effects whose traces this design cannot tell apart.
    pub classes: Vec<Vec<String>>,
    /// Covariates that move together.
    pub aliasing: Vec<Aliasing>,
    /// Columns of the table that no calibration reads.
    pub ignored_columns: Vec<String>,
    /// What this data cannot see.
    pub invisible: Vec<Invisible>,
    /// What no data of such a rig can see after the refit.
    pub never_visible: Vec<String>,
    /// Series to look at: a mislabelled weight, a bad run.
    pub bad_series: Vec<BadSeries>,
    /// What the table says of each effect of one's own; empty without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<TrialReport>,
    /// What was known after each of several tables, in their order; empty if there was one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<SessionReport>,
    /// Errors on loads above those fitted, if some were kept back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolation: Option<Extrapolation>,
}

impl Report {
    /// Why nothing is excluded although every limit is below what is of consequence.
    pub fn reservations(&self) -> Vec<String> {
        let unsettled = self.candidates.iter().filter(|c| c.fate == Fate::Unsettled).take(3);
        let ids: Vec<&str> = unsettled.map(|c| c.id.as_str()).collect();
        let mut told = Vec::new();
        if !ids.is_empty() {
            told.push(format!(
                "{} would gain more than chance makes, and change nothing by 5 %",
                ids.join(" or ")
            ));
        }
        if self.noise.mounts_hide() {
            let percent = 100.0 * self.noise.mount_scale;
            told.push(format!(
                "mounts scatter by {percent:.1} %, in which a step of friction between two of them, or what a layout has of its own, could hide"
            ));
        }
        if !self.adequate {
            told.push("the error on data held out stays above the noise".to_owned());
        }
        told
    }
}

/// Errors on the rows with higher loads than those fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extrapolation {
    /// Highest load fitted, in newtons.
    #[serde(rename = "fitted_below_N")]
    pub fitted_below_n: f64,
    /// Rows judged.
    pub rows: usize,
    /// Root mean square error of the refitted baseline, in newtons.
    #[serde(rename = "rmse_before_N")]
    pub rmse_before_n: f64,
    /// Of the augmented model.
    #[serde(rename = "rmse_after_N")]
    pub rmse_after_n: f64,
    /// The same without readings beyond twenty standard deviations of noise: a bad run decides nothing.
    #[serde(rename = "rmse_after_without_bad_N")]
    pub rmse_after_without_bad_n: f64,
    /// Readings left out of that.
    pub bad_rows: usize,
    /// Median absolute error of the refitted baseline, in newtons.
    #[serde(rename = "median_before_N")]
    pub median_before_n: f64,
    /// Of the augmented model.
    #[serde(rename = "median_after_N")]
    pub median_after_n: f64,
}
