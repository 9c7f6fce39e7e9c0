//! All that is said of an effect besides its formula in code: identity, place in the chain, constants, rivals, study.

use serde::{Deserialize, Serialize};

use super::{Covariate, Written};

/// Whether an effect belongs to the printed part or to the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Changes the part's own friction: stays in predicted curves.
    Switch,
    /// Belongs to the measurement: stays out of predicted curves.
    Rig,
}

impl Side {
    /// The word in reports and model files (`model/doc/file-formats.md`).
    pub fn as_str(self) -> &'static str {
        match self {
            Side::Switch => "switch",
            Side::Rig => "rig",
        }
    }
}

/// Where an effect acts between the weight and the reading; effects are tried in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The load itself.
    Load,
    /// A friction exponent added to the baseline's.
    AddedFriction,
    /// A factor on friction coefficients or on the wrap angle.
    ScaledFriction,
    /// The switching between pins and silicone.
    Switch,
    /// A force against the motion.
    Drag,
    /// The scale of the load cell.
    CellScale,
    /// The zero of the load cell.
    CellZero,
    /// The end of the load cell's range: acts on everything before it.
    CellLimit,
}

/// One constant of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its symbol.
    pub name: &'static str,
    /// Its unit; `1` if it has none.
    pub unit: &'static str,
    /// Bounds of a shape constant; `None` for a size, which is free.
    pub bounds: Option<(f64, f64)>,
}

impl Parameter {
    /// A size: unbounded, the effect vanishes at zero.
    pub const fn free(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, bounds: None }
    }

    /// A shape within bounds.
    pub const fn bounded(name: &'static str, unit: &'static str, least: f64, most: f64) -> Self {
        Self { name, unit, bounds: Some((least, most)) }
    }
}

/// What the paper's protocol (loads ascending, one dwell, speed following load) shows of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperProtocol {
    /// It can be seen and named.
    Shown,
    /// What it depends on never varies.
    Hidden,
    /// It can be seen, but not told from another effect.
    Confounded,
}

/// Sizes and shapes that the study of the calibrator draws, and that `power` tries: the upper part of what is typical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyRange {
    /// Smallest and largest size, in the unit of the first parameter; `None` without a free constant.
    pub size: Option<(f64, f64)>,
    /// Whether either sign is drawn.
    pub signed: bool,
    /// Ranges of the shape constants, in the order of the parameters.
    pub shapes: &'static [(f64, f64)],
    /// What the paper's protocol shows of it.
    pub paper: PaperProtocol,
}

impl StudyRange {
    /// Constants of the effect at a size in the middle of its shapes, in the order of its parameters.
    pub fn values_at(&self, size: Option<f64>) -> Vec<f64> {
        size.into_iter().chain(self.shapes.iter().map(|(least, most)| 0.5 * (least + most))).collect()
    }

    /// The largest size, if the effect has one.
    pub fn largest(&self) -> Option<f64> {
        self.size.map(|(_, most)| most)
    }
}

/// What is known and said of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// Its id: `[a-z][a-z0-9_]*`, a heading of `model/doc/effect-catalogue.md`.
    pub id: &'static str,
    /// Part or measurement.
    pub side: Side,
    /// Where its trace lies.
    pub covariate: Covariate,
    /// Where it acts.
    pub stage: Stage,
    /// Its formula, in the symbols of the effect catalogue.
    pub formula: &'static str,
    /// Its form as a formula on its own, where the language of formulas can say it.
    pub written: Written,
    /// Its constants, sizes before shapes.
    pub parameters: &'static [Parameter],
    /// Whether its size can only be positive: what fits with a negative one is something else.
    pub one_sided: bool,
    /// Whether its form is an approximation, so that what it leaves may be its own. A constant force or a scale is none.
    pub bends: bool,
    /// Whether its trace grows in proportion to its first constant, as far as a screening to first order sees.
    pub scales: bool,
    /// Ids of effects that may look the same.
    pub confused_with: &'static [&'static str],
    /// The experiment that shows it apart from those.
    pub experiment: &'static str,
    /// What keeps data from showing it.
    pub invisible_because: &'static str,
    /// What the study draws.
    pub study: StudyRange,
}
