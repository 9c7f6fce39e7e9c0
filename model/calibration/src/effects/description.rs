//! Description of an effect: identity, place in the forward model, constants, rivals, and ranges
//! for the study.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::{Covariate, Written};

/// Whether an effect belongs to the printed part or to the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The part's own friction; included in predicted curves.
    Switch,
    /// The measurement; excluded from predicted curves.
    Rig,
}

impl Side {
    /// Returns the word used in reports and model files (`model/doc/file-formats.md`).
    pub fn as_str(self) -> &'static str {
        match self {
            Side::Switch => "switch",
            Side::Rig => "rig",
        }
    }
}

/// Stage between the weight and the reading at which an effect acts. Effects act in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The load itself.
    Load,
    /// A friction exponent added to the baseline's.
    AddedFriction,
    /// A factor on friction coefficients or on the wrap angle.
    ScaledFriction,
    /// The transition between pins and silicone.
    Switch,
    /// A force against the motion.
    Drag,
    /// The scale of the load cell.
    CellScale,
    /// The zero of the load cell.
    CellZero,
    /// The end of the load cell's range, which applies after all other stages.
    CellLimit,
}

/// A constant of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Symbol.
    pub name: Cow<'static, str>,
    /// Unit; `1` if dimensionless.
    pub unit: Cow<'static, str>,
    /// Bounds of a shape; `None` for a size, which is free.
    pub bounds: Option<(f64, f64)>,
    /// Value where it is not given, as in plans and models of earlier versions; only the last constants of an effect may have
    /// one.
    pub otherwise: Option<f64>,
}

impl Parameter {
    /// Returns a size: unbounded, and the effect vanishes at zero.
    pub const fn free(name: &'static str, unit: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit: Cow::Borrowed(unit), bounds: None, otherwise: None }
    }

    /// Returns a shape within bounds.
    pub const fn bounded(name: &'static str, unit: &'static str, least: f64, most: f64) -> Self {
        Self {
            name: Cow::Borrowed(name),
            unit: Cow::Borrowed(unit),
            bounds: Some((least, most)),
            otherwise: None,
        }
    }

    /// Returns a shape within bounds that has a value where it is not given.
    pub const fn bounded_or(
        name: &'static str,
        unit: &'static str,
        least: f64,
        most: f64,
        otherwise: f64,
    ) -> Self {
        Self {
            name: Cow::Borrowed(name),
            unit: Cow::Borrowed(unit),
            bounds: Some((least, most)),
            otherwise: Some(otherwise),
        }
    }
}

/// Whether the paper's protocol (ascending loads, one dwell, speed following load) identifies an
/// effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaperProtocol {
    /// Identifiable.
    Shown,
    /// The covariate never varies.
    Hidden,
    /// Detectable, but confounded with another effect.
    Confounded,
}

/// Sizes and shapes that the study of the calibrator and `power` use: the upper part of the typical
/// range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyRange<'a> {
    /// Smallest and largest size in the unit of the first parameter; `None` without a size.
    pub size: Option<(f64, f64)>,
    /// Whether both signs are used.
    pub signed: bool,
    /// Ranges of the shapes, in the order of the parameters.
    pub shapes: &'a [(f64, f64)],
    /// Whether the paper's protocol identifies it.
    pub paper: PaperProtocol,
}

impl StudyRange<'_> {
    /// Returns the constants for a size, with shapes in the middle of their ranges, in the order of
    /// the parameters.
    pub fn values_at(&self, size: Option<f64>) -> Vec<f64> {
        size.into_iter().chain(self.shapes.iter().map(|(least, most)| 0.5 * (least + most))).collect()
    }

    /// Returns the largest size, if the effect has one.
    pub fn largest(&self) -> Option<f64> {
        self.size.map(|(_, most)| most)
    }
}

/// Description of an effect: of a built-in one for the lifetime of the program, of a user-defined one as
/// long as the effect itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description<'a> {
    /// Id: `[a-z][a-z0-9_]*`, a heading of `model/doc/effect-catalogue.md`.
    pub id: &'a str,
    /// Whether the effect belongs to the part or to the measurement.
    pub side: Side,
    /// Covariate along which the effect shows.
    pub covariate: Covariate,
    /// Stage at which the effect acts.
    pub stage: Stage,
    /// Formula in the symbols of the effect catalogue.
    pub formula: &'a str,
    /// Formula in the formula language, if the language can express it.
    pub written: Written<'a>,
    /// Constants, sizes before shapes.
    pub parameters: &'a [Parameter],
    /// Whether the size cannot be negative. A fit with a negative size then indicates another
    /// effect.
    pub one_sided: bool,
    /// Whether the formula is an approximation that may leave a residual of its own; a constant
    /// force or a scale is exact.
    pub bends: bool,
    /// Whether the predicted change is proportional to the first constant, to first order.
    pub scales: bool,
    /// Whether it can act on a rig that has `plain` contacts only, and is not another effect there.
    pub on_plain: bool,
    /// Ids of effects that may look the same.
    pub confused_with: &'a [Cow<'static, str>],
    /// Experiment that separates it from those.
    pub experiment: &'a str,
    /// Property of a table that prevents its identification.
    pub invisible_because: &'static str,
    /// Ranges for the study.
    pub study: StudyRange<'a>,
}

impl Description<'_> {
    /// Returns whether it names an effect among those that may look the same.
    pub fn is_confused_with(&self, id: &str) -> bool {
        self.confused_with.iter().any(|other| other == id)
    }
}
