//! The entities of an exchange structure, looked up by number and by kind.

use std::collections::{BTreeMap, BTreeSet};

use ruststep::ast::{DataSection, EntityInstance, Exchange, Name, Parameter, Record};
use ruststep::parser;

use super::StepReadError;

/// Millimetres of a metre, and the prefixes of the SI in front of it.
const METRE_MM: f64 = 1e3;
const PREFIXES: [(&str, f64); 5] =
    [("MICRO", 1e-6), ("MILLI", 1e-3), ("CENTI", 1e-2), ("DECI", 1e-1), ("KILO", 1e3)];
/// Units that are not of the SI, in millimetres.
const CUSTOMARY: [(&str, f64); 2] = [("INCH", 25.4), ("FOOT", 304.8)];

/// All entities of a file; an entity may be several records at once.
pub(super) struct Entities {
    exchange: Exchange,
    records: BTreeMap<u64, Vec<Record>>,
}

impl Entities {
    pub(super) fn parse(text: &str) -> Result<Self, StepReadError> {
        let exchange = parser::parse(text).map_err(|e| {
            // The parser draws a picture of the place: its first line that says where is enough.
            let words = e.to_string();
            let place = words.lines().find(|line| line.contains("at line")).unwrap_or("it breaks off");
            StepReadError::Malformed(place.trim().trim_start_matches("0: ").trim_end_matches(':').to_owned())
        })?;
        if !exchange.header.iter().any(|record| record.name == "FILE_SCHEMA") {
            return Err(StepReadError::Malformed("its header names no schema".to_owned()));
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
