//! Curves of the last designs, since a curve takes longer than any other step and most changes
//! leave the contact unchanged.

use pinswitch_calibration::ModelFile;
use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::Contact;
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::{Prediction, loads_n};

use crate::calibrated_curve::calibrated_curve;

/// Name in errors of a model that was dropped on the page.
pub(crate) const MODEL_NAME: &str = "the calibrated model";

/// Curves in the cache: the page alternates between a coarse and an exact one.
const CAPACITY: usize = 2;

/// The last predictions, the latest last.
#[derive(Debug, Default)]
pub(crate) struct PredictionCache {
    entries: Vec<Entry>,
    #[cfg(test)]
    misses: usize,
}

/// A prediction with everything that it depends on.
#[derive(Debug)]
struct Entry {
    contact: Contact,
    /// Pins and number of grooves, from which a calibrated model finds the grooves of its rig.
    layout: (Vec<usize>, usize),
    loads_n: Vec<f64>,
    model: Option<String>,
    prediction: Prediction,
}

impl PredictionCache {
    /// Returns the prediction of `design` by the published constants, or by the text of a
    /// calibrated model.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the model is invalid or does not cover the design.
    pub(crate) fn predict(&mut self, design: &Design, model: Option<&str>) -> Result<Prediction, Diagnostic> {
        let configuration = design.configuration();
        let layout = (configuration.layout.pins.clone(), configuration.segment.grooves);
        let loads_n = loads_n(design);
        let matches = |entry: &Entry| {
            entry.contact == *design.contact()
                && entry.layout == layout
                && entry.loads_n == loads_n
                && entry.model.as_deref() == model
        };
        if let Some(at) = self.entries.iter().position(matches) {
            let entry = self.entries.remove(at);
            let prediction = entry.prediction.clone();
            self.entries.push(entry);
            return Ok(prediction);
        }
        let prediction = match model {
            Some(text) => {
                let model = ModelFile::parse(text, MODEL_NAME)?;
                Prediction::with_curve(design, calibrated_curve(design, &model, MODEL_NAME)?)
            }
            None => Prediction::of(design),
        };
        #[cfg(test)]
        {
            self.misses += 1;
        }
        if self.entries.len() == CAPACITY {
            self.entries.remove(0);
        }
        self.entries.push(Entry {
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

    /// Each number of the configuration is changed a little.
    #[test]
    fn cached_curves_equal_new_curves() {
        let base = || {
            let mut c = Configuration::default();
            assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
            assign(&mut c, "friction.points=3").unwrap();
            c
        };
        let mut cache = PredictionCache::default();
        cache.predict(&Design::new(base()).unwrap(), None).unwrap();
        let (mut hits, mut misses) = (0, 0);
        for parameter in Configuration::PARAMETERS {
            let value = (parameter.get)(&base()).to_string();
            let Ok(number) = value.parse::<f64>() else { continue };
            for new in [format!("{:?}", number * 0.98), format!("{}", number as i64 + 1)] {
                let mut changed = base();
                if assign(&mut changed, &format!("{}={new}", parameter.path())).is_err() {
                    continue;
                }
                let Ok(design) = Design::new(changed) else { continue };
                let direct = Prediction::of(&design);
                let before = cache.misses;
                let cached = cache.predict(&design, None).unwrap();
                assert_eq!(cached.curve, direct.curve, "{} = {new}", parameter.path());
                assert_eq!(cached.others, direct.others, "{} = {new}", parameter.path());
                *(if before == cache.misses { &mut hits } else { &mut misses }) += 1;
            }
        }
        assert!(hits > 40 && misses > 10, "{hits} hits, {misses} misses");
    }

    /// A page requests coarse curves while a slider moves, then an exact one, then coarse ones
    /// again.
    #[test]
    fn coarse_and_exact_curves_share_the_cache() {
        let design = |points: u32, wall: &str| {
            let mut c = Configuration::default();
            assign(&mut c, &format!("friction.points={points}")).unwrap();
            assign(&mut c, &format!("shell.wall_mm={wall}")).unwrap();
            Design::new(c).unwrap()
        };
        let mut cache = PredictionCache::default();
        for wall in ["6.0", "6.5", "7.0"] {
            for points in [5, 11, 5] {
                let cached = cache.predict(&design(points, wall), None).unwrap();
                assert_eq!(cached.curve, Prediction::of(&design(points, wall)).curve);
            }
        }
        assert_eq!(cache.misses, 2);
        let mut pins = Configuration::default();
        assign(&mut pins, "layout.pins=[4, 10]").unwrap();
        assign(&mut pins, "friction.points=5").unwrap();
        let pins = Design::new(pins).unwrap();
        assert_eq!(cache.predict(&pins, None).unwrap().curve, Prediction::of(&pins).curve);
        assert_eq!((cache.misses, cache.entries.len()), (3, CAPACITY));
    }
}
