//! Effects of one's own as the text of a file.

use std::fmt::Write;

use super::definition::EffectDefinition;
use super::file::SCHEMA;

/// The text of a file of effects.
///
/// ```
/// use pinswitch_calibration::effects::{EffectDefinition, effect_named, own_effects_text};
///
/// let rate = effect_named("rate_dependence").ok_or("not in the catalogue")?;
/// let text = own_effects_text(&[EffectDefinition::of(rate)?]);
/// assert!(text.contains("formula = \"k*ln(speed_pct/mean_speed_pct)\"\n"));
/// # Ok::<(), &str>(())
/// ```
pub fn own_effects_text<'a>(effects: impl IntoIterator<Item = &'a EffectDefinition>) -> String {
    format!("schema = \"{SCHEMA}\"\n{}", own_effect_blocks(effects))
}

/// The `[[effect]]` tables alone, each after an empty line.
pub fn own_effect_blocks<'a>(effects: impl IntoIterator<Item = &'a EffectDefinition>) -> String {
    let mut text = String::new();
    for effect in effects {
        let rivals: Vec<String> = effect.confused_with.iter().map(|id| quoted(id)).collect();
        // A string takes whatever is written to it.
        let _ = write!(
            text,
            "\n[[effect]]\nid = {}\nside = {}\ncovariate = {}\nacts_on = {}\ncombine = {}\nformula = {}\none_sided = {}\n\
             confused_with = [{}]\nexperiment = {}\n",
            quoted(&effect.id),
            quoted(effect.side.as_str()),
            quoted(effect.covariate.as_str()),
            quoted(effect.acts_on.as_str()),
            quoted(effect.combine.as_str()),
            quoted(&effect.formula),
            effect.one_sided,
            rivals.join(", "),
            quoted(&effect.experiment),
        );
        if let Some(drawn_from) = &effect.drawn_from {
            let readings: Vec<String> = drawn_from.iter().map(|of| quoted(of)).collect();
            let _ = writeln!(text, "drawn_from = [{}]", readings.join(", "));
        }
        for p in &effect.parameters {
            let (start, unit) = (number(p.start), quoted(&p.unit));
            let _ = match p.bounds {
                None => writeln!(
                    text,
                    "parameters.{} = {{ size = true, start = {start}, unit = {unit} }}",
                    p.name
                ),
                Some((low, high)) => writeln!(
                    text,
                    "parameters.{} = {{ start = {start}, low = {}, high = {}, unit = {unit} }}",
                    p.name,
                    number(low),
                    number(high)
                ),
            };
        }
    }
    text
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn number(value: f64) -> String {
    toml::Value::Float(value).to_string()
}
