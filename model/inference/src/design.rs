//! The linear model at a mode: one column per coefficient that the evidence integrates.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::curved_channels::CurvedChannels;
use crate::half_t::HalfT;
use crate::hypothesis::{Hypothesis, Member};
use crate::noise::Scales;
use crate::problem::{MOST_SHAPE_CONSTANTS, Problem, Rows, SizedEffect, Space};
use crate::white_design::SeriesColumns;

/// Standard deviation of the discrepancy of an effect, relative to its contribution.
pub(crate) const DISCREPANCY_SD: f64 = 0.15;
/// Step of a constant for its finite difference.
const CONSTANT_STEP: f64 = 1e-5;
/// Step of a shift of a shape for its finite difference.
const SHIFT_STEP: f64 = 1e-3;
/// Steps of a size for its finite difference, relative to the typical size and to the size.
const SIZE_STEPS: (f64, f64) = (1e-3, 1e-4);

/// What a column of the design multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// A constant of the baseline.
    Constant(usize),
    /// The size of an effect.
    Size(usize),
    /// A constant of the shape of an effect.
    Shape(usize, usize),
    /// The discrepancy of an effect.
    Discrepancy(usize),
    /// A level of a random effect or a coefficient of a kernel.
    Variance(Component),
}

/// A set of coefficients with a common standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Component {
    /// A random effect of the space.
    Random(usize),
    /// A kernel of the space.
    Kernel(usize),
}

impl Component {
    /// Returns the channel through which it acts.
    pub(crate) fn channel(self, space: &Space) -> usize {
        match self {
            Self::Random(i) => space.random_effects[i].channel,
            Self::Kernel(i) => space.kernels[i].channel,
        }
    }

    /// Returns the prior of its standard deviation.
    pub(crate) fn prior(self, space: &Space) -> HalfT {
        match self {
            Self::Random(i) => space.random_effects[i].prior(),
            Self::Kernel(i) => HalfT::cauchy(space.kernels[i].scale),
        }
    }
}

/// Point about which a hypothesis is linearised: constants, sizes, weights of the rows, scales of
/// the noise, and standard deviations of components.
#[derive(Clone, Debug)]
pub struct Mode {
    pub(crate) constants: Vec<f64>,
    pub(crate) sizes: BTreeMap<usize, f64>,
    /// Shifts of the shape of each effect.
    pub(crate) shifts: BTreeMap<usize, [f64; MOST_SHAPE_CONSTANTS]>,
    pub(crate) weights: DVector<f64>,
    pub(crate) scales: Scales,
    pub(crate) log_sd: BTreeMap<Component, f64>,
    /// Coefficients of the components of the curved channels.
    pub(crate) curved: BTreeMap<Component, Vec<f64>>,
}

impl Mode {
    /// Returns the effects of a hypothesis with sizes and shapes.
    pub(crate) fn sized(&self, hypothesis: &Hypothesis) -> Vec<SizedEffect> {
        let effects = hypothesis.effects();
        effects
            .map(|(effect, shape)| SizedEffect {
                effect,
                shape,
                size: self.sizes.get(&effect).copied().unwrap_or(1.0),
                shifts: self.shifts.get(&effect).copied().unwrap_or_default(),
            })
            .collect()
    }
}

/// Columns of a hypothesis at a mode, and what they leave to explain.
#[derive(Clone, Debug)]
pub(crate) struct Design {
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) roles: Vec<Role>,
    /// Prior mean of each coefficient.
    pub(crate) prior_mean: Vec<f64>,
    /// `y - f + J q + X s - A m`, so that coefficients are deviations from their prior means `m`.
    pub(crate) target: DVector<f64>,
    /// Sensitivity of the readings to each channel.
    pub(crate) channels: Vec<Vec<f64>>,
    /// Values of the curved channels at the mode.
    pub(crate) curved: CurvedChannels,
    /// Components whose columns are constant within each series, times a sensitivity.
    pub(crate) of_series: Vec<SeriesColumns>,
}

impl Design {
    /// Linearises a hypothesis at a mode; `None` if a derivative is not finite.
    pub(crate) fn new(problem: &Problem, hypothesis: &Hypothesis, mode: &Mode) -> Option<Self> {
        let mut design = Self::of_rows(&problem.space, &problem.rows, hypothesis, mode)?;
        design.target += &problem.readings;
        Some(design)
    }

    /// Linearises a hypothesis at rows without readings, which count as zero.
    pub(crate) fn of_rows(space: &Space, rows: &Rows, hypothesis: &Hypothesis, mode: &Mode) -> Option<Self> {
        let effects = mode.sized(hypothesis);
        let forward = &rows.forward;
        let at = CurvedChannels::new(mode, space, rows, hypothesis);
        let curved = at.values.as_slice();
        let baseline = forward.readings_at(&mode.constants, &effects, curved);
        let channels = forward.channels_at(&mode.constants, &effects, curved, &baseline);
        let mut builder = Builder { rows: rows.len(), ..Builder::default() };
        let mut target: Vec<f64> = baseline.iter().map(|f| -f).collect();
        let slopes = |component: Component| channels[component.channel(space)].as_slice();
        let to_zero = at.linear_change(&CurvedChannels::default(), rows.len(), slopes);
        target.iter_mut().zip(to_zero).for_each(|(target, change)| *target -= change);
        for (i, constant) in space.constants.iter().enumerate() {
            let mut moved = mode.constants.clone();
            moved[i] += CONSTANT_STEP;
            let constants = [mode.constants.as_slice(), &moved];
            let after = forward.readings_where_moved(constants, &effects, curved, &baseline);
            let column = slope(&after, &baseline, CONSTANT_STEP);
            add_scaled(&mut target, &column, mode.constants[i] - constant.mean);
            builder.push(Role::Constant(i), constant.mean, column);
        }
        let sized = effects.iter().filter(|e| space.effects[e.effect].typical_size.is_some());
        let mut contributions = Vec::new();
        for effect in sized {
            let column = size_sensitivity(space, rows, mode, &effects, *effect, (&baseline, curved));
            add_scaled(&mut target, &column, effect.size);
            contributions.push((*effect, column.iter().map(|x| x * effect.size).collect::<Vec<f64>>()));
            builder.push(Role::Size(effect.effect), 0.0, column);
        }
        for (effect, _) in &contributions {
            for i in 0..space.effects[effect.effect].shape_constants {
                let moved = |e: &SizedEffect| if e == effect { shifted(*e, i) } else { *e };
                let moved: Vec<SizedEffect> = effects.iter().map(moved).collect();
                let column =
                    slope(&forward.readings_at(&mode.constants, &moved, curved), &baseline, SHIFT_STEP);
                add_scaled(&mut target, &column, effect.shifts[i]);
                builder.push(Role::Shape(effect.effect, i), 0.0, column);
            }
        }
        for (effect, contribution) in &contributions {
            for factor in &rows.discrepancies[effect.effect] {
                let column = contribution.iter().zip(factor).map(|(x, z)| x * z).collect();
                builder.push(Role::Discrepancy(effect.effect), 0.0, column);
            }
        }
        let sensitivity = |component: Component| at.sensitivity(component, slopes(component));
        let ranges = rows.ranges();
        for (i, random) in space.random_effects.iter().enumerate() {
            let component = Component::Random(i);
            let sensitivity = sensitivity(component);
            let value = |row: usize, level: usize| f64::from(u8::from(rows.levels[i][row] == Some(level)));
            let columns = DMatrix::from_fn(rows.len(), random.levels, |row, level| {
                sensitivity[row] * value(row, level)
            });
            let is_constant = |range: &Range<usize>| {
                let levels = &rows.levels[i][range.clone()];
                levels.iter().all(|level| *level == levels[0])
            };
            let by_series = ranges.iter().all(is_constant).then(|| {
                DMatrix::from_fn(ranges.len(), random.levels, |series, level| {
                    value(ranges[series].start, level)
                })
            });
            builder.push_component(component, &columns, sensitivity, by_series);
        }
        for (kernel, variant) in hypothesis.kernels() {
            let component = Component::Kernel(kernel);
            let sensitivity = sensitivity(component);
            let basis = &rows.bases[kernel][variant];
            let columns = basis.times(&sensitivity);
            builder.push_component(component, &columns, sensitivity, basis.of_series(&ranges));
        }
        builder.finish(target, channels, at)
    }

    /// Returns the prior variance of each coefficient. Sizes have the variance `size_variance` of
    /// their effect.
    pub(crate) fn prior_variances(
        &self,
        space: &Space,
        log_sd: &BTreeMap<Component, f64>,
        size_variance: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let variance = |role: &Role| match role {
            Role::Constant(i) => space.constants[*i].sd.powi(2),
            Role::Size(effect) => size_variance(*effect),
            Role::Shape(..) => 1.0,
            Role::Discrepancy(_) => DISCREPANCY_SD.powi(2),
            Role::Variance(component) => log_sd.get(component).map_or(0.0, |log| libm::exp(2.0 * log)),
        };
        self.roles.iter().map(variance).collect()
    }

    /// Returns the sensitivity of the readings to the coefficients of a component.
    pub(crate) fn sensitivity(&self, space: &Space, component: Component) -> Vec<f64> {
        self.curved.sensitivity(component, &self.channels[component.channel(space)])
    }

    /// Returns the columns of a component.
    pub(crate) fn columns_of(&self, component: Component) -> Vec<usize> {
        let is_of = |role: &Role| *role == Role::Variance(component);
        (0..self.roles.len()).filter(|i| is_of(&self.roles[*i])).collect()
    }

    /// Returns the components that have columns, in order.
    pub(crate) fn components(&self) -> Vec<Component> {
        let mut components: Vec<Component> = Vec::new();
        for role in &self.roles {
            match role {
                Role::Variance(component) if components.last() != Some(component) => {
                    components.push(*component);
                }
                _ => {}
            }
        }
        components
    }
}

/// Columns under construction.
#[derive(Default)]
struct Builder {
    rows: usize,
    data: Vec<f64>,
    roles: Vec<Role>,
    mean: Vec<f64>,
    of_series: Vec<SeriesColumns>,
}

impl Builder {
    fn push(&mut self, role: Role, mean: f64, column: Vec<f64>) {
        self.data.extend(column);
        self.roles.push(role);
        self.mean.push(mean);
    }

    /// Adds the columns of a component; `by_series` are those of its basis, if they are constant within each series.
    fn push_component(
        &mut self,
        component: Component,
        columns: &DMatrix<f64>,
        sensitivity: Vec<f64>,
        by_series: Option<DMatrix<f64>>,
    ) {
        let first = self.roles.len();
        for column in columns.column_iter() {
            self.push(Role::Variance(component), 0.0, column.iter().copied().collect());
        }
        if let Some(by_series) = by_series.filter(|rows| rows.ncols() > 0) {
            let sensitivity = DVector::from_vec(sensitivity);
            let by_series = Arc::new(by_series.into());
            self.of_series.push(SeriesColumns { columns: first..self.roles.len(), sensitivity, by_series });
        }
    }

    fn finish(self, target: Vec<f64>, channels: Vec<Vec<f64>>, curved: CurvedChannels) -> Option<Design> {
        let is_finite =
            self.data.iter().chain(&target).chain(channels.iter().flatten()).all(|x| x.is_finite());
        is_finite.then(|| Design {
            matrix: DMatrix::from_vec(self.rows, self.roles.len(), self.data),
            roles: self.roles,
            prior_mean: self.mean,
            target: DVector::from_vec(target),
            channels,
            curved,
            of_series: self.of_series,
        })
    }
}

fn shifted(mut effect: SizedEffect, index: usize) -> SizedEffect {
    effect.shifts[index] += SHIFT_STEP;
    effect
}

fn slope(moved: &[f64], baseline: &[f64], step: f64) -> Vec<f64> {
    moved.iter().zip(baseline).map(|(a, b)| (a - b) / step).collect()
}

fn add_scaled(sum: &mut [f64], column: &[f64], factor: f64) {
    sum.iter_mut().zip(column).for_each(|(s, x)| *s += factor * x);
}

/// Returns the derivative of the readings with respect to the size of an effect of the model.
fn size_sensitivity(
    space: &Space,
    rows: &Rows,
    mode: &Mode,
    effects: &[SizedEffect],
    effect: SizedEffect,
    (baseline, curved): (&[f64], &[Vec<f64>]),
) -> Vec<f64> {
    let typical = space.effects[effect.effect].typical_size.unwrap_or(1.0);
    let step = (SIZE_STEPS.0 * typical).max(SIZE_STEPS.1 * effect.size.abs());
    let moved = |e: &SizedEffect| if *e == effect { SizedEffect { size: e.size + step, ..*e } } else { *e };
    let moved: Vec<SizedEffect> = effects.iter().map(moved).collect();
    slope(&rows.forward.readings_at(&mode.constants, &moved, curved), baseline, step)
}

/// Changes of the readings by effects that are added to a hypothesis at a mode, or take the place of another form of a member.
pub(crate) struct AddedColumns<'a> {
    problem: &'a Problem,
    hypothesis: &'a Hypothesis,
    mode: &'a Mode,
    curved: Vec<Vec<f64>>,
    /// Readings of the hypothesis.
    readings: Vec<f64>,
}

impl<'a> AddedColumns<'a> {
    pub(crate) fn new(problem: &'a Problem, hypothesis: &'a Hypothesis, mode: &'a Mode) -> Self {
        let curved = CurvedChannels::new(mode, &problem.space, &problem.rows, hypothesis).values;
        let forward = &problem.rows.forward;
        let readings = forward.readings_at(&mode.constants, &mode.sized(hypothesis), &curved);
        Self { problem, hypothesis, mode, curved, readings }
    }

    /// Returns the forms of an effect with the change of the readings per size of each, by a secant to its start, without forms
    /// whose change is zero or not finite.
    pub(crate) fn of_effect(&self, effect: usize) -> impl Iterator<Item = (usize, DVector<f64>)> + '_ {
        let member = Member::Effect(effect);
        let rest = self.mode.sized(&self.hypothesis.without(member));
        let (forward, constants) = (&self.problem.rows.forward, &self.mode.constants);
        let is_member = self.hypothesis.contains(member);
        let without = is_member.then(|| forward.readings_at(constants, &rest, &self.curved));
        let starts = self.problem.space.effects[effect].starts.iter().enumerate();
        starts.filter_map(move |(shape, start)| {
            let mut with = rest.clone();
            with.push(SizedEffect { effect, shape, size: *start, shifts: [0.0; MOST_SHAPE_CONSTANTS] });
            let after = forward.readings_at(constants, &with, &self.curved);
            let column = slope(&after, without.as_ref().unwrap_or(&self.readings), *start);
            let most = column.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let is_change = most > 1e-9 && column.iter().all(|x| x.is_finite());
            is_change.then(|| (shape, DVector::from_vec(column)))
        })
    }
}
