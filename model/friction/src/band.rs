//! The 95 % band of a curve, source by source.
//!
//! Each source has half widths of `ln D` at 95 %, downwards and upwards. Independent sources add in
//! squares. They change slowly, so they are computed at a few loads and interpolated in the
//! logarithm of the load.
//!
//! A constant marked *chosen* is a judgement: no published measurement determines it.

use serde::Serialize;

use crate::band_physics::BandPhysics;
use crate::band_source::{BandSource, NORMAL_95};
use crate::contact::Contact;
use crate::deviation::Deviation;
use crate::law::{self, Law, LawError, UncertainFriction};
use crate::physics::Sensitivities;
use crate::published;
use crate::status::{is_measured, layout_distance};
use crate::substrate::Substrate;

/// Largest number of loads at which the sources are computed.
const LOADS: usize = 10;
/// Standard deviation of `ln D` from an effect outside the physics, for a parameter that deviates
/// by a factor e. Chosen.
const UNKNOWN_EFFECT: f64 = 0.1;
/// Standard deviation of `ln D` for each deviation that no law models. Chosen.
const REMARK: f64 = 0.1;
/// Standard deviation of `ln D` for a factor e in number or pitch of the pins beyond the measured
/// range. Chosen.
const BEYOND_LAYOUTS: f64 = 0.3;
/// Standard deviation of `ln D` for a factor e in load beyond the tested range. Chosen.
const BEYOND_LOADS: f64 = 0.15;
/// Distance from a measured load, as a logarithm, at which the weight of rival laws is `1 - 1/e`.
const NEAR_LOAD: f64 = 0.5;
/// The same for the distance from a measured condition, see [`layout_distance`].
const NEAR_CONDITION: f64 = 0.15;

/// 95 % band of a curve, with its sources.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Loads of the sources in newtons, ascending.
    pub load_n: Vec<f64>,
    /// Sources: those of the law, the deviations from the published rig, and the rival laws.
    pub sources: Vec<BandSource>,
    /// Rival laws, whose friction the band covers away from the measurements: name, and `ln` of
    /// their friction over that of the law at each load.
    pub rivals: Vec<(String, Vec<f64>)>,
    /// Deviations from the published rig, with their effects at each load.
    pub deviations: Vec<Deviation>,
}

impl Band {
    /// Computes the band of `law` for `contact` over the range of `loads_n` newtons.
    ///
    /// ```
    /// use pinswitch_friction::{Band, Contact, Law, PinPattern, Substrate, published};
    ///
    /// let six = &published::LAYOUTS[0];
    /// let pins = PinPattern::even(six.pins, six.pitch_rad());
    /// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
    /// let band = Band::new(Law::Physics, &contact, &[3.08, 49.67])?;
    /// let [light, heavy] = [0, 1].map(|load| band.half_width(load).1);
    /// // The maximum was measured. At a light load nothing was, and the laws disagree.
    /// assert!(heavy < 0.25 && light > 0.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LawError`] if the law does not describe the contact.
    pub fn new(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<Self, LawError> {
        Self::from_physics(law, contact, &BandPhysics::new(contact, loads_n))
    }

    /// Computes the band of `law` for the contact of `physics`, at its loads.
    ///
    /// # Errors
    /// [`LawError`] if the law does not describe the contact.
    pub(crate) fn from_physics(law: Law, contact: &Contact, physics: &BandPhysics) -> Result<Self, LawError> {
        let (load_n, deviations) = (physics.load_n.clone(), physics.deviations.clone());
        let UncertainFriction { friction_n, mut sources } = match law {
            Law::Physics => law::physics::with_uncertainty(physics.here.clone()?),
            _ => law.uncertain_friction(contact, &load_n)?,
        };
        for deviation in &deviations {
            sources.push(deviation_source(deviation, load_n.len()));
        }
        let remarks = contact.unmodelled().len() as f64;
        if remarks > 0.0 {
            sources.push(BandSource::symmetric(
                "deviations that no law models",
                vec![NORMAL_95 * REMARK * remarks.sqrt(); load_n.len()],
            ));
        }
        let (nearest, beyond) = layout_distance(contact);
        if beyond > 0.0 {
            sources.push(BandSource::symmetric(
                "layout beyond the measured range",
                vec![NORMAL_95 * BEYOND_LAYOUTS * beyond; load_n.len()],
            ));
        }
        if let (Ok(here), true) = (&physics.here, contact.modulus_scatter() > 0.0) {
            sources.push(casting_source(contact.modulus_scatter(), &here.sensitivities));
        }
        if let Some(source) = beyond_loads(&load_n) {
            sources.push(source);
        }
        let own = physics.here.as_ref().ok().map(|here| here.friction_n.as_slice());
        let rivals = rivals(law, contact, &load_n, &friction_n, (own, physics.free_n.as_deref()))?;
        // On another rig the rivals may agree by chance: the band is at least as wide as on the
        // published rig.
        let on_published = match &physics.rig {
            Some(rig) => {
                let friction = match law {
                    Law::Physics => rig.friction_n.clone()?,
                    _ => law.friction_n(&rig.contact, &load_n)?,
                };
                let by_physics = (rig.friction_n.as_deref().ok(), rig.free_n.as_deref());
                self::rivals(law, &rig.contact, &load_n, &friction, by_physics).unwrap_or_default()
            }
            None => Vec::new(),
        };
        // Distance from the nearest measured condition: layout and deviations.
        let distance = deviations.iter().map(|d| d.log_ratio.powi(2)).sum::<f64>() + nearest.powi(2);
        let distance = if is_measured(contact) { 0.0 } else { distance.sqrt() };
        let all_rivals: Vec<_> = rivals.iter().chain(&on_published).cloned().collect();
        sources.push(rival_source(&all_rivals, &load_n, distance));
        Ok(Self { load_n, sources, rivals, deviations })
    }

    /// Returns the half widths of `ln D` at the load of this index, downwards and upwards.
    pub fn half_width(&self, load: usize) -> (f64, f64) {
        let root = |side: fn(&BandSource) -> &Vec<f64>| {
            self.sources.iter().map(|s| side(s)[load].powi(2)).sum::<f64>().sqrt()
        };
        (root(|s| &s.down), root(|s| &s.up))
    }

    /// Returns the half widths of `ln D` at `load_n` newtons, interpolated between the loads of the
    /// sources.
    pub fn half_width_at(&self, load_n: f64) -> (f64, f64) {
        let above = self.load_n.partition_point(|l| *l < load_n);
        if above == 0 {
            return self.half_width(0);
        }
        if above == self.load_n.len() {
            return self.half_width(above - 1);
        }
        let (from, to) = (self.load_n[above - 1], self.load_n[above]);
        let share = libm::log(load_n / from) / libm::log(to / from);
        let ((a, b), (c, d)) = (self.half_width(above - 1), self.half_width(above));
        (a + share * (c - a), b + share * (d - b))
    }

    /// Returns the largest difference between a rival and the law: name of the rival, load, and
    /// ratio of its friction to that of the law. `None` if all ratios are within a factor of
    /// `tolerance`.
    pub fn widest_rival(&self, tolerance: f64) -> Option<(&str, f64, f64)> {
        let all = self.rivals.iter().flat_map(|(name, logs)| {
            logs.iter().zip(&self.load_n).map(move |(log, load)| (name.as_str(), *load, *log))
        });
        all.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))
            .filter(|(_, _, log)| log.abs() > libm::log(tolerance))
            .map(|(name, load, log)| (name, load, libm::exp(log)))
    }
}

/// Returns the loads of the sources: those of `loads_n` if they are few, else evenly spaced in the
/// logarithm.
pub(crate) fn spaced(loads_n: &[f64]) -> Vec<f64> {
    let mut positive: Vec<f64> = loads_n.iter().copied().filter(|l| *l > 0.0).collect();
    positive.sort_by(f64::total_cmp);
    positive.dedup();
    let (Some(&from), Some(&to)) = (positive.first(), positive.last()) else {
        return vec![published::heaviest_load_n()];
    };
    if positive.len() <= LOADS {
        return positive;
    }
    (0..LOADS).map(|i| from * libm::pow(to / from, i as f64 / (LOADS - 1) as f64)).collect()
}

fn deviation_source(deviation: &Deviation, loads: usize) -> BandSource {
    let unknown = UNKNOWN_EFFECT * deviation.log_ratio;
    let half = (0..loads)
        .map(|i| {
            // Without an equilibrium to compare, the whole change is uncertain.
            let effect =
                deviation.log_effect.get(i).copied().unwrap_or(deviation.log_ratio / deviation.uncertainty);
            NORMAL_95 * libm::hypot(deviation.uncertainty * effect, unknown)
        })
        .collect();
    BandSource::symmetric(deviation.parameter, half)
}

/// Scatter of the modulus between castings, to which the force that sinks a pin and the foundation
/// stiffness are proportional.
fn casting_source(modulus_scatter: f64, sensitivities: &[Sensitivities]) -> BandSource {
    let half = sensitivities.iter().map(|s| NORMAL_95 * modulus_scatter * (s[2] + s[3]).abs()).collect();
    BandSource::symmetric("scatter of the hardness between castings", half)
}

fn beyond_loads(load_n: &[f64]) -> Option<BandSource> {
    let (from, to) = (published::lightest_load_n(), published::heaviest_load_n());
    let beyond = |load: f64| libm::log(from / load).max(libm::log(load / to)).max(0.0);
    let half: Vec<f64> = load_n.iter().map(|load| NORMAL_95 * BEYOND_LOADS * beyond(*load)).collect();
    half.iter().any(|h| *h > 0.0).then(|| BandSource::symmetric("loads beyond the tested range", half))
}

/// Computes the rivals of `law`: name, and `ln` of their friction over `own`, that of the law. The
/// frictions by the physics, and with free spans outside the pins, are known.
fn rivals(
    law: Law,
    contact: &Contact,
    load_n: &[f64],
    own: &[f64],
    (physics_n, free_n): (Option<&[f64]>, Option<&[f64]>),
) -> Result<Vec<(String, Vec<f64>)>, LawError> {
    let on_proxy = contact.substrate() == Substrate::Abs;
    let mut all: Vec<(String, Vec<f64>)> = Law::predictive()
        // The paper's model has constants for three layouts and one wrap. As a rival it would make
        // the band jump between contacts. At light loads the layout law agrees with it. On the
        // proxy its constant coefficient contradicts its own maxima; only its trend with load is
        // used, see below.
        .filter(|other| *other != law && *other != Law::Paper)
        .filter_map(|other| {
            let friction = match other {
                Law::Physics => physics_n?.to_vec(),
                _ => other.friction_n(contact, load_n).ok()?,
            };
            Some((other.title().to_owned(), friction))
        })
        .collect();
    if let Some(friction) = free_n.filter(|_| law == Law::Physics) {
        all.push(("physics with free spans outside the pins".to_owned(), friction.to_vec()));
    }
    if law == Law::Physics && on_proxy {
        let heaviest = published::heaviest_load_n();
        let at = law.friction_n(contact, &[heaviest])?[0] / heaviest;
        all.push(("a constant coefficient".to_owned(), load_n.iter().map(|l| l * at).collect()));
    }
    let logs = |friction: Vec<f64>| -> Vec<f64> {
        let ratio = |(rival, own): (&f64, &f64)| libm::log(rival / own);
        friction.iter().zip(own).map(ratio).map(|log| if log.is_finite() { log } else { 0.0 }).collect()
    };
    Ok(all.into_iter().map(|(name, friction)| (name, logs(friction))).collect())
}

/// Weights the rivals by the distance from the measurements: 0 at the heaviest load of a measured
/// condition, 1 far from it in load or contact.
fn rival_source(rivals: &[(String, Vec<f64>)], load_n: &[f64], distance: f64) -> BandSource {
    let far = |distance: f64, near: f64| -libm::expm1(-(distance / near).powi(2));
    let contact = far(distance, NEAR_CONDITION);
    let side = |sign: f64| {
        load_n
            .iter()
            .enumerate()
            .map(|(i, load)| {
                let load = far(libm::log(load / published::heaviest_load_n()), NEAR_LOAD);
                let farthest = rivals.iter().map(|(_, logs)| sign * logs[i]).fold(0.0, f64::max);
                (1.0 - (1.0 - load) * (1.0 - contact)) * farthest
            })
            .collect()
    };
    BandSource { name: "rival laws".to_owned(), down: side(-1.0), up: side(1.0) }
}
