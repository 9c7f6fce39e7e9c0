//! What the paper's model may lack: one file per effect, named as in data.md section 4.
//!
//! To add an effect, write its file and add one line to [`LIBRARY`].

use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::table::{Condition, Frame, Point};

mod adhesion;
mod coating_ploughing;
mod coating_stiffening;
mod contact_state;
mod direction_asymmetry;
mod dwell_relaxation;
mod fixture_compliance;
mod guide_drag;
mod hook_omitted;
mod load_cell_gain;
mod load_cell_nonlinearity;
mod load_cell_offset;
mod load_cell_saturation;
mod polygon_bending;
mod rate_dependence;
mod run_in;
mod stroke_position;
mod structure;
mod substrate_saturation;
mod switch_local_tension;
mod switching_hysteresis;
mod thermal_drift;
mod wear_drift;

pub use contact_state::{ContactState, REFERENCE_LOAD_N};
pub use structure::{Channel, Shape, Structure};

/// Every named effect, in the order in which they act: the contact first, the load cell last.
pub static LIBRARY: [&dyn Effect; 21] = [
    &hook_omitted::HookOmitted,
    &coating_ploughing::CoatingPloughing,
    &coating_stiffening::CoatingStiffening,
    &polygon_bending::PolygonBending,
    &substrate_saturation::SubstrateSaturation,
    &dwell_relaxation::DwellRelaxation,
    &run_in::RunIn,
    &wear_drift::WearDrift,
    &rate_dependence::RateDependence,
    &fixture_compliance::FixtureCompliance,
    &stroke_position::StrokePosition,
    &direction_asymmetry::DirectionAsymmetry,
    &switching_hysteresis::SwitchingHysteresis,
    &switch_local_tension::SwitchLocalTension,
    &adhesion::Adhesion,
    &guide_drag::GuideDrag,
    &load_cell_gain::LoadCellGain,
    &load_cell_nonlinearity::LoadCellNonlinearity,
    &load_cell_offset::LoadCellOffset,
    &thermal_drift::ThermalDrift,
    &load_cell_saturation::LoadCellSaturation,
];

/// The effect of an id.
pub fn effect_named(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.id() == id)
}

/// Whether an effect belongs to the printed part or to the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Changes the part's own friction: stays in predicted curves.
    Switch,
    /// Belongs to the measurement: stays out of predicted curves.
    Rig,
}

impl Side {
    /// The word of data.md.
    pub fn word(self) -> &'static str {
        match self {
            Side::Switch => "switch",
            Side::Rig => "rig",
        }
    }
}

/// Where the trace of an effect lies (data.md section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Covariate {
    /// The declared load.
    Load,
    /// Eccentric or concentric.
    Direction,
    /// Repetition inside a series and direction.
    Repetition,
    /// Position along the stroke.
    Position,
    /// Speed of the actuator.
    Speed,
    /// Pause before the reading.
    Dwell,
    /// Ascending or descending loads.
    Sweep,
    /// Time since the session began.
    Time,
    /// Substrate and pins.
    Condition,
}

impl Covariate {
    /// All of them, in the order of data.md.
    pub const ALL: [Covariate; 9] = [
        Covariate::Load,
        Covariate::Direction,
        Covariate::Repetition,
        Covariate::Position,
        Covariate::Speed,
        Covariate::Dwell,
        Covariate::Sweep,
        Covariate::Time,
        Covariate::Condition,
    ];

    /// The word of data.md.
    pub fn word(self) -> &'static str {
        match self {
            Covariate::Load => "load",
            Covariate::Direction => "direction",
            Covariate::Repetition => "repetition",
            Covariate::Position => "position",
            Covariate::Speed => "speed",
            Covariate::Dwell => "dwell",
            Covariate::Sweep => "sweep",
            Covariate::Time => "time",
            Covariate::Condition => "condition",
        }
    }
}

/// One constant of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its symbol.
    pub name: &'static str,
    /// Its unit; `1` if it has none.
    pub unit: &'static str,
    /// Bounds of a shape constant; `None` for a size, which is free.
    pub bounds: Option<(f64, f64)>,
}

impl Parameter {
    /// A size: unbounded, the effect vanishes at zero.
    pub const fn free(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, bounds: None }
    }

    /// A shape within bounds.
    pub const fn bounded(name: &'static str, unit: &'static str, least: f64, most: f64) -> Self {
        Self { name, unit, bounds: Some((least, most)) }
    }
}

/// A named effect: where it enters the forward model, with which constants, and how to talk about it.
pub trait Effect: Debug + Sync {
    /// Its id in data.md.
    fn id(&self) -> &'static str;
    /// Part or measurement.
    fn side(&self) -> Side;
    /// Where its trace lies.
    fn covariate(&self) -> Covariate;
    /// The formula with its source.
    fn formula(&self) -> &'static str;
    /// Its constants; sensitivities to them are central differences.
    fn parameters(&self) -> &'static [Parameter];
    /// Whether its size can only be positive: what fits with a negative one is something else.
    fn one_sided(&self) -> bool {
        false
    }
    /// Values to start a fit from: the sizes typical of this rig, one entry per shape.
    fn starts(&self, frame: &Frame) -> Vec<Vec<f64>>;
    /// Effects that may look the same.
    fn confused_with(&self) -> &'static [&'static str];
    /// The experiment that shows it apart from those.
    fn experiment(&self) -> &'static str;
    /// What keeps data from showing it.
    fn invisible_because(&self) -> &'static str;
    /// Changes the contact; `k` are the constants.
    fn on_contact(&self, _k: &[f64], _point: &Point, _condition: &Condition, _state: &mut ContactState) {}
    /// Changes the reading in newtons; `k` are the constants.
    fn on_reading(&self, _k: &[f64], _point: &Point, reading_n: f64) -> f64 {
        reading_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Surface;

    #[test]
    fn ids_are_unique_and_rivals_exist() {
        for (i, effect) in LIBRARY.iter().enumerate() {
            assert!(LIBRARY[i + 1..].iter().all(|other| other.id() != effect.id()));
            assert!(effect.confused_with().iter().all(|id| effect_named(id).is_some()), "{}", effect.id());
            assert!(!effect.experiment().is_empty() && effect.formula().len() > 8);
        }
    }

    /// Each effect changes some reading of a rig that varies everything, and each start has all constants.
    #[test]
    fn every_effect_can_be_seen_in_some_row() {
        let frame = Frame {
            stroke_mm: 150.0,
            session_s: 1e4,
            reference_speed_pct: 50.0,
            travel_time_s: vec![0.0, 1e4],
            travel_share: vec![0.0, 1.0],
            load_range_n: (3.0, 50.0),
            conditions: Vec::new(),
        };
        let condition = Condition {
            surface: Surface::Silicone,
            pins: vec![5, 8, 11],
            device: Some(0),
            wrap_rad: 1.115,
            weight: 0.1,
            turn_rad: 0.37,
            ploughing: 0.7,
        };
        let point = Point {
            condition: 0,
            load_n: 49.0,
            sign: 1.0,
            descending: 1.0,
            log_speed: 0.2,
            log_dwell: 0.5,
            repetition: 2.0,
            position: 0.8,
            time: 0.7,
            travel: 0.6,
        };
        for effect in LIBRARY {
            let read = |k: Option<&[f64]>| {
                let mut state = ContactState {
                    load_n: point.load_n,
                    wrap_rad: condition.wrap_rad,
                    mu_pins: 0.05,
                    mu_silicone: 0.24,
                    extra_exponent_pins: 0.0,
                    exponent_factor: 1.0,
                    half_load_n: 40.0,
                    steepness: 4.6,
                    local_tension: false,
                    adhesion_n: 0.0,
                    drag_n: 0.0,
                };
                if let Some(k) = k {
                    effect.on_contact(k, &point, &condition, &mut state);
                }
                let tension = state.tension_n(&condition, &point);
                k.map_or(tension, |k| effect.on_reading(k, &point, tension))
            };
            let changed = effect.starts(&frame).iter().any(|k| {
                assert_eq!(k.len(), effect.parameters().len(), "{}", effect.id());
                (read(Some(k)) - read(None)).abs() > 1e-3
            });
            assert!(changed, "{}", effect.id());
        }
    }
}
