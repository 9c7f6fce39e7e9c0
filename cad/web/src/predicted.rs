//! The curve of the last design, kept: most changes of a design leave its contact as it is, and the curve takes longer than
//! any other step.

use pinswitch_calibration::ModelFile;
use pinswitch_friction::Contact;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::{Prediction, loads_n};

use crate::calibrated_curve::calibrated_curve;
use crate::trouble::Trouble;

/// What a model dropped on the page is called in errors.
const MODEL: &str = "the calibrated model";

/// A prediction with all that it was made from.
#[derive(Debug)]
pub(crate) struct Predicted {
    contact: Contact,
    /// A calibrated model looks for the grooves of the rig that it was measured on.
    layout: (Vec<usize>, usize),
    loads_n: Vec<f64>,
    model: Option<String>,
    prediction: Prediction,
}

impl Predicted {
    /// The prediction of `design`, by the published constants or by a calibrated model: the kept one, if it was made from
    /// the same.
    pub(crate) fn of(
        kept: &mut Option<Self>,
        design: &Design,
        model: Option<&str>,
    ) -> Result<Prediction, Trouble> {
        let configuration = design.configuration();
        let layout = (configuration.layout.pins.clone(), configuration.segment.grooves);
        let loads_n = loads_n(design);
        if let Some(kept) = kept.as_ref().filter(|kept| {
            kept.contact == *design.contact()
                && kept.layout == layout
                && kept.loads_n == loads_n
                && kept.model.as_deref() == model
        }) {
            return Ok(kept.prediction.clone());
        }
        let prediction = match model {
            Some(text) => {
                let model = ModelFile::parse(text, MODEL).map_err(Trouble::general)?;
                let curve = calibrated_curve(design, &model, MODEL).map_err(Trouble::general)?;
                Prediction::with_curve(design, curve)
            }
            None => Prediction::of(design),
        };
        *kept = Some(Self {
            contact: design.contact().clone(),
            layout,
            loads_n,
            model: model.map(str::to_owned),
            prediction: prediction.clone(),
        });
        Ok(prediction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::{Configuration, assign};

    /// Of every number of the configuration, changed a little, the kept curve is the one that would be made anew.
    #[test]
    fn what_is_kept_is_what_would_be_made_anew() {
        let base = || {
            let mut c = Configuration::default();
            assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
            assign(&mut c, "friction.points=3").unwrap();
            c
        };
        let mut kept = None;
        Predicted::of(&mut kept, &Design::new(base()).unwrap(), None).unwrap();
        let (mut same, mut other) = (0, 0);
        for parameter in Configuration::PARAMETERS {
            let value = (parameter.get)(&base()).to_string();
            let Ok(number) = value.parse::<f64>() else { continue };
            for new in [format!("{:?}", number * 0.98), format!("{}", number as i64 + 1)] {
                let mut changed = base();
                if assign(&mut changed, &format!("{}={new}", parameter.path())).is_err() {
                    continue;
                }
                let Ok(design) = Design::new(changed) else { continue };
                let fresh = Prediction::of(&design);
                let before = kept.as_ref().map(|k| k.prediction.curve.clone());
                let told = Predicted::of(&mut kept, &design, None).unwrap();
                assert_eq!(told.curve, fresh.curve, "{} = {new}", parameter.path());
                assert_eq!(told.others, fresh.others, "{} = {new}", parameter.path());
                *(if before.as_ref() == Some(&told.curve) { &mut same } else { &mut other }) += 1;
            }
        }
        assert!(same > 40 && other > 10, "{same} left the curve as it was, {other} did not");
    }
}
