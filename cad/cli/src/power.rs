//! `pinswitch power PLAN.toml`.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_calibration::ModelFile;
use pinswitch_calibration::inference::Levels;
use pinswitch_simulation::{NoisePlan, Plan, power};

use super::own_effects::OwnEffects;
use super::{Failure, print, print_json};
use crate::input::read_text_file;

/// Tell before any measurement which effects of which size a planned experiment could see and tell apart.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch power plan.toml --runs 5
  pinswitch power plan.toml --noise calibration/model.toml")]
pub(super) struct Arguments {
    /// The plan, as for `simulate`; each effect is put into it in turn.
    plan: PathBuf,
    /// Simulated experiments per effect and size.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=1000))]
    runs: u64,
    /// The model.toml of a calibration whose noise the rig has, instead of the plan's.
    #[arg(long, value_name = "TOML")]
    noise: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    own: OwnEffects,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.plan.display().to_string();
    let text = read_text_file(&arguments.plan)?;
    let vocabulary = arguments.own.vocabulary()?;
    let mut plan = Plan::parse_among(&text, &name, &vocabulary).map_err(Failure::bad_input)?;
    if let Some(model) = &arguments.noise {
        plan.noise = noise_of(model)?;
        plan.check(&name).map_err(Failure::bad_input)?;
    }
    let all = power(&plan, arguments.runs, Levels::default());
    if arguments.json {
        return print_json(&all);
    }
    let mut table =
        format!("{:<26} {:<18} named  rivals  missed  named with it or instead\n", "effect", "constants");
    for p in &all {
        let values: Vec<String> = p.values.iter().map(|v| format!("{v:.3}")).collect();
        let others: Vec<String> = p.others.iter().map(|(id, n)| format!("{id} {n}")).collect();
        table.push_str(&format!(
            "{:<26} {:<18} {:>2}/{:<2}  {:>2}/{:<2}   {:>2}/{:<2}   {}\n",
            p.id,
            values.join(", "),
            p.named,
            p.runs,
            p.ambiguous,
            p.runs,
            p.missed,
            p.runs,
            others.join(", ")
        ));
    }
    print(table.as_bytes())
}

/// The noise that a calibration found.
pub(super) fn noise_of(model: &Path) -> Result<NoisePlan, Failure> {
    let name = model.display().to_string();
    let file = ModelFile::parse(&read_text_file(model)?, &name).map_err(Failure::bad_input)?;
    Ok(NoisePlan::from_estimate(file.noise()))
}
