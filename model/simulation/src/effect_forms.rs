//! The forms in which the twin has each effect: the first is that of the effect catalogue, the others are as plausible.
//!
//! Their formulas stand in the twin. An effect of the catalogue that is not listed here has no formula in the twin,
//! which then adds the fitter's own trace of it: a new effect can be simulated before it has a second formula.

/// The form of an effect that the twin has in one form only.
const AS_CATALOGUED: &[&str] = &["as in model/doc/effect-catalogue.md"];

/// Forms by effect, of every effect that the twin has a formula for.
pub(crate) const FORMS: [(&str, &[&str]); 21] = [
    (
        "coating_stiffening",
        &[
            "mu_p (1 + k (F/F0)^m)",
            "(F/F0)^m replaced by (1 - exp(-F/F0))/(1 - exp(-1))",
            "F replaced by the mean of F and T",
        ],
    ),
    (
        "coating_ploughing",
        &[
            "kappa sqrt(F) sum theta^1.5",
            "pin by pin with the tension at each pin",
            "F^0.45 and theta^1.45 of equal size at F0 and 0.3 rad",
        ],
    ),
    ("polygon_bending", &["mean turn per pin", "the square of it", "each pin by its own turn"]),
    ("substrate_saturation", &["as its shape h says", "(1 + F/F0)^-k", "1/sqrt(1 + 2 k F/F0)"]),
    ("adhesion", &["c S on a device", "c (1 - w) S on a device"]),
    ("dwell_relaxation", &["1 + k ln(dwell/3 s)", "(dwell/3 s)^k"]),
    ("run_in", &["exp(-(r-1)/r0) in each direction", "1/(1 + (r-1)/r0)", "r counts through both directions"]),
    (
        "wear_drift",
        &["as its shape t says", "linear in the share of repetitions", "linear in the share of time"],
    ),
    ("rate_dependence", &["1 + k ln(v/v0)", "(v/v0)^k"]),
    ("switching_hysteresis", &["down - H", "up + H/2, down - H/2"]),
    (
        "switch_local_tension",
        &["S of the mean tension", "S of the mean of F and T", "mean of S over the wrap"],
    ),
    ("direction_asymmetry", &["x (1 +- k/2)", "x exp(+-k/2)"]),
    ("fixture_compliance", &["F/F0", "the mean of F and T over F0", "(F/F0)^0.8"]),
    ("stroke_position", &["s - 1/2", "sin(pi (s - 1/2))/2"]),
    ("load_cell_nonlinearity", &["square", "power 2.25"]),
    ("load_cell_saturation", &["a corner", "a knee 0.5 N wide"]),
    ("guide_drag", AS_CATALOGUED),
    ("load_cell_offset", AS_CATALOGUED),
    ("load_cell_gain", AS_CATALOGUED),
    ("thermal_drift", AS_CATALOGUED),
    ("hook_omitted", AS_CATALOGUED),
];

/// Descriptions of the forms of an effect.
pub(crate) fn forms_of(id: &str) -> &'static [&'static str] {
    FORMS.iter().find(|f| f.0 == id).map_or(AS_CATALOGUED, |f| f.1)
}

/// Whether the twin has a formula of its own for an effect.
pub(crate) fn has_own_formula(id: &str) -> bool {
    FORMS.iter().any(|f| f.0 == id)
}
