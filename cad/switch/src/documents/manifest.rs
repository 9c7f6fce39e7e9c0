//! `manifest.json`: settings, dimensions, parts, bill, prediction and files of a set, with hashes to verify them.

use pinswitch_diagnostic::codes;
use pinswitch_friction::{FrictionCurve, Law, PredictionStatus, Transition};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::{Bill, PlateEntry, PrintEntry, bill_of_materials};
use crate::config::{Choice, Configuration, Origin};
use crate::design::Design;
use crate::measured::Comparison;
use crate::output::{OutputFile, SetError};
use crate::parts::{Part, Touch, touches};
use crate::prediction::Prediction;
use crate::process::part_density_g_cm3;
use crate::warnings::Warning;
use pinswitch_solid::validity::MeshFacts;
use pinswitch_solid::verification::Verification;

/// A parameter of the configuration.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Setting {
    /// Field, such as `shell.width_mm`.
    pub field: String,
    /// Value.
    #[schemars(extend("type" = ["boolean", "number", "string", "array"]))]
    pub value: Value,
    /// Unit; empty for words and plain numbers.
    pub unit: &'static str,
    /// `published`, `assumed` or `chosen` for a default; `configured` for another value.
    pub origin: String,
    /// Meaning, and reason of the default.
    pub reason: &'static str,
}

/// A dimension that is derived from the settings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DerivedDimension {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// `published`, `assumed` or `chosen`: the least certain origin of its settings.
    pub origin: Origin,
    /// Its derivation.
    pub from: &'static str,
}

/// A printed part.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PartEntry {
    /// Name.
    pub name: String,
    /// STL file.
    pub file: String,
    /// Material (`process.material`).
    pub material: &'static str,
    /// Volume of the exact solid, mm³.
    pub volume_mm3: f64,
    /// Surface of the exact solid, mm².
    pub surface_mm2: f64,
    /// Mass when printed solid, g.
    pub mass_g: f64,
    /// Widest bridge in print orientation, mm.
    pub widest_bridge_mm: f64,
    /// Properties of the written mesh.
    pub mesh: MeshFacts,
    /// Agreement of the mesh with that of a second kernel, where that was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verification: Option<Verification>,
    /// Features that are left out, with changes that make room; also among the warnings.
    pub notes: Vec<String>,
}

/// The accuracy of all meshes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MeshBound {
    /// Chord tolerance, mm: the largest distance of a curve from its mesh.
    pub chord_tolerance_mm: f64,
    /// Largest relative error of the volume of a mesh, over all parts.
    pub largest_volume_error: f64,
}

/// The prediction at the heaviest load, with its law and status.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FrictionEntry {
    /// Law.
    pub law: Law,
    /// Prediction status.
    pub trust: PredictionStatus,
    /// Reasons of the status.
    pub reasons: Vec<String>,
    /// Source of the law.
    pub source: &'static str,
    /// SHA-256 of the model file from which the curve is predicted, hexadecimal; absent for another law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_sha256: Option<String>,
    /// Heaviest load of the curve, N.
    pub load_n: f64,
    /// Friction at that load, N.
    pub friction_n: f64,
    /// 95 % prediction band at that load, N.
    pub band_n: [f64; 2],
    /// Threshold: the load at which silicone carries half of the friction, N; absent if it is outside of the curve.
    pub threshold_n: Option<f64>,
    /// File of the curve.
    pub curve_file: &'static str,
    /// Predictions of the other laws that apply, at the same load.
    pub other_laws: Vec<LawEntry>,
}

/// The prediction of another law at the heaviest load.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LawEntry {
    /// Law.
    pub law: Law,
    /// Prediction status.
    pub trust: PredictionStatus,
    /// Reasons of the status.
    pub reasons: Vec<String>,
    /// Source of the law.
    pub source: &'static str,
    /// Friction, N.
    pub friction_n: f64,
    /// 95 % prediction band, N.
    pub band_n: [f64; 2],
}

/// A file of the set.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FileEntry {
    /// Name in the folder of the set.
    pub file: String,
    /// Size, bytes.
    pub bytes: usize,
    /// SHA-256, hexadecimal.
    pub sha256: String,
    /// In a batch: the shared file with this content.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
}

/// The configuration of a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SourceEntry {
    /// Name of the template, or path of the file from the folder of the set, with `/` on every machine. The path of a file is
    /// never the name of a template.
    pub name: String,
}

impl SourceEntry {
    /// The entry of a configuration with this name.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into() }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// The batch that contains a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct BatchEntry {
    /// SHA-256 of the sweep.
    pub sweep_sha256: String,
    /// Number of the variant in the sweep, from 0.
    pub index: u64,
    /// Engraved label.
    pub label: String,
}

/// The manifest of a set.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Manifest {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the set.
    pub name: String,
    /// Program and version.
    pub generator: String,
    /// Configuration, if it has a name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<SourceEntry>,
    /// Batch, for a set of a batch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub batch: Option<BatchEntry>,
    /// All parameters.
    pub settings: Vec<Setting>,
    /// Derived dimensions.
    pub derived: Vec<DerivedDimension>,
    /// Printed parts.
    pub parts: Vec<PartEntry>,
    /// Plates, if the set has 3MF files.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plates: Vec<PlateEntry>,
    /// Print time and filament, if the set is sliced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub print: Option<PrintEntry>,
    /// Accuracy of the meshes.
    pub mesh: MeshBound,
    /// Bill of materials.
    pub bill_of_materials: Bill,
    /// Prediction.
    pub friction: FrictionEntry,
    /// The made switch next to its plan, if it was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<Comparison>,
    /// Warnings, each with the parameter to change.
    pub warnings: Vec<Warning>,
    /// All other files of the set.
    pub files: Vec<FileEntry>,
}

impl Manifest {
    /// The manifest of a design with its printed parts and the properties of their meshes, without files.
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
                let note = |note| Warning::new(codes::FEATURE_LEFT_OUT, format!("{}: {note}", part.name));
                warnings.extend(entry.notes.iter().map(note));
                warnings.extend(part.thin_warning(design).map(|text| Warning::new(codes::THIN_PLACE, text)));
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
                trust: curve.status,
                reasons: curve.reasons.clone(),
                source: curve.law.source(),
                model_sha256: None,
                load_n: last(&curve.load_n),
                friction_n: last(&curve.friction_n),
                band_n: [last(&curve.band_low_n), last(&curve.band_high_n)],
                other_laws: prediction.others.iter().map(law_entry).collect(),
                threshold_n: Transition::of(curve).map(|t| t.threshold_n),
                curve_file: "friction.csv",
            },
            measured: None,
            warnings,
            files: Vec::new(),
        }
    }

    /// Returns the widest bridge of all parts, mm.
    pub fn widest_bridge_mm(&self) -> f64 {
        self.parts.iter().map(|p| p.widest_bridge_mm).fold(0.0, f64::max)
    }

    /// Returns the manifest as indented JSON.
    ///
    /// # Errors
    /// [`SetError::Encoding`] for a number that JSON cannot represent, which a valid design does not have.
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
        trust: curve.status,
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
        material: design.configuration().process.material.as_str(),
        volume_mm3,
        surface_mm2: part.solid.surface_mm2(),
        mass_g: volume_mm3 / 1000.0 * part_density_g_cm3(design.configuration()),
        widest_bridge_mm: part.widest_bridge_mm(),
        mesh: facts.clone(),
        verification: None,
        notes: part.notes(design),
    }
}

impl FileEntry {
    /// The entry of a file.
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
            let is_default = value.to_string() == (p.get)(&defaults).to_string();
            Setting {
                field: p.path(),
                value: toml_to_json(&value),
                unit: p.unit(),
                origin: if is_default { p.origin.to_string() } else { "configured".to_owned() },
                reason: p.reason,
            }
        })
        .collect()
}

/// Converts a TOML value to JSON.
pub fn toml_to_json(value: &toml_edit::Value) -> Value {
    match value {
        toml_edit::Value::Integer(i) => json!(i.value()),
        toml_edit::Value::Float(f) => json!(f.value()),
        toml_edit::Value::Boolean(b) => json!(b.value()),
        toml_edit::Value::Array(list) => list.iter().map(toml_to_json).collect(),
        other => json!(other.as_str().unwrap_or_default()),
    }
}

/// Returns all derived dimensions of a design.
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
        entry("land_on_shell", land, "mm", Assumed, "chord between groove centres minus a groove"),
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
            "shell.width_mm minus both side clearances",
        ),
        entry("tendon_diameter", design.tendon_diameter_mm(), "mm", Published, "rope and twice its coating"),
        entry("slot_width", slot.width_mm, "mm", Chosen, "pins.diameter_mm + support.slot_clearance_mm"),
        entry(
            "slot_travel",
            slot.outer_mm - slot.inner_mm,
            "mm",
            Chosen,
            "from the resting to the flush position, and support.travel_margin_mm",
        ),
        entry(
            "slot_depth",
            slot.depth_mm,
            "mm",
            Chosen,
            "support.plate_mm, minus support.slot_floor_mm if blind",
        ),
        entry(
            "support_radius",
            design.support_radius_mm(),
            "mm",
            Chosen,
            "tops of the resting pins and support.rise_mm",
        ),
        entry(
            "pin_length",
            design.pin_length_mm(),
            "mm",
            Chosen,
            "width and both slots minus pins.end_play_mm, rounded down to 0.5",
        ),
        entry(
            "fastener_radius",
            design.fastener_radius_mm(),
            "mm",
            Chosen,
            "middle of the wall under the grooves",
        ),
        entry(
            "unloaded_contact_outside_pins",
            bare_deg,
            "deg",
            Assumed,
            "contact of the unloaded, taut tendon with silicone or proxy",
        ),
    ]
}
