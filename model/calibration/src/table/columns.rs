//! The columns of a plateau table.

/// The columns a table must have, in the order in which they are written.
pub(super) const COLUMNS: [&str; 13] = [
    "series",
    "substrate",
    "pins",
    "sweep",
    "load_mass_g",
    "load_N",
    "speed_pct",
    "dwell_s",
    "direction",
    "repetition",
    "position_mm",
    "time_s",
    "force_N",
];

/// Optional: the wrap angle in degrees, where a rig has another one than the paper's.
pub(super) const WRAP_ANGLE: &str = "wrap_angle_deg";

/// Optional: groupings with a scatter of their own.
pub(super) const LABELS: [&str; 4] = ["session", "mount", "operator", "specimen"];

/// Name of a column by its place: those of [`COLUMNS`], then the optional one.
pub(super) fn column_name(index: usize) -> &'static str {
    COLUMNS.get(index).copied().unwrap_or(WRAP_ANGLE)
}
