//! The points that no other beats in what an ask wants of both axes.

use pinswitch_friction::sort_by_number;

use super::AskedRegion;

/// A front and what it is.
pub(super) struct Front {
    /// Its points, by ascending threshold.
    pub(super) points: Vec<(f64, f64)>,
    /// What no point does better, for a legend.
    pub(super) words: String,
}

/// Which way an interval pulls: to more if it has no upper end, to less if it has no lower one.
fn pull((low, high): (f64, f64)) -> Option<f64> {
    match (low > 0.0, high.is_finite()) {
        (true, false) => Some(1.0),
        (false, true) => Some(-1.0),
        _ => None,
    }
}

/// The front of `points` (threshold, friction) for `asked`; none if the ask pulls one of both neither way.
pub(super) fn front(points: &[(f64, f64)], asked: AskedRegion) -> Option<Front> {
    let (later, more) = (pull(asked.threshold_n)?, pull(asked.friction_n)?);
    let mut by_threshold = points.to_vec();
    sort_by_number(&mut by_threshold, |p| -more * p.1);
    sort_by_number(&mut by_threshold, |p| -later * p.0);
    let mut best = f64::NEG_INFINITY;
    by_threshold.retain(|p| {
        let leads = more * p.1 > best;
        best = best.max(more * p.1);
        leads
    });
    if later > 0.0 {
        by_threshold.reverse();
    }
    let words = format!(
        "none {} that rubs {}",
        if later > 0.0 { "later" } else { "earlier" },
        if more > 0.0 { "more" } else { "less" }
    );
    Some(Front { points: by_threshold, words })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_of_what_was_asked() {
        const UP: f64 = f64::INFINITY;
        let points = [(10.0, 5.0), (20.0, 4.0), (15.0, 3.0), (25.0, 6.0)];
        let of = |threshold_n, friction_n| front(&points, AskedRegion { threshold_n, friction_n });
        let late_and_little = of((20.0, UP), (0.0, 8.0)).unwrap();
        assert_eq!(late_and_little.points, [(15.0, 3.0), (20.0, 4.0), (25.0, 6.0)]);
        assert_eq!(late_and_little.words, "none later that rubs less");
        assert_eq!(of((20.0, UP), (8.0, UP)).unwrap().points, [(25.0, 6.0)]);
        assert_eq!(of((0.0, 20.0), (0.0, 8.0)).unwrap().points, [(10.0, 5.0), (15.0, 3.0)]);
        assert!(of((18.0, 22.0), (0.0, 8.0)).is_none(), "a threshold about 20 pulls neither way");
        assert!(of((0.0, UP), (0.0, 8.0)).is_none());
    }
}
