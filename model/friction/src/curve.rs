//! A predicted friction curve, with its band and a word on how far to trust it.

use serde::{Deserialize, Serialize};

use crate::capstan::{Direction, capstan_friction_n, capstan_tension_n};
use crate::published::{self, PublishedLayout};
use crate::{Contact, LayoutLaw, PaperSwitch, Substrate, Switch, SwitchState};

/// Relative uncertainties of the layout law inside the published layouts (model.md 2).
const INTERPOLATED: Spread = Spread { half_load: 0.12, friction: 0.10 };
/// Outside them the law is a guess (model.md 2).
const EXTRAPOLATED: Spread = Spread { half_load: 0.40, friction: 0.40 };
/// Number of pins between which the published layouts lie.
const PINS_MEASURED: std::ops::RangeInclusive<usize> = 3..=6;
/// Slack on the published pitches, in radians.
const PITCH_SLACK_RAD: f64 = 1e-3;

/// The law behind a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// The paper's capstan and eq. 4, with its constants.
    Paper,
    /// The layout law of model.md 2.
    Layout,
    /// A string over sinking pins on a foundation, see [`crate::physics`].
    Physics,
    /// A model calibrated on measured data.
    Calibrated,
}

/// How far a curve can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trust {
    /// A condition that the paper measured.
    Published,
    /// Between measured conditions.
    Interpolated,
    /// Outside them: a guess.
    Extrapolated,
}

/// Tension and friction over load, as columns of equal length; forces in newtons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionCurve {
    /// The law behind the curve.
    pub law: Law,
    /// How far to trust it.
    pub trust: Trust,
    /// Why it is trusted no further; empty for a published condition.
    pub reasons: Vec<String>,
    /// Load on the tendon.
    pub load_n: Vec<f64>,
    /// Tension while the load is released.
    pub eccentric_n: Vec<f64>,
    /// Tension while the load is pulled.
    pub concentric_n: Vec<f64>,
    /// Friction `D = (F_c - F_e)/2`.
    pub friction_n: Vec<f64>,
    /// Lower edge of the band of `D`.
    pub band_low_n: Vec<f64>,
    /// Upper edge of the band of `D`.
    pub band_high_n: Vec<f64>,
    /// Share of `D` that the silicone makes, 0..1.
    pub silicone_share: Vec<f64>,
}

/// A measured friction maximum or onset that the paper prints for a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedPoint {
    /// Load in newtons.
    pub load_n: f64,
    /// Friction in newtons; `None` where the paper gives a load only (the onset of three-double).
    pub friction_n: Option<f64>,
}

struct Spread {
    half_load: f64,
    friction: f64,
}

/// One point of a curve: the state and its band.
struct Banded {
    state: SwitchState,
    low_n: f64,
    high_n: f64,
}

/// The paper's model; `None` for pins on silicone that it gives no constants for.
pub(crate) fn paper_curve(contact: &Contact, loads_n: &[f64]) -> Option<FrictionCurve> {
    match (contact.substrate(), contact.published_layout()) {
        (Substrate::Silicone, Some(layout)) => {
            Some(curve_of(Law::Paper, trust(contact), &paper_device(contact, layout, loads_n)))
        }
        (Substrate::Silicone, None) if contact.pins().count() > 0 => None,
        _ => Some(capstan_curve(contact, loads_n)),
    }
}

/// The paper's capstan on one material: silicone where there are no pins, else the pins alone.
pub(crate) fn capstan_curve(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let points = if contact.pins().count() == 0 {
        silicone_alone(contact, loads_n)
    } else {
        pins_alone(contact, contact.published_layout(), loads_n)
    };
    curve_of(Law::Paper, trust(contact), &points)
}

/// The layout law; `None` without pins on silicone.
pub(crate) fn layout_curve(contact: &Contact, loads_n: &[f64]) -> Option<FrictionCurve> {
    if contact.substrate() == Substrate::Abs {
        return None;
    }
    let law = LayoutLaw::new(contact.pins(), contact.wrap_rad())?;
    let trusted = trust(contact);
    let points = layout_device(contact, law, trusted.0, loads_n);
    Some(curve_of(Law::Layout, trusted, &points))
}

fn curve_of(law: Law, (trust, reasons): (Trust, Vec<String>), points: &[Banded]) -> FrictionCurve {
    let column = |f: fn(&Banded) -> f64| points.iter().map(f).collect::<Vec<_>>();
    FrictionCurve {
        law,
        trust,
        reasons,
        load_n: column(|p| p.state.load_n),
        eccentric_n: column(|p| p.state.eccentric_n),
        concentric_n: column(|p| p.state.concentric_n),
        friction_n: column(|p| p.state.friction_n),
        band_low_n: column(|p| p.low_n),
        band_high_n: column(|p| p.high_n),
        silicone_share: column(|p| p.state.silicone_share),
    }
}

/// What the paper prints for this contact: its maximum, and for three-double the onset of switching.
pub fn published_points(contact: &Contact) -> Vec<PublishedPoint> {
    if !contact.departures().is_empty() {
        return Vec::new();
    }
    let maximum = |d| PublishedPoint { load_n: published::heaviest_load_n(), friction_n: Some(d) };
    match (contact.published_layout(), contact.substrate()) {
        (Some(layout), substrate) => {
            let mut points = vec![maximum(layout.max_n(substrate))];
            if layout.name == "three-double" && substrate == Substrate::Silicone {
                points.push(PublishedPoint { load_n: published::THREE_DOUBLE_ONSET_N, friction_n: None });
            }
            points
        }
        (None, Substrate::Silicone) if contact.pins().count() == 0 => {
            vec![maximum(published::SILICONE_ALONE_MAX_N)]
        }
        _ => Vec::new(),
    }
}

/// How far the friction of `contact` is known from measurements, and why no further.
pub(crate) fn trust(contact: &Contact) -> (Trust, Vec<String>) {
    let mut reasons = contact.departures();
    let pins = contact.pins();
    let bare_silicone = contact.substrate() == Substrate::Silicone && pins.count() == 0;
    if bare_silicone || contact.published_layout().is_some() {
        let trust = if reasons.is_empty() { Trust::Published } else { Trust::Extrapolated };
        return (trust, reasons);
    }
    if !PINS_MEASURED.contains(&pins.count()) {
        reasons.push(format!("{} pin(s); measured were 3 and 6", pins.count()));
    }
    let pitches = published::LAYOUTS.map(|l| l.pitch_rad());
    let (narrow, wide) =
        (pitches.iter().copied().fold(f64::MAX, f64::min), pitches.iter().copied().fold(0.0, f64::max));
    match pins.mean_pitch_rad() {
        Some(pitch) if pitch < narrow - PITCH_SLACK_RAD || pitch > wide + PITCH_SLACK_RAD => {
            reasons.push(format!(
                "the pitch is {:.2} deg; measured were {:.2} to {:.2} deg",
                pitch.to_degrees(),
                narrow.to_degrees(),
                wide.to_degrees()
            ))
        }
        _ => {}
    }
    if !pins.is_even() {
        reasons.push("the pins are unevenly spaced; measured were even ones".to_owned());
    }
    if !pins.is_centred() {
        reasons.push("the pins lie off the middle of the wrap; measured were centred ones".to_owned());
    }
    if reasons.is_empty() {
        reasons.push("this layout lies between those that were measured".to_owned());
        (Trust::Interpolated, reasons)
    } else {
        (Trust::Extrapolated, reasons)
    }
}

/// A plain capstan with a band of `D / (1 + spread) .. D (1 + spread)`.
fn capstan(contact: &Contact, mu: f64, spread: f64, share: f64, loads_n: &[f64]) -> Vec<Banded> {
    let x = mu * contact.wrap_rad();
    loads_n
        .iter()
        .map(|&load_n| {
            let friction_n = capstan_friction_n(load_n, x);
            let state = SwitchState {
                load_n,
                eccentric_n: capstan_tension_n(load_n, x, Direction::Eccentric),
                concentric_n: capstan_tension_n(load_n, x, Direction::Concentric),
                friction_n,
                silicone_share: share,
            };
            banded(state, spread)
        })
        .collect()
}

fn banded(state: SwitchState, spread: f64) -> Banded {
    Banded { low_n: state.friction_n / (1.0 + spread), high_n: state.friction_n * (1.0 + spread), state }
}

/// How far `model` and `measured` lie apart, as a ratio above one less one: the smallest spread that covers both.
fn miss(model: f64, measured: f64) -> f64 {
    (model / measured).max(measured / model) - 1.0
}

fn silicone_alone(contact: &Contact, loads_n: &[f64]) -> Vec<Banded> {
    let model = capstan_friction_n(
        published::heaviest_load_n(),
        published::MU_SILICONE * published::wrap_angle_rad(),
    );
    let spread = miss(model, published::SILICONE_ALONE_MAX_N).max(extrapolated_spread(contact));
    capstan(contact, published::MU_SILICONE, spread, 1.0, loads_n)
}

/// Pins alone: the paper's constant coefficient, which misses its own three maxima by 42 to 113 %; the band says so.
fn pins_alone(contact: &Contact, layout: Option<PublishedLayout>, loads_n: &[f64]) -> Vec<Banded> {
    let model =
        capstan_friction_n(published::heaviest_load_n(), published::MU_PINS * published::wrap_angle_rad());
    let spread = match layout {
        Some(layout) => miss(model, layout.pins_max_n),
        None => published::LAYOUTS.iter().map(|l| miss(model, l.pins_max_n)).fold(0.0, f64::max),
    };
    capstan(contact, published::MU_PINS, spread.max(extrapolated_spread(contact)), 0.0, loads_n)
}

/// A published layout: its own miss at the maximum, and no less than the three layouts' root mean square.
fn paper_device(contact: &Contact, layout: PublishedLayout, loads_n: &[f64]) -> Vec<Banded> {
    let own = |l: &PublishedLayout| {
        let state = PaperSwitch::new(*l).state(published::heaviest_load_n(), published::wrap_angle_rad());
        miss(state.friction_n, l.device_max_n)
    };
    let mean_square =
        published::LAYOUTS.iter().map(|l| own(l).powi(2)).sum::<f64>() / published::LAYOUTS.len() as f64;
    let spread = own(&layout).max(mean_square.sqrt()).max(extrapolated_spread(contact));
    let switch = PaperSwitch::new(layout);
    loads_n.iter().map(|&load| banded(switch.state(load, contact.wrap_rad()), spread)).collect()
}

/// A published layout in a part that departs from the measured one is no longer published.
fn extrapolated_spread(contact: &Contact) -> f64 {
    if contact.departures().is_empty() { 0.0 } else { EXTRAPOLATED.friction }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PinPattern, predict};
    use proptest::prelude::*;

    fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
        Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn every_published_condition_is_published_and_its_band_covers_the_measured_maximum() {
        let mut conditions = vec![contact(Substrate::Silicone, PinPattern::default())];
        for l in &published::LAYOUTS {
            for substrate in [Substrate::Silicone, Substrate::Abs] {
                conditions.push(contact(substrate, PinPattern::even(l.pins, l.pitch_rad())));
            }
        }
        for c in &conditions {
            let curve = predict(c, &[published::heaviest_load_n()]);
            assert_eq!((curve.law, curve.trust), (Law::Paper, Trust::Published));
            assert!(curve.reasons.is_empty());
            let measured = published_points(c)[0].friction_n.unwrap();
            let covered = curve.band_low_n[0] * 0.999_999..=curve.band_high_n[0] * 1.000_001;
            assert!(covered.contains(&measured), "{measured} outside {covered:?}");
        }
    }

    #[test]
    fn other_layouts_say_how_far_they_are_known() {
        let between = contact(Substrate::Silicone, PinPattern::even(4, 0.25));
        assert_eq!(predict(&between, &[20.0]).trust, Trust::Interpolated);
        let reasons = |pins| predict(&contact(Substrate::Silicone, pins), &[20.0]);
        for (pins, word) in [
            (PinPattern::even(9, 0.1), "9 pin"),
            (PinPattern::even(4, 0.1), "pitch"),
            (PinPattern::new(vec![-0.3, 0.0, 0.2]), "unevenly"),
            (PinPattern::new(vec![-0.4, -0.1, 0.2]), "off the middle"),
            (PinPattern::even(5, 0.29), "outside the wrap"),
        ] {
            let curve = reasons(pins);
            assert_eq!(curve.trust, Trust::Extrapolated);
            assert!(curve.reasons.iter().any(|r| r.contains(word)), "{word}: {:?}", curve.reasons);
        }
    }

    #[test]
    fn a_departure_makes_a_published_layout_an_extrapolation() {
        let l = &published::LAYOUTS[1];
        let plain = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
        let soft = plain.clone().with_departures(vec!["another silicone".to_owned()]);
        let (a, b) = (predict(&plain, &[40.0]), predict(&soft, &[40.0]));
        assert_eq!(b.trust, Trust::Extrapolated);
        assert!(b.band_high_n[0] > a.band_high_n[0]);
        assert!(published_points(&soft).is_empty());
    }

    proptest! {
        #[test]
        fn bands_hold_the_curve_and_forces_stay_ordered(
            count in 0usize..15, pitch in 0.02..0.5f64, load in 0.0..80.0f64, wrap in 0.1..3.0f64
        ) {
            let c = Contact::new(Substrate::Silicone, PinPattern::even(count, pitch), wrap).unwrap();
            let curve = predict(&c, &[load]);
            prop_assert!(curve.band_low_n[0] <= curve.friction_n[0]);
            prop_assert!(curve.friction_n[0] <= curve.band_high_n[0]);
            prop_assert!(curve.eccentric_n[0] <= load && load <= curve.concentric_n[0]);
            prop_assert!((0.0..=1.0).contains(&curve.silicone_share[0]));
        }
    }
}
