//! Requests of the page.

use pinswitch_switch::formats::page::Values;
use serde::Deserialize;

/// One request; `command` names its kind.
#[derive(Debug, Deserialize)]
#[serde(tag = "command", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Request {
    /// Fields, templates and formats.
    Facts,
    /// The curves of the templates that are switches.
    Templates,
    /// What the page shows of a design.
    Design {
        #[serde(flatten)]
        design: DesignRequest,
        #[serde(default)]
        quality: Quality,
    },
    /// The values of a number with which the design satisfies every rule.
    Reach { values: Values, field: String },
    /// The values in the text of a configuration.
    Open { toml: String, file: String },
    /// Names and sizes of the files of a design.
    Files {
        #[serde(flatten)]
        design: DesignRequest,
    },
    /// The content of one file.
    File {
        #[serde(flatten)]
        design: DesignRequest,
        name: String,
    },
    /// All files in one archive.
    Zip {
        #[serde(flatten)]
        design: DesignRequest,
    },
    /// Designs that reach targets.
    Search(SearchRequest),
    /// Whether a text is a calibrated model.
    Model { toml: String, file: String },
    /// What a dropped file of measurements contains: its bytes in base64, and values of its map.
    Import { data: String, file: String, set: Vec<String> },
    /// A calibration with a table of measured plateaus.
    Calibrate { csv: String, file: String },
    /// A table to try a calibration with.
    Sample,
    /// The runs after a table that answer most open questions in some minutes.
    Experiment { csv: String, file: String, minutes: f64 },
}

/// A design.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub(crate) struct DesignRequest {
    #[serde(default)]
    pub(crate) values: Values,
    /// The text of a calibrated model, instead of the published constants.
    #[serde(default)]
    pub(crate) model: Option<String>,
}

/// Resolution of meshes and curve.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Quality {
    /// Coarse, for display while a slider moves.
    Coarse,
    /// As configured.
    #[default]
    Exact,
}

/// Targets of a search for designs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SearchRequest {
    #[serde(default)]
    pub(crate) values: Values,
    /// Target threshold, N.
    #[serde(default)]
    pub(crate) threshold_n: Option<f64>,
    /// Target frictions.
    #[serde(default)]
    pub(crate) friction: Vec<FrictionTarget>,
    /// The text of a calibrated model, instead of the published constants.
    #[serde(default)]
    pub(crate) model: Option<String>,
    /// Parameters that the search varies, by the names of a request, and `pattern` for the pins; by default those of the
    /// command line.
    #[serde(default)]
    pub(crate) vary: Option<Vec<String>>,
    /// Most designs to return.
    #[serde(default = "default_most")]
    pub(crate) most: usize,
}

/// A target friction at a load.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrictionTarget {
    /// Load, N.
    pub(crate) load_n: f64,
    /// Friction, N.
    pub(crate) friction_n: f64,
}

const fn default_most() -> usize {
    6
}
