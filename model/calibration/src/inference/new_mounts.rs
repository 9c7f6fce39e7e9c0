//! Error that new mounts add in another session.
//!
//! All series of a mount share its effect `z`, so that held-out series show only the part that the
//! constants, fitted to the other series, have not absorbed: `z - H z`, with the hat matrix `H` of
//! generalised least squares. A new session has its own mount effects: its squared error is larger
//! by about `z' H z`. If the fit includes mount effects, little is absorbed and little is added.
//! (Constants that are wrong by all they absorbed would add `2 z' H z`; for independently simulated
//! rigs this was too much, see model/doc/calibration.md.)

use nalgebra::DVector;

use super::fit::{Fit, Slopes, jacobian};
use super::noise::Noise;
use super::observations::Observations;
use super::projection::dot;
use super::scatter::Scatter;
use super::weighed::Weighed;

/// Returns the mean square in newtons that new mounts add to held-out errors.
///
/// The mount effects are the most probable ones, given those of the noise, or, if it has none,
/// those estimated in addition to the model: a table without mount effects does not imply that the
/// next mounts have none. Zero if the constants are not determined.
pub(crate) fn new_mounts_n2(fitted: &Fit, data: &Observations, noise: Noise) -> f64 {
    let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&fitted.model, data, &predicted);
    let known = if noise.mount_scale > 0.0 {
        noise.mount_scale
    } else {
        Scatter::Mounts.estimated(data, &fitted.residual_n, &own, noise).mount_scale
    };
    let known = Scatter::Mounts.most_probable(known, data.mounts.len());
    if known <= 0.0 || data.points.is_empty() {
        return 0.0;
    }
    let weighed = Weighed::new(data, noise);
    let slopes = Slopes::new(&fitted.model, &weighed, &predicted);
    let Some(factor) = slopes.normal.clone().cholesky() else { return 0.0 };
    let taken_over = |mount: &Vec<usize>| {
        let mut trace = vec![0.0; data.points.len()];
        mount.iter().for_each(|row| trace[*row] = known * data.friction_n[*row]);
        let mut white = trace.clone();
        weighed.whiten(&mut white);
        along_n2(&trace, &own, &factor.solve(&slopes.along(&white)))
    };
    data.mounts.iter().map(taken_over).sum::<f64>() / data.points.len() as f64
}

/// Returns `z' H z` of one trace: its product with the part that the constants absorb by shifting.
fn along_n2(trace: &[f64], own: &[Vec<f64>], shift: &DVector<f64>) -> f64 {
    own.iter().zip(shift.iter()).map(|(column, by)| by * dot(column, trace)).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Model, Weighed, fit};
    use crate::table::Frame;
    use crate::test_session::session;

    /// With few mounts the constants absorb most, unless the fit includes mount effects.
    #[test]
    fn new_mounts_increase_the_expected_error() {
        let rows = session(3);
        let frame = Frame::new(&rows);
        let mut data = Observations::new(&frame, &rows).unwrap();
        let model = Model::baseline(frame);
        let noise = |mount_scale| Noise { mount_scale, ..Noise::constant(0.05, 0.02) };
        let fitted = fit(&model, &Weighed::new(&data, noise(0.0)));
        data.friction_n = fitted.model.friction_n(&data.points);
        let predicted: Vec<f64> = data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
        let own = jacobian(&fitted.model, &data, &predicted);
        let share = |mount_scale: f64| {
            let weighed = Weighed::new(&data, noise(mount_scale));
            let slopes = Slopes::new(&fitted.model, &weighed, &predicted);
            let factor = slopes.normal.clone().cholesky().unwrap();
            let (mut taken, mut whole) = (0.0, 0.0);
            for mount in &data.mounts {
                let mut trace = vec![0.0; data.points.len()];
                mount.iter().for_each(|row| trace[*row] = data.friction_n[*row]);
                whole += dot(&trace, &trace);
                let mut white = trace.clone();
                weighed.whiten(&mut white);
                taken += along_n2(&trace, &own, &factor.solve(&slopes.along(&white)));
            }
            taken / whole
        };
        let (unknown, known) = (share(0.0), share(0.05));
        assert!((0.5..=1.0 + 1e-9).contains(&unknown) && known < unknown, "{unknown} {known}");
        data.mounts.clear();
        assert_eq!(new_mounts_n2(&fitted, &data, noise(0.05)), 0.0);
    }
}
