//! Reader of files of user-defined effects.

use std::ops::Range;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes, excerpt};
use pinswitch_friction::sort_by_number;
use schemars::{Schema, json_schema};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::OwnEffect;
use super::definition::{DefinitionError, EffectDefinition, OwnParameter, Part};
use super::unknown_name::unknown_name;
use crate::effects::{ActsOn, Combine, Covariate, Side, Vocabulary};
use pinswitch_measurements::toml_error;

/// Name and version of the format.
pub(super) const SCHEMA: &str = "pinswitch.effects/1";
/// Words of `combine`. `sum` was written by earlier versions and is read as `add`.
const COMBINE: [(&str, Combine); 3] =
    [("factor", Combine::Factor), ("add", Combine::Sum), ("sum", Combine::Sum)];
/// Most effects of a file.
const MAX_EFFECTS: usize = 32;
/// Most bytes of a file.
const MAX_BYTES: usize = 1 << 20;

/// A value with its span in the text.
type Value<'a> = Spanned<DeValue<'a>>;

/// Text of a file.
struct Source<'a> {
    text: &'a str,
    file: &'a str,
}

impl Source<'_> {
    fn error(&self, code: Code, at: usize, problem: impl Into<String>) -> Diagnostic {
        self.locate(at, Diagnostic::new(code, problem))
    }

    /// Returns the diagnostic at a byte of the text.
    fn locate(&self, at: usize, diagnostic: Diagnostic) -> Diagnostic {
        diagnostic.with_location(Location::in_text(self.file, self.text, at..at))
    }

    /// Returns the position in the text of byte `at` of a string; of a string with escapes, its
    /// start.
    fn inside(&self, string: Range<usize>, at: usize) -> usize {
        let raw = self.text.get(string.clone()).unwrap_or_default();
        let quote = if raw.starts_with("\"\"\"") || raw.starts_with("'''") { 3 } else { 1 };
        let first_line = raw.get(quote..).map_or(0, |inner| {
            if quote == 1 {
                0
            } else {
                usize::from(inner.starts_with("\r\n")) + usize::from(inner.starts_with(['\r', '\n']))
            }
        });
        if raw.starts_with('"') && raw.contains('\\') {
            return string.start;
        }
        (string.start + quote + first_line + at).min(string.end)
    }
}

/// Reads the effects of a file, in addition to those of a vocabulary, to which [`Vocabulary::with`]
/// adds them. `file` is the name of the file in errors.
///
/// # Errors
/// A [`Diagnostic`] of the first problem, with line and column.
pub fn read_own_effects(
    text: &str,
    file: &str,
    vocabulary: &Vocabulary,
) -> Result<Vec<OwnEffect>, Diagnostic> {
    let source = Source { text, file };
    if text.len() > MAX_BYTES {
        let problem = format!("the file has {} bytes, at most {MAX_BYTES} are possible", text.len());
        return Err(source.error(codes::FILE_TOO_LARGE, 0, problem).with_help("split it into several files"));
    }
    let root = document(&source)?;
    let table = Table { source: &source, table: root.get_ref(), at: 0, what: "the file" };
    table.only(&["schema", "effect"])?;
    let (schema, at) = table.string("schema", &format!("start with schema = \"{SCHEMA}\""))?;
    if schema != SCHEMA {
        let problem = format!("unknown schema '{}'", excerpt(schema, 80));
        return Err(source
            .error(codes::OTHER_KIND_OF_FILE, at.start, problem)
            .with_help(format!("write schema = \"{SCHEMA}\"")));
    }
    if !root.get_ref().contains_key("effect") {
        return Err(source
            .error(codes::MISSING_FIELD, 0, "the file contains no effect")
            .with_help("start one with [[effect]]; `pinswitch init effects` writes an example"));
    }
    let effects = blocks(&source, root.get_ref())?;
    for (i, effect) in effects.iter().enumerate() {
        check_formula(&source, effect)?;
        let id = &effect.own.definition().id;
        let is_repeated = effects[..i].iter().any(|other| other.own.definition().id == *id);
        if is_repeated || vocabulary.named(id).is_some() {
            return Err(source
                .error(codes::DUPLICATE_ENTRY, effect.id_at, format!("duplicate id '{id}'"))
                .with_help("give each effect its own id"));
        }
        for (rival, at) in effect.own.definition().confused_with.iter().zip(&effect.rivals_at) {
            let is_here = effects.iter().any(|other| other.own.definition().id == *rival);
            if !is_here && vocabulary.named(rival).is_none() {
                let own = effects.iter().map(|other| other.own.definition().id.as_str());
                let known = own.chain(vocabulary.acting_order().iter().map(|effect| effect.id()));
                return Err(source.locate(*at, unknown_name(codes::UNKNOWN_NAME, "effect", rival, known)));
            }
        }
    }
    Ok(effects.into_iter().map(|effect| effect.own).collect())
}

/// Checks that a fit of an effect is well posed.
fn check_formula(source: &Source<'_>, effect: &Placed) -> Result<(), Diagnostic> {
    if let Some(names) = effect.own.unidentifiable_constants() {
        let problem = format!(
            "constants {} are not identifiable: a change of one is compensated by the others",
            names.join(" and ")
        );
        return Err(source
            .error(codes::CONSTANTS_NOT_IDENTIFIABLE, effect.formula_at, problem)
            .with_help("leave out one of them"));
    }
    if let Some(name) = effect.own.step_parameter() {
        let problem = format!("the effect changes only in steps with '{name}', which a fit cannot follow");
        let help = format!(
            "replace the comparison by a narrow slope, such as 0.5*(1 + tanh((time - {name})/0.004)), or the parameter by a number"
        );
        return Err(source.error(codes::EFFECT_IN_STEPS, effect.formula_at, problem).with_help(help));
    }
    if effect.own.is_nonlinear_in_sizes() {
        return Err(source
            .error(
                codes::EFFECT_NOT_LINEAR,
                effect.formula_at,
                "the effect is not linear in its sizes near zero",
            )
            .with_help("write k*f or exp(k*f) - 1 in place of k^2, abs(k) or sqrt(k)"));
    }
    Ok(())
}

/// Reads the effects that a model file contains. Their rivals need not be in the file.
pub(crate) fn effects_of_model(text: &str, file: &str) -> Result<Vec<OwnEffect>, Diagnostic> {
    let source = Source { text, file };
    let root = document(&source)?;
    let effects = blocks(&source, root.get_ref())?;
    for (i, effect) in effects.iter().enumerate() {
        let id = &effect.own.definition().id;
        if effects[..i].iter().any(|other| other.own.definition().id == *id) {
            return Err(source.error(codes::DUPLICATE_ENTRY, effect.id_at, format!("duplicate id '{id}'")));
        }
    }
    Ok(effects.into_iter().map(|effect| effect.own).collect())
}

fn document<'a>(source: &Source<'a>) -> Result<Spanned<DeTable<'a>>, Diagnostic> {
    DeTable::parse(source.text).map_err(|e| {
        toml_error(source.file, source.text, &e).with_help("see model/doc/own-effects.md for the format")
    })
}

/// An effect with the positions that later checks refer to.
struct Placed {
    own: OwnEffect,
    id_at: usize,
    formula_at: usize,
    rivals_at: Vec<usize>,
}

fn blocks(source: &Source<'_>, root: &DeTable<'_>) -> Result<Vec<Placed>, Diagnostic> {
    let Some(value) = root.get("effect") else { return Ok(Vec::new()) };
    let Some(all) = value.get_ref().as_array() else {
        return Err(source
            .error(codes::WRONG_TYPE, value.span().start, "effect is not a list of tables")
            .with_help("start each effect with [[effect]]"));
    };
    if all.len() > MAX_EFFECTS {
        let problem = format!("{} effects, at most {MAX_EFFECTS} are possible", all.len());
        return Err(source.error(codes::TOO_MANY_ENTRIES, value.span().start, problem));
    }
    all.iter().map(|value| effect(source, value)).collect()
}

/// A table with its name in errors.
struct Table<'a> {
    source: &'a Source<'a>,
    table: &'a DeTable<'a>,
    at: usize,
    what: &'a str,
}

impl<'a> Table<'a> {
    fn new(source: &'a Source<'a>, value: &'a Value<'a>, what: &'a str) -> Result<Self, Diagnostic> {
        let at = value.span().start;
        match value.get_ref().as_table() {
            Some(table) => Ok(Self { source, table, at, what }),
            None => Err(source.error(codes::WRONG_TYPE, at, format!("{what} is not a table"))),
        }
    }

    /// Refuses all other keys.
    fn only(&self, keys: &[&str]) -> Result<(), Diagnostic> {
        let mut others = self.table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        others.next().map_or(Ok(()), |key| {
            let error = unknown_name(codes::UNKNOWN_FIELD, "key", key.get_ref(), keys.iter().copied());
            Err(self.source.locate(key.span().start, error))
        })
    }

    fn missing(&self, key: &str, help: &str) -> Diagnostic {
        self.source.error(codes::MISSING_FIELD, self.at, format!("{} lacks {key}", self.what)).with_help(help)
    }

    fn wrong(&self, key: &str, value: &Value<'_>, expected: &str) -> Diagnostic {
        self.source.error(codes::WRONG_TYPE, value.span().start, format!("{key}: expected {expected}"))
    }

    fn string(&self, key: &str, help: &str) -> Result<(&'a str, Range<usize>), Diagnostic> {
        let value = self.table.get(key).ok_or_else(|| self.missing(key, help))?;
        let text = value.get_ref().as_str();
        text.map(|text| (text, value.span())).ok_or_else(|| self.wrong(key, value, "a string in quotes"))
    }

    /// Reads a word of a list.
    fn word<T: Copy>(&self, key: &str, words: &[(&'static str, T)]) -> Result<T, Diagnostic> {
        let help = format!("use one of {}", words.iter().map(|w| w.0).collect::<Vec<_>>().join(", "));
        let (text, at) = self.string(key, &help)?;
        words.iter().find(|w| w.0 == text).map(|w| w.1).ok_or_else(|| {
            self.source
                .error(codes::UNKNOWN_WORD, at.start, format!("unknown {key} '{}'", excerpt(text, 60)))
                .with_help(help.as_str())
        })
    }

    fn boolean(&self, key: &str) -> Result<bool, Diagnostic> {
        let Some(value) = self.table.get(key) else { return Ok(false) };
        value.get_ref().as_bool().ok_or_else(|| self.wrong(key, value, "true or false"))
    }

    fn number(&self, key: &str) -> Result<Option<f64>, Diagnostic> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        let number = match value.get_ref() {
            DeValue::Float(number) => number.as_str().parse().ok(),
            DeValue::Integer(number) => {
                i64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64)
            }
            _ => None,
        };
        number.map(Some).ok_or_else(|| self.wrong(key, value, "a number"))
    }
}

/// Keys of an effect.
const KEYS: [&str; 11] = [
    "id",
    "side",
    "covariate",
    "acts_on",
    "combine",
    "formula",
    "one_sided",
    "confused_with",
    "experiment",
    "drawn_from",
    "parameters",
];

/// Keys of a constant of an effect.
const PARAMETER_KEYS: [&str; 5] = ["size", "start", "low", "high", "unit"];

/// Returns the JSON Schema of a file of effects.
pub fn effects_schema() -> Schema {
    let text = |description: &str| json_schema!({ "type": "string", "description": description });
    let parameter = json_schema!({
        "type": "object",
        "properties": {
            "size": { "type": "boolean", "description": "Whether the effect is proportional to it." },
            "start": { "type": "number", "description": "Value at which a fit starts." },
            "low": { "type": "number" },
            "high": { "type": "number" },
            "unit": { "type": "string" },
        },
        "required": ["start", "unit"],
        "additionalProperties": false,
    });
    let words = |all: Vec<&str>| json_schema!({ "enum": all });
    let ids = json_schema!({ "type": "array", "items": { "type": "string" } });
    let property = |key: &str| match key {
        "side" => words([Side::Switch, Side::Rig].map(Side::as_str).to_vec()),
        "covariate" => words(Covariate::ALL.map(Covariate::as_str).to_vec()),
        "acts_on" => words(ActsOn::ALL.map(ActsOn::as_str).to_vec()),
        "combine" => words(COMBINE.map(|(word, _)| word).to_vec()),
        "one_sided" => {
            json_schema!({ "type": "boolean", "description": "Whether its first size is positive." })
        }
        "confused_with" | "drawn_from" => ids.clone(),
        "parameters" => json_schema!({ "type": "object", "additionalProperties": parameter }),
        "formula" => text("Formula, such as `k*ln(speed_pct/50)`."),
        _ => json_schema!({ "type": "string" }),
    };
    let properties: std::collections::BTreeMap<&str, Schema> =
        KEYS.iter().map(|key| (*key, property(key))).collect();
    json_schema!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Effects of a tendon rig (pinswitch)",
        "type": "object",
        "properties": {
            "schema": { "const": SCHEMA },
            "effect": {
                "type": "array",
                "items": {
                    "type": "object",
                    "properties": properties,
                    "required": ["id", "side", "covariate", "acts_on", "combine", "formula", "parameters"],
                    "additionalProperties": false,
                },
            },
        },
        "required": ["schema", "effect"],
        "additionalProperties": false,
    })
}

fn effect(source: &Source<'_>, value: &Value<'_>) -> Result<Placed, Diagnostic> {
    let table = Table::new(source, value, "the effect")?;
    table.only(&KEYS)?;
    let (id, id_at) = table.string("id", "give it a name, such as id = \"lubricant_dip\"")?;
    let (formula, formula_at) =
        table.string("formula", "write one, such as formula = \"k*ln(speed_pct/50)\"")?;
    let (parameters, parameters_at) = parameters(&table)?;
    let (confused_with, rivals_at) =
        words(&table, "confused_with", "a list of ids, such as [\"rate_dependence\"]")?;
    let is_declared = table.table.contains_key("drawn_from");
    let (drawn_from, _) = words(&table, "drawn_from", "a list of strings, as `calibrate` writes it")?;
    let experiment = match table.table.contains_key("experiment") {
        true => table.string("experiment", "")?.0,
        false => "",
    };
    let definition = EffectDefinition {
        id: id.to_owned(),
        side: table.word("side", &[Side::Switch, Side::Rig].map(|s| (s.as_str(), s)))?,
        covariate: table.word("covariate", &Covariate::ALL.map(|c| (c.as_str(), c)))?,
        acts_on: table.word("acts_on", &ActsOn::ALL.map(|a| (a.as_str(), a)))?,
        combine: table.word("combine", &COMBINE)?,
        formula: formula.to_owned(),
        one_sided: table.boolean("one_sided")?,
        confused_with,
        experiment: experiment.to_owned(),
        drawn_from: is_declared.then_some(drawn_from),
        parameters,
    };
    let own = OwnEffect::new(definition).map_err(|DefinitionError { part, diagnostic }| {
        let at = match part {
            Part::Formula(span) => {
                let [start, end] = [span.start, span.end].map(|byte| source.inside(formula_at.clone(), byte));
                return diagnostic.with_location(Location::in_text(source.file, source.text, start..end));
            }
            Part::Id => id_at.start,
            Part::Parameter(i) => parameters_at.get(i).copied().unwrap_or(table.at),
            Part::Parameters => key_at(&table, "parameters"),
            Part::ConfusedWith => key_at(&table, "confused_with"),
            Part::Experiment => key_at(&table, "experiment"),
            Part::DrawnFrom => key_at(&table, "drawn_from"),
        };
        source.locate(at, diagnostic)
    })?;
    Ok(Placed { own, id_at: id_at.start, formula_at: formula_at.start, rivals_at })
}

/// Returns the position of a key, or of the table that lacks it.
fn key_at(table: &Table<'_>, key: &str) -> usize {
    table.table.get_key_value(key).map_or(table.at, |(key, _)| key.span().start)
}

/// Reads the constants in the order of the file, with their positions.
fn parameters(effect: &Table<'_>) -> Result<(Vec<OwnParameter>, Vec<usize>), Diagnostic> {
    let example = "write one, such as parameters.k = { size = true, start = 0.1, unit = \"1\" }";
    let value = effect.table.get("parameters").ok_or_else(|| effect.missing("parameters", example))?;
    let all = Table::new(effect.source, value, "parameters")?;
    let mut named: Vec<_> = all.table.iter().collect();
    sort_by_number(&mut named, |(name, _)| name.span().start as f64);
    let mut parameters = Vec::new();
    for (name, value) in &named {
        let what = format!("parameter '{}'", excerpt(name.get_ref(), 60));
        let table = Table::new(effect.source, value, &what)?;
        table.only(&PARAMETER_KEYS)?;
        let size = table.boolean("size")?;
        let (low, high) = (table.number("low")?, table.number("high")?);
        let start = table
            .number("start")?
            .ok_or_else(|| table.missing("start", "give the value at which a fit starts"))?;
        let bounds = match (size, low, high) {
            (true, None, None) => None,
            (false, Some(low), Some(high)) => Some((low, high)),
            (true, ..) => {
                return Err(effect
                    .source
                    .error(
                        codes::CONFLICTING_SETTINGS,
                        table.at,
                        format!("{what}: a size cannot have bounds"),
                    )
                    .with_help("leave out low and high; one_sided = true keeps the first size positive"));
            }
            (false, ..) => {
                return Err(table.missing("low and high", "give both bounds of a shape, or size = true"));
            }
        };
        let (unit, _) = table.string("unit", "write unit = \"1\" for none")?;
        let name = name.get_ref().to_string();
        parameters.push(OwnParameter { name, unit: unit.to_owned(), start, bounds });
    }
    Ok((parameters, named.iter().map(|(name, _)| name.span().start).collect()))
}

/// Reads a list of strings, with their positions; empty if the key is absent.
fn words(effect: &Table<'_>, key: &str, expected: &str) -> Result<(Vec<String>, Vec<usize>), Diagnostic> {
    let Some(value) = effect.table.get(key) else { return Ok((Vec::new(), Vec::new())) };
    let wrong = |value| effect.wrong(key, value, expected);
    let all = value.get_ref().as_array().ok_or_else(|| wrong(value))?;
    let (mut texts, mut positions) = (Vec::new(), Vec::new());
    for word in all {
        let text = word.get_ref().as_str().ok_or_else(|| wrong(word))?;
        texts.push(text.to_owned());
        positions.push(word.span().start);
    }
    Ok((texts, positions))
}
