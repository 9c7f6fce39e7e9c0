//! Shared predictions: many variants have the same contact and loads.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use quick_cache::sync::Cache;

use pinswitch_friction::{Contact, FrictionCurve};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::FileEntry;
use pinswitch_switch::formats::curve_files;
use pinswitch_switch::output::{OutputFile, SetError};
use pinswitch_switch::prediction::{PredictedCurve, Prediction};

/// Predictions in the cache, about 15 kB each with their table.
const CACHED_PREDICTIONS: usize = 64;

/// The inputs of a prediction: the contact and the loads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PredictionKey {
    contact: Contact,
    loads_n: [f64; 2],
    points: usize,
}

impl PredictionKey {
    pub(super) fn from_design(design: &Design) -> Self {
        let f = &design.configuration().friction;
        let loads_n = [f.load_min_n, f.load_max_n];
        Self { contact: design.contact().clone(), loads_n, points: f.points }
    }
}

// All numbers of a contact are finite, so that every key equals itself.
impl Eq for PredictionKey {}

impl Hash for PredictionKey {
    /// Hashes the quantities that sweeps vary most; equality compares all of them.
    fn hash<H: Hasher>(&self, state: &mut H) {
        let bed = self.contact.bed();
        let numbers = [bed.contact_radius_mm, bed.layer_mm, bed.layer_width_mm, bed.modulus_mpa];
        let all = numbers.iter().chain(&self.loads_n).chain(self.contact.pins().angles_rad());
        all.for_each(|x| x.to_bits().hash(state));
    }
}

/// The prediction for every design with one key; each step is computed on first use.
#[derive(Default)]
pub(super) struct CachedPrediction {
    curve: OnceLock<PredictedCurve>,
    shared: OnceLock<SharedCurve>,
}

/// The curve that manifests and folders of all variants with one key contain.
pub(super) struct SharedCurve {
    /// The curve with those of the other laws.
    pub prediction: Prediction,
    /// The curve as a table.
    pub files: Vec<(OutputFile, FileEntry)>,
}

impl CachedPrediction {
    /// Returns the curve; `design` has the key of this prediction.
    pub(super) fn curve(&self, design: &Design) -> &FrictionCurve {
        &self.predicted(design).curve
    }

    fn predicted(&self, design: &Design) -> &PredictedCurve {
        self.curve.get_or_init(|| PredictedCurve::of(design))
    }

    /// Returns the curve with its table; `design` has the key of this prediction.
    ///
    /// # Errors
    /// [`SetError`] if the table cannot be encoded.
    pub(super) fn shared(&self, design: &Design) -> Result<&SharedCurve, SetError> {
        if let Some(cached) = self.shared.get() {
            return Ok(cached);
        }
        let prediction = Prediction::of_curve(design, self.predicted(design));
        let files = curve_files(design, &prediction, false)?;
        let with_entry = |file: OutputFile| {
            let entry = FileEntry::of(&file);
            (file, entry)
        };
        let files = files.into_iter().map(with_entry).collect();
        Ok(self.shared.get_or_init(|| SharedCurve { prediction, files }))
    }
}

/// Predictions by their inputs.
pub(super) struct PredictionCache(Cache<PredictionKey, Arc<CachedPrediction>>);

impl Default for PredictionCache {
    fn default() -> Self {
        Self(Cache::new(CACHED_PREDICTIONS))
    }
}

impl PredictionCache {
    /// Returns the prediction of `design`, still to be computed if it is the first with its key.
    pub(super) fn get(&self, design: &Design) -> Arc<CachedPrediction> {
        let key = PredictionKey::from_design(design);
        self.0.get(&key).unwrap_or_else(|| {
            let new = Arc::new(CachedPrediction::default());
            self.0.insert(key, new.clone());
            new
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::{Configuration, assign};
    use pinswitch_switch::prediction::predicted_curve;

    #[test]
    fn equal_contacts_share_a_prediction() {
        let design = |assignments: &[&str]| {
            let mut c = Configuration::default();
            assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
            Design::new(c).unwrap()
        };
        let cache = PredictionCache::default();
        let base = cache.get(&design(&["layout.pins=[5, 8, 11]"]));
        let is_shared = |other: &str| {
            let design = design(&["layout.pins=[5, 8, 11]", other]);
            let prediction = cache.get(&design);
            assert_eq!(
                prediction.shared(&design).unwrap().prediction.curve,
                predicted_curve(&design),
                "{other}"
            );
            Arc::ptr_eq(&base, &prediction)
        };
        assert!(is_shared("tendon.length_mm=250") && is_shared("shell.wall_mm=5.5"));
        for other in [
            "layout.pins=[3, 8]",
            "shell.outer_radius_mm=21",
            "silicone.hardness_shore_a=20",
            "pins.diameter_mm=0.9",
            "friction.load_max_n=80",
            "friction.points=51",
            "friction.six_single_threshold=4",
        ] {
            assert!(!is_shared(other), "{other}");
        }
    }
}
