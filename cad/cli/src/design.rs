//! `pinswitch design`: from a wanted curve to layouts.

use std::path::PathBuf;

use clap::Args;
use pinswitch_friction::layout_search::{LayoutCandidate, MAX_GROOVES, Wanted};
use serde::Serialize;

use super::range::Range;
use super::source::Source;
use super::{Failure, print, print_json};
use crate::write::write_set;
use pinswitch_plot::pareto_svg;
use pinswitch_switch::config::{Name, to_toml};
use pinswitch_switch::design::Design;
use pinswitch_switch::inverse::{Proposal, SearchResult, find, search_for};
use pinswitch_switch::output::OutputFile;

/// Find pin layouts that switch where you want them to.
///
/// Tries every pattern of occupied grooves with the physics, judges the best by the law that `predict` uses for them, and
/// ranks those that can be printed. The threshold is the load at which silicone makes half of the friction.
#[derive(Args, Debug)]
#[command(mut_arg("config", |a| a.required(false).default_value("three-double")))]
#[command(after_help = "Examples:
  pinswitch design --threshold 20 --max-friction 8
  pinswitch design --threshold 30 --pins 3..6 --out out/late
  pinswitch design my-switch.toml --max-friction 12 --load-range 3..80 --tune")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Wanted threshold in newtons: the load at which silicone makes half of the friction.
    #[arg(long, value_name = "N", required_unless_present = "max_friction")]
    threshold: Option<f64>,
    /// Wanted friction at the heaviest load, in newtons.
    #[arg(long, value_name = "N")]
    max_friction: Option<f64>,
    /// Lightest and heaviest load in newtons, such as 3..80 [default: friction.load_min_n..friction.load_max_n].
    #[arg(long, value_name = "A..B")]
    load_range: Option<Range<f64>>,
    /// Fewest and most pins, such as 3..6 [default: any number].
    #[arg(long, value_name = "A..B")]
    pins: Option<Range<usize>>,
    /// How many designs to propose.
    #[arg(long, value_name = "N", default_value_t = 5)]
    best: usize,
    /// Vary the pitch of the grooves of each proposal, too.
    #[arg(long)]
    tune: bool,
    /// Folder for the configurations, pareto.svg and design.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What is written as design.json.
#[derive(Serialize)]
struct Report<'a> {
    wanted: Wanted,
    patterns: u64,
    tried: usize,
    proposals: &'a [Proposal],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let wanted = wanted(arguments)?;
    let design = design(arguments)?;
    let grooves = design.configuration().segment.grooves;
    let pins = arguments.pins.map_or((1, grooves), |r| (r.from, r.to));
    if pins.0 == 0 || pins.1 > grooves {
        return Err(Failure::bad_input(format!(
            "--pins = {}..{}: a layout has 1 to {grooves} pins here; narrow it or raise segment.grooves",
            pins.0, pins.1
        )));
    }
    let search = search_for(&design, pins);
    if search.grooves.len() > MAX_GROOVES {
        return Err(Failure::bad_input(format!(
            "segment.grooves: the tendon touches {} grooves, and 2^{0} patterns are too many; lower segment.grooves until \
             it touches {MAX_GROOVES} or fewer",
            search.grooves.len()
        )));
    }
    let found = find(&design, &search, wanted, arguments.best, arguments.tune);
    if found.proposals.is_empty() {
        return Err(Failure::failed(
            "no printable pattern switches within these loads; widen --load-range or --pins",
        ));
    }
    log::info!(
        "{} patterns touch the tendon, {} of which differ in where; {} can be proposed",
        found.patterns,
        found.candidates.len(),
        found.proposals.len()
    );
    let report = Report {
        wanted,
        patterns: found.patterns,
        tried: found.candidates.len(),
        proposals: &found.proposals,
    };
    if let Some(folder) = &arguments.out {
        write_set(folder, &files(&found, &report)?).map_err(Failure::failed)?;
        log::info!(
            "{}: design-1.toml to design-{}.toml, pareto.svg",
            folder.display(),
            found.proposals.len()
        );
    }
    if arguments.json { print_json(&report) } else { print(table(&found.proposals).as_bytes()) }
}

fn wanted(arguments: &Arguments) -> Result<Wanted, Failure> {
    for (flag, value) in [("--threshold", arguments.threshold), ("--max-friction", arguments.max_friction)] {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Failure::bad_input(format!("{flag} = {value}: give a force above 0 N")));
        }
    }
    if arguments.best == 0 {
        return Err(Failure::bad_input("--best = 0: ask for at least one design"));
    }
    Ok(Wanted { threshold_n: arguments.threshold, friction_n: arguments.max_friction })
}

/// The configuration with the wanted loads.
fn design(arguments: &Arguments) -> Result<Design, Failure> {
    let design = arguments.source.design()?;
    let Some(range) = arguments.load_range else { return Ok(design) };
    let mut configuration = design.configuration().clone();
    (configuration.friction.load_min_n, configuration.friction.load_max_n) = (range.from, range.to);
    Design::new(configuration).map_err(|e| Failure::bad_input(format!("--load-range: {e}")))
}

fn files(found: &SearchResult, report: &Report<'_>) -> Result<Vec<OutputFile>, Failure> {
    let mut files: Vec<OutputFile> = found
        .proposals
        .iter()
        .enumerate()
        .map(|(i, proposal)| {
            let mut configuration = proposal.configuration.clone();
            configuration.switch.name = Name::cleaned(&format!("design-{}", i + 1));
            OutputFile { name: format!("design-{}.toml", i + 1), bytes: to_toml(&configuration).into_bytes() }
        })
        .collect();
    let chosen: Vec<LayoutCandidate> = found
        .proposals
        .iter()
        .map(|p| LayoutCandidate {
            pins: p.pins.clone(),
            threshold_n: p.transition.map(|t| t.threshold_n),
            friction_n: p.friction_n,
            ratio: p.ratio,
        })
        .collect();
    let svg = pareto_svg(&found.candidates, &chosen).map_err(Failure::failed)?;
    files.push(OutputFile { name: "pareto.svg".to_owned(), bytes: svg.into_bytes() });
    let mut bytes = serde_json::to_vec_pretty(report).map_err(Failure::failed)?;
    bytes.push(b'\n');
    files.push(OutputFile { name: "design.json".to_owned(), bytes });
    Ok(files)
}

fn table(proposals: &[Proposal]) -> String {
    let mut text =
        "     threshold (band)           friction (band)            within  trust         pins\n".to_owned();
    for (i, p) in proposals.iter().enumerate() {
        let threshold = p.transition.map_or("none".to_owned(), |t| {
            format!("{:5.2} N ({:.1} to {:.1})", t.threshold_n, t.low_n, t.high_n)
        });
        let friction =
            format!("{:5.2} N ({:.2} to {:.2})", p.friction_n, p.friction_band_n[0], p.friction_band_n[1]);
        let within = if p.within_band { "yes" } else { "no" };
        let trust = format!("{:?}", p.trust).to_lowercase();
        text += &format!("{:>3}  {threshold:<26} {friction:<26} {within:<7} {trust:<13} {:?}", i + 1, p.pins);
        text += &if (p.span_deg - pinswitch_friction::published::SEGMENT_DEG).abs() > 1e-9 {
            format!(" over {:.2} deg\n", p.span_deg)
        } else {
            "\n".to_owned()
        };
    }
    text
}
