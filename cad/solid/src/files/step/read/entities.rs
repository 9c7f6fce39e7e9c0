//! The entities of an exchange structure, looked up by number and by kind.

use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr as _;

use ruststep::ast::{DataSection, EntityInstance, Exchange, Name, Parameter, Record};
use ruststep::parser;

use super::StepReadError;
use crate::validity::Fault;

/// Millimetres of a metre, and the prefixes of the SI in front of it.
const METRE_MM: f64 = 1e3;
const PREFIXES: [(&str, f64); 5] =
    [("MICRO", 1e-6), ("MILLI", 1e-3), ("CENTI", 1e-2), ("DECI", 1e-1), ("KILO", 1e3)];
/// Units that are not of the SI, in millimetres.
const CUSTOMARY: [(&str, f64); 2] = [("INCH", 25.4), ("FOOT", 304.8)];

/// Schemas of shapes, by what is in their names.
const SCHEMAS: [&str; 5] =
    ["CONFIG_CONTROL", "AUTOMOTIVE_DESIGN", "AP2", "MANAGED_MODEL_BASED_3D", "INTEGRATED_CNC"];
/// What has radii, and where among its parameters.
const RADII: [(&str, &[usize]); 6] = [
    ("CIRCLE", &[2]),
    ("ELLIPSE", &[2, 3]),
    ("CYLINDRICAL_SURFACE", &[2]),
    ("SPHERICAL_SURFACE", &[2]),
    ("CONICAL_SURFACE", &[2]),
    ("TOROIDAL_SURFACE", &[2, 3]),
];
/// So much of a broken statement is shown, in characters.
const SHOWN: usize = 60;

/// All entities of a file; an entity may be several records at once.
pub(super) struct Entities {
    exchange: Exchange,
    records: BTreeMap<u64, Vec<Record>>,
}

impl Entities {
    pub(super) fn parse(text: &str) -> Result<Self, StepReadError> {
        let exchange = parser::parse(text).map_err(|_| StepReadError::Malformed(broken_statement(text)))?;
        let schema = exchange.header.iter().find(|record| record.name == "FILE_SCHEMA");
        let Some(schema) = schema else {
            return Err(StepReadError::Malformed("its header names no schema".to_owned()));
        };
        let mut names = Vec::new();
        strings(&schema.parameter, &mut names);
        let is_of_shapes = |name: &String| SCHEMAS.iter().any(|known| name.to_uppercase().contains(known));
        if !names.iter().any(is_of_shapes) {
            return Err(StepReadError::Schema(names.join(", ")));
        }
        if exchange.data.len() != 1 {
            return Err(StepReadError::Malformed(format!(
                "it has {} data sections, not one",
                exchange.data.len()
            )));
        }
        let mut records = BTreeMap::new();
        for entity in exchange.data.iter().flat_map(|section| &section.entities) {
            let (id, all) = match entity {
                EntityInstance::Simple { id, record } => (id, vec![record.clone()]),
                EntityInstance::Complex { id, subsuper } => (id, subsuper.0.clone()),
            };
            if records.insert(*id, all).is_some() {
                return Err(StepReadError::Malformed(format!("#{id} is there twice")));
            }
        }
        Ok(Self { exchange, records })
    }

    pub(super) fn section(&self) -> &DataSection {
        &self.exchange.data[0]
    }

    /// Entities with a record of this kind, with its parameters.
    pub(super) fn of_kind(&self, kind: &'static str) -> impl Iterator<Item = (u64, &[Parameter])> {
        self.records.keys().filter_map(move |id| Some((*id, self.record(*id, kind)?)))
    }

    /// The parameters of entity `id` as a record of this kind.
    pub(super) fn record(&self, id: u64, kind: &str) -> Option<&[Parameter]> {
        let record = self.records.get(&id)?.iter().find(|record| record.name == kind)?;
        list(&record.parameter)
    }

    /// Numbers that are referred to and not there.
    pub(super) fn dangling(&self) -> Vec<u64> {
        let mut named = BTreeSet::new();
        for record in self.records.values().flatten() {
            references(&record.parameter, &mut named);
        }
        named.into_iter().filter(|id| !self.records.contains_key(id)).collect()
    }

    /// Curves and surfaces with radii that none can have.
    pub(super) fn impossible_radii(&self) -> Option<Fault> {
        let number = |p: &Parameter| match p {
            Parameter::Real(value) => Some(*value),
            #[allow(clippy::cast_precision_loss)]
            Parameter::Integer(value) => Some(*value as f64),
            _ => None,
        };
        let mut all: Vec<(u64, f64)> = Vec::new();
        for (kind, places) in RADII {
            for (id, parameters) in self.of_kind(kind) {
                let radii = places.iter().filter_map(|i| parameters.get(*i).and_then(number));
                // The radius of a cone may be nothing: that of its tip.
                let is_wrong = |r: &f64| if kind == "CONICAL_SURFACE" { *r < 0.0 } else { *r <= 0.0 };
                all.extend(radii.filter(is_wrong).map(|r| (id, r)));
            }
        }
        all.sort_by_key(|(id, _)| *id);
        let (id, radius) = all.first()?;
        Some(Fault {
            check: "radius",
            count: all.len(),
            at_mm: None,
            detail: format!("#{id} has a radius of {radius}, and none is that small"),
        })
    }

    /// Shells that bound nothing, by their own word.
    pub(super) fn open_shells(&self) -> Option<Fault> {
        let all: Vec<u64> = self.of_kind("OPEN_SHELL").map(|(id, _)| id).collect();
        let first = all.first()?;
        Some(Fault {
            check: "open shell",
            count: all.len(),
            at_mm: None,
            detail: format!("#{first} is an OPEN_SHELL, which bounds no solid; a solid has a CLOSED_SHELL"),
        })
    }

    /// How many faces of a shell lead to one of `lost`.
    pub(super) fn faces_with(&self, shell: u64, lost: &BTreeSet<u64>) -> usize {
        if lost.is_empty() {
            return 0;
        }
        let mut faces = BTreeSet::new();
        for record in self.records.get(&shell).into_iter().flatten() {
            references(&record.parameter, &mut faces);
        }
        faces.into_iter().filter(|face| self.leads_to(*face, lost)).count()
    }

    fn leads_to(&self, from: u64, lost: &BTreeSet<u64>) -> bool {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(id) = next.pop() {
            if lost.contains(&id) {
                return true;
            }
            if seen.insert(id) {
                let mut named = BTreeSet::new();
                for record in self.records.get(&id).into_iter().flatten() {
                    references(&record.parameter, &mut named);
                }
                next.extend(named);
            }
        }
        false
    }

    /// Millimetres of the unit of length.
    pub(super) fn unit_mm(&self) -> Result<f64, StepReadError> {
        let mut units = Vec::new();
        for (_, parameters) in self.of_kind("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            let assigned = parameters.first().and_then(list).unwrap_or_default();
            let lengths = assigned
                .iter()
                .filter_map(entity)
                .filter(|id| self.record(*id, "LENGTH_UNIT").is_some() || self.is_length(*id));
            for id in lengths {
                let unit = self.length_mm(id).ok_or_else(|| {
                    StepReadError::Unit(format!("its unit of length, #{id}, is not known here"))
                })?;
                units.push(unit);
            }
        }
        match units.first() {
            None => Err(StepReadError::Unit("it names no unit of length".to_owned())),
            Some(first) if units.iter().all(|unit| unit == first) => Ok(*first),
            Some(_) => Err(StepReadError::Unit("its parts have different units of length".to_owned())),
        }
    }

    /// Whether a unit is a length although no record says so: some programs leave the record away.
    fn is_length(&self, id: u64) -> bool {
        let si = self.record(id, "SI_UNIT");
        si.is_some_and(|si| matches!(si.last(), Some(Parameter::Enumeration(name)) if name == "METRE"))
    }

    fn length_mm(&self, id: u64) -> Option<f64> {
        if let Some([Parameter::String(name), ..]) = self.record(id, "CONVERSION_BASED_UNIT") {
            let name = name.to_uppercase();
            return CUSTOMARY.iter().find(|(unit, _)| name.starts_with(unit)).map(|(_, mm)| *mm);
        }
        match self.record(id, "SI_UNIT")? {
            [Parameter::Enumeration(prefix), _] => {
                PREFIXES.iter().find(|(name, _)| name == prefix).map(|(_, share)| share * METRE_MM)
            }
            _ => Some(METRE_MM),
        }
    }

    /// The solid that a shell bounds.
    pub(super) fn solid_of(&self, shell: u64) -> Option<u64> {
        ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "SHELL_BASED_SURFACE_MODEL"]
            .into_iter()
            .flat_map(|kind| self.of_kind(kind))
            .find(|(_, parameters)| mentions(parameters, shell))
            .map(|(id, _)| id)
    }

    /// The name of a shell: its solid's, or else its product's.
    pub(super) fn name_of(&self, shell: u64) -> Option<String> {
        let solid = self.solid_of(shell)?;
        let given = |id| match self.records.get(&id)?.first().and_then(|r| list(&r.parameter))?.first()? {
            Parameter::String(name) if !name.trim().is_empty() => Some(name.clone()),
            _ => None,
        };
        given(solid).or_else(|| given(self.representation_of(solid)?))
    }

    /// The representation that lists a solid.
    pub(super) fn representation_of(&self, solid: u64) -> Option<u64> {
        [
            "ADVANCED_BREP_SHAPE_REPRESENTATION",
            "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
            "SHAPE_REPRESENTATION",
        ]
        .into_iter()
        .flat_map(|kind| self.of_kind(kind))
        .find(|(_, parameters)| mentions(parameters, solid))
        .map(|(id, _)| id)
    }
}

/// The texts in a parameter.
fn strings(parameter: &Parameter, found: &mut Vec<String>) {
    match parameter {
        Parameter::String(text) => found.push(text.clone()),
        Parameter::List(all) => all.iter().for_each(|p| strings(p, found)),
        _ => {}
    }
}

/// Where a file breaks off from the exchange structure: the first statement that is none, by its line. The parser itself
/// only knows in which section that is.
fn broken_statement(text: &str) -> String {
    let mut is_data = false;
    for (line, statement) in statements(text) {
        let Some(statement) = statement.strip_suffix(';') else {
            return format!("it breaks off in line {line}");
        };
        match statement.trim() {
            "DATA" => is_data = true,
            "ENDSEC" => is_data = false,
            instance if is_data && DataSection::from_str(&format!("DATA;{instance};ENDSEC;")).is_err() => {
                let shown: String = instance.chars().take(SHOWN).collect();
                return format!("line {line} is no entity: {shown}");
            }
            _ => {}
        }
    }
    "its sections are not those of a STEP file".to_owned()
}

/// Statements with their semicolons, and the lines in which they begin. Those in texts and comments do not end one.
fn statements(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let (mut rest, mut line) = (text, 1);
    std::iter::from_fn(move || {
        loop {
            let begins = rest.trim_start();
            line += lines_in(&rest[..rest.len() - begins.len()]);
            rest = begins;
            let Some(comment) = rest.strip_prefix("/*") else { break };
            let end = comment.find("*/").map_or(comment.len(), |at| at + 2);
            line += lines_in(&comment[..end]);
            rest = &comment[end..];
        }
        if rest.is_empty() {
            return None;
        }
        let mut is_text = false;
        let end = rest.bytes().position(|b| {
            is_text ^= b == b'\'';
            b == b';' && !is_text
        });
        let (statement, after) = rest.split_at(end.map_or(rest.len(), |at| at + 1));
        let begins = line;
        line += lines_in(statement);
        rest = after;
        Some((begins, statement))
    })
}

fn lines_in(text: &str) -> usize {
    text.bytes().filter(|b| *b == b'\n').count()
}

/// A list of parameters.
pub(super) fn list(parameter: &Parameter) -> Option<&[Parameter]> {
    match parameter {
        Parameter::List(all) => Some(all),
        _ => None,
    }
}

/// The entity that a parameter refers to.
pub(super) fn entity(parameter: &Parameter) -> Option<u64> {
    match parameter {
        Parameter::Ref(Name::Entity(id)) => Some(*id),
        _ => None,
    }
}

fn mentions(parameters: &[Parameter], id: u64) -> bool {
    parameters.iter().any(|p| entity(p) == Some(id) || list(p).is_some_and(|inner| mentions(inner, id)))
}

fn references(parameter: &Parameter, named: &mut BTreeSet<u64>) {
    match parameter {
        Parameter::Ref(Name::Entity(id)) => {
            named.insert(*id);
        }
        Parameter::List(all) => all.iter().for_each(|p| references(p, named)),
        Parameter::Typed { parameter, .. } => references(parameter, named),
        _ => {}
    }
}
