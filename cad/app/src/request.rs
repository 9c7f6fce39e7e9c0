//! Questions of the page.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

/// Values that differ from the defaults, by `table.key`.
pub type Values = BTreeMap<String, Value>;

/// One question.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Request {
    /// Fields, templates and formats.
    Facts,
    /// What the page shows of a design.
    Design {
        #[serde(flatten)]
        design: Asked,
        #[serde(default)]
        quality: Quality,
    },
    /// The values that the text of a configuration sets.
    Open { toml: String, file: String },
    /// Names and sizes of the files of a design.
    Files {
        #[serde(flatten)]
        design: Asked,
    },
    /// The content of one of them.
    File {
        #[serde(flatten)]
        design: Asked,
        name: String,
    },
    /// All of them in one archive.
    Zip {
        #[serde(flatten)]
        design: Asked,
    },
    /// Designs that do what is wanted.
    Search(Wanted),
    /// Whether the text of a calibrated model is one.
    Model { toml: String, file: String },
    /// What a table of measured plateaus says.
    Calibrate { csv: String, file: String },
}

/// How long a question takes, at the most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Somebody moves a slider: some hundredths of a second.
    Quick,
    /// The files of a design.
    Files,
    /// A search or a calibration: seconds, and minutes for a long table.
    Long,
}

/// What a question asks, whatever else it holds.
#[derive(Deserialize)]
struct Asks<'a> {
    #[serde(borrow)]
    ask: std::borrow::Cow<'a, str>,
}

/// How long a question may take; what is none is answered at once.
pub fn pace(question: &[u8]) -> Pace {
    match serde_json::from_slice::<Asks<'_>>(question).as_ref().map(|asks| &*asks.ask) {
        Ok("search" | "calibrate") => Pace::Long,
        Ok("files" | "file" | "zip") => Pace::Files,
        _ => Pace::Quick,
    }
}

/// A design that a question is about.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub(crate) struct Asked {
    #[serde(default)]
    pub(crate) values: Values,
    /// The text of a calibrated model, instead of the published constants.
    #[serde(default)]
    pub(crate) model: Option<String>,
}

/// How fine the meshes are.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Quality {
    /// Coarse, to be seen while somebody moves a slider.
    Coarse,
    /// As the configuration says.
    #[default]
    Exact,
}

/// What is wanted of a switch.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wanted {
    #[serde(default)]
    pub(crate) values: Values,
    /// Threshold, N.
    #[serde(default)]
    pub(crate) threshold_n: Option<f64>,
    /// Friction at loads.
    #[serde(default)]
    pub(crate) friction: Vec<FrictionAt>,
    /// The text of a calibrated model, instead of the published constants.
    #[serde(default)]
    pub(crate) model: Option<String>,
    /// How many designs at the most.
    #[serde(default = "six")]
    pub(crate) most: usize,
}

/// Friction at a load, both in newtons.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrictionAt {
    pub(crate) load_n: f64,
    pub(crate) friction_n: f64,
}

const fn six() -> usize {
    6
}
