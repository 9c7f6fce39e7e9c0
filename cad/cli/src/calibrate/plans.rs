//! `--plan`: what tables were recorded for, as `experiment` wrote it.

use std::path::{Path, PathBuf};

use pinswitch_calibration::Asked;
use pinswitch_calibration::effects::{EffectDefinition, Vocabulary};
use pinswitch_calibration::experiment::{PlannedRun, SCHEMA, read_runs};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_friction::published::load_n;

use super::super::Failure;
use super::FORM;
use crate::input::{read_file, read_text_file};

/// Share of a load by which a weight may differ from the one planned, hook and scale included.
const SAME_LOAD: f64 = 0.05;

/// Differences by which speed and dwell of a reading may differ from those planned, as shares of them.
const SAME_SETTING: f64 = 0.05;

/// What each table after the first was recorded for, if a plan was given for it. Plans come in the order of their tables; which
/// table one belongs to, its runs tell.
pub(super) fn plans(plans: &[PathBuf], tables: &[PathBuf]) -> Result<Vec<Option<Asked>>, Failure> {
    let later = tables.get(1..).unwrap_or_default();
    if plans.len() > later.len() {
        return Err(Failure::bad_input(format!(
            "--plan is given {} times and {} tables follow the first; give the tables in order, and a plan for each after it at most",
            plans.len(),
            later.len()
        )));
    }
    let mut found = vec![None; later.len()];
    let mut next = 0;
    for (i, folder) in plans.iter().enumerate() {
        let asked = plan(folder)?;
        // Each plan still to come needs a table of its own.
        let possible = next..later.len() - (plans.len() - 1 - i);
        let at = recorded_in(folder, &later[possible])? + next;
        recorded_by(folder, &later[at])?;
        found[at] = Some(asked);
        next = at + 1;
    }
    Ok(found)
}

/// What the plan in a folder asks.
fn plan(folder: &Path) -> Result<Asked, Failure> {
    #[derive(serde::Deserialize)]
    struct PlanFile {
        schema: String,
        #[serde(flatten)]
        asked: Asked,
    }
    // The file in the folder is meant as well.
    let path = if folder.is_file() { folder.to_owned() } else { folder.join("experiment.json") };
    let refused = |problem: String| {
        Failure::bad_input(format!("{}: {problem}; give the folder as `experiment` wrote it", path.display()))
    };
    let plan: PlanFile = serde_json::from_str(&read_text_file(&path)?).map_err(|e| refused(e.to_string()))?;
    if plan.schema != SCHEMA {
        return Err(refused(format!("schema = \"{}\" is not {SCHEMA}", plan.schema)));
    }
    Ok(plan.asked)
}

/// A vocabulary with the forms whose coming again the plans ask about, unless they are in it under whatever name.
pub(super) fn with_forms(vocabulary: Vocabulary, plans: &[PathBuf]) -> Result<Vocabulary, Failure> {
    plans.iter().try_fold(vocabulary, |vocabulary, folder| {
        let folder = if folder.is_file() { folder.parent().unwrap_or(folder) } else { folder };
        let path = folder.join(FORM);
        if !path.is_file() {
            return Ok(vocabulary);
        }
        let (text, name) = (read_text_file(&path)?, path.display().to_string());
        let forms = Vocabulary::built_in().read(&text, &name).map_err(Failure::bad_input)?;
        let is_known = |form: &EffectDefinition| {
            let is_it = |own: &EffectDefinition| {
                own.id == form.id || (own.formula == form.formula && own.drawn_from == form.drawn_from)
            };
            vocabulary.own().any(|own| is_it(own.definition()))
        };
        if forms.own().any(|form| is_known(form.definition())) {
            return Ok(vocabulary);
        }
        vocabulary.read(&text, &name).map_err(Failure::bad_input)
    })
}

/// The runs of a plan, and the file that they stand in; `None` where only its questions were kept.
fn runs_of(folder: &Path) -> Result<Option<(Vec<PlannedRun>, String)>, Failure> {
    let folder = if folder.is_file() { folder.parent().unwrap_or(folder) } else { folder };
    let path = folder.join("next-runs.csv");
    if !path.is_file() {
        return Ok(None);
    }
    let plan = path.display().to_string();
    let runs = read_runs(&read_text_file(&path)?, &plan).map_err(Failure::bad_input)?;
    Ok(Some((runs, plan)))
}

fn rows_of(table: &Path) -> Result<Vec<PlateauRow>, Failure> {
    let name = table.display().to_string();
    Ok(PlateauTable::read(read_file(table)?.as_slice(), &name).map_err(Failure::bad_input)?.rows)
}

/// Whether a row was recorded on the contact and at the load of a run.
fn is_at(run: &PlannedRun, row: &PlateauRow) -> bool {
    let load_n = load_n(run.load_mass_g);
    row.substrate == Some(run.substrate)
        && row.pins == run.pins
        && (row.load_n - load_n).abs() <= SAME_LOAD * load_n.max(1.0)
}

/// Place of the table that holds most of a plan's runs, with their speeds and dwells; of equals the first.
fn recorded_in(folder: &Path, tables: &[PathBuf]) -> Result<usize, Failure> {
    let Some((runs, _)) = runs_of(folder)?.filter(|_| tables.len() > 1) else { return Ok(0) };
    let is_made = |run: &PlannedRun, row: &PlateauRow| {
        is_at(run, row)
            && (row.speed_pct - run.speed_pct).abs() <= SAME_SETTING * run.speed_pct
            && (row.dwell_s - run.dwell_s).abs() <= SAME_SETTING * run.dwell_s
    };
    let mut best = (0, 0);
    for (at, table) in tables.iter().enumerate() {
        let rows = rows_of(table)?;
        let made = runs.iter().filter(|run| rows.iter().any(|row| is_made(run, row))).count();
        if made > best.1 {
            best = (at, made);
        }
    }
    Ok(best.0)
}

/// Whether a table holds the runs of a plan: contacts and loads that were proposed.
fn recorded_by(folder: &Path, table: &Path) -> Result<(), Failure> {
    let Some((runs, plan)) = runs_of(folder)? else { return Ok(()) };
    let (rows, name) = (rows_of(table)?, table.display());
    let missing = runs.iter().filter(|run| !rows.iter().any(|row| is_at(run, row))).count();
    if missing == runs.len() {
        return Err(Failure::bad_input(format!(
            "{name}: none of the {missing} runs of {plan} is in it; give the table that was recorded by the plan, or leave --plan out"
        )));
    }
    if missing > 0 {
        log::warn!("{name}: {missing} of the {} runs of {plan} are not in it", runs.len());
    }
    Ok(())
}
