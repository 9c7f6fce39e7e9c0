//! `layout`: from number and pitch of the pins to a switch, fitted to the three published layouts.

use super::definition::{LawDefinition, UncertainFriction};
use super::error::LawError;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::published::{self, PublishedLayout};
use crate::substrate::Substrate;
use crate::switch::{Switch, SwitchState};

pub(super) static DEFINITION: LawDefinition = LawDefinition {
    word: "layout",
    title: "layout law",
    summary: "The law fitted to the three layouts' thresholds: number and pitch of the pins",
    source: "layout law fitted to the three published layouts: F_half = 13.1 N sqrt(n/(a p)), s = 4.64",
    needs_model: false,
    states: layout_states,
    uncertain: layout_uncertain,
    remark: |_| None,
};

/// Relative uncertainty of friction besides that of the half load: what the law misses of the three maxima.
const FRICTION_UNCERTAINTY: f64 = 0.10;

/// Number of pins that the tendon touches: one beyond the wrap counts less and less, and not at all half a pitch from its
/// end, where the chord to its neighbour has turned as far as the tendon.
fn touching(contact: &Contact, pitch_rad: f64) -> f64 {
    let half = contact.wrap_rad() / 2.0;
    let share = |angle: &f64| (1.0 - (angle.abs() - half) / (pitch_rad / 2.0)).clamp(0.0, 1.0);
    contact.all_pins().angles_rad().iter().map(share).sum()
}

fn law_of(contact: &Contact) -> Result<LayoutLaw, LawError> {
    (contact.substrate() == Substrate::Silicone)
        .then(|| {
            let pitch_rad = contact.all_pins().mean_pitch_rad().unwrap_or(contact.wrap_rad());
            LayoutLaw::of_count(touching(contact, pitch_rad), pitch_rad, contact.wrap_rad(), LayoutLaw::RULE)
        })
        .flatten()
        .ok_or(LawError::DoesNotApply {
            problem: "the layout law describes pins on silicone only",
            help: "use the law paper or physics",
        })
}

fn layout_states(contact: &Contact, loads_n: &[f64]) -> Result<Vec<SwitchState>, LawError> {
    let law = law_of(contact)?;
    Ok(loads_n.iter().map(|&load| law.state(load, contact.wrap_rad())).collect())
}

/// What the half load and the misses at the maxima leave open, at twice their standard deviations.
fn layout_uncertain(contact: &Contact, loads_n: &[f64]) -> Result<UncertainFriction, LawError> {
    let law = law_of(contact)?;
    let factor = 1.0 + 2.0 * LayoutLaw::UNCERTAINTY;
    let (early, late) = (law.with_half_load_scaled(1.0 / factor), law.with_half_load_scaled(factor));
    let log = |law: &LayoutLaw, load: f64| libm::log(law.state(load, contact.wrap_rad()).friction_n);
    let side = |moved: &LayoutLaw, sign: f64| {
        loads_n.iter().map(|&load| (sign * (log(moved, load) - log(&law, load))).max(0.0)).collect()
    };
    Ok(UncertainFriction {
        friction_n: loads_n.iter().map(|&load| libm::exp(log(&law, load))).collect(),
        sources: vec![
            BandSource { name: "half load".to_owned(), down: side(&late, -1.0), up: side(&early, 1.0) },
            BandSource::even(
                "misses at the measured maxima",
                vec![2.0 * FRICTION_UNCERTAINTY; loads_n.len()],
            ),
        ],
    })
}

/// `w = n/30` reproduces the three published weights.
const WEIGHT_PER_PIN: f64 = 1.0 / 30.0;

/// `S = 1/(1 + exp(-s (F/F_half - 1)))` with `F_half = C sqrt(n/(a p))` (`model/doc/friction-laws.md`).
///
/// ```
/// use pinswitch_friction::{LayoutLaw, PinPattern, Switch, published};
///
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let law = LayoutLaw::new(&pins, published::wrap_angle_rad()).ok_or("no pins, nothing to switch")?;
/// assert!((law.switched(law.half_load_n()) - 0.5).abs() < 1e-12);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutLaw {
    half_load_n: f64,
    steepness: f64,
    weight: f64,
}

/// How a half load follows from a layout: `F_half = C sqrt(n/(a p))`, with one steepness for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThresholdRule {
    /// `C`, in newtons.
    pub scale_n: f64,
    /// `s`, dimensionless.
    pub steepness: f64,
}

impl ThresholdRule {
    /// The rule that the printed thresholds of these layouts follow, on average; `None` without any. The half load is
    /// where `F_r` reaches `F_thr`, the steepness the slope of `F_r` there times that load.
    pub fn fitted(layouts: &[PublishedLayout]) -> Option<Self> {
        let (light, heavy) = (published::lightest_load_n(), published::heaviest_load_n());
        let (mut log_scale, mut steepness) = (0.0, 0.0);
        for layout in layouts {
            let (from, to) = layout.reduced_load;
            let half_load = light + (layout.threshold - from) / (to - from) * (heavy - light);
            let unit = (layout.pins as f64 / (published::wrap_angle_rad() * layout.pitch_rad())).sqrt();
            log_scale += libm::log(half_load / unit);
            steepness += (to - from) / (heavy - light) * half_load;
        }
        let count = layouts.len() as f64;
        (count > 0.0).then(|| Self { scale_n: libm::exp(log_scale / count), steepness: steepness / count })
    }
}

impl LayoutLaw {
    /// Steepness `s` of the switch, dimensionless: describes all three published layouts.
    pub const STEEPNESS: f64 = 4.64;

    /// The rule of both constants.
    pub const RULE: ThresholdRule = ThresholdRule { scale_n: Self::SCALE_N, steepness: Self::STEEPNESS };

    /// `C` of `F_half = C sqrt(n/(a p))`, in newtons: describes all three published layouts.
    pub const SCALE_N: f64 = 13.1;

    /// Relative uncertainty of the half load between the published layouts.
    pub const UNCERTAINTY: f64 = 0.12;

    /// `F_half = C sqrt(n/(a p))` in newtons for `n` pins a pitch `p` apart on a wrap `a`, both in radians.
    pub fn half_load_at_n(pins: f64, pitch_rad: f64, wrap_rad: f64) -> f64 {
        Self::SCALE_N * (pins / (wrap_rad * pitch_rad)).sqrt()
    }

    /// The law for `pins` within a wrap of `wrap_rad` radians; uneven pins enter with their mean pitch,
    /// a single pin with the whole wrap as its pitch. `None` without pins: there is nothing to switch.
    pub fn new(pins: &PinPattern, wrap_rad: f64) -> Option<Self> {
        Self::by_rule(pins, wrap_rad, Self::RULE)
    }

    /// The law for `pins` by another rule than its own.
    pub fn by_rule(pins: &PinPattern, wrap_rad: f64, rule: ThresholdRule) -> Option<Self> {
        let pitch_rad = pins.mean_pitch_rad().unwrap_or(wrap_rad);
        Self::of_count(pins.count() as f64, pitch_rad, wrap_rad, rule)
    }

    fn of_count(n: f64, pitch_rad: f64, wrap_rad: f64, rule: ThresholdRule) -> Option<Self> {
        (n > 0.0).then(|| Self {
            half_load_n: Self::half_load_at_n(n, pitch_rad, wrap_rad) * rule.scale_n / Self::SCALE_N,
            steepness: rule.steepness,
            weight: (n * WEIGHT_PER_PIN).min(1.0),
        })
    }

    /// The same law with its half load scaled by `factor`: how the band is propagated.
    #[must_use]
    pub fn with_half_load_scaled(self, factor: f64) -> Self {
        Self { half_load_n: self.half_load_n * factor, ..self }
    }

    /// Load in newtons at which half of the contact has switched.
    pub fn half_load_n(&self) -> f64 {
        self.half_load_n
    }
}

impl Switch for LayoutLaw {
    fn switched(&self, load_n: f64) -> f64 {
        1.0 / (1.0 + libm::exp(-self.steepness * (load_n / self.half_load_n - 1.0)))
    }

    fn weight(&self) -> f64 {
        self.weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `model/doc/friction-laws.md`: the maxima come out at 0.0 / +6.5 / -3.4 %; its constants are printed to three
    /// digits, which leaves 0.7 % open.
    #[test]
    fn describes_the_three_published_maxima() {
        let errors: Vec<_> = published::LAYOUTS
            .iter()
            .map(|l| {
                let pins = PinPattern::even(l.pins, l.pitch_rad());
                let law = LayoutLaw::new(&pins, published::wrap_angle_rad()).unwrap();
                let d = law.state(published::heaviest_load_n(), published::wrap_angle_rad()).friction_n;
                (d / l.device_max_n - 1.0) * 100.0
            })
            .collect();
        for (error, printed) in errors.iter().zip([0.0, 6.5, -3.4]) {
            assert!((error - printed).abs() < 0.7, "{errors:?}");
        }
    }

    #[test]
    fn more_pins_switch_later_and_wider_pins_earlier() {
        let half = |n, p| LayoutLaw::new(&PinPattern::even(n, p), 1.1).unwrap().half_load_n();
        assert!(half(6, 0.2) > half(3, 0.2));
        assert!(half(3, 0.3) < half(3, 0.2));
        assert_eq!(LayoutLaw::new(&PinPattern::default(), 1.1), None);
    }

    /// `model/doc/friction-laws.md`: half loads of 68.3, 39.5 and 44.0 N.
    #[test]
    fn a_rule_follows_from_the_printed_thresholds() {
        for (layout, half_load) in published::LAYOUTS.iter().zip([68.3, 39.5, 44.0]) {
            let rule = ThresholdRule::fitted(&[*layout]).unwrap();
            let pins = PinPattern::even(layout.pins, layout.pitch_rad());
            let law = LayoutLaw::by_rule(&pins, published::wrap_angle_rad(), rule).unwrap();
            assert!((law.half_load_n() - half_load).abs() < 0.06, "{}: {law:?}", layout.name);
        }
        assert_eq!(ThresholdRule::fitted(&[]), None);
    }

    #[test]
    fn the_source_names_the_constants_that_are_used() {
        let named = format!("F_half = {} N sqrt(n/(a p)), s = {}", LayoutLaw::SCALE_N, LayoutLaw::STEEPNESS);
        assert!(DEFINITION.source.ends_with(&named), "{}", DEFINITION.source);
    }
}
