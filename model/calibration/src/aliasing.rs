//! Confounded covariates of a table.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use pinswitch_measurements::{correlation, ranks};

use crate::table::PlateauRow;

/// Correlation above which two covariates count as confounded.
const TOGETHER: f64 = 0.95;

/// Two confounded covariates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Aliasing {
    /// Names of the covariates.
    pub covariates: [String; 2],
    /// Correlation of the values or of their ranks, whichever is larger in magnitude. For the
    /// unordered condition, the correlation ratio, corrected for the number of conditions.
    pub correlation: f64,
}

/// A covariate of a row with its name.
type Column = (&'static str, fn(&PlateauRow) -> f64);

/// Returns all confounded pairs of a table.
pub fn aliasing(rows: &[PlateauRow]) -> Vec<Aliasing> {
    let columns: [Column; 8] = [
        ("load", |r| r.load_n),
        ("direction", |r| r.direction.sign()),
        ("repetition", |r| f64::from(r.repetition)),
        ("position", |r| r.position_mm),
        ("speed", |r| r.speed_pct),
        ("dwell", |r| r.dwell_s),
        ("sweep", |r| f64::from(u8::from(r.sweep == crate::table::Sweep::Down))),
        ("time", |r| r.time_s),
    ];
    let values: Vec<(&str, Vec<f64>, Vec<f64>)> = columns
        .iter()
        .map(|(name, of)| {
            let values: Vec<f64> = rows.iter().map(of).collect();
            let ranks = ranks(&values);
            (*name, values, ranks)
        })
        .collect();
    let mut found = Vec::new();
    for (i, (a, values_a, ranks_a)) in values.iter().enumerate() {
        for (b, values_b, ranks_b) in &values[i + 1..] {
            let (plain, ranked) = (correlation(values_a, values_b), correlation(ranks_a, ranks_b));
            let correlation = if ranked.abs() > plain.abs() { ranked } else { plain };
            if correlation.abs() > TOGETHER {
                found.push(Aliasing { covariates: [(*a).to_owned(), (*b).to_owned()], correlation });
            }
        }
    }
    let conditions = conditions(rows);
    for (name, values, _) in &values {
        let correlation = correlation_ratio(&conditions, values);
        if correlation > TOGETHER {
            found.push(Aliasing { covariates: ["condition".to_owned(), (*name).to_owned()], correlation });
        }
    }
    found
}

/// Returns the index of each row's condition.
fn conditions(rows: &[PlateauRow]) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    rows.iter()
        .map(|r| {
            let next = numbers.len();
            *numbers.entry((r.substrate.map(|s| s as u8), r.pins.as_slice())).or_insert(next)
        })
        .collect()
}

/// Returns the correlation ratio `sqrt(1 - V_within/V_all)` with unbiased variances, so that many
/// small groups explain nothing by chance (Kelley's epsilon, 1935); zero if the values do not vary.
fn correlation_ratio(group: &[usize], values: &[f64]) -> f64 {
    let groups = group.iter().max().map_or(0, |most| most + 1);
    let (mut sum, mut count) = (vec![0.0; groups], vec![0.0; groups]);
    for (g, v) in group.iter().zip(values) {
        sum[*g] += v;
        count[*g] += 1.0;
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n.max(1.0);
    let within: f64 = group.iter().zip(values).map(|(g, v)| (v - sum[*g] / count[*g]).powi(2)).sum();
    let all: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let free = n - groups as f64;
    if groups < 2 || free <= 0.0 || all <= 0.0 {
        return 0.0;
    }
    (1.0 - (within / free) / (all / (n - 1.0))).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_session::session;

    #[test]
    fn speed_that_follows_load_is_confounded() {
        let mut rows = session(1);
        // The conditions of the test session are consecutive; this clock makes them independent of
        // time.
        rows.iter_mut().enumerate().for_each(|(i, r)| r.time_s = ((i * 7919) % 1009) as f64);
        assert!(aliasing(&rows).is_empty(), "{:?}", aliasing(&rows));
        rows.iter_mut().for_each(|r| r.speed_pct = 40.0 + r.load_n.powi(3) * 1e-4);
        let found = aliasing(&rows);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].covariates, ["load", "speed"]);
        assert!(found[0].correlation > 0.999, "the ranks are equal");
    }

    #[test]
    fn consecutive_conditions_are_confounded_with_time() {
        let rows = session(1);
        let found = aliasing(&rows);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].covariates, ["condition", "time"]);
        // Five equal parts of the time: a share 1 - 1/25 of the variance is between them.
        assert!((found[0].correlation - 0.96f64.sqrt()).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn groups_of_one_row_explain_nothing() {
        let values: Vec<f64> = (0..40).map(|i| f64::from((i * 17) % 41)).collect();
        let alone: Vec<usize> = (0..40).collect();
        assert_eq!(correlation_ratio(&alone, &values), 0.0);
        let pairs: Vec<usize> = (0..40).map(|i| i / 2).collect();
        assert!(correlation_ratio(&pairs, &values) < 0.6, "by chance");
        assert_eq!(correlation_ratio(&[0; 40], &values), 0.0);
        assert_eq!(correlation_ratio(&pairs, &[1.0; 40]), 0.0);
    }
}
