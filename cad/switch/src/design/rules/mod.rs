//! Rules between parameters: errors, warnings, and the checklist of a set.
//!
//! A rule is one [`Rule`] value in the list of its subject: the parameter, the severity, and the assessment. These lists
//! are the only place that decides whether a configuration is good. `cad/doc/dimensions.md` lists the rules for users.

mod direction;
mod joint;
mod mould;
mod mount;
mod pins;
mod print;
mod process;
mod rig;
mod shell;
mod support;

use super::Dimensions;
use crate::config::{Configuration, Diagnostic, Location, field_location};
use crate::warnings::Warning;
use pinswitch_diagnostic::Code;

pub use direction::Direction;

/// Least width at the bottom of a wall with chamfers on both sides, mm.
const MIN_FOOT_MM: f64 = 0.05;

/// The consequence of breaking a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The configuration is refused.
    Error,
    /// The set is made, with a warning on the terminal, in manifest, guide and page.
    Warning,
    /// Listed in guide and page, whether it is satisfied or not.
    Checklist,
}

/// The assessment of a configuration by one rule.
#[derive(Clone, Debug, PartialEq)]
pub enum Assessment {
    /// The rule does not apply to this configuration.
    NotApplicable,
    /// The rule is satisfied; in a checklist, with these numbers.
    Satisfied(String),
    /// The rule is broken.
    Broken {
        /// The problem, with the bound.
        problem: String,
        /// The change that satisfies the rule.
        remedy: Remedy,
    },
}

/// The remedy for a broken rule.
#[derive(Clone, Debug, PartialEq)]
pub enum Remedy {
    /// An instruction.
    Text(String),
    /// Directions in which to look for a value, the most natural first.
    Directions(&'static [Direction]),
}

/// The input of a rule.
#[derive(Clone, Copy, Debug)]
pub struct Inspection<'a> {
    /// The configuration with its derived dimensions.
    pub dimensions: &'a Dimensions,
    /// Widest ceiling to be bridged over all printed parts, mm; `None` before they are built.
    pub widest_bridge_mm: Option<f64>,
}

impl<'a> Inspection<'a> {
    /// Before any part is built.
    const fn of_dimensions(dimensions: &'a Dimensions) -> Self {
        Self { dimensions, widest_bridge_mm: None }
    }

    const fn configuration(&self) -> &Configuration {
        self.dimensions.configuration()
    }
}

impl std::ops::Deref for Inspection<'_> {
    type Target = Dimensions;

    fn deref(&self) -> &Dimensions {
        self.dimensions
    }
}

/// One rule.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// The code of a broken rule, with the page that explains it.
    pub code: Code,
    /// The parameter that the rule is about.
    pub field: &'static str,
    /// The consequence of breaking it.
    pub severity: Severity,
    /// Assesses a configuration.
    pub assess: fn(&Inspection<'_>) -> Assessment,
}

/// A line of the checklist.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// Whether the rule is satisfied.
    #[serde(rename = "fine")]
    pub is_satisfied: bool,
    /// The rule with the numbers of this set.
    #[serde(rename = "words")]
    pub statement: String,
    /// The change that satisfies a broken rule.
    pub remedy: String,
}

/// A broken rule of severity error.
#[derive(Clone, Debug)]
pub(crate) struct Violation {
    /// The code of the rule.
    pub(crate) code: Code,
    /// The field to blame: that of the rule, unless it has its default and another one is a likely cause.
    pub(crate) field: &'static str,
    /// The problem, with the bound.
    pub(crate) problem: String,
    /// Directions in which to look for a value that satisfies the rule.
    pub(crate) directions: &'static [Direction],
}

/// Returns all rules; errors in the order in which a reader would fix them.
pub fn rules() -> impl Iterator<Item = &'static Rule> {
    [
        shell::RULES,
        pins::RULES,
        support::RULES,
        mould::RULES,
        mount::RULES,
        joint::RULES,
        rig::RULES,
        print::RULES,
        process::RULES,
    ]
    .into_iter()
    .flatten()
}

fn errors() -> impl Iterator<Item = &'static Rule> {
    rules().filter(|rule| rule.severity == Severity::Error)
}

/// Returns the broken rules of severity error, in their order.
pub(crate) fn violations(dimensions: &Dimensions) -> impl Iterator<Item = Violation> {
    let inspection = Inspection::of_dimensions(dimensions);
    errors().filter_map(move |rule| match (rule.assess)(&inspection) {
        Assessment::Broken { problem, remedy } => {
            let directions = match remedy {
                Remedy::Directions(directions) => directions,
                Remedy::Text(_) => &[],
            };
            let c = inspection.configuration();
            let field = if departs(c, rule.field) { rule.field } else { cause(c, directions, rule.field) };
            Some(Violation { code: rule.code, field, problem, directions })
        }
        _ => None,
    })
}

/// The first parameter that departs from its default against one of these directions; `field` if there is none.
fn cause(c: &Configuration, directions: &[Direction], field: &'static str) -> &'static str {
    directions.iter().find(|direction| direction.is_cause(c)).map_or(field, |direction| direction.field())
}

/// Whether a parameter differs from its default.
fn departs(c: &Configuration, field: &str) -> bool {
    c.shown(field) != Configuration::default().shown(field)
}

/// Checks the rules of severity error.
///
/// # Errors
/// A [`Diagnostic`] of the first broken rule with field, value and bound; [`crate::feasibility`] adds the help.
pub(super) fn check(dimensions: &Dimensions) -> Result<(), Diagnostic> {
    let Some(violation) = violations(dimensions).next() else { return Ok(()) };
    let value = dimensions.configuration().shown(violation.field);
    let location = Location { value, ..field_location(violation.field) };
    Err(Diagnostic::new(violation.code, violation.problem).with_location(location))
}

/// Whether no rule of severity error is broken. Cheaper than [`check`], for searches.
pub(super) fn are_satisfied(dimensions: &Dimensions) -> bool {
    let inspection = Inspection::of_dimensions(dimensions);
    errors().all(|rule| !matches!((rule.assess)(&inspection), Assessment::Broken { .. }))
}

/// Returns the warnings, each with its remedy.
pub(super) fn warnings(dimensions: &Dimensions) -> Vec<Warning> {
    let inspection = Inspection::of_dimensions(dimensions);
    rules()
        .filter(|rule| rule.severity == Severity::Warning)
        .filter_map(|rule| match (rule.assess)(&inspection) {
            Assessment::Broken { problem, remedy: Remedy::Text(help) } => {
                Some(Warning::new(rule.code, format!("{problem}: {help}")))
            }
            _ => None,
        })
        .collect()
}

/// Returns the checklist of a set whose widest ceiling to be bridged is `widest_bridge_mm`.
pub fn checklist(dimensions: &Dimensions, widest_bridge_mm: f64) -> Vec<Check> {
    let inspection = Inspection { dimensions, widest_bridge_mm: Some(widest_bridge_mm) };
    rules()
        .filter(|rule| rule.severity == Severity::Checklist)
        .filter_map(|rule| match (rule.assess)(&inspection) {
            Assessment::NotApplicable => None,
            Assessment::Satisfied(statement) => {
                Some(Check { is_satisfied: true, statement, remedy: String::new() })
            }
            Assessment::Broken { problem, remedy } => {
                let Remedy::Text(remedy) = remedy else { return None };
                Some(Check { is_satisfied: false, statement: problem, remedy })
            }
        })
        .collect()
}

/// A rule of severity error: broken unless `is_satisfied`, with a problem and directions.
fn require(is_satisfied: bool, reason: impl FnOnce() -> (String, &'static [Direction])) -> Assessment {
    if is_satisfied {
        return Assessment::Satisfied(String::new());
    }
    let (problem, directions) = reason();
    Assessment::Broken { problem, remedy: Remedy::Directions(directions) }
}

/// A rule of severity warning: broken unless `is_satisfied`, with a problem and an instruction.
fn advise(is_satisfied: bool, reason: impl FnOnce() -> (String, String)) -> Assessment {
    if is_satisfied {
        return Assessment::Satisfied(String::new());
    }
    let (problem, help) = reason();
    Assessment::Broken { problem, remedy: Remedy::Text(help) }
}

/// Least thickness of a wall of `lines` times the thinnest accepted one, with room for chamfers on both bottom edges.
fn least_wall_mm(c: &Configuration, lines: f64) -> f64 {
    (lines * c.print.least_wall_mm).max(2.0 * c.print.elephant_foot_mm + MIN_FOOT_MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;

    #[test]
    fn the_document_lists_every_rule_that_refuses() {
        let document = include_str!("../../../../doc/dimensions.md");
        let (_, rules) = document.split_once("## Invalid configurations").unwrap();
        for rule in super::rules().filter(|rule| rule.severity == Severity::Error) {
            let field = format!("`{}`", rule.field);
            // The rules of the joint are with its geometry, those of the rig in its document.
            let place = match rule.field.split('.').next() {
                Some("joint") => document,
                Some("rig") => include_str!("../../../../doc/rig.md"),
                _ => rules,
            };
            assert!(place.contains(&field), "{field}");
        }
    }

    #[test]
    fn every_rule_names_existing_parameters() {
        let exists = |path: &str| Configuration::PARAMETERS.iter().any(|p| p.path() == path);
        for rule in rules() {
            assert!(exists(rule.field), "{}", rule.field);
        }
        // Directions of the rules that these configurations break.
        let mut directions = 0;
        for parameter in Configuration::PARAMETERS {
            for end in (parameter.ends)().into_iter().flatten() {
                let mut c = Configuration::default();
                assign(&mut c, &format!("{}={end}", parameter.path())).unwrap();
                for violation in violations(&Dimensions::new(c.clone())) {
                    let named = violation.directions.iter().map(|direction| direction.field());
                    let mut named = named.chain([violation.field]);
                    assert!(named.all(exists), "{violation:?}");
                    directions += violation.directions.len();
                }
            }
        }
        assert!(directions > 100, "{directions}");
    }

    #[test]
    fn the_field_that_was_set_is_blamed() {
        for (assignments, field) in [
            (&["tendon.rope_diameter_mm=4.4"][..], "tendon.rope_diameter_mm"),
            (&["tendon.coating_mm=2"], "tendon.coating_mm"),
            (&["print.elephant_foot_mm=1"], "print.elephant_foot_mm"),
            (&["segment.span_deg=340", "layout.wrap_angle_deg=340"], "segment.span_deg"),
            (&["segment.end_margin_mm=10"], "segment.end_margin_mm"),
            (&["shell.outer_radius_mm=14"], "shell.outer_radius_mm"),
            // A larger shell is not the cause of grooves that overlap.
            (&["shell.outer_radius_mm=25", "print.elephant_foot_mm=0.9"], "print.elephant_foot_mm"),
        ] {
            let mut c = Configuration::default();
            assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
            let error = check(&Dimensions::new(c)).unwrap_err();
            assert_eq!(error.location().unwrap().field.as_deref(), Some(field), "{error}");
        }
    }

    #[test]
    fn the_default_configuration_breaks_no_rule() {
        let dimensions = Dimensions::new(Configuration::default());
        assert_eq!(check(&dimensions), Ok(()));
        assert_eq!(warnings(&dimensions), Vec::<Warning>::new());
        assert!(checklist(&dimensions, 3.0).iter().all(|c| c.is_satisfied));
        assert!(
            checklist(&dimensions, 12.0)
                .iter()
                .any(|c| !c.is_satisfied && c.remedy.contains("pins.diameter_mm"))
        );
    }
}
