//! `[sample]`: seeded samples, either a Latin hypercube (McKay, Beckman and Conover 1979) or
//! independent random points.

use std::sync::OnceLock;

use pinswitch_diagnostic::{Diagnostic, codes};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use toml_edit::{Item, TableLike};

use super::values::{self, Sampler};
use super::{AxisTable, SweepAxis, fields};
use crate::diagnostics::field_error;
use crate::source::SweepSource;

/// The table of a sample: one axis with a row for each point.
pub(super) const TABLE: AxisTable =
    AxisTable { name: "sample", keys: &["method", "count", "seed", "axes"], level: 2, read };

/// Most points; a larger count is taken for a typing error.
const MAX_COUNT: usize = 10_000_000;

/// Sampling method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Each axis is divided into as many strata as there are points, and each stratum contains one
    /// point.
    LatinHypercube,
    /// Independent, uniformly distributed coordinates.
    Random,
}

/// Every method with its word, the default first.
pub(crate) const METHODS: [(&str, Method); 2] =
    [("latin-hypercube", Method::LatinHypercube), ("random", Method::Random)];

/// Points of the unit cube. The same seed gives the same points on every machine.
///
/// Points are generated on request; only the order of the strata is kept, in four bytes per point
/// and axis.
#[derive(Debug)]
struct UnitPoints {
    method: Method,
    count: usize,
    axes: usize,
    seed: u64,
    axis_draws: OnceLock<Vec<AxisDraw>>,
}

/// The coordinates along one axis.
#[derive(Debug)]
struct AxisDraw {
    /// The stratum of every point; empty for independent points.
    strata: Vec<u32>,
    /// The generator in front of the first coordinate.
    random: ChaCha8Rng,
}

/// Words of the generator per coordinate.
const WORDS_PER_COORDINATE: u128 = 2;

impl UnitPoints {
    fn new(method: Method, count: usize, axes: usize, seed: u64) -> Self {
        Self { method, count, axes, seed, axis_draws: OnceLock::new() }
    }

    fn axis_draws(&self) -> &[AxisDraw] {
        self.axis_draws.get_or_init(|| {
            let mut random = ChaCha8Rng::seed_from_u64(self.seed);
            (0..self.axes)
                .map(|_| {
                    let mut strata = Vec::new();
                    if self.method == Method::LatinHypercube {
                        strata.extend((0..self.count).map(|i| u32::try_from(i).unwrap_or(u32::MAX)));
                        strata.shuffle(&mut random);
                    }
                    let draw = AxisDraw { strata, random: random.clone() };
                    random.set_word_pos(random.get_word_pos() + WORDS_PER_COORDINATE * self.count as u128);
                    draw
                })
                .collect()
        })
    }

    /// Returns the point with this index, which is below the count.
    fn point(&self, index: u64) -> Vec<f64> {
        let coordinate = |draw: &AxisDraw| {
            let mut random = draw.random.clone();
            random.set_word_pos(random.get_word_pos() + WORDS_PER_COORDINATE * u128::from(index));
            let within: f64 = random.random();
            match usize::try_from(index).ok().and_then(|i| draw.strata.get(i)) {
                #[allow(clippy::cast_precision_loss)]
                Some(stratum) => (f64::from(*stratum) + within) / self.count as f64,
                None => within,
            }
        };
        self.axis_draws().iter().map(coordinate).collect()
    }
}

/// Returns `count` points of the unit cube in `axes` dimensions. The same seed gives the same
/// points on every machine.
pub fn unit_points(method: Method, count: usize, axes: usize, seed: u64) -> Vec<Vec<f64>> {
    let points = UnitPoints::new(method, count, axes, seed);
    (0..count as u64).map(|index| points.point(index)).collect()
}

fn read(source: &SweepSource, item: &Item) -> Result<Vec<SweepAxis>, Diagnostic> {
    let Some(table) = item.as_table_like() else { return Ok(Vec::new()) };
    for entry in fields(table.get("axes").and_then(Item::as_table_like)) {
        entry.field(source)?;
    }
    let axis = axis(table).map_err(|e| source.locate(e, item.span()))?;
    Ok(vec![axis])
}

fn axis(table: &dyn TableLike) -> Result<SweepAxis, Diagnostic> {
    let whole = |key: &str| table.get(key).and_then(Item::as_integer);
    let word = table.get("method").and_then(Item::as_str).unwrap_or(METHODS[0].0);
    let Some((_, method)) = METHODS.into_iter().find(|(known, _)| *known == word) else {
        let value = format!("{word:?}");
        let help = "give \"latin-hypercube\" or \"random\"";
        return Err(field_error(codes::UNKNOWN_WORD, "sample.method", Some(&value), "unknown method", help));
    };
    let count = whole("count").and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    if count > MAX_COUNT {
        let value = count.to_string();
        let problem = format!("more than {MAX_COUNT} points");
        return Err(field_error(codes::TOO_MANY_ENTRIES, "sample.count", Some(&value), problem, "lower it"));
    }
    let seed = whole("seed").unwrap_or(0).unsigned_abs();
    let axes = fields(table.get("axes").and_then(Item::as_table_like));
    sample(method, count, seed, axes.iter().map(|entry| (entry.path.as_str(), entry.item)))
}

/// Samples `axes`: lists are choices; ranges are continuous, or a grid if they have a `step`.
///
/// # Errors
/// An axis that cannot be sampled, and a sample without points or axes.
fn sample<'a>(
    method: Method,
    count: usize,
    seed: u64,
    axes: impl Iterator<Item = (&'a str, &'a Item)>,
) -> Result<SweepAxis, Diagnostic> {
    let mut fields = Vec::new();
    let mut samplers: Vec<Sampler> = Vec::new();
    for (path, item) in axes {
        let field = super::field(path)?;
        samplers.push((values::notation(field, item)?.sampler)(field, item)?);
        fields.push(field);
    }
    if fields.is_empty() || count == 0 {
        let error = Diagnostic::new(codes::INVALID_AXIS, "the sample has no points or no axes");
        return Err(error.with_help("give sample.count and at least one field under [sample.axes]"));
    }
    let points = UnitPoints::new(method, count, fields.len(), seed);
    // The ends of every range were checked above, and all values between them are valid.
    Ok(SweepAxis::new(fields, count as u64, move |index| {
        points.point(index).iter().zip(&samplers).map(|(share, sampler)| sampler(*share)).collect()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn each_stratum_contains_one_point(count in 1usize..60, axes in 1usize..6, seed: u64) {
            let points = unit_points(Method::LatinHypercube, count, axes, seed);
            for axis in 0..axes {
                let mut strata: Vec<_> = points.iter().map(|p| (p[axis] * count as f64) as usize).collect();
                strata.sort_unstable();
                prop_assert_eq!(strata, (0..count).collect::<Vec<_>>());
            }
        }
    }

    /// The same points, generated all at once in their order.
    fn points_in_order(method: Method, count: usize, axes: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut points = vec![vec![0.0; axes]; count];
        for axis in 0..axes {
            let mut strata: Vec<usize> = (0..count).collect();
            if method == Method::LatinHypercube {
                strata.shuffle(&mut random);
            }
            for (point, stratum) in points.iter_mut().zip(strata) {
                let within: f64 = random.random();
                point[axis] = match method {
                    Method::LatinHypercube => (stratum as f64 + within) / count as f64,
                    Method::Random => within,
                };
            }
        }
        points
    }

    #[test]
    fn single_points_equal_the_sequence() {
        for method in [Method::LatinHypercube, Method::Random] {
            for (count, axes, seed) in [(1, 1, 0), (2, 3, 9), (17, 4, 1), (1000, 2, 5)] {
                assert_eq!(
                    unit_points(method, count, axes, seed),
                    points_in_order(method, count, axes, seed)
                );
            }
        }
    }

    #[test]
    fn seeds_determine_points() {
        let points = |seed| unit_points(Method::Random, 5, 2, seed);
        assert_eq!(points(1), points(1));
        assert_ne!(points(1), points(2));
    }

    #[test]
    fn samples_respect_ranges_and_grids() {
        let width: Item = Item::Value("{ from = 10, to = 12.3, step = 0.5 }".parse().unwrap());
        let slots: Item = Item::Value("[\"all\", \"occupied\"]".parse().unwrap());
        let axes = [("shell.width_mm", &width), ("support.slots", &slots)];
        let axis = sample(Method::LatinHypercube, 40, 3, axes.into_iter()).unwrap();
        let rows: Vec<_> = (0..axis.count()).map(|i| axis.row(i)).collect();
        for row in &rows {
            let x = row[0].as_float().unwrap();
            assert!((10.0..=12.0).contains(&x) && (x * 2.0).fract() == 0.0, "{x}");
        }
        assert_eq!(rows.iter().filter(|r| r[1].as_str() == Some("all")).count(), 20);
    }
}
