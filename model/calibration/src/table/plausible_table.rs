//! Whether a table's loads and readings can belong together, before anything is fitted to them.

use std::ops::RangeInclusive;

use pinswitch_friction::published::GRAVITY_M_S2;

use super::follows::Following;
use super::friction_gap::{Friction, friction};
use super::plateau_table::PlateauTable;
use super::row::PlateauRow;
use super::swapped_columns::{Swapped, evident, repairing};
use super::table_error::TableError;
use super::units::implausible;
use super::whole_series::mixed_up;
use crate::median::median;
use pinswitch_friction::sort_by_number;

/// Declared load over the weight of the declared mass: one, with room for hooks and levers.
const WEIGHS: RangeInclusive<f64> = 0.5..=2.0;

impl PlateauTable {
    /// Refuses a table that cannot fix a baseline, or that no rig can have measured. One odd condition or series is not
    /// refused: finding it is the fit's.
    ///
    /// # Errors
    /// [`TableError::TooFewLoads`] with fewer than two loads above zero, [`TableError::SwappedColumns`] if two columns
    /// stand in each other's place, [`TableError::Unrelated`] if the readings do not follow the loads in most
    /// conditions, [`TableError::LoadUnit`] if loads and masses contradict each other, [`TableError::NoFriction`] if the
    /// directions differ nowhere, [`TableError::SwappedDirections`] if they differ the wrong way round in most
    /// conditions; what tells units and directions without masses or a second direction, and what is wrong with single
    /// series, has variants of its own.
    pub fn require_baseline(&self, file: &str) -> Result<(), TableError> {
        let mut loads: Vec<f64> = self.rows.iter().map(|r| r.load_n).filter(|n| *n > 0.0).collect();
        loads.sort_by(f64::total_cmp);
        loads.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        let needed = 2;
        let file = file.to_owned();
        let swapped = |Swapped { first, second, because }| TableError::SwappedColumns {
            file: file.clone(),
            first,
            second,
            because,
        };
        if let Some(columns) = evident(&self.rows) {
            return Err(swapped(columns));
        }
        if loads.len() < needed {
            let last_line = self.rows.len() + 1;
            return Err(TableError::TooFewLoads { file, last_line, found: loads.len(), needed });
        }
        if let Some(error) = self.contradiction(&file) {
            return Err(repairing(&self.rows).map_or(error, swapped));
        }
        implausible(&self.rows, &file).or_else(|| mixed_up(&self.rows, &file)).map_or(Ok(()), Err)
    }

    /// What no rig can have measured.
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

    /// Declared load over what `load_mass_g` weighs, on the heaviest quarter of the rows, where a hook adds little;
    /// `None` where no mass is given.
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
    fn one_load_or_readings_that_do_not_follow_it_fix_no_baseline() {
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
            let error = heavier(reading).unwrap_err().to_string();
            assert!(error.contains(&format!("changes by {slope} N")), "{error}");
        }
        assert!(heavier("7.1").is_ok());
        let grams =
            checked("251.2,3.0766,47,3,eccentric,1,6.93,7,2.3157", "800,800,47,3,eccentric,1,6.93,7,700");
        assert!(matches!(grams, Err(TableError::LoadUnit { factor, .. }) if factor > 100.0));
    }
}
