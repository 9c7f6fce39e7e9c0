//! A calibrated model as the belief of a design search.

use std::sync::Mutex;

use pinswitch_calibration::ModelFile;
use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::{Contact, FrictionCurve, Substrate, Transfer};
use pinswitch_switch::design_search::{Belief, Curve, LoadState, Part};

use crate::calibrated_curve::rig_contact;

/// Transfers in the cache: a search evaluates one part many times, with other constants.
const MAX_RECENT: usize = 24;

/// The curves of a `model.toml` with band and covariance, transferred to other dimensions by the
/// physics as in `generate --model`.
#[derive(Debug)]
pub struct CalibratedSwitch {
    file: ModelFile,
    name: String,
    /// Transfers from the rig to a contact at these loads (N), the latest last.
    recent: Mutex<Vec<(Contact, Vec<f64>, Transfer)>>,
}

impl CalibratedSwitch {
    /// Creates the belief of a model; `name` is the model's name in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the model was fitted to a table without pins, or without silicone.
    pub fn new(file: ModelFile, name: String) -> Result<Self, Diagnostic> {
        file.check_materials(Substrate::Silicone, true, &name)?;
        Ok(Self { file, name, recent: Mutex::default() })
    }

    /// Returns the transfer from the same grooves of the rig to `part`, from the cache if it is
    /// there.
    fn transfer(&self, part: &Part, loads_n: &[f64]) -> Option<Transfer> {
        let cached = |recent: &Vec<(Contact, Vec<f64>, Transfer)>| {
            recent
                .iter()
                .find(|(c, l, _)| *c == part.contact && l == loads_n)
                .map(|(_, _, transfer)| transfer.clone())
        };
        if let Some(transfer) = self.recent.lock().ok().and_then(|recent| cached(&recent)) {
            return Some(transfer);
        }
        let rig = rig_contact(&part.contact, &part.pins).ok()?;
        let transfer = Transfer::between(&rig, &part.contact, loads_n).ok()?;
        if let Ok(mut recent) = self.recent.lock() {
            if recent.len() >= MAX_RECENT {
                recent.remove(0);
            }
            recent.push((part.contact.clone(), loads_n.to_vec(), transfer.clone()));
        }
        Some(transfer)
    }
}

impl Belief for CalibratedSwitch {
    fn constants(&self) -> usize {
        self.file.constants_drawn()
    }

    fn curve<'a>(&'a self, part: &Part, loads_n: &'a [f64], z: &[f64]) -> Option<Curve<'a>> {
        let transfer = self.transfer(part, loads_n)?;
        let (rig_n, rig_share) =
            self.file.drawn_part(Substrate::Silicone, &part.pins, loads_n, z, &self.name).ok()?;
        let (friction_n, silicone_share) = transfer.friction_and_share(loads_n, &rig_n, &rig_share);
        Some(Curve::new(loads_n, move |i| {
            Some(LoadState { friction_n: friction_n[i].max(1e-6), silicone_share: silicone_share[i] })
        }))
    }

    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve> {
        let curve = self.file.part_curve(Substrate::Silicone, &part.pins, loads_n, &self.name).ok()?;
        Some(self.transfer(part, loads_n)?.apply(curve))
    }
}
