//! The Pareto front of layouts in threshold and friction.

use pinswitch_friction::sort_by_number;

use super::TargetRegion;

/// Layouts that no other layout exceeds in both properties.
pub(super) struct ParetoFront {
    /// Threshold and friction in newtons, by ascending threshold.
    pub(super) points: Vec<(f64, f64)>,
    /// The preferred directions, for a legend.
    pub(super) label: String,
}

/// The preferred direction of a target interval: more (1) without an upper end, less (-1) without a
/// lower end.
fn direction((low, high): (f64, f64)) -> Option<f64> {
    match (low > 0.0, high.is_finite()) {
        (true, false) => Some(1.0),
        (false, true) => Some(-1.0),
        _ => None,
    }
}

/// Returns the front of `points` (threshold, friction) for a target region; `None` if the region
/// prefers no direction in one of them.
pub(super) fn pareto_front(points: &[(f64, f64)], region: TargetRegion) -> Option<ParetoFront> {
    let (higher, more) = (direction(region.threshold_n)?, direction(region.friction_n)?);
    let mut by_threshold = points.to_vec();
    sort_by_number(&mut by_threshold, |p| -more * p.1);
    sort_by_number(&mut by_threshold, |p| -higher * p.0);
    let mut best = f64::NEG_INFINITY;
    by_threshold.retain(|p| {
        let is_better = more * p.1 > best;
        best = best.max(more * p.1);
        is_better
    });
    if higher > 0.0 {
        by_threshold.reverse();
    }
    let label = format!(
        "{} threshold, {} friction",
        if higher > 0.0 { "higher" } else { "lower" },
        if more > 0.0 { "more" } else { "less" }
    );
    Some(ParetoFront { points: by_threshold, label })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_follows_the_target_region() {
        const OPEN: f64 = f64::INFINITY;
        let points = [(10.0, 5.0), (20.0, 4.0), (15.0, 3.0), (25.0, 6.0)];
        let of = |threshold_n, friction_n| pareto_front(&points, TargetRegion { threshold_n, friction_n });
        let higher_and_less = of((20.0, OPEN), (0.0, 8.0)).unwrap();
        assert_eq!(higher_and_less.points, [(15.0, 3.0), (20.0, 4.0), (25.0, 6.0)]);
        assert_eq!(higher_and_less.label, "higher threshold, less friction");
        assert_eq!(of((20.0, OPEN), (8.0, OPEN)).unwrap().points, [(25.0, 6.0)]);
        assert_eq!(of((0.0, 20.0), (0.0, 8.0)).unwrap().points, [(10.0, 5.0), (15.0, 3.0)]);
        assert!(of((18.0, 22.0), (0.0, 8.0)).is_none(), "a threshold between two bounds");
        assert!(of((0.0, OPEN), (0.0, 8.0)).is_none());
    }
}
