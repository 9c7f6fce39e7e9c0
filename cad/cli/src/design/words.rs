//! What a search found, for a reader at a terminal.

use std::fmt::Write;

use pinswitch_switch::design_search::{Blocked, Found, Missed, Move, Proposal};
use pinswitch_switch::request::{Parameter, Request};

/// Shares of the variance that are shown.
const SHARES: usize = 3;

/// The ask, and every proposal with its targets, what the uncertainty comes from, and sensitivities.
pub(super) fn table(found: &Found, ask: &Request) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, found, ask);
    text
}

fn write_table(text: &mut String, found: &Found, ask: &Request) -> std::fmt::Result {
    let targets: Vec<String> = ask.targets.iter().map(ToString::to_string).collect();
    writeln!(text, "asked: {}", targets.join("; "))?;
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
    ask: &Request,
    range_n: (f64, f64),
) -> std::fmt::Result {
    let trust = format!("{:?}", p.trust).to_lowercase();
    writeln!(
        text,
        "{name}: met by {:.0} % of made parts (+-{:.0}); pins {:?}, {}; {trust}",
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
            "   {}: {:.3} ({:.3} to {:.3}), met by {:.0} %{}{}",
            t.target,
            t.value,
            t.band[0],
            t.band[1],
            100.0 * t.probability,
            if t.is_met { "" } else { "; missed by the best guess" },
            if i == p.tightest && p.targets.len() > 1 { "; the tightest" } else { "" }
        )?;
    }
    let shares: Vec<String> = p
        .uncertainty
        .iter()
        .take(SHARES)
        .filter(|s| s.share >= 0.005)
        .map(|s| format!("{} {:.0} %", s.source, 100.0 * s.share))
        .collect();
    writeln!(text, "   uncertain by: {}", shares.join(", "))?;
    let slopes = |slope: fn(&pinswitch_switch::design_search::Sensitivity) -> f64| {
        let all: Vec<String> =
            p.sensitivity.iter().map(|s| format!("{} {:+.3}", s.parameter.name(), slope(s))).collect();
        all.join(", ")
    };
    writeln!(text, "   dD/d at the heaviest load, N per unit: {}", slopes(|s| s.friction_n_per_unit))?;
    writeln!(text, "   dthreshold/d, N per unit:              {}", slopes(|s| s.threshold_n_per_unit))
}

/// Parameters that were varied or chosen, with their values.
fn parameters(p: &Proposal, ask: &Request) -> String {
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
    if all.is_empty() { "all else as configured".to_owned() } else { all.join(", ") }
}

/// Why the ask cannot be met, for standard error.
pub(super) fn refusal(blocked: &Blocked) -> String {
    let mut text = "nothing within the ask meets it; the nearest ".to_owned();
    text += &if blocked.missed.is_empty() {
        "that can be printed does, and lies outside of it".to_owned()
    } else {
        format!("misses: {}", all_missed(&blocked.missed))
    };
    text += &format!("\n  blocked by: {}", blocked.limit);
    for m in blocked.moves.iter().take(3) {
        text += &format!("\n  {}", advice(m));
    }
    if !blocked.together.is_empty() {
        let all: Vec<String> = blocked
            .together
            .iter()
            .map(|c| format!("{} from {:.2} to {:.2}", c.parameter.name(), c.from, c.to))
            .collect();
        text += &format!("\n  together these meet it: {}", all.join(", "));
    }
    text
}

/// How far all of these are from their bounds, as shares of the bounds.
fn all_missed(missed: &[Missed]) -> String {
    let one =
        |m: &Missed| format!("{} has {:.3}, {:.1} % from {:.3}", m.target, m.value, 100.0 * m.by, m.bound);
    missed.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn advice(m: &Move) -> String {
    let verb = if m.to > m.from { "raise" } else { "lower" };
    let effect =
        if m.meets { "then the ask is met".to_owned() } else { format!("then {}", all_missed(&m.missed)) };
    format!("{verb} {} from {:.2} to {:.2}: {effect} ({})", m.parameter.name(), m.from, m.to, m.forbidden_by)
}
