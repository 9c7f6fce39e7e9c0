//! Mounts whose friction differs from that of the others.

use pinswitch_inference::{Coefficient, Coefficients};

use crate::evidence::{CONSEQUENCE, Evidence};
use crate::report::MountReport;

/// Standard deviations on either side of the mean of a 95 % interval.
const TWO_SIDED_95: f64 = 1.96;

/// Returns the mounts whose friction differs by a size of consequence under the best hypothesis, the largest difference first.
pub(super) fn mounts(evidence: &Evidence) -> Vec<MountReport> {
    let best = evidence.posterior().window.first();
    let Some(coefficients) = best.and_then(|best| Coefficients::new(evidence.problem(), best)) else {
        return Vec::new();
    };
    let mut mounts: Vec<MountReport> = evidence
        .mounts()
        .filter_map(|(effect, level, name)| {
            let at = coefficients.index(Coefficient::Level(effect, level))?;
            let friction = coefficients.mean[at];
            let half = TWO_SIDED_95 * coefficients.covariance[(at, at)].max(0.0).sqrt();
            let ci95 = [friction - half, friction + half];
            (friction.abs() >= CONSEQUENCE).then(|| MountReport { mount: name.to_owned(), friction, ci95 })
        })
        .collect();
    mounts.sort_by(|a, b| b.friction.abs().total_cmp(&a.friction.abs()));
    mounts
}
