//! Triangle sets: named groups of triangles of a mesh (core specification, 4.1.5).

use std::collections::{BTreeMap, HashSet};

use super::findings::Findings;
use super::value::index;
use crate::validity::Level;

/// Namespace of triangle sets.
pub(super) const NAMESPACE: &str = "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07";
/// Paragraph of the core specification.
const PARAGRAPH: &str = "3MF core 4.1.5";

/// The triangle sets of a mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct TriangleSets {
    identifiers: HashSet<String>,
    /// The greatest index of a triangle.
    greatest: Option<u32>,
    problems: BTreeMap<&'static str, usize>,
}

impl TriangleSets {
    /// Reads an element of the namespace, with the values of its attributes.
    pub(super) fn element<'a>(&mut self, name: &str, value: impl Fn(&str) -> Option<&'a str>) {
        match name {
            "triangleset" => {
                let text = |name| value(name).map(str::trim).filter(|text| !text.is_empty());
                if text("name").is_none() {
                    self.report("a triangle set has no name");
                }
                match text("identifier") {
                    None => self.report("a triangle set has no identifier"),
                    Some(id) if !self.identifiers.insert(id.to_owned()) => {
                        self.report("two triangle sets have the same identifier");
                    }
                    Some(_) => {}
                }
            }
            "ref" => self.refer(value("index").and_then(index)),
            "refrange" => {
                let (start, end) = (value("startindex").and_then(index), value("endindex").and_then(index));
                if start.zip(end).is_some_and(|(start, end)| start > end) {
                    self.report("a range of a triangle set is reversed");
                }
                self.refer(start);
                self.refer(end);
            }
            _ => {}
        }
    }

    fn refer(&mut self, triangle: Option<u32>) {
        match triangle {
            Some(_) => self.greatest = self.greatest.max(triangle),
            None => self.report("a reference of a triangle set is not an index"),
        }
    }

    fn report(&mut self, problem: &'static str) {
        *self.problems.entry(problem).or_default() += 1;
    }

    /// Reports what is wrong with the sets of the object `id`, which has this number of triangles.
    pub(super) fn check(&self, id: &str, triangles: usize, findings: &mut Findings) {
        for (problem, count) in &self.problems {
            let detail = format!("object {id}: {problem}");
            findings.add("triangle set", Level::Error, *count, PARAGRAPH, &detail);
        }
        if let Some(greatest) = self.greatest.filter(|greatest| *greatest as usize >= triangles) {
            let detail = format!("object {id}: a set refers to triangle {greatest} of {triangles}");
            findings.error("triangle set", PARAGRAPH, &detail);
        }
    }
}
