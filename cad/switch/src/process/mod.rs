//! The process that makes a configured switch: materials as sold, and the cure that gives the layer its hardness and size.
//!
//! A configuration states the switch: the hardness of its layer, and the shrinkage that its mould compensates. The process
//! follows from it, so that the cure in the guide and the hardness behind the curve cannot contradict each other:
//!
//! - the cure in the mould is at the temperature at which the silicone shrinks by `mould.shrinkage_pct`
//!   ([`Silicone::shrinkage_pct`]), or at `process.cure_c`, which must agree with it;
//! - a cure that leaves the layer softer than `silicone.hardness_shore_a` is followed by a post-cure of the layer outside
//!   the mould, at the temperature that gives this hardness ([`Silicone::hardness_shore_a`]).
//!
//! Where no such cure exists, [`Process::conflicts`] says why. Then the guide gives no cure, and the prediction is
//! extrapolated. `cad/doc/process.md` lists materials and sources.

mod cure;
pub(crate) mod instructions;
mod material;
mod silicone;
mod stock;

use crate::config::{Choice, Configuration, MouldKind};
use pinswitch_friction::Substrate;
use pinswitch_friction::physics::modulus_of_shore_a_mpa;

pub use cure::Cure;
pub use material::{Material, PartMaterial};
pub use silicone::{Silicone, SiliconeProduct};
pub use stock::{Coating, PinStock, nearest_pin_mm, pin_is_sold};

/// Temperature of a room, °C: a cure at or below it needs no oven.
pub const ROOM_C: f64 = 25.0;
/// Largest difference between the shrinkage of a cure and that of the mould, in per cent. Chosen: 0.1 mm over the arc of the
/// default layer.
const SHRINKAGE_TOLERANCE_PCT: f64 = 0.3;
/// Step to which temperatures are rounded, °C.
const STEP_C: f64 = 5.0;
/// Duration of a post-cure, h. Chosen: longer than the full cure at every temperature at which Sylgard 184 is post-cured.
const POST_CURE_H: f64 = 2.0;

/// The reason why a silicone cannot make the configured layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    subject: Subject,
    /// The problem, with the bound.
    pub problem: String,
    /// What to change.
    pub help: String,
}

/// The process of a configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// Material of the printed parts.
    pub material: &'static PartMaterial,
    /// Silicone of the layer; `None` for a user-defined one, whose data are on its package.
    pub silicone: Option<&'static Silicone>,
    /// Cure in the mould; `None` where a conflict excludes it, and for a user-defined silicone.
    pub mould_cure: Option<Cure>,
    /// Post-cure of the layer outside the mould, if the hardness needs it.
    pub post_cure: Option<Cure>,
    /// Shore A hardness after these cures, and its standard deviation; `None` where it is not known.
    pub hardness_shore_a: Option<[f64; 2]>,
    /// Why this silicone cannot make the layer; empty if it can.
    pub conflicts: Vec<Conflict>,
}

/// The part of the process that a conflict is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    /// Cavity and cure in the mould.
    Mould,
    /// Hardness of the layer.
    Hardness,
}

impl Process {
    /// Derives the process of a configuration.
    pub fn of(c: &Configuration) -> Self {
        let material = c.process.material.data();
        let mut process = Self {
            material,
            silicone: c.process.silicone.data(),
            mould_cure: None,
            post_cure: None,
            hardness_shore_a: None,
            conflicts: Vec::new(),
        };
        if c.layout.substrate != Substrate::Silicone || c.mould.kind == MouldKind::None {
            return process;
        }
        let Some(silicone) = process.silicone else { return process };
        let temperature_c = mould_temperature_c(c, silicone, material);
        process.conflicts.extend(conflict_of_mould(c, silicone, material, temperature_c));
        let wanted = c.silicone.hardness_shore_a;
        let hottest_c = hottest_available_c(c);
        match silicone.cure_for(wanted, temperature_c) {
            // A cure in the mould that is too hot for the oven is a conflict of the mould.
            Some(post_c) if post_c <= hottest_c.max(temperature_c) => {
                let most_c = silicone.hottest_c.min(hottest_c);
                let post_c = (post_c > temperature_c).then(|| rounded_c(post_c).min(most_c));
                process.post_cure = post_c.map(|temperature_c| Cure { temperature_c, hours: POST_CURE_H });
                let hottest = post_c.unwrap_or(temperature_c);
                process.hardness_shore_a =
                    Some([silicone.hardness_shore_a(hottest), silicone.hardness_scatter_shore_a]);
            }
            too_hot => process.conflicts.push(conflict_of_hardness(c, silicone, temperature_c, too_hot)),
        }
        if process.conflicts.is_empty() {
            process.mould_cure = Some(silicone.cure_at(temperature_c));
        } else {
            (process.post_cure, process.hardness_shore_a) = (None, None);
        }
        process
    }

    /// Returns the conflict of the cure in the mould, if there is one.
    pub(crate) fn mould_conflict(&self) -> Option<Conflict> {
        self.conflict_of(Subject::Mould)
    }

    /// Returns the conflict of the hardness, if there is one.
    pub(crate) fn hardness_conflict(&self) -> Option<Conflict> {
        self.conflict_of(Subject::Hardness)
    }

    fn conflict_of(&self, subject: Subject) -> Option<Conflict> {
        self.conflicts.iter().find(|conflict| conflict.subject == subject).cloned()
    }

    /// Relative standard deviation of the modulus of the layer, from the scatter of its hardness. 0 where it is not known,
    /// and for a rigid proxy.
    pub fn modulus_scatter(&self) -> f64 {
        self.hardness_shore_a.map_or(0.0, |[shore_a, scatter]| relative_modulus_sd(shore_a, scatter))
    }
}

/// Relative standard deviation of the modulus of a silicone, from the hardness and its standard deviation, Shore A.
pub(crate) fn relative_modulus_sd(shore_a: f64, sd_shore_a: f64) -> f64 {
    (modulus_of_shore_a_mpa(shore_a + sd_shore_a) - modulus_of_shore_a_mpa(shore_a - sd_shore_a))
        / (2.0 * modulus_of_shore_a_mpa(shore_a))
}

/// Temperature of the cure in the mould, °C: the configured one, or that of the shrinkage of the mould.
fn mould_temperature_c(c: &Configuration, silicone: &Silicone, material: &PartMaterial) -> f64 {
    if c.process.cure_c > 0.0 {
        return c.process.cure_c;
    }
    match c.mould.shrinkage_pct {
        // A mould that compensates nothing is for a cure at room temperature.
        shrinkage if shrinkage <= 0.0 => ROOM_C.min(silicone.hottest_in_mould_c),
        shrinkage => rounded_c(silicone.temperature_of_shrinkage_c(shrinkage, material)),
    }
}

/// Hottest cure with the configured oven, °C: a room needs none.
fn hottest_available_c(c: &Configuration) -> f64 {
    c.process.oven_c.max(ROOM_C)
}

fn rounded_c(temperature_c: f64) -> f64 {
    (temperature_c / STEP_C).round() * STEP_C
}

/// Whether cavity and cure have the same shrinkage, the oven reaches the cure, and the cure spares the mould.
fn conflict_of_mould(
    c: &Configuration,
    silicone: &Silicone,
    material: &PartMaterial,
    temperature_c: f64,
) -> Option<Conflict> {
    let shrinkage = silicone.shrinkage_pct(temperature_c, material);
    let most_c = material.hottest_cure_c.min(silicone.hottest_in_mould_c);
    let needs = || match c.process.cure_c > 0.0 {
        true => format!("the cure in the mould is at {temperature_c} C"),
        false => format!(
            "{} shrinks by {:.2} % only when cured at {temperature_c} C",
            silicone.name, c.mould.shrinkage_pct
        ),
    };
    if temperature_c > most_c {
        let why = if material.hottest_cure_c < silicone.hottest_in_mould_c {
            format!("a mould of {} softens above {} C", material.name, material.hottest_cure_c)
        } else {
            format!("{} has no data above {} C", silicone.name, silicone.hottest_in_mould_c)
        };
        let least = silicone.shrinkage_pct(most_c, material);
        return Some(Conflict {
            subject: Subject::Mould,
            problem: format!("{}, and {why}", needs()),
            help: format!("set mould.shrinkage_pct to at most {:.1}", (10.0 * least).floor() / 10.0),
        });
    }
    let oven_c = hottest_available_c(c);
    if temperature_c > oven_c {
        let least = silicone.shrinkage_pct(oven_c, material);
        return Some(Conflict {
            subject: Subject::Mould,
            problem: format!("{}, and process.oven_c is {}", needs(), c.process.oven_c),
            help: format!(
                "set process.oven_c to {temperature_c}, or mould.shrinkage_pct to {:.1} and process.cure_c to 0",
                (10.0 * least).floor() / 10.0
            ),
        });
    }
    ((shrinkage - c.mould.shrinkage_pct).abs() > SHRINKAGE_TOLERANCE_PCT).then(|| Conflict {
        subject: Subject::Mould,
        problem: format!(
            "the mould compensates a shrinkage of {} %, and {} cured at {temperature_c} C shrinks by {shrinkage:.2} %",
            c.mould.shrinkage_pct, silicone.name
        ),
        help: format!("set mould.shrinkage_pct to {shrinkage:.2}, or process.cure_c to 0"),
    })
}

/// Why no cure of this silicone gives the configured hardness.
fn conflict_of_hardness(
    c: &Configuration,
    silicone: &Silicone,
    from_c: f64,
    needs_c: Option<f64>,
) -> Conflict {
    let wanted = c.silicone.hardness_shore_a;
    let softest = silicone.hardness_shore_a(from_c);
    let hardest = silicone.hardness_shore_a(c.process.oven_c.clamp(from_c, silicone.hottest_c.max(from_c)));
    let reach = if hardest - softest < 0.5 {
        format!("{} has {softest:.0} Shore A", silicone.name)
    } else {
        format!("{} has {softest:.0} to {hardest:.0} Shore A", silicone.name)
    };
    let problem = match needs_c {
        Some(needs_c) => format!(
            "{wanted} Shore A needs a post-cure of {} at {:.0} C, and process.oven_c is {}",
            silicone.name,
            rounded_c(needs_c),
            c.process.oven_c
        ),
        None => format!("{reach}, and the curve is for {wanted} Shore A"),
    };
    let nearest = wanted.clamp(softest, hardest);
    let other = SiliconeProduct::for_hardness(wanted)
        .filter(|product| *product != c.process.silicone)
        .map_or("\"other\"".to_owned(), |product| format!("{:?}", product.as_str()));
    Conflict {
        subject: Subject::Hardness,
        problem,
        help: format!(
            "set process.silicone to {other}, or silicone.hardness_shore_a to {}",
            (10.0 * nearest).round() / 10.0
        ),
    }
}

/// The coating of the tendon: none where its thickness is 0.
pub fn coating(c: &Configuration) -> Coating {
    if c.tendon.coating_mm > 0.0 { c.process.coating } else { Coating::Bare }
}

/// Density of the printed parts, g/cm³: the configured one for ABS, else that of the material.
pub fn part_density_g_cm3(c: &Configuration) -> f64 {
    c.process.material.data().density_g_cm3.unwrap_or(c.print.abs_density_g_cm3)
}

/// Density of the cured silicone, g/cm³: the configured one for Sylgard 184 and a user-defined silicone.
pub fn silicone_density_g_cm3(c: &Configuration) -> f64 {
    c.process.silicone.data().and_then(|s| s.density_g_cm3).unwrap_or(c.silicone.density_g_cm3)
}

/// Base to curing agent by mass: the configured ratio for Sylgard 184 and a user-defined silicone.
pub fn mix_ratio(c: &Configuration) -> f64 {
    c.process.silicone.data().and_then(|s| s.mix_ratio).unwrap_or(c.silicone.mix_ratio)
}

#[cfg(test)]
mod tests;
