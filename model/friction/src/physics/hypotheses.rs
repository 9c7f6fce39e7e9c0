//! What the tendon does outside the pins: hypotheses against every fact that the paper prints.
//!
//! The wrap is 63.89 degrees, the pins span 24 to 60, and the paper does not say what the tendon does on the rest. Each
//! hypothesis gets the three constants that fit the seven maxima best, and is then asked about the facts that no
//! constant was fitted to.

use serde::Serialize;

use super::fit::{FitError, fit, published_maxima};
use super::{Bed, Constants, OutsidePins, PhysicsSwitch};
use crate::published::{self, LAYOUTS};
use crate::{Contact, PinPattern, Substrate};

/// Bending stiffness of the stiff tendon. The coating's tube alone, 1.2 to 1.7 mm of PA12 at 1.4 GPa, would have 430 N
/// mm² when perfectly bonded; strands that slip and a coating that creeps leave less. 120 puts the onset nearest to the
/// printed one.
pub(super) const STIFF_N_MM2: f64 = 120.0;
/// Root mean square error on the maxima beyond which a hypothesis falls.
const LARGEST_RMS: f64 = 0.04;
/// Silicone's share of friction at which a curve visibly leaves that of its pins.
const VISIBLE_SHARE: f64 = 0.02;
/// Share at which a device has begun to switch: where the thresholds are compared.
const BEGUN_SHARE: f64 = 0.10;
/// How much friction may differ from that of the pins alone and still count as the same.
const SAME: f64 = 0.05;

/// The angle over which the tendon turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Turned {
    /// 63.89 degrees with every layout.
    FullWrap,
    /// What the pins span.
    PinSpan,
}

/// A hypothesis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hypothesis {
    /// In words.
    pub name: &'static str,
    /// What carries the tendon.
    pub bed: Bed,
    /// Where it turns.
    pub turned: Turned,
}

/// What a hypothesis says of each fact.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HypothesisFinding {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// The constants that fit the seven maxima best.
    pub constants: Constants,
    /// Their root mean square relative error.
    pub rms: f64,
    /// Load at which three-double visibly leaves the curve of its pins, N; 15.31 was printed.
    pub onset_n: f64,
    /// Friction of three-double over that of its pins, less one, at the last weight below the onset.
    pub before_onset: f64,
    /// Friction of six-single over that of its pins, less one, at the middle weight.
    pub six_single_excess: f64,
    /// Load at which each layout begins to switch, N: six-single, three-double, three-single.
    pub begun_n: [f64; 3],
    /// The facts that it contradicts; empty for one that survives.
    pub contradicts: Vec<String>,
}

/// The hypotheses that are tested, the default of [`Bed::published`] among them.
pub fn hypotheses() -> Vec<Hypothesis> {
    let bed =
        |outside, softening, bending_n_mm2| Bed { outside, softening, bending_n_mm2, ..Bed::published() };
    let soft = Bed::published().softening;
    [
        ("on silicone over the whole wrap", bed(OutsidePins::OnSilicone, 0.0, 0.0)),
        ("on silicone, pins soften as they sink", bed(OutsidePins::OnSilicone, soft, 0.0)),
        ("on silicone, tendon stiff in bending (120 N mm2)", bed(OutsidePins::OnSilicone, 0.0, STIFF_N_MM2)),
        ("on silicone as far as the next groove", bed(OutsidePins::NextGroove, 0.0, 0.0)),
        ("free outside the pins", bed(OutsidePins::Free, 0.0, 0.0)),
        ("free, tendon stiff in bending (120 N mm2)", bed(OutsidePins::Free, 0.0, STIFF_N_MM2)),
        ("free, pins soften as they sink", bed(OutsidePins::Free, soft, 0.0)),
    ]
    .map(|(name, bed)| Hypothesis { name, bed, turned: Turned::FullWrap })
    .into_iter()
    .chain([Hypothesis {
        name: "the tendon turns over the pins' span only",
        bed: Bed::published(),
        turned: Turned::PinSpan,
    }])
    .collect()
}

impl Hypothesis {
    fn wrap_rad(&self, pins: &PinPattern) -> f64 {
        match (self.turned, pins.span_rad()) {
            (Turned::PinSpan, Some(span)) => span,
            _ => published::wrap_angle_rad(),
        }
    }

    fn switch(&self, layout: usize, substrate: Substrate, constants: Constants) -> Option<PhysicsSwitch> {
        let pins = PinPattern::even(LAYOUTS[layout].pins, LAYOUTS[layout].pitch_rad());
        let wrap = self.wrap_rad(&pins);
        let contact = Contact::new(substrate, pins, wrap).ok()?.with_bed(self.bed);
        Some(PhysicsSwitch::new(&contact, constants))
    }

    /// Fits the constants and asks about every fact.
    ///
    /// # Errors
    /// [`FitError`] if the hypothesis cannot be computed.
    pub fn test(&self) -> Result<HypothesisFinding, FitError> {
        let maxima = published_maxima(|pins| self.wrap_rad(pins));
        let fitted = fit(&self.bed, &maxima.iter().collect::<Vec<_>>())?;
        let constants = fitted.constants;
        let weights = published::WEIGHTS_G.map(published::load_n);
        let reaches = |layout: usize, share: f64| -> Result<f64, FitError> {
            let Some(switch) = self.switch(layout, Substrate::Silicone, constants) else {
                return Ok(f64::INFINITY);
            };
            let loads: Vec<f64> = (1..=320).map(|i| 0.25 * f64::from(i)).collect();
            let states = switch.states(&loads)?;
            Ok(states.iter().find(|s| s.silicone_share >= share).map_or(f64::INFINITY, |s| s.load_n))
        };
        let excess = |layout: usize, load: f64| -> Result<f64, FitError> {
            let of = |substrate| {
                self.switch(layout, substrate, constants).map_or(Ok(f64::NAN), |s| s.friction_n(load))
            };
            Ok(of(Substrate::Silicone)? / of(Substrate::Abs)? - 1.0)
        };
        let before = weights.iter().copied().rev().find(|w| *w < published::THREE_DOUBLE_ONSET_N);
        let mut finding = HypothesisFinding {
            hypothesis: *self,
            constants,
            rms: fitted.rms,
            onset_n: reaches(1, VISIBLE_SHARE)?,
            before_onset: excess(1, before.unwrap_or(weights[0]))?,
            six_single_excess: excess(0, weights[weights.len() / 2])?,
            begun_n: [reaches(0, BEGUN_SHARE)?, reaches(1, BEGUN_SHARE)?, reaches(2, BEGUN_SHARE)?],
            contradicts: Vec::new(),
        };
        finding.contradicts = finding.judge(&weights);
        Ok(finding)
    }
}

impl HypothesisFinding {
    /// The facts against it.
    fn judge(&self, weights_n: &[f64]) -> Vec<String> {
        let onset = published::THREE_DOUBLE_ONSET_N;
        // The onset is one of the weights: it is known to half the distance to its neighbours.
        let below = weights_n.iter().copied().filter(|w| *w < onset).fold(0.0, f64::max);
        let at = weights_n.iter().copied().filter(|w| *w >= onset).fold(f64::INFINITY, f64::min);
        let above = weights_n.iter().copied().filter(|w| *w > at).fold(f64::INFINITY, f64::min);
        let [six, double, single] = self.begun_n;
        let facts = [
            (self.rms <= LARGEST_RMS, format!("the seven maxima (RMS {:.1} %)", 100.0 * self.rms)),
            (
                self.onset_n > (below + at) / 2.0 && self.onset_n < (at + above) / 2.0,
                format!("the onset of three-double at {onset} N (here {:.1} N)", self.onset_n),
            ),
            (
                self.before_onset.abs() <= SAME,
                format!("pins only before the onset (here {:+.0} %)", 100.0 * self.before_onset),
            ),
            (
                self.six_single_excess.abs() <= SAME,
                format!(
                    "six-single alike with and without silicone (here {:+.0} %)",
                    100.0 * self.six_single_excess
                ),
            ),
            (
                double < single && single < six,
                format!(
                    "the order of thresholds, double < single < six (here {double:.1}, {single:.1}, {six:.1} N)"
                ),
            ),
        ];
        facts.into_iter().filter(|(holds, _)| !holds).map(|(_, fact)| fact).collect()
    }

    /// Whether no fact contradicts it.
    pub fn survives(&self) -> bool {
        self.contradicts.is_empty()
    }
}
