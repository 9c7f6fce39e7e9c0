//! Proposals of a search, and why there are none, as text for the terminal.

use std::fmt::Write;

use pinswitch_diagnostic::Diagnostic;
use pinswitch_switch::ask::{Ask, Parameter};
use pinswitch_switch::design_search::{Blocked, Found, Missed, Move, Proposal};

/// Most sources of uncertainty that are listed.
const MAX_SOURCES: usize = 3;
/// Smallest share of the variance that is listed.
const MIN_SHARE: f64 = 0.005;
/// Most changes of one parameter that are listed.
const MAX_MOVES: usize = 3;

/// Formats the targets, and every proposal with its values, its sources of uncertainty and its sensitivities.
pub(super) fn table(found: &Found, ask: &Ask) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, found, ask);
    text
}

fn write_table(text: &mut String, found: &Found, ask: &Ask) -> std::fmt::Result {
    let targets: Vec<String> = ask.targets.iter().map(ToString::to_string).collect();
    writeln!(text, "targets: {}", targets.join("; "))?;
    for (i, proposal) in found.proposals.iter().enumerate() {
        let name = if found.blocked.is_some() { "nearest".to_owned() } else { (i + 1).to_string() };
        write_proposal(text, &name, proposal, ask, found.range_n)?;
    }
    Ok(())
}

fn write_proposal(
    text: &mut String,
    name: &str,
    p: &Proposal,
    ask: &Ask,
    range_n: (f64, f64),
) -> std::fmt::Result {
    let trust = format!("{:?}", p.trust).to_lowercase();
    writeln!(
        text,
        "{name}: {:.0} % of made parts meet the request (+-{:.0}); pins {:?}, {}; {trust}",
        100.0 * p.probability.all,
        196.0 * p.standard_error,
        p.pins,
        parameters(p, ask)
    )?;
    let threshold = p.threshold_n.map_or("none".to_owned(), |t| format!("{t:.2} N"));
    writeln!(text, "   threshold {threshold}; {:.2} N at {:.2} N of load", p.friction_n, range_n.1)?;
    for (i, t) in p.targets.iter().enumerate() {
        writeln!(
            text,
            "   {}: {:.3} ({:.3} to {:.3}), {:.0} % meet it{}{}",
            t.target,
            t.value,
            t.band[0],
            t.band[1],
            100.0 * t.probability,
            if t.is_met { "" } else { "; the best estimate does not" },
            if i == p.tightest && p.targets.len() > 1 { "; tightest" } else { "" }
        )?;
    }
    let shares: Vec<String> = p
        .uncertainty
        .iter()
        .take(MAX_SOURCES)
        .filter(|s| s.share >= MIN_SHARE)
        .map(|s| format!("{} {:.0} %", s.source, 100.0 * s.share))
        .collect();
    writeln!(text, "   sources of uncertainty: {}", shares.join(", "))?;
    let slopes = |slope: fn(&pinswitch_switch::design_search::Sensitivity) -> f64| {
        let all: Vec<String> =
            p.sensitivity.iter().map(|s| format!("{} {:+.3}", s.parameter.name(), slope(s))).collect();
        all.join(", ")
    };
    writeln!(
        text,
        "   sensitivity of friction at the heaviest load, N per unit: {}",
        slopes(|s| s.friction_n_per_unit)
    )?;
    writeln!(
        text,
        "   sensitivity of the threshold, N per unit:                 {}",
        slopes(|s| s.threshold_n_per_unit)
    )
}

/// Lists the parameters that were varied or chosen, with their values.
fn parameters(p: &Proposal, ask: &Ask) -> String {
    let is_chosen = |parameter: Parameter| {
        ask.vary.parameters.iter().any(|v| v.parameter == parameter)
            || (parameter == Parameter::PinDiameterMm && !ask.materials.pin_diameter_mm.is_empty())
            || (parameter == Parameter::HardnessShoreA && !ask.materials.hardness_shore_a.is_empty())
    };
    let mut all: Vec<String> = Parameter::ALL
        .iter()
        .filter(|parameter| is_chosen(**parameter))
        .filter_map(|parameter| {
            Some(format!("{} {:.2}", parameter.name(), p.parameters.get(parameter.name())?))
        })
        .collect();
    if !ask.materials.tendon.is_empty() {
        all.push(format!("rope {} mm with {} mm of coating", p.tendon_mm[0], p.tendon_mm[1]));
    }
    if all.is_empty() { "other parameters as configured".to_owned() } else { all.join(", ") }
}

/// Returns the diagnostic of a request that no design meets: what the nearest design misses, what blocks it, and the
/// changes that help.
pub(super) fn refusal(blocked: &Blocked) -> Diagnostic {
    let problem = if blocked.missed.is_empty() {
        "no printable design within the limits meets the request; the nearest design outside of them does"
            .to_owned()
    } else {
        format!("no design meets the request; the nearest misses: {}", all_missed(&blocked.missed))
    };
    let mut help: Vec<String> = blocked.moves.iter().take(MAX_MOVES).map(advice).collect();
    if !blocked.together.is_empty() {
        let all: Vec<String> = blocked
            .together
            .iter()
            .map(|c| format!("{} from {:.2} to {:.2}", c.parameter.name(), c.from, c.to))
            .collect();
        help.push(format!("together these meet the request: {}", all.join(", ")));
    }
    Diagnostic::new(format!("{problem}; blocked by {}", blocked.limit)).with_help(help.join("\n"))
}

/// Lists how far each target is from its bound, as a share of the bound.
fn all_missed(missed: &[Missed]) -> String {
    let one =
        |m: &Missed| format!("{} is {:.3}, {:.1} % from {:.3}", m.target, m.value, 100.0 * m.by, m.bound);
    missed.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn advice(m: &Move) -> String {
    let verb = if m.to > m.from { "raise" } else { "lower" };
    let effect =
        if m.meets { "meets the request".to_owned() } else { format!("leaves {}", all_missed(&m.missed)) };
    format!("{verb} {} from {:.2} to {:.2}: {effect} ({})", m.parameter.name(), m.from, m.to, m.forbidden_by)
}
