//! Groups of rows with equal values of a basis, which is evaluated once for each.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

use super::covariates::Covariates;

/// Groups of the rows of a table.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    /// First row of each group.
    pub(super) firsts: Covariates,
    /// Number of its rows.
    pub(super) counts: Vec<f64>,
    /// Group of each row.
    pub(super) of_row: Arc<[u32]>,
}

impl Groups {
    /// Groups rows by a key.
    pub(super) fn new<K: Eq + Hash>(rows: &Covariates, key: impl Fn(usize) -> K) -> Self {
        let (mut firsts, mut counts, mut of_row) = (Vec::new(), Vec::new(), Vec::new());
        let mut known: HashMap<K, usize> = HashMap::new();
        for row in 0..rows.len() {
            let group = *known.entry(key(row)).or_insert(firsts.len());
            if group == firsts.len() {
                firsts.push(row);
                counts.push(0.0);
            }
            counts[group] += 1.0;
            of_row.push(u32::try_from(group).unwrap_or(u32::MAX));
        }
        Self { firsts: rows.select(&firsts), counts, of_row: of_row.into() }
    }
}
