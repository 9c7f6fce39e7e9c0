//! Sizes drawn in the study and tried by `power`.

/// Range of an effect's size and shape: typical values of effects.md, and whether the sign is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Id of the effect.
    pub id: &'static str,
    /// Smallest and largest size.
    pub size: (f64, f64),
    /// Either sign.
    pub signed: bool,
    /// Ranges of the shape constants.
    pub shapes: &'static [(f64, f64)],
}

const fn strength(id: &'static str, least: f64, most: f64, signed: bool) -> Strength {
    Strength { id, size: (least, most), signed, shapes: &[] }
}

/// Sizes drawn in the study: the upper part of the typical sizes of effects.md, log-uniform.
static STRENGTHS: [Strength; 21] = [
    Strength { shapes: &[(1.0, 2.0)], ..strength("coating_stiffening", 0.3, 1.2, false) },
    strength("coating_ploughing", 0.012, 0.03, false),
    strength("polygon_bending", 0.3, 1.5, false),
    Strength { shapes: &[(0.0, 1.0)], ..strength("substrate_saturation", 0.12, 0.33, false) },
    strength("adhesion", 0.2, 0.6, false),
    strength("dwell_relaxation", 0.04, 0.12, true),
    Strength { shapes: &[(1.5, 6.0), (1.0, 1.0)], ..strength("run_in", 0.05, 0.4, false) },
    Strength { shapes: &[(0.2, 3.0)], ..strength("wear_drift", 0.08, 0.25, true) },
    strength("rate_dependence", 0.15, 0.5, false),
    strength("fixture_compliance", 0.06, 0.25, false),
    strength("stroke_position", 0.05, 0.2, true),
    strength("direction_asymmetry", 0.05, 0.2, true),
    strength("switching_hysteresis", 3.0, 10.0, false),
    strength("guide_drag", 0.1, 0.5, false),
    strength("load_cell_offset", 0.2, 1.5, true),
    strength("load_cell_gain", 0.01, 0.06, true),
    strength("load_cell_nonlinearity", 0.3, 1.5, true),
    strength("load_cell_saturation", 46.0, 58.0, false),
    strength("thermal_drift", 0.3, 1.5, true),
    Strength { size: (0.0, 0.0), ..strength("hook_omitted", 0.0, 0.0, false) },
    Strength { size: (0.0, 0.0), ..strength("switch_local_tension", 0.0, 0.0, false) },
];

/// Sizes of all effects.
pub(crate) fn strengths() -> &'static [Strength] {
    &STRENGTHS
}
