//! `pinswitch effects`.

use clap::Args;
use pinswitch_calibration::effects::{
    Description, EffectDefinition, Parameter, Vocabulary, formula_variables, own_effects_text,
};
use schemars::JsonSchema;
use serde::Serialize;

use super::user_effects::UserEffects;
use super::{Failure, print_data, print_json, print_text};

/// List the effects that a calibration tests.
///
/// Each has an id, a side (switch or rig), a covariate and a formula.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch effects
  pinswitch effects --toml
  pinswitch effects --effects mine.toml --json")]
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
    /// Print JSON instead of a table.
    #[arg(long, conflicts_with_all = ["toml", "variables"])]
    json: bool,
}

/// An effect, as `--json` prints it.
#[derive(Serialize, JsonSchema)]
pub(super) struct ListedEffect {
    /// Id, a heading of the effect catalogue.
    id: String,
    /// Whether it belongs to the part, `switch`, or to the measurement, `rig`.
    side: String,
    /// Covariate along which it shows.
    covariate: String,
    /// Formula in the symbols of the effect catalogue.
    formula: String,
    /// Constants, sizes before shapes.
    constants: Vec<ListedConstant>,
    /// Ids of effects that may look the same.
    confused_with: Vec<String>,
    /// Experiment that separates it from those.
    experiment: String,
}

/// A constant of an effect.
#[derive(Serialize, JsonSchema)]
struct ListedConstant {
    /// Symbol.
    name: String,
    /// Unit; `1` if dimensionless.
    unit: String,
    /// Bounds of a shape; null for a size, which is free.
    bounds: Option<[f64; 2]>,
}

impl ListedEffect {
    fn new(description: &Description<'_>) -> Self {
        let constant = |of: &Parameter| ListedConstant {
            name: of.name.to_string(),
            unit: of.unit.to_string(),
            bounds: of.bounds.map(|(least, most)| [least, most]),
        };
        Self {
            id: description.id.to_owned(),
            side: description.side.as_str().to_owned(),
            covariate: description.covariate.as_str().to_owned(),
            formula: description.formula.to_owned(),
            constants: description.parameters.iter().map(constant).collect(),
            confused_with: description.confused_with.iter().map(ToString::to_string).collect(),
            experiment: description.experiment.to_owned(),
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let vocabulary = arguments.effects.vocabulary()?;
    if arguments.json {
        let all: Vec<_> =
            vocabulary.effects().map(|effect| ListedEffect::new(&effect.description())).collect();
        return print_json(&all);
    }
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
