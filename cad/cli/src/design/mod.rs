//! `pinswitch design`: from an ask to configurations.

mod flags;
mod progress;
mod words;

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::ModelFile;
use pinswitch_friction::layout_search::LayoutCandidate;
use serde::Serialize;

use super::source::Source;
use super::{Failure, print, print_json};
use crate::write::write_set;
use flags::AskFlags;
use pinswitch_app::CalibratedSwitch;
use pinswitch_friction::published::GROOVES;
use pinswitch_report::{TargetRegion, pareto_svg};
use pinswitch_switch::ask::{Ask, Parameter, Quantity};
use pinswitch_switch::config::{Configuration, Name, to_toml};
use pinswitch_switch::design_search::{
    Belief, Blocked, Found, Options, Proposal, PublishedPhysics, load_range_n, search,
};
use pinswitch_switch::output::OutputFile;
use progress::Bar;

/// Find switches that do what you ask: pins, grooves, silicone.
///
/// An ask is a set of targets (threshold, friction at any loads, stiffness of switching) within limits (size, number of pins,
/// printer, materials at hand), in a file or as options. Patterns of pins and continuous parameters are searched with the
/// physics; answers are ranked by the probability that a made part meets the ask, with everything that is uncertain: the
/// constants, the model, and how well parts are printed and cast. An ask that cannot be met ends with exit code 1, the
/// nearest design, the limit that blocks it, and the parameter that would move it.
#[derive(Args, Debug)]
#[command(mut_arg("config", |a| a.required(false).default_value("three-double")))]
#[command(after_help = "Examples:
  pinswitch design --threshold 24 --max-friction 9
  pinswitch design --ask templates/asks/gripper.toml --out out/gripper
  pinswitch design --friction 'at most 1 at 15' --friction 'at least 8 at 50' --pins 3..6 --vary pitch_deg,layer_mm=1.5..3
  pinswitch design --threshold 'at least 30' --model model.toml --json

cad/doc/design.md explains every field, and how the probability is computed.")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    ask: Box<AskFlags>,
    /// A model.toml written by `calibrate`: its curve, band and covariance instead of the published constants.
    #[arg(long, value_name = "TOML")]
    model: Option<PathBuf>,
    /// How many designs to propose.
    #[arg(long, value_name = "N", default_value_t = Options::default().best)]
    best: usize,
    /// Made parts that are drawn for each probability.
    #[arg(long, value_name = "N", default_value_t = Options::default().draws)]
    draws: usize,
    /// Seed of the draws.
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    seed: u64,
    /// Patterns whose continuous parameters are searched: more is slower and leaves less out.
    #[arg(long, value_name = "N", default_value_t = Options::default().starts)]
    starts: usize,
    /// Folder for the configurations, pareto.svg and design.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON and written as design.json.
#[derive(Serialize)]
struct Report<'a> {
    ask: &'a Ask,
    load_range_n: (f64, f64),
    draws: usize,
    seed: u64,
    /// Patterns that differ, mirror images counted once.
    patterns: usize,
    /// Curves that the enumeration computed.
    tried: usize,
    possible: bool,
    proposals: &'a [Proposal],
    blocked: Option<&'a Blocked>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let ask = arguments.ask.ask()?;
    let base = arguments.source.with_preset(ask.limits.preset.as_deref()).design()?;
    let options = options(arguments)?;
    check_pins(&ask, base.configuration())?;
    ask.check_loads(load_range_n(base.configuration(), &ask)).map_err(Failure::bad_input)?;
    if arguments.model.is_some() && ask.vary.parameters.iter().any(|v| v.parameter == Parameter::WrapDeg) {
        return Err(Failure::bad_input(
            "--vary wrap_deg: a calibrated switch is known at the wrap of its rig only; leave out wrap_deg or --model",
        ));
    }
    let grooves = base.configuration().segment.grooves;
    if arguments.model.is_some() && grooves != GROOVES {
        return Err(Failure::bad_input(format!(
            "segment.grooves = {grooves}: a calibrated switch is known by the {GROOVES} grooves of its rig; set {GROOVES} or leave \
             out --model"
        )));
    }
    let calibrated = arguments.model.as_deref().map(calibrated_switch).transpose()?;
    let published = PublishedPhysics::default();
    let belief: &dyn Belief = match &calibrated {
        Some(calibrated) => calibrated,
        None => &published,
    };
    let bar = Bar::new();
    let found = search(&base, &ask, belief, options, &bar);
    bar.finish();
    log::info!(
        "{} patterns, mirror images once; {} curves of patterns computed",
        found.patterns,
        found.tried
    );
    let report = Report {
        ask: &ask,
        load_range_n: found.range_n,
        draws: options.draws,
        seed: options.seed,
        patterns: found.patterns,
        tried: found.tried,
        possible: found.blocked.is_none() && !found.proposals.is_empty(),
        proposals: &found.proposals,
        blocked: found.blocked.as_ref(),
    };
    if let Some(folder) = &arguments.out {
        let files = files(&found, &report, &ask)?;
        write_set(folder, &files)?;
        let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
        log::info!("{}: {}", folder.display(), names.join(", "));
    }
    if arguments.json {
        print_json(&report)?;
    } else {
        print(words::table(&found, &ask).as_bytes())?;
    }
    match &found.blocked {
        Some(blocked) => Err(Failure::failed(words::refusal(blocked))),
        None if found.proposals.is_empty() => Err(Failure::failed(
            "nothing that the tendon touches can be printed, whatever the ask; start from another configuration",
        )),
        None => Ok(()),
    }
}

fn calibrated_switch(path: &Path) -> Result<CalibratedSwitch, Failure> {
    let name = path.display().to_string();
    let text = crate::input::read_text_file(path)?;
    let file = ModelFile::parse(&text, &name).map_err(Failure::bad_input)?;
    Ok(CalibratedSwitch::new(file, name))
}

fn options(arguments: &Arguments) -> Result<Options, Failure> {
    let Arguments { best, draws, seed, starts, .. } = *arguments;
    for (flag, value, most) in
        [("--best", best, 100), ("--draws", draws, 1_000_000), ("--starts", starts, 1000)]
    {
        if value == 0 || value > most {
            return Err(Failure::bad_input(format!("{flag} = {value}: give 1 to {most}")));
        }
    }
    Ok(Options { best, draws, seed, starts: starts.max(best) })
}

fn check_pins(ask: &Ask, base: &Configuration) -> Result<(), Failure> {
    let grooves = base.segment.grooves;
    match ask.limits.pins {
        Some((fewest, most)) if most > grooves => Err(Failure::bad_input(format!(
            "--pins = {fewest}..{most}: a layout has 1 to {grooves} pins here; narrow it or raise segment.grooves"
        ))),
        _ => Ok(()),
    }
}

fn files(found: &Found, report: &Report<'_>, ask: &Ask) -> Result<Vec<OutputFile>, Failure> {
    let named = |i: usize| if report.possible { format!("design-{}", i + 1) } else { "nearest".to_owned() };
    let mut files: Vec<OutputFile> = found
        .proposals
        .iter()
        .enumerate()
        .map(|(i, proposal)| {
            let mut configuration = proposal.configuration.clone();
            configuration.switch.name = Name::cleaned(&named(i));
            OutputFile { name: format!("{}.toml", named(i)), bytes: to_toml(&configuration).into_bytes() }
        })
        .collect();
    let chosen: Vec<LayoutCandidate> = found
        .proposals
        .iter()
        .map(|p| LayoutCandidate {
            pins: p.pins.clone(),
            threshold_n: p.threshold_n,
            friction_n: p.friction_n,
        })
        .collect();
    let svg =
        pareto_svg(&found.candidates, &chosen, asked_region(ask, found.range_n)).map_err(Failure::failed)?;
    files.push(OutputFile { name: "pareto.svg".to_owned(), bytes: svg.into_bytes() });
    let mut bytes = serde_json::to_vec_pretty(report).map_err(Failure::failed)?;
    bytes.push(b'\n');
    files.push(OutputFile { name: "design.json".to_owned(), bytes });
    Ok(files)
}

/// What the ask says of threshold and friction at the heaviest load, if it says anything of either.
fn asked_region(ask: &Ask, range_n: (f64, f64)) -> Option<TargetRegion> {
    let of = |is_it: &dyn Fn(Quantity) -> bool| {
        let intervals = ask.targets.iter().filter(|t| is_it(t.quantity)).map(|t| t.wish.interval());
        intervals.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1)))
    };
    let threshold = of(&|q| q == Quantity::Threshold);
    let friction = of(&|q| match q {
        Quantity::MaxFriction => true,
        Quantity::Friction { load_n } => (load_n - range_n.1).abs() < 1e-9,
        _ => false,
    });
    let anything = (0.0, f64::INFINITY);
    (threshold.is_some() || friction.is_some()).then(|| TargetRegion {
        threshold_n: threshold.unwrap_or(anything),
        friction_n: friction.unwrap_or(anything),
    })
}
