//! Predictions that variants share: many variants differ in nothing that the tendon feels.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use quick_cache::sync::Cache;

use pinswitch_friction::{Contact, FrictionCurve};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::FileEntry;
use pinswitch_switch::formats::curve_files;
use pinswitch_switch::output::{OutputFile, SetError};
use pinswitch_switch::prediction::{Prediction, predicted_curve};

/// Forecasts kept in the cache, about 15 kB each with their table.
const CACHED_FORECASTS: usize = 64;

/// All that a prediction depends on: the contact and the loads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ForecastKey {
    contact: Contact,
    loads_n: [f64; 2],
    points: usize,
}

impl ForecastKey {
    pub(super) fn of(design: &Design) -> Self {
        let f = &design.configuration().friction;
        let loads_n = [f.load_min_n, f.load_max_n];
        Self { contact: design.contact().clone(), loads_n, points: f.points }
    }
}

// A contact holds no number that is not finite, so that every key equals itself.
impl Eq for ForecastKey {}

impl Hash for ForecastKey {
    /// What sweeps vary most; equality looks at all of it.
    fn hash<H: Hasher>(&self, state: &mut H) {
        let bed = self.contact.bed();
        let numbers = [bed.contact_radius_mm, bed.layer_mm, bed.layer_width_mm, bed.modulus_mpa];
        let all = numbers.iter().chain(&self.loads_n).chain(self.contact.pins().angles_rad());
        all.for_each(|x| x.to_bits().hash(state));
    }
}

/// The prediction for every design with one key, each step made when it is first asked for.
#[derive(Default)]
pub(super) struct Forecast {
    curve: OnceLock<FrictionCurve>,
    shared: OnceLock<SharedCurve>,
}

/// What manifests and folders of variants with one forecast hold alike.
pub(super) struct SharedCurve {
    /// The curve with the other laws beside it.
    pub prediction: Prediction,
    /// The curve as a table.
    pub files: Vec<(OutputFile, FileEntry)>,
}

impl Forecast {
    /// The curve; `design` is one of those with this forecast's key.
    pub(super) fn curve(&self, design: &Design) -> &FrictionCurve {
        self.curve.get_or_init(|| predicted_curve(design))
    }

    /// The curve with all that follows from it; `design` is one of those with this forecast's key.
    ///
    /// # Errors
    /// [`SetError`] if the table cannot be made.
    pub(super) fn shared(&self, design: &Design) -> Result<&SharedCurve, SetError> {
        if let Some(known) = self.shared.get() {
            return Ok(known);
        }
        let prediction = Prediction::with_curve(design, self.curve(design).clone());
        let files = curve_files(design, &prediction, false)?;
        let with_entry = |file: OutputFile| {
            let entry = FileEntry::of(&file);
            (file, entry)
        };
        let files = files.into_iter().map(with_entry).collect();
        Ok(self.shared.get_or_init(|| SharedCurve { prediction, files }))
    }
}

/// Forecasts by what they depend on.
pub(super) struct Forecasts(Cache<ForecastKey, Arc<Forecast>>);

impl Default for Forecasts {
    fn default() -> Self {
        Self(Cache::new(CACHED_FORECASTS))
    }
}

impl Forecasts {
    /// The forecast of `design`, not yet made if it is the first with its key.
    pub(super) fn of(&self, design: &Design) -> Arc<Forecast> {
        let key = ForecastKey::of(design);
        self.0.get(&key).unwrap_or_else(|| {
            let new = Arc::new(Forecast::default());
            self.0.insert(key, new.clone());
            new
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::{Configuration, assign};

    #[test]
    fn equal_contacts_share_a_forecast_and_only_they() {
        let design = |assignments: &[&str]| {
            let mut c = Configuration::default();
            assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
            Design::new(c).unwrap()
        };
        let forecasts = Forecasts::default();
        let base = forecasts.of(&design(&["layout.pins=[5, 8, 11]"]));
        let alike = |other: &str| {
            let design = design(&["layout.pins=[5, 8, 11]", other]);
            let found = forecasts.of(&design);
            assert_eq!(found.shared(&design).unwrap().prediction.curve, predicted_curve(&design), "{other}");
            Arc::ptr_eq(&base, &found)
        };
        assert!(alike("tendon.length_mm=250") && alike("shell.wall_mm=5.5"));
        for other in [
            "layout.pins=[3, 8]",
            "shell.outer_radius_mm=21",
            "silicone.hardness_shore_a=20",
            "pins.diameter_mm=0.9",
            "friction.load_max_n=80",
            "friction.points=51",
            "friction.six_single_threshold=4",
        ] {
            assert!(!alike(other), "{other}");
        }
    }
}
