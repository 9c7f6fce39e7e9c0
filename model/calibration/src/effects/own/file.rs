//! Reads a file of effects of one's own; errors point at line and column.

use std::ops::Range;

use pinswitch_diagnostic::excerpt;
use pinswitch_friction::sort_by_number;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::OwnEffect;
use super::definition::{DefinitionError, EffectDefinition, OwnParameter, Part};
use super::expression::unknown;
use crate::effects::{ActsOn, Combine, Covariate, Side, Vocabulary};

/// Name and version of the format.
pub(super) const SCHEMA: &str = "pinswitch.effects/1";
/// Words of `combine`. `sum` was written by earlier versions and is read as `add`.
const COMBINE: [(&str, Combine); 3] =
    [("factor", Combine::Factor), ("add", Combine::Sum), ("sum", Combine::Sum)];
/// Most effects of a file.
const MAX_EFFECTS: usize = 32;
/// Most bytes of a file.
const MAX_BYTES: usize = 1 << 20;

/// What is wrong with a file of effects, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}:{line}:{column}: {}", excerpt(file, 120), excerpt(problem, 430))]
pub struct OwnEffectError {
    /// File name as given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong, and what to do.
    pub problem: String,
}

/// A value with its place in the text.
type Value<'a> = Spanned<DeValue<'a>>;

/// The text that is read.
struct Source<'a> {
    text: &'a str,
    file: &'a str,
}

impl Source<'_> {
    fn error(&self, at: usize, problem: impl Into<String>) -> OwnEffectError {
        let before = self.text.get(..at).unwrap_or(self.text);
        let line_begins = before.rfind('\n').map_or(0, |i| i + 1);
        OwnEffectError {
            file: self.file.to_owned(),
            line: 1 + before.matches('\n').count(),
            column: 1 + before[line_begins..].chars().count(),
            problem: problem.into(),
        }
    }

    /// Where the byte `at` of a string stands in the text; of one with escapes, where it begins.
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

/// The effects of a file, in addition to those of a vocabulary, which [`Vocabulary::with`] makes them part of. `file` is the
/// name used in errors.
///
/// # Errors
/// [`OwnEffectError`] at the first thing that is wrong.
pub fn read_own_effects(
    text: &str,
    file: &str,
    vocabulary: &Vocabulary,
) -> Result<Vec<OwnEffect>, OwnEffectError> {
    let source = Source { text, file };
    if text.len() > MAX_BYTES {
        let problem = format!("{} bytes; {MAX_BYTES} are possible: give several files", text.len());
        return Err(source.error(0, problem));
    }
    let root = document(&source)?;
    let table = Table { source: &source, table: root.get_ref(), at: 0, what: "a file of effects" };
    table.only(&["schema", "effect"])?;
    let (schema, at) = table.string("schema", &format!("begin with schema = \"{SCHEMA}\""))?;
    if schema != SCHEMA {
        let problem = format!("schema '{}' is unknown; this version reads \"{SCHEMA}\"", excerpt(schema, 80));
        return Err(source.error(at.start, problem));
    }
    if !root.get_ref().contains_key("effect") {
        return Err(
            source.error(0, "no effect; begin one by [[effect]], `pinswitch init effects` writes an example")
        );
    }
    let found = blocks(&source, root.get_ref())?;
    for (i, effect) in found.iter().enumerate() {
        if let Some(alike) = effect.own.constants_not_told_apart() {
            let problem = format!(
                "no data can tell {} apart: what one does another makes up for; leave one out",
                alike.join(" and ")
            );
            return Err(source.error(effect.formula_at, problem));
        }
        if let Some(place) = effect.own.moved_by_jumps() {
            let problem = format!(
                "'{place}' moves the effect by jumps alone, which no fit can follow; write a narrow slope in place of the \
                 comparison, such as 0.5*(1 + tanh((time - {place})/0.004)), or a number in place of the parameter"
            );
            return Err(source.error(effect.formula_at, problem));
        }
        if let Some(problem) = effect.own.sizes_out_of_proportion() {
            return Err(source.error(effect.formula_at, problem));
        }
        let id = &effect.own.definition().id;
        let twice = found[..i].iter().any(|other| other.own.definition().id == *id);
        if twice || vocabulary.named(id).is_some() {
            return Err(
                source.error(effect.id_at, format!("id '{id}' is given twice; give each effect its own"))
            );
        }
        for (rival, at) in effect.own.definition().confused_with.iter().zip(&effect.rivals_at) {
            let here = found.iter().any(|other| other.own.definition().id == *rival);
            if !here && vocabulary.named(rival).is_none() {
                let own = found.iter().map(|other| other.own.definition().id.as_str());
                let known = own.chain(vocabulary.effects().map(|e| e.id()));
                let problem = format!("{}; a file with it must come first", unknown("effect", rival, known));
                return Err(source.error(*at, problem));
            }
        }
    }
    Ok(found.into_iter().map(|effect| effect.own).collect())
}

/// The effects that a model file carries. What they may be confused with need not be in it.
pub(crate) fn effects_of_model(text: &str, file: &str) -> Result<Vec<OwnEffect>, OwnEffectError> {
    let source = Source { text, file };
    let root = document(&source)?;
    let found = blocks(&source, root.get_ref())?;
    for (i, effect) in found.iter().enumerate() {
        let id = &effect.own.definition().id;
        if found[..i].iter().any(|other| other.own.definition().id == *id) {
            return Err(source.error(effect.id_at, format!("id '{id}' is given twice")));
        }
    }
    Ok(found.into_iter().map(|effect| effect.own).collect())
}

fn document<'a>(source: &Source<'a>) -> Result<Spanned<DeTable<'a>>, OwnEffectError> {
    DeTable::parse(source.text).map_err(|e| {
        let at = e.span().map_or(0, |span| span.start);
        source.error(
            at,
            format!("{}; model/doc/own-effects.md shows the form", e.message().trim().replace('\n', ", ")),
        )
    })
}

/// An effect with the places that are looked at again once all are read.
struct Placed {
    own: OwnEffect,
    id_at: usize,
    formula_at: usize,
    rivals_at: Vec<usize>,
}

fn blocks(source: &Source<'_>, root: &DeTable<'_>) -> Result<Vec<Placed>, OwnEffectError> {
    let Some(value) = root.get("effect") else { return Ok(Vec::new()) };
    let Some(all) = value.get_ref().as_array() else {
        return Err(source.error(value.span().start, "effect is no list of tables; begin each by [[effect]]"));
    };
    if all.len() > MAX_EFFECTS {
        return Err(
            source.error(value.span().start, format!("{} effects; {MAX_EFFECTS} are possible", all.len()))
        );
    }
    all.iter().map(|value| effect(source, value)).collect()
}

/// A table with what it is in errors.
struct Table<'a> {
    source: &'a Source<'a>,
    table: &'a DeTable<'a>,
    at: usize,
    what: &'a str,
}

impl<'a> Table<'a> {
    fn new(source: &'a Source<'a>, value: &'a Value<'a>, what: &'a str) -> Result<Self, OwnEffectError> {
        let at = value.span().start;
        match value.get_ref().as_table() {
            Some(table) => Ok(Self { source, table, at, what }),
            None => Err(source.error(at, format!("{what} is no table"))),
        }
    }

    /// No keys but these.
    fn only(&self, keys: &[&str]) -> Result<(), OwnEffectError> {
        let mut others = self.table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        others.next().map_or(Ok(()), |key| {
            let problem = unknown("key", key.get_ref(), keys.iter().copied());
            Err(self.source.error(key.span().start, format!("{}: {problem}", self.what)))
        })
    }

    fn missing(&self, key: &str, remedy: &str) -> OwnEffectError {
        self.source.error(self.at, format!("{} has no {key}; {remedy}", self.what))
    }

    fn wrong(&self, key: &str, at: usize, needed: &str) -> OwnEffectError {
        self.source.error(at, format!("{key} is no {needed}"))
    }

    fn string(&self, key: &str, remedy: &str) -> Result<(&'a str, Range<usize>), OwnEffectError> {
        let value = self.table.get(key).ok_or_else(|| self.missing(key, remedy))?;
        let text = value.get_ref().as_str();
        text.map(|text| (text, value.span()))
            .ok_or_else(|| self.wrong(key, value.span().start, "text in quotes"))
    }

    /// A word of a list.
    fn word<T: Copy>(&self, key: &str, words: &[(&'static str, T)]) -> Result<T, OwnEffectError> {
        let listed = words.iter().map(|w| w.0).collect::<Vec<_>>().join(", ");
        let (found, at) = self.string(key, &format!("it is one of {listed}"))?;
        words.iter().find(|w| w.0 == found).map(|w| w.1).ok_or_else(|| {
            let problem = format!("{key} = '{}' is unknown; it is one of {listed}", excerpt(found, 60));
            self.source.error(at.start, problem)
        })
    }

    fn boolean(&self, key: &str) -> Result<bool, OwnEffectError> {
        let Some(value) = self.table.get(key) else { return Ok(false) };
        value.get_ref().as_bool().ok_or_else(|| self.wrong(key, value.span().start, "true or false"))
    }

    fn number(&self, key: &str) -> Result<Option<f64>, OwnEffectError> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        let number = match value.get_ref() {
            DeValue::Float(number) => number.as_str().parse().ok(),
            DeValue::Integer(number) => {
                i64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64)
            }
            _ => None,
        };
        number.map(Some).ok_or_else(|| self.wrong(key, value.span().start, "number"))
    }
}

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

fn effect(source: &Source<'_>, value: &Value<'_>) -> Result<Placed, OwnEffectError> {
    let table = Table::new(source, value, "an effect")?;
    table.only(&KEYS)?;
    let (id, id_at) = table.string("id", "give it a name such as id = \"lubricant_dip\"")?;
    let (formula, formula_at) = table.string("formula", "such as formula = \"k*ln(speed_pct/50)\"")?;
    let (parameters, parameters_at) = parameters(&table)?;
    let (confused_with, rivals_at) =
        words(&table, "confused_with", "list of ids, such as [\"rate_dependence\"]")?;
    let (drawn_from, _) = words(&table, "drawn_from", "list of words; `calibrate` writes it")?;
    let experiment = match table.table.contains_key("experiment") {
        true => table.string("experiment", "")?.0,
        false => "",
    };
    let found = EffectDefinition {
        id: id.to_owned(),
        side: table.word("side", &[Side::Switch, Side::Rig].map(|s| (s.as_str(), s)))?,
        covariate: table.word("covariate", &Covariate::ALL.map(|c| (c.as_str(), c)))?,
        acts_on: table.word("acts_on", &ActsOn::ALL.map(|a| (a.as_str(), a)))?,
        combine: table.word("combine", &COMBINE)?,
        formula: formula.to_owned(),
        one_sided: table.boolean("one_sided")?,
        confused_with,
        experiment: experiment.to_owned(),
        drawn_from,
        parameters,
    };
    let own = OwnEffect::new(found).map_err(|DefinitionError { part, problem }| {
        let at = match part {
            Part::Id => id_at.start,
            Part::Formula(byte) => source.inside(formula_at.clone(), byte),
            Part::Parameter(i) => parameters_at.get(i).copied().unwrap_or(table.at),
            Part::Parameters => key_at(&table, "parameters"),
            Part::ConfusedWith => key_at(&table, "confused_with"),
            Part::Experiment => key_at(&table, "experiment"),
            Part::DrawnFrom => key_at(&table, "drawn_from"),
        };
        source.error(at, problem)
    })?;
    Ok(Placed { own, id_at: id_at.start, formula_at: formula_at.start, rivals_at })
}

/// Where a key stands, or the table that lacks it.
fn key_at(table: &Table<'_>, key: &str) -> usize {
    table.table.get_key_value(key).map_or(table.at, |(key, _)| key.span().start)
}

/// The constants in the order of the file, and where each begins.
fn parameters(effect: &Table<'_>) -> Result<(Vec<OwnParameter>, Vec<usize>), OwnEffectError> {
    let example = "such as parameters.k = { size = true, start = 0.1, unit = \"1\" }";
    let value = effect.table.get("parameters").ok_or_else(|| effect.missing("parameters", example))?;
    let all = Table::new(effect.source, value, "parameters")?;
    let mut named: Vec<_> = all.table.iter().collect();
    sort_by_number(&mut named, |(name, _)| name.span().start as f64);
    let mut found = Vec::new();
    for (name, value) in &named {
        let what = format!("parameter '{}'", excerpt(name.get_ref(), 60));
        let table = Table::new(effect.source, value, &what)?;
        table.only(&["size", "start", "low", "high", "unit"])?;
        let size = table.boolean("size")?;
        let (low, high) = (table.number("low")?, table.number("high")?);
        let start = table.number("start")?.ok_or_else(|| table.missing("start", "a fit starts there"))?;
        let bounds = match (size, low, high) {
            (true, None, None) => None,
            (false, Some(low), Some(high)) => Some((low, high)),
            (true, ..) => {
                let problem = format!(
                    "{what}: a size has no bounds; leave out low and high, one_sided = true keeps it positive"
                );
                return Err(effect.source.error(table.at, problem));
            }
            (false, ..) => {
                return Err(table.missing("low and high", "a shape has both, a size has size = true"));
            }
        };
        let (unit, _) = table.string("unit", "write unit = \"1\" for none")?;
        found.push(OwnParameter { name: name.get_ref().to_string(), unit: unit.to_owned(), start, bounds });
    }
    Ok((found, named.iter().map(|(name, _)| name.span().start).collect()))
}

/// A list of words, and where each begins; none where the key is absent.
fn words(effect: &Table<'_>, key: &str, wanted: &str) -> Result<(Vec<String>, Vec<usize>), OwnEffectError> {
    let Some(value) = effect.table.get(key) else { return Ok((Vec::new(), Vec::new())) };
    let wrong = |at| effect.wrong(key, at, wanted);
    let all = value.get_ref().as_array().ok_or_else(|| wrong(value.span().start))?;
    let mut found = (Vec::new(), Vec::new());
    for word in all {
        let text = word.get_ref().as_str().ok_or_else(|| wrong(word.span().start))?;
        found.0.push(text.to_owned());
        found.1.push(word.span().start);
    }
    Ok(found)
}
