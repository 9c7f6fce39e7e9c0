//! Gains over the flexion of a joint. The flexion determines the wrap, and the wrap the pins under
//! the tendon.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use schemars::JsonSchema;
use serde::Serialize;

use super::gains::{FingerPoint, Tensions};
use crate::contact::Contact;
use crate::curve::FrictionCurve;
use crate::law::{Law, LawError};
use crate::plural::pluralise;
use crate::published;
use crate::status::PredictionStatus;

/// Largest flexion of a joint in degrees.
const LARGEST_FLEXION_DEG: f64 = 180.0;
/// Largest wrap of a straight finger in degrees.
const LARGEST_START_DEG: f64 = 180.0;
/// Largest wrap per flexion, in degrees per degree.
const LARGEST_SHARE: f64 = 2.0;
/// Wrap below which the tendon touches nothing, in radians.
const SAME_RAD: f64 = 1e-9;

/// A value of a joint or of its tendon path that is out of bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{}", Diagnostic::from(*self))]
pub struct JointPathError {
    /// Field, with its unit.
    pub field: &'static str,
    /// Value as given.
    pub value: f64,
    /// Least allowed value.
    pub low: f64,
    /// Largest allowed value.
    pub high: f64,
    /// What to do about it.
    pub help: &'static str,
}

impl From<JointPathError> for Diagnostic {
    fn from(error: JointPathError) -> Self {
        let JointPathError { field, value, low, high, help } = error;
        Self::new(codes::OUT_OF_RANGE, format!("must be from {low} to {high}"))
            .with_location(Location::field(field, value.to_string()))
            .with_help(help)
    }
}

impl JointPathError {
    /// Returns the value if it is from `low` to `high`.
    ///
    /// # Errors
    /// [`JointPathError`] with `field` and `help` for any other value.
    pub fn within(
        field: &'static str,
        value: f64,
        (low, high): (f64, f64),
        help: &'static str,
    ) -> Result<f64, Self> {
        if (low..=high).contains(&value) { Ok(value) } else { Err(Self { field, value, low, high, help }) }
    }
}

/// Wrap of the tendon on a switch at one flexion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrap {
    /// Wrap angle, degrees.
    pub wrap_deg: f64,
    /// Angle of the middle of the wrap from the middle of the segment, degrees.
    pub middle_deg: f64,
}

/// Wrap over flexion: assumed ([`JointPath`]), or computed from the geometry of a joint.
pub trait FlexionWrap {
    /// Returns the wrap at a flexion in degrees.
    ///
    /// # Errors
    /// [`JointPathError`] if the flexion is out of bounds.
    fn wrap(&self, joint_deg: f64) -> Result<Wrap, JointPathError>;

    /// Returns the flexion in degrees at which the contact is that of the paper's experiment, if
    /// any: the only measured point of a curve over the joint.
    fn measured_joint_deg(&self) -> Option<f64>;
}

/// Assumed relation between the flexion of a joint and the wrap on its switch:
/// `wrap = start + share flexion`.
///
/// The default is a two-link finger with a straight tendon along both links: its direction turns by
/// the flexion, all of it on the switch. This is an assumption, because no path is published
/// (`model/doc/finger.md`).
///
/// ```
/// use pinswitch_friction::finger::JointPath;
///
/// assert_eq!(JointPath::default().wrap_deg(83.0)?, 83.0);
/// // A wrap of 10 degrees at the straight finger, and guides that take a fifth of the turn.
/// let path = JointPath::new(10.0, 0.8)?;
/// assert_eq!(path.wrap_deg(50.0)?, 50.0);
/// let error = path.wrap_deg(-5.0).unwrap_err();
/// assert!(error.to_string().starts_with("joint angle (deg) = -5: must be from 0 to 180"));
/// # Ok::<(), pinswitch_friction::finger::JointPathError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JointPath {
    /// Wrap angle at the straight finger, degrees.
    wrap_at_straight_deg: f64,
    /// Increase of the wrap angle per degree of flexion, degrees.
    wrap_per_flexion: f64,
}

impl Default for JointPath {
    fn default() -> Self {
        Self { wrap_at_straight_deg: 0.0, wrap_per_flexion: 1.0 }
    }
}

impl JointPath {
    /// Creates a path with a wrap of `wrap_at_straight_deg` degrees at the straight finger, and
    /// `wrap_per_flexion` more degrees for each degree of flexion.
    ///
    /// # Errors
    /// [`JointPathError`] if a value is out of bounds.
    pub fn new(wrap_at_straight_deg: f64, wrap_per_flexion: f64) -> Result<Self, JointPathError> {
        const START: &str = "give the wrap of the straight finger in degrees, 0 if its tendon is straight";
        const SHARE: &str =
            "give the share of the flexion that turns the tendon on the switch, 1 for all of it";
        Ok(Self {
            wrap_at_straight_deg: JointPathError::within(
                "wrap at the straight finger (deg)",
                wrap_at_straight_deg,
                (0.0, LARGEST_START_DEG),
                START,
            )?,
            wrap_per_flexion: JointPathError::within(
                "wrap per flexion",
                wrap_per_flexion,
                (0.0, LARGEST_SHARE),
                SHARE,
            )?,
        })
    }

    /// Returns the wrap at a flexion, both in degrees.
    ///
    /// # Errors
    /// [`JointPathError`] if the flexion is out of bounds.
    pub fn wrap_deg(&self, joint_deg: f64) -> Result<f64, JointPathError> {
        let help = "give flexions between a straight and a folded finger";
        JointPathError::within("joint angle (deg)", joint_deg, (0.0, LARGEST_FLEXION_DEG), help)
            .map(|joint_deg| self.wrap_at_straight_deg + self.wrap_per_flexion * joint_deg)
    }
}

impl FlexionWrap for JointPath {
    fn wrap(&self, joint_deg: f64) -> Result<Wrap, JointPathError> {
        Ok(Wrap { wrap_deg: self.wrap_deg(joint_deg)?, middle_deg: 0.0 })
    }

    fn measured_joint_deg(&self) -> Option<f64> {
        let joint_deg = (published::WRAP_ANGLE_DEG - self.wrap_at_straight_deg) / self.wrap_per_flexion;
        (0.0..=LARGEST_FLEXION_DEG).contains(&joint_deg).then_some(joint_deg)
    }
}

impl std::fmt::Display for JointPath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { wrap_at_straight_deg, wrap_per_flexion } = self;
        write!(f, "wrap = {wrap_at_straight_deg} deg + {wrap_per_flexion} x flexion")
    }
}

/// Gains and costs at one flexion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JointPoint {
    /// Flexion of the joint, degrees.
    pub joint_deg: f64,
    /// Wrap of the tendon on the switch, degrees.
    pub wrap_deg: f64,
    /// Angle of the middle of the wrap from the middle of the segment, degrees.
    #[serde(skip_serializing_if = "is_zero")]
    pub wrap_middle_deg: f64,
    /// Number of pins within the wrap.
    pub pins: usize,
    /// Support of the prediction at this wrap by measurements.
    #[serde(rename = "trust")]
    pub status: PredictionStatus,
    /// Gains and costs.
    #[serde(flatten)]
    pub gains: FingerPoint,
}

/// Whether the wrap is centred, as all assumed ones are.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde needs")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Gains over the joint at one load.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JointCurve {
    /// Load, N.
    pub load_n: f64,
    /// Laws of the points, in the order of their first use; more than one with a fallback.
    pub laws: Vec<Law>,
    /// Status of the least supported point.
    #[serde(rename = "trust")]
    pub status: PredictionStatus,
    /// Reasons for the status, and the flexions that are left out.
    pub reasons: Vec<String>,
    /// Points, in the order of the given flexions.
    pub points: Vec<JointPoint>,
}

/// Computes the gains of a part at `load_n` newtons over the flexions `joints_deg` of its joint,
/// with the curves of `predict`. Leaves out flexions to which the law does not apply, and adds a
/// reason.
///
/// ```
/// use pinswitch_friction::finger::{JointPath, over_joint};
/// use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
///
/// let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let predicted = |contact: &Contact, loads_n: &[f64]| Ok(predict(contact, loads_n));
/// let curve = over_joint(&contact, &JointPath::default(), &[0.0, 30.0, 83.0], 49.671, predicted)?;
/// let difference = |i: usize| curve.points[i].gains.force_difference.value;
/// assert_eq!(difference(0), 0.0, "a straight tendon touches nothing");
/// assert!(difference(1) < difference(2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`JointPathError`] if a flexion is out of bounds.
pub fn over_joint(
    contact: &Contact,
    path: &impl FlexionWrap,
    joints_deg: &[f64],
    load_n: f64,
    predict: impl Fn(&Contact, &[f64]) -> Result<FrictionCurve, LawError>,
) -> Result<JointCurve, JointPathError> {
    let mut curve = JointCurve {
        load_n,
        laws: Vec::new(),
        status: PredictionStatus::Published,
        reasons: Vec::new(),
        points: Vec::new(),
    };
    let mut left_out: Vec<(f64, Diagnostic)> = Vec::new();
    for &joint_deg in joints_deg {
        let Wrap { wrap_deg, middle_deg } = path.wrap(joint_deg)?;
        match state(contact, [wrap_deg, middle_deg].map(f64::to_radians), load_n, &predict) {
            Ok(state) => {
                let Some(gains) = state.tensions.gains(load_n) else { continue };
                curve.status = curve.status.max(state.status);
                if let Some(law) = state.law.filter(|law| !curve.laws.contains(law)) {
                    curve.laws.push(law);
                }
                let State { pins, status, .. } = state;
                let wrap_middle_deg = middle_deg;
                curve.points.push(JointPoint { joint_deg, wrap_deg, wrap_middle_deg, pins, status, gains });
            }
            Err(error) => left_out.push((joint_deg, error)),
        }
    }
    if curve.status == PredictionStatus::Extrapolated {
        curve.reasons.push(format!(
            "one wrap was measured, {} deg: every other flexion is extrapolated",
            published::WRAP_ANGLE_DEG
        ));
    }
    if let Some((first_deg, error)) = left_out.first() {
        let count = pluralise(left_out.len(), "flexion");
        curve.reasons.push(format!("{count} left out, the first at {first_deg} deg: {}", error.problem()));
    }
    Ok(curve)
}

/// State of a contact at one wrap.
#[derive(Clone, Copy)]
struct State {
    tensions: Tensions,
    pins: usize,
    law: Option<Law>,
    status: PredictionStatus,
}

/// Predicts the state of a contact with another wrap, about another middle.
fn state(
    contact: &Contact,
    [wrap_rad, middle_rad]: [f64; 2],
    load_n: f64,
    predict: &impl Fn(&Contact, &[f64]) -> Result<FrictionCurve, LawError>,
) -> Result<State, Diagnostic> {
    if wrap_rad < SAME_RAD {
        let tensions = Tensions::without_friction(load_n);
        // A tendon that touches nothing has no friction: this needs no measurement.
        return Ok(State { tensions, pins: 0, law: None, status: PredictionStatus::Published });
    }
    let contact = contact.at_wrap_about(wrap_rad, middle_rad)?;
    let curve = predict(&contact, &[load_n])?;
    let tensions = Tensions::from_curve(&curve, 0)
        .ok_or_else(|| Diagnostic::new(codes::LAW_DOES_NOT_APPLY, "the law gives no point at this load"))?;
    Ok(State { tensions, pins: contact.pins().count(), law: Some(curve.law), status: curve.status })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finger::gains::finger;
    use crate::pattern::PinPattern;
    use crate::prediction::{predict, predict_by};
    use crate::substrate::Substrate;

    fn part(pins: PinPattern) -> Contact {
        Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
    }

    fn best(contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
        Ok(predict(contact, loads_n))
    }

    fn differences(curve: &JointCurve) -> Vec<f64> {
        curve.points.iter().map(|p| p.gains.force_difference.value).collect()
    }

    #[test]
    fn bare_silicone_follows_the_capstan() {
        let joints: Vec<f64> = (0..=9).map(|i| 10.0 * f64::from(i)).collect();
        let curve =
            over_joint(&part(PinPattern::default()), &JointPath::default(), &joints, 30.0, best).unwrap();
        let exponent = |p: &JointPoint| libm::asinh(p.gains.force_difference.value / 2.0);
        let mu = exponent(&curve.points[9]) / 90f64.to_radians();
        assert!((mu / published::MU_SILICONE - 1.0).abs() < 0.2);
        for point in &curve.points {
            assert!((exponent(point) - mu * point.joint_deg.to_radians()).abs() < 1e-9, "{point:?}");
        }
        assert_eq!(curve.status, PredictionStatus::Extrapolated);
    }

    /// A pin enters and leaves the wrap continuously.
    #[test]
    fn friction_is_continuous_over_the_joint() {
        let joints: Vec<f64> = (0..=360).map(|i| 0.25 * f64::from(i)).collect();
        for layout in &published::LAYOUTS {
            let contact = part(PinPattern::even(layout.pins, layout.pitch_rad()));
            let physics = |c: &Contact, n: &[f64]| predict_by(Law::Physics, c, n);
            let curve = over_joint(&contact, &JointPath::default(), &joints, 49.671, physics).unwrap();
            assert_eq!(curve.points.len(), joints.len(), "{:?}", curve.reasons);
            for pair in differences(&curve).windows(2) {
                assert!((pair[1] - pair[0]).abs() < 0.01, "{}: {pair:?}", layout.name);
            }
        }
    }

    #[test]
    fn measured_wrap_is_not_extrapolated() {
        let layout = &published::LAYOUTS[1];
        let contact = part(PinPattern::even(layout.pins, layout.pitch_rad()));
        let path = JointPath::new(13.89, 1.0).unwrap();
        assert!((path.measured_joint_deg().unwrap() - 50.0).abs() < 1e-9);
        let curve = over_joint(&contact, &path, &[50.0], 40.0, best).unwrap();
        let straight = finger(&predict(&contact, &[40.0]));
        let (a, b) = (curve.points[0].gains.force_difference, straight[0].force_difference);
        assert!((a.value - b.value).abs() < 1e-6 && (a.high - b.high).abs() < 1e-6, "{a:?} {b:?}");
        assert_ne!(curve.status, PredictionStatus::Extrapolated);
    }

    /// A wrap on one side of the segment has the pins of that side.
    #[test]
    fn pins_follow_the_middle_of_the_wrap() {
        struct OneSided;
        impl FlexionWrap for OneSided {
            fn wrap(&self, joint_deg: f64) -> Result<Wrap, JointPathError> {
                Ok(Wrap { wrap_deg: joint_deg, middle_deg: 32.0 - joint_deg / 2.0 })
            }

            fn measured_joint_deg(&self) -> Option<f64> {
                None
            }
        }
        let layout = &published::LAYOUTS[1];
        let contact = part(PinPattern::even(layout.pins, layout.pitch_rad()));
        let pins = |path: &dyn Fn(&[f64]) -> JointCurve, deg: f64| path(&[deg]).points[0].pins;
        let one = |deg: &[f64]| over_joint(&contact, &OneSided, deg, 40.0, best).unwrap();
        let two = |deg: &[f64]| over_joint(&contact, &JointPath::default(), deg, 40.0, best).unwrap();
        // Pins are at -17.9, 0 and 17.9 deg.
        assert_eq!([10.0, 20.0, 33.0, 51.0].map(|deg| pins(&one, deg)), [0, 1, 2, 3]);
        assert_eq!([10.0, 20.0, 33.0, 51.0].map(|deg| pins(&two, deg)), [1, 1, 1, 3]);
    }

    #[test]
    fn inapplicable_flexions_are_left_out() {
        let layout = &published::LAYOUTS[1];
        let contact = part(PinPattern::even(layout.pins, layout.pitch_rad()));
        let paper = |c: &Contact, n: &[f64]| predict_by(Law::Paper, c, n);
        let curve = over_joint(&contact, &JointPath::default(), &[10.0, 60.0], 40.0, paper).unwrap();
        assert_eq!(curve.points.len(), 1);
        assert!(curve.reasons.iter().any(|r| r.contains("1 flexion left out, the first at 10 deg")));
    }

    #[test]
    fn invalid_paths_are_refused() {
        for (path, word) in [
            (JointPath::new(-1.0, 1.0), "wrap at the straight finger (deg) = -1"),
            (JointPath::new(f64::NAN, 1.0), "NaN"),
            (JointPath::new(0.0, 3.0), "wrap per flexion = 3: must be from 0 to 2"),
        ] {
            assert!(path.unwrap_err().to_string().contains(word), "{path:?}");
        }
        assert!(JointPath::new(20.0, 0.0).unwrap().measured_joint_deg().is_none());
    }
}
