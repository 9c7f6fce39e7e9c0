//! What reports read off a posterior.

use pinswitch_inference::{Kernel, Member, REPORTED_PROBABILITY, leave_groups_out};

use super::fitted::channel_of;
use super::forward::Channel;
use super::structure::{NOISE, Record, Structure};
use super::{Evidence, Fitted, MOUNT};
use crate::effects::{self, SharedEffect};
use crate::table::{Frame, Point};

impl Evidence {
    /// Returns the number of series.
    pub fn series_count(&self) -> usize {
        self.series.last().map_or(0, |last| last + 1)
    }

    /// Returns, in the order of the problem, the row of the table, the number of the series and the
    /// covariates of each reading.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize, &Point)> {
        let series = self.series.iter().copied();
        self.source.iter().copied().zip(series).zip(&self.points).map(|((row, series), p)| (row, series, p))
    }

    /// Returns the first row of the table of a series.
    pub(crate) fn row_of_series(&self, series: usize) -> Option<usize> {
        let place = self.series.iter().position(|of| *of == series)?;
        self.source(place)
    }

    /// Returns the row of the table of a row of the problem.
    pub fn source(&self, row: usize) -> Option<usize> {
        self.source.get(row).copied()
    }

    /// Returns whether each row of the table has a gross error, or belongs to a series that has one.
    pub fn outliers(&self) -> Vec<bool> {
        let mut outliers = vec![false; self.source.len()];
        for (row, source) in self.source.iter().enumerate() {
            outliers[*source] = self.posterior.outliers.contains(row);
        }
        outliers
    }

    /// Returns the reading of each row of the table in newtons.
    pub fn readings_n(&self) -> Vec<f64> {
        self.in_table_order(&self.readings)
    }

    /// Returns the weight of each row of the table in the best fit: below 1 for large residuals, 0 for a
    /// row that is excluded.
    pub fn weights(&self) -> Vec<f64> {
        let best = self.posterior.window.first();
        self.in_table_order(&best.map_or_else(Vec::new, |fit| fit.weights().collect()))
    }

    /// Returns the repetition noise of each row of the table in units of its scale, under the best
    /// hypothesis: Student's t with 5 degrees of freedom if the noise is as assumed. A row that is
    /// excluded has none.
    pub fn standardised_noise(&self) -> Vec<f64> {
        self.in_table_order(&self.posterior.outliers.standardised)
    }

    /// Returns reading minus prediction of each row of the table in newtons, where each series is
    /// predicted from the others under the best hypothesis; `None` without a finite fit.
    pub fn left_out_residuals_n(&self) -> Option<Vec<f64>> {
        let best = self.posterior.window.first()?;
        let groups = (0..self.series_count()).collect::<Vec<usize>>();
        let residuals = leave_groups_out(&self.problem, best, &groups, |_| Vec::new())?;
        Some(self.in_table_order(&residuals))
    }

    /// Returns numbers in the order of the problem in that of the table.
    fn in_table_order(&self, values: &[f64]) -> Vec<f64> {
        let mut ordered = vec![f64::NAN; self.source.len()];
        for (row, value) in self.source.iter().zip(values) {
            ordered[*row] = *value;
        }
        ordered
    }

    /// Returns reading minus expectation in newtons, in the order of the problem.
    pub(crate) fn residuals_n(&self, fitted: &Fitted) -> Vec<f64> {
        self.source.iter().zip(&self.readings).map(|(row, y)| y - fitted.predicted_n[*row]).collect()
    }

    /// Returns the root mean square of numbers in the order of the problem, without gross errors and
    /// undefined numbers.
    pub(crate) fn root_mean_square_n(&self, values: &[f64]) -> f64 {
        let is_sound = |row: &usize| !self.posterior.outliers.contains(*row) && values[*row].is_finite();
        let (mut sum, mut count) = (0.0, 0.0);
        for row in (0..values.len()).filter(is_sound) {
            sum += values[row] * values[row];
            count += 1.0;
        }
        (sum / f64::max(count, 1.0)).sqrt()
    }

    /// Returns the effect of an index of the space.
    pub fn effect_at(&self, index: usize) -> &SharedEffect {
        &self.setup.priors[index].effect
    }

    /// Returns the effect of a member; `None` for structure without a name.
    pub fn effect(&self, member: Member) -> Option<&SharedEffect> {
        match member {
            Member::Effect(index) => Some(self.effect_at(index)),
            Member::Kernel(_) => None,
        }
    }

    /// Returns the index of the random effect of the mounts, with the number and the name of each of its levels.
    pub(crate) fn mounts(&self) -> impl Iterator<Item = (usize, usize, &str)> {
        let effects = &self.problem.space().random_effects;
        let of_mounts = effects.iter().position(|effect| effect.name == MOUNT && effect.levels > 0);
        let names = self.setup.mounts.iter().enumerate();
        of_mounts
            .into_iter()
            .flat_map(move |effect| names.clone().map(move |(level, name)| (effect, level, name.as_str())))
    }

    /// Returns the conditions and reference values of the table.
    pub(crate) fn frame(&self) -> &Frame {
        &self.setup.frame
    }

    /// Returns the number of a structure among those of the model file, from 1; `None` if the file does
    /// not keep it.
    pub(crate) fn structure_number(&self, member: Member) -> Option<usize> {
        let best = &self.posterior.window.first()?.hypothesis;
        let is_kept = |kernel: &usize| self.setup.structures[*kernel].record != Record::Nothing;
        let kernels = best.members().filter_map(|of| match of {
            Member::Kernel(kernel) => Some(kernel),
            Member::Effect(_) => None,
        });
        let place = kernels.filter(is_kept).position(|kernel| Member::Kernel(kernel) == member)?;
        Some(place + 1)
    }

    /// Returns the kernel of a member; `None` for an effect.
    pub(crate) fn kernel_at(&self, member: Member) -> Option<&Kernel> {
        match member {
            Member::Kernel(kernel) => self.problem.space().kernels.get(kernel),
            Member::Effect(_) => None,
        }
    }

    /// Returns the channel of structure without a name; `None` for an effect.
    pub(crate) fn channel(&self, member: Member) -> Option<effects::Channel> {
        match member {
            Member::Kernel(kernel) => Some(channel_of(self.setup.structures.get(kernel)?.channel)),
            Member::Effect(_) => None,
        }
    }

    /// Returns whether a member is noise, which is not reported.
    pub(crate) fn is_noise(&self, member: Member) -> bool {
        self.kernel_at(member).is_some_and(|kernel| kernel.noise_probability.is_some())
    }

    /// Returns the offsets that wander from series to series in the best hypothesis: channel and standard deviation of each.
    pub(crate) fn wandering(&self) -> Vec<(Channel, f64)> {
        let Some(best) = self.posterior.window.first() else { return Vec::new() };
        let is_wandering = |(_, structure): &(usize, &Structure)| structure.covariate == NOISE;
        let structures = self.setup.structures.iter().enumerate().filter(is_wandering);
        structures.filter_map(|(kernel, of)| Some((of.channel, best.kernel_sd(kernel)?))).collect()
    }

    /// Returns whether the absence of structure without a name has less than the probability from which a member is reported.
    pub(crate) fn may_have_structure(&self) -> bool {
        let is_structure = |member: Member| {
            matches!(member, Member::Kernel(_)) && !self.is_noise(member) && !self.is_change(member)
        };
        self.posterior.probability_of_any(is_structure) > 1.0 - REPORTED_PROBABILITY
    }

    /// Returns whether the size of an effect cannot be negative.
    pub(crate) fn is_one_sided(&self, effect: usize) -> bool {
        self.problem.space().effects[effect].is_one_sided
    }

    /// Returns the first constant of an effect for a size.
    pub(crate) fn parameter_of_size(&self, effect: usize, size: f64) -> f64 {
        self.setup.priors[effect].limit_from_n.map_or(size, |from| from - size)
    }

    /// Returns the constants of a shape of an effect after its size.
    pub(crate) fn shape_values(&self, effect: usize, shape: usize) -> Vec<f64> {
        self.setup.priors[effect].shape(shape)
    }

    /// Returns the full name of an effect's first constant, and the 95 % interval of it over all
    /// hypotheses with the effect.
    pub(crate) fn size_interval(&self, effect: usize) -> Option<(String, [f64; 2])> {
        let size = self.posterior.size(effect)?;
        let named = self.effect_at(effect);
        let parameter = named.parameters().first()?;
        let least = if self.is_one_sided(effect) { 0.0 } else { f64::NEG_INFINITY };
        let ends = size.interval.map(|end| self.parameter_of_size(effect, end.max(least)));
        let interval = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        Some((format!("{}.{}", named.id(), parameter.name), interval))
    }

    /// Returns the constants of the baseline that belong to a device.
    pub(crate) fn device_constants(&self, device: usize) -> [usize; 2] {
        self.setup.baseline.device_indices(device)
    }

    /// Returns whether a member is a constant of the switch that differs between sessions or specimens: a property of
    /// the switch, and no effect that the model lacks.
    pub(crate) fn is_change(&self, member: Member) -> bool {
        let Member::Kernel(kernel) = member else { return false };
        let structure = &self.setup.structures[kernel];
        matches!(structure.covariate, "session" | "specimen") && channel_of(structure.channel).is_of_switch()
    }

    /// Returns the constant that a change multiplies.
    pub(crate) fn changing_constant(&self, kernel: usize) -> &'static str {
        match self.setup.structures[kernel].channel {
            Channel::Pins => "mu_p",
            Channel::Silicone => "mu_s",
            Channel::HalfLoad | Channel::HalfLoadOf(_) => "F_half",
            _ => "mu",
        }
    }

    /// Returns the layout whose constant a change multiplies; `None` for all of them.
    pub(crate) fn changing_layout(&self, kernel: usize) -> Option<String> {
        let Channel::HalfLoadOf(device) = self.setup.structures[kernel].channel else { return None };
        let condition = self.setup.conditions.iter().find(|condition| condition.device == Some(device));
        condition.map(|condition| condition.layout())
    }

    /// Returns the session or specimen of each row of the problem.
    pub(crate) fn groups(&self, by: &str) -> impl Iterator<Item = &str> {
        let is_session = by == "session";
        self.groups.iter().map(
            move |[session, specimen]| {
                if is_session { session.as_str() } else { specimen.as_str() }
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    /// The problem sorts the rows of a table by series and time.
    #[test]
    fn values_of_rows_are_in_table_order() {
        let mut rows = session(3);
        rows.reverse();
        let evidence = Evidence::baseline(&rows, 1).unwrap();
        let readings: Vec<f64> = rows.iter().map(|row| row.force_n).collect();
        assert_eq!(evidence.readings_n(), readings);
        let left_out = evidence.left_out_residuals_n().unwrap();
        let fitted = evidence.fitted(&evidence.posterior().baseline).unwrap();
        for ((left_out, reading), predicted) in left_out.iter().zip(&readings).zip(&fitted.predicted_n) {
            assert!((left_out - (reading - predicted)).abs() < 0.1, "{left_out} {reading} {predicted}");
        }
        assert!(evidence.weights().iter().all(|weight| *weight > 0.2), "no reading is an outlier");
        assert!(evidence.standardised_noise().iter().all(|noise| noise.abs() < 8.0));
    }
}
