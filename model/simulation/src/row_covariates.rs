//! Covariates of one row.

/// Covariates of a row that an effect can depend on, in addition to load and contact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowCovariates {
    /// -1 eccentric, +1 concentric.
    pub(crate) sign: f64,
    /// Whether the sweep descends.
    pub(crate) down: bool,
    /// Speed in percent.
    pub(crate) speed_pct: f64,
    /// Geometric mean of the session's speeds in percent.
    pub(crate) mean_speed_pct: f64,
    /// Pause before the reading in seconds.
    pub(crate) dwell_s: f64,
    /// Repetition within series and direction, from 1.
    pub(crate) repetition: f64,
    /// Repetition within the series, counted through both directions, from 1.
    pub(crate) series_repetition: f64,
    /// Position, as a share of the stroke.
    pub(crate) stroke_share: f64,
    /// Time, as a share of the session.
    pub(crate) time_share: f64,
    /// Repetitions before this one, as a share of the session's repetitions.
    pub(crate) travel_share: f64,
    /// Decrease of the load from the previous series, as a share of the session's highest load.
    pub(crate) step_down: f64,
    /// Operator: 1 or 2.
    pub(crate) operator: u32,
    /// Factor of this tendon seating and mount on all friction.
    pub(crate) seating: f64,
}
