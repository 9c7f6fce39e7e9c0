//! Plausibility of a table's loads and readings, checked before any fit.

use std::ops::RangeInclusive;

use pinswitch_friction::published::GRAVITY_M_S2;

use super::follows::Following;
use super::friction_gap::{Friction, friction};
use super::plateau_table::PlateauTable;
use super::row::PlateauRow;
use super::swapped_columns::{Swapped, evident, repairing};
use super::table_error::TableError;
use super::units::implausible;
use super::whole_series::inconsistent_series;
use crate::median::median;
use pinswitch_friction::sort_by_number;

/// Plausible ratio of declared load to weight of the declared mass; the margin is for hooks and
/// levers.
const WEIGHS: RangeInclusive<f64> = 0.5..=2.0;

impl PlateauTable {
    /// Refuses a table that cannot determine a baseline or that no rig can have measured. A single
    /// odd condition or series is left to the fit, which detects it.
    ///
    /// # Errors
    /// [`TableError::TooFewLoads`] with fewer than two loads above zero, unless a `plain` contact has two angles,
    /// [`TableError::SwappedColumns`] if two columns are swapped, [`TableError::Unrelated`] if the
    /// readings do not follow the loads in most conditions, [`TableError::LoadUnit`] if loads and
    /// masses contradict each other, [`TableError::NoFriction`] if the directions differ nowhere,
    /// [`TableError::SwappedDirections`] if their labels are swapped in most conditions; other
    /// variants for units and directions of tables without masses or without a second direction,
    /// and for single series.
    pub fn require_baseline(&self, file: &str) -> Result<(), TableError> {
        let distinct = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
            values.len()
        };
        let loaded = self.rows.iter().filter(|r| r.load_n > 0.0);
        let loads = distinct(loaded.clone().map(|r| r.load_n).collect());
        // One load at several angles determines the friction coefficient of a capstan.
        let plain = loaded.filter(|r| r.substrate.is_none());
        let wraps = distinct(plain.map(|r| r.wrap_angle_deg).collect());
        let needed = 2;
        let file = file.to_owned();
        let swapped = |Swapped { first, second, evidence }| TableError::SwappedColumns {
            file: file.clone(),
            first,
            second,
            evidence,
        };
        if let Some(columns) = evident(&self.rows) {
            return Err(swapped(columns));
        }
        if loads.max(wraps) < needed {
            let last_line = self.rows.len() + 1;
            return Err(TableError::TooFewLoads { file, last_line, found: loads, needed });
        }
        if let Some(error) = self.contradiction(&file) {
            return Err(repairing(&self.rows).map_or(error, swapped));
        }
        implausible(&self.rows, &file).or_else(|| inconsistent_series(&self.rows, &file)).map_or(Ok(()), Err)
    }

    /// Returns a contradiction that no rig can have measured.
    fn contradiction(&self, file: &str) -> Option<TableError> {
        let file = file.to_owned();
        let following = Following::new(&self.rows, |r| r.load_n, |r| r.force_n);
        if following.is_astray() {
            let Following { judged, astray, slope, correlation, bounds } = following;
            return Some(TableError::Unrelated {
                file,
                slope,
                correlation,
                bounds,
                conditions: astray,
                of: judged,
            });
        }
        if let Some(factor) = self.newtons_per_weight().filter(|factor| !WEIGHS.contains(factor)) {
            return Some(TableError::LoadUnit { file, factor, bounds: WEIGHS });
        }
        match friction(&self.rows, |r| r.load_n, |r| r.force_n) {
            Friction::Measured => None,
            Friction::Nowhere(conditions) => Some(TableError::NoFriction { file, conditions }),
            Friction::Backwards { backwards, judged, example } => Some(TableError::SwappedDirections {
                file,
                conditions: backwards,
                of: judged,
                load_n: example.load_n,
                concentric_n: example.concentric_n,
                eccentric_n: example.eccentric_n,
            }),
        }
    }

    /// Returns declared load over weight of `load_mass_g`, as the median over the heaviest quarter
    /// of the rows, where a hook adds little; `None` if no mass is given.
    fn newtons_per_weight(&self) -> Option<f64> {
        let mut rows: Vec<&PlateauRow> = self.rows.iter().collect();
        sort_by_number(&mut rows, |r| -r.load_n);
        let weight_n = |r: &PlateauRow| r.load_mass_g * 1e-3 * GRAVITY_M_S2;
        let mut factors: Vec<f64> = rows[..rows.len().div_ceil(4)]
            .iter()
            .filter(|r| r.load_mass_g > 0.0)
            .map(|r| r.load_n / weight_n(r))
            .collect();
        (!factors.is_empty()).then(|| median(&mut factors))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N";
    const LINE: &str = "0,silicone,,up,251.2,3.0766,47,3,eccentric,1,6.93,3.5,2.3157";

    #[test]
    fn readings_must_follow_several_loads() {
        let checked = |from: &str, to: &str| {
            let other = LINE.replacen("0,", "1,", 1).replacen("3.5", "7", 1).replacen(from, to, 1);
            let text = format!("{HEADER}\n{LINE}\n{other}\n");
            PlateauTable::read(text.as_bytes(), "t.csv").unwrap().require_baseline("t.csv")
        };
        assert!(matches!(checked("2.3157", "2.4"), Err(TableError::TooFewLoads { found: 1, .. })));
        assert!(matches!(checked("3.0766", "0"), Err(TableError::TooFewLoads { found: 1, .. })));
        let heavier = |reading: &str| {
            checked(
                "251.2,3.0766,47,3,eccentric,1,6.93,7,2.3157",
                &format!("800,9,47,3,eccentric,1,6.93,7,{reading}"),
            )
        };
        for (reading, slope) in [("2.3157", "0.00"), ("-6", "-1.40"), ("6000", "1012.54")] {
            let error = heavier(reading).unwrap_err();
            let TableError::Unrelated { slope: found, .. } = error else { panic!("{error}") };
            assert_eq!(format!("{found:.2}"), slope, "{reading}");
        }
        assert!(heavier("7.1").is_ok());
        let grams =
            checked("251.2,3.0766,47,3,eccentric,1,6.93,7,2.3157", "800,800,47,3,eccentric,1,6.93,7,700");
        assert!(matches!(grams, Err(TableError::LoadUnit { factor, .. }) if factor > 100.0));
    }
}
