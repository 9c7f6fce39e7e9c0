//! `manifest.json`: everything that a person or a program needs to know of a set, and to check it.

use pinswitch_friction::{FrictionCurve, Law, Transition, Trust};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::{Bill, PlateEntry, PrintEntry, bill_of_materials};
use crate::config::{Configuration, Origin};
use crate::design::Design;
use crate::output::{OutputFile, SetError};
use crate::parts::{Material, Part, Touch, touches};
use crate::prediction::Prediction;
use pinswitch_solid::validity::MeshFacts;
use pinswitch_solid::verification::Verification;

/// One value that the user may set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// `section.key`.
    pub field: String,
    /// The value.
    pub value: Value,
    /// Its unit; empty for words and plain numbers.
    pub unit: &'static str,
    /// `published`, `assumed` or `chosen` by us; `configured` where the configuration sets another value.
    pub origin: String,
    /// What it is and why it has its default.
    pub reason: &'static str,
}

/// One dimension that follows from the settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DerivedDimension {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// `published`, `assumed` or `chosen`: the least certain of what it follows from.
    pub origin: Origin,
    /// How it follows.
    pub from: &'static str,
}

/// One part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartEntry {
    /// Its name.
    pub name: String,
    /// Its file.
    pub file: String,
    /// What it is printed from.
    pub material: Material,
    /// Exact volume of the profile's solid, mm³.
    pub volume_mm3: f64,
    /// Exact surface, mm².
    pub surface_mm2: f64,
    /// Mass when printed solid, g.
    pub mass_g: f64,
    /// Widest ceiling to be bridged when it is printed, mm.
    pub widest_bridge_mm: f64,
    /// The mesh as written.
    pub mesh: MeshFacts,
    /// Agreement of the mesh with that of a second kernel, where that was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verification: Option<Verification>,
    /// What was left out of it, and what makes room for it; among the warnings, too.
    pub notes: Vec<String>,
}

/// The bound that every mesh keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeshBound {
    /// Chord tolerance, mm: no point of a curve and of its flattening lie further apart.
    pub chord_tolerance_mm: f64,
    /// Largest relative difference between a mesh's volume and the exact one, over all parts.
    pub largest_volume_error: f64,
}

/// The model behind the curve, and how far to trust it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrictionEntry {
    /// The law.
    pub law: Law,
    /// How far to trust it.
    pub trust: Trust,
    /// Why no further.
    pub reasons: Vec<String>,
    /// Where the law comes from.
    pub source: &'static str,
    /// Heaviest load of the curve, N.
    pub load_n: f64,
    /// Friction there, N.
    pub friction_n: f64,
    /// Its band there, N.
    pub band_n: [f64; 2],
    /// Load from which the silicone makes half of the friction or more, N; absent if that lies outside the curve.
    pub threshold_n: Option<f64>,
    /// The whole curve.
    pub curve_file: &'static str,
    /// The other laws that apply, at the same load: beside the curve, never mixed into it.
    pub other_laws: Vec<LawEntry>,
}

/// What another law says at the heaviest load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawEntry {
    /// The law.
    pub law: Law,
    /// How far to trust it.
    pub trust: Trust,
    /// Why no further.
    pub reasons: Vec<String>,
    /// Where it comes from.
    pub source: &'static str,
    /// Friction, N.
    pub friction_n: f64,
    /// Its band, N.
    pub band_n: [f64; 2],
}

/// A file of the set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileEntry {
    /// Its name in the folder.
    pub file: String,
    /// Its size.
    pub bytes: usize,
    /// Its SHA-256, hexadecimal.
    pub sha256: String,
    /// In a batch: the one file that all equal ones are links to, or stand for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
}

/// The configuration that a set was made from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceEntry {
    /// The template's name, or the file's path from the folder of the set, with `/` on every machine. No file has the
    /// name of a template alone.
    pub name: String,
}

impl SourceEntry {
    /// The entry of a configuration of this name.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into() }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// The batch that a set was made in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BatchEntry {
    /// SHA-256 of the sweep.
    pub sweep_sha256: String,
    /// Place in the sweep, from 0.
    pub index: u64,
    /// What is engraved.
    pub label: String,
}

/// The manifest of a set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Manifest {
    /// Name and version of this file's schema.
    pub schema: &'static str,
    /// Name of the set.
    pub name: String,
    /// Program and version that made it.
    pub generator: String,
    /// The configuration that it was made from, where that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<SourceEntry>,
    /// The batch that it is part of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub batch: Option<BatchEntry>,
    /// Every value that the user may set.
    pub settings: Vec<Setting>,
    /// What follows from them.
    pub derived: Vec<DerivedDimension>,
    /// The parts.
    pub parts: Vec<PartEntry>,
    /// The plates that they are printed on, where the set has packages of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plates: Vec<PlateEntry>,
    /// What a slicer says of printing them, where one was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub print: Option<PrintEntry>,
    /// The bound on their meshes.
    pub mesh: MeshBound,
    /// What to buy, cut and pour.
    pub bill_of_materials: Bill,
    /// The predicted curve.
    pub friction: FrictionEntry,
    /// What is not ideal, with the parameter to change.
    pub warnings: Vec<String>,
    /// All other files of the set.
    pub files: Vec<FileEntry>,
}

impl Manifest {
    /// The manifest of a design with its printed parts and their meshes' facts; no file is listed yet.
    pub fn new<'a>(
        design: &Design,
        parts: impl IntoIterator<Item = (&'a Part, &'a MeshFacts)>,
        prediction: &Prediction,
    ) -> Self {
        let c = design.configuration();
        let mut warnings = design.warnings();
        let parts: Vec<_> = parts
            .into_iter()
            .map(|(part, facts)| {
                let entry = part_entry(part, facts, design);
                warnings.extend(entry.notes.iter().map(|note| format!("{}: {note}", part.name)));
                warnings.extend(part.thin_warning(design));
                entry
            })
            .collect();
        let error = |p: &PartEntry| (p.mesh.volume_mm3 / p.volume_mm3 - 1.0).abs();
        let curve = &prediction.curve;
        Self {
            schema: "pinswitch.set/1",
            name: c.switch.name.to_string(),
            generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
            source: None,
            batch: None,
            settings: settings(c),
            derived: derived(design),
            mesh: MeshBound {
                chord_tolerance_mm: design.tolerance().mm(),
                largest_volume_error: parts.iter().map(error).fold(0.0, f64::max),
            },
            parts,
            plates: Vec::new(),
            print: None,
            bill_of_materials: bill_of_materials(design),
            friction: FrictionEntry {
                law: curve.law,
                trust: curve.trust,
                reasons: curve.reasons.clone(),
                source: curve.law.source(),
                load_n: last(&curve.load_n),
                friction_n: last(&curve.friction_n),
                band_n: [last(&curve.band_low_n), last(&curve.band_high_n)],
                other_laws: prediction.others.iter().map(law_entry).collect(),
                threshold_n: Transition::of(curve).map(|t| t.threshold_n),
                curve_file: "friction.csv",
            },
            warnings,
            files: Vec::new(),
        }
    }

    /// Widest ceiling to be bridged over all parts, mm.
    pub fn widest_bridge_mm(&self) -> f64 {
        self.parts.iter().map(|p| p.widest_bridge_mm).fold(0.0, f64::max)
    }

    /// The manifest as indented JSON.
    ///
    /// # Errors
    /// [`SetError::Encoding`] for a value that JSON cannot hold, which no valid design has.
    pub fn bytes(&self) -> Result<Vec<u8>, SetError> {
        let mut bytes = serde_json::to_vec_pretty(self).map_err(SetError::encoding)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

fn last(column: &[f64]) -> f64 {
    column.last().copied().unwrap_or_default()
}

fn law_entry(curve: &FrictionCurve) -> LawEntry {
    LawEntry {
        law: curve.law,
        trust: curve.trust,
        reasons: curve.reasons.clone(),
        source: curve.law.source(),
        friction_n: last(&curve.friction_n),
        band_n: [last(&curve.band_low_n), last(&curve.band_high_n)],
    }
}

fn part_entry(part: &Part, facts: &MeshFacts, design: &Design) -> PartEntry {
    let volume_mm3 = part.solid.volume_mm3();
    PartEntry {
        name: part.name.clone(),
        file: format!("{}.stl", part.name),
        material: part.material(),
        volume_mm3,
        surface_mm2: part.solid.surface_mm2(),
        mass_g: volume_mm3 / 1000.0 * design.configuration().print.abs_density_g_cm3,
        widest_bridge_mm: part.widest_bridge_mm(),
        mesh: facts.clone(),
        verification: None,
        notes: part.notes(design),
    }
}

impl FileEntry {
    /// The entry of a file with these bytes.
    pub fn of(file: &OutputFile) -> Self {
        let sha256 = hexadecimal(&Sha256::digest(&file.bytes));
        Self { file: file.name.clone(), bytes: file.bytes.len(), sha256, content: None }
    }
}

fn settings(c: &Configuration) -> Vec<Setting> {
    let defaults = Configuration::default();
    Configuration::PARAMETERS
        .iter()
        .map(|p| {
            let value = (p.get)(c);
            let as_default = value.to_string() == (p.get)(&defaults).to_string();
            Setting {
                field: p.path(),
                value: toml_to_json(&value),
                unit: p.unit(),
                // The published layouts are data of the paper, whichever of them a configuration names.
                origin: if as_default { p.origin.to_string() } else { "configured".to_owned() },
                reason: p.reason,
            }
        })
        .collect()
}

/// A TOML value as JSON.
pub fn toml_to_json(value: &toml_edit::Value) -> Value {
    match value {
        toml_edit::Value::Integer(i) => json!(i.value()),
        toml_edit::Value::Float(f) => json!(f.value()),
        toml_edit::Value::Boolean(b) => json!(b.value()),
        toml_edit::Value::Array(list) => list.iter().map(toml_to_json).collect(),
        other => json!(other.as_str().unwrap_or_default()),
    }
}

/// Every dimension of `design` that follows from its settings.
pub fn derived(design: &Design) -> Vec<DerivedDimension> {
    let land = design.land_mm();
    let slot = design.slot();
    let entry = |name, value, unit, origin, from| DerivedDimension { name, value, unit, origin, from };
    use Origin::{Assumed, Chosen, Published};
    let touches = touches(design);
    let on_silicone = |t: &&Touch| t.pin.is_none();
    let bare_deg: f64 =
        touches.iter().filter(on_silicone).map(|t| (t.to_rad - t.from_rad).to_degrees()).sum();
    vec![
        entry("groove_pitch", design.pitch_deg(), "deg", Published, "segment.span_deg / segment.grooves"),
        entry(
            "contact_radius",
            design.contact_radius_mm(),
            "mm",
            Assumed,
            "shell.outer_radius_mm + silicone.thickness_mm",
        ),
        entry(
            "inner_radius",
            design.inner_radius_mm(),
            "mm",
            Assumed,
            "shell.outer_radius_mm - shell.wall_mm",
        ),
        entry("land_on_shell", land, "mm", Assumed, "chord between groove centres less a groove"),
        entry(
            "end_wall",
            design.end_wall_mm(),
            "mm",
            Assumed,
            "half a land, segment.end_margin_mm, and the stop with its gap",
        ),
        entry(
            "layer_width",
            design.layer_width_mm(),
            "mm",
            Assumed,
            "shell.width_mm less both side clearances",
        ),
        entry("tendon_diameter", design.tendon_diameter_mm(), "mm", Published, "rope and twice its coating"),
        entry("slot_width", slot.width_mm, "mm", Chosen, "pins.diameter_mm + support.slot_clearance_mm"),
        entry(
            "slot_travel",
            slot.outer_mm - slot.inner_mm,
            "mm",
            Chosen,
            "from resting to flush, and support.travel_margin_mm",
        ),
        entry(
            "slot_depth",
            slot.depth_mm,
            "mm",
            Chosen,
            "support.plate_mm less support.slot_floor_mm if blind",
        ),
        entry(
            "support_radius",
            design.support_radius_mm(),
            "mm",
            Chosen,
            "resting pins' tops and support.rise_mm",
        ),
        entry(
            "pin_length",
            design.pin_length_mm(),
            "mm",
            Chosen,
            "width and both slots less pins.end_play_mm, rounded down to 0.5",
        ),
        entry(
            "fastener_radius",
            design.fastener_radius_mm(),
            "mm",
            Chosen,
            "middle of the wall under the grooves",
        ),
        entry(
            "unloaded_contact_beside_pins",
            bare_deg,
            "deg",
            Assumed,
            "where the unloaded, taut tendon lies on silicone or proxy, beside its pins",
        ),
    ]
}
