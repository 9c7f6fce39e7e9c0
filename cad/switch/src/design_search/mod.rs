//! The search for configurations that meet a request. It enumerates patterns, optimises continuous
//! parameters with a simplex, and ranks designs by the probability that a made part meets the
//! request. `cad/doc/design.md` explains every step.

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
pub use curve::{Curve, LoadState, Switching};
pub use kinds::differ_in_kind;
pub use linear::VarianceShare;
pub use probability::Probability;
pub use proposal::{Proposal, TargetResult};
pub use sensitivity::Sensitivity;

/// Largest number of curves that the enumeration computes.
const ENUMERATED: usize = 9_000;
/// Number of points in the space of continuous parameters at which patterns are enumerated, in
/// addition to the base.
const SPREAD_PLACES: usize = 5;
/// Simplex steps per parameter with guessed standard deviations.
const GUESSED_STEPS: u64 = 40;
/// Simplex steps per parameter with computed standard deviations.
const PROBABLE_STEPS: u64 = 14;
/// Number of candidates whose full probability is computed, in addition to the proposals.
const SPARE: usize = 3;

/// Options of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Number of designs to propose.
    pub best: usize,
    /// Number of simulated parts for a probability.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Number of patterns whose continuous parameters are optimised.
    pub starts: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { best: 5, draws: 1000, seed: 1, starts: 16 }
    }
}

/// Receives the progress of a search, possibly from several threads.
pub trait Progress: Sync {
    /// Reports the start of a stage with this number of steps.
    fn begin(&self, stage: &'static str, steps: usize);
    /// Reports a completed step.
    fn step(&self);
}

/// Ignores all progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _: &'static str, _: usize) {}
    fn step(&self) {}
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// Lightest and heaviest load of the search, N.
    pub range_n: (f64, f64),
    /// Number of different patterns of the grooves of the base. Mirror images count once.
    pub patterns: usize,
    /// Number of patterns whose curves were computed.
    pub tried: usize,
    /// Patterns of the base, for a plot.
    pub candidates: Vec<LayoutCandidate>,
    /// Designs whose best estimate meets the request, the most probable first; the nearest design
    /// if no design meets it.
    pub proposals: Vec<Proposal>,
    /// The reason why no design meets the request.
    pub blocked: Option<Blocked>,
}

/// Returns the lightest and the heaviest load for `request`: its own range, or that of the
/// configuration, extended to the loads and thresholds of the targets.
pub fn load_range_n(base: &Configuration, request: &Request) -> (f64, f64) {
    if let Some(range) = request.load_range_n {
        return range;
    }
    let (mut low, mut high) = (base.friction.load_min_n, base.friction.load_max_n);
    for target in &request.targets {
        let (least, most) = match (target.quantity, target.requirement) {
            (Quantity::Friction { load_n }, _) => (load_n, load_n),
            // Extended below the threshold, so that lighter loads exist.
            (Quantity::Threshold, Requirement::AtMost(most)) => (most / 1.2, most),
            (Quantity::Threshold, Requirement::AtLeast(least)) => (least, least * 1.2),
            (Quantity::Threshold, requirement) => requirement.interval(),
            _ => continue,
        };
        (low, high) = (low.min(least), high.max(most));
    }
    (low, high.min(1000.0))
}

/// Searches for designs that meet `request`, starting from `base`. Equal arguments give equal
/// results.
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

/// Returns the probability that a made part of `configuration` meets `request`, with another seed,
/// to verify a reported probability.
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

/// A configuration with its cost and its miss.
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

/// Returns the first `count` candidates, each a different design from all before it.
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

/// The result of the enumeration of patterns.
struct Enumerated {
    /// Places by ascending guessed cost.
    places: Vec<(f64, Place)>,
    patterns: usize,
    tried: usize,
    candidates: Vec<LayoutCandidate>,
}

/// Evaluates every pattern with every material, at the base and at points that cover the continuous
/// parameters.
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
        let mut curve = trial.belief.best(&part, &trial.loads_n)?;
        let cost = guessed_cost(trial, &trial.values(&mut curve, 1.0)?);
        let candidate = is_base.then(|| proposal::pictured(&mut curve, &place.pins, trial.range_n));
        Some((cost, place, candidate.flatten()))
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

/// Returns the starting points of the continuous search: the best places that are different
/// designs, then the best of the others.
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

/// Returns the smallest miss with any number of pins, and that number.
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
