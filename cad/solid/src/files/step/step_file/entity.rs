//! The data section: entities, their parameters, and a parser.

use std::collections::BTreeMap;

pub(super) type Vec3 = [f64; 3];

/// A defect of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct StepError {
    problem: String,
}

impl std::fmt::Display for StepError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.problem)
    }
}

impl std::error::Error for StepError {}

impl From<String> for StepError {
    fn from(problem: String) -> Self {
        Self { problem }
    }
}

impl From<&str> for StepError {
    fn from(problem: &str) -> Self {
        Self { problem: problem.to_owned() }
    }
}

/// Largest degree and multiplicity of a knot; those of the writer have one digit.
const MAX_COUNT: u16 = 100;

/// A parameter of an entity.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Id(u64),
    Real(f64),
    Text(String),
    Word(String),
    List(Vec<Value>),
}

/// The parameters of an entity by its type; a complex entity has several types.
pub(super) type Entity = BTreeMap<String, Vec<Value>>;

/// Returns the parameter at an index.
pub(super) fn parameter(parameters: &[Value], index: usize) -> Result<&Value, StepError> {
    Ok(parameters.get(index).ok_or_else(|| format!("parameter {index} of {parameters:?} is missing"))?)
}

pub(super) fn id(value: &Value) -> Result<u64, StepError> {
    if let Value::Id(id) = value { Ok(*id) } else { Err(format!("{value:?} is not a reference").into()) }
}

pub(super) fn real(value: &Value) -> Result<f64, StepError> {
    if let Value::Real(x) = value { Ok(*x) } else { Err(format!("{value:?} is not a number").into()) }
}

pub(super) fn text(value: &Value) -> Result<String, StepError> {
    if let Value::Text(text) = value {
        Ok(text.clone())
    } else {
        Err(format!("{value:?} is not a string").into())
    }
}

pub(super) fn list(value: &Value) -> Result<&[Value], StepError> {
    if let Value::List(list) = value { Ok(list) } else { Err(format!("{value:?} is not a list").into()) }
}

pub(super) fn flag(value: &Value) -> Result<bool, StepError> {
    match value {
        Value::Word(word) if word == "T" => Ok(true),
        Value::Word(word) if word == "F" => Ok(false),
        other => Err(format!("{other:?} is not a logical value").into()),
    }
}

/// Returns a small natural number.
pub(super) fn count(value: &Value) -> Result<usize, StepError> {
    let number = real(value)?;
    (0..=MAX_COUNT)
        .find(|n| f64::from(*n) == number)
        .map(usize::from)
        .ok_or_else(|| format!("{number} is not a whole number from 0 to {MAX_COUNT}").into())
}

/// Returns the numbers of a list, each as often as the list of counts requires.
pub(super) fn repeated(counts: &Value, numbers: &Value) -> Result<Vec<f64>, StepError> {
    let (counts, numbers) = (list(counts)?, list(numbers)?);
    if counts.len() != numbers.len() {
        return Err(format!("{} counts for {} numbers", counts.len(), numbers.len()).into());
    }
    let pairs = counts.iter().zip(numbers);
    let repeated = pairs.map(|(n, x)| Ok(vec![real(x)?; count(n)?]));
    Ok(repeated.collect::<Result<Vec<_>, StepError>>()?.concat())
}

pub(super) fn coordinates(value: &Value) -> Result<Vec3, StepError> {
    let numbers = list(value)?.iter().map(real).collect::<Result<Vec<_>, _>>()?;
    numbers.try_into().map_err(|_| "a point does not have three coordinates".into())
}

/// Reads the rows of a matrix.
pub(super) fn rows<T>(
    value: &Value,
    read: impl Fn(&Value) -> Result<T, StepError>,
) -> Result<Vec<Vec<T>>, StepError> {
    list(value)?.iter().map(|row| list(row)?.iter().map(&read).collect()).collect()
}

/// A parser of the data section.
pub(super) struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    pub(super) fn new(rest: &'a str) -> Self {
        Self { rest }
    }

    /// Skips white space; returns the rest.
    pub(super) fn space(&mut self) -> &'a str {
        self.rest = self.rest.trim_start();
        self.rest
    }

    pub(super) fn consume(&mut self, c: char) -> Result<(), StepError> {
        self.rest =
            self.space().strip_prefix(c).ok_or_else(|| format!("expected {c}, found {:.40}", self.rest))?;
        Ok(())
    }

    /// Returns the longest prefix of accepted characters and skips it.
    fn take(&mut self, accepts: impl Fn(char) -> bool) -> &'a str {
        let (taken, rest) = self.rest.split_at(self.rest.find(|c| !accepts(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        taken
    }

    /// Parses a simple or complex entity.
    pub(super) fn entity(&mut self) -> Result<Entity, StepError> {
        let is_complex = self.space().starts_with('(');
        if is_complex {
            self.consume('(')?;
        }
        let mut entity = Entity::new();
        while !entity.is_empty() && !is_complex || !self.space().starts_with(')') {
            let name = self.take(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
            if name.is_empty() {
                return Err(format!("expected an entity, found {:.40}", self.rest).into());
            }
            let Value::List(parameters) = self.value()? else {
                return Err(format!("{name} has no parameters").into());
            };
            entity.insert(name.to_owned(), parameters);
            if !is_complex {
                return Ok(entity);
            }
        }
        self.consume(')').map(|()| entity)
    }

    pub(super) fn value(&mut self) -> Result<Value, StepError> {
        let first = self.space().chars().next().ok_or("expected a value, found the end")?;
        match first {
            '#' => {
                self.consume('#')?;
                let digits = self.take(|c| c.is_ascii_digit());
                digits.parse().map(Value::Id).map_err(|_| format!("#{digits} is not a number").into())
            }
            '(' => self.list(),
            '\'' => self.string(),
            '$' | '*' => self.consume(first).map(|()| Value::Word(first.to_string())),
            '.' => {
                self.consume('.')?;
                let word = self.take(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
                self.consume('.').map(|()| Value::Word(word.to_owned()))
            }
            c if c.is_ascii_uppercase() => {
                // A typed value, such as LENGTH_MEASURE(1.E-7).
                self.take(|c| c.is_ascii_uppercase() || c == '_');
                self.list()
            }
            _ => {
                let number = self.take(|c| c.is_ascii_digit() || "+-.E".contains(c));
                number.parse().map(Value::Real).map_err(|_| format!("{number:?} is not a number").into())
            }
        }
    }

    fn list(&mut self) -> Result<Value, StepError> {
        self.consume('(')?;
        let mut values = Vec::new();
        while !self.space().starts_with(')') {
            if !values.is_empty() {
                self.consume(',')?;
            }
            values.push(self.value()?);
        }
        self.consume(')').map(|()| Value::List(values))
    }

    fn string(&mut self) -> Result<Value, StepError> {
        let mut text = String::new();
        loop {
            self.consume('\'')?;
            text += self.take(|c| c != '\'');
            self.consume('\'')?;
            if !self.rest.starts_with('\'') {
                return Ok(Value::Text(text));
            }
            text.push('\'');
        }
    }
}
