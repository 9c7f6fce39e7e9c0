//! Levels of a factor of the protocol, as the forms of a kernel.

use std::collections::BTreeSet;
use std::ops::Range;
use std::rc::Rc;

use pinswitch_inference::kernel;

use super::covariates::{Covariates, RowLabels};
use super::groups::Groups;
use super::variant::{BasisOfRows, Variant};

/// Name of the level of a factor at a row.
pub(super) type LevelOfRow = dyn Fn(&RowFactors, &RowLabels) -> String;

/// Levels of a factor in a table.
pub(super) struct Levels {
    /// Sorted names.
    names: Rc<Vec<String>>,
    of_row: Rc<LevelOfRow>,
    groups: Groups,
}

impl Levels {
    pub(super) fn new(rows: &Covariates, of_row: Rc<LevelOfRow>) -> Self {
        let of_rows = names_of(rows, &*of_row);
        let groups = Groups::new(rows, |row| of_rows[row].as_str());
        let mut names = names_of(&groups.firsts, &*of_row);
        names.sort_unstable();
        Self { names: Rc::new(names), of_row, groups }
    }

    pub(super) fn count(&self) -> usize {
        self.names.len()
    }

    /// Returns whether each of several levels has one level of the other factor only, so that a function of that is one of these.
    pub(super) fn determine(&self, other: &Self) -> bool {
        let (own, of_other) = (&self.groups.of_row, &other.groups.of_row);
        let pairs: BTreeSet<(u32, u32)> = own.iter().copied().zip(of_other.iter().copied()).collect();
        self.count() > 1 && pairs.len() == self.count()
    }

    /// Returns independent levels and, with a probability, one level that differs from the others: a faulty part or a wrong
    /// reading, which independent levels price as many differences. Of two levels either one differs.
    pub(super) fn variants(&self, of_one: f64) -> Vec<Variant> {
        let count = self.names.len();
        let of_one = if count < 3 { 0.0 } else { of_one };
        let mut variants = Vec::new();
        if of_one < 1.0 {
            variants.extend(Variant::of_groups(self.columns(0..count), &self.groups, 1.0 - of_one));
        }
        if of_one > 0.0 {
            let one = |at| Variant::as_is(self.columns(at..at + 1), &self.groups, of_one / count as f64);
            variants.extend((0..count).map(one));
        }
        variants
    }

    /// Returns a basis with a column for each of these levels.
    fn columns(&self, levels: Range<usize>) -> BasisOfRows {
        let (names, of_row) = (self.names.clone(), self.of_row.clone());
        Rc::new(move |rows| {
            let column = |name: &String| {
                let at = names.binary_search(name).ok().filter(|at| levels.contains(at))?;
                Some(at - levels.start)
            };
            kernel::levels(&names_of(rows, &*of_row).iter().map(column).collect::<Vec<_>>(), levels.len())
        })
    }
}

/// Numbers of a row that may be levels of a factor.
pub(super) struct RowFactors {
    pub(super) wrap_deg: f64,
    pub(super) load_n: f64,
    /// Share of the stroke.
    pub(super) position: f64,
    /// Repetition, negative in the eccentric direction.
    pub(super) directed_repetition: f64,
}

fn names_of(rows: &Covariates, level: &LevelOfRow) -> Vec<String> {
    let factors = |i: usize| RowFactors {
        wrap_deg: rows.wrap_deg[i],
        load_n: rows.points[i].load_n,
        position: rows.points[i].position,
        directed_repetition: rows.points[i].sign * rows.points[i].repetition,
    };
    (0..rows.len()).map(|i| level(&factors(i), &rows.labels[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Frame;
    use crate::test_session::session;

    /// Forms of a factor share its probability; of two levels either one differs, so that one form is enough.
    #[test]
    fn one_level_may_differ_from_three_on() {
        let mut rows = session(3);
        let covariates = |rows: &[_]| Covariates::new(&Frame::new(rows), rows).unwrap();
        for (count, of_one, forms) in [(2, 0.5, 1), (3, 0.5, 4), (3, 1.0, 3), (5, 0.5, 6)] {
            let operator = |(i, row): (usize, &mut crate::table::PlateauRow)| {
                row.labels.operator = format!("operator {}", i % count);
            };
            rows.iter_mut().enumerate().for_each(operator);
            let name = |_: &RowFactors, label: &RowLabels| label.operator.clone();
            let levels = Levels::new(&covariates(&rows), Rc::new(name));
            let variants = levels.variants(of_one);
            let total: f64 = variants.iter().map(|variant| variant.probability).sum();
            assert_eq!((levels.count(), variants.len()), (count, forms));
            assert!((total - 1.0).abs() < 1e-12, "{total}");
            let last = &variants[forms - 1].fitted;
            let is_one = |row: &usize| last.at(*row).iter().any(|x| *x != 0.0);
            let share = (0..rows.len()).filter(is_one).count() as f64 / rows.len() as f64;
            let expected = if forms == 1 { 1.0 } else { 1.0 / count as f64 };
            assert!((share - expected).abs() < 0.05, "{share} of {count}");
        }
    }

    #[test]
    fn levels_determine_coarser_ones() {
        let mut rows = session(3);
        rows.iter_mut().enumerate().for_each(|(i, row)| {
            row.labels.operator = format!("{}", i % 6);
            row.labels.specimen = format!("{}", i % 3);
        });
        let covariates = Covariates::new(&Frame::new(&rows), &rows).unwrap();
        let levels = |name: fn(&RowLabels) -> &String| {
            Levels::new(&covariates, Rc::new(move |_: &RowFactors, label: &RowLabels| name(label).clone()))
        };
        let (fine, coarse) = (levels(|label| &label.operator), levels(|label| &label.specimen));
        assert!(fine.determine(&coarse) && !coarse.determine(&fine));
    }
}
