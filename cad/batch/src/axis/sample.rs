//! `[sample]`: seeded samples, Latin hypercube (McKay, Beckman and Conover 1979) and plain random.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use toml_edit::{Item, TableLike};

use super::values::{self, Sampler};
use super::{AxisTable, SweepAxis, accepted, config_error, fields};
use crate::source::SweepSource;
use pinswitch_switch::config::ConfigError;

/// The table of a sample: one axis of as many rows as it has points.
pub(super) const TABLE: AxisTable =
    AxisTable { name: "sample", keys: &["method", "count", "seed", "axes"], level: 2, read };

/// Number of points beyond which a count is taken for a typing error.
const MAX_COUNT: usize = 10_000_000;

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every axis is cut into as many strata as there are points, and each stratum holds one point.
    LatinHypercube,
    /// Every coordinate on its own.
    Random,
}

/// `count` points of the unit cube in `axes` dimensions; the same seed gives the same points on every machine.
pub fn unit_points(method: Method, count: usize, axes: usize, seed: u64) -> Vec<Vec<f64>> {
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
                #[allow(clippy::cast_precision_loss)]
                Method::LatinHypercube => (stratum as f64 + within) / count as f64,
                Method::Random => within,
            };
        }
    }
    points
}

fn read(source: &SweepSource, item: &Item) -> Result<Vec<SweepAxis>, ConfigError> {
    let Some(table) = item.as_table_like() else { return Ok(Vec::new()) };
    let axis = sampled(table).map_err(|e| e.at(source.place(item.span())))?;
    Ok(vec![axis])
}

fn sampled(table: &dyn TableLike) -> Result<SweepAxis, ConfigError> {
    let whole = |key: &str| table.get(key).and_then(Item::as_integer);
    let method = match table.get("method").and_then(Item::as_str) {
        Some("latin-hypercube") | None => Method::LatinHypercube,
        Some("random") => Method::Random,
        Some(other) => {
            let value = format!("{other:?}");
            let remedy = "give \"latin-hypercube\" or \"random\"";
            return Err(config_error("sample.method", Some(&value), "is no method", remedy));
        }
    };
    let count = whole("count").and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    if count > MAX_COUNT {
        let value = count.to_string();
        return Err(config_error("sample.count", Some(&value), "is over ten million", "lower it"));
    }
    let seed = whole("seed").unwrap_or(0).unsigned_abs();
    let axes = fields(table.get("axes").and_then(Item::as_table_like));
    sample(method, count, seed, axes.iter().map(|(path, item)| (path.as_str(), *item)))
}

/// The rows of a sample over `axes`: lists are choices, ranges are continuous, on a grid if they give `step`.
///
/// # Errors
/// [`ConfigError`] for an axis that cannot be sampled.
fn sample<'a>(
    method: Method,
    count: usize,
    seed: u64,
    axes: impl Iterator<Item = (&'a str, &'a Item)>,
) -> Result<SweepAxis, ConfigError> {
    let mut fields = Vec::new();
    let mut samplers: Vec<Sampler> = Vec::new();
    for (path, item) in axes {
        let field = super::field(path)?;
        samplers.push((values::kind(field, item)?.sampler)(field, item)?);
        fields.push(field);
    }
    if fields.is_empty() || count == 0 {
        return Err(config_error(
            "sample",
            None,
            "is empty",
            "give count and at least one field under [sample.axes]",
        ));
    }
    let rows = unit_points(method, count, fields.len(), seed)
        .into_iter()
        .map(|point| {
            let coordinates = point.iter().zip(&samplers).zip(&fields);
            coordinates.map(|((share, sampler), field)| accepted(field, &sampler(*share))).collect()
        })
        .collect::<Result<_, _>>()?;
    Ok(SweepAxis { fields, rows })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_latin_hypercube_puts_one_point_in_every_stratum(count in 1usize..60, axes in 1usize..6, seed: u64) {
            let points = unit_points(Method::LatinHypercube, count, axes, seed);
            for axis in 0..axes {
                let mut strata: Vec<_> = points.iter().map(|p| (p[axis] * count as f64) as usize).collect();
                strata.sort_unstable();
                prop_assert_eq!(strata, (0..count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn the_seed_decides() {
        let draw = |seed| unit_points(Method::Random, 5, 2, seed);
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }

    #[test]
    fn values_lie_in_their_ranges_and_on_their_grid() {
        let width: Item = Item::Value("{ from = 10, to = 12.3, step = 0.5 }".parse().unwrap());
        let slots: Item = Item::Value("[\"all\", \"occupied\"]".parse().unwrap());
        let axes = [("shell.width_mm", &width), ("support.slots", &slots)];
        let level = sample(Method::LatinHypercube, 40, 3, axes.into_iter()).unwrap();
        for row in &level.rows {
            let x = row[0].as_float().unwrap();
            assert!((10.0..=12.0).contains(&x) && (x * 2.0).fract() == 0.0, "{x}");
        }
        assert_eq!(level.rows.iter().filter(|r| r[1].as_str() == Some("all")).count(), 20);
    }
}
