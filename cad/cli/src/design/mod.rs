//! `pinswitch design`: configurations that meet a request.

mod progress;
mod request_options;
mod text;

use std::path::PathBuf;

use clap::Args;
use pinswitch_app::CalibratedSwitch;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::layout_search::LayoutCandidate;
use pinswitch_friction::published::GROOVES;
use pinswitch_report::{TargetRegion, pareto_svg};
use pinswitch_switch::config::{Configuration, Name, to_toml};
use pinswitch_switch::design_search::{
    Belief, Blocked, Found, Options, Proposal, PublishedPhysics, load_range_n, search,
};
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::request::{Parameter, Quantity, Request};
use schemars::JsonSchema;
use serde::Serialize;

use super::calibrated_curve::read_model;
use super::source::Source;
use super::terminal::to_json;
use super::{Failure, print_json, print_text};
use crate::write::SetFolder;
use progress::Bar;
use request_options::RequestOptions;

/// Find pins, grooves and silicone that meet a request.
///
/// A request has targets (threshold, friction at any loads, stiffness of switching) within limits (size, number of pins,
/// printer, available materials), in a file or as options. Write a target as `at most 8`, `at least 8`,
/// `between 4 and 6`, `about 5` or `about 5 within 15%`. The search covers patterns of pins and continuous parameters,
/// with the physics law. Proposals are ranked by the probability that a made part meets the request, which includes the
/// uncertainty of the constants, of the model, and of printing and casting. A request that no design meets ends with exit
/// code 1, the nearest design, the limit that blocks it, and the parameters to change.
#[derive(Args, Debug)]
#[command(mut_arg("config", |a| a.required(false).default_value("three-double")))]
#[command(after_help = "Examples:
  pinswitch design --threshold 24 --max-friction 9
  pinswitch design --request templates/requests/gripper.toml --out out/gripper
  pinswitch design --friction 'at most 1 at 15' --friction 'at least 8 at 50' --pins 3..6 --vary pitch_deg,layer_mm=1.5..3
  pinswitch design --threshold 'at least 30' --model model.toml --json

cad/doc/design.md explains every field and the computation of the probability.")]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    #[command(flatten)]
    request: Box<RequestOptions>,
    /// model.toml of a calibration; its curve, band and covariance replace the published constants.
    #[arg(long, value_name = "TOML")]
    model: Option<PathBuf>,
    /// Number of proposals.
    #[arg(long, value_name = "N", default_value_t = Options::default().best)]
    best: usize,
    /// Simulated parts per probability.
    #[arg(long, value_name = "N", default_value_t = Options::default().draws)]
    draws: usize,
    /// Seed of the simulated parts.
    #[arg(long, value_name = "N", default_value_t = Options::default().seed)]
    seed: u64,
    /// Patterns whose continuous parameters are optimised; more are slower and more thorough.
    #[arg(long, value_name = "N", default_value_t = Options::default().starts)]
    starts: usize,
    /// Folder for the configurations, pareto.svg and design.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Content of `--json` and design.json.
#[derive(Serialize, JsonSchema)]
pub(super) struct Report<'a> {
    /// The request.
    request: &'a Request,
    /// Lightest and heaviest load, N.
    load_range_n: (f64, f64),
    /// Simulated parts per probability.
    draws: usize,
    /// Seed of the simulated parts.
    seed: u64,
    /// Distinct patterns; mirror images count once.
    patterns: usize,
    /// Curves that were computed to compare the patterns.
    tried: usize,
    /// Whether a design meets the request.
    possible: bool,
    /// Designs, the most probable first; the nearest one if none meets the request.
    proposals: &'a [Proposal],
    /// What blocks the request; null if it is possible.
    blocked: Option<&'a Blocked>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let request = arguments.request.request()?;
    let base = arguments.source.with_preset(request.limits.preset.as_deref()).design()?;
    let options = options(arguments)?;
    check_pins(&request, base.configuration())?;
    request.check_loads(load_range_n(base.configuration(), &request)).map_err(Failure::bad_input)?;
    if arguments.model.is_some() {
        check_model_scope(&request, base.configuration())?;
    }
    let calibrated = match &arguments.model {
        Some(path) => {
            let (model, name) = read_model(path)?;
            Some(CalibratedSwitch::new(model, name).map_err(Failure::bad_input)?)
        }
        None => None,
    };
    // Locked before the search, which may take minutes.
    let out = arguments.out.as_deref().map(SetFolder::lock).transpose()?;
    let published = PublishedPhysics::default();
    let belief: &dyn Belief = match &calibrated {
        Some(calibrated) => calibrated,
        None => &published,
    };
    let bar = Bar::new();
    let found = search(&base, &request, belief, options, &bar);
    bar.finish();
    log::info!(
        "{} distinct patterns (mirror images count once); {} curves computed",
        found.patterns,
        found.tried
    );
    let report = Report {
        request: &request,
        load_range_n: found.range_n,
        draws: options.draws,
        seed: options.seed,
        patterns: found.patterns,
        tried: found.tried,
        possible: found.blocked.is_none() && !found.proposals.is_empty(),
        proposals: &found.proposals,
        blocked: found.blocked.as_ref(),
    };
    if let Some(out) = out {
        let files = files(&found, &report, &request)?;
        out.replace(&files)?;
        let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
        log::info!("{}: {}", out.folder().display(), names.join(", "));
    }
    if arguments.json {
        print_json(&report)?;
    } else {
        print_text(&text::table(&found, &request))?;
    }
    match &found.blocked {
        Some(blocked) => Err(Failure::failed(text::refusal(blocked))),
        None if found.proposals.is_empty() => Err(Failure::failed(
            Diagnostic::new(
                codes::REQUEST_IMPOSSIBLE,
                "no layout of this configuration can be printed, whatever the request",
            )
            .with_help("start from another configuration"),
        )),
        None => Ok(()),
    }
}

/// Checks that a calibrated model covers everything that the request varies.
fn check_model_scope(request: &Request, base: &Configuration) -> Result<(), Failure> {
    if request.vary.parameters.iter().any(|v| v.parameter == Parameter::WrapDeg) {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::MODEL_BEYOND_RIG,
                "a calibrated model covers the wrap angle of its rig only",
            )
            .with_location(Location::field("--vary", "wrap_deg"))
            .with_help("leave out wrap_deg or --model"),
        ));
    }
    let grooves = base.segment.grooves;
    if grooves != GROOVES {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::MODEL_BEYOND_RIG,
                format!("a calibrated model covers the {GROOVES} grooves of its rig only"),
            )
            .with_location(Location::field("segment.grooves", grooves.to_string()))
            .with_help(format!("set it to {GROOVES}, or leave out --model")),
        ));
    }
    Ok(())
}

fn options(arguments: &Arguments) -> Result<Options, Failure> {
    let Arguments { best, draws, seed, starts, .. } = *arguments;
    for (flag, value, most) in
        [("--best", best, 100), ("--draws", draws, 1_000_000), ("--starts", starts, 1000)]
    {
        if value == 0 || value > most {
            return Err(Failure::bad_input(
                Diagnostic::new(codes::OUT_OF_RANGE, "out of range")
                    .with_location(Location::field(flag, value.to_string()))
                    .with_help(format!("give 1 to {most}")),
            ));
        }
    }
    Ok(Options { best, draws, seed, starts: starts.max(best) })
}

fn check_pins(request: &Request, base: &Configuration) -> Result<(), Failure> {
    let grooves = base.segment.grooves;
    match request.limits.pins {
        Some((fewest, most)) if most > grooves => Err(Failure::bad_input(
            Diagnostic::new(
                codes::OUT_OF_RANGE,
                format!("a layout of this configuration has 1 to {grooves} pins"),
            )
            .with_location(Location::field("--pins", format!("{fewest}..{most}")))
            .with_help("narrow the range, or raise segment.grooves"),
        )),
        _ => Ok(()),
    }
}

fn files(found: &Found, report: &Report<'_>, request: &Request) -> Result<Vec<OutputFile>, Failure> {
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
    let svg = pareto_svg(&found.candidates, &chosen, target_region(request, found.range_n))
        .map_err(Failure::failed)?;
    files.push(OutputFile { name: "pareto.svg".to_owned(), bytes: svg.into_bytes() });
    files.push(OutputFile { name: "design.json".to_owned(), bytes: to_json(report)? });
    Ok(files)
}

/// Returns the intervals of threshold and of friction at the heaviest load that meet the targets; `None` without a target
/// for either.
fn target_region(request: &Request, range_n: (f64, f64)) -> Option<TargetRegion> {
    let interval = |is_meant: &dyn Fn(Quantity) -> bool| {
        let intervals =
            request.targets.iter().filter(|t| is_meant(t.quantity)).map(|t| t.requirement.interval());
        intervals.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1)))
    };
    let threshold = interval(&|q| q == Quantity::Threshold);
    let friction = interval(&|q| match q {
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
