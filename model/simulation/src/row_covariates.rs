//! Covariates of one row.

/// What an effect may depend on in one row, beside the load and the contact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowCovariates {
    /// -1 eccentric, +1 concentric.
    pub(crate) sign: f64,
    /// Whether loads descend.
    pub(crate) down: bool,
    /// Speed in percent.
    pub(crate) speed_pct: f64,
    /// Geometric mean of the session's speeds in percent.
    pub(crate) mean_speed_pct: f64,
    /// Pause before the reading in seconds.
    pub(crate) dwell_s: f64,
    /// Repetition inside series and direction, from 1.
    pub(crate) repetition: f64,
    /// Repetition inside the series, both directions counted, from 1.
    pub(crate) series_repetition: f64,
    /// Share of the stroke, 0..1.
    pub(crate) stroke_share: f64,
    /// Share of the session's time, 0..1.
    pub(crate) time_share: f64,
    /// Share of the session's repetitions made before, 0..1.
    pub(crate) travel_share: f64,
    /// The step down from the load of the series before, as a share of the session's highest load.
    pub(crate) step_down: f64,
    /// Who measures: 1 or 2.
    pub(crate) operator: u32,
    /// Factor on all friction that this seating of the tendon has.
    pub(crate) seating: f64,
}
