//! Twenty design requests, six of them impossible: the proposals, their stated probabilities, and
//! the share of simulated prints within tolerance that meet the request. `cad/doc/design.md` shows
//! the table.
//!
//! `cargo run --release --example requests [NUMBER]` takes some minutes; with a number it runs one
//! request.

use std::time::Instant;

use pinswitch::switch::config::Configuration;
use pinswitch::switch::design::Design;
use pinswitch::switch::design_search::{Found, Options, PublishedPhysics, Silent, search, simulated};
use pinswitch::switch::request::Request;

use Source::{File, Targets};

/// Number of simulated prints.
const PRINTS: usize = 2000;
/// Seed of the prints, different from that of the search.
const SEED: u64 = 20_260;
/// Largest error of a stated probability.
const POINTS: f64 = 0.05;

/// The source of a request.
enum Source {
    /// The targets and the other tables of a file, without the header of its first table.
    Targets(&'static str),
    /// The text of a file.
    File(&'static str),
}

impl Source {
    fn text(&self) -> String {
        match self {
            Targets(targets) => format!("[targets]\n{targets}"),
            File(text) => (*text).to_owned(),
        }
    }
}

/// The requests, and whether each is possible.
const REQUESTS: [(Source, bool); 20] = [
    (Targets("threshold_n = 24\nmax_friction_n = 'at most 9'\n[limits]\npins = [3, 6]"), true),
    (Targets("threshold_n = { about = 15, within = 0.15 }"), true),
    (Targets("threshold_n = 'at least 28'"), true),
    (Targets("friction = [{ load_n = 15, at_most_n = 1 }, { load_n = 50, at_least_n = 8 }]"), true),
    (Targets("friction = [{ load_n = 30, about_n = 4, within = 0.2 }]"), true),
    (Targets("max_friction_n = 'between 6 and 8'\n[limits]\npins = [3, 6]"), true),
    (Targets("low_load_friction_n = 'at most 0.15'\nmax_friction_n = 'at least 6'"), true),
    (Targets("threshold_n = { about = 20, within = 0.2 }\nstiffness = 'at least 2'"), true),
    (File(include_str!("../../templates/requests/small-joint.toml")), true),
    (File(include_str!("../../templates/requests/gripper.toml")), true),
    (
        Targets(
            "threshold_n = { about = 30, within = 0.2 }\n[vary]\npitch_deg = true\n[materials]\nhardness_shore_a = [20, 35, 50, 65]",
        ),
        true,
    ),
    (
        Targets(
            "friction = [{ load_n = 25, at_most_n = 3 }, { load_n = 50, at_least_n = 8.5 }]\n[vary]\npitch_deg = true\nlayer_mm = true\npin_diameter_mm = [0.8, 1.4]\nradius_mm = [16, 26]\nwidth_mm = [12, 18]",
        ),
        true,
    ),
    (Targets("max_friction_n = 'between 12 and 16'\n[vary]\nwrap_deg = true\npitch_deg = true"), true),
    (Targets("threshold_n = { about = 20, within = 0.15 }\n[vary]\npattern = false\nlayer_mm = true"), true),
    (File(include_str!("../../templates/requests/impossible.toml")), false),
    (Targets("max_friction_n = 'at least 30'"), false),
    (
        Targets("threshold_n = 'between 34 and 40'\n[limits]\npins = [3, 3]\n[vary]\nlayer_mm = [1.9, 2.1]"),
        false,
    ),
    (
        Targets(
            "threshold_n = { about = 9, within = 0.1 }\nfriction = [{ load_n = 50, at_most_n = 8 }]\n[limits]\nouter_radius_mm = 25.1\npins = [3, 3]\n[vary]\nlayer_mm = [2, 5]",
        ),
        false,
    ),
    (Targets("friction = [{ load_n = 10, at_most_n = 0.05 }]"), false),
    (
        Targets(
            "threshold_n = 'at least 35'\n[vary]\npitch_deg = true\n[materials]\nhardness_shore_a = [10, 15]",
        ),
        false,
    ),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let only: Option<usize> = std::env::args().nth(1).and_then(|word| word.parse().ok());
    let mut base = Configuration::default();
    base.layout.pins = vec![5, 8, 11];
    let base = Design::new(base)?;
    let mut wrong = 0;
    println!("| | request | proposal | predicted | stated | simulated | s |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let selected = REQUESTS.iter().enumerate().filter(|(i, _)| only.is_none_or(|n| n == i + 1));
    for (i, (source, is_possible)) in selected {
        let request = Request::read(&source.text(), &format!("request {}", i + 1))?;
        let start = Instant::now();
        let result = search(&base, &request, &PublishedPhysics::default(), Options::default(), &Silent);
        let seconds = start.elapsed().as_secs_f64();
        wrong += usize::from(result.blocked.is_none() != *is_possible);
        wrong += row(i + 1, &request, &result, seconds)?;
    }
    println!(
        "\n{wrong} unexpected results: possibility, or stated probability off by more than {} points",
        100.0 * POINTS
    );
    Ok(())
}

/// Prints the row of a request; returns the number of proposals with a wrong probability.
fn row(
    number: usize,
    request: &Request,
    result: &Found,
    seconds: f64,
) -> Result<usize, Box<dyn std::error::Error>> {
    let targets: Vec<String> = request.targets.iter().map(ToString::to_string).collect();
    let targets = targets.join("; ");
    let Some(best) = result.proposals.first() else {
        println!("| {number} | {targets} | none | | | | {seconds:.1} |");
        return Ok(1);
    };
    let predicted: Vec<String> = best.targets.iter().map(|t| format!("{:.3}", t.value)).collect();
    let varied: Vec<String> = request
        .vary
        .parameters
        .iter()
        .map(|v| format!("{} {:.2}", v.parameter.name(), v.parameter.value(&best.configuration)))
        .collect();
    let proposed = format!("{:?}, {}", best.pins, varied.join(", "));
    if let Some(blocked) = &result.blocked {
        let by: Vec<String> = blocked.missed.iter().map(|m| format!("{:.0} %", 100.0 * m.by)).collect();
        let moved = blocked.moves.first().map_or("no change helps".to_owned(), |m| {
            format!(
                "{} {:.2} to {:.2} {}",
                m.parameter.name(),
                m.from,
                m.to,
                if m.meets { "meets it" } else { "is closer" }
            )
        });
        println!(
            "| {number} | {targets} | impossible; nearest {proposed} | {}, off by {} | blocked by {} | {moved} | {seconds:.1} |",
            predicted.join(", "),
            by.join(", "),
            blocked.limit
        );
        return Ok(0);
    }
    let (mut wrong, mut stated, mut frequencies) = (0, Vec::new(), Vec::new());
    for p in &result.proposals {
        let design = Design::new(p.configuration.clone())?;
        let made = simulated(&design, request, &PublishedPhysics::default(), PRINTS, SEED)
            .ok_or("a proposal is not predictable")?;
        wrong += usize::from((made.all - p.probability.all).abs() > POINTS);
        stated.push(format!("{:.0}", 100.0 * p.probability.all));
        frequencies.push(format!("{:.0}", 100.0 * made.all));
    }
    println!(
        "| {number} | {targets} | {proposed} | {} | {} % | {} % | {seconds:.1} |",
        predicted.join(", "),
        stated.join(", "),
        frequencies.join(", ")
    );
    Ok(wrong)
}
