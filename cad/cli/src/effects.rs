//! `pinswitch effects`.

use clap::Args;
use pinswitch_calibration::effects::{EffectDefinition, Vocabulary, formula_variables, own_effects_text};

use super::user_effects::UserEffects;
use super::{Failure, print_data, print_text};

/// List the effects that a calibration tests.
///
/// Each has an id, a side (switch or rig), a covariate and a formula.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch effects
  pinswitch effects --toml
  pinswitch effects --effects mine.toml")]
pub(super) struct Arguments {
    #[command(flatten)]
    effects: UserEffects,
    /// Print a file of user-defined effects instead, with every effect that a formula can express; the built-in ids are
    /// reserved, so rename those you keep.
    #[arg(long, conflicts_with = "variables")]
    toml: bool,
    /// List the variables and functions of formulas instead.
    #[arg(long)]
    variables: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let vocabulary = arguments.effects.vocabulary()?;
    match (arguments.toml, arguments.variables) {
        (true, _) => print_data(toml(&vocabulary).as_bytes()),
        (false, true) => print_text(&variables()),
        (false, false) => print_text(&listing(&vocabulary)),
    }
}

fn listing(vocabulary: &Vocabulary) -> String {
    let mut text = format!("{:<24} {:<7} {:<11} formula\n", "effect", "side", "covariate");
    for effect in vocabulary.effects() {
        let description = effect.description();
        let (side, covariate) = (description.side.as_str(), description.covariate.as_str());
        text.push_str(&format!("{:<24} {side:<7} {covariate:<11} {}\n", description.id, description.formula));
    }
    text
}

fn variables() -> String {
    let mut text = format!("{:<20} {:<5} meaning\n", "variable", "unit");
    for [name, unit, meaning] in formula_variables() {
        text.push_str(&format!("{name:<20} {unit:<5} {meaning}\n"));
    }
    text.push_str(
        "functions: + - * / ^ exp ln sqrt abs sin cos tanh min max; comparisons < <= > >= == != give 0 or 1\n",
    );
    text
}

/// Returns the effects as a TOML file; comments list the built-in effects that no formula of one row can express.
fn toml(vocabulary: &Vocabulary) -> String {
    let (mut definitions, mut inexpressible) = (Vec::new(), String::new());
    for effect in Vocabulary::built_in().effects() {
        match EffectDefinition::of(&*effect) {
            Ok(definition) => definitions.push(definition),
            Err(why) => inexpressible.push_str(&format!("#   {}: {why}\n", effect.id())),
        }
    }
    let built_in = definitions.len();
    definitions.extend(vocabulary.own().map(|effect| effect.definition().clone()));
    let mut text =
        "# The built-in effects as formulas. Their ids are reserved: rename those that you keep.\n"
            .to_owned();
    if definitions.len() > built_in {
        text.push_str("# User-defined effects follow them, with their ids.\n");
    }
    text.push_str("# A formula of one row cannot express these:\n");
    text.push_str(&inexpressible);
    text.push_str(&own_effects_text(&definitions));
    text
}
