//! `layout`: from number and pitch of the pins to a switch, fitted to the three published layouts.

use super::{Definition, Law, LawError, Support};
use crate::curve::Banded;
use crate::trust::{EXTRAPOLATED_SPREAD, trust};
use crate::{Contact, FrictionCurve, PinPattern, Substrate, Switch, Trust};

pub(super) static DEFINITION: Definition = Definition {
    word: "layout",
    title: "layout law",
    summary: "The law fitted to the three layouts' thresholds: number and pitch of the pins",
    source: "layout law fitted to the three published layouts: F_half = 13.1 N sqrt(n/(a p)), s = 4.64",
    needs_model: false,
    support,
    curve: layout_curve,
};

/// Relative uncertainties of half load and friction.
struct Spread {
    half_load: f64,
    friction: f64,
}

/// Between the published layouts (`model/doc/friction-laws.md`).
const INTERPOLATED: Spread = Spread { half_load: LayoutLaw::UNCERTAINTY, friction: 0.10 };
/// Outside them the law is a guess.
const EXTRAPOLATED: Spread = Spread { half_load: EXTRAPOLATED_SPREAD, friction: EXTRAPOLATED_SPREAD };

/// At its best between the layouts that it was fitted to.
fn support(contact: &Contact) -> Support {
    if trust(contact).0 == Trust::Interpolated && contact.substrate() == Substrate::Silicone {
        Support::Interpolated
    } else {
        Support::StandIn
    }
}

fn layout_curve(contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    let law = (contact.substrate() == Substrate::Silicone)
        .then(|| LayoutLaw::new(contact.pins(), contact.wrap_rad()))
        .flatten()
        .ok_or(LawError::DoesNotApply {
            why: "the layout law describes pins on silicone only; use the law paper or physics",
        })?;
    let trusted = trust(contact);
    let points = layout_device(contact, law, trusted.0, loads_n);
    Ok(FrictionCurve::of(Law::Layout, trusted, &points))
}

/// The layout law; its band is the envelope over both uncertainties.
fn layout_device(contact: &Contact, law: LayoutLaw, trust: Trust, loads_n: &[f64]) -> Vec<Banded> {
    let spread = if trust == Trust::Extrapolated { EXTRAPOLATED } else { INTERPOLATED };
    let (early, late) = (
        law.with_half_load_scaled(1.0 / (1.0 + spread.half_load)),
        law.with_half_load_scaled(1.0 + spread.half_load),
    );
    loads_n
        .iter()
        .map(|&load| {
            let friction = |law: &LayoutLaw| law.state(load, contact.wrap_rad()).friction_n;
            let state = law.state(load, contact.wrap_rad());
            let (a, b) = (friction(&early), friction(&late));
            let low_n = a.min(b).min(state.friction_n) / (1.0 + spread.friction);
            let high_n = a.max(b).max(state.friction_n) * (1.0 + spread.friction);
            Banded { state, low_n, high_n }
        })
        .collect()
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
    weight: f64,
}

impl LayoutLaw {
    /// Steepness `s` of the switch, dimensionless: describes all three published layouts.
    pub const STEEPNESS: f64 = 4.64;

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
        let n = pins.count() as f64;
        let pitch = pins.mean_pitch_rad().unwrap_or(wrap_rad);
        (pins.count() > 0).then(|| Self {
            half_load_n: Self::half_load_at_n(n, pitch, wrap_rad),
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
        1.0 / (1.0 + (-Self::STEEPNESS * (load_n / self.half_load_n - 1.0)).exp())
    }

    fn weight(&self) -> f64 {
        self.weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published;

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

    #[test]
    fn the_source_names_the_constants_that_are_used() {
        let named = format!("F_half = {} N sqrt(n/(a p)), s = {}", LayoutLaw::SCALE_N, LayoutLaw::STEEPNESS);
        assert!(DEFINITION.source.ends_with(&named), "{}", DEFINITION.source);
    }
}
