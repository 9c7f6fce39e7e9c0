//! The rules between parameters: what cannot be built, what is not ideal, and what a person should look at.
//!
//! A rule is one [`Rule`] value in the list of its subject: its parameter, where it is shown, and its assessment. Nothing
//! else in the program decides whether a configuration is good. cad/doc/dimensions.md lists them for users.

mod mould;
mod mount;
mod pins;
mod print;
mod remedy;
mod shell;
mod support;

use super::Dimensions;
use crate::config::{ConfigError, Configuration};

pub use remedy::{Change, Remedy};
pub(crate) use remedy::{Effort, way_out, ways_out};

/// What chamfers on both sides leave of a wall on the bed.
const MIN_FOOT_MM: f64 = 0.05;

/// Where a rule is shown, and what it costs to break it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The configuration is refused, with an error.
    Error,
    /// The set is made, with a warning on the terminal, in manifest, guide and page.
    Warning,
    /// Listed in guide and page, kept or not.
    Checklist,
}

/// What a rule says of a configuration.
#[derive(Clone, Debug, PartialEq)]
pub enum Assessment {
    /// The rule does not concern this configuration.
    NotApplicable,
    /// It is kept; in a checklist, with these numbers.
    Kept(String),
    /// It is broken.
    Broken {
        /// What is wrong, with the bound.
        problem: String,
        /// What to change.
        remedy: Remedy,
    },
}

/// What rules look at.
#[derive(Clone, Copy, Debug)]
pub struct Inspection<'a> {
    /// The configuration and what follows from it.
    pub dimensions: &'a Dimensions,
    /// Widest ceiling to be bridged over all printed parts, mm; `None` before they are built.
    pub widest_bridge_mm: Option<f64>,
}

impl Inspection<'_> {
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
    /// The parameter that it is about.
    pub field: &'static str,
    /// Where it is shown.
    pub severity: Severity,
    /// Whether a configuration keeps it.
    pub assess: fn(&Inspection<'_>) -> Assessment,
}

/// A line of the checklist.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// Whether the rule is kept.
    #[serde(rename = "fine")]
    pub is_kept: bool,
    /// The rule in this set's numbers.
    #[serde(rename = "words")]
    pub statement: String,
    /// What to change where it is not kept.
    pub remedy: String,
}

/// All rules; errors in the order in which a reader would fix them.
pub fn rules() -> impl Iterator<Item = &'static Rule> {
    [shell::RULES, pins::RULES, support::RULES, mould::RULES, mount::RULES, print::RULES]
        .into_iter()
        .flatten()
}

/// The first error of a configuration.
///
/// # Errors
/// [`ConfigError`] names the field, its value, the bound and the remedy.
pub(super) fn check(dimensions: &Dimensions) -> Result<(), ConfigError> {
    let inspection = Inspection { dimensions, widest_bridge_mm: None };
    let broken =
        rules().filter(|r| r.severity == Severity::Error).find_map(|rule| match (rule.assess)(&inspection) {
            Assessment::Broken { problem, remedy } => Some((rule, problem, remedy)),
            _ => None,
        });
    broken.map_or(Ok(()), |(rule, problem, remedy)| Err(remedy::error(rule, dimensions, problem, remedy)))
}

/// Whether every rule is kept that refuses a configuration: for a search, which asks often and needs no remedy.
pub(super) fn are_kept(dimensions: &Dimensions) -> bool {
    rules().filter(|r| r.severity == Severity::Error).all(|rule| remedy::keeps(rule, dimensions))
}

/// What is not ideal, each with the parameter to change.
pub(super) fn warnings(dimensions: &Dimensions) -> Vec<String> {
    let inspection = Inspection { dimensions, widest_bridge_mm: None };
    rules()
        .filter(|r| r.severity == Severity::Warning)
        .filter_map(|rule| match (rule.assess)(&inspection) {
            Assessment::Broken { problem, remedy: Remedy::Words(words) } => {
                Some(format!("{problem}: {words}"))
            }
            _ => None,
        })
        .collect()
}

/// The checklist of a set whose parts have ceilings of up to `widest_bridge_mm` to be bridged.
pub fn checklist(dimensions: &Dimensions, widest_bridge_mm: f64) -> Vec<Check> {
    let inspection = Inspection { dimensions, widest_bridge_mm: Some(widest_bridge_mm) };
    rules()
        .filter(|r| r.severity == Severity::Checklist)
        .filter_map(|rule| match (rule.assess)(&inspection) {
            Assessment::NotApplicable => None,
            Assessment::Kept(statement) => Some(Check { is_kept: true, statement, remedy: String::new() }),
            Assessment::Broken { problem, remedy } => {
                let Remedy::Words(remedy) = remedy else { return None };
                Some(Check { is_kept: false, statement: problem, remedy })
            }
        })
        .collect()
}

/// A rule that `is_kept`, or is broken with this problem, which some of these changes may mend.
fn require(is_kept: bool, reason: impl FnOnce() -> (String, &'static [Change])) -> Assessment {
    if is_kept {
        return Assessment::Kept(String::new());
    }
    let (problem, changes) = reason();
    Assessment::Broken { problem, remedy: Remedy::Changes(changes) }
}

/// A rule that `is_kept`, or is broken with this problem and this remedy in words.
fn advise(is_kept: bool, reason: impl FnOnce() -> (String, String)) -> Assessment {
    if is_kept {
        return Assessment::Kept(String::new());
    }
    let (problem, remedy) = reason();
    Assessment::Broken { problem, remedy: Remedy::Words(remedy) }
}

/// The least thickness of a wall that may be as thin as `lines` times the thinnest accepted one: chamfers on both of
/// its bottom edges must leave it a foot.
fn least_wall_mm(c: &Configuration, lines: f64) -> f64 {
    (lines * c.print.least_wall_mm).max(2.0 * c.print.elephant_foot_mm + MIN_FOOT_MM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_is_about_a_parameter() {
        for rule in rules() {
            assert!(Configuration::PARAMETERS.iter().any(|p| p.path() == rule.field), "{}", rule.field);
        }
    }

    #[test]
    fn the_default_configuration_breaks_no_rule() {
        let dimensions = Dimensions::new(Configuration::default());
        assert_eq!(check(&dimensions), Ok(()));
        assert_eq!(warnings(&dimensions), Vec::<String>::new());
        assert!(checklist(&dimensions, 3.0).iter().all(|c| c.is_kept));
        assert!(
            checklist(&dimensions, 12.0).iter().any(|c| !c.is_kept && c.remedy.contains("pins.diameter_mm"))
        );
    }
}
