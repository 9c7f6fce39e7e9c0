//! Belief in a calibrated switch: the curve of `model.toml` with its band and covariance, carried to other dimensions by
//! the physics.

use std::path::Path;
use std::sync::Mutex;

use pinswitch_calibration::ModelFile;
use pinswitch_friction::physics::Bed;
use pinswitch_friction::{Contact, FrictionCurve, PinPattern, Substrate, Trust, published};

use crate::Failure;
use pinswitch_switch::design_search::{Belief, Curve, Part, PublishedPhysics};

/// How much of a change that the physics makes may be wrong, as a standard deviation: assumed, since no calibration has
/// yet measured a change of dimensions.
const CHANGE_SD: f64 = 0.5;
/// Curves of the physics that are kept: one part is asked for many times, with other constants.
const KEPT: usize = 24;

/// A calibrated switch.
pub(super) struct CalibratedSwitch {
    file: ModelFile,
    name: String,
    physics: PublishedPhysics,
    recent: Mutex<Vec<(Contact, Curve)>>,
}

impl CalibratedSwitch {
    /// Reads `model.toml`.
    ///
    /// # Errors
    /// [`Failure::BadInput`] names file and fault.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let text = crate::input::read_text_file(path)?;
        let file = ModelFile::parse(&text, &name).map_err(Failure::bad_input)?;
        Ok(Self { file, name, physics: PublishedPhysics::default(), recent: Mutex::default() })
    }

    /// The curve of the physics, remembered.
    fn physics(&self, part: &Part, loads_n: &[f64]) -> Option<Curve> {
        let known = |recent: &Vec<(Contact, Curve)>| {
            let same =
                |(contact, curve): &&(Contact, Curve)| *contact == part.contact && curve.load_n == loads_n;
            recent.iter().find(same).map(|(_, curve)| curve.clone())
        };
        if let Some(curve) = self.recent.lock().ok().and_then(|recent| known(&recent)) {
            return Some(curve);
        }
        let curve = self.physics.curve(part, loads_n, &[0.0; 3])?;
        if let Ok(mut recent) = self.recent.lock() {
            if recent.len() >= KEPT {
                recent.remove(0);
            }
            recent.push((part.contact.clone(), curve.clone()));
        }
        Some(curve)
    }

    /// The physics of `part` against the same pins on the rig that was calibrated: logarithms of friction, and differences of
    /// the share's log-odds. `None` if the rig has no such grooves.
    fn change(&self, part: &Part, loads_n: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let angles = part.pins.iter().map(|pin| groove_rad(*pin)).collect::<Option<Vec<f64>>>()?;
        let contact =
            Contact::new(Substrate::Silicone, PinPattern::new(angles), published::wrap_angle_rad()).ok()?;
        let on_rig = Part { pins: part.pins.clone(), contact: contact.with_bed(Bed::published()) };
        if same_contact(&on_rig.contact, &part.contact) {
            return Some((vec![0.0; loads_n.len()], vec![0.0; loads_n.len()]));
        }
        let (there, rig) = (self.physics(part, loads_n)?, self.physics(&on_rig, loads_n)?);
        let friction = there.friction_n.iter().zip(&rig.friction_n).map(|(a, b)| (a / b).ln()).collect();
        let share = there
            .silicone_share
            .iter()
            .zip(&rig.silicone_share)
            .map(|(a, b)| log_odds(*a) - log_odds(*b))
            .collect();
        Some((friction, share))
    }
}

/// Angle of a groove of the rig.
fn groove_rad(groove: usize) -> Option<f64> {
    let middle = (published::GROOVES as f64 + 1.0) / 2.0;
    (1..=published::GROOVES)
        .contains(&groove)
        .then(|| (groove as f64 - middle) * published::GROOVE_PITCH_DEG.to_radians())
}

fn same_contact(a: &Contact, b: &Contact) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    a.bed() == b.bed()
        && near(a.wrap_rad(), b.wrap_rad())
        && a.pins().count() == b.pins().count()
        && a.pins().angles_rad().iter().zip(b.pins().angles_rad()).all(|(a, b)| near(*a, *b))
}

fn log_odds(share: f64) -> f64 {
    let share = share.clamp(1e-6, 1.0 - 1e-6);
    (share / (1.0 - share)).ln()
}

impl Belief for CalibratedSwitch {
    fn constants(&self) -> usize {
        self.file.constants_drawn()
    }

    fn curve(&self, part: &Part, loads_n: &[f64], z: &[f64]) -> Option<Curve> {
        let (friction, share) = self.change(part, loads_n)?;
        let (rig_n, rig_share) =
            self.file.drawn_part(Substrate::Silicone, &part.pins, loads_n, z, &self.name).ok()?;
        Some(Curve {
            load_n: loads_n.to_vec(),
            friction_n: rig_n.iter().zip(&friction).map(|(d, by)| d.max(1e-6) * by.exp()).collect(),
            silicone_share: rig_share
                .iter()
                .zip(&share)
                .map(|(s, by)| 1.0 / (1.0 + (-(log_odds(*s) + by)).exp()))
                .collect(),
        })
    }

    fn banded(&self, part: &Part, loads_n: &[f64]) -> Option<FrictionCurve> {
        let (friction, _) = self.change(part, loads_n)?;
        let mut curve = self.file.part_curve(Substrate::Silicone, &part.pins, loads_n, &self.name).ok()?;
        let here = self.curve(part, loads_n, &vec![0.0; self.constants()])?;
        for (i, by) in friction.iter().enumerate() {
            let own = |edge: f64, d: f64| (edge.max(1e-6) / d.max(1e-6)).ln().abs();
            let change = 1.96 * CHANGE_SD * by.abs();
            let down = own(curve.band_low_n[i], curve.friction_n[i]).hypot(change);
            let up = own(curve.band_high_n[i], curve.friction_n[i]).hypot(change);
            curve.band_low_n[i] = here.friction_n[i] * (-down).exp();
            curve.band_high_n[i] = here.friction_n[i] * up.exp();
        }
        if friction.iter().any(|by| *by != 0.0) {
            curve.trust = Trust::Extrapolated;
        }
        curve.friction_n = here.friction_n;
        curve.silicone_share = here.silicone_share;
        Some(curve)
    }
}
