//! Hypotheses about the tendon's path outside the pins, weighted by the facts that the paper
//! prints.
//!
//! The wrap is 63.89 degrees, the pins span 24 to 60 degrees, and the paper does not describe the
//! rest. Each hypothesis has the three constants that fit the seven maxima best, and is compared
//! with each fact, relative to the scatter of the fact. A fact that set a constant of a hypothesis
//! is not used to test it. The paper does not give the radius either: the likelihoods are averaged
//! over possible radii.

use schemars::JsonSchema;
use serde::Serialize;

use super::constants::Constants;
use super::fit::{FitError, fit, published_maxima};
use super::switch::PhysicsSwitch;
use crate::bed::{Bed, OutsidePins};
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::published::{self, LAYOUTS};
use crate::substrate::Substrate;

/// Relative scatter of the maxima about a fit.
const MAXIMA_SCATTER: f64 = 0.05;
/// Standard deviation of the printed onset, N: the weights are about 5 N apart.
const ONSET_SD_N: f64 = 1.4;
/// Relative standard deviation of a statement that two curves are equal.
const SAME_SD: f64 = 0.05;
/// Standard deviation of the logarithm of [`ORDER_RATIO`]: by eq. 4 three-double begins to switch
/// at 8.5 N, and the paper prints 15.31 N, a factor of 1.8 for each layout.
const ORDER_SD: f64 = 0.85;
/// Ratio of the loads at which three-single and three-double begin to switch, by eq. 4 with half
/// loads of 44.0 and 39.5 N.
const ORDER_RATIO: f64 = 44.0 / 39.5;
/// Silicone's share of friction at which a curve visibly deviates from that of its pins.
const VISIBLE_SHARE: f64 = 0.02;
/// Silicone's share of friction at which a device has begun to switch.
const BEGUN_SHARE: f64 = 0.10;
/// Possible radii of the silicone's surface, mm.
const RADII_MM: [f64; 3] = [18.0, 22.0, 26.0];
/// Heaviest load and step of the search for the begin of switching, N.
const SEARCH_N: (f64, f64) = (80.0, 0.5);

/// Angle over which the tendon turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TurnAngle {
    /// The wrap angle, 63.89 degrees with every layout.
    FullWrap,
    /// The angle from the first to the last pin.
    PinSpan,
}

/// Hypothesis about the path of the tendon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Hypothesis {
    /// Description.
    pub name: &'static str,
    /// Support of the tendon.
    pub bed: Bed,
    /// Angle over which the tendon turns.
    #[serde(rename = "turned")]
    pub turn_angle: TurnAngle,
    /// Whether the onset of three-double set one of its constants; it is then not tested by the
    /// onset.
    pub set_by_onset: bool,
}

/// Comparison of a hypothesis with a fact.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FactComparison {
    /// Fact.
    pub fact: &'static str,
    /// Value of the hypothesis, as text.
    pub here: String,
    /// Squared deviation over squared scatter: 1 is usual, 9 is a deviation of three standard
    /// deviations. For the maxima, the sum over them.
    pub chi_squared: f64,
}

/// Result of the test of a hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HypothesisFinding {
    /// Hypothesis.
    pub hypothesis: Hypothesis,
    /// Constants that fit the seven maxima best, with the radius of the published bed.
    pub constants: Constants,
    /// Root mean square relative error of the maxima.
    pub rms: f64,
    /// Comparison with every fact that can test it, with that radius.
    pub compared: Vec<FactComparison>,
    /// Natural logarithm of the likelihood, averaged over the possible radii.
    pub log_likelihood: f64,
}

/// Returns the hypotheses, that of [`Bed::published`] first.
pub fn hypotheses() -> Vec<Hypothesis> {
    let bed =
        |outside, softening, bending_n_mm2| Bed { outside, softening, bending_n_mm2, ..Bed::published() };
    let Bed { softening: soft, bending_n_mm2: stiff, .. } = Bed::published();
    let (on, next, free) = (OutsidePins::OnSilicone, OutsidePins::NextGroove, OutsidePins::Free);
    [
        ("on silicone over the whole wrap, tendon stiff in bending", bed(on, soft, stiff), true),
        ("on silicone, a string", bed(on, soft, 0.0), false),
        ("on silicone as far as the next groove, a string", bed(next, soft, 0.0), false),
        ("free outside the pins, a string", bed(free, soft, 0.0), true),
        ("free outside the pins, tendon stiff in bending", bed(free, 0.0, stiff), false),
    ]
    .map(|(name, bed, set_by_onset)| Hypothesis { name, bed, turn_angle: TurnAngle::FullWrap, set_by_onset })
    .into_iter()
    .chain([Hypothesis {
        name: "the tendon turns over the pins' span only",
        bed: Bed::published(),
        turn_angle: TurnAngle::PinSpan,
        set_by_onset: false,
    }])
    .collect()
}

/// Test of a hypothesis at one radius.
struct AtRadius {
    constants: Constants,
    rms: f64,
    compared: Vec<FactComparison>,
}

impl Hypothesis {
    /// Returns the angle in radians over which the tendon turns with these pins.
    fn wrap_rad(&self, pins: &PinPattern) -> f64 {
        match (self.turn_angle, pins.span_rad()) {
            (TurnAngle::PinSpan, Some(span)) => span,
            _ => published::wrap_angle_rad(),
        }
    }

    /// Returns the switch of a published layout.
    fn switch(&self, layout: usize, substrate: Substrate, constants: Constants) -> Option<PhysicsSwitch> {
        let pins = PinPattern::even(LAYOUTS[layout].pins, LAYOUTS[layout].pitch_rad());
        let wrap = self.wrap_rad(&pins);
        let contact = Contact::new(substrate, pins, wrap).ok()?.with_bed(self.bed);
        Some(PhysicsSwitch::new(&contact, constants))
    }

    /// Fits the constants and compares the hypothesis with every fact, at each radius.
    ///
    /// # Errors
    /// [`FitError`] if the model does not converge.
    pub fn test(&self) -> Result<HypothesisFinding, FitError> {
        let here = self.at_radius()?;
        let mut likelihoods = Vec::with_capacity(RADII_MM.len());
        for contact_radius_mm in RADII_MM {
            let other = Self { bed: Bed { contact_radius_mm, ..self.bed }, ..*self };
            let chi_squared: f64 = other.at_radius()?.compared.iter().map(|c| c.chi_squared).sum();
            likelihoods.push(libm::exp(-chi_squared / 2.0));
        }
        let mean = likelihoods.iter().sum::<f64>() / likelihoods.len() as f64;
        Ok(HypothesisFinding {
            hypothesis: *self,
            constants: here.constants,
            rms: here.rms,
            compared: here.compared,
            log_likelihood: libm::log(mean.max(f64::MIN_POSITIVE)),
        })
    }

    /// Tests the hypothesis at the radius of its bed.
    fn at_radius(&self) -> Result<AtRadius, FitError> {
        let maxima = published_maxima(|pins| self.wrap_rad(pins));
        let fitted = fit(&self.bed, &maxima.iter().collect::<Vec<_>>())?;
        let constants = fitted.constants;
        let reaches = |layout: usize, share: f64| -> Result<f64, FitError> {
            let Some(switch) = self.switch(layout, Substrate::Silicone, constants) else {
                return Ok(f64::INFINITY);
            };
            let (most, step) = SEARCH_N;
            let loads: Vec<f64> = (1..=(most / step) as usize).map(|i| step * i as f64).collect();
            let states = switch.states(&loads)?;
            let Some(above) = states.iter().position(|s| s.silicone_share >= share) else { return Ok(most) };
            let Some(below) = above.checked_sub(1) else { return Ok(loads[0]) };
            let (from, to) = (states[below].silicone_share, states[above].silicone_share);
            Ok(loads[below] + step * (share - from) / (to - from))
        };
        let excess = |layout: usize, load: f64| -> Result<f64, FitError> {
            let of = |substrate| {
                self.switch(layout, substrate, constants).map_or(Ok(f64::NAN), |s| s.friction_n(load))
            };
            Ok(of(Substrate::Silicone)? / of(Substrate::Abs)? - 1.0)
        };
        let weights = published::WEIGHTS_G.map(published::load_n);
        let onset = published::THREE_DOUBLE_ONSET_N;
        let before = weights.iter().copied().rev().find(|w| *w < onset).unwrap_or(weights[0]);
        let mut compared = vec![FactComparison {
            fact: "the seven maxima",
            here: format!("RMS {:.1} %", 100.0 * fitted.rms),
            chi_squared: fitted.errors.iter().map(|(_, e)| (e / MAXIMA_SCATTER).powi(2)).sum(),
        }];
        let mut fact = |fact: &'static str, here: String, deviation: f64| {
            compared.push(FactComparison { fact, here, chi_squared: deviation.powi(2) });
        };
        if !self.set_by_onset {
            let here = reaches(1, VISIBLE_SHARE)?;
            fact("the onset of three-double at 15.31 N", format!("{here:.1} N"), (here - onset) / ONSET_SD_N);
        }
        let double = excess(1, before)?;
        fact("three-double on its pins only before the onset", percent(double), double / SAME_SD);
        let six = excess(0, weights[weights.len() / 2])?;
        fact("six-single equal with and without silicone", percent(six), six / SAME_SD);
        let (double, single) = (reaches(1, BEGUN_SHARE)?, reaches(2, BEGUN_SHARE)?);
        fact(
            "three-single begins to switch after three-double",
            format!("{single:.1} N after {double:.1} N"),
            (libm::log(single / double) - libm::log(ORDER_RATIO)) / ORDER_SD,
        );
        Ok(AtRadius { constants, rms: fitted.rms, compared })
    }
}

fn percent(share: f64) -> String {
    format!("{:+.0} %", 100.0 * share)
}

/// Returns the posterior probability of each hypothesis, with equal prior probabilities.
pub fn weights(findings: &[HypothesisFinding]) -> Vec<f64> {
    let best = findings.iter().map(|f| f.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
    let raw: Vec<f64> = findings.iter().map(|f| libm::exp(f.log_likelihood - best)).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}
