//! Tables of every kind of rig of the study are plausible.

use pinswitch_calibration::table::PlateauTable;
use pinswitch_simulation::{plan_of, simulate, study_cases};

/// Covers every kind of rig of the study, including effects and disturbances.
#[test]
fn study_tables_are_plausible() {
    for case in study_cases() {
        for seed in [901, 902] {
            let rows = simulate(&plan_of(&case, seed)).rows;
            let table = PlateauTable::read(PlateauTable::write(&rows).as_bytes(), "t.csv");
            table
                .and_then(|table| table.require_baseline("t.csv"))
                .unwrap_or_else(|e| panic!("{} {seed}: {e}", case.name));
        }
    }
}
