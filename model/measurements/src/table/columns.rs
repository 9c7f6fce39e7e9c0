//! The columns of a plateau table.

/// Required columns, in the order in which they are written.
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

/// Optional column: wrap angle in degrees where it differs from the paper's.
pub(super) const WRAP_ANGLE: &str = "wrap_angle_deg";

/// Optional columns: groupings of the rows for random effects.
pub(super) const LABELS: [&str; 4] = ["session", "mount", "operator", "specimen"];

/// Returns the name of a column by its index: those of [`COLUMNS`], then [`WRAP_ANGLE`].
pub(super) fn column_name(index: usize) -> &'static str {
    COLUMNS.get(index).copied().unwrap_or(WRAP_ANGLE)
}

/// Returns the unit of a numeric column of a plateau table, `1` for a pure number; `None` for a column of texts, and for any
/// other column.
pub fn column_unit(name: &str) -> Option<&'static str> {
    match name {
        "load_mass_g" => Some("g"),
        "load_N" | "force_N" => Some("N"),
        "speed_pct" => Some("%"),
        "dwell_s" | "time_s" => Some("s"),
        "repetition" => Some("1"),
        "position_mm" => Some("mm"),
        WRAP_ANGLE => Some("deg"),
        _ => None,
    }
}
