//! Proposals of a search, and why there are none, as text for the terminal.

use std::fmt::Write;

use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_switch::design_search::{Blocked, Found, Proposal};
use pinswitch_switch::request::{Parameter, Request};

/// Most sources of uncertainty that are listed.
const MAX_SOURCES: usize = 3;
/// Smallest share of the variance that is listed.
const MIN_SHARE: f64 = 0.005;

/// Formats the targets, and every proposal with its values, its sources of uncertainty and its sensitivities.
pub(super) fn table(found: &Found, request: &Request) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, found, request);
    text
}

fn write_table(text: &mut String, found: &Found, request: &Request) -> std::fmt::Result {
    let targets: Vec<String> = request.targets.iter().map(ToString::to_string).collect();
    writeln!(text, "targets: {}", targets.join("; "))?;
    for (i, proposal) in found.proposals.iter().enumerate() {
        let name = if found.blocked.is_some() { "nearest".to_owned() } else { (i + 1).to_string() };
        write_proposal(text, &name, proposal, request, found.range_n)?;
    }
    Ok(())
}

fn write_proposal(
    text: &mut String,
    name: &str,
    p: &Proposal,
    request: &Request,
    range_n: (f64, f64),
) -> std::fmt::Result {
    writeln!(
        text,
        "{name}: {:.0} % of made parts meet the request (+-{:.0}); pins {:?}, {}; {}",
        100.0 * p.probability.all,
        196.0 * p.standard_error,
        p.pins,
        parameters(p, request),
        p.trust.as_str()
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
fn parameters(p: &Proposal, request: &Request) -> String {
    let is_chosen = |parameter: Parameter| {
        request.vary.parameters.iter().any(|v| v.parameter == parameter)
            || (parameter == Parameter::PinDiameterMm && !request.materials.pin_diameter_mm.is_empty())
            || (parameter == Parameter::HardnessShoreA && !request.materials.hardness_shore_a.is_empty())
    };
    let mut all: Vec<String> = Parameter::ALL
        .iter()
        .filter(|parameter| is_chosen(**parameter))
        .filter_map(|parameter| {
            Some(format!("{} {:.2}", parameter.name(), p.parameters.get(parameter.name())?))
        })
        .collect();
    if !request.materials.tendon.is_empty() {
        all.push(format!("rope {} mm with {} mm of coating", p.tendon_mm[0], p.tendon_mm[1]));
    }
    if all.is_empty() { "other parameters as configured".to_owned() } else { all.join(", ") }
}

/// Returns the diagnostic of a request that no design meets: what the nearest design misses, what blocks it, and the
/// changes that help.
pub(super) fn refusal(blocked: &Blocked) -> Diagnostic {
    Diagnostic::new(codes::REQUEST_IMPOSSIBLE, blocked.problem()).with_help(blocked.help().join("\n"))
}
