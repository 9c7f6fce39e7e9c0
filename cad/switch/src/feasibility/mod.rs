//! Feasibility: the configurations nearest to an infeasible one that can be built.
//!
//! A configuration is *feasible* if it satisfies every rule of severity error ([`crate::design::rules`]) and all of its
//! parts are built and meshed validly ([`Built::new`] succeeds). For an infeasible one, a [`Proposal`] is a feasible
//! configuration near it. Proposals are compared by the number of changed parameters, then by how many of these have
//! their default, then by the relative size of the changes. Alternatives that change one parameter are listed together,
//! the field to blame first. Each proposal is verified by building it.
//!
//! The search uses three strategies, and the first that succeeds:
//!
//! 1. a line search along each direction that a broken rule names ([`crate::design::rules::Direction`]);
//! 2. a line search over each parameter that departs from its default;
//! 3. several parameters together: pairs of these lines, or as few returns towards defaults as suffice. The default
//!    configuration is feasible, so the latter always succeeds.
//!
//! ```
//! use pinswitch_switch::config::{Configuration, assign};
//! use pinswitch_switch::feasibility;
//!
//! let mut crowded = Configuration::default();
//! assign(&mut crowded, "segment.grooves=40")?;
//! let error = feasibility::design(crowded.clone()).unwrap_err();
//! assert!(error.help().is_some_and(|help| help.starts_with("lower it to 20, raise shell.outer_radius_mm to ")));
//!
//! let proposal = feasibility::repair(&crowded)?.ok_or("feasible")?;
//! assert_eq!(proposal.configuration.segment.grooves, 20);
//! assert_eq!(
//!     proposal.changes[0].to_string(),
//!     "segment.grooves: 40 -> 20: grooves overlap (0.781 mm apart, at least 1.450 mm needed)"
//! );
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod distance;
mod line_search;
mod problem;
mod proposal;
mod search;

use crate::built::Built;
use crate::config::{Configuration, Diagnostic, Location};
use crate::design::Design;
use crate::design::rules::Direction;
use crate::output::BuildError;
use pinswitch_solid::solid::CapCache;
use problem::Problem;

use line_search::{Effort, Line};
pub use proposal::{ParameterChange, Proposal};

/// Checks the rules of `configuration`, as [`Design::new`], with proposals where it is refused.
///
/// # Errors
/// A [`Diagnostic`] of the first broken rule, with the nearest feasible values as help, and the first of them as changes.
pub fn design(configuration: Configuration) -> Result<Design, Diagnostic> {
    Design::new(configuration.clone()).map_err(|error| explained(error.into(), &configuration).into())
}

/// Builds `design`, as [`Built::new`], with proposals where it cannot be built.
///
/// # Errors
/// [`BuildError`]: the error of a configuration with the nearest feasible values, or a fault of the program for which no
/// value is to blame.
pub fn build(design: Design) -> Result<Built, BuildError> {
    build_following(design, None, &CapCache::new(usize::MAX))
}

/// Builds `design` after a similar one, as [`Built::following`], with proposals where it cannot be built.
///
/// # Errors
/// As [`build`].
pub fn build_following(design: Design, before: Option<&Built>, caps: &CapCache) -> Result<Built, BuildError> {
    let configuration = design.configuration().clone();
    Built::following(design, before, caps).map_err(|error| explained(error, &configuration))
}

/// Returns the nearest feasible configuration, with the reason for each change; `None` if `configuration` is feasible.
///
/// # Errors
/// [`BuildError`] if no feasible configuration is found: a fault of the program.
pub fn repair(configuration: &Configuration) -> Result<Option<Proposal>, BuildError> {
    let Some(error) = fault(configuration) else { return Ok(None) };
    let problem = Problem::new(configuration, &error);
    let Some(found) = search::proposals(&problem).into_iter().next() else { return Err(error) };
    Ok(Some(with_reasons(configuration, found, &problem.subject)))
}

/// Returns whether `configuration` satisfies all rules and builds.
pub(crate) fn is_feasible(configuration: &Configuration) -> bool {
    fault(configuration).is_none()
}

/// The error of a configuration; `None` if it is feasible.
fn fault(configuration: &Configuration) -> Option<BuildError> {
    match Design::new(configuration.clone()) {
        Ok(design) => Built::new(design).err(),
        Err(error) => Some(error.into()),
    }
}

/// The proposal of a feasible configuration. The reason for a change is the error without it; changes that turn out to be
/// unnecessary are undone.
fn with_reasons(start: &Configuration, mut found: Configuration, subject: &str) -> Proposal {
    let mut changes = Vec::new();
    for change in proposal::changes(start, &found, subject) {
        let Some(parameter) = Configuration::PARAMETERS.iter().find(|p| p.path() == change.field) else {
            continue;
        };
        let mut without = found.clone();
        // The value comes from a configuration, and is accepted.
        let _ = (parameter.set)(&mut without, &(parameter.get)(start));
        match fault(&without) {
            None => found = without,
            Some(error) => changes.push(ParameterChange {
                from: start.shown(&change.field).unwrap_or_default(),
                field: change.field,
                to: change.value,
                reason: match error {
                    BuildError::Configuration(error) => error.problem().to_owned(),
                    other => other.to_string(),
                },
            }),
        }
    }
    Proposal { configuration: found, changes }
}

/// Returns the error with the nearest feasible values of `configuration`; unchanged where none is found.
pub fn explained(error: BuildError, configuration: &Configuration) -> BuildError {
    let problem = Problem::new(configuration, &error);
    let found = search::proposals(&problem);
    let Some(first) = found.first() else { return error };
    // No rule covers the reason why the part does not build, so the first change gives the field.
    let subject = match problem.subject.as_str() {
        "" => {
            proposal::changes(configuration, first, "").first().map(|c| c.field.clone()).unwrap_or_default()
        }
        subject => subject.to_owned(),
    };
    let help = found.iter().map(|c| proposal::instruction(configuration, c, &subject)).collect();
    let diagnostic = match error {
        BuildError::Configuration(diagnostic) => diagnostic,
        other => Diagnostic::new(other.code(), other.problem()),
    };
    let location = Location {
        value: configuration.shown(&subject),
        field: Some(subject.clone()),
        ..diagnostic.location().cloned().unwrap_or_default()
    };
    let diagnostic = diagnostic
        .with_location(location)
        .with_help(proposal::alternatives(help))
        .with_changes(proposal::changes(configuration, first, &subject))
        .with_alternatives(
            found[1..].iter().map(|c| proposal::changes(configuration, c, &subject)).collect(),
        );
    BuildError::Configuration(diagnostic)
}

/// A change of one parameter that satisfies a constraint other than feasibility, for warnings.
#[derive(Clone, Debug)]
pub(crate) struct Advice {
    /// The changed configuration.
    pub(crate) configuration: Configuration,
    /// The change as an instruction, such as `raise shell.wall_mm to 9.5`.
    pub(crate) instruction: String,
    /// Whether the value stays within a factor of two.
    pub(crate) is_small: bool,
}

/// Returns the nearest value with which a configuration `fits`, along the first of `directions` for
/// which a small change is sufficient, or else along the first with any such value.
pub(crate) fn advice(
    c: &Configuration,
    directions: &[Direction],
    fits: &dyn Fn(&Configuration) -> bool,
) -> Option<Advice> {
    let fits = |c: &Configuration| {
        fits(c) && Design::new(c.clone()).is_ok_and(|design| crate::parts::can_be_printed(&design))
    };
    let mut large = None;
    for direction in directions {
        let Some(line) = Line::along(*direction, c) else { continue };
        let Some(configuration) = line.nearest(c, &fits, Effort::QUICK) else { continue };
        let instruction = proposal::instruction(c, &configuration, "");
        let is_small = search::is_small_change(c, &configuration);
        let advice = Advice { configuration, instruction, is_small };
        if is_small {
            return Some(advice);
        }
        large = large.or(Some(advice));
    }
    large
}

#[cfg(test)]
mod tests;
