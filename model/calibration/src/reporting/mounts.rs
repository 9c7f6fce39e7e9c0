//! Mounts whose friction differs from that of the others.

use pinswitch_inference::{Coefficient, Coefficients};

use super::errors::NORMAL_95;
use crate::evidence::{CONSEQUENCE, Evidence};
use crate::report::MountReport;

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
            let half = NORMAL_95 * coefficients.covariance[(at, at)].max(0.0).sqrt();
            let ci95 = [friction - half, friction + half];
            // A level is named after session and mount, or after condition, session and specimen; some are empty.
            let parts: Vec<&str> = name.split('|').filter(|part| !part.is_empty()).collect();
            (friction.abs() >= CONSEQUENCE).then(|| MountReport { mount: parts.join(" "), friction, ci95 })
        })
        .collect();
    mounts.sort_by(|a, b| b.friction.abs().total_cmp(&a.friction.abs()));
    mounts
}
