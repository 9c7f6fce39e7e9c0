//! A problem: an infeasible configuration, and the constraints that a proposal must satisfy.

use std::cell::RefCell;

use super::distance::differing;
use super::line_search::Line;
use crate::built::{Built, builds};
use crate::config::Configuration;
use crate::config::parameter::Parameter;
use crate::design::rules::{Direction, violations};
use crate::design::{Design, Dimensions, is_accepted};
use crate::output::BuildError;
use crate::parts::{can_be_printed, room_on_bed};
use pinswitch_solid::solid::CapCache;

/// A reason, unknown to the rules, for which a configuration does not build.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Obstacle {
    /// An outline cannot be constructed, or a part does not fit on the bed.
    Outline,
    /// The mesh of this part is invalid.
    Mesh(String),
}

impl Obstacle {
    fn from_error(error: &BuildError) -> Self {
        match error {
            BuildError::Configuration(_) => Self::Outline,
            BuildError::Cap { part, .. } | BuildError::Invalid { part, .. } => Self::Mesh(part.clone()),
        }
    }

    /// Whether the obstacle is absent from a configuration that satisfies the rules.
    fn is_absent_from(&self, design: &Design, caps: &CapCache) -> bool {
        match self {
            Self::Outline => can_be_printed(design),
            Self::Mesh(part) => builds(part, design, caps),
        }
    }
}

/// An infeasible configuration, with all that is known about its faults.
///
/// A configuration is feasible if it satisfies all rules of severity error and builds. Rules take microseconds, building
/// takes milliseconds: a search uses [`Self::admits`] for every candidate, and [`Self::verify`] for the best ones. The
/// reason for which a candidate does not build becomes a constraint of [`Self::admits`].
pub(super) struct Problem<'a> {
    /// The infeasible configuration.
    pub(super) start: &'a Configuration,
    /// The field to blame.
    pub(super) subject: String,
    /// Lines of the directions of all broken rules, the most natural first.
    pub(super) lines: Vec<Line>,
    obstacles: RefCell<Vec<Obstacle>>,
    caps: CapCache,
    /// The last configuration that was built: the next one has most of its parts.
    built: RefCell<Option<Built>>,
}

impl<'a> Problem<'a> {
    /// Returns the problem of `start`, which was refused with `error` by the rules or while it was built.
    pub(super) fn new(start: &'a Configuration, error: &BuildError) -> Self {
        let subject = match error {
            BuildError::Configuration(error) => error.location().and_then(|l| l.field.clone()),
            BuildError::Cap { .. } | BuildError::Invalid { .. } => None,
        };
        let mut problem = Self {
            start,
            subject: subject.unwrap_or_default(),
            lines: Vec::new(),
            obstacles: RefCell::default(),
            caps: CapCache::new(usize::MAX),
            built: RefCell::default(),
        };
        let mut directions: Vec<Direction> = Vec::new();
        for violation in violations(&Dimensions::new(start.clone())) {
            directions.extend(violation.directions);
        }
        if is_accepted(start.clone()) {
            problem.obstacles.get_mut().push(Obstacle::from_error(error));
            if problem.subject == "print.bed_mm" {
                directions.extend(Design::new(start.clone()).iter().flat_map(room_on_bed));
            } else {
                problem.lines.extend(problem.parameter().and_then(|field| Line::below(field, start)));
            }
        }
        let mut unique: Vec<Direction> = Vec::new();
        for direction in directions {
            if !unique.contains(&direction) {
                problem.lines.extend(Line::along(direction, start));
                unique.push(direction);
            }
        }
        // A field that no direction is about: a list or a choice.
        let is_covered = unique.iter().any(|direction| direction.field() == problem.subject);
        if let Some(field) = problem.parameter().filter(|_| !is_covered) {
            problem.lines.extend(problem.back(field));
        }
        problem
    }

    fn parameter(&self) -> Option<&'static Parameter<Configuration>> {
        Configuration::PARAMETERS.iter().find(|p| p.path() == self.subject)
    }

    /// Returns the default configuration with the name of this one: a feasible configuration.
    pub(super) fn default(&self) -> Configuration {
        let mut default = Configuration::default();
        default.switch.name = self.start.switch.name.clone();
        default
    }

    /// Returns the parameters that differ from their defaults. Those that the broken rules do not mention come first, and
    /// among them choices and lists.
    pub(super) fn departing(&self) -> Vec<&'static Parameter<Configuration>> {
        let is_mentioned = |path: &str| path == self.subject || self.lines.iter().any(|l| l.field() == path);
        let mut departing: Vec<_> = differing(self.start, &self.default()).collect();
        departing.sort_by_key(|p| (is_mentioned(&p.path()), (p.ends)().is_some()));
        departing
    }

    /// Returns the line of a parameter back to its default; `None` for a default.
    pub(super) fn back(&self, parameter: &Parameter<Configuration>) -> Option<Line> {
        Line::towards(parameter, self.start, &(parameter.get)(&self.default()))
    }

    /// Whether a candidate satisfies the rules, and is free of the obstacles found so far.
    pub(super) fn admits(&self, candidate: &Configuration) -> bool {
        if !is_accepted(candidate.clone()) {
            return false;
        }
        let obstacles = self.obstacles.borrow();
        let is_free = |design: Design| obstacles.iter().all(|o| o.is_absent_from(&design, &self.caps));
        obstacles.is_empty() || Design::new(candidate.clone()).is_ok_and(is_free)
    }

    /// Whether [`Self::admits`] builds parts.
    pub(super) fn has_obstacles(&self) -> bool {
        !self.obstacles.borrow().is_empty()
    }

    /// Builds a candidate. Where it does not build, the reason becomes a constraint.
    ///
    /// # Errors
    /// Whether the reason is new, so that another search may find another candidate.
    pub(super) fn verify(&self, candidate: &Configuration) -> Result<(), IsNew> {
        let built = match Design::new(candidate.clone()) {
            Ok(design) => Built::following(design, self.built.borrow().as_ref(), &self.caps),
            Err(error) => Err(error.into()),
        };
        match built {
            Ok(built) => {
                self.built.replace(Some(built));
                Ok(())
            }
            Err(error) => {
                let obstacle = Obstacle::from_error(&error);
                let mut obstacles = self.obstacles.borrow_mut();
                let is_new = !obstacles.contains(&obstacle);
                if is_new {
                    obstacles.push(obstacle);
                }
                Err(IsNew(is_new))
            }
        }
    }
}

/// Whether an obstacle was unknown before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct IsNew(pub(super) bool);
