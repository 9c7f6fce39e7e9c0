//! Numbers printed in the paper (Dermitzakis & Carbajal, arXiv:1401.5232), and those of human
//! fingers for comparison.

use crate::substrate::Substrate;

/// Standard gravity in m/s², which converts the published masses into loads.
pub const GRAVITY_M_S2: f64 = 9.80665;
/// Mass of the hook that carries the weights, in grams; it is part of the load
/// (`model/doc/friction-laws.md`).
pub const HOOK_MASS_G: f64 = 62.53;
/// Eleven weights in grams, without the hook.
pub const WEIGHTS_G: [f64; 11] =
    [251.2, 503.6, 1003.2, 1503.9, 2005.0, 2505.4, 3007.2, 3508.6, 4007.8, 4504.5, 5002.5];
/// Wrap angle of the tendon in every experiment, in degrees.
pub const WRAP_ANGLE_DEG: f64 = 63.89;
/// Pause after each move and before each reading, in seconds.
pub const DWELL_S: f64 = 3.0;
/// Stroke of the actuator in millimetres.
pub const STROKE_MM: f64 = 152.4;
/// Ploughing coefficient `kappa` of the coating in N^-0.5, `x = kappa sqrt(T) sum theta_i^1.5`:
/// fitted to the three maxima of pins alone (`model/doc/friction-laws.md`).
pub const PLOUGHING_KAPPA: f64 = 0.0237;
/// Angle of the grooved segment in degrees.
pub const SEGMENT_DEG: f64 = 89.45;
/// Grooves on the segment.
pub const GROOVES: usize = 15;
/// Angle between neighbouring grooves in degrees.
pub const GROOVE_PITCH_DEG: f64 = SEGMENT_DEG / GROOVES as f64;
/// Friction coefficient of the coated tendon on polished pins (fit of the paper).
pub const MU_PINS: f64 = 0.05;
/// Friction coefficient of the coated tendon on the silicone (fit of the paper).
pub const MU_SILICONE: f64 = 0.24;
/// Load in newtons at which the friction of three-double first exceeds that of its pins.
pub const THREE_DOUBLE_ONSET_N: f64 = 15.31;
/// Largest friction measured on silicone without pins, in newtons.
pub const SILICONE_ALONE_MAX_N: f64 = 12.97;

/// Post-eccentric minus post-concentric force of the human finger, as a fraction of its output
/// force: 9 to 12 % at high load (the paper's abstract). Comparable with
/// [`crate::finger::FingerPoint::force_difference`].
pub const HUMAN_FORCE_DIFFERENCE: (f64, f64) = (0.09, 0.12);
/// Flexion of the human middle joint at its largest force difference, in degrees (Schweizer et al.,
/// J. Biomech. 42, 2009, 1856-1861: six cadaver fingers, 40 N on each flexor tendon).
pub const HUMAN_PEAK_JOINT_DEG: f64 = 83.0;
/// Mean force difference at that flexion, a fraction (same source).
pub const HUMAN_PEAK_DIFFERENCE: f64 = 0.11;

/// Published layout with its constants of eq. 4 and its measured maxima.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedLayout {
    /// Name in the paper.
    pub name: &'static str,
    /// Number of pins.
    pub pins: usize,
    /// Pitch of the pins in grooves (1: every groove has a pin).
    pub step: usize,
    /// Occupied grooves, numbered from 1, centred on the segment.
    pub grooves: &'static [usize],
    /// Weight `w` of eq. 4, dimensionless.
    pub weight: f64,
    /// Threshold `F_thr` on the scale of `F_r`.
    pub threshold: f64,
    /// Interval of `F_r` onto which the tested loads are mapped.
    pub reduced_load: (f64, f64),
    /// Largest friction of the device (pins in silicone), in newtons.
    pub device_max_n: f64,
    /// Largest friction of the pins alone (on the rigid proxy), in newtons.
    pub pins_max_n: f64,
}

/// The three layouts of the paper. `six-single` has the printed `F_thr = 5.7`
/// (`model/doc/friction-laws.md`).
pub const LAYOUTS: [PublishedLayout; 3] = [
    PublishedLayout {
        name: "six-single",
        pins: 6,
        step: 2,
        grooves: &[3, 5, 7, 9, 11, 13],
        weight: 0.2,
        threshold: 5.7,
        reduced_load: (-2.0, 3.5),
        device_max_n: 5.097,
        pins_max_n: 3.935,
    },
    PublishedLayout {
        name: "three-double",
        pins: 3,
        step: 3,
        grooves: &[5, 8, 11],
        weight: 0.1,
        threshold: 4.3,
        reduced_load: (0.0, 5.5),
        device_max_n: 9.667,
        pins_max_n: 5.829,
    },
    PublishedLayout {
        name: "three-single",
        pins: 3,
        step: 2,
        grooves: &[6, 8, 10],
        weight: 0.1,
        threshold: 4.3,
        reduced_load: (0.0, 4.9),
        device_max_n: 8.495,
        pins_max_n: 5.893,
    },
];

impl PublishedLayout {
    /// Returns the centre-to-centre pitch of the pins in radians.
    pub fn pitch_rad(&self) -> f64 {
        self.step as f64 * GROOVE_PITCH_DEG.to_radians()
    }

    /// Returns the measured maximum on `substrate`, in newtons.
    pub fn max_n(&self, substrate: Substrate) -> f64 {
        match substrate {
            Substrate::Silicone => self.device_max_n,
            Substrate::Abs => self.pins_max_n,
        }
    }
}

/// Returns [`WRAP_ANGLE_DEG`] in radians.
pub fn wrap_angle_rad() -> f64 {
    WRAP_ANGLE_DEG.to_radians()
}

/// Returns the load in newtons of a weight of `mass_g` grams with the hook.
pub fn load_n(mass_g: f64) -> f64 {
    (mass_g + HOOK_MASS_G) * 1e-3 * GRAVITY_M_S2
}

/// Returns the lightest load of the paper's experiment in newtons (3.077).
pub fn lightest_load_n() -> f64 {
    load_n(WEIGHTS_G[0])
}

/// Returns the heaviest load of the paper's experiment in newtons (49.671).
pub fn heaviest_load_n() -> f64 {
    load_n(WEIGHTS_G[WEIGHTS_G.len() - 1])
}
