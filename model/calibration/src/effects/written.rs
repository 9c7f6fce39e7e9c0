//! What a formula of an effect acts on, and how: the part of an effect that the language of formulas can say.

use super::{ContactState, Stage};

/// What a formula acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActsOn {
    /// The friction on pins and silicone alike.
    Mu,
    /// The friction on the pins.
    MuPins,
    /// The friction on the silicone; for `plain` the free exponent.
    MuSilicone,
    /// The wrap angle.
    Wrap,
    /// The load at which a device has switched by half.
    Threshold,
    /// The load.
    Load,
    /// The tension that the contact leaves, before the load cell.
    Tension,
    /// The reading of the load cell.
    Reading,
}

impl ActsOn {
    /// All of them, on the way from the load to the reading.
    pub const ALL: [ActsOn; 8] = [
        ActsOn::Mu,
        ActsOn::MuPins,
        ActsOn::MuSilicone,
        ActsOn::Wrap,
        ActsOn::Threshold,
        ActsOn::Load,
        ActsOn::Tension,
        ActsOn::Reading,
    ];

    /// The word of the files.
    pub fn as_str(self) -> &'static str {
        match self {
            ActsOn::Mu => "mu",
            ActsOn::MuPins => "mu_pins",
            ActsOn::MuSilicone => "mu_silicone",
            ActsOn::Wrap => "wrap",
            ActsOn::Threshold => "threshold",
            ActsOn::Load => "load",
            ActsOn::Tension => "tension",
            ActsOn::Reading => "reading",
        }
    }

    /// Unit of what it is: what a formula that is added must have.
    pub fn unit(self) -> &'static str {
        match self {
            ActsOn::Mu | ActsOn::MuPins | ActsOn::MuSilicone => "1",
            ActsOn::Wrap => "rad",
            ActsOn::Threshold | ActsOn::Load | ActsOn::Tension | ActsOn::Reading => "N",
        }
    }

    /// Whether the tension is known where it acts.
    pub fn knows_tension(self) -> bool {
        matches!(self, ActsOn::Tension | ActsOn::Reading)
    }
}

/// How a formula `f` changes what it acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// Times `1 + f`, `f` dimensionless.
    Factor,
    /// Plus `f`, in the unit of what it acts on.
    Sum,
}

impl Combine {
    /// The word of the files.
    pub fn as_str(self) -> &'static str {
        match self {
            Combine::Factor => "factor",
            Combine::Sum => "add",
        }
    }

    /// A value after the formula had the value `f`.
    pub fn applied(self, value: f64, f: f64) -> f64 {
        match self {
            Combine::Factor => value * (1.0 + f),
            Combine::Sum => value + f,
        }
    }
}

/// An effect's form in the language of formulas (`model/doc/own-effects.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// The language can say it.
    As {
        /// What it acts on.
        acts_on: ActsOn,
        /// How.
        combine: Combine,
        /// The formula.
        formula: &'static str,
    },
    /// The language cannot, for this reason.
    No(&'static str),
}

impl Written {
    /// A formula `f` by which something is multiplied, as `1 + f`.
    pub const fn factor(acts_on: ActsOn, formula: &'static str) -> Self {
        Self::As { acts_on, combine: Combine::Factor, formula }
    }

    /// A formula that is added.
    pub const fn sum(acts_on: ActsOn, formula: &'static str) -> Self {
        Self::As { acts_on, combine: Combine::Sum, formula }
    }
}

/// Where a formula acts between the weight and the reading.
pub(super) fn stage(acts_on: ActsOn, combine: Combine) -> Stage {
    match (acts_on, combine) {
        (ActsOn::Load, _) => Stage::Load,
        (ActsOn::Mu | ActsOn::MuPins | ActsOn::MuSilicone, Combine::Sum) => Stage::AddedFriction,
        (ActsOn::Mu | ActsOn::MuPins | ActsOn::MuSilicone, Combine::Factor) | (ActsOn::Wrap, _) => {
            Stage::ScaledFriction
        }
        (ActsOn::Threshold, _) => Stage::Switch,
        (ActsOn::Tension, _) => Stage::Drag,
        (ActsOn::Reading, Combine::Factor) => Stage::CellScale,
        (ActsOn::Reading, Combine::Sum) => Stage::CellZero,
    }
}

/// The least load in newtons at which a device may have switched by half.
const LEAST_THRESHOLD_N: f64 = 1.0;

/// Changes the contact by a formula whose value is `f`. Friction, wrap and load are held at zero or above, as by the
/// built-in effects; what is no number stays none.
pub(super) fn on_contact(acts_on: ActsOn, combine: Combine, f: f64, state: &mut ContactState) {
    let changed = |value: f64, least: f64| {
        let value = combine.applied(value, f);
        if value < least { least } else { value }
    };
    if matches!(acts_on, ActsOn::Mu | ActsOn::MuPins) {
        state.mu_pins = changed(state.mu_pins, 0.0);
        // What ploughing adds is friction of the pins, too; a coefficient that is added leaves it as it is.
        if combine == Combine::Factor {
            state.extra_exponent_pins = changed(state.extra_exponent_pins, 0.0);
        }
    }
    match acts_on {
        ActsOn::Mu | ActsOn::MuSilicone => state.mu_silicone = changed(state.mu_silicone, 0.0),
        ActsOn::Wrap => state.exponent_factor *= changed(state.wrap_rad, 0.0) / state.wrap_rad,
        ActsOn::Threshold => state.half_load_n = changed(state.half_load_n, LEAST_THRESHOLD_N),
        ActsOn::Load => state.load_n = changed(state.load_n, 0.0),
        ActsOn::MuPins | ActsOn::Tension | ActsOn::Reading => {}
    }
}
