//! The next experiment: the runs with the most information about the open questions of a calibration
//! per minute of work.
//!
//! A question has two explanations of the readings: two effects, or an effect and none. Let `d` be
//! the difference of their predictions for some runs, in standard deviations of the noise with all its
//! random effects, without the part that the constants of the fitted explanation absorb. Its squared
//! length is that of T-optimality (Atkinson and Fedorov 1975):
//!
//! ```text
//! S  = min_b (x_a - X b)' V^-1 (x_a - X b)  =  x_a'V^-1 x_a - x_a'V^-1 X (X'V^-1 X)^-1 X'V^-1 x_a
//! dS = S(recorded and planned rows) - S(recorded rows)
//! ln odds(a, after)  =  ln odds(a, reported) + N(dS/2, dS)        if a is correct
//! I  = H(p) - E[H(p, after)]                                      in nats, at most H(p)
//! ```
//!
//! `x_a` is the contribution of explanation `a` to the readings, `X` are the columns of the constants
//! and of the other explanation, `V` is the covariance of the readings, `p` the reported probability
//! of an explanation and `H` its entropy. A plan maximizes the sum of the expected information `I`
//! (Lindley 1956) over all questions within the available time. A question is answered when the log
//! odds reach those of a reported effect. `model/doc/next-experiment.md` describes the choice of
//! runs.

mod candidates;
mod information;
mod plan;
mod question;
mod rig;
mod runs;
mod search;
mod whitening;

use nalgebra::DMatrix;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{published, sort_by_number};
use schemars::JsonSchema;
use serde::Serialize;

pub use candidates::paper_runs;
pub use rig::RigLimits;
pub use runs::{PlannedRun, by_contact, contact_words, read_runs, rows_of, write_runs};
pub use search::MOST_RUNS;

use crate::effects::{Covariate, Vocabulary};
use crate::evidence::MOUNT_SCALE;
use crate::model::{Model, Noise};
use crate::model_file::ModelFile;
use crate::report::Report;
use crate::session_plan::NONE;
use crate::table::{PlateauRow, Sweep};
use candidates::{Candidate, candidates};
use information::Design;
use plan::Planner;
use question::{Agenda, Question};
use search::Candidates;

/// Name and version of `experiment.json`.
pub const SCHEMA: &str = "pinswitch.experiment/1";
/// Purpose of a run with a heavier load before descending ones.
const LIFT: &str = "loads descend from here";
/// Probability below which a question is not answered by all runs of a rig together.
const ANSWERABLE: f64 = 0.5;

/// A question with the expected result of the runs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct QuestionOutlook {
    /// The two explanations: two ids, or an id and `none`.
    pub between: [String; 2],
    /// Size in question in the unit of the effect's first constant, for an effect against none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// Probability that the recorded data and these runs answer it.
    pub resolved_probability: f64,
    /// The same for the paper's protocol repeated for the same time.
    pub by_repeating: f64,
}

/// A question that no experiment on the rig answers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Unanswerable {
    /// The two explanations: two ids, or an id and `none`.
    pub between: [String; 2],
    /// Why.
    pub why: String,
}

/// Content of `experiment.json`, and the runs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Proposal {
    /// Name and version of the format.
    pub schema: &'static str,
    /// Duration of the runs in minutes.
    pub minutes: f64,
    /// Questions of the runs, by descending probability of an answer.
    pub questions: Vec<QuestionOutlook>,
    /// Questions that they cannot answer.
    pub unanswerable: Vec<Unanswerable>,
    /// The runs, in order.
    #[serde(skip)]
    pub runs: Vec<PlannedRun>,
}

/// Reason why no runs can be proposed; converts to a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The model file is invalid.
    Model(Diagnostic),
    /// Report, model and rows are not of one calibration; contains its name.
    Mismatch(String),
    /// No load is within the range of the load cell.
    CellTooSmall {
        /// Upper end of the range in newtons.
        limit_n: f64,
    },
    /// No run fits into the time.
    NoTime {
        /// Available time in minutes.
        minutes: f64,
        /// Duration of the shortest run in minutes.
        shortest: f64,
    },
}

impl From<&ExperimentError> for Diagnostic {
    fn from(error: &ExperimentError) -> Self {
        match error {
            ExperimentError::Model(error) => error.clone(),
            ExperimentError::Mismatch(name) => Self::new(
                codes::CALIBRATION_INCOMPLETE,
                "report.json, model.toml and residuals.csv are incomplete or from different calibrations",
            )
            .with_location(Location::file(name))
            .with_help("calibrate again"),
            ExperimentError::CellTooSmall { limit_n } => Self::new(
                codes::NO_RUN_FITS,
                "the load cell would exceed 90 % of its range at every load on every layout of the rig",
            )
            .with_location(Location::field("cell_limit_n", limit_n.to_string()))
            .with_help("raise it, or list lighter weights"),
            ExperimentError::NoTime { minutes, shortest } => Self::new(
                codes::NO_RUN_FITS,
                format!("no run fits into {minutes} minutes on this rig (the shortest takes {shortest:.1})"),
            )
            .with_help("give more --minutes, or shorter times in rig.toml"),
        }
    }
}

impl From<ExperimentError> for Diagnostic {
    fn from(error: ExperimentError) -> Self {
        Self::from(&error)
    }
}

impl From<Diagnostic> for ExperimentError {
    fn from(error: Diagnostic) -> Self {
        Self::Model(error)
    }
}

impl std::fmt::Display for ExperimentError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        Diagnostic::from(self).fmt(f)
    }
}

impl std::error::Error for ExperimentError {}

/// Results of a calibration: report, model and rows.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Content of `report.json`.
    pub report: &'a Report,
    /// Content of `model.toml`.
    pub model: &'a ModelFile,
    /// The fitted rows.
    pub rows: &'a [PlateauRow],
    /// The effects of the calibration.
    pub vocabulary: &'a Vocabulary,
    /// Name of the folder in errors.
    pub name: &'a str,
}

/// Proposes runs within a duration in minutes. The proposal is empty if the report leaves nothing
/// open.
///
/// # Errors
/// [`ExperimentError`] if report, model and rows are not of one calibration, or no run is within
/// the load cell's range or the time.
pub fn propose(known: Known<'_>, rig: &RigLimits, minutes: f64) -> Result<Proposal, ExperimentError> {
    let foreign = || ExperimentError::Mismatch(known.name.to_owned());
    // The wrap is that of the table, unless the rig's file gives another.
    let rig = &rig.clone().wrapped_by(usual_wrap_deg(known.rows));
    let (model, noise) = extended(known, rig)?;
    if known.report.data.rows != known.rows.len()
        || !is_of_one_calibration(known.report, &known.model.model(known.name)?)
    {
        return Err(foreign());
    }
    let highest_n = known.rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
    let agenda = Agenda::new(known.report, &model, highest_n);
    let design = Design { model: &model, noise, contributions: &agenda.contributions };
    let recorded = design.recorded(known.rows).ok_or_else(foreign)?;
    let recorded = agenda.without_unconfirmed(recorded);
    let questions = agenda.questions(&recorded);
    let all = candidates(&model, rig, &agenda);
    if all.is_empty() {
        return Err(ExperimentError::CellTooSmall { limit_n: rig.cell_limit_n });
    }
    let shortest = all.iter().map(|c| c.minutes(std::iter::empty(), rig)).fold(f64::INFINITY, f64::min);
    if shortest > minutes {
        return Err(ExperimentError::NoTime { minutes, shortest });
    }
    let candidates = Candidates::new(all, &design, rig, minutes, agenda.asks_of_previous_loads());
    let candidates = candidates.ok_or_else(foreign)?;
    let everything = candidates.information.iter().fold(recorded.clone(), |sum, one| sum + one);
    let (open, closed): (Vec<Question>, Vec<Question>) =
        questions.into_iter().partition(|q| q.answer_probability(&everything) >= ANSWERABLE);
    let planner = Planner {
        candidates: &candidates,
        design: &design,
        recorded: &recorded,
        questions: &open,
        rig,
        minutes,
    };
    let runs = planner.best_plan().ok_or_else(foreign)?;
    let with_runs = planner.after(&runs).ok_or_else(foreign)?;
    // Addition avoids the negative zero of an empty sum.
    let spent = 0.0 + runs.iter().map(|run| run.minutes).sum::<f64>();
    let repeated = planner.after(&paper_runs(rig, spent)).ok_or_else(foreign)?;
    let mut outlooks: Vec<QuestionOutlook> = open
        .iter()
        .map(|q| QuestionOutlook {
            between: q.between.clone(),
            size: q.size,
            resolved_probability: rounded(q.answer_probability(&with_runs)),
            by_repeating: rounded(q.answer_probability(&repeated)),
        })
        .collect();
    sort_by_number(&mut outlooks, |q| -q.resolved_probability);
    let unanswerable = closed.iter().map(|q| unanswerable(q, &everything, &agenda, minutes)).collect();
    Ok(Proposal {
        schema: SCHEMA,
        minutes: (100.0 * spent).round() / 100.0,
        questions: outlooks,
        unanswerable,
        runs,
    })
}

/// Returns whether a report contains the constants of a model, which shows that both are of one
/// calibration.
fn is_of_one_calibration(report: &Report, model: &Model) -> bool {
    let reported = &report.augmented.parameters;
    let agrees = |((name, _), value): ((String, &str), f64)| {
        reported.get(&name).is_none_or(|known| (known.value - value).abs() <= 1e-6 * value.abs().max(1e-9))
    };
    let names = model.names();
    reported.keys().all(|key| names.iter().any(|(name, _)| name == key))
        && names.into_iter().zip(model.values()).all(agrees)
}

/// Returns the wrap angle in degrees of most rows.
fn usual_wrap_deg(rows: &[PlateauRow]) -> f64 {
    let mut wraps: Vec<f64> =
        rows.iter().filter(|r| r.substrate.is_some()).map(|r| r.wrap_angle_deg).collect();
    wraps.sort_by(f64::total_cmp);
    let longest = wraps.chunk_by(|a, b| a == b).max_by_key(|chunk| chunk.len());
    longest.map_or(published::WRAP_ANGLE_DEG, |chunk| chunk[0])
}

/// Returns the model of a calibration with the contacts of the rig, and its noise.
fn extended(known: Known<'_>, rig: &RigLimits) -> Result<(Model, Noise), Diagnostic> {
    let model = known.model.model(known.name)?;
    // User-defined effects of the model are in its vocabulary already.
    let others = known.vocabulary.retaining(|own| model.vocabulary.named(&own.definition().id).is_none());
    let own: Vec<_> = others.own().cloned().collect();
    let all = model.vocabulary.with(own).unwrap_or_else(|_| model.vocabulary.clone());
    let model = model.among(&all);
    let mut frame = model.frame.clone();
    for candidate in paper_runs(rig, f64::INFINITY) {
        rows_of(std::slice::from_ref(&candidate), rig, "").iter().take(1).for_each(|row| frame.extend(row));
    }
    let mut noise = known.model.noise();
    if noise.mount_scale <= 0.0 {
        // Not estimated, but planned mounts differ as those of other rigs.
        noise.mount_scale = MOUNT_SCALE;
    }
    Ok((model.in_frame(frame), noise))
}

/// Returns the runs in the order in which they are made: early ones first, each contact mounted
/// once, with ascending and then descending loads. Includes their durations.
fn in_order<'a>(chosen: impl Iterator<Item = (&'a Candidate, String)>, rig: &RigLimits) -> Vec<PlannedRun> {
    let contacts = rig.contacts();
    let place = |run: &PlannedRun| contacts.iter().position(|contact| *contact == run.contact());
    let mut ordered: Vec<(Candidate, String)> =
        chosen.map(|(candidate, asks)| (candidate.clone(), asks)).collect();
    for place in 0..ordered.len() {
        if let Some(lift) = ordered[place].0.lift(ordered.iter().map(|(other, _)| other)) {
            ordered.push((lift, LIFT.to_owned()));
        }
    }
    ordered.sort_by(|(a, _), (b, _)| {
        let down = |c: &Candidate| c.run.sweep == Sweep::Down;
        let rising = a.run.load_mass_g.total_cmp(&b.run.load_mass_g);
        let by_load = if down(a) { rising.reverse() } else { rising };
        let pace = |c: &Candidate| (c.run.speed_pct, c.run.dwell_s);
        a.late
            .cmp(&b.late)
            .then(place(&a.run).cmp(&place(&b.run)))
            .then(down(a).cmp(&down(b)))
            .then(by_load)
            .then(pace(a).partial_cmp(&pace(b)).unwrap_or(std::cmp::Ordering::Equal))
    });
    let mut runs: Vec<PlannedRun> = Vec::new();
    let mut before: Option<&Candidate> = None;
    for (candidate, asks) in &ordered {
        let is_mounted = before.is_some_and(|b| b.shares_mount(candidate));
        let mount = runs.last().map_or(0, |run| run.mount) + usize::from(!is_mounted);
        let is_loaded = is_mounted && before.is_some_and(|b| b.run.load_mass_g == candidate.run.load_mass_g);
        let minutes = candidate.run.recording_minutes(rig)
            + if is_loaded { 0.0 } else { rig.minutes_per_load_change }
            + if is_mounted { 0.0 } else { rig.minutes_per_mount_change };
        // Rounded as in the file, so that the file adds up to the reported total.
        let minutes = (100.0 * minutes).floor() / 100.0;
        runs.push(PlannedRun { mount, minutes, asks: asks.clone(), ..candidate.run.clone() });
        before = Some(candidate);
    }
    runs
}

fn unanswerable(
    question: &Question,
    everything: &DMatrix<f64>,
    agenda: &Agenda,
    minutes: f64,
) -> Unanswerable {
    let [first, second] = &question.between;
    let most = 100.0 * question.answer_probability(everything);
    let does =
        if second == NONE { format!("identify {first}") } else { format!("separate {first} from {second}") };
    // An effect of time may appear later than a short session lasts.
    let within = if agenda.is_along(first, Covariate::Time) {
        format!("; no run is later than {minutes:.0} minutes into its session, so more --minutes may help")
    } else {
        String::new()
    };
    let why = format!(
        "all runs that this rig can make would together {does} with a probability of {most:.0} %{within}"
    );
    Unanswerable { between: question.between.clone(), why }
}

fn rounded(probability: f64) -> f64 {
    (1e3 * probability).round() / 1e3
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::effects::effect_named;
    use crate::evidence::Session;
    use crate::model::Term;
    use crate::table::Frame;
    use crate::test_session::{session, session_with};
    use crate::{Answer, SessionPlan, TrialOutcome, Verdict, calibrate};

    /// Content of a folder of `calibrate`.
    struct Calibrated {
        report: Report,
        model: ModelFile,
        rows: Vec<PlateauRow>,
        vocabulary: Vocabulary,
    }

    fn calibrated(rows: Vec<PlateauRow>, vocabulary: &Vocabulary) -> Calibrated {
        let found = calibrate(&rows, vocabulary, 1).unwrap();
        let model = ModelFile::new(&found.augmented);
        Calibrated { report: found.report, model, rows, vocabulary: vocabulary.clone() }
    }

    /// Returns whether a heavier run of the same mount precedes each run with descending loads.
    fn descends_from_somewhere(runs: &[PlannedRun]) -> bool {
        (0..runs.len()).filter(|i| runs[*i].sweep == Sweep::Down).all(|i| {
            let before = runs[..i].iter().filter(|run| run.mount == runs[i].mount);
            before.into_iter().any(|run| run.load_mass_g > runs[i].load_mass_g)
        })
    }

    /// Descending loads need a heavier load before them, at the cost of another run.
    #[test]
    fn loads_descend_from_a_heavier_one() {
        let rig = RigLimits::default();
        let run = PlannedRun { minutes: 0.0, ..paper_runs(&rig, 30.0).remove(0) };
        let of = |load_mass_g, sweep, after_g| Candidate {
            run: PlannedRun { load_mass_g, sweep, ..run.clone() },
            late: false,
            after_g,
        };
        let (up, down) = (of(2005.0, Sweep::Up, 1003.2), of(2005.0, Sweep::Down, 3007.2));
        let heavier = of(4007.8, Sweep::Up, 3007.2);
        let planned = |chosen: &[&Candidate]| {
            let runs = in_order(chosen.iter().map(|c| (*c, "asked".to_owned())), &rig);
            assert!(descends_from_somewhere(&runs), "{runs:?}");
            let before = |i: usize| chosen[..i].iter().copied();
            let told: f64 = (0..chosen.len()).map(|i| chosen[i].minutes(before(i), &rig)).sum();
            let spent: f64 = runs.iter().map(|run| run.minutes).sum();
            assert!(spent <= told + 1e-9, "{spent} {told}");
            runs
        };
        let lifted = planned(&[&up, &down]);
        assert_eq!(lifted.iter().map(|run| run.load_mass_g).collect::<Vec<_>>(), [2005.0, 3007.2, 2005.0]);
        assert!(lifted[1].sweep == Sweep::Up && lifted[1].asks == LIFT);
        assert_eq!(planned(&[&down, &heavier]).len(), 2);
        assert_eq!(planned(&[&down]).len(), 2);
    }

    fn proposed(calibrated: &Calibrated, rig: &RigLimits, minutes: f64) -> Proposal {
        let Calibrated { report, model, rows, vocabulary } = calibrated;
        propose(Known { report, model, rows, vocabulary, name: "d" }, rig, minutes).unwrap()
    }

    fn outlook<'a>(proposal: &'a Proposal, effect: &str) -> Option<&'a QuestionOutlook> {
        proposal.questions.iter().find(|q| q.between[0].starts_with(effect))
    }

    #[test]
    fn longer_plans_answer_more_questions() {
        let calibrated = calibrated(session(1), &Vocabulary::built_in());
        let rig = RigLimits::default();
        let (short, long) = (proposed(&calibrated, &rig, 9.0), proposed(&calibrated, &rig, 60.0));
        for (proposal, minutes) in [(&short, 9.0), (&long, 60.0)] {
            assert!(proposal.minutes <= minutes + 1e-9 && !proposal.runs.is_empty(), "{proposal:?}");
            assert!(proposal.runs.iter().all(|run| !run.asks.is_empty()));
            assert!(descends_from_somewhere(&proposal.runs), "{proposal:?}");
        }
        let sum = |p: &Proposal| p.questions.iter().map(|q| q.resolved_probability).sum::<f64>();
        assert!(sum(&long) >= sum(&short), "{:?} {:?}", short.questions, long.questions);
        let repeated: f64 = long.questions.iter().map(|q| q.by_repeating).sum();
        assert!(sum(&long) > repeated, "{:?}", long.questions);
        assert_eq!(proposed(&calibrated, &rig, 60.0), long);
        // A dwell that is constant in a session is confounded with the switch.
        let dwells: BTreeSet<_> = short.runs.iter().map(|run| run.dwell_s.to_bits()).collect();
        assert!(outlook(&short, "dwell_relaxation").is_some_and(|q| q.resolved_probability > 0.9));
        assert!(dwells.len() > 1, "{short:?}");
        let Calibrated { report, model, rows, vocabulary } = &calibrated;
        let known = Known { report, model, rows, vocabulary, name: "d" };
        let nothing = propose(known, &rig, 1.0).unwrap_err().to_string();
        assert!(nothing.contains("give more --minutes"), "{nothing}");
        let foreign = propose(Known { rows: &rows[1..], ..known }, &rig, 60.0).unwrap_err();
        assert_eq!(foreign, ExperimentError::Mismatch("d".to_owned()));
    }

    /// On bare silicone, drag of the rig and adhesion are the same. Runs on pins separate them, and
    /// the rig gives the predicted answers.
    #[test]
    fn planned_runs_separate_drag_and_adhesion() {
        for id in ["guide_drag", "adhesion"] {
            let truth = Term::named(effect_named(id).unwrap());
            let mut rows = session_with(1, &[(truth.clone(), &[0.4])]);
            rows.retain(|row| row.pins.is_empty());
            let calibrated = calibrated(rows, &Vocabulary::built_in());
            assert_eq!(calibrated.report.verdict, Verdict::Ambiguous);
            let silicone_only = RigLimits { layouts: Vec::new(), cell_limit_n: 60.0, ..RigLimits::default() };
            let proposal = proposed(&calibrated, &silicone_only, 60.0);
            let is_pair = |between: &[String; 2]| *between == ["guide_drag", "adhesion"];
            assert!(proposal.unanswerable.iter().any(|q| is_pair(&q.between)), "{proposal:?}");
            let proposal = proposed(&calibrated, &RigLimits::default(), 60.0);
            let question = proposal.questions.iter().find(|q| is_pair(&q.between)).unwrap();
            assert!(question.resolved_probability > 0.95 && question.by_repeating < 0.5, "{question:?}");
            assert_predicted_answers(&calibrated, &proposal, (truth, &[0.4]), id);
        }
    }

    /// The paper's protocol cannot show a dependence on speed, since speed follows load. Its rival is
    /// the compliance of the fixture.
    #[test]
    fn planned_runs_show_an_effect_of_speed() {
        let truth = Term::named(effect_named("rate_dependence").unwrap());
        let calibrated = after_few_loads((truth.clone(), &[0.2]), 1);
        let proposal = proposed(&calibrated, &RigLimits::default(), 30.0);
        let question = outlook(&proposal, "rate_dependence").unwrap();
        assert!(question.resolved_probability > 0.9 && question.by_repeating < 0.2, "{question:?}");
        assert_predicted_answers(&calibrated, &proposal, (truth, &[0.2]), "rate_dependence");
    }

    /// Neither effect is named where speed follows load, whichever of them the rig has.
    #[test]
    fn speed_and_compliance_stay_rivals_in_the_papers_protocol() {
        let effects = ["rate_dependence", "fixture_compliance"];
        for ((id, size), seed) in effects.into_iter().zip([0.2, 0.1]).flat_map(|e| [(e, 1), (e, 4)]) {
            let truth = Term::named(effect_named(id).unwrap());
            let report = after_few_loads((truth, &[size]), seed).report;
            let rivals = report.effects.first().map(|effect| (&effect.id, &effect.rivals[..]));
            let Some((named, [rival])) = rivals else { panic!("{id} {seed}: {rivals:?}") };
            assert_eq!(report.verdict, Verdict::Ambiguous, "{id} {seed}");
            assert!(effects.iter().all(|id| id == named || *id == rival.id), "{id} {seed}: {rivals:?}");
        }
    }

    /// Returns a calibration with every second load of the paper's protocol on a rig with a term.
    fn after_few_loads(truth: (Term, &[f64]), seed: u64) -> Calibrated {
        let loads_g = RigLimits::default().loads_g.into_iter().step_by(2).collect();
        let few_loads = RigLimits { loads_g, ..RigLimits::default() };
        let first = recorded(&[], &paper_runs(&few_loads, f64::INFINITY), truth, seed);
        calibrated(first, &Vocabulary::built_in())
    }

    /// Asserts that a rig with a term gives the answers that a plan predicts, and that the effect of
    /// this id alone is attributed.
    fn assert_predicted_answers(
        calibrated: &Calibrated,
        proposal: &Proposal,
        truth: (Term, &[f64]),
        id: &str,
    ) {
        let next = recorded(&calibrated.rows, &proposal.runs, truth, 7);
        let rows = [&calibrated.rows[..], &next[..]].concat();
        let after = calibrate(&rows, &calibrated.vocabulary, 1).unwrap().report;
        let ids: Vec<&str> = after.effects.iter().map(|effect| effect.id.as_str()).collect();
        assert_eq!((after.verdict, ids), (Verdict::Attributed, vec![id]), "{:?}", after.effects);
        let text = serde_json::to_string(proposal).unwrap();
        let plan: SessionPlan = serde_json::from_str(&text).unwrap();
        for question in plan.answered(&after, 49.0).questions {
            assert!(question.resolved_probability < 0.95 || question.answer != Answer::Open, "{question:?}");
        }
    }

    /// Returns the rows of runs on a rig with a term, whose mounts differ by 1.5 % and tendon seatings
    /// by 0.5 %, after the rows of earlier sessions.
    fn recorded(
        earlier: &[PlateauRow],
        runs: &[PlannedRun],
        (term, values): (Term, &[f64]),
        seed: u64,
    ) -> Vec<PlateauRow> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = |sd: f64| sd * ((0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0);
        let session = if earlier.is_empty() { "first" } else { "next" };
        let mut rows = rows_of(runs, &RigLimits::default(), session);
        let frame = Frame::new(&[earlier, &rows[..]].concat());
        let model = Model::baseline(frame).with_term(term, values);
        let points = model.frame.points(&rows).unwrap();
        let (readings, friction) = (model.predict(&points), model.friction_n(&points));
        let (mut mounts, mut seatings) = (BTreeMap::new(), BTreeMap::new());
        for (row, (reading, friction)) in rows.iter_mut().zip(readings.iter().zip(&friction)) {
            let mount = *mounts.entry(row.labels.mount.clone()).or_insert_with(|| normal(0.015));
            let seating = *seatings.entry(row.series.clone()).or_insert_with(|| normal(0.005));
            row.force_n = reading + (mount + seating) * friction + normal(0.05);
        }
        rows
    }

    /// Curves extend to heavier loads than the recorded ones, within the range of the load cell.
    #[test]
    fn heavier_loads_are_proposed_within_the_cell() {
        let mut rows = session(3);
        rows.retain(|row| row.load_mass_g < 3100.0);
        let calibrated = calibrated(rows, &Vocabulary::built_in());
        let rig = RigLimits { cell_limit_n: 65.0, ..RigLimits::default() };
        let proposal = proposed(&calibrated, &rig, 30.0);
        let question = outlook(&proposal, "friction_above_30_N").unwrap();
        assert!(question.resolved_probability > 0.9 && question.by_repeating < 0.2, "{question:?}");
        let planned = rows_of(&proposal.runs, &rig, "next");
        assert!(planned.iter().any(|row| row.load_n > 40.0));
        let (readings_n, _) = calibrated.model.predict(&planned, Session::New, "model.toml").unwrap();
        assert!(readings_n.iter().all(|reading| 1.1 * reading <= 65.0 + 0.5), "{readings_n:?}");
        let Calibrated { report, model, rows, vocabulary } = &calibrated;
        let known = Known { report, model, rows, vocabulary, name: "d" };
        let tiny = propose(known, &RigLimits { cell_limit_n: 0.1, ..rig }, 30.0);
        assert_eq!(tiny, Err(ExperimentError::CellTooSmall { limit_n: 0.1 }));
    }

    /// A rig with forty layouts and weights is planned in seconds.
    #[test]
    fn large_rigs_are_sampled() {
        let mut rows = session(1);
        rows.retain(|row| row.pins.is_empty());
        let calibrated = calibrated(rows, &Vocabulary::built_in());
        let layouts = (1..=8).flat_map(|i| (i + 3..=8 + i).map(move |j| vec![i, j]).take(5));
        let rig = RigLimits {
            loads_g: (1..=40).map(|i| 125.0 * f64::from(i)).collect(),
            layouts: layouts.collect(),
            ..RigLimits::default()
        };
        let proposal = proposed(&calibrated, &rig, 20.0);
        assert!(proposal.minutes <= 20.0, "{proposal:?}");
        assert!(proposal.questions.iter().any(|q| q.resolved_probability > 0.9), "{proposal:?}");
    }

    /// Readings from which an effect was derived do not answer whether it acts, however many.
    #[test]
    fn derived_effects_need_new_readings() {
        let text = "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"steeper\"\nside = \"switch\"\n\
                    covariate = \"speed\"\nacts_on = \"mu\"\ncombine = \"factor\"\n\
                    formula = \"a * (speed_pct - 50)/20\"\n\
                    parameters.a = { size = true, start = 0.1, unit = \"1\" }\n";
        let vocabulary = Vocabulary::built_in().read(text, "steeper.toml").unwrap();
        let mut calibrated = calibrated(session(1), &vocabulary);
        let rig = RigLimits::default();
        assert_eq!(calibrated.report.trials[0].outcome, TrialOutcome::Refuted);
        assert_eq!(outlook(&proposed(&calibrated, &rig, 30.0), "steeper"), None);
        calibrated.report.trials[0].outcome = TrialOutcome::Drawn;
        let proposal = proposed(&calibrated, &rig, 30.0);
        assert!(outlook(&proposal, "steeper").is_some_and(|q| q.resolved_probability > 0.9), "{proposal:?}");
        let speeds: BTreeSet<_> = proposal.runs.iter().map(|run| run.speed_pct.to_bits()).collect();
        assert!(speeds.len() > 1, "{proposal:?}");
    }
}
