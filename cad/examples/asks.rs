//! Twenty asks, six of them impossible: what was proposed, what is stated of it, and how often simulated prints within
//! tolerance meet the ask. `cad/doc/design.md` shows its table.
//!
//! `cargo run --release --example asks` (some minutes; a number as argument takes that ask alone)

use std::time::Instant;

use pinswitch::switch::config::Configuration;
use pinswitch::switch::design::Design;
use pinswitch::switch::design_search::{Found, Options, PublishedPhysics, Silent, search, simulated};
use pinswitch::switch::request::Request;

/// Prints that are simulated, with a seed that the search does not use.
const PRINTS: usize = 2000;
const SEED: u64 = 20_260;
/// Within how much a stated probability must hold.
const POINTS: f64 = 0.05;

const ASKS: [(&str, bool); 20] = [
    ("[ask]\nthreshold_n = 24\nmax_friction_n = 'at most 9'\n[limits]\npins = [3, 6]", true),
    ("[ask]\nthreshold_n = { about = 15, within = 0.15 }", true),
    ("[ask]\nthreshold_n = 'at least 28'", true),
    ("[ask]\nfriction = [{ load_n = 15, at_most_n = 1 }, { load_n = 50, at_least_n = 8 }]", true),
    ("[ask]\nfriction = [{ load_n = 30, about_n = 4, within = 0.2 }]", true),
    ("[ask]\nmax_friction_n = 'between 6 and 8'\n[limits]\npins = [3, 6]", true),
    ("[ask]\nlow_load_friction_n = 'at most 0.15'\nmax_friction_n = 'at least 6'", true),
    ("[ask]\nthreshold_n = { about = 20, within = 0.2 }\nstiffness = 'at least 2'", true),
    (include_str!("../../templates/asks/small-joint.toml"), true),
    (include_str!("../../templates/asks/gripper.toml"), true),
    (
        "[ask]\nthreshold_n = { about = 30, within = 0.2 }\n[vary]\npitch_deg = true\n[materials]\nhardness_shore_a = [20, 35, 50, 65]",
        true,
    ),
    (
        "[ask]\nfriction = [{ load_n = 25, at_most_n = 3 }, { load_n = 50, at_least_n = 8.5 }]\n[vary]\npitch_deg = true\nlayer_mm = true\npin_diameter_mm = [0.8, 1.4]\nradius_mm = [16, 26]\nwidth_mm = [12, 18]",
        true,
    ),
    ("[ask]\nmax_friction_n = 'between 12 and 16'\n[vary]\nwrap_deg = true\npitch_deg = true", true),
    ("[ask]\nthreshold_n = { about = 20, within = 0.15 }\n[vary]\npattern = false\nlayer_mm = true", true),
    (include_str!("../../templates/asks/impossible.toml"), false),
    ("[ask]\nmax_friction_n = 'at least 30'", false),
    (
        "[ask]\nthreshold_n = 'between 34 and 40'\n[limits]\npins = [3, 3]\n[vary]\nlayer_mm = [1.9, 2.1]",
        false,
    ),
    (
        "[ask]\nthreshold_n = { about = 9, within = 0.1 }\nfriction = [{ load_n = 50, at_most_n = 8 }]\n[limits]\nouter_radius_mm = 25.1\npins = [3, 3]\n[vary]\nlayer_mm = [2, 5]",
        false,
    ),
    ("[ask]\nfriction = [{ load_n = 10, at_most_n = 0.05 }]", false),
    (
        "[ask]\nthreshold_n = 'at least 35'\n[vary]\npitch_deg = true\n[materials]\nhardness_shore_a = [10, 15]",
        false,
    ),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let only: Option<usize> = std::env::args().nth(1).and_then(|word| word.parse().ok());
    let mut base = Configuration::default();
    base.layout.pins = vec![5, 8, 11];
    let base = Design::new(base)?;
    let mut wrong = 0;
    println!("| | asked | proposed | predicted | stated | simulated | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (i, (text, is_possible)) in ASKS.iter().enumerate().filter(|(i, _)| only.is_none_or(|n| n == i + 1)) {
        let ask = Request::read(text, &format!("ask {}", i + 1))?;
        let start = Instant::now();
        let found = search(&base, &ask, &PublishedPhysics::default(), Options::default(), &Silent);
        let seconds = start.elapsed().as_secs_f64();
        wrong += usize::from(found.blocked.is_none() != *is_possible);
        wrong += row(i + 1, &ask, &found, seconds)?;
    }
    println!("\n{wrong} are not as expected: possible or not, or stated within {} points", 100.0 * POINTS);
    Ok(())
}

/// Prints the row of an ask; returns how many of its proposals state a probability that does not hold.
fn row(
    number: usize,
    ask: &Request,
    found: &Found,
    seconds: f64,
) -> Result<usize, Box<dyn std::error::Error>> {
    let asked: Vec<String> = ask.targets.iter().map(ToString::to_string).collect();
    let asked = asked.join("; ");
    let Some(best) = found.proposals.first() else {
        println!("| {number} | {asked} | nothing | | | | {seconds:.1} |");
        return Ok(1);
    };
    let predicted: Vec<String> = best.targets.iter().map(|t| format!("{:.3}", t.value)).collect();
    let varied: Vec<String> = ask
        .vary
        .parameters
        .iter()
        .map(|v| format!("{} {:.2}", v.parameter.name(), v.parameter.value(&best.configuration)))
        .collect();
    let proposed = format!("{:?}, {}", best.pins, varied.join(", "));
    if let Some(blocked) = &found.blocked {
        let by: Vec<String> = blocked.missed.iter().map(|m| format!("{:.0} %", 100.0 * m.by)).collect();
        let moved = blocked.moves.first().map_or("nothing moves it".to_owned(), |m| {
            format!(
                "{} {:.2} to {:.2} {}",
                m.parameter.name(),
                m.from,
                m.to,
                if m.meets { "meets it" } else { "comes nearer" }
            )
        });
        println!(
            "| {number} | {asked} | impossible; nearest {proposed} | {}, off by {} | blocked by {} | {moved} | {seconds:.1} |",
            predicted.join(", "),
            by.join(", "),
            blocked.limit
        );
        return Ok(0);
    }
    let (mut wrong, mut stated, mut frequencies) = (0, Vec::new(), Vec::new());
    for p in &found.proposals {
        let design = Design::new(p.configuration.clone())?;
        let made = simulated(&design, ask, &PublishedPhysics::default(), PRINTS, SEED)
            .ok_or("a proposal cannot be predicted again")?;
        wrong += usize::from((made.all - p.probability.all).abs() > POINTS);
        stated.push(format!("{:.0}", 100.0 * p.probability.all));
        frequencies.push(format!("{:.0}", 100.0 * made.all));
    }
    println!(
        "| {number} | {asked} | {proposed} | {} | {} % | {} % | {seconds:.1} |",
        predicted.join(", "),
        stated.join(", "),
        frequencies.join(", ")
    );
    Ok(wrong)
}
