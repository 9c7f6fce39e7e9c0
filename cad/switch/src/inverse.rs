//! From a wanted curve to configurations: patterns searched by the physics, the best judged by the law that `predict`
//! would use, printable ones only.

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use pinswitch_friction::layout_search::{LayoutCandidate, Search, Wanted};
use pinswitch_friction::{FrictionCurve, Law, PinPattern, Substrate, Transition, Trust};
use serde::Serialize;

use crate::config::Configuration;
use crate::design::Design;
use crate::parallel::map_each;
use crate::prediction::predicted_curve;

/// Candidates of the sweep that are judged by the law that predicts them, besides all even and centred ones.
const JUDGED: usize = 150;
/// Steps of the search over the pitch.
const PITCH_STEPS: u64 = 24;

/// A printable configuration and what its curve says.
#[derive(Clone, Debug, Serialize)]
pub struct Proposal {
    /// Occupied grooves.
    pub pins: Vec<usize>,
    /// Angle of the grooved sector, degrees: the published one unless the pitch was tuned.
    pub span_deg: f64,
    /// The law that predicts it.
    pub law: Law,
    /// How far to trust that.
    pub trust: Trust,
    /// Where it switches, N.
    pub transition: Option<Transition>,
    /// Friction at the heaviest load, N.
    pub friction_n: f64,
    /// Band of that friction, N.
    pub friction_band_n: [f64; 2],
    /// Friction at the heaviest load over that of its pins alone, by the physics.
    pub ratio: f64,
    /// Distance from what was wanted, see [`Wanted::miss`].
    pub miss: f64,
    /// What to expect of it: the miss and the half widths of the bands, as logarithms, added as squares. Ranks a layout
    /// that is known well before one that is only guessed to be closer.
    pub expected_miss: f64,
    /// Whether what was wanted lies within the bands.
    pub within_band: bool,
    /// The configuration.
    #[serde(skip)]
    pub configuration: Configuration,
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct SearchResult {
    /// Every pattern that differs in where it touches the tendon.
    pub candidates: Vec<LayoutCandidate>,
    /// Patterns of all grooves that these stand for.
    pub patterns: u64,
    /// Printable designs, best first.
    pub proposals: Vec<Proposal>,
}

/// The search that `design`'s grooves, wrap and loads allow, for this many pins.
pub fn search_for(design: &Design, pins: (usize, usize)) -> Search {
    let half = design.contact().wrap_rad() / 2.0;
    let numbered = design.groove_angles_rad().into_iter().enumerate().map(|(i, angle)| (i + 1, angle));
    let f = &design.configuration().friction;
    Search {
        // A pin outside the wrap carries nothing: patterns with one are no better than those without.
        grooves: numbered.filter(|(_, angle)| angle.abs() <= half).collect(),
        wrap_rad: design.contact().wrap_rad(),
        bed: *design.contact().bed(),
        loads_n: (f.load_min_n, f.load_max_n),
        pins,
    }
}

/// Searches all patterns for the `best` designs closest to `wanted`; `tune` also varies the pitch of each of them.
pub fn find(design: &Design, search: &Search, wanted: Wanted, best: usize, tune: bool) -> SearchResult {
    let candidates = search.sweep();
    let mut ranked: Vec<&LayoutCandidate> = candidates.iter().collect();
    let miss = |c: &LayoutCandidate| wanted.miss(c.threshold_n, c.friction_n);
    ranked.sort_by(|a, b| miss(a).total_cmp(&miss(b)));
    let configuration = design.configuration();
    let judged: Vec<&LayoutCandidate> = ranked
        .into_iter()
        .enumerate()
        .filter(|(rank, c)| *rank < JUDGED || is_even_and_centred(search, c))
        .map(|(_, c)| c)
        .collect();
    let proposals = map_each(judged, |c| {
        let mut with_pins = configuration.clone();
        with_pins.layout.pins.clone_from(&c.pins);
        propose(with_pins, wanted, c.ratio)
    });
    let mut proposals: Vec<Proposal> =
        proposals.into_iter().flatten().filter(|p| p.miss.is_finite()).collect();
    rank(&mut proposals);
    proposals.truncate(best);
    if tune {
        proposals = map_each(proposals, |p| tuned(p, wanted));
        rank(&mut proposals);
    }
    let untouched = configuration.segment.grooves - search.grooves.len();
    SearchResult { patterns: (candidates.len() as u64) << untouched.min(32), candidates, proposals }
}

/// Best first: those whose bands hold what was wanted, by what to expect of them; of equals, the one with fewer pins.
fn rank(proposals: &mut [Proposal]) {
    proposals.sort_by(|a, b| {
        (b.within_band.cmp(&a.within_band))
            .then_with(|| a.expected_miss.total_cmp(&b.expected_miss))
            .then_with(|| a.pins.len().cmp(&b.pins.len()))
    });
}

fn is_even_and_centred(search: &Search, candidate: &LayoutCandidate) -> bool {
    let angles = search.grooves.iter().filter(|(number, _)| candidate.pins.contains(number)).map(|g| g.1);
    let pattern = PinPattern::new(angles.collect());
    pattern.is_even() && pattern.is_centred()
}

/// The proposal of a configuration; `None` if it cannot be built.
fn propose(mut configuration: Configuration, wanted: Wanted, ratio: f64) -> Option<Proposal> {
    configuration.layout.substrate = Substrate::Silicone;
    let design = Design::new(configuration).ok()?;
    let curve: FrictionCurve = predicted_curve(&design);
    let transition = Transition::of(&curve);
    let last = |column: &[f64]| column.last().copied();
    let friction_n = last(&curve.friction_n)?;
    let friction_band_n = [last(&curve.band_low_n)?, last(&curve.band_high_n)?];
    let friction_met =
        wanted.friction_n.is_none_or(|w| (friction_band_n[0]..=friction_band_n[1]).contains(&w));
    let threshold_met =
        wanted.threshold_n.is_none_or(|w| transition.is_some_and(|t| (t.low_n..=t.high_n).contains(&w)));
    let miss = wanted.miss(transition.map(|t| t.threshold_n), friction_n);
    let half_width = |low: f64, high: f64| (high / low).ln() / 2.0;
    let friction_width =
        wanted.friction_n.map_or(0.0, |_| half_width(friction_band_n[0], friction_band_n[1]));
    let threshold_width = wanted.threshold_n.and(transition).map_or(0.0, |t| half_width(t.low_n, t.high_n));
    Some(Proposal {
        expected_miss: (miss.powi(2) + friction_width.powi(2) + threshold_width.powi(2)).sqrt(),
        pins: design.configuration().layout.pins.clone(),
        span_deg: design.configuration().segment.span_deg,
        law: curve.law,
        trust: curve.trust,
        transition,
        friction_n,
        friction_band_n,
        ratio,
        miss,
        within_band: friction_met && threshold_met,
        configuration: design.configuration().clone(),
    })
}

/// The miss as a function of the sector's angle, which sets the pitch.
struct Pitch<'a> {
    proposal: &'a Proposal,
    wanted: Wanted,
}

impl Pitch<'_> {
    fn at(&self, span_deg: f64) -> Option<Proposal> {
        let mut configuration = self.proposal.configuration.clone();
        configuration.segment.span_deg = span_deg;
        propose(configuration, self.wanted, self.proposal.ratio)
    }
}

impl CostFunction for Pitch<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, span_deg: &f64) -> Result<f64, argmin::core::Error> {
        // What cannot be built or does not switch is as bad as can be, but finite, as the optimiser needs it.
        Ok(self.at(*span_deg).map_or(1e3, |p| p.expected_miss.min(1e3)))
    }
}

/// The proposal with the pitch of its grooves varied by up to an eighth (Brent's method); itself if that gains nothing.
fn tuned(proposal: Proposal, wanted: Wanted) -> Proposal {
    let span = proposal.span_deg;
    let found =
        Executor::new(Pitch { proposal: &proposal, wanted }, BrentOpt::new(span * 0.875, span * 1.125))
            .configure(|state| state.max_iters(PITCH_STEPS))
            .run()
            .ok()
            .and_then(|result| result.state.best_param);
    // Hundredths of a degree are finer than any printer.
    let rounded = found.map(|span| (span * 100.0).round() / 100.0);
    match rounded.and_then(|span| Pitch { proposal: &proposal, wanted }.at(span)) {
        Some(better) if better.expected_miss < proposal.expected_miss => better,
        _ => proposal,
    }
}
