//! The variants in plots and page: an evenly spaced sample of the sweep, small enough for a
//! browser.

use serde::Serialize;

use super::table::{Cell, Row, Schema};
use super::variant::Variants;
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

/// Curve and drawing of a variant in the gallery.
#[derive(Clone, Debug)]
pub(super) struct Sketch {
    /// Smallest and largest load, N.
    loads_n: [f64; 2],
    /// Friction at evenly spaced loads, N.
    friction_n: Vec<f64>,
    glyph: Glyph,
}

impl Sketch {
    /// Creates the sketch of variant `index` from the bytes of its curve's table; `None` if the
    /// variant is not in the gallery.
    pub(super) fn new(variants: &Variants, index: u64, curve: &[u8]) -> Option<Self> {
        if !index.is_multiple_of(every(variants)) {
            return None;
        }
        // Building the design again is cheaper than keeping or reading what was made.
        let design = Design::new(variants.get(index).configuration).ok()?;
        let (load_n, friction_n) = written_curve(curve)?;
        let friction = &design.configuration().friction;
        let loads_n = [friction.load_min_n, friction.load_max_n].map(rounded);
        #[allow(clippy::cast_precision_loss)]
        let at = |i: usize| loads_n[0] + (loads_n[1] - loads_n[0]) * i as f64 / (POINTS - 1) as f64;
        let friction_n = (0..POINTS).map(|i| rounded(interpolated(&load_n, &friction_n, at(i)))).collect();
        Some(Self { loads_n, friction_n, glyph: Glyph::from_design(&design) })
    }
}

/// Returns loads and friction of a curve's table, N; `None` if it is malformed.
fn written_curve(bytes: &[u8]) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut lines = std::str::from_utf8(bytes).ok()?.lines();
    let names: Vec<&str> = lines.next()?.split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name);
    let (load, friction) = (column("load_N")?, column("friction_N")?);
    let number = |line: &str, column: usize| line.split(',').nth(column)?.parse::<f64>().ok();
    let rows: Option<Vec<_>> =
        lines.map(|line| Some((number(line, load)?, number(line, friction)?))).collect();
    Some(rows?.into_iter().unzip())
}

/// Returns `column` at `load` by the polynomial through the four nearest loads, or all of fewer.
fn interpolated(loads: &[f64], column: &[f64], load: f64) -> f64 {
    const NEAREST: usize = 4;
    let count = loads.len().min(NEAREST);
    let above = loads.partition_point(|l| *l < load);
    let first = above.saturating_sub(NEAREST / 2).min(loads.len() - count);
    let (loads, column) = (&loads[first..first + count], &column[first..first + count]);
    let weight = |i: usize| {
        let others = loads.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| (load - other) / (loads[i] - other)).product::<f64>()
    };
    column.iter().enumerate().map(|(i, value)| weight(i) * value).sum()
}

/// Returns every how many variants one is in the gallery.
fn every(variants: &Variants) -> u64 {
    variants.count().div_ceil(MAX_SHOWN).max(1)
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
}

impl Gallery {
    /// An empty gallery for a sweep.
    pub(super) fn new(variants: &Variants) -> Self {
        Self {
            fields: variants.fields().map(|f| f.path()).collect(),
            of: variants.count(),
            every: every(variants),
            shown: Vec::new(),
        }
    }

    /// Adds variant `index` if it is in the sample; a variant that was made has a sketch.
    pub(super) fn add(&mut self, index: u64, schema: &Schema, row: &Row, sketch: Option<Sketch>) {
        if !index.is_multiple_of(self.every) {
            return;
        }
        let cell = |name: &str| schema.cell(row, name);
        let text = |name: &str| cell(name).text().map(str::to_owned);
        let number = |name: &str| cell(name).number().map(rounded);
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
            loads_n: sketch.as_ref().map(|sketch| sketch.loads_n),
            curve_n: sketch.as_ref().map(|sketch| sketch.friction_n.clone()).unwrap_or_default(),
            glyph: sketch.map(|sketch| sketch.glyph),
        });
    }

    /// Returns the variants with a curve.
    pub(super) fn made(&self) -> impl Iterator<Item = &GalleryEntry> {
        self.shown.iter().filter(|s| s.loads_n.is_some())
    }
}

/// Rounds to a tenth of a millinewton, or of a micrometre, for display.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
