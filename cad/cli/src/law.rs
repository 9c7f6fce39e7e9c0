//! `--law`: which law makes the curve.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use pinswitch_friction::{Contact, FrictionCurve, Law, LawError, predict, predict_by};

use super::Failure;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::Prediction;

/// The law behind the curve.
#[derive(Args, Clone, Debug)]
pub(super) struct LawChoice {
    /// Law of the curve [default: physics, for every configuration].
    #[arg(long, value_parser = laws())]
    law: Option<String>,
}

/// The laws that predict from a layout alone, by name.
fn laws() -> PossibleValuesParser {
    let values = Law::predictive().map(|law| PossibleValue::new(law.as_str()).help(law.summary()));
    PossibleValuesParser::new(values)
}

impl LawChoice {
    /// This choice, or the law of the set that is made again. A set by a calibrated model tells that its model is needed.
    pub(super) fn or_of_set(&self, law: Option<&str>) -> Self {
        let of_set = law.and_then(Law::named).filter(|_| self.law.is_none());
        match of_set {
            Some(Law::Calibrated) => {
                log::warn!(
                    "the curve of that set came from a calibrated model: give it with --model to make the same set; here it comes from the {} law",
                    Law::DEFAULT.as_str()
                );
                self.clone()
            }
            Some(law) => Self { law: Some(law.as_str().to_owned()) },
            None => self.clone(),
        }
    }

    /// The prediction of `design` by the chosen law.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the law does not apply to the layout.
    pub(super) fn prediction(&self, design: &Design) -> Result<Prediction, Failure> {
        match self.law.as_deref().and_then(Law::named) {
            None => Ok(Prediction::of(design)),
            Some(law) => Prediction::by(law, design)
                .map_err(|e| Failure::bad_input(format!("--law {}: {e}", law.as_str()))),
        }
    }

    /// The curve of any contact by the chosen law.
    ///
    /// # Errors
    /// [`LawError`] if the law does not apply to the contact.
    pub(super) fn curve(&self, contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
        match self.law.as_deref().and_then(Law::named) {
            None => Ok(predict(contact, loads_n)),
            Some(law) => predict_by(law, contact, loads_n),
        }
    }
}

/// The chosen law and the others at the heaviest load: `paper 10.01 N; others: layout 10.29, physics 8.92`.
pub(super) fn side_by_side(curve: &FrictionCurve, others: &[FrictionCurve]) -> String {
    let last = |c: &FrictionCurve| c.friction_n.last().copied().unwrap_or_default();
    let load = curve.load_n.last().copied().unwrap_or_default();
    let beside: Vec<_> = others.iter().map(|c| format!("{} {:.2} N", c.law.as_str(), last(c))).collect();
    let tail = if beside.is_empty() { String::new() } else { format!(" ({})", beside.join(", ")) };
    format!("law {}: {:.2} N of friction at {load:.2} N of load{tail}", curve.law.as_str(), last(curve))
}
