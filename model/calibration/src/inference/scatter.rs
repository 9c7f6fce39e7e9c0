//! Random effects of few groups: mounts, drifting offsets, operators and sessions, specimens.

use super::noise::Noise;
use super::observations::Observations;
use super::projection::{Projection, dot};
use super::variance_components::{LEAST_SCALE, ROUNDS, indicator};
use super::wandering::{walk_cost, wandering};
use super::weighed::Weighed;

/// Relative mount effect in which a relevant step of friction, 5 %, can hide.
const HIDING_MOUNT_SCALE: f64 = 0.04;
/// Largest relative mount effect that counts as scatter; a larger one indicates an error.
const MOST_MOUNT_SCALE: f64 = 0.06;

impl Noise {
    /// Returns whether the mount effect is large enough to hide a relevant step of friction between
    /// two mounts, or an effect of a layout.
    pub fn mounts_hide(self) -> bool {
        self.mount_scale >= HIDING_MOUNT_SCALE
    }
}

/// A random effect that competes with effects, since its few groups determine it poorly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scatter {
    /// Friction of each mount.
    Mounts,
    /// Offsets that drift from series to series.
    Walk,
    /// Reading of each operator and of each session, if the table names them.
    Groups,
    /// Friction of each specimen, if the table names them.
    Specimens,
}

impl Scatter {
    /// Random effects that compete with effects. The others follow from labels of the table.
    pub(super) const ALL: [Scatter; 2] = [Scatter::Mounts, Scatter::Walk];

    /// Returns the noise with this component taken from another one.
    pub(super) fn taken_from(self, other: Noise, noise: Noise) -> Noise {
        match self {
            Scatter::Mounts => Noise { mount_scale: other.mount_scale, ..noise },
            Scatter::Walk => Noise { walk: other.walk, ..noise },
            Scatter::Groups => Noise { group_offset_n: other.group_offset_n, ..noise },
            Scatter::Specimens => Noise { specimen_scale: other.specimen_scale, ..noise },
        }
    }

    /// Returns the noise without this component.
    pub(super) fn left_out(self, noise: Noise) -> Noise {
        self.taken_from(Noise::constant(0.0, 0.0), noise)
    }

    /// Returns the noise with this component estimated from residuals in newtons, with `own`
    /// columns projected out. All other components are unchanged.
    pub(super) fn estimated(
        self,
        data: &Observations,
        residual_n: &[f64],
        own: &[Vec<f64>],
        noise: Noise,
    ) -> Noise {
        let without = self.left_out(noise);
        if self == Scatter::Walk {
            return Noise { walk: wandering(data, residual_n, own, without), ..without };
        }
        self.in_noise(without, scatter_size(self, data, residual_n, own, without))
    }

    /// All components except the drift have one size.
    fn in_noise(self, noise: Noise, size: f64) -> Noise {
        match self {
            Scatter::Mounts => Noise { mount_scale: size, ..noise },
            Scatter::Walk => noise,
            Scatter::Groups => Noise { group_offset_n: size, ..noise },
            Scatter::Specimens => Noise { specimen_scale: size, ..noise },
        }
    }

    fn groups(self, data: &Observations) -> Vec<&Vec<usize>> {
        match self {
            Scatter::Mounts => data.mounts.iter().collect(),
            Scatter::Walk => Vec::new(),
            Scatter::Groups => data.operators.iter().chain(&data.sessions).collect(),
            Scatter::Specimens => data.specimens.iter().collect(),
        }
    }

    /// Returns the fewest groups for an estimate.
    fn least_groups(self) -> usize {
        match self {
            Scatter::Mounts => 3,
            Scatter::Walk => 0,
            Scatter::Groups | Scatter::Specimens => 2,
        }
    }

    /// Returns the change of a row in newtons per unit of a group's random effect.
    pub(super) fn direction_n(self, data: &Observations, row: usize) -> f64 {
        match self {
            Scatter::Mounts | Scatter::Specimens => data.friction_n[row],
            Scatter::Walk | Scatter::Groups => 1.0,
        }
    }

    /// Returns characteristic sizes: smallest relevant, start value, typical, and largest.
    fn scale(self) -> [f64; 4] {
        match self {
            Scatter::Mounts => [LEAST_SCALE, 0.02, 0.045, MOST_MOUNT_SCALE],
            Scatter::Walk => [0.0; 4],
            Scatter::Groups => [2e-3, 0.2, 0.5, 10.0],
            Scatter::Specimens => [LEAST_SCALE, 0.05, 0.1, 1.0],
        }
    }

    /// Returns the most probable size if this number of groups has the maximum-likelihood estimate
    /// `size`: few groups may scatter more than others will, and large scatter is rare.
    pub(super) fn most_probable(self, size: f64, groups: usize) -> f64 {
        // Root of the derivative with respect to the variance v of `d ln v + d size^2 / v + v /
        // typical^2`, which is twice the negative log posterior density, with `d` degrees of
        // freedom.
        let degrees = groups.saturating_sub(1) as f64;
        let rare = self.scale()[2].powi(-2);
        let root = (degrees * degrees + 4.0 * rare * degrees * size * size).sqrt();
        ((root - degrees) / (2.0 * rare)).sqrt()
    }

    /// Returns minus twice the log prior density of this component, a half-normal distribution of
    /// its size, up to a constant.
    pub(super) fn cost(self, noise: Noise, data: &Observations) -> f64 {
        let size = match self {
            Scatter::Mounts => noise.mount_scale,
            Scatter::Walk => return walk_cost(noise, data),
            Scatter::Groups => noise.group_offset_n,
            Scatter::Specimens => noise.specimen_scale,
        };
        (size / self.scale()[2]).powi(2)
    }
}

/// Estimates the size of a component by restricted maximum likelihood.
fn scatter_size(
    scatter: Scatter,
    data: &Observations,
    residual_n: &[f64],
    own: &[Vec<f64>],
    noise: Noise,
) -> f64 {
    let [least, start, _, most] = scatter.scale();
    let none = (0..data.points.len()).all(|r| scatter.direction_n(data, r) == 0.0);
    if scatter.groups(data).len() < scatter.least_groups() || none {
        return 0.0;
    }
    let means = data.cell_means(noise);
    let residual = means.mean_of(data, residual_n);
    let columns = means.means_of(data, own);
    let means = &means.observations;
    let groups: Vec<Vec<f64>> = scatter
        .groups(means)
        .iter()
        .map(|rows| indicator(residual.len(), rows, |r| scatter.direction_n(means, r)))
        .collect();
    let mut theta = start * start;
    for _ in 0..ROUNDS {
        let weighed = Weighed::new(means, scatter.in_noise(noise, theta.sqrt()));
        let projection = Projection::of_whitened(&columns, residual.len(), &weighed);
        let mut rest = residual.clone();
        weighed.whiten(&mut rest);
        projection.remove(&mut rest);
        let (mut found, mut expected) = (0.0, 0.0);
        let mut white = groups.clone();
        weighed.whiten_all(&mut white);
        for mut white in white {
            projection.remove(&mut white);
            let expect = dot(&white, &white);
            found += dot(&white, &rest).powi(2);
            expected += expect;
        }
        if expected <= 0.0 {
            return 0.0;
        }
        theta *= (found / expected).clamp(0.05, 20.0);
        if theta < least * least {
            return 0.0;
        }
    }
    theta.sqrt().min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_groups_shrink_the_estimate() {
        let probable = |size: f64, groups| Scatter::Mounts.most_probable(size, groups);
        assert_eq!((probable(0.0, 7), probable(0.05, 1)), (0.0, 0.0));
        assert!((0.04..0.056).contains(&probable(0.06, 7)) && probable(0.06, 3) < probable(0.06, 7));
        assert!((probable(0.01, 7) / 0.01 - 1.0).abs() < 0.01);
        assert!((probable(0.06, 10_000) / 0.06 - 1.0).abs() < 0.001);
    }
}
