//! Forms of each effect in the twin: form 0 is that of the effect catalogue, the others are equally
//! plausible.
//!
//! The formulas are in the twin. For an effect without a formula there, such as a new or a
//! user-defined one, the twin uses the fitter's model of the effect.

/// Description of the form of an effect with one form.
const AS_CATALOGUED: &[&str] = &["as in model/doc/effect-catalogue.md"];

/// Forms of every effect with a formula in the twin.
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
    ("polygon_bending", &["mean turn per pin", "square of the mean turn", "turn of each pin"]),
    ("substrate_saturation", &["by its shape h", "(1 + F/F0)^-k", "1/sqrt(1 + 2 k F/F0)"]),
    ("adhesion", &["c S on a device", "c (1 - w) S on a device"]),
    ("dwell_relaxation", &["1 + k ln(dwell/3 s)", "(dwell/3 s)^k"]),
    ("run_in", &["exp(-(r-1)/r0) in each direction", "1/(1 + (r-1)/r0)", "r counts through both directions"]),
    ("wear_drift", &["by its shape t", "linear in the share of repetitions", "linear in the share of time"]),
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

/// Returns the descriptions of the forms of an effect.
pub(crate) fn forms_of(id: &str) -> &'static [&'static str] {
    FORMS.iter().find(|f| f.0 == id).map_or(AS_CATALOGUED, |f| f.1)
}

/// Whether the twin has a formula for an effect.
pub(crate) fn has_own_formula(id: &str) -> bool {
    FORMS.iter().any(|f| f.0 == id)
}
