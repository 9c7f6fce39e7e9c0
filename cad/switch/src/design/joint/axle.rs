//! The bolt that is the axle of a joint, with its nut and washers.

/// Lengths of hexagon bolts with a shank, mm (ISO 4014). [`AxleBolt::lengths_mm`] limits those of
/// each thread.
const LENGTHS_MM: [f64; 13] = [25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 90.0];
/// Allowance for rounding errors in a length, mm.
const ROUNDING_MM: f64 = 1e-9;
/// Largest difference of equal diameters, mm.
const SAME_MM: f64 = 1e-6;

/// Diameters of the axle, mm.
pub(crate) const AXLES_MM: &[f64] = &[4.0, 5.0, 6.0, 8.0];

/// A hexagon bolt with a shank, which bears the distal link, and its hardware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleBolt {
    /// Name of the thread, such as `M5`.
    pub name: &'static str,
    /// Diameter of the shank, mm.
    pub diameter_mm: f64,
    /// Head: width across flats and height (ISO 4014), mm.
    pub head_mm: [f64; 2],
    /// Height of a self-locking nut (ISO 7040), mm. Its width is that of the head.
    pub nut_mm: f64,
    /// Washer: inner and outer diameter, and thickness (ISO 7089), mm.
    pub washer_mm: [f64; 3],
    /// Length of the thread (ISO 4014), mm.
    pub thread_mm: f64,
    /// Shortest and longest bolt (ISO 4014), mm.
    lengths_mm: [f64; 2],
}

/// Bolts, by ascending diameter.
const BOLTS: [AxleBolt; 4] = [
    bolt(("M4", 4.0), [7.0, 2.8], 6.0, [4.3, 9.0, 0.8], 14.0, [25.0, 40.0]),
    bolt(("M5", 5.0), [8.0, 3.5], 6.8, [5.3, 10.0, 1.0], 16.0, [25.0, 50.0]),
    bolt(("M6", 6.0), [10.0, 4.0], 8.0, [6.4, 12.0, 1.6], 18.0, [30.0, 60.0]),
    bolt(("M8", 8.0), [13.0, 5.3], 9.5, [8.4, 16.0, 1.6], 22.0, [40.0, 80.0]),
];

const fn bolt(
    (name, diameter_mm): (&'static str, f64),
    head_mm: [f64; 2],
    nut_mm: f64,
    washer_mm: [f64; 3],
    thread_mm: f64,
    lengths_mm: [f64; 2],
) -> AxleBolt {
    AxleBolt { name, diameter_mm, head_mm, nut_mm, washer_mm, thread_mm, lengths_mm }
}

impl AxleBolt {
    /// Returns the bolt whose diameter is nearest to `diameter_mm`.
    pub(super) fn nearest_to(diameter_mm: f64) -> Self {
        let far = |bolt: &Self| (bolt.diameter_mm - diameter_mm).abs();
        BOLTS.into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(BOLTS[1])
    }

    /// Returns whether `diameter_mm` is the diameter of this bolt.
    pub(crate) fn has_diameter(&self, diameter_mm: f64) -> bool {
        (self.diameter_mm - diameter_mm).abs() < SAME_MM
    }

    /// Returns the shortest available bolt of at least `least_mm`.
    pub(super) fn at_least_mm(&self, least_mm: f64) -> Option<f64> {
        let [low, high] = self.lengths_mm;
        let is_sold = |length: &f64| (low..=high).contains(length) && *length >= least_mm - ROUNDING_MM;
        LENGTHS_MM.into_iter().find(is_sold)
    }
}
