//! `pinswitch power PLAN.toml`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_simulation::{NoisePlan, Plan, power};

use super::calibrated_curve::read_model;
use super::user_effects::UserEffects;
use super::{Failure, print_json, print_text};
use crate::input::read_text_file;

/// Estimate which effects a planned experiment could detect and separate.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch power plan.toml --runs 5
  pinswitch power plan.toml --noise calibration/model.toml")]
pub(super) struct Arguments {
    /// Plan, as for `simulate`; each effect is added to it in turn.
    plan: PathBuf,
    /// Simulated experiments per effect and size.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=1000))]
    runs: u64,
    /// model.toml of a calibration; its noise replaces the plan's.
    #[arg(long, value_name = "TOML")]
    noise: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    effects: UserEffects,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.plan.display().to_string();
    let text = read_text_file(&arguments.plan)?;
    let vocabulary = arguments.effects.vocabulary()?;
    let bad_input = Failure::bad_input;
    let mut plan = Plan::parse_among(&text, &name, &vocabulary).map_err(bad_input)?;
    if let Some(model) = &arguments.noise {
        plan.noise = noise_of(model)?;
        plan.check(&name).map_err(bad_input)?;
    }
    let all = power(&plan, arguments.runs);
    if arguments.json {
        return print_json(&all);
    }
    let mut table = format!(
        "{:<26} {:<18} attributed  ambiguous  missed  other effects attributed\n",
        "effect", "constants"
    );
    for p in &all {
        let values: Vec<String> = p.values.iter().map(|v| format!("{v:.3}")).collect();
        let others: Vec<String> = p.others.iter().map(|(id, n)| format!("{id} {n}")).collect();
        let row = format!(
            "{:<26} {:<18} {:>7}/{:<2} {:>7}/{:<2}  {:>4}/{:<2} {}",
            p.id,
            values.join(", "),
            p.named,
            p.runs,
            p.ambiguous,
            p.runs,
            p.missed,
            p.runs,
            others.join(", ")
        );
        table.push_str(row.trim_end());
        table.push('\n');
    }
    print_text(&table)
}

/// Returns the noise of a calibrated rig.
///
/// # Errors
/// [`Failure::bad_input`] if the model cannot be read.
pub(super) fn noise_of(model: &Path) -> Result<NoisePlan, Failure> {
    let (model, _) = read_model(model)?;
    Ok(NoisePlan::from_estimate(model.noise()))
}
