//! `pinswitch physics`: refits the physics of the curves and compares it with the published facts.

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_friction::physics::hypotheses::{HypothesisFinding, hypotheses, weights};
use pinswitch_friction::physics::{
    Bed, FitError, LayoutLeftOut, MaximaFit, contact_profile, fit_maxima, leave_one_layout_out,
};
use pinswitch_friction::validation::{LawValidation, validate_laws};
use pinswitch_friction::{Direction, Law, Substrate};
use pinswitch_report::contact_svg;
use pinswitch_switch::output::OutputFile;
use schemars::JsonSchema;
use serde::Serialize;

use super::source::Source;
use super::terminal::to_json;
use super::{Failure, print_json, print_text};
use crate::write::SetFolder;

/// Chi-squared above which a published fact counts against a hypothesis.
const MIN_CHI_SQUARED: f64 = 1.0;
/// Loads of the profiles, as shares of the heaviest load.
const PROFILE_LOADS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];

/// Show the physics: its constants, the errors of the laws, and the path of the tendon.
///
/// Refits the three constants to the seven published maxima, predicts each layout from the others, compares the
/// friction laws, and weighs hypotheses about the tendon's path by all published facts. With --out, draws the tendon
/// over the pins of a configuration.
#[derive(Args, Debug)]
#[command(mut_arg("config", |a| a.required(false).default_value("three-double")))]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Folder for contact.svg and physics.json.
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Everything that is printed.
#[derive(Serialize, JsonSchema)]
pub(super) struct Report {
    /// Support of the tendon on the published rig.
    bed: Bed,
    /// Constants, fitted to the seven published maxima.
    fit: MaximaFit,
    /// Errors on each layout with constants that are fitted without it.
    left_out: Vec<LayoutLeftOut>,
    /// Errors of each law on the maxima.
    evidence: Vec<LawValidation>,
    /// Hypotheses of the path of the tendon outside the pins.
    hypotheses: Vec<HypothesisFinding>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let design = arguments.source.design()?;
    let report = report().map_err(Failure::failed)?;
    if let Some(folder) = &arguments.out {
        let contact = design.contact();
        if contact.substrate() == Substrate::Abs || contact.pins().count() == 0 {
            return Err(Failure::bad_input(
                Diagnostic::new(
                    codes::LAW_DOES_NOT_APPLY,
                    "--out draws a tendon over pins on silicone, and this configuration has none",
                )
                .with_help("give a configuration with pins and layout.substrate = \"silicone\""),
            ));
        }
        let heaviest = design.configuration().friction.load_max_n;
        let profiles = PROFILE_LOADS
            .iter()
            .map(|share| {
                let load = share * heaviest;
                contact_profile(contact, load, Direction::Eccentric).map(|profile| (load, profile))
            })
            .collect::<Result<Vec<_>, _>>()
            .map_err(Failure::failed)?;
        let title = format!("{}: the tendon over its pins", design.configuration().switch.name);
        let svg = contact_svg(&title, &profiles).map_err(Failure::failed)?;
        let files = [("contact.svg", svg.into_bytes()), ("physics.json", to_json(&report)?)]
            .map(|(name, bytes)| OutputFile { name: name.to_owned(), bytes });
        SetFolder::lock(folder)?.replace(&files)?;
        log::info!("{}: contact.svg, physics.json", folder.display());
    }
    if arguments.json { print_json(&report) } else { print_text(&text(&report)) }
}

fn report() -> Result<Report, FitError> {
    let bed = Bed::published();
    Ok(Report {
        bed,
        fit: fit_maxima(&bed)?,
        left_out: leave_one_layout_out(&bed)?,
        evidence: validate_laws()?,
        hypotheses: hypotheses().iter().map(|h| h.test()).collect::<Result<_, _>>()?,
    })
}

fn text(report: &Report) -> String {
    let (fit, percent) = (&report.fit, |share: f64| format!("{:+.1} %", 100.0 * share));
    let sd = |i: usize| 100.0 * fit.covariance[i][i].sqrt();
    let mut text = format!(
        "Constants, fitted to the seven published maxima (RMS error {:.1} %):\n\
         \x20 kappa  {:.4} N^-0.5  +- {:.1} %   ploughing of the coating by a pin, mu = kappa sqrt(N)\n\
         \x20 mu_s   {:.4}         +- {:.1} %   coated tendon on silicone\n\
         \x20 N0     {:.2} N         +- {:.1} %   force that sinks a pin flush with the silicone\n\n",
        100.0 * fit.rms,
        fit.constants.kappa_per_sqrt_n,
        sd(0),
        fit.constants.mu_silicone,
        sd(1),
        fit.constants.flush_force_n,
        sd(2)
    );
    text += "Error of each law on the seven maxima: in-sample / leave-one-layout-out\n";
    text += &format!("{:<26}", "");
    for law in &report.evidence {
        let default = if law.law == Law::DEFAULT { ", the default" } else { "" };
        text += &format!("{:<22}", format!("{}{default}", law.law.as_str()));
    }
    text.push('\n');
    let pair = |a: Option<f64>, b: Option<f64>| {
        let shown = |share: Option<f64>| share.map_or("-".to_owned(), percent);
        if a.or(b).is_none() { "-".to_owned() } else { format!("{} / {}", shown(a), shown(b)) }
    };
    let maxima = report.evidence.first().map_or(0, |law| law.errors.len());
    for row in 0..maxima {
        let name = report.evidence.first().map_or("", |law| law.errors[row].maximum.as_str());
        text += &format!("{name:<26}");
        for law in &report.evidence {
            text += &format!("{:<22}", pair(law.errors[row].in_sample, law.errors[row].left_out));
        }
        text = text.trim_end().to_owned() + "\n";
    }
    text += &format!("{:<26}", "root mean square");
    for law in &report.evidence {
        text += &format!("{:<22}", pair(law.rms_in_sample, law.rms_left_out).replace('+', ""));
    }
    text = text.trim_end().to_owned() + "\n";
    text += "\nPath of the tendon outside the pins: relative likelihood of each hypothesis at its best constants, and the\n\
             published facts against it, in standard deviations:\n";
    for (finding, weight) in report.hypotheses.iter().zip(weights(&report.hypotheses)) {
        text += &format!("{:>4.0} %  {}\n", 100.0 * weight, finding.hypothesis.name);
        for c in finding
            .compared
            .iter()
            .filter(|c| c.chi_squared > MIN_CHI_SQUARED && c.fact != "the seven maxima")
        {
            text += &format!("          {:.1} sd from {}: {}\n", c.chi_squared.sqrt(), c.fact, c.here);
        }
    }
    text += "No hypothesis explains the friction of three-double, 14 % above three-single at the heaviest load.\n";
    text
}
