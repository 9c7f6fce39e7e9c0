//! `pinswitch schema`.

use std::collections::BTreeMap;

use clap::{Args, ValueEnum};
use pinswitch_batch::{Estimate, ShardStamp, Stamp, Tally};
use pinswitch_calibration::effects::effects_schema;
use pinswitch_calibration::experiment::{Proposal, RigLimits};
use pinswitch_calibration::segmentation::{RunPlan, SegmentationReport};
use pinswitch_calibration::{Explanation, Report};
use pinswitch_import::Understanding;
use pinswitch_robot::Surface;
use pinswitch_simulation::{Faults, Plan, Power, StudiedRig};
use pinswitch_slicer::Slicing;
use pinswitch_solid::file_check::Verdict;
use pinswitch_switch::documents::Manifest;
use pinswitch_switch::{config, measured, request};
use schemars::schema_for;

use super::init::CONFIGURATIONS;
use super::provenance::Provenance;
use super::report_schema::{perhaps_with_checksum, written, written_with_checksum};
use super::terminal::{FailureReport, to_json};
use super::{Failure, design, effects, explain, finger, layouts, physics, predict, print_data, tolerances};

/// Print the JSON Schema of a file that you write, or of a report that the program writes.
///
/// With that of a file, an editor completes and checks TOML: keep it next to your files, and name it in their first line,
/// `#:schema ./switch.schema.json`; `pinswitch init NAME --schema` does both. With that of a report, a program checks what it reads, or makes its own types from it.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch schema configuration > switch.schema.json
  pinswitch schema calibration-report > report.schema.json")]
pub(super) struct Arguments {
    /// Kind of file or report.
    #[arg(value_enum)]
    kind: Kind,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// A configuration, as for `generate`.
    Configuration,
    /// Effects of your own, as for `calibrate --effects`.
    Effects,
    /// A map of an import, as for `import --map`.
    Import,
    /// The readings of a made switch, as for `--measured`.
    Measured,
    /// A synthetic rig, as for `simulate`.
    Plan,
    /// A request, as for `design --request`.
    Request,
    /// The limits of a rig, as for `experiment --rig`.
    Rig,
    /// The logs of a run, as for `segment`.
    Run,
    /// A sweep, as for `batch`.
    Sweep,
    /// The estimate of a batch, from `batch --dry-run --json`.
    BatchEstimate,
    /// The sweep of a batch, batch.json of `batch`.
    BatchRecord,
    /// The totals of a batch, from `batch --json` and `merge --json`.
    BatchTally,
    /// A calibration, from `calibrate --json` and report.json.
    CalibrationReport,
    /// Verdicts on mesh files, from `check --json`.
    CheckReport,
    /// Designs for a request, from `design --json` and design.json.
    DesignReport,
    /// The effects that a calibration tests, from `effects --json`.
    EffectsReport,
    /// The next runs, from `experiment --json` and experiment.json.
    ExperimentReport,
    /// The pages of codes, from `explain --json`.
    ExplainReport,
    /// Why a command stopped, from any command with --json that fails.
    Failure,
    /// A finger with a switch, from `finger --json` and finger.json.
    FingerReport,
    /// What an import understood, from `import --json`.
    ImportReport,
    /// Published layouts and templates, from `layouts --json`.
    LayoutsReport,
    /// A set, from `generate --json` and manifest.json, also of a batch.
    Manifest,
    /// The physics, from `physics --json` and physics.json.
    PhysicsReport,
    /// The power of a plan, from `power --json`.
    PowerReport,
    /// A predicted curve, from `predict --json`.
    PredictionReport,
    /// Origin of the files of a folder, from `simulate --json` and provenance.json of `calibrate` and others.
    Provenance,
    /// A calibration on the published maxima, from `calibrate --published --json` and published.json.
    PublishedReport,
    /// The segmented logs of a run, from `segment --json` and its JSON file.
    SegmentationReport,
    /// A finished block of a batch, shard.json of `batch --shard`.
    ShardRecord,
    /// The faults of simulated logs, faults.json of `simulate --raw`.
    SimulatedFaults,
    /// Print time and filament, slicing.json of `generate --slice`.
    SlicingReport,
    /// Outcomes of simulated rigs, from `simulate --study --json`.
    StudyReport,
    /// Tensions over load and wrap angle, from `export --json` and switch.json.
    TensionTable,
    /// The scatter of the threshold, from `tolerances --json` and tolerances.json.
    TolerancesReport,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    print_data(&schema_of(arguments.kind)?)
}

/// Returns the schema of the files that start with `init`; `None` for a name that `init` writes as a table.
pub(super) fn schema_of_example(name: &str) -> Result<Option<Vec<u8>>, Failure> {
    let kind = match Kind::from_str(name, false) {
        Ok(kind) => kind,
        Err(_) if name == CONFIGURATIONS => return Ok(None),
        Err(_) => Kind::Configuration,
    };
    schema_of(kind).map(Some)
}

/// Returns a schema as JSON.
fn schema_of(kind: Kind) -> Result<Vec<u8>, Failure> {
    let schema = match kind {
        Kind::Configuration => return to_json(&config::json_schema()),
        Kind::Measured => return to_json(&measured::json_schema()),
        Kind::Sweep => return to_json(&pinswitch_batch::json_schema()),
        Kind::Effects => effects_schema(),
        Kind::Import => pinswitch_import::map_schema(),
        Kind::Plan => schema_for!(Plan),
        Kind::Request => request::request_schema(),
        Kind::Rig => schema_for!(RigLimits),
        Kind::Run => schema_for!(RunPlan),
        Kind::BatchEstimate => written::<Estimate>("Estimate of a batch"),
        Kind::BatchRecord => written_with_checksum::<Stamp>("Sweep of a batch"),
        Kind::BatchTally => written::<Tally>("Totals of a batch"),
        Kind::CalibrationReport => written::<Report>("Report of a calibration"),
        Kind::CheckReport => written::<Vec<Verdict>>("Verdicts on mesh files"),
        Kind::DesignReport => written::<design::Report<'_>>("Designs for a request"),
        Kind::EffectsReport => written::<Vec<effects::ListedEffect>>("Effects that a calibration tests"),
        Kind::ExperimentReport => written::<Proposal>("Plan of the next runs"),
        Kind::ExplainReport => written::<explain::Pages>("Pages of codes"),
        Kind::Failure => written::<FailureReport<'_>>("Failure of a command"),
        Kind::FingerReport => written::<finger::Report>("Finger with a friction switch"),
        Kind::ImportReport => written::<Understanding>("Understanding of an import"),
        Kind::LayoutsReport => written::<layouts::Listing>("Published layouts and templates"),
        Kind::Manifest => perhaps_with_checksum::<Manifest>("Manifest of a set"),
        Kind::PhysicsReport => written::<physics::Report>("Physics of the friction switch"),
        Kind::PowerReport => written::<Vec<Power>>("Power of a plan"),
        Kind::PredictionReport => written::<predict::Output>("Predicted friction curve"),
        Kind::Provenance => written_with_checksum::<Provenance>("Origin of the files of a folder"),
        Kind::PublishedReport => written::<Vec<Explanation>>("Calibration on the published maxima"),
        Kind::SegmentationReport => written::<SegmentationReport>("Segmented logs of a run"),
        Kind::ShardRecord => written_with_checksum::<ShardStamp>("Finished block of a batch"),
        Kind::SimulatedFaults => written::<BTreeMap<String, Faults>>("Faults of simulated logs"),
        Kind::SlicingReport => written::<Slicing>("Print time and filament of a set"),
        Kind::StudyReport => written::<Vec<StudiedRig>>("Outcomes of simulated rigs"),
        Kind::TensionTable => written::<Surface>("Tensions over load and wrap angle"),
        Kind::TolerancesReport => written::<tolerances::Report>("Scatter of the threshold"),
    };
    to_json(&schema)
}
