//! Columns of a wide table that are named by their trial alone, such as `Trial 1` or `1`.

use std::collections::BTreeSet;

use crate::column::Column;
use crate::name;
use crate::quantity::Quantity;
use crate::sheet::Sheet;
use crate::vocabulary::words;

/// Words for one of several readings.
const READINGS: [&str; 10] = [
    "reading",
    "measurement",
    "measure",
    "value",
    "messung",
    "messwert",
    "wert",
    "mesure",
    "medida",
    "misura",
];

/// Returns the number of a trial that is all of a name, in addition to words for a trial.
pub(crate) fn trial(text: &str) -> Option<u32> {
    let words: Vec<String> = words(text).into_iter().filter(|word| !word.is_empty()).collect();
    let (numbers, others): (Vec<&String>, Vec<&String>) =
        words.iter().partition(|word| word.chars().all(|c| c.is_ascii_digit()));
    let [number] = numbers.as_slice() else { return None };
    let is_trial = |word: &&String| {
        READINGS.contains(&word.as_str()) || name::read(word, None).quantity == Some(Quantity::Repetition)
    };
    others.iter().all(is_trial).then(|| number.parse().ok()).flatten()
}

/// Reads columns that are named by different trials as the force, if no column is the force and
/// others show what differs from row to row. Their unit remains a question.
pub(crate) fn find_trials(columns: &mut [Column]) {
    count_decided(columns);
    let has = |quantity| columns.iter().any(|column| column.quantity == quantity);
    let has_rows = [Quantity::Load, Quantity::LoadMass, Quantity::Direction, Quantity::WrapAngle];
    if has(Quantity::Force) || !has_rows.into_iter().any(has) {
        return;
    }
    let is_open = |column: &Column| {
        !column.is_decided && matches!(column.quantity, Quantity::Repetition | Quantity::Ignore)
    };
    let trials: Vec<(usize, u32)> = (columns.iter().enumerate())
        .filter(|(_, column)| is_open(column))
        .filter_map(|(i, column)| Some((i, trial(&column.name)?)))
        .collect();
    let different: BTreeSet<u32> = trials.iter().map(|(_, trial)| *trial).collect();
    if trials.len() < 2 || different.len() < trials.len() {
        return;
    }
    for (i, trial) in trials {
        columns[i].quantity = Quantity::Force;
        columns[i].repetition = Some(trial);
    }
}

/// Columns that a person declared as forces, and that are named by different trials, are those trials.
fn count_decided(columns: &mut [Column]) {
    let is_decided = |column: &Column| column.is_decided && column.quantity == Quantity::Force;
    let trials: Vec<(usize, u32)> = (columns.iter().enumerate())
        .filter(|(_, column)| is_decided(column) && !column.is_wide())
        .filter_map(|(i, column)| Some((i, trial(&column.name)?)))
        .collect();
    let different: BTreeSet<u32> = trials.iter().map(|(_, trial)| *trial).collect();
    if different.len() > 1 && different.len() == trials.len() {
        trials.into_iter().for_each(|(i, trial)| columns[i].repetition = Some(trial));
    }
}

/// Whether a row names quantities and counts trials: its numbers are 1, 2, 3 and so on.
pub(crate) fn counts_trials(sheet: &Sheet, row: usize) -> bool {
    let (mut next, mut named) = (1u32, false);
    for cell in sheet.row(row).map(str::trim) {
        if cell == next.to_string() {
            next += 1;
        } else if cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) {
            return false;
        } else {
            named |= name::read(cell, None).quantity.is_some();
        }
    }
    named && next > 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_are_all_of_their_name() {
        for (name, expected) in [
            ("Trial 1", Some(1)),
            ("trial_12", Some(12)),
            ("3", Some(3)),
            ("Repetition", None),
            ("Trial 1 of 3", None),
            ("Reading 2", Some(2)),
            ("Messwert3", Some(3)),
            ("Temperature 1", None),
            ("1.5", None),
        ] {
            assert_eq!(trial(name), expected, "{name}");
        }
    }
}
