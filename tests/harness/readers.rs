//! Every reader of foreign files, with the condition that it must satisfy for any bytes: one short
//! error, or a complete and consistent value.
//!
//! The fuzz targets (`fuzz/`), the tests of `tests/corpus` and the campaign use these readers.

#![allow(dead_code, missing_docs, unreachable_pub)]

use std::cell::RefCell;
use std::io::Cursor;
use std::path::Path;

use pinswitch_batch::{
    ConfigurationTable, Destination, MergeError, Observer, Options, Schema, Shard, Sweep, SweepSource,
    TableWriter, VariantOutcome, Variants, merge, mesh_file, partial_folder, read_rows, run,
};
use pinswitch_calibration::ModelFile;
use pinswitch_calibration::effects::{OwnEffect, Vocabulary, own_effects_text, read_own_effects};
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::experiment::RigLimits;
use pinswitch_calibration::segmentation::{Log, RunPlan, segment};
use pinswitch_calibration::table::PlateauTable;
use pinswitch_friction::Substrate;
use pinswitch_import::{Map, Output, Source, import};
use pinswitch_simulation::{Plan, simulate};
use pinswitch_solid::files::{read_stl, read_three_mf, stl_bytes};
use pinswitch_solid::validity::{Expectation, examine};
use pinswitch_switch::config::{Configuration, read, read_over, to_toml};
use pinswitch_switch::design::Design;
use pinswitch_switch::feasibility;
use pinswitch_switch::measured::Measured;
use pinswitch_switch::request::Request;
use sha2::{Digest, Sha256};

/// Largest number of characters of an error.
pub const LONGEST: usize = 600;
/// Name of the file in errors.
const FILE: &str = "given";

/// The result of a reader that satisfies its conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    Accepted,
    Refused,
}

/// A reader, by the name of its folder in `tests/corpus` and of its fuzz target.
pub struct Reader {
    pub name: &'static str,
    /// Reads the bytes; an error is a fault of the reader.
    pub judge: fn(&[u8]) -> Result<Reading, String>,
}

/// All readers.
pub const READERS: [Reader; 20] = [
    Reader { name: "configuration", judge: configuration },
    Reader { name: "preset", judge: preset },
    Reader { name: "request", judge: request },
    Reader { name: "run", judge: run_plan },
    Reader { name: "log", judge: log },
    Reader { name: "plateaus", judge: plateaus },
    Reader { name: "conditions", judge: conditions },
    Reader { name: "model", judge: model },
    Reader { name: "plan", judge: plan },
    Reader { name: "rig", judge: rig },
    Reader { name: "effects", judge: effects },
    Reader { name: "sweep", judge: sweep },
    Reader { name: "stl", judge: stl },
    Reader { name: "three_mf", judge: three_mf },
    Reader { name: "shard_table", judge: shard_table },
    Reader { name: "configurations", judge: configurations },
    Reader { name: "batch_files", judge: batch_files },
    Reader { name: "import", judge: import_file },
    Reader { name: "import_map", judge: import_map },
    Reader { name: "measured", judge: measured },
];

/// Reads bytes with the reader of that name.
///
/// # Errors
/// A fault of the reader.
pub fn judge(name: &str, bytes: &[u8]) -> Result<Reading, String> {
    let reader = READERS.iter().find(|reader| reader.name == name).ok_or(format!("no reader {name}"))?;
    (reader.judge)(bytes)
}

/// Returns the bytes as text. The command line refuses other bytes before any reader.
fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}

/// Returns a refusal, if its message is neither empty nor too long.
fn refused(error: &impl std::fmt::Display) -> Result<Reading, String> {
    let message = error.to_string();
    match message.chars().count() {
        0 => Err("an empty error".to_owned()),
        n if n >= LONGEST => Err(format!("an error of {n} characters: {message:.200}")),
        _ => Ok(Reading::Refused),
    }
}

fn require(is_true: bool, fault: impl FnOnce() -> String) -> Result<(), String> {
    if is_true { Ok(()) } else { Err(fault()) }
}

/// A question is a refusal; a result is repeated by the map that it gives.
fn import_file(bytes: &[u8]) -> Result<Reading, String> {
    let of = |map: &Map| import(&[Source::new(FILE, bytes)], map);
    let result = match of(&Map::default()) {
        Ok(result) => result,
        Err(e) => return refused(&e),
    };
    for question in &result.understanding.questions {
        refused(&question.to_diagnostic())?;
    }
    let Some(output) = result.output else { return Ok(Reading::Refused) };
    let text = result.map.to_toml();
    let map = Map::parse(&text, "written").map_err(|e| format!("the written map is refused: {e}\n{text}"))?;
    let again = of(&map).map_err(|e| format!("the written map cannot be used: {e}\n{text}"))?;
    // As text: a log may have values that are not numbers.
    let written = again.output.as_ref().map(Output::to_csv);
    require(written == Some(output.to_csv()), || format!("the written map has another result:\n{text}"))?;
    Ok(Reading::Accepted)
}

fn import_map(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let map = match Map::parse(text, FILE) {
        Ok(map) => map,
        Err(e) => return refused(&e),
    };
    let written = map.to_toml();
    let again = Map::parse(&written, "written").map_err(|e| format!("the written map is refused: {e}"))?;
    require(again == map, || format!("the written map has another content:\n{written}"))?;
    Ok(Reading::Accepted)
}

fn configuration(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let (configuration, _) = match read(text, FILE) {
        Ok(read) => read,
        Err(e) => return refused(&e),
    };
    let written = to_toml(&configuration);
    let (again, _) = read(&written, "written").map_err(|e| format!("the written file is refused: {e}"))?;
    require(again == configuration, || format!("the written file has another content:\n{written}"))?;
    match feasibility::design(configuration) {
        Ok(_) => Ok(Reading::Accepted),
        Err(e) => {
            let field = e.location().and_then(|location| location.field.as_deref());
            let known = Configuration::PARAMETERS.iter().any(|p| Some(p.path().as_str()) == field);
            require(known && e.help().is_some(), || format!("an error without field or help: {e}"))?;
            refused(&e)
        }
    }
}

fn preset(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let base = match read(text, FILE) {
        Ok((base, _)) => base,
        Err(e) => return refused(&e),
    };
    let (over, _) = read_over(base.clone(), "", "empty").map_err(|e| e.to_string())?;
    require(over == base, || "an empty configuration over a preset changes it".to_owned())?;
    Ok(Reading::Accepted)
}

fn request(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let request = match Request::read(text, FILE) {
        Ok(request) => request,
        Err(e) => return refused(&e),
    };
    require(!request.targets.is_empty(), || "a request without targets".to_owned())?;
    for target in &request.targets {
        let (low, high) = target.requirement.interval();
        require(low <= high && low.is_finite(), || format!("{target}: {low} to {high}"))?;
        require(target.to_string().chars().count() < LONGEST, || "a target without end".to_owned())?;
    }
    match request.check_loads(request.load_range_n.unwrap_or((2.5, 50.0))) {
        Ok(()) => Ok(Reading::Accepted),
        Err(e) => refused(&e),
    }
}

fn measured(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let measured = match Measured::read(text, FILE) {
        Ok(measured) => measured,
        Err(e) => return refused(&e),
    };
    let planned = Design::new(Configuration::default()).map_err(|e| e.to_string())?;
    let bed = *measured.apply(&planned).contact().bed();
    let lengths = [
        bed.contact_radius_mm,
        bed.tendon_radius_mm,
        bed.pin_diameter_mm,
        bed.groove_radius_mm,
        bed.layer_mm,
        bed.layer_width_mm,
        bed.modulus_mpa,
    ];
    require(lengths.iter().all(|x| x.is_finite() && *x > 0.0), || format!("{bed:?}"))?;
    Ok(Reading::Accepted)
}

fn run_plan(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let plan = match RunPlan::parse(text, FILE) {
        Ok(plan) => plan,
        Err(e) => return refused(&e),
    };
    for series in &plan.series {
        let Some(load_n) = series.load_n(&plan.rig) else { continue };
        // The range of a load in a plateau table.
        require((0.0..=1e5).contains(&load_n), || format!("a load of {load_n} N"))?;
        let mut pins = series.pins.clone();
        pins.sort_unstable();
        pins.dedup();
        require(pins.len() == series.pins.len(), || format!("pins {:?}", series.pins))?;
    }
    Ok(Reading::Accepted)
}

/// The rig of the paper.
pub const RIG: &str = "[rig]\nwrap_angle_deg=63.89\nsample_rate_hz=200.0\nhook_mass_g=62.53\nstroke_mm=152.4\n\
                       on_s=0.5\ndwell_s=3.0\n[[series]]\nfile=\"a.csv\"\nsubstrate=\"silicone\"\npins=[5, 8, 11]\n\
                       load_mass_g=251.2\nspeed_pct=47\nsweep=\"up\"\n";

fn log(bytes: &[u8]) -> Result<Reading, String> {
    let log = match Log::parse(bytes, FILE) {
        Ok(log) => log,
        Err(e) => return refused(&e),
    };
    require(log.time_s.is_sorted_by(|a, b| a < b), || "time steps back".to_owned())?;
    let plan = RunPlan::parse(RIG, "run.toml").map_err(|e| e.to_string())?;
    let segmentation = match segment(&log, &plan.rig, plan.series[0].load_n(&plan.rig)) {
        Ok(segmentation) => segmentation,
        Err(e) => return refused(&e),
    };
    for plateau in &segmentation.plateaus {
        let position_mm = plateau.position_mm.unwrap_or_default();
        let numbers = [plateau.force_n, position_mm, plateau.time_s, plateau.dwell_s];
        require(numbers.iter().all(|x| x.is_finite()), || format!("a plateau of {numbers:?}"))?;
    }
    for finding in &segmentation.findings {
        require(finding.to_string().chars().count() < LONGEST, || "a finding without end".to_owned())?;
    }
    Ok(Reading::Accepted)
}

fn plateaus(bytes: &[u8]) -> Result<Reading, String> {
    let table = match PlateauTable::read(bytes, FILE) {
        Ok(table) => table,
        Err(e) => return refused(&e),
    };
    for row in &table.rows {
        let numbers = [row.load_n, row.force_n, row.speed_pct, row.dwell_s, row.position_mm, row.time_s];
        require(numbers.iter().all(|x| x.is_finite()), || format!("a row of {numbers:?}"))?;
    }
    let written = table.with_columns(&[], &[], 0);
    let again = PlateauTable::read(written.as_bytes(), "written")
        .map_err(|e| format!("the written file is refused: {e}\n{written:.300}"))?;
    require(again.rows == table.rows, || format!("the written file has another content:\n{written:.300}"))?;
    match table.require_baseline(FILE) {
        Ok(()) => Ok(Reading::Accepted),
        Err(e) => refused(&e),
    }
}

fn conditions(bytes: &[u8]) -> Result<Reading, String> {
    match PlateauTable::read_conditions(bytes, FILE) {
        Ok(_) => Ok(Reading::Accepted),
        Err(e) => refused(&e),
    }
}

/// Rows of a plateau table with values at the ends of their ranges.
const ROWS: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
0,silicone,,up,251.2,3.0766,47,3,eccentric,1,6.93,3.5,2.3157
1,abs,5;8;11,down,251.2,30,0,0,concentric,2,-10,3.5,2.3157
2,silicone,5;8;11,up,0,100000,1000000,1000000,concentric,1000000,1000000,10000000000,1
3,silicone,3;5;7;9;11;13,up,0,0,50,3,concentric,1,152,-10000000000,1
4,plain,,up,0,10,50,3,concentric,1,152,1,1
";

fn model(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let model = match ModelFile::parse(text, FILE) {
        Ok(model) => model,
        Err(e) => return refused(&e),
    };
    let written = model.to_text().map_err(|e| e.to_string())?;
    let again =
        ModelFile::parse(&written, "written").map_err(|e| format!("the written file is refused: {e}"))?;
    require(again == model, || format!("the written file has another content:\n{written:.300}"))?;
    let rows = PlateauTable::read_conditions(ROWS.as_bytes(), "rows").map_err(|e| e.to_string())?.rows;
    // One row at a time, so that a refused row does not hide others.
    let mut reading = Reading::Accepted;
    for row in &rows {
        match model.predict(std::slice::from_ref(row), Session::New, FILE) {
            Ok((n, sd)) => require(n.iter().chain(&sd).all(|x| x.is_finite()), || format!("{n:?} {sd:?}"))?,
            Err(e) => reading = refused(&e)?,
        }
    }
    for pins in [&[][..], &[5, 8, 11]] {
        match model.part_curve(Substrate::Silicone, pins, &[0.0, 2.5, 50.0], FILE) {
            Ok(curve) => {
                let bands = curve.band_low_n.iter().chain(&curve.band_high_n);
                let mut numbers = curve.friction_n.iter().chain(bands);
                require(numbers.all(|x| x.is_finite()), || format!("{pins:?}: {curve:?}"))?;
            }
            // The table of the model had no pins, or no silicone.
            Err(e) if e.code().name() == "model-beyond-rig" => {}
            Err(e) => reading = refused(&e)?,
        }
    }
    Ok(reading)
}

/// Largest number of rows of a plan that is also simulated; larger plans are only read.
const MOST_ROWS: u64 = 3000;

fn plan(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let plan = match Plan::parse(text, FILE) {
        Ok(plan) => plan,
        Err(e) => return refused(&e),
    };
    let written = plan.to_text().map_err(|e| e.to_string())?;
    let again = Plan::parse(&written, "written").map_err(|e| format!("the written file is refused: {e}"))?;
    require(again == plan, || format!("the written file has another content:\n{written:.300}"))?;
    let settings = (1 + 2 * plan.layouts.len() as u64).saturating_mul(2 * plan.weights_g.len() as u64);
    let repetitions: u64 =
        plan.repetitions.iter().map(|n| u64::from(*n) + u64::from(plan.repetitions_spread)).sum();
    let rows = settings.saturating_mul(repetitions);
    // A plan that would fill the memory must be refused.
    require(rows <= 1_000_000, || format!("a plan of {rows} rows"))?;
    if rows <= MOST_ROWS {
        let simulated = simulate(&plan);
        if let Err(e) = simulated.check(FILE) {
            return refused(&e);
        }
        for row in simulated.rows.iter().chain(&simulated.fresh) {
            require(row.force_n.is_finite() && row.load_n.is_finite(), || format!("a row of {row:?}"))?;
        }
    }
    Ok(Reading::Accepted)
}

fn rig(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    match RigLimits::parse(text, FILE) {
        Ok(rig) => require(!rig.loads_g.is_empty(), || format!("{rig:?}")).map(|()| Reading::Accepted),
        Err(e) => refused(&e),
    }
}

/// Reads effects without adding them to a vocabulary, which would stay in memory.
fn effects(bytes: &[u8]) -> Result<Reading, String> {
    let Some(text) = text(bytes) else { return Ok(Reading::Refused) };
    let built_in = Vocabulary::built_in();
    let effects = match read_own_effects(text, FILE, &built_in) {
        Ok(effects) => effects,
        Err(e) => return refused(&e),
    };
    let written = own_effects_text(effects.iter().map(OwnEffect::definition));
    let again = read_own_effects(&written, "written", &built_in)
        .map_err(|e| format!("the written file is refused: {e}"))?;
    require(again == effects, || format!("the written file has another content:\n{written:.300}"))?;
    Ok(Reading::Accepted)
}

thread_local! {
    /// A temporary folder of the thread.
    static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) };
}

/// Calls a function with a temporary folder that exists as long as the thread.
fn in_folder<T>(act: impl FnOnce(&Path) -> Result<T, String>) -> Result<T, String> {
    FOLDER.with_borrow_mut(|folder| {
        if folder.is_none() {
            *folder = Some(in_memory()?);
        }
        folder.as_ref().map_or(Err("no folder".to_owned()), |folder| act(folder.path()))
    })
}

/// Creates a temporary folder, in memory on systems with `/dev/shm`.
pub fn in_memory() -> Result<tempfile::TempDir, String> {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).map_err(|e| e.to_string())
}

/// The file of rows that a sweep may cite.
const SWEEP_ROWS: &str = "\"shell.width_mm\",\"layout.pins\"\n14,\"[5, 8, 11]\"\n15,\"[4, 8, 12]\"\n";

fn sweep(bytes: &[u8]) -> Result<Reading, String> {
    let source = in_folder(|folder| {
        let (rows, path) = (folder.join("rows.csv"), folder.join("sweep.toml"));
        std::fs::write(rows, SWEEP_ROWS)
            .and_then(|()| std::fs::write(&path, bytes))
            .map_err(|e| e.to_string())?;
        Ok(SweepSource::read(&path))
    })?;
    let source = match source {
        Ok(source) => source,
        Err(e) => return refused(&e),
    };
    let sweep = match Sweep::new(&source) {
        Ok(sweep) => sweep,
        Err(e) => return refused(&e),
    };
    // The command line refuses more variants before it lists them.
    if sweep.count().is_none_or(|count| count > 10_000) {
        return Ok(Reading::Refused);
    }
    let variants = Variants::new(sweep, &source);
    let mut ids = std::collections::HashSet::new();
    for index in [0, variants.count() / 2, variants.count().saturating_sub(1)] {
        if index < variants.count() {
            let variant = variants.get(index);
            require(!variant.id.is_empty() && variant.id.len() < 256, || format!("id {:?}", variant.id))?;
            require(variant.index == index, || format!("variant {index} has index {}", variant.index))?;
            ids.insert(variant.id);
        }
    }
    require(variants.count() < 3 || ids.len() == 3, || format!("variants share ids: {ids:?}"))?;
    Ok(Reading::Accepted)
}

fn stl(bytes: &[u8]) -> Result<Reading, String> {
    let stl = match read_stl(&mut Cursor::new(bytes)) {
        Ok(stl) => stl,
        Err(e) => return refused(&e),
    };
    require(!stl.mesh.triangles.is_empty(), || "an STL without triangles".to_owned())?;
    if stl.mesh.triangles.len() > 20_000 {
        return Ok(Reading::Accepted);
    }
    let examination = examine(&stl.mesh, &Expectation::default());
    for fault in &examination.faults {
        let text = fault.to_string();
        require(!text.is_empty() && text.chars().count() < LONGEST, || format!("a fault: {text:.200}"))?;
        let at = fault.at_mm.iter().flatten();
        require(at.copied().all(f64::is_finite), || format!("a fault at {:?}", fault.at_mm))?;
    }
    let facts = &examination.facts;
    let numbers = facts.low_mm.iter().chain(&facts.high_mm).chain([&facts.volume_mm3]);
    require(numbers.copied().all(f64::is_finite), || format!("{facts:?}"))?;
    // A valid mesh must remain complete when it is written and read again.
    if examination.is_valid() {
        let written = stl_bytes(&stl.mesh).map_err(|e| e.to_string())?;
        let again =
            read_stl(&mut Cursor::new(written)).map_err(|e| format!("the written file is refused: {e}"))?;
        require(again.mesh.triangles.len() == stl.mesh.triangles.len(), || "facets are lost".to_owned())?;
    }
    Ok(Reading::Accepted)
}

/// Reads a 3MF and examines its meshes like an STL.
fn three_mf(bytes: &[u8]) -> Result<Reading, String> {
    let package = match read_three_mf(bytes) {
        Ok(package) => package,
        Err(e) => return refused(&e),
    };
    for fault in &package.faults {
        let text = fault.to_string();
        require(!text.is_empty() && text.chars().count() < LONGEST, || format!("a fault: {text:.200}"))?;
    }
    for object in package.meshes.iter().filter(|o| o.mesh.triangles.len() < 20_000) {
        let corners = object.mesh.positions.len();
        let inside = object.mesh.triangles.iter().flatten().all(|i| (*i as usize) < corners);
        require(inside, || "a triangle names a vertex that is not there".to_owned())?;
        examine(&object.mesh, &Expectation::default());
    }
    Ok(Reading::Accepted)
}

/// The sweep of the batches: two variants of one part.
const SMALL_SWEEP: &str = "[sweep]\nname = \"small\"\nparts = [\"coupon\"]\n[set]\n\"friction.points\" = 2\n\
                           [axes]\n\"tendon.length_mm\" = [200, 300]\n";

fn small_source() -> SweepSource {
    SweepSource {
        slice: false,
        verify: false,
        name: "small".to_owned(),
        file: "sweep.toml".to_owned(),
        sweep: SMALL_SWEEP.to_owned(),
        base: to_toml(&Configuration::default()),
        rows: None,
    }
}

/// Reads the rows of a table of configurations.
fn configurations(bytes: &[u8]) -> Result<Reading, String> {
    let rows = ConfigurationTable::read(bytes.to_vec(), FILE)
        .and_then(|table| Ok((table.first_rows(10_000)?, table.fields().len())));
    let (rows, columns) = match rows {
        Ok(read) => read,
        Err(e) => return refused(&e),
    };
    require(!rows.is_empty() && rows.iter().all(|row| row.len() == columns), || {
        "no rows, or a row of another width".to_owned()
    })?;
    Ok(Reading::Accepted)
}

/// Reads rows from a Parquet file, as a merge of shards does.
fn shard_table(bytes: &[u8]) -> Result<Reading, String> {
    let source = small_source();
    let sweep = Sweep::new(&source).map_err(|e| e.to_string())?;
    let schema = Schema::new(&sweep);
    let rows = match read_rows(bytes.to_vec(), &schema)
        .and_then(|rows| rows.take(10_000).collect::<Result<Vec<_>, _>>())
    {
        Ok(rows) => rows,
        Err(e) => return refused(&e),
    };
    require(rows.iter().all(|row| row.len() == schema.columns().len()), || {
        "a row of another width".to_owned()
    })?;
    in_folder(|folder| {
        let (csv, parquet) = (folder.join("t.csv"), folder.join("t.parquet"));
        let mut table = TableWriter::create(&schema, &csv, &parquet).map_err(|e| e.to_string())?;
        for row in &rows {
            table.push(row.clone()).map_err(|e| format!("the rows cannot be written: {e}"))?;
        }
        table.finish().map_err(|e| format!("the rows cannot be written: {e}"))
    })?;
    Ok(Reading::Accepted)
}

/// An observer that does nothing.
pub struct NullObserver;

impl Observer for NullObserver {
    fn variant_done(&self, _: &VariantOutcome) {}
    fn stop_requested(&self) -> bool {
        false
    }
}

/// Returns the JSON with a valid checksum, so that damage is not detected by its checksum.
pub fn sealed(json: &[u8]) -> Vec<u8> {
    let body = json.trim_ascii_end();
    let body = body.strip_suffix(b"}").unwrap_or(body).trim_ascii_end();
    let hash: String = Sha256::digest(body).iter().map(|b| format!("{b:02x}")).collect();
    [body, format!(",\n  \"checksum\": \"{hash}\"\n}}\n").as_bytes()].concat()
}

/// Returns the table of a finished shard. Its columns follow the parameters, so the file in the
/// corpus changes with them.
pub fn finished_shard_table() -> Result<Vec<u8>, String> {
    let shards = Shards::new()?;
    let table = shards.files.into_iter().find(|(name, _)| name.ends_with(".parquet"));
    table.map(|(_, bytes)| bytes).ok_or_else(|| "a shard without a table".to_owned())
}

/// Two finished shards of one variant each, and the table of their merge.
struct Shards {
    folder: tempfile::TempDir,
    /// Every file that a merge reads, with its bytes.
    files: Vec<(String, Vec<u8>)>,
    table: Vec<u8>,
}

fn open(folder: &Path) -> Result<Destination, String> {
    Destination::open(&folder.display().to_string(), &partial_folder(Shard::WHOLE)).map_err(|e| e.to_string())
}

impl Shards {
    fn new() -> Result<Self, String> {
        let folder = in_memory()?;
        let source = small_source();
        let sweep = Sweep::new(&source).map_err(|e| e.to_string())?;
        let variants = Variants::new(sweep, &source);
        let place = open(&folder.path().join("b"))?;
        for shard in ["1/2", "2/2"] {
            let shard = shard.parse().map_err(|e: pinswitch_batch::ShardError| e.to_string())?;
            let options = Options {
                shard,
                threads: 1,
                fail_fast: true,
                mesh_maker: mesh_file,
                slicer: None,
                kernel: None,
            };
            run(&variants, &source, &place, options, &NullObserver).map_err(|e| e.to_string())?;
        }
        let mut files = Vec::new();
        collect(&folder.path().join("b"), "", &mut files)?;
        files.sort();
        let mut shards = Self { folder, files, table: Vec::new() };
        shards.merge().map_err(|e| e.to_string())?;
        shards.table = shards.merged_table()?;
        Ok(shards)
    }

    /// Merges into a new folder.
    fn merge(&self) -> Result<(), MergeError> {
        let target = self.folder.path().join("m");
        let _ = std::fs::remove_dir_all(&target);
        let open = |folder: &Path| Destination::open(&folder.display().to_string(), ".partial-m");
        merge(&[open(&self.folder.path().join("b"))?], &open(&target)?).map(drop)
    }

    fn merged_table(&self) -> Result<Vec<u8>, String> {
        std::fs::read(self.folder.path().join("m/variants.csv")).map_err(|e| e.to_string())
    }
}

/// Collects every file below a folder, with its bytes.
fn collect(folder: &Path, prefix: &str, all: &mut Vec<(String, Vec<u8>)>) -> Result<(), String> {
    for entry in std::fs::read_dir(folder).map_err(|e| e.to_string())? {
        let entry = entry.map_err(|e| e.to_string())?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{name}/"), all)?;
        } else {
            all.push((name, std::fs::read(entry.path()).map_err(|e| e.to_string())?));
        }
    }
    Ok(())
}

thread_local! {
    static SHARDS: RefCell<Option<Shards>> = const { RefCell::new(None) };
}

/// Damages a file: replaces it, changes some bytes, truncates it, or deletes it (`None`).
fn damaged(whole: &[u8], how: u8, rest: &[u8]) -> Option<Vec<u8>> {
    let offset = |pair: &[u8]| pair.iter().fold(0, |n, b| 256 * n + usize::from(*b)) % whole.len().max(1);
    match how % 4 {
        0 => Some(rest.to_vec()),
        1 => {
            let mut bytes = whole.to_vec();
            for edit in rest.chunks_exact(3) {
                if let (Some(byte), [.., value]) = (bytes.get_mut(offset(&edit[..2])), edit) {
                    *byte ^= value;
                }
            }
            Some(bytes)
        }
        2 => Some(whole[..offset(rest.get(..2).unwrap_or_default())].to_vec()),
        _ => None,
    }
}

/// Damages a file of finished shards and merges them. The first byte selects the file, and whether
/// it gets a valid checksum; the second selects the damage. A merge that succeeds must give the
/// undamaged table.
fn batch_files(bytes: &[u8]) -> Result<Reading, String> {
    let [choice, how, rest @ ..] = bytes else { return Ok(Reading::Refused) };
    SHARDS.with_borrow_mut(|shards| {
        if shards.is_none() {
            *shards = Some(Shards::new()?);
        }
        let shards = shards.as_ref().ok_or("no shards")?;
        let (name, whole) = &shards.files[usize::from(choice >> 1) % shards.files.len()];
        let is_forged = choice & 1 == 1 && name.ends_with(".json");
        let content = damaged(whole, *how, rest).map(|bytes| if is_forged { sealed(&bytes) } else { bytes });
        let path = shards.folder.path().join("b").join(name);
        // Creates a new file, since parts are links to one file.
        std::fs::remove_file(&path).map_err(|e| e.to_string())?;
        let put = |bytes: &[u8]| std::fs::write(&path, bytes).map_err(|e| e.to_string());
        content.as_deref().map_or(Ok(()), put)?;
        let merged = shards.merge();
        let table = merged.as_ref().ok().map(|()| shards.merged_table());
        put(whole)?;
        match (merged, table) {
            (Err(e), _) => refused(&e),
            (Ok(()), table) => {
                let table = table.ok_or("no table")??;
                require(table == shards.table, || format!("a damaged {name} reached the table"))?;
                let is_kept = is_forged || content.as_ref() == Some(whole);
                require(is_kept, || format!("a damaged {name} was not detected"))?;
                Ok(Reading::Accepted)
            }
        }
    })
}
