//! `--plan`: the plans by which tables were recorded, as `experiment` wrote them.

use std::path::{Path, PathBuf};

use pinswitch_calibration::SessionPlan;
use pinswitch_calibration::effects::{EffectDefinition, Vocabulary};
use pinswitch_calibration::experiment::{PlannedRun, SCHEMA, by_contact, read_runs};
use pinswitch_calibration::table::PlateauTable;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_report::FORM_FILE;

use super::super::Failure;
use super::plan_match::PlanMatch;
use crate::input::{read_file, read_text_file};
use crate::terminal::warn;

/// Help for a folder that is not a complete plan.
const GIVE_PLAN: &str = "give the folder as `experiment` wrote it";

/// Returns the plan of each table after the first; `None` for a table without one. Plans are given in the order of their
/// tables; the runs of a plan decide which table it belongs to.
///
/// # Errors
/// [`Failure::bad_input`] if there are more plans than tables, a plan cannot be read, or no table contains its runs.
pub(super) fn plans(
    plans: &[PathBuf],
    tables: &[PathBuf],
    vocabulary: &Vocabulary,
) -> Result<Vec<Option<SessionPlan>>, Failure> {
    let later = tables.get(1..).unwrap_or_default();
    if plans.len() > later.len() {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::USAGE,
                format!("--plan is given {} times, but {} tables follow the first", plans.len(), later.len()),
            )
            .with_help("give the tables in order, and at most one plan for each table after the first"),
        ));
    }
    let mut of_tables = vec![None; later.len()];
    let mut next = 0;
    for (i, folder) in plans.iter().enumerate() {
        let plan = plan(folder, vocabulary)?;
        // Each remaining plan needs a separate table.
        let possible = next..later.len() - (plans.len() - 1 - i);
        let at = table_of(folder, &later[possible])? + next;
        of_tables[at] = Some(plan);
        next = at + 1;
    }
    Ok(of_tables)
}

/// Reads the plan in a folder.
fn plan(folder: &Path, vocabulary: &Vocabulary) -> Result<SessionPlan, Failure> {
    #[derive(serde::Deserialize)]
    struct PlanFile {
        schema: String,
        #[serde(flatten)]
        plan: SessionPlan,
    }
    // The file itself may be given instead of its folder.
    let path = if folder.is_file() { folder.to_owned() } else { folder.join("experiment.json") };
    let name = path.display().to_string();
    let file: PlanFile = serde_json::from_str(&read_text_file(&path)?).map_err(|e| {
        let problem =
            Diagnostic::new(codes::PLAN_NOT_USABLE, "not a plan").with_location(Location::file(&name));
        Failure::bad_input(problem.with_help(GIVE_PLAN).with_source(e))
    })?;
    if file.schema != SCHEMA {
        let location = Location::file(&name).with_field("schema", format!("\"{}\"", file.schema));
        return Err(Failure::bad_input(
            Diagnostic::new(codes::OTHER_KIND_OF_FILE, format!("is not {SCHEMA}"))
                .with_location(location)
                .with_help(GIVE_PLAN),
        ));
    }
    // Missing runs are reported before errors in the questions about them.
    let (runs, _) = runs_of(folder)?;
    let form = form_of(folder)?;
    let is_known = |id: &str| {
        vocabulary.named(id).is_some() || form.as_ref().is_some_and(|form| form.named(id).is_some())
    };
    file.plan.check(is_known).map_err(|e| {
        let error = e.or_in_file(&name);
        Failure::bad_input(if error.help().is_none() { error.with_help(GIVE_PLAN) } else { error })
    })?;
    Ok(SessionPlan { runs: by_contact(&runs), ..file.plan })
}

/// Returns the built-in effects with the form that a plan tests, if there is one.
fn form_of(folder: &Path) -> Result<Option<Vocabulary>, Failure> {
    let path = folder_of(folder).join(FORM_FILE);
    if !path.is_file() {
        return Ok(None);
    }
    let (text, name) = (read_text_file(&path)?, path.display().to_string());
    let vocabulary = Vocabulary::built_in().read(&text, &name);
    vocabulary.map(Some).map_err(Failure::bad_input)
}

/// Adds the forms that the plans test to a vocabulary, unless it defines them under any name.
///
/// # Errors
/// [`Failure::bad_input`] if the file of a form cannot be read.
pub(super) fn with_forms(vocabulary: Vocabulary, plans: &[PathBuf]) -> Result<Vocabulary, Failure> {
    plans.iter().try_fold(vocabulary, |vocabulary, folder| {
        let Some(forms) = form_of(folder)? else { return Ok(vocabulary) };
        let is_known = |form: &EffectDefinition| {
            let is_same = |own: &EffectDefinition| {
                own.id == form.id || (own.formula == form.formula && own.drawn_from == form.drawn_from)
            };
            vocabulary.own().any(|own| is_same(own.definition()))
        };
        if forms.own().any(|form| is_known(form.definition())) {
            return Ok(vocabulary);
        }
        let path = folder_of(folder).join(FORM_FILE);
        vocabulary.read(&read_text_file(&path)?, &path.display().to_string()).map_err(Failure::bad_input)
    })
}

/// Returns the folder of a plan, which may be given by a file in it.
fn folder_of(plan: &Path) -> &Path {
    if plan.is_file() { plan.parent().unwrap_or(plan) } else { plan }
}

/// Reads the runs of a plan; also returns the name of their file.
fn runs_of(folder: &Path) -> Result<(Vec<PlannedRun>, String), Failure> {
    let path = folder_of(folder).join("next-runs.csv");
    let name = path.display().to_string();
    if !path.is_file() {
        return Err(Failure::bad_input(
            Diagnostic::new(codes::PLAN_NOT_USABLE, "file not found; it lists the planned runs")
                .with_location(Location::file(name))
                .with_help(GIVE_PLAN),
        ));
    }
    let runs = read_runs(&read_text_file(&path)?, &name).map_err(Failure::bad_input)?;
    Ok((runs, name))
}

/// Matches a table with the runs of a plan.
fn match_table(runs: &[PlannedRun], table: &Path) -> Result<PlanMatch, Failure> {
    let name = table.display().to_string();
    let table = PlateauTable::read(read_file(table)?.as_slice(), &name).map_err(Failure::bad_input)?;
    Ok(PlanMatch::new(runs, &table.rows))
}

/// Returns the place of the table with most runs of a plan, the first of equals. Warns about missing runs and about
/// another order.
///
/// # Errors
/// [`Failure::bad_input`] if no table contains half of the runs.
fn table_of(folder: &Path, tables: &[PathBuf]) -> Result<usize, Failure> {
    let (runs, plan) = runs_of(folder)?;
    let mut best: Option<(usize, PlanMatch)> = None;
    for (at, table) in tables.iter().enumerate() {
        let candidate = match_table(&runs, table)?;
        if best.is_none_or(|(_, most)| candidate.made > most.made) {
            best = Some((at, candidate));
        }
    }
    let Some((at, best)) = best else { return Ok(0) };
    let PlanMatch { planned, made, .. } = best;
    let in_table = |problem: String| {
        Diagnostic::new(codes::PLAN_NOT_FOLLOWED, problem)
            .with_location(Location::file(tables[at].display().to_string()))
    };
    if !best.is_by_plan() {
        let problem = match made {
            0 => format!("contains none of the {planned} runs of {plan}"),
            _ => format!("contains only {made} of the {planned} runs of {plan}"),
        };
        return Err(Failure::bad_input(in_table(problem).with_help(
            "give the table of the planned session, with the planned loads, sweeps, speeds and dwells, or leave out --plan",
        )));
    }
    if made < planned {
        warn(in_table(format!("lacks {} of the {planned} runs of {plan}", planned - made)));
    }
    if !best.is_in_order() {
        warn(in_table(format!("the order of the series differs from that of the runs of {plan}")).with_help(
            "record the runs in order: another order weakens conclusions about time and about the previous load",
        ));
    }
    Ok(at)
}
