//! Quantity that an effect's formula changes, and how: the part of an effect that the formula
//! language can express.

use crate::effects::{ContactState, Stage};

/// Quantity that a formula changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActsOn {
    /// Friction on pins and silicone; a factor also changes ploughing.
    Mu,
    /// Friction coefficient on the pins.
    MuPins,
    /// Friction on the silicone; the free exponent for `plain`.
    MuSilicone,
    /// Wrap angle.
    Wrap,
    /// Threshold of a device.
    Threshold,
    /// Load.
    Load,
    /// Tension after the contact and before the load cell.
    Tension,
    /// Reading of the load cell.
    Reading,
}

impl ActsOn {
    /// All of them, in the order from the load to the reading.
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

    /// Returns the word used in files.
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

    /// Returns the unit of the quantity, which a formula must have that is added to it.
    pub fn unit(self) -> &'static str {
        match self {
            ActsOn::Mu | ActsOn::MuPins | ActsOn::MuSilicone => "1",
            ActsOn::Wrap => "rad",
            ActsOn::Threshold | ActsOn::Load | ActsOn::Tension | ActsOn::Reading => "N",
        }
    }

    /// Returns whether the tension is known at its stage.
    pub fn knows_tension(self) -> bool {
        matches!(self, ActsOn::Tension | ActsOn::Reading)
    }
}

/// How a formula `f` changes its quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// Multiplies it by `1 + f`, with `f` dimensionless.
    Factor,
    /// Adds `f`, in the unit of the quantity.
    Sum,
}

impl Combine {
    /// Returns the word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Combine::Factor => "factor",
            Combine::Sum => "add",
        }
    }

    /// Applies the value `f` of a formula.
    pub fn applied(self, value: f64, f: f64) -> f64 {
        match self {
            Combine::Factor => value * (1.0 + f),
            Combine::Sum => value + f,
        }
    }
}

/// Formula of an effect in the formula language (`model/doc/own-effects.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written<'a> {
    /// The effect has a formula.
    As {
        /// Quantity that it changes.
        acts_on: ActsOn,
        /// How it changes the quantity.
        combine: Combine,
        /// The formula.
        formula: &'a str,
    },
    /// The language cannot express the effect, for this reason.
    No(&'a str),
}

impl<'a> Written<'a> {
    /// Returns a formula `f` that multiplies by `1 + f`.
    pub const fn factor(acts_on: ActsOn, formula: &'a str) -> Self {
        Self::As { acts_on, combine: Combine::Factor, formula }
    }

    /// Returns a formula that is added.
    pub const fn sum(acts_on: ActsOn, formula: &'a str) -> Self {
        Self::As { acts_on, combine: Combine::Sum, formula }
    }
}

/// Returns the stage at which a formula acts.
pub(in crate::effects) fn stage(acts_on: ActsOn, combine: Combine) -> Stage {
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

/// Smallest threshold of a device in newtons.
const LEAST_THRESHOLD_N: f64 = 1.0;

/// Applies the value `f` of a formula to the contact. Friction, wrap and load remain non-negative; NaN is passed on.
pub(super) fn on_contact(acts_on: ActsOn, combine: Combine, f: f64, state: &mut ContactState) {
    let changed = |value: f64, least: f64| {
        let value = combine.applied(value, f);
        if value < least { least } else { value }
    };
    if matches!(acts_on, ActsOn::Mu | ActsOn::MuPins) {
        state.mu_pins = changed(state.mu_pins, 0.0);
    }
    // Ploughing is friction, too, but no coefficient: a factor on the whole friction scales it, a change of a coefficient
    // does not.
    if acts_on == ActsOn::Mu && combine == Combine::Factor {
        state.extra_exponent_pins = changed(state.extra_exponent_pins, 0.0);
    }
    match acts_on {
        ActsOn::Mu | ActsOn::MuSilicone => state.mu_silicone = changed(state.mu_silicone, 0.0),
        ActsOn::Wrap => state.exponent_factor *= changed(state.wrap_rad, 0.0) / state.wrap_rad,
        ActsOn::Threshold => state.half_load_n = changed(state.half_load_n, LEAST_THRESHOLD_N),
        ActsOn::Load => state.load_n = changed(state.load_n, 0.0),
        ActsOn::MuPins | ActsOn::Tension | ActsOn::Reading => {}
    }
}
