//! `pinswitch effects`.

use clap::Args;
use pinswitch_calibration::effects::{EffectDefinition, Vocabulary, formula_variables, own_effects_text};

use super::own_effects::OwnEffects;
use super::{Failure, print};

/// List the effects that a calibration tries: id, side, covariate and formula.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch effects
  pinswitch effects --toml
  pinswitch effects --effects mine.toml")]
pub(super) struct Arguments {
    #[command(flatten)]
    own: OwnEffects,
    /// Write them as a file of effects of one's own, as far as formulas can say them; give those you keep ids of your own.
    #[arg(long, conflicts_with = "variables")]
    toml: bool,
    /// List what formulas may read instead.
    #[arg(long)]
    variables: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let vocabulary = arguments.own.vocabulary()?;
    let text = match (arguments.toml, arguments.variables) {
        (true, _) => toml(&vocabulary),
        (false, true) => variables(),
        (false, false) => listing(&vocabulary),
    };
    print(text.as_bytes())
}

fn listing(vocabulary: &Vocabulary) -> String {
    let mut text = format!("{:<24} {:<7} {:<11} formula\n", "effect", "side", "covariate");
    for effect in vocabulary.effects() {
        let told = effect.description();
        let (side, covariate) = (told.side.as_str(), told.covariate.as_str());
        text.push_str(&format!("{:<24} {side:<7} {covariate:<11} {}\n", told.id, told.formula));
    }
    text
}

fn variables() -> String {
    let mut text = format!("{:<20} {:<5} meaning\n", "variable", "unit");
    for [name, unit, meaning] in formula_variables() {
        text.push_str(&format!("{name:<20} {unit:<5} {meaning}\n"));
    }
    text.push_str(
        "functions: + - * / ^ exp ln sqrt abs sin cos tanh min max, and < <= > >= == != as 0 or 1\n",
    );
    text
}

fn toml(vocabulary: &Vocabulary) -> String {
    let (mut said, mut unsaid) = (Vec::new(), String::new());
    for effect in Vocabulary::built_in().effects() {
        match EffectDefinition::of(effect) {
            Ok(definition) => said.push(definition),
            Err(why) => unsaid.push_str(&format!("#   {}: {why}\n", effect.id())),
        }
    }
    let built_in = said.len();
    said.extend(vocabulary.own().map(|own| own.definition().clone()));
    let mut text = "# The built-in effects as formulas. Their ids are taken: give those that you keep ids of your own.\n".to_owned();
    if said.len() > built_in {
        text.push_str("# Those of your own stand after them, under their ids.\n");
    }
    text.push_str("# No formula of one row can say these:\n");
    text.push_str(&unsaid);
    text.push_str(&own_effects_text(&said));
    text
}
