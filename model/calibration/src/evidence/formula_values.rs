//! Values of the formulas of effects at all rows of a table, which a search needs again and again: the derivatives of a design
//! change one constant at a time, and the candidates of every expansion start from the same constants.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Most numbers that are kept.
const MOST_NUMBERS: usize = 1 << 20;

/// An effect by its number, and the bits of its constants.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    effect: usize,
    constants: Vec<u64>,
}

/// Values by effect and constants at the rows of one table. Those that were not used for the longest time are forgotten. A clone
/// knows none, since it may be for other rows.
#[derive(Debug, Default)]
pub(super) struct FormulaValues(Mutex<Known>);

#[derive(Debug, Default)]
struct Known {
    values: HashMap<Key, (u64, Arc<[f64]>)>,
    uses: u64,
}

impl Clone for FormulaValues {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl FormulaValues {
    /// Returns the values of an effect at all rows; `compute` returns them if they are not known.
    pub(super) fn of(
        &self,
        effect: usize,
        constants: &[f64],
        compute: impl FnOnce() -> Vec<f64>,
    ) -> Arc<[f64]> {
        let key = Key { effect, constants: constants.iter().map(|k| k.to_bits()).collect() };
        if let Some(values) = self.known().used(&key) {
            return values;
        }
        let values: Arc<[f64]> = compute().into();
        self.known().keep(key, values.clone());
        values
    }

    fn known(&self) -> std::sync::MutexGuard<'_, Known> {
        // Values are kept whole or not at all, so that a panic elsewhere leaves none that are wrong.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Known {
    fn used(&mut self, key: &Key) -> Option<Arc<[f64]>> {
        self.uses += 1;
        let (last, values) = self.values.get_mut(key)?;
        *last = self.uses;
        Some(values.clone())
    }

    fn keep(&mut self, key: Key, values: Arc<[f64]>) {
        let most = (MOST_NUMBERS / values.len().max(1)).max(1);
        while self.values.len() >= most {
            let oldest = self.values.iter().min_by_key(|(_, (last, _))| *last).map(|(key, _)| key.clone());
            let Some(oldest) = oldest else { break };
            self.values.remove(&oldest);
        }
        self.values.insert(key, (self.uses, values));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_computed_once_for_an_effect_and_its_constants() {
        let values = FormulaValues::default();
        assert_eq!(*values.of(2, &[0.5], || vec![1.0, 2.0]), [1.0, 2.0]);
        assert_eq!(*values.of(2, &[0.5], || unreachable!("known")), [1.0, 2.0]);
        assert_eq!(*values.of(3, &[0.5], || vec![3.0]), [3.0]);
        assert_eq!(*values.of(2, &[-0.5], || vec![4.0]), [4.0]);
        assert_eq!(*values.clone().of(2, &[0.5], || vec![5.0]), [5.0]);
    }

    #[test]
    fn the_values_that_were_not_used_for_the_longest_time_are_forgotten() {
        let values = FormulaValues::default();
        let half = || vec![0.0; MOST_NUMBERS / 2];
        values.of(0, &[], half);
        values.of(1, &[], half);
        values.of(0, &[], || unreachable!("known"));
        values.of(2, &[], half);
        values.of(0, &[], || unreachable!("used more recently than 1"));
        let mut is_forgotten = false;
        values.of(1, &[], || {
            is_forgotten = true;
            half()
        });
        assert!(is_forgotten);
    }
}
