//! The nearest design that can be printed, for a request that no printable design satisfies. Limits
//! of size become soft first; then the number of pins is free, and finally all parameters are.

use super::blocked::{self, Blocked, Change};
use super::candidate::Trial;
use super::refine::{Aim, cost, refined};
use super::space::Space;
use super::{GUESSED_STEPS, Silent, enumerate, starts};
use crate::config::Configuration;
use crate::parallel::map_each;
use crate::request::{Parameter, Request, Varied};

/// Patterns whose parameters are searched.
const STARTS: usize = 4;

/// Returns the nearest design, and the reason why the request excludes it; `None` if no
/// configuration near `base` can be printed.
pub(super) fn nearest(original: &Trial<'_>, base: &Configuration) -> Option<(Configuration, Blocked)> {
    let within = Space::new(base, original.request);
    let (refused, why) = refusal(original, &within);
    relaxations(original.request, base).iter().find_map(|request| {
        let trial = original.with_soft_sizes(request);
        let space = Space::new(base, request);
        let mut places = enumerate(&trial, &space, &Silent).places;
        places.retain(|(_, p)| trial.keeps_limits(&space.configuration(p.material, &p.pins, &p.at)));
        let steps = GUESSED_STEPS * (space.varied.len() as u64 + 1);
        let (_, nearest) = map_each(starts(&space, &places, STARTS), |start| {
            let there = refined(&trial, &space, &start, Aim::Nearest, steps);
            let miss = cost(&trial, &space, &there, Aim::Nearest)?;
            Some((miss, space.configuration(there.material, &there.pins, &there.at)))
        })
        .into_iter()
        .flatten()
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut blocked = blocked::blocked(&trial, &within, &nearest, None);
        blocked.limit = original.broken_limit(&nearest).unwrap_or_else(|| why.clone());
        if blocked.missed.is_empty() {
            blocked.together = excluded_changes(original.request, &refused, &nearest);
        }
        Some((nearest, blocked))
    })
}

/// Returns the configuration at the start of the search, and the limit or the rule that excludes
/// it, with field, value and bound.
fn refusal(original: &Trial<'_>, space: &Space) -> (Configuration, String) {
    let base = space.base();
    let patterns = space.patterns(0, &base, 1).taken;
    let Some(pins) = patterns.first() else {
        let (fewest, most) = original.request.limits.pins.unwrap_or_default();
        let why = format!(
            "limits.pins = {fewest}..{most}: fewer grooves are under the tendon; request fewer pins (--pins) or raise \
             layout.wrap_angle_deg"
        );
        return (space.materials[0].clone(), why);
    };
    let c = space.configuration(0, pins, &base);
    let why = match original.broken_limit(&c) {
        Some(limit) => limit,
        None if original.part(&c).is_none() => format!(
            "layout.pins = {:?}, which vary.pattern = false (--keep-pins) keeps: the tendon must touch all of its pins, at \
             least 1; let pins vary, or give others",
            c.layout.pins
        ),
        None => "the rules of what can be printed; widen limits, vary or materials".to_owned(),
    };
    (c, why)
}

/// Returns increasingly permissive requests. All of them are used with soft limits of size.
fn relaxations(request: &Request, base: &Configuration) -> [Request; 3] {
    let mut any_pins = request.clone();
    any_pins.vary.pattern = true;
    any_pins.limits.pins = None;
    let mut anything = any_pins.clone();
    anything.materials.pin_diameter_mm.clear();
    anything.materials.hardness_shore_a.clear();
    anything.vary.parameters = Parameter::ALL.iter().map(|p| extended_range(*p, base)).collect();
    [request.clone(), any_pins, anything]
}

/// Returns the default range of a parameter, extended to its present value.
pub(super) fn extended_range(parameter: Parameter, at: &Configuration) -> Varied {
    let ((low, high), here) = (parameter.default_range(), parameter.value(at));
    Varied { parameter, from: low.min(here), to: high.max(here) }
}

/// Returns the changes of parameters in `to` that the request does not allow.
fn excluded_changes(request: &Request, from: &Configuration, to: &Configuration) -> Vec<Change> {
    let allows = |p: Parameter| match request.vary.parameters.iter().find(|v| v.parameter == p) {
        Some(v) => (v.from - 1e-9..=v.to + 1e-9).contains(&p.value(to)),
        None => (p.value(from) - p.value(to)).abs() < 1e-6,
    };
    Parameter::ALL
        .into_iter()
        .filter(|p| !allows(*p))
        .map(|p| Change { parameter: p, from: p.value(from), to: p.value(to) })
        .collect()
}
