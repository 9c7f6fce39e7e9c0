//! Documents of a test rig: bill, files of the programs, run sheet and wiring. All are made from one [`RigFacts`].

mod bill;
mod files;
mod sheet;
mod wiring;

pub use bill::bill_csv;
pub use files::{plan_toml, rig_toml, run_toml};
pub use sheet::rig_sheet;
pub use wiring::wiring_svg;

use pinswitch_calibration::experiment::{PlannedRun, RigLimits, paper_runs};
use pinswitch_friction::{Substrate, published};

/// Time of one move of the drive, s: the paper's actuator.
pub(crate) const MOVE_S: f64 = 0.5;
/// Lowest and highest speed of the actuator, %: the paper's.
const ACTUATOR_SPEEDS_PCT: [f64; 2] = [40.0, 70.0];
/// Speed in the logs of a crank, %: that of the paper's table without a speed.
const CRANK_SPEED_PCT: f64 = 50.0;

/// The drive of a rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// A linear actuator with this speed at 100 %, mm/s.
    Actuator {
        /// Full speed, mm/s.
        full_speed_mm_s: f64,
    },
    /// A hand crank.
    Crank {
        /// Length of tendon per hole of the drum, mm.
        step_mm: f64,
    },
}

/// A bought item of the bill.
#[derive(Clone, Debug, PartialEq)]
pub struct BoughtItem {
    /// Number of pieces.
    pub quantity: usize,
    /// Size and standard.
    pub item: String,
    /// Where it is used.
    pub purpose: String,
}

impl BoughtItem {
    /// Creates an item.
    pub fn new(quantity: usize, item: impl Into<String>, purpose: impl Into<String>) -> Self {
        Self { quantity, item: item.into(), purpose: purpose.into() }
    }
}

/// Every fact that more than one document of a rig states.
#[derive(Clone, Debug, PartialEq)]
pub struct RigFacts {
    /// Name of the set.
    pub name: String,
    /// Grooves with pins, ascending; empty for silicone alone.
    pub pins: Vec<usize>,
    /// Whether the set has a silicone layer.
    pub has_silicone: bool,
    /// Whether the set has the rigid proxy.
    pub has_proxy: bool,
    /// Wrap angle of the tendon, degrees.
    pub wrap_angle_deg: f64,
    /// Mass of the hook, g.
    pub hook_mass_g: f64,
    /// Weights on the hook, g, ascending.
    pub weights_g: Vec<f64>,
    /// The load cell, such as `S-beam load cell, M8`.
    pub cell: String,
    /// Range of the load cell, N.
    pub cell_limit_n: f64,
    /// Rate of the logger, Hz.
    pub sample_rate_hz: f64,
    /// The drive.
    pub drive: Drive,
    /// Stroke of the drive, mm.
    pub stroke_mm: f64,
    /// Mechanical items to buy.
    pub items: Vec<BoughtItem>,
}

impl RigFacts {
    /// Returns the limits of the rig, as in its `rig.toml`. A layout that the paper's segment cannot
    /// have is a contact of its wrap angle.
    pub fn limits(&self) -> RigLimits {
        let is_layout = !self.pins.is_empty()
            && self.pins.is_sorted_by(|a, b| a < b)
            && self.pins.iter().all(|groove| (1..=published::GROOVES).contains(groove));
        let layouts = if is_layout { vec![self.pins.clone()] } else { Vec::new() };
        let is_plain = layouts.is_empty() && !self.has_silicone;
        let speeds_pct = match self.drive {
            Drive::Actuator { .. } => ACTUATOR_SPEEDS_PCT,
            // Cranking by hand has one speed, which is not recorded.
            Drive::Crank { .. } => [CRANK_SPEED_PCT; 2],
        };
        RigLimits {
            loads_g: self.weights_g.clone(),
            speeds_pct,
            full_speed_mm_s: self.full_speed_mm_s(),
            layouts,
            silicone: self.has_silicone,
            proxy: self.has_proxy,
            plain_wraps_deg: if is_plain { vec![self.wrap_angle_deg] } else { Vec::new() },
            hook_mass_g: Some(self.hook_mass_g),
            wrap_angle_deg: Some(self.wrap_angle_deg),
            stroke_mm: self.stroke_mm,
            cell_limit_n: self.cell_limit_n,
            ..RigLimits::default()
        }
    }

    /// Returns the runs of the paper's protocol on this rig: every contact with every weight. Each has the
    /// file name of its log as its purpose.
    pub fn runs(&self) -> Vec<PlannedRun> {
        let mut runs = paper_runs(&self.limits(), f64::INFINITY);
        for (i, run) in runs.iter_mut().enumerate() {
            run.asks = log_name(i + 1, run);
        }
        runs
    }

    /// Returns the speed of the actuator at 100 %, mm/s; `None` with a crank.
    pub fn full_speed_mm_s(&self) -> Option<f64> {
        match self.drive {
            Drive::Actuator { full_speed_mm_s } => Some(full_speed_mm_s),
            Drive::Crank { .. } => None,
        }
    }

    /// Returns the load of a weight with the hook, N.
    pub fn load_n(&self, weight_g: f64) -> f64 {
        (weight_g + self.hook_mass_g) * 1e-3 * published::GRAVITY_M_S2
    }

    /// Returns the largest load, N.
    pub fn heaviest_n(&self) -> f64 {
        self.load_n(self.weights_g.iter().copied().fold(0.0, f64::max))
    }
}

/// Returns the file name of the log of a run, numbered from 1.
fn log_name(number: usize, run: &PlannedRun) -> String {
    let contact = match (run.substrate, run.pins.is_empty()) {
        (Some(Substrate::Abs), _) => "proxy",
        (Some(Substrate::Silicone), true) => "silicone",
        (Some(Substrate::Silicone), false) => "device",
        (None, _) => "plain",
    };
    format!("{number:03}-{contact}-{:.0}g.csv", run.load_mass_g)
}

#[cfg(test)]
pub(crate) mod tests;
