//! The channels in which readings are not linear, such as friction: one plus each is a product over the
//! random effects and kernels that act through it.
//!
//! As a product, a level that all rows share is the same as another value of a constant, whatever the
//! other coefficients are. In a sum it would also scale them all, and a level that nothing supports would gain by
//! bringing them closer to zero.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::{Component, Mode};
use crate::hypothesis::Hypothesis;
use crate::problem::{Rows, Space};

/// Bounds of a channel, and of each part.
const RANGE: (f64, f64) = (-0.9, 9.0);

/// Values of the curved channels at the rows of a mode.
#[derive(Clone, Debug, Default)]
pub(crate) struct CurvedChannels {
    /// Function of each component, in the order of the rows.
    parts: BTreeMap<Component, Vec<f64>>,
    /// Value of each curved channel of the space at each row; empty where it is zero.
    pub(crate) values: Vec<Vec<f64>>,
}

impl CurvedChannels {
    /// Multiplies the parts of each channel.
    fn of_parts(
        mut parts: BTreeMap<Component, Vec<f64>>,
        channels: &[usize],
        channel: impl Fn(Component) -> usize,
    ) -> Self {
        parts.values_mut().flatten().for_each(|x| *x = x.clamp(RANGE.0, RANGE.1));
        let product = |of: &usize| {
            let mut value: Vec<f64> = Vec::new();
            for part in
                parts.iter().filter(|(component, _)| channel(**component) == *of).map(|(_, part)| part)
            {
                value.resize(part.len(), 0.0);
                value.iter_mut().zip(part).for_each(|(value, x)| *value = (1.0 + *value) * (1.0 + *x) - 1.0);
            }
            value.iter_mut().for_each(|value| *value = value.clamp(RANGE.0, RANGE.1));
            value
        };
        let values = channels.iter().map(product).collect();
        Self { parts, values }
    }

    /// Evaluates the channels.
    pub(crate) fn new(mode: &Mode, space: &Space, rows: &Rows, hypothesis: &Hypothesis) -> Self {
        let mut parts = BTreeMap::new();
        let is_curved = |channel: usize| space.curved_channels.contains(&channel);
        for (i, random) in space.random_effects.iter().enumerate().filter(|(_, r)| is_curved(r.channel)) {
            let component = Component::Random(i);
            let Some(levels) = mode.curved.get(&component).filter(|l| l.len() == random.levels) else {
                continue;
            };
            let part = rows.levels[i].iter().map(|level| level.map_or(0.0, |level| levels[level]));
            parts.insert(component, part.collect::<Vec<f64>>());
        }
        for (kernel, variant) in hypothesis.kernels().filter(|(k, _)| is_curved(space.kernels[*k].channel)) {
            let component = Component::Kernel(kernel);
            let basis = &rows.bases[kernel][variant];
            if let Some(known) = mode.curved.get(&component).filter(|c| c.len() == basis.coefficients()) {
                parts.insert(component, basis.function(known));
            }
        }
        Self::of_parts(parts, &space.curved_channels, |component| component.channel(space))
    }

    /// Returns the sensitivity of the readings to a component from that to the logarithm of one plus its channel.
    pub(crate) fn sensitivity(&self, component: Component, channel: &[f64]) -> Vec<f64> {
        match self.parts.get(&component) {
            Some(part) => channel.iter().zip(part).map(|(slope, x)| slope / (1.0 + x)).collect(),
            None => channel.to_vec(),
        }
    }

    /// Returns the change of the readings from here to other values by the linear model, with the sensitivity to each component's
    /// channel.
    pub(crate) fn linear_change<'a>(
        &self,
        to: &Self,
        rows: usize,
        slopes: impl Fn(Component) -> &'a [f64],
    ) -> Vec<f64> {
        let mut sum = vec![0.0; rows];
        let components: BTreeSet<&Component> = self.parts.keys().chain(to.parts.keys()).collect();
        for component in components {
            let value = |of: &Self, row: usize| of.parts.get(component).map_or(0.0, |part| part[row]);
            for (row, (sum, slope)) in sum.iter_mut().zip(slopes(*component)).enumerate() {
                let from = value(self, row);
                *sum += slope * (value(to, row) - from) / (1.0 + from);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::{Element, Member};
    use crate::problem::{ForwardModel, Problem, SizedEffect};
    use crate::random::Random;
    use crate::test_problem::{fitted, long_rows, space};

    const MOUNT: Component = Component::Random(0);
    const CURVE: Component = Component::Kernel(2);

    /// Returns the value of channel 1 with two parts.
    fn channel(mount: [f64; 2], curve: [f64; 2]) -> CurvedChannels {
        CurvedChannels::of_parts([(MOUNT, mount.to_vec()), (CURVE, curve.to_vec())].into(), &[1], |_| 1)
    }

    /// Readings of the square of one plus the channel.
    fn readings(at: &CurvedChannels) -> Vec<f64> {
        at.values[0].iter().map(|value| (1.0 + value).powi(2)).collect()
    }

    /// Derivatives of the readings with respect to the logarithm of one plus the channel.
    fn slopes(at: &CurvedChannels) -> Vec<f64> {
        readings(at).iter().map(|reading| 2.0 * reading).collect()
    }

    #[test]
    fn sensitivities_match_finite_differences() {
        let (at, step) = (channel([0.2, -0.1], [-0.3, 0.4]), 1e-6);
        let moved = [
            (MOUNT, channel([0.2 + step, -0.1 + step], [-0.3, 0.4])),
            (CURVE, channel([0.2, -0.1], [-0.3 + step, 0.4 + step])),
        ];
        for (component, moved) in moved {
            let sensitivity = at.sensitivity(component, &slopes(&at));
            let slopes = slopes(&at);
            let change = at.linear_change(&moved, 2, |_| &slopes);
            for row in 0..2 {
                let slope = (readings(&moved)[row] - readings(&at)[row]) / step;
                assert!((sensitivity[row] - slope).abs() < 1e-4, "{component:?} {row}");
                assert!((change[row] - slope * step).abs() < 1e-9, "{component:?} {row}");
            }
        }
    }

    /// A level of a component that is zero changes the readings as any other factor of all rows does.
    #[test]
    fn a_common_level_is_a_common_factor() {
        let at = channel([0.2, -0.1], [0.0, 0.0]);
        assert_eq!(at.sensitivity(CURVE, &slopes(&at)), slopes(&at));
    }

    /// Friction in proportion to the load.
    struct Friction(Vec<f64>);

    impl ForwardModel for Friction {
        fn readings(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
            self.readings_at(constants, effects, &[])
        }

        fn channels(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<Vec<f64>> {
            self.channels_at(constants, effects, &[], &[])
        }

        fn readings_at(&self, constants: &[f64], _: &[SizedEffect], curved: &[Vec<f64>]) -> Vec<f64> {
            let factor = |row: usize| 1.0 + curved.first().and_then(|c| c.get(row)).copied().unwrap_or(0.0);
            let readings = self.0.iter().enumerate();
            readings.map(|(row, load)| libm::exp(constants[0]) * load * factor(row)).collect()
        }

        fn channels_at(
            &self,
            constants: &[f64],
            effects: &[SizedEffect],
            curved: &[Vec<f64>],
            _: &[f64],
        ) -> Vec<Vec<f64>> {
            vec![vec![1.0; self.0.len()], self.readings_at(constants, effects, curved)]
        }

        fn of_rows(&self, rows: &[usize]) -> Box<dyn ForwardModel> {
            Box::new(Self(rows.iter().map(|row| self.0[*row]).collect()))
        }
    }

    /// A hundred mounts that differ, and levels that do not: they gain nothing by bringing the mounts closer to zero.
    #[test]
    fn many_mounts_are_no_structure() {
        let mut rows = long_rows(300, 4);
        rows.levels = vec![rows.series.iter().map(|series| Some(series / 3)).collect()];
        rows.load.iter_mut().for_each(|load| *load *= 10.0);
        rows.forward = Box::new(Friction(rows.load.clone()));
        let mut space = space();
        space.effects.clear();
        space.usual_effects.clear();
        (rows.discrepancies, rows.relevant) = (Vec::new(), Vec::new());
        space.kernels[0].channel = 1;
        space.random_effects[0].levels = 100;
        space.curved_channels = vec![1];
        let mut random = Random::new(5);
        let mounts: Vec<f64> = (0..100).map(|_| 0.02 * random.normal()).collect();
        let mount = |row: usize| rows.levels[0][row].map_or(0.0, |level| mounts[level]);
        let readings = (0..rows.len()).map(|row| {
            let error = 0.03 * random.normal();
            2.0 * rows.load[row] * (1.0 + mount(row)) + error
        });
        let readings = readings.collect();
        let problem = Problem::new(space, rows, readings).unwrap();
        let (none, ..) = fitted(&problem, &Hypothesis::default());
        let levels = Hypothesis::from_elements([Element { member: Member::Kernel(0), form: 0 }]);
        let (levels, ..) = fitted(&problem, &levels);
        let gain = levels.log_evidence - none.log_evidence;
        assert!(gain < 0.0, "{gain}");
    }
}
