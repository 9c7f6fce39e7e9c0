//! The curves of the last design, kept: most changes of a design leave its contact as it is, and a curve takes longer than
//! any other step. There are two of them, since a page asks for a coarse curve while something moves, and for all of it after.

use pinswitch_calibration::ModelFile;
use pinswitch_friction::Contact;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::{Prediction, loads_n};

use crate::calibrated_curve::calibrated_curve;
use crate::trouble::Trouble;

/// What a model dropped on the page is called in errors.
pub(crate) const MODEL: &str = "the calibrated model";

/// Curves that are kept.
const KEPT: usize = 2;

/// The last predictions, the latest one last.
#[derive(Debug, Default)]
pub(crate) struct Predictions {
    kept: Vec<Predicted>,
    #[cfg(test)]
    made: usize,
}

/// A prediction with all that it was made from.
#[derive(Debug)]
struct Predicted {
    contact: Contact,
    /// A calibrated model looks for the grooves of the rig that it was measured on.
    layout: (Vec<usize>, usize),
    loads_n: Vec<f64>,
    model: Option<String>,
    prediction: Prediction,
}

impl Predictions {
    /// The prediction of `design`, by the published constants or by a calibrated model: a kept one, if it was made from
    /// the same.
    pub(crate) fn of(&mut self, design: &Design, model: Option<&str>) -> Result<Prediction, Trouble> {
        let configuration = design.configuration();
        let layout = (configuration.layout.pins.clone(), configuration.segment.grooves);
        let loads_n = loads_n(design);
        let is_same = |kept: &Predicted| {
            kept.contact == *design.contact()
                && kept.layout == layout
                && kept.loads_n == loads_n
                && kept.model.as_deref() == model
        };
        if let Some(at) = self.kept.iter().position(is_same) {
            let kept = self.kept.remove(at);
            let prediction = kept.prediction.clone();
            self.kept.push(kept);
            return Ok(prediction);
        }
        let prediction = match model {
            Some(text) => {
                let model = ModelFile::parse(text, MODEL).map_err(Trouble::general)?;
                let curve = calibrated_curve(design, &model, MODEL).map_err(Trouble::general)?;
                Prediction::with_curve(design, curve)
            }
            None => Prediction::of(design),
        };
        #[cfg(test)]
        {
            self.made += 1;
        }
        if self.kept.len() == KEPT {
            self.kept.remove(0);
        }
        self.kept.push(Predicted {
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
        let mut kept = Predictions::default();
        kept.of(&Design::new(base()).unwrap(), None).unwrap();
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
                let before = kept.made;
                let told = kept.of(&design, None).unwrap();
                assert_eq!(told.curve, fresh.curve, "{} = {new}", parameter.path());
                assert_eq!(told.others, fresh.others, "{} = {new}", parameter.path());
                *(if before == kept.made { &mut same } else { &mut other }) += 1;
            }
        }
        assert!(same > 40 && other > 10, "{same} took a kept curve, {other} were made");
    }

    /// As a page asks: coarse while something moves, exact after, and coarse again.
    #[test]
    fn coarse_and_exact_curves_do_not_drive_each_other_out() {
        let design = |points: u32, wall: &str| {
            let mut c = Configuration::default();
            assign(&mut c, &format!("friction.points={points}")).unwrap();
            assign(&mut c, &format!("shell.wall_mm={wall}")).unwrap();
            Design::new(c).unwrap()
        };
        let mut kept = Predictions::default();
        for wall in ["6.0", "6.5", "7.0"] {
            for points in [5, 11, 5] {
                let told = kept.of(&design(points, wall), None).unwrap();
                assert_eq!(told.curve, Prediction::of(&design(points, wall)).curve);
            }
        }
        assert_eq!(kept.made, 2);
        let mut pins = Configuration::default();
        assign(&mut pins, "layout.pins=[4, 10]").unwrap();
        assign(&mut pins, "friction.points=5").unwrap();
        let pins = Design::new(pins).unwrap();
        assert_eq!(kept.of(&pins, None).unwrap().curve, Prediction::of(&pins).curve);
        assert_eq!((kept.made, kept.kept.len()), (3, KEPT));
    }
}
