//! `--law`: the friction law that makes the curve.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{Contact, FrictionCurve, Law, LawError, predict, predict_by};
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::Prediction;

use super::Failure;
use super::terminal::warn;

/// The friction law of the curve.
#[derive(Args, Clone, Debug)]
pub(super) struct LawChoice {
    /// Friction law of the curve [default: physics, for every configuration].
    #[arg(long, value_parser = laws())]
    law: Option<String>,
}

/// Lists the laws that predict from a layout alone, by name.
fn laws() -> PossibleValuesParser {
    let values = Law::predictive().map(|law| PossibleValue::new(law.as_str()).help(law.summary()));
    PossibleValuesParser::new(values)
}

impl LawChoice {
    /// Returns this choice, or else the law of the set that is generated again. Warns if that set used a calibrated
    /// model, which only `--model` can give.
    pub(super) fn or_of_set(&self, law: Option<&str>) -> Self {
        let of_set = law.and_then(Law::named).filter(|_| self.law.is_none());
        match of_set {
            Some(Law::Calibrated) => {
                let default = Law::DEFAULT.as_str();
                warn(
                    Diagnostic::new(codes::MODEL_BEYOND_RIG, format!(
                        "the curve of that set came from a calibrated model; this curve comes from the {default} law"
                    ))
                    .with_help("give the model with --model to generate the same set"),
                );
                self.clone()
            }
            Some(law) => Self { law: Some(law.as_str().to_owned()) },
            None => self.clone(),
        }
    }

    /// Returns the name of the law, unless the default applies.
    pub(super) fn name(&self) -> Option<&str> {
        self.law.as_deref()
    }

    /// Whether the law holds at the wrap angle of its layouts only.
    pub(super) fn is_of_one_wrap(&self) -> bool {
        self.law.as_deref().and_then(Law::named) == Some(Law::Paper)
    }

    /// Predicts the friction of `design` with the chosen law.
    ///
    /// # Errors
    /// [`Failure::bad_input`] if the law does not apply to the layout.
    pub(super) fn prediction(&self, design: &Design) -> Result<Prediction, Failure> {
        match self.law.as_deref().and_then(Law::named) {
            None => Ok(Prediction::of(design)),
            Some(law) => Prediction::by(law, design).map_err(|e| {
                let location = Location::field("--law", law.as_str());
                Failure::bad_input(Diagnostic::from(e).with_location(location))
            }),
        }
    }

    /// Predicts the curve of any contact with the chosen law, at loads in N.
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

/// Compares the laws at the heaviest load: `law paper: 10.01 N of friction at 49.67 N of load (layout 10.29 N)`.
pub(super) fn compare_laws(curve: &FrictionCurve, others: &[FrictionCurve]) -> String {
    let last = |c: &FrictionCurve| c.friction_n.last().copied().unwrap_or_default();
    let load = curve.load_n.last().copied().unwrap_or_default();
    let others: Vec<_> = others.iter().map(|c| format!("{} {:.2} N", c.law.as_str(), last(c))).collect();
    let others = if others.is_empty() { String::new() } else { format!(" ({})", others.join(", ")) };
    format!("law {}: {:.2} N of friction at {load:.2} N of load{others}", curve.law.as_str(), last(curve))
}
