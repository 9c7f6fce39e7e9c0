//! What plots and page show of a sweep: as many variants as a person can look at, evenly taken from all.

use std::collections::HashMap;

use serde::Serialize;

use super::forecast::ForecastKey;
use super::table::{Cell, Row, Schema};
use super::variant::Variants;
use pinswitch_friction::predict;
use pinswitch_switch::design::Design;

/// Most variants that are shown; beyond it every second, third, ... one is.
const MAX_SHOWN: u64 = 5000;
/// Points of a shown curve.
const POINTS: usize = 25;

/// A value of a field that varies.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum SettingValue {
    /// A number.
    Number(f64),
    /// Anything else, as written.
    Words(String),
}

/// A variant as it is shown; curve and numbers are absent unless it was made. Forces in newtons.
#[derive(Clone, Debug, Serialize)]
pub(super) struct GalleryEntry {
    /// Its id.
    pub id: String,
    /// What is engraved.
    pub label: String,
    /// made, refused or failed.
    pub status: String,
    /// Why not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The fields that vary, in the order of [`Gallery::fields`].
    pub settings: Vec<SettingValue>,
    /// Friction at the heaviest load with the edges of its band: middle, low, high.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_n: Option<[f64; 3]>,
    /// Load from which the silicone makes half of the friction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub threshold_n: Option<f64>,
    /// How far to trust the curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trust: Option<String>,
    /// Mass of all printed parts, g.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub printed_g: Option<f64>,
    /// First and last load of the curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loads_n: Option<[f64; 2]>,
    /// Friction at evenly spaced loads between them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curve_n: Vec<f64>,
    /// Its segment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glyph: Option<Glyph>,
}

/// The segment as it is drawn small, seen along the pulley's axis.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Glyph {
    /// Outer radius of the shell.
    radius_mm: f64,
    /// Its radial thickness.
    wall_mm: f64,
    /// Thickness of the silicone, or of the rigid proxy in its place.
    layer_mm: f64,
    /// Angle over all grooves.
    span_deg: f64,
    /// Where the pins lie, from the middle.
    pins_deg: Vec<f64>,
}

impl Glyph {
    fn of(design: &Design) -> Self {
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

/// A curve as it is shown.
#[derive(Clone, Debug)]
struct ShownCurve {
    /// First and last load.
    loads_n: [f64; 2],
    /// Friction at evenly spaced loads between them.
    friction_n: Vec<f64>,
}

/// The variants that are shown.
#[derive(Clone, Debug, Default)]
pub(super) struct Gallery {
    /// Names of the fields that vary.
    pub fields: Vec<String>,
    /// Number of variants of the sweep.
    pub of: u64,
    /// One in this many is shown.
    pub every: u64,
    /// Those shown.
    pub shown: Vec<GalleryEntry>,
    /// Curves by what they depend on.
    curves: HashMap<ForecastKey, ShownCurve>,
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

    /// Adds variant `index` if it is one of those shown.
    pub(super) fn add(&mut self, variants: &Variants, index: u64, schema: &Schema, row: &Row) {
        if !index.is_multiple_of(self.every) {
            return;
        }
        let cell = |name: &str| schema.cell(row, name);
        let text = |name: &str| cell(name).text().map(str::to_owned);
        let number = |name: &str| cell(name).number().map(rounded);
        let made = cell("status").text() == Some("made");
        // From the configuration: cheaper than to keep or read what was made of it.
        let design = made.then(|| Design::new(variants.get(index).configuration).ok()).flatten();
        let curve = design.as_ref().map(|design| self.curve(design));
        let settings = self.fields.iter().map(|name| match cell(name) {
            Cell::Text(words) => SettingValue::Words(words.clone()),
            other => {
                other.number().map_or_else(|| SettingValue::Words(other.to_string()), SettingValue::Number)
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
            glyph: design.as_ref().map(Glyph::of),
        });
    }

    fn curve(&mut self, design: &Design) -> ShownCurve {
        let known = self.curves.entry(ForecastKey::of(design));
        known.or_insert_with(|| shown_curve(design)).clone()
    }

    /// The variants with a curve.
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

/// A tenth of a millinewton is enough to look at.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
