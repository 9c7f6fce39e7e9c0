//! The variants in plots and page: an evenly spaced sample of the sweep, small enough for a
//! browser.

use std::collections::HashMap;

use serde::Serialize;

use super::prediction_cache::PredictionKey;
use super::table::{Cell, Row, Schema};
use super::variant::Variants;
use pinswitch_friction::predict;
use pinswitch_switch::design::Design;

/// Most variants in the gallery; of a larger sweep, every second, third, ... one.
const MAX_SHOWN: u64 = 5000;
/// Points of a curve.
const POINTS: usize = 25;

/// The value of a field that varies.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum SettingValue {
    /// A number.
    Number(f64),
    /// Any other value, as written.
    Text(String),
}

/// A variant in the gallery; curve and numbers are absent unless it was made. Forces are in
/// newtons.
#[derive(Clone, Debug, Serialize)]
pub(super) struct GalleryEntry {
    /// Its id.
    pub id: String,
    /// The engraved label.
    pub label: String,
    /// `made`, `refused` or `failed`.
    pub status: String,
    /// Why it was not made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The values of the fields that vary, in the order of [`Gallery::fields`].
    pub settings: Vec<SettingValue>,
    /// Friction at the largest load with its band: middle, low, high.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_n: Option<[f64; 3]>,
    /// Load at which silicone carries half of the friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold_n: Option<f64>,
    /// Prediction status: `published`, `interpolated` or `extrapolated`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trust: Option<String>,
    /// Mass of all printed parts, g.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub printed_g: Option<f64>,
    /// Smallest and largest load of the curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_n: Option<[f64; 2]>,
    /// Friction at evenly spaced loads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curve_n: Vec<f64>,
    /// Its segment as a small drawing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glyph: Option<Glyph>,
}

/// A small drawing of the segment, seen along the pulley's axis.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Glyph {
    /// Outer radius of the shell.
    radius_mm: f64,
    /// Radial thickness of the shell.
    wall_mm: f64,
    /// Thickness of the silicone layer, or of the rigid proxy that replaces it.
    layer_mm: f64,
    /// Angle over all grooves.
    span_deg: f64,
    /// Angles of the pins from the middle.
    pins_deg: Vec<f64>,
}

impl Glyph {
    fn from_design(design: &Design) -> Self {
        let c = design.configuration();
        let pins_deg = design.pin_angles_rad().into_iter().map(|a| rounded(a.to_degrees())).collect();
        Self {
            radius_mm: c.shell.outer_radius_mm,
            wall_mm: c.shell.wall_mm,
            layer_mm: rounded(design.contact_radius_mm() - c.shell.outer_radius_mm),
            span_deg: c.segment.span_deg,
            pins_deg,
        }
    }
}

/// A curve in the gallery.
#[derive(Clone, Debug)]
struct ShownCurve {
    /// Smallest and largest load.
    loads_n: [f64; 2],
    /// Friction at evenly spaced loads.
    friction_n: Vec<f64>,
}

/// The variants in plots and page.
#[derive(Clone, Debug, Default)]
pub(super) struct Gallery {
    /// Names of the fields that vary.
    pub fields: Vec<String>,
    /// Number of variants of the sweep.
    pub of: u64,
    /// Every how many variants one is in the gallery.
    pub every: u64,
    /// The variants in the gallery.
    pub shown: Vec<GalleryEntry>,
    /// Curves by their inputs.
    curves: HashMap<PredictionKey, ShownCurve>,
}

impl Gallery {
    /// An empty gallery for a sweep.
    pub(super) fn new(variants: &Variants) -> Self {
        Self {
            fields: variants.fields().map(|f| f.path()).collect(),
            of: variants.count(),
            every: variants.count().div_ceil(MAX_SHOWN).max(1),
            shown: Vec::new(),
            curves: HashMap::new(),
        }
    }

    /// Adds variant `index` if it is in the sample.
    pub(super) fn add(&mut self, variants: &Variants, index: u64, schema: &Schema, row: &Row) {
        if !index.is_multiple_of(self.every) {
            return;
        }
        let cell = |name: &str| schema.cell(row, name);
        let text = |name: &str| cell(name).text().map(str::to_owned);
        let number = |name: &str| cell(name).number().map(rounded);
        let made = cell("status").text() == Some("made");
        // Building the design again is cheaper than keeping or reading what was made.
        let design = made.then(|| Design::new(variants.get(index).configuration).ok()).flatten();
        let curve = design.as_ref().map(|design| self.curve(design));
        let settings = self.fields.iter().map(|name| match cell(name) {
            Cell::Text(text) => SettingValue::Text(text.clone()),
            other => {
                other.number().map_or_else(|| SettingValue::Text(other.to_string()), SettingValue::Number)
            }
        });
        self.shown.push(GalleryEntry {
            settings: settings.collect(),
            id: text("id").unwrap_or_default(),
            label: text("label").unwrap_or_default(),
            status: text("status").unwrap_or_default(),
            reason: text("reason"),
            friction_n: number("friction_n")
                .zip(number("band_low_n"))
                .zip(number("band_high_n"))
                .map(|((middle, low), high)| [middle, low, high]),
            threshold_n: number("threshold_n"),
            trust: text("friction_trust"),
            printed_g: number("printed_mass_g"),
            loads_n: curve.as_ref().map(|curve| curve.loads_n),
            curve_n: curve.map(|curve| curve.friction_n).unwrap_or_default(),
            glyph: design.as_ref().map(Glyph::from_design),
        });
    }

    fn curve(&mut self, design: &Design) -> ShownCurve {
        let entry = self.curves.entry(PredictionKey::from_design(design));
        entry.or_insert_with(|| shown_curve(design)).clone()
    }

    /// Returns the variants with a curve.
    pub(super) fn made(&self) -> impl Iterator<Item = &GalleryEntry> {
        self.shown.iter().filter(|s| s.loads_n.is_some())
    }
}

fn shown_curve(design: &Design) -> ShownCurve {
    let f = &design.configuration().friction;
    let ends = [f.load_min_n, f.load_max_n];
    #[allow(clippy::cast_precision_loss)]
    let loads: Vec<_> =
        (0..POINTS).map(|i| ends[0] + (ends[1] - ends[0]) * i as f64 / (POINTS - 1) as f64).collect();
    let curve = predict(design.contact(), &loads);
    ShownCurve { loads_n: ends.map(rounded), friction_n: curve.friction_n.into_iter().map(rounded).collect() }
}

/// Rounds to a tenth of a millinewton, or of a micrometre, for display.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
