//! `layout`: a switch from the number and pitch of the pins, fitted to the three published layouts.

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
    summary: "Fit to the thresholds of the three published layouts: number and pitch of the pins",
    source: "layout law fitted to the three published layouts: F_half = 13.1 N sqrt(n/(a p)), s = 4.64",
    needs_model: false,
    states: layout_states,
    uncertain: layout_uncertain,
    remark: |_| None,
};

/// Relative standard deviation of friction from errors other than that of the half load: the law's
/// error on the three maxima.
const FRICTION_UNCERTAINTY: f64 = 0.10;

/// Returns the number of pins under the tendon. The weight of a pin falls from one at the end of
/// the wrap to zero at half a pitch beyond it, where the chord to its neighbour has the direction
/// of the tendon.
fn touching(contact: &Contact, pitch_rad: f64) -> f64 {
    let half = contact.wrap_rad() / 2.0;
    let share = |angle: &f64| (1.0 - (angle.abs() - half) / (pitch_rad / 2.0)).clamp(0.0, 1.0);
    contact.all_pins().angles_rad().iter().map(share).sum()
}

/// Returns the layout law of a contact with pins on silicone.
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

/// Propagates the uncertainties of the half load and of the maxima, at two standard deviations.
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
            BandSource::symmetric(
                "errors at the measured maxima",
                vec![2.0 * FRICTION_UNCERTAINTY; loads_n.len()],
            ),
        ],
    })
}

/// Weight per pin: `w = n/30` reproduces the three published weights.
const WEIGHT_PER_PIN: f64 = 1.0 / 30.0;

/// Logistic switch whose half load follows from the layout (`model/doc/friction-laws.md`):
/// `S = 1/(1 + exp(-s (F/F_half - 1)))` with `F_half = C sqrt(n/(a p))`.
///
/// `F` is the load and `F_half` the half load (N), `s` the steepness, `C` the scale (N), `n` the
/// number of pins, `a` the wrap angle and `p` the pitch (rad).
///
/// ```
/// use pinswitch_friction::{LayoutLaw, PinPattern, Switch, published};
///
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let law = LayoutLaw::new(&pins, published::wrap_angle_rad()).ok_or("no pins")?;
/// assert!((law.switched(law.half_load_n()) - 0.5).abs() < 1e-12);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutLaw {
    half_load_n: f64,
    steepness: f64,
    weight: f64,
}

/// Constants of the rule `F_half = C sqrt(n/(a p))`, with one steepness for all layouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThresholdRule {
    /// `C`, in newtons.
    pub scale_n: f64,
    /// `s`, dimensionless.
    pub steepness: f64,
}

impl ThresholdRule {
    /// Fits the rule to the printed thresholds of these layouts, or returns `None` without layouts.
    ///
    /// The half load of a layout is the load at which `F_r` reaches `F_thr`, its steepness the
    /// slope of `F_r` times that load. The scale is the geometric mean over the layouts, the
    /// steepness the arithmetic mean.
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
    /// Steepness `s` of the switch, dimensionless, for all three published layouts.
    pub const STEEPNESS: f64 = 4.64;

    /// Rule with both constants.
    pub const RULE: ThresholdRule = ThresholdRule { scale_n: Self::SCALE_N, steepness: Self::STEEPNESS };

    /// `C` of `F_half = C sqrt(n/(a p))` in newtons, for all three published layouts.
    pub const SCALE_N: f64 = 13.1;

    /// Relative uncertainty of the half load between the published layouts.
    pub const UNCERTAINTY: f64 = 0.12;

    /// Returns `F_half = C sqrt(n/(a p))` in newtons for `n` pins with a pitch `p` on a wrap `a`,
    /// both in radians.
    pub fn half_load_at_n(pins: f64, pitch_rad: f64, wrap_rad: f64) -> f64 {
        Self::SCALE_N * (pins / (wrap_rad * pitch_rad)).sqrt()
    }

    /// Creates the law for `pins` within a wrap of `wrap_rad` radians, or returns `None` without
    /// pins.
    ///
    /// Uneven pins have their mean pitch; the pitch of a single pin is the whole wrap.
    pub fn new(pins: &PinPattern, wrap_rad: f64) -> Option<Self> {
        Self::by_rule(pins, wrap_rad, Self::RULE)
    }

    /// Creates the law for `pins` by another rule.
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

    /// Returns the same law with its half load multiplied by `factor`.
    #[must_use]
    pub fn with_half_load_scaled(self, factor: f64) -> Self {
        Self { half_load_n: self.half_load_n * factor, ..self }
    }

    /// Returns the load in newtons at which half of the contact has switched.
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

    /// `model/doc/friction-laws.md`: the errors of the maxima are 0.0, +6.5 and -3.4 %. The
    /// constants are printed with three digits, hence the tolerance of 0.7 %.
    #[test]
    fn published_maxima_are_reproduced() {
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
    fn half_load_follows_the_layout() {
        let half = |n, p| LayoutLaw::new(&PinPattern::even(n, p), 1.1).unwrap().half_load_n();
        assert!(half(6, 0.2) > half(3, 0.2));
        assert!(half(3, 0.3) < half(3, 0.2));
        assert_eq!(LayoutLaw::new(&PinPattern::default(), 1.1), None);
    }

    /// `model/doc/friction-laws.md`: half loads of 68.3, 39.5 and 44.0 N.
    #[test]
    fn rules_fit_the_printed_thresholds() {
        for (layout, half_load) in published::LAYOUTS.iter().zip([68.3, 39.5, 44.0]) {
            let rule = ThresholdRule::fitted(&[*layout]).unwrap();
            let pins = PinPattern::even(layout.pins, layout.pitch_rad());
            let law = LayoutLaw::by_rule(&pins, published::wrap_angle_rad(), rule).unwrap();
            assert!((law.half_load_n() - half_load).abs() < 0.06, "{}: {law:?}", layout.name);
        }
        assert_eq!(ThresholdRule::fitted(&[]), None);
    }

    #[test]
    fn source_text_has_the_constants() {
        let named = format!("F_half = {} N sqrt(n/(a p)), s = {}", LayoutLaw::SCALE_N, LayoutLaw::STEEPNESS);
        assert!(DEFINITION.source.ends_with(&named), "{}", DEFINITION.source);
    }
}
