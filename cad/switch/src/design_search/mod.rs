//! From a request to configurations: patterns by enumeration, continuous parameters by a simplex, ranked by the probability that
//! a made part meets the request. `cad/doc/design.md` explains every step.

mod belief;
mod blocked;
mod candidate;
mod curve;
mod kinds;
mod linear;
mod probability;
mod proposal;
mod refine;
mod relaxed;
mod sensitivity;
mod space;

use pinswitch_friction::layout_search::LayoutCandidate;
use pinswitch_friction::sort_by_number;

use crate::config::Configuration;
use crate::design::Design;
use crate::parallel::map_each;
use crate::request::{Quantity, Request, Requirement};
use candidate::Trial;
use linear::guessed_cost;
use refine::{Aim, Place, cost, refined};
use space::Space;

pub use belief::{Belief, Believed, ModelError, Part, PublishedPhysics};
pub use blocked::{Blocked, Change, Missed, Move};
pub use curve::{Curve, Switching};
pub use kinds::differ_in_kind;
pub use linear::VarianceShare;
pub use probability::Probability;
pub use proposal::{Proposal, TargetResult};
pub use sensitivity::Sensitivity;

/// Curves that the enumeration computes at the most.
const ENUMERATED: usize = 9_000;
/// Places of the continuous parameters at which patterns are enumerated, beside the base.
const SPREAD_PLACES: usize = 5;
/// Steps of the simplex with guessed standard deviations, for each parameter.
const GUESSED_STEPS: u64 = 40;
/// Steps of the simplex with the real ones, for each parameter.
const PROBABLE_STEPS: u64 = 14;
/// Candidates whose probability is computed in full, beyond those that are proposed.
const SPARE: usize = 3;

/// How a search is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How many designs to propose.
    pub best: usize,
    /// Made parts that are drawn for a probability.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Patterns whose continuous parameters are searched.
    pub starts: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { best: 5, draws: 1000, seed: 1, starts: 16 }
    }
}

/// Hears how far a search has come. It may be called from many threads.
pub trait Progress: Sync {
    /// A stage begins, of so many steps.
    fn begin(&self, stage: &'static str, steps: usize);
    /// One step of it is done.
    fn step(&self);
}

/// Hears nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &'static str, _: usize) {}
    fn step(&self) {}
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Lightest and heaviest load that it looked at, N.
    pub range_n: (f64, f64),
    /// Patterns that differ, mirror images counted once, of the base's grooves.
    pub patterns: usize,
    /// Curves of patterns that were computed.
    pub tried: usize,
    /// The base's patterns, for a picture.
    pub candidates: Vec<LayoutCandidate>,
    /// Designs that meet the request by the best guess, the most probable first; if there are none, the nearest one.
    pub proposals: Vec<Proposal>,
    /// Why there are none.
    pub blocked: Option<Blocked>,
}

/// The loads that `request` looks at: its own range or the configuration's, widened to the loads and thresholds that it names.
pub fn load_range_n(base: &Configuration, request: &Request) -> (f64, f64) {
    if let Some(range) = request.load_range_n {
        return range;
    }
    let (mut low, mut high) = (base.friction.load_min_n, base.friction.load_max_n);
    for target in &request.targets {
        let (least, most) = match (target.quantity, target.requirement) {
            (Quantity::Friction { load_n }, _) => (load_n, load_n),
            // Room under an early threshold, or no load is lighter than it.
            (Quantity::Threshold, Requirement::AtMost(most)) => (most / 1.2, most),
            (Quantity::Threshold, Requirement::AtLeast(least)) => (least, least * 1.2),
            (Quantity::Threshold, requirement) => requirement.interval(),
            _ => continue,
        };
        (low, high) = (low.min(least), high.max(most));
    }
    (low, high.min(1000.0))
}

/// Searches for designs that meet `request`, from `base`. The same arguments give the same answer.
pub fn search(
    base: &Design,
    request: &Request,
    belief: &dyn Belief,
    options: Options,
    progress: &dyn Progress,
) -> Found {
    let range_n = load_range_n(base.configuration(), request);
    let mut configuration = base.configuration().clone();
    (configuration.friction.load_min_n, configuration.friction.load_max_n) = range_n;
    let trial = Trial::new(request, belief, range_n, base.configuration().friction.points);
    let space = Space::new(&configuration, request);
    let enumerated = enumerate(&trial, &space, progress);
    let starts = starts(&space, &enumerated.places, options.starts);

    progress.begin("parameters", starts.len());
    let steps = |each: u64| each * (space.varied.len() as u64 + 1);
    let searched = map_each(starts.clone(), |start| {
        let near = refined(&trial, &space, &start, Aim::Guessed, steps(GUESSED_STEPS));
        let there = refined(&trial, &space, &near, Aim::Probable, steps(PROBABLE_STEPS));
        progress.step();
        [start, near, there]
    });
    let mut pool = judged(&trial, &space, searched.into_iter().flatten().collect());
    if !pool.iter().any(|c| c.meets) {
        progress.begin("nearest", starts.len());
        let nearest = map_each(starts, |start| {
            let there = refined(&trial, &space, &start, Aim::Nearest, steps(GUESSED_STEPS));
            progress.step();
            there
        });
        pool.extend(judged(&trial, &space, nearest));
    }
    let mut found = Found {
        range_n,
        patterns: enumerated.patterns,
        tried: enumerated.tried,
        candidates: enumerated.candidates,
        proposals: Vec::new(),
        blocked: None,
    };
    let relaxed = if pool.is_empty() { relaxed::nearest(&trial, &configuration) } else { None };
    let draws = probability::draws(options.seed, options.draws.max(1), belief.constants());
    let is_possible = pool.iter().any(|c| c.meets);
    if is_possible {
        pool.retain(|c| c.meets);
    }
    pool.sort_by(|a, b| a.pins().cmp(b.pins()));
    sort_by_number(&mut pool, |c| if is_possible { c.cost } else { c.miss });
    let wanted = if is_possible { options.best + SPARE } else { 1 };
    let kinds = distinct(pool, wanted);
    progress.begin("probabilities", kinds.len());
    let mut proposals: Vec<Proposal> = map_each(kinds, |c| {
        let proposal = proposal::propose(&trial, &c.configuration, &draws);
        progress.step();
        proposal
    })
    .into_iter()
    .flatten()
    .collect();
    sort_by_number(&mut proposals, |p| p.pins.len() as f64);
    sort_by_number(&mut proposals, |p| -p.probability.all);
    proposals.truncate(options.best);
    if let Some((nearest, blocked)) = relaxed {
        proposals.extend(proposal::propose(&trial, &nearest, &draws));
        found.blocked = Some(blocked);
    } else if !is_possible && let Some(nearest) = proposals.first() {
        let other = request.limits.pins.and_then(|_| with_any_pins(&trial, request, &configuration));
        found.blocked = Some(blocked::blocked(&trial, &space, &nearest.configuration, other));
    }
    found.proposals = proposals;
    found
}

/// How often made parts of `configuration` meet `request`, with draws of another seed: a check of a stated probability.
pub fn simulated(
    base: &Design,
    request: &Request,
    belief: &dyn Belief,
    draws: usize,
    seed: u64,
) -> Option<Probability> {
    let range_n = load_range_n(base.configuration(), request);
    let trial = Trial::new(request, belief, range_n, base.configuration().friction.points);
    probability::probability(
        &trial,
        base.configuration(),
        &probability::draws(seed, draws, belief.constants()),
    )
}

/// A place whose best guess is known.
struct Judged {
    configuration: Configuration,
    cost: f64,
    miss: f64,
    meets: bool,
}

impl Judged {
    fn pins(&self) -> &[usize] {
        &self.configuration.layout.pins
    }
}

fn judged(trial: &Trial<'_>, space: &Space, places: Vec<Place>) -> Vec<Judged> {
    map_each(places, |place| {
        let configuration = space.configuration(place.material, &place.pins, &place.at);
        let cost = cost(trial, space, &place, Aim::Probable)?;
        let values = trial.median(&configuration)?;
        Some(Judged { meets: trial.is_met(&values), miss: trial.miss(&values), cost, configuration })
    })
    .into_iter()
    .flatten()
    .collect()
}

/// The first `count` that differ in kind from all before them.
fn distinct(pool: Vec<Judged>, count: usize) -> Vec<Judged> {
    let mut taken: Vec<Judged> = Vec::new();
    for candidate in pool {
        if taken.len() == count {
            break;
        }
        if taken.iter().all(|t| differ_in_kind(&t.configuration, &candidate.configuration)) {
            taken.push(candidate);
        }
    }
    taken
}

/// What the enumeration of patterns found.
struct Enumerated {
    /// By guessed cost, least first.
    places: Vec<(f64, Place)>,
    patterns: usize,
    tried: usize,
    candidates: Vec<LayoutCandidate>,
}

/// Every pattern with every material, at the base and at places spread over the continuous parameters.
fn enumerate(trial: &Trial<'_>, space: &Space, progress: &dyn Progress) -> Enumerated {
    let mut points = vec![space.base()];
    if !space.varied.is_empty() {
        points.extend((1..=SPREAD_PLACES).map(|i| space.spread_point(i)));
    }
    let most = (ENUMERATED / (points.len() * space.materials.len())).max(20);
    let mut all = Vec::new();
    let mut patterns = 0;
    for (i, at) in points.iter().enumerate() {
        for material in 0..space.materials.len() {
            let found = space.patterns(material, at, most);
            if i == 0 && material == 0 {
                patterns = found.all;
            }
            all.extend(
                found
                    .taken
                    .into_iter()
                    .map(|pins| (i == 0 && material == 0, Place { material, pins, at: at.clone() })),
            );
        }
    }
    let tried = all.len();
    progress.begin("patterns", tried);
    let evaluated = map_each(all, |(is_base, place)| {
        progress.step();
        let configuration = space.configuration(place.material, &place.pins, &place.at);
        let part = trial.part(&configuration)?;
        let curve = trial.belief.curve(&part, &trial.loads_n, &vec![0.0; trial.belief.constants()])?;
        let cost = guessed_cost(trial, &trial.values(&curve, 1.0));
        let candidate = is_base.then(|| proposal::pictured(&curve, &place.pins, trial.range_n));
        Some((cost, place, candidate))
    });
    let mut candidates = Vec::new();
    let mut places = Vec::new();
    for (cost, place, candidate) in evaluated.into_iter().flatten() {
        candidates.extend(candidate);
        places.push((cost, place));
    }
    sort_by_number(&mut places, |(cost, _)| *cost);
    Enumerated { places, patterns, tried, candidates }
}

/// Where the continuous search begins: the best places that differ in kind, then the best of the rest.
fn starts(space: &Space, places: &[(f64, Place)], count: usize) -> Vec<Place> {
    let configuration = |p: &Place| space.configuration(p.material, &p.pins, &p.at);
    let mut taken: Vec<(Configuration, Place)> = Vec::new();
    for (_, place) in places {
        if taken.len() >= count {
            break;
        }
        let here = configuration(place);
        if taken.iter().all(|(there, _)| differ_in_kind(there, &here)) {
            taken.push((here, place.clone()));
        }
    }
    let kinds = taken.len();
    let rest = places.iter().map(|p| &p.1).take(count.saturating_sub(kinds) + kinds);
    let mut starts: Vec<Place> = taken.into_iter().map(|t| t.1).collect();
    for place in rest {
        let is_new =
            starts.iter().all(|s| s.pins != place.pins || s.at != place.at || s.material != place.material);
        if starts.len() < count && is_new {
            starts.push(place.clone());
        }
    }
    starts
}

/// The least miss with any number of pins, and that number.
fn with_any_pins(trial: &Trial<'_>, request: &Request, base: &Configuration) -> Option<(usize, f64)> {
    let mut free = request.clone();
    free.limits.pins = None;
    let space = Space::new(base, &free);
    let places = enumerate(trial, &space, &Silent).places;
    let best = starts(&space, &places, 4);
    map_each(best, |start| {
        let there = refined(trial, &space, &start, Aim::Nearest, GUESSED_STEPS);
        Some((there.pins.len(), cost(trial, &space, &there, Aim::Nearest)?))
    })
    .into_iter()
    .flatten()
    .min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests;
