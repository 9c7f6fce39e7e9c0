//! Content of `report.json` (`model/doc/file-formats.md`).

use std::collections::BTreeMap;

use pinswitch_inference::REPORTED_PROBABILITY;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::aliasing::Aliasing;
use crate::model::Noise;

mod forms;
mod sessions;
mod trials;
mod verdict;

pub use forms::{FormReport, FormRival};
pub use sessions::{ChangeReport, SessionReport};
pub use trials::{TrialOutcome, TrialReport};
pub use verdict::Verdict;

/// A constant with its confidence interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// 95 % confidence interval.
    pub ci95: [f64; 2],
    /// Unit.
    pub unit: String,
}

/// Counts of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DataSummary {
    /// Number of rows.
    pub rows: usize,
    /// Number of series.
    pub series: usize,
    /// Number of conditions.
    pub conditions: usize,
    /// Number of rows with a gross error, or in a series that has one.
    pub outliers: usize,
}

/// A fitted model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelReport {
    /// In-sample RMSE in newtons, without gross errors; predictions contain the effects of their mounts.
    #[serde(rename = "rmse_N")]
    pub rmse_n: f64,
    /// Held-out RMSE in newtons, over series and loads.
    #[serde(rename = "heldout_rmse_N")]
    pub heldout_rmse_n: f64,
    /// Leave-series-out RMSE in newtons.
    #[serde(rename = "heldout_series_rmse_N")]
    pub heldout_series_rmse_n: f64,
    /// Leave-load-out RMSE in newtons.
    #[serde(rename = "heldout_loads_rmse_N")]
    pub heldout_loads_rmse_n: f64,
    /// Leave-one-layout-out RMSE in newtons, with friction and effects from the other layouts;
    /// absent with fewer than two layouts.
    #[serde(rename = "heldout_layouts_rmse_N", default, skip_serializing_if = "Option::is_none")]
    pub heldout_layouts_rmse_n: Option<f64>,
    /// Constants by name.
    pub parameters: BTreeMap<String, Estimate>,
}

/// An effect that explains the data equally well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RivalReport {
    /// Id; the name of the structure, if it is not an effect.
    pub id: String,
    /// Posterior probability.
    pub probability: f64,
    /// Why the data cannot separate the two.
    pub why: String,
    /// Experiment that separates them.
    pub experiment: String,
}

/// An effect of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectReport {
    /// Id, or `unattributed`.
    pub id: String,
    /// Covariate along which it shows.
    pub covariate: String,
    /// `switch` or `rig`; absent for unattributed structure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<String>,
    /// Formula with its source, or the shape of a structure in words.
    pub formula: String,
    /// Posterior probability that it acts.
    pub probability: f64,
    /// Posterior odds of the best hypothesis against the same without it; at most 1e12.
    pub odds: f64,
    /// Constants.
    pub parameters: BTreeMap<String, Estimate>,
    /// Held-out error of the model without it, in newtons; absent if that model is not finite.
    #[serde(rename = "error_before_N", default, skip_serializing_if = "Option::is_none")]
    pub error_before_n: Option<f64>,
    /// Held-out error of the model with it, in newtons.
    #[serde(rename = "error_after_N")]
    pub error_after_n: f64,
    /// Other effects that explain the data equally well.
    pub rivals: Vec<RivalReport>,
    /// Effects that are the same on every run of a rig of `plain` contacts, and are part of the size.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub includes: Vec<String>,
    /// Formula derived from unattributed structure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<FormReport>,
}

/// Outcome for a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// In the model.
    Kept,
    /// May take the place of an effect of the model.
    Rival,
    /// Its limits exclude every relevant size.
    Excluded,
    /// Neither reported nor excluded.
    Open,
    /// Not identifiable with this table.
    Invisible,
}

/// An effect of the vocabulary as a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CandidateReport {
    /// Id.
    pub id: String,
    /// Posterior probability that it acts.
    pub probability: f64,
    /// Outcome.
    pub fate: Fate,
}

/// Structure without a name that may act.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StructureReport {
    /// Quantity and covariate, such as `friction over position`.
    pub name: String,
    /// Covariate.
    pub covariate: String,
    /// Posterior probability that it acts.
    pub probability: f64,
}

/// An expected error with its interval, in newtons.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedErrorReport {
    /// Expected root mean square error.
    pub value: f64,
    /// 90 % interval of the error of one new session.
    pub ci90: [f64; 2],
}

/// An effect that is not identifiable with this table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Invisible {
    /// Id.
    pub id: String,
    /// Why.
    pub why: String,
    /// Experiment that identifies it.
    pub experiment: String,
    /// Sizes that the data do not exclude, if they are limited at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub possible: Option<[f64; 2]>,
}

/// A series that departs from the model by more than its noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BadSeries {
    /// Session, if the table names it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub session: String,
    /// Name in the table.
    pub series: String,
    /// `eccentric` or `concentric`.
    pub direction: String,
    /// Mean residual in newtons, or the largest residual if only single readings are wrong.
    #[serde(rename = "offset_N")]
    pub offset_n: f64,
    /// Residual in standard deviations.
    pub standard_deviations: f64,
    /// Probability of a gross error of the whole series; absent if single readings are wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Repetition of the worst reading; absent if the whole series is wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repetition: Option<u32>,
    /// Number of wrong readings; absent if the whole series is wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub readings: Option<usize>,
}

impl BadSeries {
    /// Describes the location: the series and direction, or the reading in it.
    pub fn place(&self) -> String {
        let session = if self.session.is_empty() { String::new() } else { format!(" of {}", self.session) };
        let series = format!("series {}{session} {}", self.series, self.direction);
        match (self.repetition, self.readings.unwrap_or(1)) {
            (Some(repetition), 1) => format!("repetition {repetition} of {series}"),
            (Some(repetition), n) => {
                format!("{n} readings of {series}, the worst at repetition {repetition}")
            }
            (None, _) => series,
        }
    }
}

/// A mount whose friction differs from that of the others by a size of consequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MountReport {
    /// Session and name in the table. Without a column `mount`: condition, session and specimen.
    pub mount: String,
    /// Difference of friction, as a share of it.
    pub friction: f64,
    /// 95 % interval of the difference.
    pub ci95: [f64; 2],
}

/// A component of the noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NoisePart {
    /// `repetition`, `series_and_direction`, `series`, `series_scale`, `mount`, `specimen`, `wandering_reading`, `wandering_drag` or
    /// `wandering_gain`.
    pub part: String,
    /// Description.
    pub what: String,
    /// Standard deviation, in newtons at a load of 20 N or relative to friction.
    pub size: f64,
    /// `N`, or `1` for a share of the friction.
    pub unit: String,
}

/// Sizes of an effect that the data do not exclude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitReport {
    /// Id.
    pub id: String,
    /// Name of the size; `present` for an effect without constants, whose whole is 1.
    pub parameter: String,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Size that changes friction or reading by 5 % somewhere in the table.
    pub typical: f64,
    /// Shape constants by name, for which the limits apply.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub shape: BTreeMap<String, f64>,
    /// Unit of the size.
    #[serde(default)]
    pub unit: String,
    /// Whether the size cannot be negative.
    #[serde(default)]
    pub one_sided: bool,
    /// Experiment that determines it.
    #[serde(default)]
    pub experiment: String,
    /// Whether every size in the interval is smaller than the typical one.
    pub excluded: bool,
}

/// An input of a calibration that no manifest lists, so that a change of it is not detected.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ExternalInput {
    /// Name without its folder.
    pub file: String,
    /// SHA-256 of its content, in hexadecimal digits.
    pub sha256: String,
}

/// Origin of the inputs of a calibration.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ProvenanceReport {
    /// External inputs, by name. All others were compared with their manifests.
    pub external: Vec<ExternalInput>,
}

impl ProvenanceReport {
    /// Returns the names of the external inputs, with commas.
    pub fn external_names(&self) -> String {
        self.external.iter().map(|input| input.file.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// Content of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// Name and version of the format.
    pub schema: String,
    /// Counts of the table.
    pub data: DataSummary,
    /// The verdict.
    pub verdict: Verdict,
    /// Whether repeated readings are as close to the model as to each other: an F test of the lack of
    /// fit at 1 %. True if no readings are repeated.
    pub adequate: bool,
    /// Expected error of a new session of the same rig in newtons: `expected_error_N` without its
    /// interval.
    #[serde(rename = "promise_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_n: Option<f64>,
    /// The same for the refitted model of the paper.
    #[serde(rename = "promise_baseline_N", default, skip_serializing_if = "Option::is_none")]
    pub promise_baseline_n: Option<f64>,
    /// Expected error of a new session with its interval; absent if there are too few series.
    #[serde(rename = "expected_error_N", default, skip_serializing_if = "Option::is_none")]
    pub expected_error_n: Option<ExpectedErrorReport>,
    /// Held-out error in newtons of robust least squares of the paper's model with drag, offset and
    /// gain, on the same parts as `heldout_series_rmse_N`.
    #[serde(rename = "least_squares_N", default, skip_serializing_if = "Option::is_none")]
    pub least_squares_n: Option<f64>,
    /// Standard deviation of a reading around the best model, in newtons.
    #[serde(rename = "noise_floor_N")]
    pub noise_floor_n: f64,
    /// Noise, as in the model file.
    pub noise: Noise,
    /// Components of the noise.
    pub noise_parts: Vec<NoisePart>,
    /// Root mean square of the scatter between series, mounts and specimens, as a share of that of the friction. The verdict is
    /// `none` only below 0.05.
    #[serde(default)]
    pub series_scatter: f64,
    /// Constants of the switch that differ between sessions or specimens.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<ChangeReport>,
    /// The refitted model of the paper.
    pub baseline: ModelReport,
    /// The best hypothesis.
    pub augmented: ModelReport,
    /// Effects of the model.
    pub effects: Vec<EffectReport>,
    /// All effects of the vocabulary, the most probable first.
    pub candidates: Vec<CandidateReport>,
    /// Structure without a name with a probability of at least 1 %.
    pub structures: Vec<StructureReport>,
    /// Sizes that the data do not exclude, of identifiable effects that are not in the model.
    pub limits: Vec<LimitReport>,
    /// Confounded covariates.
    pub aliasing: Vec<Aliasing>,
    /// Columns of the table that no calibration reads.
    pub ignored_columns: Vec<String>,
    /// Optional columns that are absent, or empty in some rows: their covariates are not used.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unknown_columns: Vec<String>,
    /// Origin of the inputs; absent if they were not read from files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<ProvenanceReport>,
    /// Effects that are not identifiable with this table.
    pub invisible: Vec<Invisible>,
    /// Effects that no table of such a rig identifies after the refit.
    pub never_visible: Vec<String>,
    /// Series to check, such as one with a mislabelled weight.
    pub bad_series: Vec<BadSeries>,
    /// Mounts whose friction differs by 5 % or more, the largest difference first: scatter that no member of the model
    /// explains. None of consequence may be there for the verdict `none`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mounts: Vec<MountReport>,
    /// Tests of the user-defined effects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<TrialReport>,
    /// State after each of several tables, in their order; empty for a single table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<SessionReport>,
    /// Errors on loads above those fitted, if some were withheld.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolation: Option<Extrapolation>,
}

impl Report {
    /// Returns why an inconclusive verdict remains although every limit is below the typical size.
    pub fn reservations(&self) -> Vec<String> {
        let hidden: Vec<&str> =
            self.invisible.iter().filter(|i| i.possible.is_some()).map(|i| i.id.as_str()).take(3).collect();
        let mut reasons = Vec::new();
        if !hidden.is_empty() {
            reasons.push(format!("the data are too few to exclude {}", hidden.join(" or ")));
        }
        let of_structure: f64 = self.structures.iter().map(|structure| structure.probability).sum();
        let possible = self.structures.first().filter(|_| of_structure > 1.0 - REPORTED_PROBABILITY);
        if let Some(StructureReport { name, probability, .. }) = possible {
            reasons.push(format!("{name} has a probability of {probability:.2}"));
        }
        reasons.extend(self.scatter_in_words());
        reasons
    }

    /// Describes scatter of consequence without a cause; `None` without any.
    pub fn scatter_in_words(&self) -> Option<String> {
        // The size of consequence, as a share of the friction.
        const LEAST: f64 = 0.05;
        let share = 100.0 * self.series_scatter;
        let words = || format!("without a known cause, series differ by {share:.0} % of the friction");
        let of_series = || (self.series_scatter >= LEAST).then(words);
        self.mounts_in_words().or_else(of_series)
    }

    /// Describes the mounts that differ, the first three by name; `None` without any.
    fn mounts_in_words(&self) -> Option<String> {
        const NAMED: usize = 3;
        let words = |m: &MountReport| format!("{} by {:+.0} %", m.mount, 100.0 * m.friction);
        let named: Vec<String> = self.mounts.iter().take(NAMED).map(words).collect();
        let more = self.mounts.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let named = named.join(", ");
        (!named.is_empty()).then(|| format!("friction differs between mounts: {named}{more}"))
    }
}

/// Errors on rows with higher loads than those fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Extrapolation {
    /// Highest load fitted, in newtons.
    #[serde(rename = "fitted_below_N")]
    pub fitted_below_n: f64,
    /// Number of rows evaluated.
    pub rows: usize,
    /// Root mean square error of the refitted baseline, in newtons.
    #[serde(rename = "rmse_before_N")]
    pub rmse_before_n: f64,
    /// The same of the augmented model.
    #[serde(rename = "rmse_after_N")]
    pub rmse_after_n: f64,
    /// The same without readings beyond 20 standard deviations of noise, so that a bad run does not
    /// dominate.
    #[serde(rename = "rmse_after_without_bad_N")]
    pub rmse_after_without_bad_n: f64,
    /// Number of readings excluded from that.
    pub bad_rows: usize,
    /// Median absolute error of the refitted baseline, in newtons.
    #[serde(rename = "median_before_N")]
    pub median_before_n: f64,
    /// The same of the augmented model.
    #[serde(rename = "median_after_N")]
    pub median_after_n: f64,
}
