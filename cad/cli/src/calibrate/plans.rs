//! `--plan`: what tables were recorded for, as `experiment` wrote it.

use std::path::{Path, PathBuf};

use pinswitch_calibration::SessionPlan;
use pinswitch_calibration::effects::{EffectDefinition, Vocabulary};
use pinswitch_calibration::experiment::{PlannedRun, SCHEMA, by_contact, read_runs};
use pinswitch_calibration::table::PlateauTable;

use super::super::Failure;
use super::FORM;
use super::recorded::Recorded;
use crate::input::{read_file, read_text_file};

/// What each table after the first was recorded for, if a plan was given for it. Plans come in the order of their tables; which
/// table one belongs to, its runs tell.
pub(super) fn plans(
    plans: &[PathBuf],
    tables: &[PathBuf],
    vocabulary: &Vocabulary,
) -> Result<Vec<Option<SessionPlan>>, Failure> {
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
        let asked = plan(folder, vocabulary)?;
        // Each plan still to come needs a table of its own.
        let possible = next..later.len() - (plans.len() - 1 - i);
        let at = recorded_in(folder, &later[possible])? + next;
        found[at] = Some(asked);
        next = at + 1;
    }
    Ok(found)
}

/// What the plan in a folder asks.
fn plan(folder: &Path, vocabulary: &Vocabulary) -> Result<SessionPlan, Failure> {
    #[derive(serde::Deserialize)]
    struct PlanFile {
        schema: String,
        #[serde(flatten)]
        asked: SessionPlan,
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
    // That a plan has no runs is said before what it says of them.
    let (runs, _) = runs_of(folder)?;
    let form = form_of(folder)?;
    let is_known = |id: &str| {
        vocabulary.named(id).is_some() || form.as_ref().is_some_and(|form| form.named(id).is_some())
    };
    plan.asked.check(is_known).map_err(|e| refused(e.to_string()))?;
    Ok(SessionPlan { runs: by_contact(&runs), ..plan.asked })
}

/// The built-in effects with the form that a plan asks about, if there is one.
fn form_of(folder: &Path) -> Result<Option<Vocabulary>, Failure> {
    let path = folder_of(folder).join(FORM);
    if !path.is_file() {
        return Ok(None);
    }
    let (text, name) = (read_text_file(&path)?, path.display().to_string());
    Vocabulary::built_in().read(&text, &name).map(Some).map_err(Failure::bad_input)
}

/// A vocabulary with the forms whose coming again the plans ask about, unless they are in it under whatever name.
pub(super) fn with_forms(vocabulary: Vocabulary, plans: &[PathBuf]) -> Result<Vocabulary, Failure> {
    plans.iter().try_fold(vocabulary, |vocabulary, folder| {
        let Some(forms) = form_of(folder)? else { return Ok(vocabulary) };
        let is_known = |form: &EffectDefinition| {
            let is_it = |own: &EffectDefinition| {
                own.id == form.id || (own.formula == form.formula && own.drawn_from == form.drawn_from)
            };
            vocabulary.own().any(|own| is_it(own.definition()))
        };
        if forms.own().any(|form| is_known(form.definition())) {
            return Ok(vocabulary);
        }
        let path = folder_of(folder).join(FORM);
        vocabulary.read(&read_text_file(&path)?, &path.display().to_string()).map_err(Failure::bad_input)
    })
}

/// The folder of a plan, which may be given by a file in it.
fn folder_of(plan: &Path) -> &Path {
    if plan.is_file() { plan.parent().unwrap_or(plan) } else { plan }
}

/// The runs of a plan, and the file that they stand in.
fn runs_of(folder: &Path) -> Result<(Vec<PlannedRun>, String), Failure> {
    let path = folder_of(folder).join("next-runs.csv");
    let name = path.display().to_string();
    if !path.is_file() {
        return Err(Failure::bad_input(format!(
            "{name}: is not there, and it alone says which runs were planned; give the folder as `experiment` wrote it"
        )));
    }
    let runs = read_runs(&read_text_file(&path)?, &name).map_err(Failure::bad_input)?;
    Ok((runs, name))
}

/// What a table holds of the runs of a plan.
fn recorded(runs: &[PlannedRun], table: &Path) -> Result<Recorded, Failure> {
    let name = table.display().to_string();
    let table = PlateauTable::read(read_file(table)?.as_slice(), &name).map_err(Failure::bad_input)?;
    Ok(Recorded::of(runs, &table.rows))
}

/// Place of the table that holds most of a plan's runs; of equals the first. One that holds fewer than half of them was not
/// recorded by it.
fn recorded_in(folder: &Path, tables: &[PathBuf]) -> Result<usize, Failure> {
    let (runs, plan) = runs_of(folder)?;
    let mut best: Option<(usize, Recorded)> = None;
    for (at, table) in tables.iter().enumerate() {
        let found = recorded(&runs, table)?;
        if best.is_none_or(|(_, most)| found.made > most.made) {
            best = Some((at, found));
        }
    }
    let Some((at, found)) = best else { return Ok(0) };
    let Recorded { planned, made, .. } = found;
    let name = tables[at].display();
    if !found.is_by_plan() {
        let holds = match made {
            0 => format!("none of the {planned} runs of {plan} is in it"),
            _ => format!("only {made} of the {planned} runs of {plan} are in it"),
        };
        return Err(Failure::bad_input(format!(
            "{name}: {holds}; give the table of the planned session, with the loads, sweeps, speeds and dwells planned, or leave --plan out"
        )));
    }
    if made < planned {
        log::warn!("{name}: {} of the {planned} runs of {plan} are not in it", planned - made);
    }
    if !found.is_in_order() {
        log::warn!(
            "{name}: its series stand in another order than the runs of {plan}; the order is part of the experiment, and what comes with time or with the load before is told less surely"
        );
    }
    Ok(at)
}
