//! Clearance holes: the thread that fits a hole, and the tolerance of the hole (ISO 273).

/// Threads with their fine, medium and coarse clearance holes, mm (ISO 273).
const HOLES_MM: [(&str, [f64; 3]); 9] = [
    ("M1.6", [1.7, 1.8, 2.0]),
    ("M2", [2.2, 2.4, 2.6]),
    ("M2.5", [2.7, 2.9, 3.1]),
    ("M3", [3.2, 3.4, 3.6]),
    ("M4", [4.3, 4.5, 4.8]),
    ("M5", [5.3, 5.5, 5.8]),
    ("M6", [6.4, 6.6, 7.0]),
    ("M8", [8.4, 9.0, 10.0]),
    ("M10", [10.5, 11.0, 12.0]),
];
/// Tolerance of each series (ISO 273).
const GRADES: [&str; 3] = ["H12", "H13", "H14"];
/// Allowance for rounding errors in the diameter of a hole, mm.
const ROUNDING_MM: f64 = 1e-9;

/// The thread and the tolerance of a clearance hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Clearance {
    /// The largest thread that fits; `None` below M1.6.
    pub(crate) thread: Option<&'static str>,
    /// Tolerance of the diameter.
    pub(crate) grade: &'static str,
}

/// Returns the largest thread that fits a hole, and the tolerance of the hole.
pub(crate) fn clearance(hole_mm: f64) -> Clearance {
    let passes = |(_, series): &&(&str, [f64; 3])| series[0] <= hole_mm + ROUNDING_MM;
    let thread = HOLES_MM.iter().rev().find(passes).map(|(name, _)| *name);
    Clearance { thread, grade: clearance_grade(thread, hole_mm) }
}

/// Returns the tolerance of a hole for a thread: that of the widest series whose diameter it
/// reaches. A hole without a thread belongs to the medium series.
pub(crate) fn clearance_grade(thread: Option<&str>, hole_mm: f64) -> &'static str {
    let of_thread = HOLES_MM.iter().find(|(name, _)| Some(*name) == thread);
    let reached =
        of_thread.and_then(|(_, series)| series.iter().rposition(|least| *least <= hole_mm + ROUNDING_MM));
    reached.and_then(|i| GRADES.get(i)).copied().unwrap_or(GRADES[1])
}

#[cfg(test)]
mod tests {
    use super::super::fastening::CLEARANCE_HOLES_MM;
    use super::*;

    #[test]
    fn holes_have_the_tolerance_of_their_series() {
        let of = |mm: f64| (clearance(mm).thread.unwrap_or(""), clearance(mm).grade);
        assert_eq!([of(3.2), of(3.3), of(3.4), of(3.6)].map(|o| o.1), ["H12", "H12", "H13", "H14"]);
        assert_eq!([of(4.5), of(8.4), of(9.0), of(1.0)].map(|o| o.0), ["M4", "M8", "M8", ""]);
        assert_eq!((of(8.4).1, of(1.0).1), ("H12", "H13"));
        assert_eq!(clearance_grade(Some("M5"), 6.6), "H14");
    }

    /// The rules suggest the same holes for the screws of the shell.
    #[test]
    fn the_holes_of_rules_are_those_of_the_standard() {
        let ours: Vec<f64> = HOLES_MM.iter().flat_map(|(_, series)| *series).collect();
        assert_eq!(CLEARANCE_HOLES_MM, &ours[..CLEARANCE_HOLES_MM.len()]);
    }
}
