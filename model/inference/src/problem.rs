//! The data of an inference: readings, the groups of their rows, priors, and the forward model.

use std::fmt;
use std::ops::Range;
use std::sync::OnceLock;

use nalgebra::DVector;

use crate::basis::Basis;
use crate::cells::KernelsOfBases;
use crate::half_t::HalfT;
use crate::noise::NoiseReference;

/// A constant of the baseline, with a normal prior in the coordinate in which it is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// Name in reports.
    pub name: String,
    /// Prior mean.
    pub mean: f64,
    /// Prior standard deviation.
    pub sd: f64,
}

/// A named effect, which a hypothesis may contain.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Name in reports.
    pub name: String,
    /// Quartile of the Cauchy prior of its size; `None` for an effect without a free size.
    pub typical_size: Option<f64>,
    /// Whether its size cannot be negative.
    pub is_one_sided: bool,
    /// Prior probability, 0..1.
    pub probability: f64,
    /// Size at which each shape is scored first, one per shape.
    pub starts: Vec<f64>,
    /// Prior probabilities of the shapes, given the effect; empty if all are equal.
    pub shape_probabilities: Vec<f64>,
    /// Number of constants of a shape, at most [`MOST_SHAPE_CONSTANTS`]. A fit shifts them from
    /// their discrete values.
    pub shape_constants: usize,
}

/// Most constants of a shape.
pub const MOST_SHAPE_CONSTANTS: usize = 3;

/// Unnamed structure over one covariate, which a hypothesis may contain.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Name in reports.
    pub name: String,
    /// Covariate in reports.
    pub covariate: String,
    /// Number of its bases. Kernels of one number have the same bases, through different channels.
    pub bases: usize,
    /// Index of the channel through which it acts.
    pub channel: usize,
    /// Scale of the half-Cauchy prior of its standard deviation, in the unit of the channel.
    pub scale: f64,
    /// Prior probabilities of its variants: discrete forms, each a hypothesis of its own.
    pub variants: Vec<f64>,
    /// Whether a new session draws it again.
    pub is_session_bound: bool,
    /// Process of the levels of sessions of each variant; empty for a kernel over another covariate.
    pub session_levels: Vec<SessionLevels>,
    /// Whether it has levels of specimens, which another session measures again.
    pub is_of_specimens: bool,
    /// Prior probability of a kernel that is noise, which is never reported; `None` for unnamed
    /// structure, which shares [`Space::structure_probability`].
    pub noise_probability: Option<f64>,
    /// Whether it is a gross error of the rows where its basis is not zero, which no other session has.
    pub is_gross_error: bool,
}

/// Process that the levels of sessions follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionLevels {
    /// Each session draws its level about the same mean, which a new one is expected to have.
    Independent,
    /// Each session has the level of the one before and a step, so that a new one is expected to have the last level.
    RandomWalk,
    /// The level changed once between this number of sessions; a new one is expected to have the last level.
    OneChange(usize),
    /// One of this number of sessions, but not the first, differs from all others, whose level a new one is expected to have.
    OneSession(usize),
}

impl SessionLevels {
    /// Returns the level that a new session is expected to have, given those of the sessions in their order.
    pub fn expected(self, levels: &[f64]) -> f64 {
        let level = match self {
            Self::Independent => Some(levels.iter().sum::<f64>() / levels.len().max(1) as f64),
            Self::RandomWalk | Self::OneChange(_) => levels.last().copied(),
            Self::OneSession(_) => levels.first().copied(),
        };
        level.unwrap_or(0.0)
    }

    /// Returns the row of a new session with the expected level, given a basis that is constant in each session.
    pub(crate) fn expected_row(self, basis: &Basis) -> Vec<f64> {
        let mut rows: Vec<&[f64]> = (0..basis.readings()).map(|reading| basis.at(reading)).collect();
        rows.dedup();
        let of_column = |column| {
            let levels: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            self.expected(&levels)
        };
        (0..basis.coefficients()).map(of_column).collect()
    }
}

/// A random effect that every hypothesis contains, such as that of mounts.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomEffect {
    /// Name in reports.
    pub name: String,
    /// Index of the channel through which it acts.
    pub channel: usize,
    /// Scale of the half-normal prior of its standard deviation, in the unit of the channel.
    pub scale: f64,
    /// Number of levels.
    pub levels: usize,
    /// Whether a new session has new levels: a new mount, but the same specimen.
    pub is_redrawn: bool,
}

/// Scale of a half-t distribution with three degrees of freedom over that of a half-normal one with the same mean.
const EQUAL_MEAN: f64 = 0.7236;

impl RandomEffect {
    /// Returns the prior by which hypotheses are compared. It excludes standard deviations of many scales, so that scatter does
    /// not explain what structure explains: a layout that is off, a session that differs.
    pub(crate) const fn prior(&self) -> HalfT {
        HalfT::normal(self.scale)
    }

    /// Returns the prior of what is reported and predicted, given a hypothesis: half-t with three degrees of freedom and the same
    /// mean. Its tail believes the data where levels differ by far more, as the first prior would not (Gelman 2006).
    pub(crate) const fn predictive_prior(&self) -> HalfT {
        HalfT { scale: EQUAL_MEAN * self.scale, degrees: 3.0 }
    }
}

/// Everything that hypotheses are made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Space {
    /// Constants of the baseline.
    pub constants: Vec<Constant>,
    /// Named effects.
    pub effects: Vec<Effect>,
    /// Unnamed structure.
    pub kernels: Vec<Kernel>,
    /// Random effects.
    pub random_effects: Vec<RandomEffect>,
    /// Effects from which a second search starts, since only together may they explain anything.
    pub usual_effects: Vec<usize>,
    /// Prior probability of unnamed structure, spread evenly over the kernels.
    pub structure_probability: f64,
    /// Index of the channel of the scale that each series draws.
    pub series_scale_channel: usize,
    /// Indices of the channels in which the readings are not linear, about whose values fits are linearised again.
    pub curved_channels: Vec<usize>,
    /// Pairs of channels through which one cause acts, each in its own way: a search adds kernels of both at once.
    pub joint_channels: Vec<[usize; 2]>,
}

/// An effect with its size, as an argument of a forward model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizedEffect {
    /// Index in [`Space::effects`].
    pub effect: usize,
    /// Index of its shape.
    pub shape: usize,
    /// Size; 1 for an effect without a free size.
    pub size: f64,
    /// Shifts of the constants of its shape, in standard deviations of their priors.
    pub shifts: [f64; MOST_SHAPE_CONSTANTS],
}

/// The expected readings of some rows, as a function of constants and effects.
pub trait ForwardModel {
    /// Returns the readings, one per row.
    fn readings(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64>;

    /// Returns the derivative of the readings with respect to each channel, one column per channel.
    fn channels(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<Vec<f64>>;

    /// Returns the readings where each curved channel of the space has this value at each row; an empty list
    /// is zeros. A space without curved channels needs no other implementation.
    fn readings_at(&self, constants: &[f64], effects: &[SizedEffect], _curved: &[Vec<f64>]) -> Vec<f64> {
        self.readings(constants, effects)
    }

    /// Returns the same where `constants` have one that is `moved`, given the readings at them. A model may keep those that the
    /// constant does not change.
    fn readings_where_moved(
        &self,
        [_constants, moved]: [&[f64]; 2],
        effects: &[SizedEffect],
        curved: &[Vec<f64>],
        _readings: &[f64],
    ) -> Vec<f64> {
        self.readings_at(moved, effects, curved)
    }

    /// Returns the derivatives as [`ForwardModel::channels`] there, given the readings; those of curved channels with respect
    /// to the logarithms of one plus them.
    fn channels_at(
        &self,
        constants: &[f64],
        effects: &[SizedEffect],
        _curved: &[Vec<f64>],
        _readings: &[f64],
    ) -> Vec<Vec<f64>> {
        self.channels(constants, effects)
    }

    /// Returns the model of some of the rows, in this order.
    fn of_rows(&self, rows: &[usize]) -> Box<dyn ForwardModel>;

    /// Returns the readings where effects of a session's time have their mean over the session.
    fn session_mean(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
        self.readings(constants, effects)
    }
}

/// Conditions of some rows. The rows of a series are consecutive.
pub struct Rows {
    /// Number of the series of each row, from 0 in the order of the rows.
    pub series: Vec<usize>,
    /// Whether each row belongs to the second of the two directions.
    pub direction: Vec<bool>,
    /// Session of each row.
    pub sessions: Vec<usize>,
    /// Order of each row in its series, as a lag: 0, 1, 2, ...
    pub order: Vec<usize>,
    /// Load of each row, with which the repetition noise grows.
    pub load: Vec<f64>,
    /// Level of each row for each random effect of the space.
    pub levels: Vec<Vec<Option<usize>>>,
    /// Bases of each kernel of the space, one per variant.
    pub bases: Vec<Vec<Basis>>,
    /// Columns that multiply the contribution of each effect of the space where its form is wrong.
    pub discrepancies: Vec<Vec<Vec<f64>>>,
    /// Smallest relevant change of each reading by each effect of the space.
    pub relevant: Vec<Vec<f64>>,
    /// Whether the rows belong to another session than the fitted one.
    pub is_new_session: bool,
    /// Forward model of these rows.
    pub forward: Box<dyn ForwardModel>,
}

impl fmt::Debug for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rows").field("rows", &self.len()).finish_non_exhaustive()
    }
}

impl Rows {
    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.series.len()
    }

    /// Returns whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }

    /// Returns the rows of each series.
    pub(crate) fn ranges(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (row, series) in self.series.iter().enumerate() {
            match ranges.last_mut() {
                Some(range) if self.series[range.start] == *series => range.end = row + 1,
                _ => ranges.push(row..row + 1),
            }
        }
        ranges
    }
}

/// Readings, their rows, and the space of hypotheses about them.
#[derive(Debug)]
pub struct Problem {
    pub(crate) space: Space,
    pub(crate) rows: Rows,
    pub(crate) readings: DVector<f64>,
    pub(crate) ranges: Vec<Range<usize>>,
    pub(crate) reference: NoiseReference,
    kernels_of_bases: OnceLock<Vec<KernelsOfBases>>,
}

/// Why a problem is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProblemError {
    /// The list of rows is empty.
    Empty,
    /// A list has a wrong length.
    Length {
        /// Name of the list.
        name: &'static str,
        /// Its length.
        length: usize,
        /// The length that the rows or the space require.
        expected: usize,
    },
    /// The rows of a series are not consecutive, or series are not numbered from 0.
    Series {
        /// The first such row.
        row: usize,
    },
    /// A number is not finite.
    NotFinite {
        /// Name of the list.
        name: &'static str,
        /// The first such row.
        row: usize,
    },
}

impl fmt::Display for ProblemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the list of rows is empty"),
            Self::Length { name, length, expected } => {
                write!(f, "{name}: {length} entries, but {expected} are expected")
            }
            Self::Series { row } => {
                write!(f, "row {row}: the rows of a series are not consecutive")
            }
            Self::NotFinite { name, row } => write!(f, "row {row}: {name} is not finite"),
        }
    }
}

impl std::error::Error for ProblemError {}

impl Problem {
    /// Checks readings and rows against a space.
    ///
    /// # Errors
    /// [`ProblemError`] if lengths do not agree, or a number is not finite.
    pub fn new(space: Space, rows: Rows, readings: Vec<f64>) -> Result<Self, ProblemError> {
        check_rows(&space, &rows)?;
        expect_length("readings", readings.len(), rows.len())?;
        expect_finite("reading", &readings)?;
        let ranges = rows.ranges();
        let reference = NoiseReference::of_readings(&readings, &rows);
        Ok(Self::of_parts(space, rows, DVector::from_vec(readings), ranges, reference))
    }

    /// Returns the space of hypotheses.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// Returns the problem of parts that agree.
    pub(crate) fn of_parts(
        space: Space,
        rows: Rows,
        readings: DVector<f64>,
        ranges: Vec<Range<usize>>,
        reference: NoiseReference,
    ) -> Self {
        Self { space, rows, readings, ranges, reference, kernels_of_bases: OnceLock::new() }
    }

    /// Returns the kernels by their bases, which the scores of every fit need.
    pub(crate) fn kernels_of_bases(&self) -> &[KernelsOfBases] {
        let Rows { bases, direction, .. } = &self.rows;
        self.kernels_of_bases.get_or_init(|| KernelsOfBases::new(bases, &self.ranges, direction))
    }

    /// Returns the conditions of the readings.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Returns the properties of the readings from which the priors of the noise follow.
    pub fn noise_reference(&self) -> &NoiseReference {
        &self.reference
    }

    /// Returns the number of readings.
    pub fn len(&self) -> usize {
        self.readings.len()
    }

    /// Returns whether the list of readings is empty; never true.
    pub fn is_empty(&self) -> bool {
        self.readings.is_empty()
    }
}

/// Checks the lengths of the lists of some rows.
pub(crate) fn check_rows(space: &Space, rows: &Rows) -> Result<(), ProblemError> {
    let count = rows.len();
    if count == 0 {
        return Err(ProblemError::Empty);
    }
    expect_length("direction", rows.direction.len(), count)?;
    expect_length("sessions", rows.sessions.len(), count)?;
    expect_length("order", rows.order.len(), count)?;
    expect_length("load", rows.load.len(), count)?;
    expect_length("levels", rows.levels.len(), space.random_effects.len())?;
    expect_length("bases", rows.bases.len(), space.kernels.len())?;
    expect_length("discrepancies", rows.discrepancies.len(), space.effects.len())?;
    for levels in &rows.levels {
        expect_length("levels of a random effect", levels.len(), count)?;
    }
    for (bases, kernel) in rows.bases.iter().zip(&space.kernels) {
        expect_length("bases of a kernel", bases.len(), kernel.variants.len())?;
        for basis in bases {
            expect_length("rows of a basis", basis.readings(), count)?;
        }
    }
    for effect in &space.effects {
        if effect.shape_constants > MOST_SHAPE_CONSTANTS {
            let (length, expected) = (effect.shape_constants, MOST_SHAPE_CONSTANTS);
            return Err(ProblemError::Length { name: "constants of a shape", length, expected });
        }
    }
    for effect in space.effects.iter().filter(|effect| !effect.shape_probabilities.is_empty()) {
        expect_length("shape probabilities", effect.shape_probabilities.len(), effect.starts.len())?;
    }
    expect_length("relevant", rows.relevant.len(), space.effects.len())?;
    for column in &rows.relevant {
        expect_length("relevant changes of an effect", column.len(), count)?;
    }
    for column in rows.discrepancies.iter().flatten() {
        expect_length("a discrepancy", column.len(), count)?;
    }
    for (number, range) in rows.ranges().iter().enumerate() {
        if rows.series[range.start] != number {
            return Err(ProblemError::Series { row: range.start });
        }
    }
    expect_finite("load", &rows.load)
}

fn expect_length(name: &'static str, length: usize, expected: usize) -> Result<(), ProblemError> {
    if length == expected { Ok(()) } else { Err(ProblemError::Length { name, length, expected }) }
}

fn expect_finite(name: &'static str, values: &[f64]) -> Result<(), ProblemError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(ProblemError::NotFinite { name, row }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::{problem, rows};
    use nalgebra::DMatrix;

    #[test]
    fn inconsistent_rows_are_refused() {
        let space = problem(3, 0.0).space;
        let readings = vec![1.0; 15];
        let with = |change: &dyn Fn(&mut Rows)| {
            let mut rows = rows(3);
            change(&mut rows);
            Problem::new(space.clone(), rows, readings.clone()).unwrap_err()
        };
        assert_eq!(
            with(&|rows| rows.load.truncate(14)),
            ProblemError::Length { name: "load", length: 14, expected: 15 }
        );
        assert_eq!(with(&|rows| rows.series[14] = 0), ProblemError::Series { row: 14 });
        assert_eq!(with(&|rows| rows.load[3] = f64::NAN), ProblemError::NotFinite { name: "load", row: 3 });
        let empty = with(&|rows| rows.series.clear());
        assert_eq!(empty, ProblemError::Empty);
    }

    /// Three sessions of two readings: a new one has the last row of a basis, the mean of its rows, or the first one.
    #[test]
    fn a_new_session_has_the_expected_row() {
        let basis =
            Basis::from(DMatrix::from_row_slice(6, 2, &[0., 3., 0., 3., 6., 0., 6., 0., 0., 9., 0., 9.]));
        assert_eq!(SessionLevels::RandomWalk.expected_row(&basis), [0.0, 9.0]);
        assert_eq!(SessionLevels::OneChange(3).expected_row(&basis), [0.0, 9.0]);
        assert_eq!(SessionLevels::Independent.expected_row(&basis), [2.0, 4.0]);
        assert_eq!(SessionLevels::OneSession(3).expected_row(&basis), [0.0, 3.0]);
    }
}
