//! Complete curves without bands, and thresholds.

/// Friction and share of the silicone at ascending loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Loads, N, ascending.
    pub load_n: Vec<f64>,
    /// Friction, N.
    pub friction_n: Vec<f64>,
    /// Share of the friction that silicone carries.
    pub silicone_share: Vec<f64>,
}

/// The threshold of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switching {
    /// Load at which silicone carries half of the friction, N. If no load reaches this share, an
    /// extrapolated load that is monotonic in the share at the end of the curve.
    pub threshold_n: f64,
    /// Whether the threshold is within the loads of the curve.
    pub is_found: bool,
    /// Index of the first load at or above the threshold; the number of loads if there is none.
    pub next: usize,
}
